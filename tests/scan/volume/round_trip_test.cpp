// SPDX-License-Identifier: Apache-2.0
// What writeScan writes, readScan reads: values, spacing, place.
#include <gtest/gtest.h>

#include <set>

#include "handpiece/base/core/parallel.h"
#include "scan_support.h"

namespace handpiece::volume::round_trip_test {
namespace {

using test::difference;
using test::sampleVolume;

struct Format {
    const char* name;
    double error;       ///< of a value, in parts of the range
    double placeError;  ///< of spacing, origin and axes
};

class RoundTrip : public testing::TestWithParam<Format> {};

void expectSamePlace(const Grid& a, const Grid& b, double tolerance) {
    EXPECT_EQ(a.size, b.size);
    EXPECT_LE((a.spacingMm - b.spacingMm).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_LE((a.originMm - b.originMm).cwiseAbs().maxCoeff(), 40 * tolerance);
    EXPECT_LE((a.axes - b.axes).cwiseAbs().maxCoeff(), tolerance);
}

TEST_P(RoundTrip, KeepsValuesAndPlace) {
    for (const double low : {0.0, -1000.0})
        for (const bool isOblique : {false, true}) {
            const test::TemporaryFolder temporary;
            Volume scan = sampleVolume({23, 17, 9}, low);
            if (isOblique) scan.grid.axes = test::obliqueAxes();
            writeScan(scan, temporary.path() / "scan", scanFormatByName(GetParam().name));
            const Scan read = readScan(temporary.path() / "scan");
            const auto [least, most] = std::minmax_element(scan.values.begin(), scan.values.end());
            EXPECT_LE(difference(scan, read.volume), GetParam().error * static_cast<double>(*most - *least)) << low;
            expectSamePlace(scan.grid, read.volume.grid, GetParam().placeError);
            EXPECT_TRUE(read.series.isSpacingKnown);
            EXPECT_EQ(read.series.slices, 9);
        }
}

TEST_P(RoundTrip, SecondScanReplacesTheFirstAndTheBytesAreTheSameOnOneThread) {
    const test::TemporaryFolder temporary;
    const ScanFormat format = scanFormatByName(GetParam().name);
    writeScan(sampleVolume({23, 17, 12}), temporary.path() / "a", format);
    test::writeBytes(temporary.path() / "a" / "truth.nrrd.txt", "not ours");
    const Volume scan = sampleVolume();
    writeScan(scan, temporary.path() / "a", format);
    core::setThreadCount(1);
    writeScan(scan, temporary.path() / "b", format);
    const Scan one = readScan(temporary.path() / "a");
    core::setThreadCount(0);
    const Scan many = readScan(temporary.path() / "a");
    EXPECT_EQ(one.volume.values, many.volume.values);
    EXPECT_EQ(one.series.thumbnail, many.series.thumbnail);
    std::set<std::string> names;
    for (const auto& e : std::filesystem::directory_iterator(temporary.path() / "b")) {
        names.insert(e.path().filename().string());
        EXPECT_EQ(test::readBytes(e.path()), test::readBytes(temporary.path() / "a" / e.path().filename()));
    }
    for (const auto& e : std::filesystem::directory_iterator(temporary.path() / "a"))
        EXPECT_TRUE(names.count(e.path().filename().string()) == 1 || e.path().filename() == "truth.nrrd.txt")
            << e.path();
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip,
                         testing::Values(Format{"dicom", 0, 1e-9}, Format{"tiff", 0, 1e-12}, Format{"png", 0, 1e-12},
                                         Format{"bmp", 0.5 / 255 + 1e-6, 1e-12}, Format{"jpeg", 8.0 / 255, 1e-12},
                                         Format{"nrrd", 0, 1e-12}, Format{"raw", 0, 1e-12},
                                         Format{"metaimage", 0, 1e-12}, Format{"nifti", 0, 1e-6}),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(WriteScan, WideRangesAreScaledWhereTheFormatCanTell) {
    const test::TemporaryFolder temporary;
    const Volume scan = sampleVolume({23, 17, 9}, -50000, 200000);
    const auto [least, most] = std::minmax_element(scan.values.begin(), scan.values.end());
    const double step = static_cast<double>(*most - *least) / 65535.0;
    for (const char* name : {"dicom", "tiff", "png", "raw", "nifti"}) {
        writeScan(scan, temporary.path() / name, scanFormatByName(name));
        EXPECT_LE(difference(scan, readScan(temporary.path() / name).volume), 0.51 * step) << name;
    }
    EXPECT_NE(test::errorOf([&] { writeScan(scan, temporary.path() / "n", ScanFormat::nrrd); }).find("16 bits"),
              std::string::npos);
}

TEST(WriteScan, UnsignedValuesAbove32767StayInDicom) {
    const test::TemporaryFolder temporary;
    const Volume scan = sampleVolume({11, 7, 4}, 1000, 62000);
    writeScan(scan, temporary.path(), ScanFormat::dicom);
    EXPECT_EQ(readScan(temporary.path()).volume.values, scan.values);
}

TEST(WriteScan, RefusesWhatIsNoScanAndUnknownFormats) {
    const test::TemporaryFolder temporary;
    EXPECT_NE(test::errorOf([&] { writeScan({}, temporary.path() / "x", ScanFormat::raw); }), "");
    Volume scan = sampleVolume();
    scan.values[3] = NAN;
    EXPECT_NE(test::errorOf([&] { writeScan(scan, temporary.path() / "x", ScanFormat::raw); }), "");
    EXPECT_NE(test::errorOf([] { (void)scanFormatByName("xml"); }).find("metaimage"), std::string::npos);
}

TEST(WriteScan, CancelledLeavesNothing) {
    const test::TemporaryFolder temporary;
    for (const ScanFormat format : {ScanFormat::png, ScanFormat::raw}) {
        const auto stop = [](double fraction) { return fraction < 0.3; };
        EXPECT_NE(test::errorOf([&] { writeScan(sampleVolume(), temporary.path() / "x", format, stop); }), "");
        EXPECT_TRUE(std::filesystem::is_empty(temporary.path() / "x"));
    }
}

TEST(Labels, RoundTripAndWhatIsNoLabel) {
    const test::TemporaryFolder temporary;
    Volume numbers = sampleVolume({19, 14, 6}, 0, 8);
    numbers.grid.axes = test::obliqueAxes();
    const Labels labels = toLabels(numbers, "here");
    writeLabels(labels, temporary.path() / "labels.nrrd");
    const Scan read = readScan(temporary.path() / "labels.nrrd");
    EXPECT_EQ(read.volume.values, numbers.values);
    expectSamePlace(read.volume.grid, numbers.grid, 1e-12);
    const std::string first = test::readBytes(temporary.path() / "labels.nrrd");
    writeLabels(labels, temporary.path() / "labels.nrrd");
    EXPECT_EQ(test::readBytes(temporary.path() / "labels.nrrd"), first);
    for (const float wrong : {-1.0f, 256.0f, 1.5f}) {
        numbers.values[5] = wrong;
        EXPECT_NE(test::errorOf([&] { (void)toLabels(numbers, "here"); }).find("here"), std::string::npos);
    }
}

TEST(Thumbnail, IsTheMiddleSliceFittedRowsFromTheTop) {
    const test::TemporaryFolder temporary;
    Volume scan;
    scan.grid.size = {256, 512, 5};
    scan.grid.spacingMm = {0.1, 0.1, 0.1};
    scan.values.assign(scan.grid.count(), 100.0f);
    for (int j = 0; j < 256; ++j)
        for (int i = 0; i < 128; ++i)
            scan.values[scan.grid.index(i, j, 2)] = 300.0f;
    writeScan(scan, temporary.path(), ScanFormat::png);
    const std::vector<Series> found = findSeries(temporary.path());
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].thumbnailSize, (std::array{64, 128}));
    ASSERT_EQ(found[0].thumbnail.size(), 64u * 128u);
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 64; ++x)
            ASSERT_EQ(found[0].thumbnail[static_cast<std::size_t>(64 * y + x)], x < 32 && y < 64 ? 255 : 0)
                << x << " " << y;
    EXPECT_EQ(readScan(temporary.path()).series.thumbnail, found[0].thumbnail);
}

TEST(ReadScan, ReportsProgressAndCanBeCancelled) {
    const test::TemporaryFolder temporary;
    writeScan(sampleVolume({40, 40, 30}), temporary.path(), ScanFormat::dicom);
    std::atomic<int> calls{0};
    (void)readScan(temporary.path(), {}, [&](double f) { return ++calls, f >= 0.0 && f <= 1.0; });
    EXPECT_GT(calls, 30);
    EXPECT_NE(test::errorOf([&] { (void)readScan(temporary.path(), {}, [](double f) { return f < 0.5; }); }), "");
}

}  // namespace
}  // namespace handpiece::volume::round_trip_test
