// SPDX-License-Identifier: Apache-2.0
// Scans that nobody here made (../shared/data): a tooth in big-endian raw numbers, a molar in NIfTI, jaws in NRRD.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan_support.h"

namespace handpiece::volume::real_data_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class RealScans : public testing::Test {
  protected:
    fs::path data_ = test::realDataFolder();
    test::TemporaryFolder temporary_;
    void SetUp() override {
        if (data_.empty()) GTEST_SKIP() << "no real data beside this checkout (../shared/data)";
    }
};

TEST_F(RealScans, GeToothAndItsByteOrder) {
    const fs::path raw = data_ / "ge-tooth-ct" / "tooth_103x94x161_uint16_be.raw";
    if (!fs::exists(raw)) GTEST_SKIP() << "no GE tooth there";
    fs::copy_file(raw, temporary_.path() / "tooth.raw");
    const std::string text =
        "file = \"tooth.raw\"\nsize = [103, 94, 161]\ntype = \"uint16\"\nspacing_mm = [0.133, 0.133, "
        "0.133]\nbyte_order = ";
    test::writeBytes(temporary_.path() / "scan.toml", text + "\"little\"\n");
    EXPECT_THAT(test::errorOf([&] { (void)readScan(temporary_.path()); }), HasSubstr("byte_order = \"big\""));
    test::writeBytes(temporary_.path() / "scan.toml", text + "\"big\"\n");
    const Scan scan = readScan(temporary_.path());
    // The same scan at 8 bits must be a monotonous image of it: rank correlation by the means of its levels.
    const Volume narrow = readScan(data_ / "ge-tooth-ct" / "tooth_103x94x161_uint8.nrrd",
                                   [] {
                                       ReadSettings settings;
                                       settings.spacingMm = core::Vec3::Constant(0.133);
                                       return settings;
                                   }())
                              .volume;
    ASSERT_EQ(narrow.values.size(), scan.volume.values.size());
    std::map<int, std::pair<double, double>> levels;
    for (std::size_t i = 0; i < narrow.values.size(); ++i) {
        auto& [sum, count] = levels[static_cast<int>(narrow.values[i])];
        sum += static_cast<double>(scan.volume.values[i]);
        count += 1.0;
    }
    EXPECT_GT(levels.size(), 100u);
    double last = -1.0;
    for (const auto& [level, mean] : levels) {
        EXPECT_GT(mean.first / mean.second, last) << level;
        last = mean.first / mean.second;
    }
}

TEST_F(RealScans, MolarLabelsAreTheSameInBothFormats) {
    const fs::path folder = data_ / "molar-caries";
    if (!fs::exists(folder)) GTEST_SKIP() << "no molar there";
    const Scan crop = readScan(folder / "molar_labels_34um_cropped.nrrd");
    EXPECT_NEAR(crop.volume.grid.spacingMm.x(), 0.034, 1e-9);
    const Labels labels = toLabels(crop.volume, "molar");
    std::array<std::size_t, 256> counts{};
    for (const std::uint8_t v : labels.values)
        ++counts[v];
    // mm3 as told by those who segmented it: decay 6.4, enamel 188, dentine 512.
    const double voxel = crop.volume.grid.voxelMm3();
    EXPECT_NEAR(static_cast<double>(counts[1]) * voxel, 6.4, 0.1);
    EXPECT_NEAR(static_cast<double>(counts[2]) * voxel, 188, 1);
    EXPECT_NEAR(static_cast<double>(counts[3]) * voxel, 512, 1);
    ReadSettings settings;
    settings.spacingMm = core::Vec3::Constant(0.034);
    const Scan whole = readScan(folder / "molar_labels_34um.nii.gz", settings);
    ASSERT_EQ(whole.volume.grid.size, (std::array{600, 600, 400}));
    std::array<std::size_t, 256> all{};
    for (const float v : whole.volume.values)
        ++all[static_cast<std::size_t>(v)];
    for (std::size_t label = 1; label < 4; ++label)
        EXPECT_EQ(all[label], counts[label]) << label;
}

TEST_F(RealScans, JawsHaveTheirSpacing) {
    const fs::path file = data_ / "head-ct" / "jaw_crop.nrrd";
    if (!fs::exists(file)) GTEST_SKIP() << "no jaws there";
    const Scan scan = readScan(file);
    EXPECT_EQ(scan.volume.grid.spacingMm, core::Vec3(1, 1, 2));
}

}  // namespace
}  // namespace handpiece::volume::real_data_test
