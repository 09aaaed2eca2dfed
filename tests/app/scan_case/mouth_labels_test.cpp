// SPDX-License-Identifier: Apache-2.0
// Labels with FDI numbers, as segmentation programs write them, become a mouth.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <numbers>
#include <random>

#include "handpiece/app/scan_case/scan_job.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/case/case_check.h"
#include "handpiece/model/dentition/tooth_form.h"
#include "handpiece/scan/volume/write_scan.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::scan_case::mouth_labels_test {
namespace {

using core::Pose;
using core::Quat;
using core::Vec3;
using geometry::TriangleMesh;
using test::errorOf;
using ::testing::Contains;
using ::testing::HasSubstr;

struct TrueTooth {
    TriangleMesh inScan;
    Pose toothInScan;
};
using TrueMouth = std::map<int, TrueTooth>;

/// Lower right teeth along an arc and upper ones that stand over two of them; +x left, +y back, +z head.
TrueMouth trueMouth() {
    TrueMouth mouth;
    geometry::IsosurfaceSettings settings;
    settings.lipschitz = dentition::ToothForm::kLipschitz;
    settings.usualSlope = 1.0;
    settings.spacingMm = 0.25;
    const auto stand = [&](int fdi, double alongMm) {
        const dentition::ToothForm form(fdi, {3, 25.0});
        // An arc about a place behind: from the front it goes to the right and back.
        constexpr double kRadiusMm = 32.0;
        const double rad = alongMm / kRadiusMm;
        const Vec3 at(-kRadiusMm * core::sin(rad), -kRadiusMm * core::cos(rad), 0.0);
        const Vec3 mesial(core::cos(rad), -core::sin(rad), 0.0);
        const bool isUpper = fdi < 30;
        const Vec3 occlusal(0.0, 0.0, isUpper ? -1.0 : 1.0);
        core::Mat3 axes;
        axes.col(0) = mesial;
        axes.col(1) = occlusal.cross(mesial);
        axes.col(2) = occlusal;
        TrueTooth& tooth = mouth[fdi];
        // Real teeth lean.
        const Quat lean(Eigen::AngleAxisd(0.12, Vec3(0.6, 0.8, 0.0)));
        tooth.toothInScan = {at + Vec3(0.0, 0.0, isUpper ? 17.0 : 0.0), (Quat(axes) * lean).normalized()};
        tooth.inScan = geometry::transformed(geometry::isosurface(
                                                 form.bounds(), [&](const Vec3& p) { return form.outer(p); }, settings),
                                             tooth.toothInScan);
    };
    double along = 22.0;
    for (const int fdi : {44, 45, 46, 47}) {
        const double width = dentition::ToothForm(fdi, {3, 25.0}).mesiodistalMm();
        stand(fdi, along + 0.5 * width);
        along += width + 0.1;
    }
    stand(15, 33.0);
    stand(16, 43.0);
    return mouth;
}

const TrueMouth& theMouth() {
    static const TrueMouth mouth = trueMouth();
    return mouth;
}

volume::Labels labelsOf(const TrueMouth& mouth, const Vec3& spacingMm, double marginMm = 2.0) {
    volume::Labels labels;
    core::Box box;
    for (const auto& [fdi, tooth] : mouth) {
        box.extend(tooth.inScan.bounds().min);
        box.extend(tooth.inScan.bounds().max);
    }
    labels.grid.spacingMm = spacingMm;
    labels.grid.originMm = box.min - Vec3::Constant(marginMm);
    for (std::size_t a = 0; a < 3; ++a)
        labels.grid.size[a] =
            static_cast<int>((box.size()[static_cast<int>(a)] + 2.0 * marginMm) / spacingMm[static_cast<int>(a)]) + 1;
    labels.values.assign(labels.grid.count(), 0);
    for (const auto& [fdi, tooth] : mouth) {
        const geometry::TriangleTree tree(tooth.inScan);
        const Vec3 low = labels.grid.toVoxels(tree.bounds().min), high = labels.grid.toVoxels(tree.bounds().max);
        const auto from = [&](int a) { return std::max(0, static_cast<int>(low[a])); };
        const auto to = [&](int a) {
            return std::min(labels.grid.size[static_cast<std::size_t>(a)] - 1, static_cast<int>(high[a]) + 1);
        };
        for (int k = from(2); k <= to(2); ++k)
            for (int j = from(1); j <= to(1); ++j)
                for (int i = from(0); i <= to(0); ++i)
                    if (tree.signedDistance(labels.grid.toMm(Vec3(i, j, k))) < 0.0)
                        labels.values[labels.grid.index(i, j, k)] = static_cast<std::uint8_t>(fdi);
    }
    return labels;
}

/// As a NIfTI file of 16 bits, which is what most programs write.
std::filesystem::path written(const volume::Labels& labels, const std::filesystem::path& folder) {
    volume::Volume volume;
    volume.grid = labels.grid;
    volume.values.assign(labels.values.begin(), labels.values.end());
    volume::writeScan(volume, folder, volume::ScanFormat::nifti);
    return folder / "scan.nii";
}

double degreesBetween(const Vec3& a, const Vec3& b) {
    return core::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

/// A surface beside the true one: 95th percentile of the distances.
double offMm(const TriangleMesh& made, const TriangleMesh& truth) {
    const geometry::TriangleTree tree(truth);
    std::vector<double> distances;
    for (const Vec3& v : made.vertices)
        distances.push_back(tree.nearest(v).distanceMm);
    std::sort(distances.begin(), distances.end());
    return distances[distances.size() * 95 / 100];
}

TEST(MouthOfLabels, EachToothIsWhereAndWhatItWas) {
    constexpr double kVoxelMm = 0.3;
    const TrueMouth& truth = theMouth();
    volume::Labels labels = labelsOf(truth, Vec3::Constant(kVoxelMm));
    // Bone about the lower roots, as ToothFairy numbers it.
    const double crestAt = truth.at(46).toothInScan.positionMm.z() - 2.0;
    for (int k = 0; k < labels.grid.size[2]; ++k)
        for (int j = 4; j + 4 < labels.grid.size[1]; ++j)
            for (int i = 4; i + 4 < labels.grid.size[0]; ++i) {
                std::uint8_t& label = labels.values[labels.grid.index(i, j, k)];
                if (k > 3 && labels.grid.toMm(Vec3(i, j, k)).z() < crestAt && label == 0) label = 1;
            }
    const test::TemporaryFolder folder;
    ScanJob job;
    job.source = written(labels, folder.path());
    job.placing.fdiNumber = 46;
    job.percents = {100.0};
    job.openingMm = 0.0;
    const ScanResult result = runScanJob(job);
    EXPECT_TRUE(result.isMouth());
    EXPECT_THAT(result.notes(), Contains(HasSubstr("labels of teeth, not grey values")));
    EXPECT_THAT(result.notes(), ::testing::Not(Contains(HasSubstr("mirror"))));
    ASSERT_EQ(result.cases.size(), 1u);
    const cases::Case& made = result.cases.front().toothCase;
    EXPECT_EQ(made.fdiNumber, 46);
    EXPECT_EQ(made.kind, "lower-first-molar");
    ASSERT_EQ(made.others.size(), truth.size() - 1);

    const auto isRight = [&](const cases::Tooth& tooth, const Pose& inCase) {
        SCOPED_TRACE(tooth.fdiNumber);
        const TrueTooth& as = truth.at(tooth.fdiNumber);
        // The case's frame is the found one's of 46: back by that.
        const Pose toothInScan = result.placed.scanInTooth.inverse() * inCase;
        const TriangleMesh inScan = geometry::transformed(tooth.outer, toothInScan);
        EXPECT_LT(offMm(inScan, as.inScan), 0.5 * kVoxelMm);
        const double volume = geometry::enclosedVolumeMm3(as.inScan);
        EXPECT_NEAR(geometry::enclosedVolumeMm3(inScan), volume, 0.02 * volume);
        const Quat& found = toothInScan.orientation;
        const Quat& was = as.toothInScan.orientation;
        EXPECT_LT(degreesBetween(found * Vec3::UnitX(), was * Vec3::UnitX()), 6.0);
        EXPECT_LT(degreesBetween(found * Vec3::UnitZ(), was * Vec3::UnitZ()), 4.0);
        EXPECT_LT((toothInScan.positionMm - as.toothInScan.positionMm).norm(), 1.0);
        EXPECT_EQ(tooth.buccalSign, tooth.fdiNumber / 10 % 2 == 1 ? 1 : -1);
        ASSERT_EQ(tooth.parts.size(), 1u);
        EXPECT_EQ(tooth.parts.front().tissue, cases::Tissue::enamel);
    };
    isRight(made, {});
    for (const cases::PlacedTooth& other : made.others)
        isRight(other, other.inCase);
    for (const cases::PlacedTooth& other : made.others)
        EXPECT_TRUE(other.isCuttable || (other.fdiNumber != 45 && other.fdiNumber != 47)) << other.fdiNumber;

    ASSERT_FALSE(made.scenery.empty());
    EXPECT_EQ(made.scenery.front().tissue, cases::Tissue::bone);
    EXPECT_TRUE(made.scenery.front().isFelt);
    // It stays clear of the roots.
    const geometry::TriangleTree own(made.outer);
    for (const Vec3& v : made.scenery.front().mesh.vertices)
        ASSERT_GT(own.signedDistance(v), 0.0);

    writeScanCases(result, folder.path() / "mouth");
    const cases::Case back = cases::readCase(folder.path() / "mouth");
    EXPECT_EQ(back.others.size(), made.others.size());
    EXPECT_TRUE(cases::checkCase(back).empty() || !cases::checkCase(back).front().isError);

    // Opened for work: the upper teeth go up as one, all else stays.
    job.openingMm = 30.0;
    const ScanResult opened = runScanJob(job, {}, &result);
    EXPECT_EQ(opened.full, result.full);
    EXPECT_THAT(opened.notes(), Contains(HasSubstr("opened to 30 mm")));
    const cases::Case& wide = opened.cases.front().toothCase;
    for (std::size_t i = 0; i < made.others.size(); ++i) {
        const Pose &was = made.others[i].inCase, &is = wide.others[i].inCase;
        if (made.others[i].fdiNumber < 30)
            EXPECT_GT((is.positionMm - was.positionMm).norm(), 8.0) << made.others[i].fdiNumber;
        else
            EXPECT_LT((is.positionMm - was.positionMm).norm(), 1e-9) << made.others[i].fdiNumber;
    }

    // Another of its teeth: the labels are not read anew, and it is the other way round.
    job.placing.fdiNumber = 16;
    const ScanResult upper = runScanJob(job, {}, &result, ScanStage::place);
    EXPECT_EQ(upper.scan, result.scan);
    EXPECT_EQ(upper.fdiNumber, 16);
    EXPECT_EQ(upper.others.size(), truth.size() - 1);
    // One that is not there is told with those that are.
    job.placing.fdiNumber = 11;
    EXPECT_THAT(errorOf([&] { (void)runScanJob(job, {}, &result); }), HasSubstr("15, 16, 44, 45, 46, 47"));
}

TEST(MouthOfLabels, TheScanThatTheyAreOfLiesWhereTheyDo) {
    const volume::Labels labels = labelsOf(theMouth(), Vec3::Constant(0.5));
    const test::TemporaryFolder folder;
    std::mt19937_64 generator(test::seed());
    for (const double shiftMm : {0.0, 4.0, 12.0}) {
        volume::Volume grey;
        grey.grid = labels.grid;
        grey.grid.originMm.y() += shiftMm;
        for (std::size_t n = 0; n < labels.values.size(); ++n) {
            const auto k = static_cast<int>(n / (grey.grid.count() / static_cast<std::size_t>(grey.grid.size[2])));
            // Crowns, near the plane where the jaws meet, are of enamel.
            const double z = labels.grid.toMm(Vec3(0, 0, k)).z();
            const double level = labels.values[n] < 11 ? 100.0 : std::abs(z) < 3.0 ? 3000.0 : 1800.0;
            grey.values.push_back(static_cast<float>(std::round(level + test::uniform(generator, -40, 40))));
        }
        std::filesystem::remove_all(folder.path() / "grey");
        volume::writeScan(grey, folder.path() / "grey", volume::ScanFormat::nrrd);
        ScanJob job;
        job.source = written(labels, folder.path());
        job.placing.fdiNumber = 46;
        job.grey = folder.path() / "grey" / "scan.nrrd";
        if (shiftMm > 8.0) {
            EXPECT_THAT(errorOf([&] { (void)runScanJob(job, {}, nullptr, ScanStage::segment); }),
                        HasSubstr("another scan, or shifted"));
            continue;
        }
        const ScanResult result = runScanJob(job, {}, nullptr, ScanStage::segment);
        const auto isTold = Contains(HasSubstr("are they of this scan?"));
        if (shiftMm > 0.0)
            EXPECT_THAT(result.notes(), isTold);
        else
            EXPECT_THAT(result.notes(), ::testing::Not(isTold));
    }
}

TEST(MouthOfLabels, AMirrorImageIsTold) {
    volume::Labels labels = labelsOf(theMouth(), Vec3::Constant(0.5));
    for (std::uint8_t& v : labels.values)
        v = static_cast<std::uint8_t>(v >= 40 ? v - 10 : v > 0 ? v + 10 : 0);  // the right side's are called the left's
    const test::TemporaryFolder folder;
    ScanJob job;
    job.source = written(labels, folder.path());
    const ScanResult result = runScanJob(job, {}, nullptr, ScanStage::place);
    EXPECT_EQ(result.fdiNumber, 36);
    EXPECT_THAT(result.notes(), Contains(HasSubstr("mirror image")));
    EXPECT_THAT(result.notes(), Contains(HasSubstr("the tooth that is worked on is 36")));
}

/// A peg with a crown, cheap to make.
void addPeg(volume::Labels& labels, const Vec3& atMm, std::uint8_t label) {
    const volume::Grid& g = labels.grid;
    for (int k = 0; k < g.size[2]; ++k)
        for (int j = 0; j < g.size[1]; ++j)
            for (int i = 0; i < g.size[0]; ++i) {
                const Vec3 p = g.toMm(Vec3(i, j, k)) - atMm;
                const double up = p.z() + 9.0;  // from the apex
                const double radius = up < 0.0 || up > 18.0 ? 0.0
                                      : up < 11.0           ? 1.0 + 0.2 * up
                                                            : 3.8 - 0.05 * (up - 14.0) * (up - 14.0);
                if (p.head<2>().norm() < radius) labels.values[g.index(i, j, k)] = label;
            }
}

volume::Labels pegs(const Vec3& spacingMm) {
    volume::Labels labels;
    labels.grid.spacingMm = spacingMm;
    labels.grid.size = {static_cast<int>(34.0 / spacingMm.x()), static_cast<int>(16.0 / spacingMm.y()),
                        static_cast<int>(26.0 / spacingMm.z())};
    labels.values.assign(labels.grid.count(), 0);
    addPeg(labels, Vec3(6, 8, 13), 85);
    addPeg(labels, Vec3(16, 8, 13), 84);
    addPeg(labels, Vec3(26, 8, 13), 83);
    return labels;
}

TEST(MouthOfLabels, WhatIsOddIsTold) {
    const test::TemporaryFolder folder;
    volume::Labels labels = pegs(Vec3::Constant(0.4));
    const auto set = [&](int i, int j, int k, std::uint8_t label) {
        labels.values[labels.grid.index(i, j, k)] = label;
    };
    for (int i = 72; i < 75; ++i)
        set(i, 5, 5, 82);  // a tooth of three voxels
    for (int i = 0; i < 27; ++i)
        set(3 + i % 3, 3 + i / 3 % 3, 3 + i / 9, 85);  // another piece of 85
    for (int i = 0; i < 18; ++i)
        set(80 + i % 3, 3 + i / 3 % 3, 3 + i / 9, 83);  // and a smaller one of 83
    for (int k = 12; k < 50; ++k)
        for (int i = 65; i < labels.grid.size[0]; ++i)
            set(i, 20, k, 83);  // out of the volume
    ScanJob job;
    job.source = written(labels, folder.path());
    job.isLabels = true;
    const ScanResult result = runScanJob(job);
    const std::vector<std::string> notes = result.notes();
    EXPECT_THAT(notes, Contains(HasSubstr("82 is left out: its label has 3 voxels")));
    // What is told of both is told once.
    EXPECT_THAT(notes, Contains("83, 85: in several pieces, of which the largest is kept, 2.9 mm3 are left out"));
    EXPECT_THAT(notes, Contains(HasSubstr("cuts off 83")));
    EXPECT_THAT(notes, Contains(HasSubstr("counts as enamel")));
    EXPECT_EQ(result.cases.front().toothCase.others.size(), 2u);
    EXPECT_EQ(result.cases.front().toothCase.fdiNumber, 84);  // the one that is whole, between two
    // By a place in it.
    job.segmentation.toothAtMm = Vec3(6, 8, 15);
    EXPECT_EQ(runScanJob(job, {}, &result, ScanStage::segment).fdiNumber, 85);
    job.segmentation.toothAtMm = Vec3(11, 1, 1);
    EXPECT_THAT(errorOf([&] { (void)runScanJob(job, {}, &result); }), HasSubstr("no tooth at the place"));
}

TEST(MouthOfLabels, SlicesFarApartAndFloats) {
    const test::TemporaryFolder folder;
    const volume::Labels labels = pegs(Vec3(0.3, 0.3, 0.6));
    volume::Volume volume;
    volume.grid = labels.grid;
    volume.values.assign(labels.values.begin(), labels.values.end());
    volume::writeScan(volume, folder.path(), volume::ScanFormat::metaimage);
    ScanJob job;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        if (entry.path().extension() == ".mha" || entry.path().extension() == ".mhd") job.source = entry.path();
    const ScanResult result = runScanJob(job);
    EXPECT_THAT(result.notes(), Contains(HasSubstr("0.3 x 0.3 x 0.6 mm")));
    const TriangleMesh& surface = result.full->outer.mesh;
    volume::Labels truth = pegs(Vec3::Constant(0.15));
    double voxels = 0.0;
    for (const std::uint8_t v : truth.values)
        voxels += v == result.fdiNumber ? 1.0 : 0.0;
    const double volume3 = voxels * truth.grid.voxelMm3();
    EXPECT_NEAR(geometry::enclosedVolumeMm3(surface), volume3, 0.03 * volume3);
}

TEST(MouthOfLabels, JawsAndRowsOfTeethAreRefused) {
    volume::Labels labels;
    labels.grid.size = {120, 100, 60};
    labels.grid.spacingMm = Vec3::Constant(0.6);
    labels.values.assign(labels.grid.count(), 0);
    for (std::size_t n = 0; n < labels.values.size(); ++n)
        labels.values[n] = n % 120 < 100 ? static_cast<std::uint8_t>(1 + n / 120 / 100 / 15) : std::uint8_t{0};
    const test::TemporaryFolder folder;
    volume::writeLabels(labels, folder.path() / "labels.nrrd");
    ScanJob job;
    job.source = folder.path() / "labels.nrrd";
    job.isLabels = true;
    EXPECT_THAT(errorOf([&] { (void)runScanJob(job); }), HasSubstr("rows of teeth"));
}

}  // namespace
}  // namespace handpiece::scan_case::mouth_labels_test
