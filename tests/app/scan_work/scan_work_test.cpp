// SPDX-License-Identifier: Apache-2.0
// Scans of preparations whose truth is known. Measured again they are where the virtual tooth is, within what is
// stated; what is no scan of it is refused.
#include "handpiece/app/scan_work/scan_work.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "app/scan_work/scans.h"
#include "handpiece/assess/measures/measure.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/dentition/tooth_form.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::scan_work::test::scan_work_test {
namespace {

using ::testing::HasSubstr;

constexpr double kNoiseMm = 0.03;

assessment::Result scoreOf(ScannedTeeth teeth, const Bench& bench) {
    return assessment::scoreWork(assessment::workOfScan(std::move(teeth)), bench.task, bench.rubric);
}
const score::CriterionScore& criterion(const assessment::Result& result, const std::string& id) {
    const auto& all = result.assessment.criteria;
    return *std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.id == id; });
}

/// One cavity for all tests of this program.
struct ClassOne {
    std::mt19937_64 generator{handpiece::test::seed()};
    Bench bench = benchOf(Kind::classOne, false);
    Cut cut = cutBy(bench.task, varied(*bench.task.preparation, generator));
    TriangleMesh shown = crownOf(cut.mesh, 0.5);
};
ClassOne& classOne() {
    static ClassOne one;
    return one;
}
TriangleMesh holed(TriangleMesh mesh, const Vec3& at, double reachMm) {
    std::erase_if(mesh.triangles,
                  [&](const geometry::Triangle& t) { return (mesh.vertices[t[0]] - at).norm() < reachMm; });
    return mesh;
}

TEST(ScanWork, ACavityScannedComesToTheVirtualValuesWithinWhatIsStated) {
    ClassOne& one = classOne();
    // With holes, one in the cavity's floor, and inside out.
    TriangleMesh mesh = holed(one.shown, {0.0, 0.0, 3.6}, 0.4);
    mesh = holed(std::move(mesh), {0.0, 4.0, 2.0}, 0.6);
    for (geometry::Triangle& t : mesh.triangles)
        std::swap(t[1], t[2]);
    ScannedTeeth teeth = teethOfScan(scanned(std::move(mesh), kNoiseMm, one.generator), one.bench.task, "scan");
    EXPECT_LT(teeth.fit.rmsMm, 0.04);
    EXPECT_LT(teeth.fit.liesMm, 0.01);
    EXPECT_EQ(teeth.fit.registeredOn, score::RegisteredOn::uncutSurface);
    const assessment::Result truth = assessment::scoreWork(one.cut.work, one.bench.task, one.bench.rubric);
    const assessment::Result result = scoreOf(std::move(teeth), one.bench);
    EXPECT_EQ(result.assessment.context.device, "scan");
    EXPECT_EQ(criterion(result, "time").reason, "a scan says nothing of the hand");
    Tallies tallies;
    compare(truth, result, tallies);
    std::size_t count = 0, covered = 0;
    for (const auto& [id, t] : tallies) {
        fmt::print("{:<16} worst {:.4f}, stated {:.4f}\n", id, t.worst, t.stated);
        EXPECT_EQ(t.missing, 0u) << id;
        EXPECT_LE(t.worst, 2.0 * t.stated + 1e-9) << id;
        count += t.count;
        covered += t.covered;
    }
    EXPECT_GE(count, 7u);
    EXPECT_GE(covered + 1, count);
}

TEST(ScanWork, AnUncutToothHasNothingDone) {
    ClassOne& one = classOne();
    const TriangleMesh uncut = crownOf(one.bench.task.toothCase.outer, 0.5);
    ScannedTeeth teeth = teethOfScan(scanned(uncut, kNoiseMm, one.generator), one.bench.task, "scan");
    EXPECT_EQ(teeth.fit.cutMm2, 0.0);
    const assessment::Result result = scoreOf(std::move(teeth), one.bench);
    EXPECT_FALSE(criterion(result, "depth").value);
    EXPECT_EQ(criterion(result, "depth").reason, "nothing was cut");
    EXPECT_THAT(result.proof, HasSubstr("nothing of the tooth is gone"));
}

TEST(ScanWork, BadScansAreRefusedWithWhatAndWhatToDo) {
    ClassOne& one = classOne();
    const tasks::Task& task = one.bench.task;
    std::mt19937_64& generator = one.generator;
    const auto errorOf = [&](const TriangleMesh& mesh) {
        return handpiece::test::errorOf([&] { (void)teethOfScan(mesh, task, "the scan"); });
    };
    // Another tooth: the same place of the other jaw's molar, and the neighbour of the same mouth.
    dentition::Patient another;
    another.seed = 2;
    for (const int fdi : {16, 47}) {
        const TriangleMesh other = dentition::makeTooth(fdi, another, {6000, 0}).outer;
        const std::string error = errorOf(scanned(crownOf(other, 0.5), kNoiseMm, generator));
        EXPECT_THAT(error, HasSubstr("does not fit the exercise's tooth")) << fdi;
        EXPECT_THAT(error, HasSubstr("--unit")) << fdi;
    }
    TriangleMesh mirrored = one.shown;
    for (Vec3& v : mirrored.vertices)
        v.y() = -v.y();
    EXPECT_THAT(errorOf(scanned(std::move(mirrored), kNoiseMm, generator)), HasSubstr("does not fit"));
    EXPECT_THAT(errorOf(TriangleMesh{}), HasSubstr("no surface"));
    // Files: cut off, no mesh, in metres.
    const handpiece::test::TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "scan.stl";
    const auto ofFile = [&] { return handpiece::test::errorOf([&] { (void)readScan({file}, task); }); };
    std::vector<std::byte> bytes = geometry::stlBytes(one.cut.mesh, "scan");
    bytes.resize(bytes.size() / 2);
    {
        std::ofstream out(file, std::ios::binary);
        out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
    EXPECT_THAT(ofFile(), HasSubstr("scan.stl"));
    std::ofstream(file) << "no mesh at all";
    EXPECT_THAT(ofFile(), HasSubstr("scan.stl"));
    geometry::writeStl(file, geometry::scaled(one.cut.mesh, 1e-3));
    EXPECT_THAT(ofFile(), testing::AllOf(HasSubstr("--unit"), HasSubstr("looks like m")));
    EXPECT_NO_THROW((void)readScan({file, {}, 1000.0}, task));
}

}  // namespace
}  // namespace handpiece::scan_work::test::scan_work_test
