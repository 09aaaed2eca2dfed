// SPDX-License-Identifier: Apache-2.0
// A starter tooth through the phantom scanner, and teeth that nobody here made.
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <fstream>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/scan/phantom/phantom.h"
#include "handpiece/scan/segmentation/label_key.h"
#include "scan/segmentation/balls.h"
#include "support/random.h"

namespace handpiece::segmentation::tooth_test {
namespace {

using cases::Tissue;
using test::volumeOf;

cases::Case incisor() {
    starter::ToothOptions options;
    options.faces = 20000;
    return starter::makeTooth(starter::ToothKind::upperIncisor, options);
}

/// Dice's coefficients of caries, enamel, dentine and pulp (labels 1 to 4) between a region and the phantom's truth.
std::array<double, 5> diceOf(const Region& region, const phantom::Image& image) {
    const volume::Labels found = labelsOf(region);
    std::array<double, 5> both{}, truth{}, ours{};
    for (const std::uint8_t label : found.values)
        if (label < 5) ours.at(label) += 1;
    for (int k = 0; k < image.truth.grid.size[2]; ++k)
        for (int j = 0; j < image.truth.grid.size[1]; ++j)
            for (int i = 0; i < image.truth.grid.size[0]; ++i) {
                const std::uint8_t label = image.truth.values[image.truth.grid.index(i, j, k)];
                if (label > 4) continue;
                truth.at(label) += 1;
                const core::Vec3 at = found.grid.toVoxels(image.truth.grid.toMm(core::Vec3(i, j, k)));
                bool isInside = true;
                for (int axis = 0; axis < 3; ++axis)
                    isInside =
                        isInside && at[axis] > -0.5 && at[axis] < found.grid.size[static_cast<std::size_t>(axis)] - 0.5;
                if (isInside && found.values[found.grid.index(static_cast<int>(std::lround(at.x())),
                                                              static_cast<int>(std::lround(at.y())),
                                                              static_cast<int>(std::lround(at.z())))] == label)
                    both.at(label) += 1;
            }
    std::array<double, 5> dice{};
    for (std::size_t label = 1; label < 5; ++label)
        dice.at(label) = 2 * both.at(label) / (truth.at(label) + ours.at(label));
    return dice;
}

// In a jaw, where the labels of a mouth say which tooth is which: bone and touching neighbours are not its.
TEST(PhantomTooth, ItsTissuesAreFoundWithinItsLabel) {
    phantom::Settings s;
    s.scanner = phantom::Scanner::cbct;
    s.voxelUm = 250;
    s.noise = 0.03;
    s.scenery = true;
    const phantom::Image image = phantom::image(incisor(), s);
    volume::Labels labels = image.truth;
    for (std::uint8_t& v : labels.values)
        v = v == 0 || v == 7 ? 0 : v <= 5 ? 11 : v == 6 ? 2 : v == phantom::kNeighbourLabel ? 12 : 0;
    const LabelKey key = labelKeyOf(labels, {}, {}, "labels");
    const std::vector<LabelledTooth> teeth = teethOf(labels, key);
    ASSERT_EQ(teeth.front().fdi, 11);
    const Region region =
        segmentWithin(image.volume, findThresholds(image.volume), labels, key, alone(labels, key, teeth.front()));
    const std::array<double, 5> dice = diceOf(region, image);
    EXPECT_GT(dice[2], 0.93);
    EXPECT_GT(dice[3], 0.96);
    EXPECT_GT(dice[4], 0.85);
    const auto volumes = volumesMm3(region);
    double whole = 0.0, truth = 0.0;
    for (std::size_t t = 0; t < volumes.size(); ++t) {
        whole += volumes.at(t);
        truth += image.volumesMm3.at(t);
    }
    EXPECT_NEAR(whole, truth, 0.03 * truth);
    for (const Tissue t : {Tissue::enamel, Tissue::dentine}) {
        const double was = image.volumesMm3.at(static_cast<std::size_t>(t));
        EXPECT_NEAR(volumes.at(static_cast<std::size_t>(t)), was, 0.06 * was);
    }
}

TEST(PhantomTooth, AnIncisorAt200MicrometresMeetsItsTruth) {
    const cases::Case toothCase = incisor();
    phantom::Settings s;
    s.voxelUm = 200;
    s.noise = 0.04;
    s.blurVoxels = 0.8;
    s.seed = test::seed();
    const phantom::Image image = phantom::image(toothCase, s);
    const Region region = segment(image.volume);
    const std::array<double, 5> dice = diceOf(region, image);
    EXPECT_GT(dice[2], 0.93);
    EXPECT_GT(dice[3], 0.95);
    EXPECT_GT(dice[4], 0.8);
    for (const Tissue tissue : {Tissue::enamel, Tissue::dentine, Tissue::pulp})
        EXPECT_NEAR(volumeOf(region, tissue) / image.volumesMm3[static_cast<std::size_t>(tissue)], 1, 0.03)
            << static_cast<int>(tissue);
}

TEST(PhantomTooth, AnIncisorInItsNoisyJawIsPartedFromNeighboursAndBone) {
    const cases::Case toothCase = incisor();
    phantom::Settings s;
    s.scanner = phantom::Scanner::cbct;
    s.voxelUm = 200;
    s.noise = 0.05;
    s.scenery = true;
    s.seed = test::seed();
    const phantom::Image image = phantom::image(toothCase, s);
    const Region region = segment(image.volume);
    // Noise hides dentine's peak in bone's; the outside is air all the same, and dentine is dentine.
    EXPECT_NEAR(region.thresholds.outside, phantom::greyOf(s.scanner, Tissue::none), 40);
    EXPECT_NEAR(region.thresholds.dentine, phantom::greyOf(s.scanner, Tissue::dentine), 40);
    EXPECT_NEAR(region.thresholds.enamel, phantom::greyOf(s.scanner, Tissue::enamel), 60);
    const std::array<double, 5> dice = diceOf(region, image);
    EXPECT_GT(dice[2], 0.95);
    EXPECT_GT(dice[3], 0.95);
    EXPECT_GT(dice[4], 0.85);
    EXPECT_NEAR(volumeOf(region, Tissue::enamel) / image.volumesMm3[static_cast<std::size_t>(Tissue::enamel)], 1, 0.04);
    EXPECT_NEAR(volumeOf(region, Tissue::dentine) / image.volumesMm3[static_cast<std::size_t>(Tissue::dentine)], 1,
                0.05);
}

TEST(RealTooth, TheIndustrialCtOfAMolarHasItsThreeTissues) {
    const std::filesystem::path folder = test::realDataFolder();
    if (folder.empty()) GTEST_SKIP() << "no real data beside this checkout (../shared/data)";
    const std::vector<std::byte> bytes = core::readFile(folder / "ge-tooth-ct" / "tooth_103x94x161_uint16_be.raw");
    volume::Volume v;
    v.grid.size = {103, 94, 161};
    v.grid.spacingMm = core::Vec3::Constant(0.133);
    v.values.resize(v.grid.count());
    ASSERT_EQ(bytes.size(), 2 * v.values.size());
    for (std::size_t n = 0; n < v.values.size(); ++n)
        v.values[n] =
            static_cast<float>(std::to_integer<int>(bytes[2 * n]) * 256 + std::to_integer<int>(bytes[2 * n + 1]));
    const Region region = segment(v);
    EXPECT_NEAR(region.thresholds.outside, 396, 30);
    EXPECT_NEAR(region.thresholds.dentine, 823, 30);
    EXPECT_NEAR(region.thresholds.enamel, 1187, 30);
    EXPECT_NEAR(region.thresholds.toothFrom, 614, 20);
    EXPECT_NEAR(region.thresholds.enamelFrom, 1014, 20);
    EXPECT_LT(region.thresholds.pulp, 200) << "darker than the outside";
    // Against voxels counted by the thresholds alone, which lose enamel's outer half voxel to blur.
    double enamel = 0, hard = 0;
    for (const float value : v.values) {
        enamel += value > 1014 ? v.grid.voxelMm3() : 0;
        hard += value > 614 ? v.grid.voxelMm3() : 0;
    }
    EXPECT_GT(volumeOf(region, Tissue::enamel), enamel);
    EXPECT_LT(volumeOf(region, Tissue::enamel), 1.25 * enamel);
    EXPECT_NEAR(
        (volumeOf(region, Tissue::enamel) + volumeOf(region, Tissue::dentine) + volumeOf(region, Tissue::caries)) /
            hard,
        1, 0.05);
    EXPECT_GT(volumeOf(region, Tissue::pulp), 20);
    EXPECT_LT(volumeOf(region, Tissue::pulp), 60);
    // Crown up, roots down.
    double crownZ = 0, enamelVoxels = 0;
    const volume::Labels labels = labelsOf(region);
    for (std::size_t n = 0; n < labels.values.size(); ++n)
        if (labels.values[n] == 2) crownZ += static_cast<double>(n / labels.grid.index(0, 0, 1)), enamelVoxels += 1;
    EXPECT_GT(crownZ / enamelVoxels, 0.6 * labels.grid.size[2]);
}

std::vector<std::uint8_t> nrrdBytes(const std::filesystem::path& file, std::size_t count) {
    std::ifstream in(file, std::ios::binary);
    std::string all((std::istreambuf_iterator<char>(in)), {});
    const std::size_t start = all.find("\n\n") + 2;
    std::vector<std::uint8_t> out(count);
    z_stream z{};
    if (inflateInit2(&z, 15 + 32) != Z_OK) return {};
    z.next_in = reinterpret_cast<Bytef*>(all.data() + start);
    z.avail_in = static_cast<uInt>(all.size() - start);
    z.next_out = out.data();
    z.avail_out = static_cast<uInt>(out.size());
    const int result = inflate(&z, Z_FINISH);
    inflateEnd(&z);
    return result == Z_STREAM_END ? out : std::vector<std::uint8_t>{};
}

TEST(RealTooth, TheCariousMolarsLabelsKeepTheirVolumesAndItsPulpIsFilled) {
    const std::filesystem::path folder = test::realDataFolder();
    if (folder.empty()) GTEST_SKIP() << "no real data beside this checkout (../shared/data)";
    volume::Labels labels;
    labels.grid.size = {534, 357, 355};
    labels.grid.spacingMm = core::Vec3::Constant(0.034);
    labels.values = nrrdBytes(folder / "molar-caries" / "molar_labels_34um_cropped.nrrd", labels.grid.count());
    ASSERT_EQ(labels.values.size(), labels.grid.count());
    Settings settings;
    settings.spacingMm = 0.1;
    const Region region = segmentLabels(labels, settings);
    std::array<double, 4> told{};
    for (const std::uint8_t label : labels.values)
        told.at(std::min<std::size_t>(label, 3)) += labels.grid.voxelMm3();
    EXPECT_NEAR(volumeOf(region, Tissue::enamel) / told[2], 1, 0.01);
    EXPECT_NEAR(volumeOf(region, Tissue::dentine) / told[3], 1, 0.01);
    EXPECT_NEAR(volumeOf(region, Tissue::caries) / told[1], 1, 0.12) << "rough at its edges: 0.1 mm hides some";
    EXPECT_GT(volumeOf(region, Tissue::pulp), 20);
    EXPECT_LT(volumeOf(region, Tissue::pulp), 30);
}

}  // namespace
}  // namespace handpiece::segmentation::tooth_test
