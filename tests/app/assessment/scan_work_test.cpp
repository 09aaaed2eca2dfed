// SPDX-License-Identifier: Apache-2.0
// Scans of preparations whose truth is known: one's own cut tooth as a mesh, moved, noisy, of the crown alone. Measured
// again they are where the virtual tooth is, within what is stated; what is no scan of it is refused.
#include "handpiece/app/assessment/scan_work.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>

#include "handpiece/assess/measures/measure.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/dentition/tooth_form.h"
#include "handpiece/senses/surface/brick_source.h"
#include "handpiece/senses/surface/closed_surface.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::assessment {
namespace {

using core::Vec3;
using geometry::TriangleMesh;
using ::testing::HasSubstr;

tasks::Task taskOf(int fdi, const preparation::Recipe& recipe, int seed = 1) {
    dentition::Patient patient;
    patient.seed = static_cast<std::uint64_t>(seed);
    tasks::Task task;
    task.id = "scanned";
    static_cast<cases::Tooth&>(task.toothCase) = dentition::makeTooth(fdi, patient, {6000, 0});
    task.toothCase.fdiNumber = fdi;
    task.voxelMm = 0.1;
    task.preparation = recipe;
    return task;
}
preparation::Recipe classOne(double depthMm, double widthMm) {
    return {"class-one",
            "",
            {{"depth_mm", depthMm}, {"width_mm", widthMm}, {"ridge_mm", 2.0}, {"wall_deg", 3.0}},
            {0.2, 0.2},
            0.0};
}

/// What was cut, as the product has it and as a mesh of all of it.
struct Cut {
    Work work;
    TriangleMesh mesh;
};
Cut cutBy(const tasks::Task& task, const preparation::Recipe& recipe) {
    tooth::LoadSettings settings;
    settings.field.voxelMm = task.voxelMm;
    settings.useCache = false;
    Cut cut;
    const auto whole = tooth::loadModel(task.toothCase, settings);
    cut.work.teeth = {whole};
    cut.work.state = zones::idealState(*preparation::layOn(task.toothCase, recipe).zones, whole);
    tooth::ToothMirror mirror(whole);
    mirror.apply(cut.work.state);
    cut.mesh = surface::closedSurface(surface::MirrorSource(mirror));
    return cut;
}

/// The crown as a scanner gives it: open below, moved anywhere, every vertex off by noise along each axis.
TriangleMesh scanned(const TriangleMesh& mesh, double fromZ, double noiseMm, std::mt19937_64& generator) {
    TriangleMesh out;
    std::map<std::uint32_t, std::uint32_t> number;
    std::normal_distribution<double> noise(0.0, noiseMm);
    const core::Pose pose{40.0 * test::randomDirection(generator), test::randomRotation(generator)};
    for (const geometry::Triangle& t : mesh.triangles) {
        geometry::Triangle made{};
        if (std::any_of(t.begin(), t.end(), [&](std::uint32_t v) { return mesh.vertices[v].z() < fromZ; })) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [at, isNew] = number.try_emplace(t[k], static_cast<std::uint32_t>(out.vertices.size()));
            if (isNew) {
                const Vec3 off(noise(generator), noise(generator), noise(generator));
                out.vertices.push_back(pose.apply(mesh.vertices[t[k]] + (noiseMm > 0.0 ? off : Vec3(Vec3::Zero()))));
            }
            made[k] = at->second;
        }
        out.triangles.push_back(made);
    }
    return out;
}

struct Tally {
    std::size_t count = 0, covered = 0;
    double worst = 0.0, stated = 0.0;
};
int scans(int usual) {
    const char* asked = std::getenv("HANDPIECE_SCANS");
    return asked != nullptr ? std::max(1, std::atoi(asked)) : usual;
}

/// Scores a scan and the virtual tooth by the same rubric.
void compare(const tasks::Task& task, const Cut& cut, const rubric::Rubric& rubric, double fromZ, int repeats,
             std::map<std::string, Tally>& tallies) {
    std::mt19937_64 generator(test::seed());
    const Result truth = scoreWork(cut.work, task, rubric);
    for (int i = 0; i < repeats; ++i) {
        const Work work = workOfScan(scanned(cut.mesh, fromZ, 0.03, generator), task, "scan");
        ASSERT_TRUE(work.scan);
        EXPECT_LT(work.scan->rmsMm, 0.04);
        const Result result = scoreWork(work, task, rubric);
        EXPECT_EQ(result.assessment.context.device, "scan");
        for (std::size_t k = 0; k < result.assessment.criteria.size(); ++k) {
            const score::CriterionScore &scan = result.assessment.criteria[k], &own = truth.assessment.criteria[k];
            const measures::MeasureKind& kind = *measures::findMeasureKind(scan.measure);
            if (kind.subject == measures::Subject::hand) {
                EXPECT_FALSE(scan.value);
                EXPECT_EQ(scan.reason, "a scan says nothing of the hand");
                continue;
            }
            EXPECT_EQ(scan.value.has_value(), own.value.has_value()) << scan.id << ": " << scan.reason << own.reason;
            if (!scan.value || !own.value) continue;
            const double error = std::abs(*scan.value - *own.value), stated = scan.uncertainty + own.uncertainty;
            Tally& tally = tallies[scan.id];
            ++tally.count;
            tally.covered += error <= stated;
            tally.worst = std::max(tally.worst, error);
            tally.stated = std::max(tally.stated, scan.uncertainty);
        }
    }
}
void tell(const char* what, const std::map<std::string, Tally>& tallies) {
    for (const auto& [id, t] : tallies)
        fmt::print("{} {:<22} {:>3} of {:>3} within, worst {:.4f}, stated at most {:.4f}\n", what, id, t.covered,
                   t.count, t.worst, t.stated);
}

TEST(ScanWork, OwnCutToothScannedComesToTheVirtualValuesWithinWhatIsStated) {
    const rubric::Rubric rubric = rubric::shippedRubric("46-class-i");
    std::map<std::string, Tally> tallies;
    const tasks::Task task = taskOf(46, classOne(1.5, 1.2));
    for (const auto& [depthMm, widthMm] : {std::pair{1.5, 1.2}, {2.2, 1.6}})
        compare(task, cutBy(task, classOne(depthMm, widthMm)), rubric, 0.5, scans(1), tallies);
    tell("class-one", tallies);
    for (const auto& [id, t] : tallies)
        EXPECT_GE(t.covered * 100, t.count * 90) << id;
}

TEST(ScanWork, BadScansAreRefusedWithWhatAndWhatToDo) {
    const tasks::Task task = taskOf(46, classOne(1.5, 1.2));
    const Cut cut = cutBy(task, classOne(1.5, 1.2));
    std::mt19937_64 generator(test::seed());
    const auto errorOf = [&](const TriangleMesh& mesh) {
        return test::errorOf([&] { (void)workOfScan(mesh, task, "the scan"); });
    };
    // Another tooth: the same place of the other jaw's molar, and the neighbour of the same mouth.
    for (const int fdi : {16, 47}) {
        const TriangleMesh other = taskOf(fdi, classOne(1.5, 1.2), 2).toothCase.outer;
        const std::string error = errorOf(scanned(other, 0.5, 0.03, generator));
        EXPECT_THAT(error, HasSubstr("does not fit the exercise's tooth")) << fdi;
        EXPECT_THAT(error, HasSubstr("--unit")) << fdi;
    }
    // Nothing in common: a ball.
    TriangleMesh ball;
    constexpr int kRound = 60, kUp = 30;
    for (int j = 0; j <= kUp; ++j)
        for (int i = 0; i < kRound; ++i) {
            const double up = 3.14159265 * j / kUp, around = 6.2831853 * i / kRound;
            ball.vertices.emplace_back(5.0 * std::sin(up) * std::cos(around), 5.0 * std::sin(up) * std::sin(around),
                                       5.0 * std::cos(up));
        }
    for (std::uint32_t j = 0; j < kUp; ++j)
        for (std::uint32_t i = 0; i < kRound; ++i) {
            const std::uint32_t a = j * kRound + i, b = j * kRound + (i + 1) % kRound;
            ball.triangles.push_back({a, a + kRound, b});
            ball.triangles.push_back({b, a + kRound, b + kRound});
        }
    EXPECT_THAT(errorOf(ball), HasSubstr("does not fit the exercise's tooth"));
    EXPECT_THAT(errorOf(TriangleMesh{}), HasSubstr("no surface"));
    // Files: cut off, no mesh, in metres.
    const test::TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "scan.stl";
    const auto ofFile = [&] { return test::errorOf([&] { (void)readScan(file, task); }); };
    std::vector<std::byte> bytes = geometry::stlBytes(cut.mesh, "scan");
    bytes.resize(bytes.size() / 2);
    {
        std::ofstream out(file, std::ios::binary);
        out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
    EXPECT_THAT(ofFile(), HasSubstr("scan.stl"));
    std::ofstream(file) << "no mesh at all";
    EXPECT_THAT(ofFile(), HasSubstr("scan.stl"));
    geometry::writeStl(file, geometry::scaled(cut.mesh, 1e-3));
    EXPECT_THAT(ofFile(), testing::AllOf(HasSubstr("--unit"), HasSubstr("looks like m")));
    EXPECT_NO_THROW((void)readScan(file, task, 1000.0));
}

}  // namespace
}  // namespace handpiece::assessment
