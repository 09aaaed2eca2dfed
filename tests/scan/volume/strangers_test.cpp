// SPDX-License-Identifier: Apache-2.0
// Scans as people have them: bright and dark turned over, uneven slices, too large for the memory, sizes told by
// densities and logs, inks, names that are no UTF-8.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <jpeglib.h>
#include <tiffio.h>
#include <zlib.h>
#include <cstdio>

#include "scan_support.h"

namespace handpiece::volume::strangers_test {
namespace {

namespace fs = std::filesystem;
using test::DicomMaker;
using test::dicomSeries;
using test::errorOf;
using test::writeSeries;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class Strangers : public testing::Test {
  protected:
    test::TemporaryFolder temporary_;
    fs::path folder_ = temporary_.path() / "scan";

    void SetUp() override { fs::create_directories(folder_); }
    [[nodiscard]] std::string error(const ReadSettings& settings = {}) const {
        return errorOf([&] { (void)readScan(folder_, settings); });
    }
    void anew() {
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
};

// ---- DICOM

TEST_F(Strangers, LowValuesThatAreBrightAreTurnedOver) {
    // A bright block in dark surroundings, stored upside down; then one whose values rise with density all the same.
    for (const bool isUpsideDown : {true, false})
        for (const int isSigned : {0, 1}) {
            anew();
            for (int k = 0; k < 4; ++k) {
                DicomMaker d;
                d.columns = d.rows = 12;
                d.photometric = "MONOCHROME1";
                d.isSigned = isSigned;
                d.stored = 12;
                d.slope = "2";
                d.intercept = "-7";
                d.position = "0\\0\\" + std::to_string(k);
                const int ends = isSigned ? -1 : 4095;
                for (int n = 0; n < 144; ++n) {
                    const int value = n / 12 > 3 && n / 12 < 8 && n % 12 > 3 && n % 12 < 8 ? 1000 + n : 20 + k;
                    d.pixels.push_back(static_cast<std::int16_t>(isUpsideDown ? ends - value : value));
                }
                test::writeBytes(folder_ / ("IM" + std::to_string(k)), d.bytes());
            }
            const Scan scan = readScan(folder_);
            const auto at = [&](int i, int j, int k) { return scan.volume.values[scan.volume.grid.index(i, j, k)]; };
            EXPECT_EQ(at(5, 5, 2), 2.0f * 1065 - 7) << isUpsideDown << isSigned;
            EXPECT_EQ(at(0, 0, 3), 2.0f * 23 - 7) << isUpsideDown << isSigned;
            EXPECT_THAT(scan.series.notes, Contains(HasSubstr(isUpsideDown ? "turned over" : "left as they are")));
            EXPECT_EQ(findSeries(folder_)[0].notes, scan.series.notes);
            test::cutFile(folder_ / "IM2", 0.9);
            EXPECT_THAT(error(), AllOf(HasSubstr("truncated"), HasSubstr("IM2")));
        }
}

/// Slices at these places; the value is a straight function of the place, which linear resampling keeps.
void writeAt(const std::vector<double>& places, const fs::path& folder, double shear = 0.0) {
    for (std::size_t n = 0; n < places.size(); ++n) {
        DicomMaker d;
        d.position = "-3\\" + std::to_string(4 + shear * places[n]) + "\\" + std::to_string(places[n]);
        d.instance = std::to_string(n + 1);
        for (int j = 0; j < d.rows; ++j)
            for (int i = 0; i < d.columns; ++i)
                d.pixels.push_back(static_cast<std::int16_t>(std::lround(1000 * places[n]) + 10 * j + i));
        test::writeBytes(folder / ("IM" + std::to_string(n + 1)), d.bytes());
    }
}
void expectStraight(const Volume& v) {
    for (int k = 0; k < v.grid.size[2]; ++k)
        for (int j = 0; j < 6; ++j)
            for (int i = 0; i < 5; ++i) {
                const core::Vec3 p = v.grid.toMm(core::Vec3(i, j, k));
                ASSERT_NEAR(v.values[v.grid.index(i, j, k)], 1000 * p.z() + 10 * j + i, 0.6) << i << j << k;
            }
}

TEST_F(Strangers, UnevenSlicesAreResampledAndTheWidestGapIsTold) {
    struct Case {
        std::vector<double> places;
        int made;
        double mm;
        std::string told;
    };
    for (const Case& one : {Case{{0, 1, 2, 3, 6, 9, 12}, 13, 1.0, "1 to 3 mm apart, the widest gap behind slice 4"},
                            Case{{0, 1, 2, 3.4, 4, 5}, 9, 0.625, "0.6 to 1.4 mm apart, the widest gap behind slice 3"},
                            Case{{0, 0.9, 1.8, 2.7, 3.8, 4.9, 6.0}, 8, 6.0 / 7, "0.9 to 1.1 mm"},
                            Case{{0, 1, 2, 3, 4, 5, 6, 8.6}, 10, 8.6 / 9, "the widest gap behind slice 7"}}) {
        anew();
        writeAt(one.places, folder_);
        const Scan scan = readScan(folder_);
        EXPECT_EQ(scan.volume.grid.size, (std::array{5, 6, one.made})) << one.told;
        EXPECT_NEAR(scan.volume.grid.spacingMm.z(), one.mm, 1e-9) << one.told;
        EXPECT_THAT(scan.series.notes, Contains(HasSubstr(one.told)));
        EXPECT_EQ(scan.series.slices, one.made);
        expectStraight(scan.volume);
        EXPECT_EQ(findSeries(folder_)[0].slices, one.made);
        test::cutFile(folder_ / "IM2", 0.95);
        EXPECT_THAT(error(), AllOf(HasSubstr("truncated"), HasSubstr("IM2")));
    }
    // A hole is none of it, nor a gap that is absurd; within a tenth nothing is made.
    anew();
    writeAt({0, 1, 2, 3, 9, 10, 11}, folder_);
    EXPECT_THAT(error(), HasSubstr("its distance to"));
    writeAt({0, 1, 2, 3, 4.04, 5, 6}, folder_);
    EXPECT_THAT(readScan(folder_).series.notes, Not(Contains(HasSubstr("apart"))));
    // Numbers that go on over the gap say that nothing is missing; those that leap with it say that something is.
    writeAt({0, 1, 2, 3, 5, 6, 7}, folder_);
    EXPECT_EQ(readScan(folder_).volume.grid.size[2], 8);
    writeAt({0, 1, 2, 3, 4, 5, 6, 7}, folder_);
    fs::remove(folder_ / "IM5");
    EXPECT_THAT(error(), HasSubstr("1 slice is missing"));
    // Obliquely over each other, and unevenly.
    anew();
    writeAt({0, 1, 2, 4, 6, 8}, folder_, 0.02);
    EXPECT_EQ(readScan(folder_).volume.grid.size[2], 9);
}

TEST_F(Strangers, UnevenFramesOfOneFileAreReadInOrder) {
    DicomMaker d;
    d.frames = 5;
    d.enhanced = d.element(0x3004, 0xc, "DS", "0\\1\\2\\4\\6");
    for (const int z : {0, 1, 2, 4, 6})
        for (int n = 0; n < 30; ++n)
            d.pixels.push_back(static_cast<std::int16_t>(1000 * z + n / 5 * 10 + n % 5));
    test::writeBytes(folder_ / "frames.dcm", d.bytes());
    const Scan scan = readScan(folder_);
    ASSERT_EQ(scan.volume.grid.size[2], 7);
    expectStraight(scan.volume);
    ReadSettings settings;
    settings.isLabels = true;
    EXPECT_THAT(error(settings), HasSubstr("unevenly"));
}

TEST_F(Strangers, AnOrientationThatWobblesIsOneSeries) {
    auto series = dicomSeries(9);
    for (std::size_t k = 0; k < series.size(); ++k)
        series[k].orientation = k % 2 == 0 ? "1\\0\\0\\0\\1\\0" : "0.999998\\0\\0.002\\0\\1\\0";
    writeSeries(series, folder_);
    const std::vector<Series> found = findSeries(folder_);
    ASSERT_EQ(found.size(), 1u);
    const Scan scan = readScan(folder_);
    EXPECT_EQ(scan.volume.grid.size[2], 9);
    EXPECT_NEAR(scan.volume.grid.spacingMm.z(), 1.0, 1e-4);
    EXPECT_THAT(scan.series.notes, Contains(HasSubstr("their mean was taken")));
    EXPECT_EQ(scan.volume.values[scan.volume.grid.index(2, 3, 7)], 732.0f);
    // Another direction is another series still.
    for (std::size_t k = 0; k < 4; ++k)
        series[k].orientation = "0.9848\\0.1736\\0\\-0.1736\\0.9848\\0";
    writeSeries(series, folder_);
    EXPECT_EQ(findSeries(folder_).size(), 2u);
}

// ---- too large

TEST_F(Strangers, WhatIsTooLargeIsReadAtHalfItsSize) {
    Volume whole = test::sampleVolume({40, 36, 34});
    whole.grid.axes = test::obliqueAxes();
    const auto mean = [&](int i, int j, int k, int by) {
        double sum = 0.0;
        for (int c = 0; c < by; ++c)
            for (int b = 0; b < by; ++b)
                for (int a = 0; a < by; ++a)
                    sum += static_cast<double>(whole.values[whole.grid.index(by * i + a, by * j + b, by * k + c)]);
        return static_cast<float>(sum / (by * by * by));
    };
    for (const ScanFormat format : {ScanFormat::dicom, ScanFormat::nrrd, ScanFormat::tiff}) {
        anew();
        writeScan(whole, folder_, format);
        ReadSettings settings;
        settings.limitBytes = whole.grid.count() * sizeof(float) - 1;
        const Scan half = readScan(folder_, settings);
        ASSERT_EQ(half.volume.grid.size, (std::array{20, 18, 17}));
        EXPECT_TRUE(half.volume.grid.spacingMm.isApprox(2.0 * whole.grid.spacingMm, 1e-6));
        EXPECT_TRUE(half.volume.grid.originMm.isApprox(whole.grid.toMm({0.5, 0.5, 0.5}), 1e-6));
        EXPECT_THAT(half.series.notes, Contains(AllOf(HasSubstr("GB of memory"), HasSubstr("half of its size"))));
        EXPECT_EQ(half.series.size, half.volume.grid.size);
        for (int k = 0; k < 17; ++k)
            for (int j = 0; j < 18; ++j)
                for (int i = 0; i < 20; ++i)
                    ASSERT_EQ(half.volume.values[half.volume.grid.index(i, j, k)], mean(i, j, k, 2));
        // From the other end as well, and what is too large even so is refused.
        settings.reverseSlices = true;
        const Scan turned = readScan(folder_, settings);
        EXPECT_EQ(turned.volume.values[turned.volume.grid.index(3, 4, 0)], mean(3, 4, 16, 2));
        settings.limitBytes = 20 * 18 * 17 * sizeof(float) - 1;
        EXPECT_THAT(error(settings), HasSubstr("GB of memory"));
    }
    // A damaged one is not told to be too large alone.
    test::cutFile(folder_ / "slice_0003.tif", 0.5);
    EXPECT_NE(error(), "");
}

TEST_F(Strangers, AQuarterIsTheLeast) {
    const Volume whole = test::sampleVolume({70, 66, 67});
    writeScan(whole, folder_, ScanFormat::nrrd);
    ReadSettings settings;
    settings.limitBytes = 20 * 18 * 17 * sizeof(float);
    const Scan quarter = readScan(folder_, settings);
    EXPECT_EQ(quarter.volume.grid.size, (std::array{17, 16, 16}));
    EXPECT_THAT(quarter.series.notes, Contains(HasSubstr("a quarter of its size")));
    EXPECT_TRUE(quarter.volume.grid.originMm.isApprox(whole.grid.toMm({1.5, 1.5, 1.5})));
    test::cutFile(folder_ / "scan.nrrd", 0.7);
    EXPECT_THAT(error(settings), HasSubstr("GB of memory"));
    EXPECT_THAT(error(), HasSubstr("truncated"));
}

TEST_F(Strangers, LabelsAreNeverAveraged) {
    Labels labels;
    labels.grid.size = {40, 36, 34};
    labels.values.assign(labels.grid.count(), 0);
    std::mt19937_64 generator(test::seed());
    for (std::uint8_t& v : labels.values)
        v = static_cast<std::uint8_t>(2 * (generator() % 4));
    writeLabels(labels, folder_ / "labels.nrrd");
    ReadSettings settings;
    settings.isLabels = true;
    settings.limitBytes = labels.grid.count() * sizeof(float) - 1;
    const Scan half = readScan(folder_, settings);
    ASSERT_EQ(half.volume.grid.size, (std::array{20, 18, 17}));
    for (int k = 0; k < 17; ++k)
        for (int j = 0; j < 18; ++j)
            for (int i = 0; i < 20; ++i) {
                std::array<int, 7> count{};
                for (int n = 0; n < 8; ++n)
                    ++count[labels.values[labels.grid.index(2 * i + (n & 1), 2 * j + (n >> 1 & 1), 2 * k + (n >> 2))]];
                const auto best = std::max_element(count.begin(), count.end()) - count.begin();
                ASSERT_EQ(half.volume.values[half.volume.grid.index(i, j, k)], static_cast<float>(best));
            }
}

TEST_F(Strangers, ARegionIsReadAlone) {
    Volume whole = test::sampleVolume({40, 36, 34});
    for (const ScanFormat format : {ScanFormat::dicom, ScanFormat::nrrd})
        for (const bool isReversed : {false, true}) {
            anew();
            writeScan(whole, folder_, format);
            ReadSettings settings;
            settings.reverseSlices = isReversed;
            const Volume all = readScan(folder_, settings).volume;
            // Corners in any order, between voxels.
            const core::Vec3 a = whole.grid.toMm({6.5, 20.2, 9.5}), b = whole.grid.toMm({18.5, 4.5, 3.5});
            settings.regionMm = std::array{a, b};
            settings.limitBytes = 14 * 18 * 8 * sizeof(float);  // more than that is not taken
            const Scan part = readScan(folder_, settings);
            ASSERT_EQ(part.volume.grid.size, (std::array{14, 18, 8}));
            EXPECT_TRUE(part.volume.grid.originMm.isApprox(whole.grid.toMm({6, 4, 3}), 1e-6));
            EXPECT_THAT(part.series.notes, Not(Contains(HasSubstr("memory"))));
            for (int k = 0; k < 8; ++k)
                for (int j = 0; j < 18; ++j)
                    for (int i = 0; i < 14; ++i)
                        ASSERT_EQ(part.volume.values[part.volume.grid.index(i, j, k)],
                                  all.values[all.grid.index(6 + i, 4 + j, 3 + k)]);
            settings.regionMm = std::array{core::Vec3(900, 900, 900), core::Vec3(901, 901, 901)};
            EXPECT_THAT(error(settings),
                        AllOf(HasSubstr("nothing of the scan lies in the region"), HasSubstr("-12.5")));
            settings.regionMm = std::array{core::Vec3(NAN, 0, 0), core::Vec3(1, 1, 1)};
            EXPECT_THAT(error(settings), HasSubstr("no number"));
        }
}

// ---- how large a voxel is

std::string withDensity(ScanFormat format, std::string bytes, double perMetre) {
    const auto big = [](std::uint32_t v, int count) {
        std::string out;
        for (int i = count - 1; i >= 0; --i)
            out += static_cast<char>(v >> 8 * i & 0xff);
        return out;
    };
    if (format == ScanFormat::jpeg) {
        const auto perCm = static_cast<std::uint32_t>(std::lround(perMetre / 100));
        return bytes.replace(13, 5, std::string("\2") + big(perCm, 2) + big(perCm, 2));
    }
    const auto whole = static_cast<std::uint32_t>(std::lround(perMetre));
    const std::string chunk = "pHYs" + big(whole, 4) + big(whole, 4) + "\1";
    const auto sum = static_cast<std::uint32_t>(
        crc32(0, reinterpret_cast<const Bytef*>(chunk.data()), static_cast<uInt>(chunk.size())));
    return bytes.insert(33, big(9, 4) + chunk + big(sum, 4));
}

TEST_F(Strangers, SizesAreTakenFromDensitiesThatNoPrinterHas) {
    Volume scan = test::sampleVolume({23, 17, 5});
    scan.grid.spacingMm = core::Vec3::Constant(0.05);
    for (const ScanFormat format : {ScanFormat::png, ScanFormat::jpeg, ScanFormat::tiff}) {
        const auto written = [&](double mm) {
            anew();
            Volume one = scan;
            one.grid.spacingMm = core::Vec3::Constant(mm);
            writeScan(one, folder_, format);
            fs::remove(folder_ / "scan.toml");
            if (format != ScanFormat::tiff)
                for (const auto& e : fs::directory_iterator(folder_))
                    test::writeBytes(e.path(), withDensity(format, test::readBytes(e.path()), 1000.0 / mm));
        };
        written(0.05);
        const Scan read = readScan(folder_);
        EXPECT_TRUE(read.volume.grid.spacingMm.isApprox(core::Vec3::Constant(0.05), 1e-6));
        EXPECT_THAT(read.series.notes, Contains(AllOf(HasSubstr("0.05 mm"), HasSubstr("density"))));
        EXPECT_TRUE(findSeries(folder_)[0].isSpacingKnown);
        ReadSettings settings;
        settings.spacingMm = core::Vec3(0.1, 0.1, 0.2);
        EXPECT_EQ(readScan(folder_, settings).volume.grid.spacingMm, *settings.spacingMm);
        // 72, 96 and 300 dots an inch, and what no scanner has.
        for (const double mm : {25.4 / 72, 25.4 / 96, 25.4 / 300, 5.0}) {
            written(mm);
            EXPECT_FALSE(findSeries(folder_)[0].isSpacingKnown) << mm;
            EXPECT_THAT(error(), HasSubstr("give the spacing")) << mm;
        }
        // One of them says otherwise.
        written(0.1);
        const fs::path odd = fs::directory_iterator(folder_)->path();
        const std::string other = test::readBytes(odd);
        written(0.05);
        test::writeBytes(odd, other);
        EXPECT_THAT(error(), HasSubstr("give the spacing"));
        written(0.05);
        test::cutFile(odd, 0.5);
        EXPECT_THAT(error(), HasSubstr("damaged"));
    }
}

TEST_F(Strangers, SizesAreTakenFromSkyscansLog) {
    const std::string acquisition =
                          "[System]\r\nScanner=Skyscan1172\r\n[Acquisition]\r\nImage Pixel Size (um)=    8.71\r\n",
                      whole = acquisition + "[Reconstruction]\r\nPixel Size (um)=17.42000\r\n";
    writeScan(test::sampleVolume(), folder_, ScanFormat::bmp);
    fs::remove(folder_ / "scan.toml");
    for (const auto& e : fs::directory_iterator(folder_))
        fs::rename(e.path(), folder_ / ("tooth_rec" + e.path().filename().string().substr(6)));
    const auto spacing = [&] { return findSeries(folder_)[0].spacingMm; };
    test::writeBytes(folder_ / "tooth_rec.log", whole);
    EXPECT_TRUE(readScan(folder_).volume.grid.spacingMm.isApprox(core::Vec3::Constant(0.01742)));
    EXPECT_THAT(readScan(folder_).series.notes, Contains(AllOf(HasSubstr("0.01742 mm"), HasSubstr("log"))));
    // Only the scanner's own; its name counts before that of others.
    test::writeBytes(folder_ / "tooth_rec.log", acquisition);
    EXPECT_TRUE(spacing().isApprox(core::Vec3::Constant(0.00871)));
    test::writeBytes(folder_ / "tooth.log", "Image Pixel Size (um)=5\n");
    test::writeBytes(folder_ / "another.log", "Image Pixel Size (um)=6\n");
    EXPECT_TRUE(spacing().isApprox(core::Vec3::Constant(0.00871)));
    fs::remove(folder_ / "tooth_rec.log");
    EXPECT_TRUE(spacing().isApprox(core::Vec3::Constant(0.005)));
    // Strangers' logs that disagree, that tell nothing, or are cut off anywhere, tell nothing.
    fs::rename(folder_ / "tooth.log", folder_ / "b.log");
    EXPECT_FALSE(findSeries(folder_)[0].isSpacingKnown);
    fs::remove(folder_ / "b.log");
    for (const char* wrong : {"", "Image Pixel Size (um)", "Image Pixel Size (um)=", "Image Pixel Size (um)=0\n",
                              "Image Pixel Size (um)=nan\n", "Image Pixel Size (um)=-3\n", "Pixel Size = 3\n"}) {
        test::writeBytes(folder_ / "another.log", wrong);
        EXPECT_FALSE(findSeries(folder_)[0].isSpacingKnown) << wrong;
        EXPECT_THAT(error(), HasSubstr("give the spacing")) << wrong;
    }
    for (std::size_t n = 0; n < whole.size(); ++n) {
        test::writeBytes(folder_ / "another.log", whole.substr(0, n));
        (void)error();
    }
    // A description beside them wins over everything.
    test::writeBytes(folder_ / "another.log", whole);
    test::writeBytes(folder_ / "scan.toml", "spacing_mm = [0.3, 0.3, 0.4]\n");
    EXPECT_EQ(spacing(), core::Vec3(0.3, 0.3, 0.4));
}

TEST_F(Strangers, NReconMayHaveWrittenEverySecondSlice) {
    struct Case {
        int step, gap;
        double mm;
        std::string told;
    };
    for (const Case& one :
         {Case{1, 1, 0.02, "the size of a voxel, 0.02 mm"}, Case{2, 1, 0.04, "2 pixels (0.04 mm) apart by this log"},
          Case{1, 2, 0.04, "2 pixels (0.04 mm) apart by their numbers"},
          Case{2, 2, 0.04, "2 pixels (0.04 mm) apart by this log"},
          Case{2, 6, 0.12, "6 pixels (0.12 mm) apart by this log"}, Case{4, 2, 0.0, "do not fit each other"},
          Case{0, 1, 0.0, "do not fit each other"}}) {
        anew();
        writeScan(test::sampleVolume({9, 8, 7}), folder_, ScanFormat::bmp);
        fs::remove(folder_ / "scan.toml");
        std::vector<fs::path> slices;
        for (const auto& e : fs::directory_iterator(folder_))
            slices.push_back(e.path());
        ASSERT_EQ(slices.size(), 7u);
        for (int k = 0; k < 7; ++k)
            fs::rename(slices[static_cast<std::size_t>(k)],
                       folder_ / ("tooth_rec" + std::to_string(1010 + k * one.gap) + ".bmp"));
        test::writeBytes(folder_ / "tooth_rec.log",
                         "[Acquisition]\r\nImage Pixel Size (um)=10\r\n[Reconstruction]\r\n"
                         "Section to Section Step=" +
                             std::to_string(one.step) + "\r\nPixel Size (um)=20\r\n");
        const Series series = findSeries(folder_)[0];
        EXPECT_EQ(series.isSpacingKnown, one.mm > 0.0) << one.told;
        const core::Vec3 mm = one.mm > 0.0 ? core::Vec3(0.02, 0.02, one.mm) : core::Vec3(0, 0, 0);
        EXPECT_TRUE(series.spacingMm.isApprox(mm)) << one.told;
        EXPECT_THAT(series.notes, Contains(HasSubstr(one.told)));
    }
}

// ---- inks

constexpr std::array<std::array<int, 4>, 4> kInks{
    {{0, 0, 0, 0}, {255, 255, 255, 255}, {0, 0, 0, 128}, {200, 10, 60, 30}}};
int greyOf(const std::array<int, 4>& inks) {
    const auto left = [&](int n) { return (255 - inks[static_cast<std::size_t>(n)]) * (255 - inks[3]) / 255.0; };
    return static_cast<int>(std::lround(0.299 * left(0) + 0.587 * left(1) + 0.114 * left(2)));
}

TEST_F(Strangers, JpegOfInksIsReadAsGrey) {
    // As Adobe's programs write them: upside down, with their marker.
    constexpr int kSide = 32;
    std::vector<unsigned char> pixels;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
            for (const int ink : kInks[static_cast<std::size_t>(2 * (y / 16) + x / 16)])
                pixels.push_back(static_cast<unsigned char>(255 - ink));
    jpeg_compress_struct state{};
    jpeg_error_mgr problem{};
    state.err = jpeg_std_error(&problem);
    jpeg_create_compress(&state);
    unsigned char* data = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&state, &data, &size);
    state.image_width = state.image_height = kSide;
    state.input_components = 4;
    state.in_color_space = JCS_CMYK;
    jpeg_set_defaults(&state);
    jpeg_set_quality(&state, 100, TRUE);
    jpeg_start_compress(&state, TRUE);
    for (int y = 0; y < kSide; ++y) {
        JSAMPROW line = pixels.data() + 4 * kSide * y;
        jpeg_write_scanlines(&state, &line, 1);
    }
    jpeg_finish_compress(&state);
    const std::string bytes(reinterpret_cast<char*>(data), size);
    jpeg_destroy_compress(&state);
    std::free(data);
    for (const char* name : {"s1.jpg", "s2.jpg"})
        test::writeBytes(folder_ / name, bytes);
    ReadSettings settings;
    settings.spacingMm = core::Vec3::Ones();
    const Scan scan = readScan(folder_, settings);
    for (int part = 0; part < 4; ++part)
        EXPECT_NEAR(scan.volume.values[scan.volume.grid.index(16 * (part % 2) + 8, 16 * (part / 2) + 8, 1)],
                    greyOf(kInks[static_cast<std::size_t>(part)]), 2)
            << part;
    EXPECT_THAT(scan.series.notes, Contains(HasSubstr("turned to grey")));
    test::cutFile(folder_ / "s2.jpg", 0.6);
    EXPECT_THAT(error(settings), AllOf(HasSubstr("s2.jpg"), HasSubstr("damaged")));
}

TEST_F(Strangers, TiffOfInksIsReadAsGreyAndOtherColoursAreRefused) {
    const auto written = [&](int photometric, int inkSet, int samples) {
        for (const char* name : {"s1.tif", "s2.tif", "s3.tif"}) {
            TIFF* tiff = TIFFOpen((folder_ / name).c_str(), "w");
            TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 4);
            TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 3);
            TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
            TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, samples);
            TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, photometric);
            TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
            if (inkSet > 0) TIFFSetField(tiff, TIFFTAG_INKSET, inkSet);
            std::vector<std::uint8_t> line;
            for (const auto& inks : kInks)
                for (int n = 0; n < samples; ++n)
                    line.push_back(static_cast<std::uint8_t>(inks[static_cast<std::size_t>(n)]));
            for (std::uint32_t y = 0; y < 3; ++y)
                TIFFWriteScanline(tiff, line.data(), y, 0);
            TIFFClose(tiff);
        }
    };
    ReadSettings settings;
    settings.spacingMm = core::Vec3::Ones();
    written(PHOTOMETRIC_SEPARATED, 0, 4);
    const Volume v = readScan(folder_, settings).volume;
    for (int i = 0; i < 4; ++i)
        EXPECT_NEAR(v.values[v.grid.index(i, 1, 1)], greyOf(kInks[static_cast<std::size_t>(i)]), 1) << i;
    test::cutFile(folder_ / "s2.tif", 0.1);
    EXPECT_THAT(error(settings), HasSubstr("s2.tif"));
    written(PHOTOMETRIC_SEPARATED, INKSET_MULTIINK, 4);
    EXPECT_THAT(error(settings), HasSubstr("inks other than cyan"));
    written(PHOTOMETRIC_CIELAB, 0, 3);
    EXPECT_THAT(error(settings), HasSubstr("CIE L*a*b*"));
    written(PHOTOMETRIC_RGB, 0, 3);
    EXPECT_EQ(error(settings), "");
}

// ---- names

TEST_F(Strangers, NamesThatAreNoUtf8AreReadAsOthers) {
    const fs::path odd = temporary_.path() / "caf\xe9 \xff";
    const Volume scan = test::sampleVolume();
    for (const ScanFormat format : {ScanFormat::dicom, ScanFormat::png, ScanFormat::nrrd}) {
        fs::remove_all(odd);
        writeScan(scan, odd, format);
        for (const auto& e : fs::directory_iterator(odd))
            if (const std::string name = e.path().filename().string(); name != "scan.toml")
                fs::rename(e.path(), odd / ("z\xe4hn" + name));
        EXPECT_EQ(readScan(odd).volume.values, scan.values);
        // What is said of them is text.
        test::writeBytes(odd / "broken\xe9.nrrd", "NRRD0004\n");
        const std::vector<Series> found = findSeries(odd);
        for (const std::string& note : found[0].notes)
            for (const char c : note)
                EXPECT_TRUE(c >= 0x20 && c < 0x7f) << note;
    }
    EXPECT_THAT(errorOf([&] { (void)readScan(temporary_.path() / "no\xe9ne"); }), HasSubstr("no such file"));
}

}  // namespace
}  // namespace handpiece::volume::strangers_test
