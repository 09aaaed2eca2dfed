// SPDX-License-Identifier: Apache-2.0
// A person's decisions as a file and back; and what is done again when one of them changes.
#include "handpiece/app/scan_case/scan_job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "handpiece/base/core/file.h"
#include "handpiece/scan/volume/write_scan.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::scan_case::scan_job_test {
namespace {

using core::Vec3;
using test::errorOf;
using ::testing::HasSubstr;

ScanJob everything() {
    ScanJob job;
    job.source = "/somewhere/a \"quoted\" \\ folder/Zähne";
    job.series = "3";
    job.spacingMm = Vec3(0.1, 0.2, 1.0 / 3.0);
    job.isLabels = true;
    job.labelOrder = {0, 3, 2, 1, 4};
    job.grey = "/somewhere/else";
    job.labelNumbers = segmentation::LabelNumbers::universal;
    segmentation::Settings& s = job.segmentation;
    s.thresholds =
        segmentation::Thresholds{-1000.5f, 80, 1500, 2800, 250, 2150, std::numeric_limits<float>::infinity()};
    s.toothAtMm = Vec3(1e-7, -2.5, 1234.0);
    s.cutPlanes = {{Vec3(1, 2, 3), Vec3(0, 0, 1)}, {Vec3(0, 0, 0), Vec3(0.6, 0, 0.8)}};
    s.marks = {{Vec3(1, 1, 1), 0.25, cases::Tissue::pulp}, {Vec3(2, 2, 2), 1.5, cases::Tissue::none}};
    s.lesions = {{Vec3(3, 3, 3), Vec3(0.5, 0.75, 1.0)}};
    s.damp = s.findCaries = false;
    s.spacingMm = 0.07;
    job.toothFrom = 123.25;
    job.enamelFrom = -4.0;
    job.smooth = false;
    job.intraoral = "crown.stl";
    job.intraoralUnit = "inch";
    job.intraoralInScan = core::Pose{Vec3(1, 2, 3), core::Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()))};
    job.intraoralReachMm = 0.3;
    job.intraoralOverlap = 0.2;
    job.placing = {Vec3(0, 1, 0), Vec3(0.5, 0, 0.5), 46};
    job.name = "a name\nof two lines";
    job.kind = "lower-first-molar";
    job.tissuesFile = "t.toml";
    job.scenery = true;
    job.percents = {6, 12.5, 100};
    job.faces = 12345;
    return job;
}

TEST(ScanJobFile, KeepsEveryDecision) {
    const ScanJob job = everything();
    const std::string text = toToml(job);
    const ScanJob back = scanJobFromToml(text, "job.toml");
    EXPECT_EQ(toToml(back), text);
    EXPECT_EQ(back.source, job.source);
    EXPECT_EQ(back.name, job.name);
    EXPECT_EQ(back.spacingMm, job.spacingMm);
    EXPECT_EQ(back.segmentation.thresholds->outside, -1000.5f);
    EXPECT_TRUE(std::isinf(back.segmentation.thresholds->restorationFrom));
    EXPECT_EQ(back.segmentation.toothAtMm, job.segmentation.toothAtMm);
    ASSERT_EQ(back.segmentation.marks.size(), 2u);
    EXPECT_EQ(back.segmentation.marks[0].tissue, cases::Tissue::pulp);
    EXPECT_EQ(back.segmentation.marks[1].tissue, cases::Tissue::none);
    EXPECT_EQ(back.segmentation.cutPlanes[1].normal, Vec3(0.6, 0, 0.8));
    EXPECT_EQ(back.segmentation.lesions[0].halfAxesMm, Vec3(0.5, 0.75, 1.0));
    EXPECT_EQ(back.intraoralUnit, "inch");
    EXPECT_LT(back.intraoralInScan->orientation.angularDistance(job.intraoralInScan->orientation), 1e-12);
    EXPECT_EQ(back.labelOrder, job.labelOrder);
    EXPECT_EQ(back.grey, job.grey);
    EXPECT_EQ(back.labelNumbers, job.labelNumbers);
    EXPECT_EQ(back.percents, job.percents);
    EXPECT_EQ(back.placing.fdiNumber, 46);
    // A job of nothing but defaults says nothing.
    EXPECT_EQ(toToml(scanJobFromToml(toToml({}), "x")), toToml({}));
    EXPECT_THAT(toToml({}), ::testing::Not(HasSubstr("[")));
}

TEST(ScanJobFile, EachDecisionAloneComesBack) {
    // Bare keys must not slip under a heading, whatever else is there.
    ScanJob one;
    one.toothFrom = 5.0;
    one.segmentation.damp = false;
    one.segmentation.cutPlanes = {{Vec3::Zero(), Vec3::UnitX()}};
    const ScanJob back = scanJobFromToml(toToml(one), "x");
    EXPECT_EQ(back.toothFrom, 5.0);
    EXPECT_FALSE(back.segmentation.damp);
    ScanJob two;
    two.segmentation.marks = {{Vec3(1, 2, 3), 1.0, cases::Tissue::caries}};
    two.enamelFrom = 7.0;
    EXPECT_EQ(scanJobFromToml(toToml(two), "x").enamelFrom, 7.0);
    EXPECT_EQ(scanJobFromToml(toToml(two), "x").segmentation.marks.size(), 1u);
    ScanJob three;
    three.reverseSlices = true;
    three.openingMm = 25.0;
    three.regionMm = std::array{Vec3(1, 2.5, 3), Vec3(-4, 5, 6)};
    const ScanJob again = scanJobFromToml(toToml(three), "x");
    EXPECT_TRUE(again.reverseSlices);
    EXPECT_EQ(again.openingMm, 25.0);
    EXPECT_EQ(again.regionMm, three.regionMm);
    EXPECT_FALSE(scanJobFromToml(toToml(two), "x").reverseSlices);
    const volume::ReadSettings settings = readSettings(again);
    EXPECT_TRUE(settings.reverseSlices);
    EXPECT_EQ(settings.regionMm, three.regionMm);
}

TEST(ScanJobFile, TellsWhatIsWrong) {
    const auto told = [](const std::string& text) { return errorOf([&] { (void)scanJobFromToml(text, "job.toml"); }); };
    EXPECT_THAT(told(""), HasSubstr("format"));
    EXPECT_THAT(told("format = 1\nspacing_mm = [1, 2]\n"), HasSubstr("spacing_mm"));
    EXPECT_THAT(told("format = 1\nspacing_mm = [1, 2, 0]\n"), HasSubstr("not above zero"));
    EXPECT_THAT(told("format = 1\nregion_mm = [1, 2, 0]\n"), HasSubstr("region_mm has 3 numbers"));
    EXPECT_THAT(told("format = 1\nregion_mm = [1, 2, 0, 1, 1, nan]\n"), HasSubstr("region_mm"));
    EXPECT_THAT(told("format = 1\npercents = []\n"), HasSubstr("percent"));
    EXPECT_THAT(told("format = 1\nlabel_order = [1.5]\n"), HasSubstr("label_order"));
    EXPECT_THAT(told("format = 1\n[placing]\nocclusal = [0, 0, 0]\n"), HasSubstr("no direction"));
    EXPECT_THAT(told("format = 1\n[intraoral]\nmesh = \"a.stl\"\nunit = \"ell\"\n"), HasSubstr("no unit"));
    EXPECT_THAT(told("format = 1\n[intraoral]\nposition_mm = [0, 0, 0]\n"), HasSubstr("quaternion"));
    EXPECT_THAT(told("format = 1\n[segmentation.thresholds]\noutside = 1\n"), HasSubstr("missing"));
    EXPECT_THAT(told("format = 1\n[[segmentation.lesion]]\ncentre_mm = [0, 0, 0]\nhalf_axes_mm = [1, 0, 1]\n"),
                HasSubstr("half axis"));
}

/// Two balls one in the other, as labels: dentine with a cap of enamel and a pulp.
volume::Labels simpleTooth() {
    volume::Labels labels;
    labels.grid.size = {44, 40, 60};
    labels.grid.spacingMm = Vec3::Constant(0.25);
    labels.values.assign(labels.grid.count(), 0);
    for (int k = 0; k < 60; ++k)
        for (int j = 0; j < 40; ++j)
            for (int i = 0; i < 44; ++i) {
                const Vec3 p = labels.grid.toMm(Vec3(i, j, k)) - Vec3(5.5, 5.0, 7.5);
                const auto within = [&](double x, double y, double z) {
                    return p.cwiseQuotient(Vec3(x, y, z)).squaredNorm() < 1.0;
                };
                std::uint8_t& label = labels.values[labels.grid.index(i, j, k)];
                if (within(4.6, 4.0, 6.5)) label = p.z() > 2.0 ? 2 : 3;
                if (within(3.6, 3.0, 5.5)) label = 3;
                if (within(1.2, 1.0, 3.0)) label = 4;
            }
    return labels;
}

TEST(ScanJobFile, ANameThatIsNoUtf8IsReadAndNotKept) {
    const test::TemporaryFolder folder;
    ScanJob job, other;
    job.source = folder.path() / "Z\xe4hne.nrrd";
    other.source = folder.path() / "Z\xe5hne.nrrd";
    EXPECT_NE(toToml(job), toToml(other));
    EXPECT_THAT(errorOf([&] { writeScanJob(job, folder.path() / "job.toml"); }), HasSubstr("no UTF-8"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "job.toml"));
    volume::writeLabels(simpleTooth(), job.source);
    job.isLabels = true;
    job.reverseSlices = true;
    const ScanResult result = runScanJob(job, {}, nullptr, ScanStage::read);
    EXPECT_EQ(result.labels->values.front(), 0);
    EXPECT_THAT(result.notes(), ::testing::Contains(HasSubstr("read from the other end")));
}

TEST(ScanJobFile, IsForItsOwnersEyes) {
    const test::TemporaryFolder folder;
    ScanJob job;
    job.source = "/patients/somebody";
    writeScanJob(job, folder.path() / "job.toml");
    EXPECT_EQ(std::filesystem::status(folder.path() / "job.toml").permissions(),
              std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
    EXPECT_EQ(readScanJob(folder.path() / "job.toml").source, job.source);
}

TEST(ScanRun, DoesAgainOnlyWhatADecisionTouches) {
    const test::TemporaryFolder folder;
    volume::writeLabels(simpleTooth(), folder.path() / "labels.nrrd");
    ScanJob job;
    job.source = folder.path() / "labels.nrrd";
    job.isLabels = true;
    std::set<ScanStage> worked;
    std::mutex mutex;
    const ScanProgress listen = [&](ScanStage stage, double fraction) {
        EXPECT_TRUE(fraction >= 0.0 && fraction <= 1.0);
        const std::lock_guard lock(mutex);
        worked.insert(stage);
        return true;
    };
    using S = ScanStage;
    const ScanResult first = runScanJob(job, listen, nullptr, S::segment);
    EXPECT_EQ(worked, (std::set{S::read, S::segment}));
    EXPECT_EQ(first.full, nullptr);
    EXPECT_TRUE(first.cases.empty());

    const auto next = [&](const ScanResult& before) {
        worked.clear();
        return runScanJob(job, listen, &before);
    };
    const ScanResult whole = next(first);
    EXPECT_EQ(worked, (std::set{S::surface, S::place, S::decimate, S::check}));
    EXPECT_EQ(whole.region, first.region);
    ASSERT_EQ(whole.cases.size(), 1u);
    EXPECT_GT(whole.placed.confidence, 0.7);

    job.percents = {25, 100};
    const ScanResult finer = next(whole);
    EXPECT_EQ(worked, (std::set{S::decimate, S::check}));
    ASSERT_EQ(finer.cases.size(), 2u);
    EXPECT_EQ(finer.cases[0].toothCase.name, "scanned tooth (25 %)");

    job.placing.occlusal = -Vec3::UnitZ();
    const ScanResult turned = next(finer);
    EXPECT_EQ(worked, (std::set{S::place, S::decimate, S::check}));
    EXPECT_LT(turned.cases[1].toothCase.outer.vertices[0].z() * finer.cases[1].toothCase.outer.vertices[0].z(), 0.0);

    job.segmentation.lesions = {{Vec3(5.5, 5.0, 12.0), Vec3::Constant(0.8)}};
    const ScanResult decayed = next(turned);
    EXPECT_EQ(worked, (std::set{S::segment, S::surface, S::place, S::decimate, S::check}));
    EXPECT_EQ(decayed.scan, first.scan);
    EXPECT_GT(decayed.volumesMm3[static_cast<std::size_t>(cases::Tissue::caries)], 0.5);
    EXPECT_EQ(decayed.cases[1].toothCase.parts.back().name, "caries (authored)");

    // A new start gives the same as the way there.
    const ScanResult fresh = runScanJob(job);
    for (std::size_t i = 0; i < 2; ++i)
        EXPECT_EQ(cases::contentKey(fresh.cases[i].toothCase), cases::contentKey(decayed.cases[i].toothCase));

    // And what is written is what was made; a place that cannot be written leaves none of them.
    EXPECT_THAT(writeScanCases(fresh, folder.path() / "c"),
                ::testing::ElementsAre(folder.path() / "c-25", folder.path() / "c-100"));
    core::writeFile(folder.path() / "d-100", std::string_view("in the way"));
    EXPECT_NE(errorOf([&] { (void)writeScanCases(fresh, folder.path() / "d"); }), "");
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "d-25"));

    EXPECT_EQ(errorOf([&] { (void)runScanJob(job, [](S stage, double) { return stage != S::surface; }); }),
              "cancelled");
}

// Whatever stage was at fault, no case is made that "case check" would refuse.
TEST(ScanRun, RefusesACaseThatItsOwnCheckRefuses) {
    const test::TemporaryFolder folder;
    volume::writeLabels(simpleTooth(), folder.path() / "labels.nrrd");
    ScanJob job;
    job.source = folder.path() / "labels.nrrd";
    job.isLabels = true;
    ScanResult before = runScanJob(job, {}, nullptr, ScanStage::place);
    auto bad = std::make_shared<surfacing::Surfaces>(*before.full);
    for (surfacing::Surface& tissue : bad->tissues)
        if (tissue.tissue == cases::Tissue::dentine)
            for (Vec3& p : tissue.mesh.vertices)
                p.x() += 0.6;
    before.full = bad;
    const std::string told = errorOf([&] { (void)runScanJob(job, {}, &before); });
    EXPECT_THAT(told, HasSubstr("dentine: it sticks out of the outer surface by 0."));
    EXPECT_EQ(runScanJob(job, {}, &before, ScanStage::decimate).cases.size(), 1u);  // for the surfaces alone
}

// A carious molar at 34 um, on a grid that keeps this short; its decay is a comb of voxels.
TEST(ScanRun, ARealMolarPassesItsOwnCheckAtAnyPercentage) {
    const std::filesystem::path data = test::realDataFolder();
    if (data.empty()) GTEST_SKIP() << "no real data beside this checkout (../shared/data)";
    ScanJob job;
    job.source = data / "molar-caries/molar_labels_34um_cropped.nrrd";
    job.isLabels = true;
    job.segmentation.spacingMm = 0.08;
    job.percents = {100, 10};
    const ScanResult made = runScanJob(job);
    EXPECT_EQ(made.cases.size(), job.percents.size());
    EXPECT_THAT(made.notes(), ::testing::Contains(HasSubstr("wider than a voxel")));
}

// Fine voxels: as many faces as the field can use, and the result says so.
TEST(ScanRun, KeepsTheFacesThatAFieldCanUse) {
    const test::TemporaryFolder folder;
    volume::Labels ball;
    ball.grid.size = {64, 64, 64};
    ball.grid.spacingMm = Vec3::Constant(0.03);
    ball.values.assign(ball.grid.count(), 0);
    for (int k = 0; k < 64; ++k)
        for (int j = 0; j < 64; ++j)
            for (int i = 0; i < 64; ++i)
                if ((Vec3(i, j, k) - Vec3(31.6, 31.4, 31.7)).norm() < 28.0)
                    ball.values[ball.grid.index(i, j, k)] = k > 40 ? 2 : 3;
    volume::writeLabels(ball, folder.path() / "labels.nrrd");
    ScanJob job;
    job.source = folder.path() / "labels.nrrd";
    job.isLabels = true;
    const ScanResult made = runScanJob(job);
    ASSERT_EQ(made.cases.size(), 1u);
    EXPECT_GT(made.cases[0].percent, 4.0);
    EXPECT_LT(made.cases[0].percent, 15.0);
    EXPECT_THAT(made.notes(), ::testing::Contains(HasSubstr("are kept")));
    job.percents = {100.0};
    const ScanResult all = runScanJob(job, {}, &made);
    EXPECT_EQ(all.cases[0].surfaces->outer.mesh.triangles.size(), made.full->outer.mesh.triangles.size());
    EXPECT_THAT(all.notes(), ::testing::Not(::testing::Contains(HasSubstr("are kept"))));
}

}  // namespace
}  // namespace handpiece::scan_case::scan_job_test
