// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan_support.h"

namespace handpiece::volume::dicom_test {
namespace {

using namespace std::string_literals;
using test::DicomMaker;
using test::dicomSeries;
using test::errorOf;
using test::writeSeries;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

class Dicom : public testing::Test {
  protected:
    test::TemporaryFolder temporary_;
    std::filesystem::path folder_ = temporary_.path() / "scan";

    [[nodiscard]] std::string error(const ReadSettings& settings = {}) const {
        return errorOf([&] { (void)readScan(folder_, settings); });
    }
};

/// A series by its number, the largest for "".
ReadSettings chosen(const std::string& series) {
    ReadSettings settings;
    settings.series = series;
    settings.takeLargest = series.empty();
    return settings;
}

void expectOurValues(const Volume& v, int slices) {
    ASSERT_EQ(v.grid.size, (std::array{5, 6, slices}));
    for (int k = 0; k < slices; ++k)
        for (int j = 0; j < 6; ++j)
            for (int i = 0; i < 5; ++i)
                ASSERT_EQ(v.values[v.grid.index(i, j, k)], static_cast<float>(100 * k + 10 * j + i))
                    << i << " " << j << " " << k;
}

TEST_F(Dicom, IsSortedByPlaceNotByNameOrNumber) {
    auto series = dicomSeries(7);
    std::swap(series[0], series[5]);
    std::swap(series[2], series[3]);
    for (auto& s : series)
        s.instance = "1";
    writeSeries(series, folder_);
    const Scan scan = readScan(folder_);
    expectOurValues(scan.volume, 7);
    EXPECT_EQ(scan.volume.grid.spacingMm, core::Vec3(0.25, 0.5, 1.0));
    EXPECT_EQ(scan.volume.grid.originMm, core::Vec3(-3, 4, 10));
    EXPECT_EQ(scan.series.modality, "CT");
    EXPECT_EQ(scan.series.bits, 16);
}

TEST_F(Dicom, EveryPlainTransferSyntaxIsReadTheSame) {
    for (const char* syntax : {"1.2.840.10008.1.2", "1.2.840.10008.1.2.1", "1.2.840.10008.1.2.2"}) {
        auto series = dicomSeries(4);
        for (auto& s : series)
            s.syntax = syntax;
        writeSeries(series, folder_);
        expectOurValues(readScan(folder_).volume, 4);
    }
    auto bare = dicomSeries(4);
    for (auto& s : bare)
        s.hasPreamble = false;
    writeSeries(bare, folder_);
    expectOurValues(readScan(folder_).volume, 4);
}

TEST_F(Dicom, RescalesAndTakesStoredBits) {
    auto series = dicomSeries(3);
    for (auto& s : series) {
        s.slope = "2";
        s.intercept = "-1024";
        s.stored = 12;
        s.pixels[0] = static_cast<std::int16_t>(0xF000 | 0x0FFF);  // -1 in 12 bits, rubbish above
        s.pixels[1] = 0x0800;                                      // -2048
    }
    writeSeries(series, folder_);
    const Volume v = readScan(folder_).volume;
    EXPECT_EQ(v.values[0], -1026.0f);
    EXPECT_EQ(v.values[1], -4096.0f - 1024.0f);
    EXPECT_EQ(v.values[2], 2.0f * 2 - 1024);
}

TEST_F(Dicom, ReversedOrderStaysRightHanded) {
    // Positions fall along x cross y: the volume must still be right-handed and in the patient's frame.
    auto series = dicomSeries(5);
    for (auto& s : series)
        s.orientation = "1\\0\\0\\0\\-1\\0";
    writeSeries(series, folder_);
    const Grid grid = readScan(folder_).volume.grid;
    EXPECT_NEAR(grid.axes.determinant(), 1.0, 1e-12);
    EXPECT_EQ(grid.originMm, core::Vec3(-3, 4, 14));
    EXPECT_EQ(core::Vec3(grid.axes.col(2)), core::Vec3(0, 0, -1));
    EXPECT_EQ(readScan(folder_).volume.values[0], 400.0f);
}

TEST_F(Dicom, MissingSlicesAreNamed) {
    writeSeries(dicomSeries(8), folder_);
    std::filesystem::remove(folder_ / "IM4");
    std::filesystem::remove(folder_ / "IM5");
    EXPECT_THAT(error(), AllOf(HasSubstr("2 slices are missing"), HasSubstr("\"IM3\""), HasSubstr("\"IM6\"")));
    const auto found = findSeries(folder_);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_THAT(found[0].notes, Contains(HasSubstr("missing")));
    EXPECT_FALSE(found[0].thumbnail.empty());
}

TEST_F(Dicom, DoubledSlicesAreNamed) {
    writeSeries(dicomSeries(5), folder_);
    std::filesystem::copy_file(folder_ / "IM3", folder_ / "IM99");
    EXPECT_THAT(error(), AllOf(HasSubstr("same place"), HasSubstr("IM99"), HasSubstr("IM3")));
}

TEST_F(Dicom, SliceOfAnotherSizeIsNamed) {
    auto series = dicomSeries(6);
    series[2].rows = 3;
    series[2].pixels.resize(15);
    writeSeries(series, folder_);
    EXPECT_THAT(error(chosen("")), AllOf(HasSubstr("different sizes"), HasSubstr("IM3"), HasSubstr("5 x 3")));
}

TEST_F(Dicom, SlicesOfOtherGreyAreNamed) {
    auto series = dicomSeries(5);
    series[2].photometric = "MONOCHROME1";
    writeSeries(series, folder_);
    EXPECT_THAT(error(), AllOf(HasSubstr("low values are meant to be bright"), HasSubstr("IM3")));
    series = dicomSeries(5);
    series[0].bits = series[0].stored = 8;
    series[0].pixels.resize(15);  // 30 bytes
    writeSeries(series, folder_);
    EXPECT_THAT(error(), AllOf(HasSubstr("8 bits"), HasSubstr("IM1")));
    // Fewer bits of as many are the same scale.
    series = dicomSeries(5);
    series[1].stored = 12;
    writeSeries(series, folder_);
    EXPECT_EQ(readScan(folder_).volume.grid.size[2], 5);
}

TEST_F(Dicom, StraySlicesAreRefused) {
    auto series = dicomSeries(6);
    series[3].position = "5\\4\\13";
    writeSeries(series, folder_);
    EXPECT_THAT(error(), AllOf(HasSubstr("beside the line"), HasSubstr("IM4")));
}

TEST_F(Dicom, SeveralSeriesAreToldApart) {
    writeSeries(dicomSeries(6), folder_ / "a");
    auto other = dicomSeries(4);
    for (auto& s : other)
        s.series = "1.2.4";
    writeSeries(other, folder_ / "b" / "deep");
    auto scout = dicomSeries(1);
    scout[0].orientation = "0\\1\\0\\0\\0\\-1";
    writeSeries(scout, folder_ / "c");
    const auto found = findSeries(folder_);
    ASSERT_EQ(found.size(), 3u);
    EXPECT_EQ(found[0].slices, 6);
    EXPECT_EQ(found[1].slices, 4);
    EXPECT_EQ(found[2].slices, 1);
    EXPECT_EQ(found[0].id, "1");
    EXPECT_THAT(error(), HasSubstr("3 series"));
    EXPECT_THAT(error(chosen("9")), HasSubstr("1 to 3"));
    EXPECT_EQ(readScan(folder_, chosen("2")).volume.grid.size[2], 4);
    EXPECT_EQ(readScan(folder_, chosen("")).volume.grid.size[2], 6);
}

TEST_F(Dicom, TiltedGantryIsStraightened) {
    // A linear function of place is kept by linear interpolation: the truth in closed form.
    const double tilt = 0.35;
    for (int k = 0; k < 12; ++k) {
        DicomMaker d;
        d.rows = 20;
        d.columns = 8;
        const double y = 4 + k * std::sin(tilt), z = 10 + k * std::cos(tilt);
        d.position = "-3\\" + std::to_string(y) + "\\" + std::to_string(z);
        for (int j = 0; j < d.rows; ++j)
            for (int i = 0; i < d.columns; ++i)
                d.pixels.push_back(static_cast<std::int16_t>(std::lround(400 * (y + 0.5 * j) + 300 * z + 50 * i)));
        test::writeBytes(folder_ / ("IM" + std::to_string(k)), d.bytes());
    }
    const Scan scan = readScan(folder_);
    EXPECT_THAT(scan.series.notes, Contains(HasSubstr("20.1 degrees")));
    const Grid& grid = scan.volume.grid;
    EXPECT_NEAR(grid.spacingMm.z(), std::cos(tilt), 1e-5);
    ASSERT_EQ(grid.size, (std::array{8, 28, 12}));
    int inside = 0;
    for (int k = 0; k < 12; ++k)
        for (int j = 0; j < grid.size[1]; ++j)
            for (int i = 0; i < 8; ++i) {
                const core::Vec3 p =
                    grid.toMm({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
                const double first = 4 + k * std::sin(tilt);
                if (p.y() < first || p.y() > first + 9.5) continue;
                ++inside;
                EXPECT_NEAR(scan.volume.values[grid.index(i, j, k)], 400 * p.y() + 300 * p.z() + 50 * i, 1.0);
            }
    EXPECT_GT(inside, 8 * 12 * 18);
}

TEST_F(Dicom, MissingSpacingIsAskedFor) {
    auto series = dicomSeries(4);
    for (auto& s : series)
        s.spacing.clear();
    writeSeries(series, folder_);
    EXPECT_FALSE(findSeries(folder_)[0].isSpacingKnown);
    EXPECT_THAT(error(), AllOf(HasSubstr("no pixel spacing"), HasSubstr("give the spacing")));
    ReadSettings settings;
    settings.spacingMm = core::Vec3(0.1, 0.2, 0.3);
    EXPECT_EQ(readScan(folder_, settings).volume.grid.spacingMm, core::Vec3(0.1, 0.2, 0.3));
    for (const char* wrong : {"0\\0", "nan\\0.5", "-1\\1"}) {
        for (auto& s : series)
            s.spacing = wrong;
        writeSeries(series, folder_);
        EXPECT_THAT(error(), HasSubstr("spacing")) << wrong;
    }
}

TEST_F(Dicom, WithoutPlaceTheNumbersSort) {
    auto series = dicomSeries(5);
    for (auto& s : series) {
        s.position.clear();
        s.orientation.clear();
        s.between = "0.7";
    }
    std::swap(series[0], series[4]);
    writeSeries(series, folder_);
    const Scan scan = readScan(folder_);
    expectOurValues(scan.volume, 5);
    EXPECT_DOUBLE_EQ(scan.volume.grid.spacingMm.z(), 0.7);
    EXPECT_THAT(scan.series.notes, Contains(HasSubstr("left and right may be swapped")));
}

TEST_F(Dicom, TruncatedPixelsAreNamed) {
    writeSeries(dicomSeries(5), folder_);
    test::cutFile(folder_ / "IM3", 0.95);
    EXPECT_THAT(error(), AllOf(HasSubstr("truncated"), HasSubstr("IM3")));
    // Cut within the header, the slice is left out and the hole is explained by it.
    test::cutFile(folder_ / "IM3", 0.5);
    EXPECT_THAT(error(), AllOf(HasSubstr("ends in its header"), HasSubstr("IM3")));
    // More than the header tells of: half of a scan would be read.
    DicomMaker more;
    more.frames = 4;
    more.between = "2";
    more.pixels.resize(8 * 30);
    test::writeBytes(temporary_.path() / "more.dcm", more.bytes());
    EXPECT_THAT(errorOf([&] { (void)readScan(temporary_.path() / "more.dcm"); }),
                AllOf(HasSubstr("4 frames"), HasSubstr("those of 8"), HasSubstr("more.dcm")));
    more.frames = 1;
    test::writeBytes(temporary_.path() / "more.dcm", more.bytes());
    EXPECT_THAT(errorOf([&] { (void)readScan(temporary_.path() / "more.dcm"); }), HasSubstr("1 frame, and its pixels"));
    auto series = dicomSeries(2);
    series[0].pixels.resize(7);  // the element is whole, but too short
    writeSeries(series, temporary_.path() / "short");
    EXPECT_THAT(errorOf([&] { (void)readScan(temporary_.path() / "short"); }),
                AllOf(HasSubstr("truncated"), HasSubstr("14 of 60")));
}

TEST_F(Dicom, WrongTransferSyntaxIsTold) {
    for (const auto& [syntax, text] :
         std::map<std::string, std::string>{{"1.2.840.10008.1.2.4.100", "1.2.840.10008.1.2.4.100 is not read"},
                                            {"1.2.840.10008.1.2.4.70", "does not fit its pixel data"},
                                            {"1.2.840.10008.1.2.5", "does not fit its pixel data"}}) {
        auto series = dicomSeries(3);
        for (auto& s : series)
            s.syntax = syntax;
        writeSeries(series, folder_);
        EXPECT_THAT(error(), AllOf(HasSubstr(text), HasSubstr("IM1"))) << syntax;
    }
    // Explicit by its name, implicit in truth.
    DicomMaker d = dicomSeries(1)[0];
    d.syntax = "1.2.840.10008.1.2";
    std::string bytes = d.bytes();
    const std::size_t at = bytes.find("1.2.840.10008.1.2");
    bytes.replace(at - 2, 20, std::string("\x14\0", 2) + "1.2.840.10008.1.2.1" + '\0' + std::string());
    bytes.erase(at - 2 + 22, 0);
    test::writeBytes(temporary_.path() / "lie.dcm", bytes);
    EXPECT_THAT(errorOf([&] { (void)readScan(temporary_.path() / "lie.dcm"); }),
                HasSubstr("transfer syntax does not fit"));
}

TEST_F(Dicom, HugeClaimsAreRefusedBeforeMemoryIsTaken) {
    auto series = dicomSeries(2);
    for (auto& s : series) {
        s.rows = 65000;
        s.columns = 65000;
    }
    series[0].frames = 99999;
    writeSeries(series, folder_);
    EXPECT_THAT(error(chosen("")), testing::AnyOf(HasSubstr("GB of memory"), HasSubstr("truncated")));
    EXPECT_FALSE(findSeries(folder_).empty());
}

TEST_F(Dicom, FramesThatAreNotThereTakeNoMemory) {
    auto series = dicomSeries(20);
    for (auto& s : series) {
        s.frames = 99999;
        s.pixels.clear();
    }
    writeSeries(series, folder_);
    std::string text;
    EXPECT_LT(test::peakGrowth([&] { text = error(); }), 64u << 20);
    EXPECT_THAT(text, AllOf(HasSubstr("truncated: 0 of"), HasSubstr("IM1")));
    // The same of packed ones: the pieces are counted.
    for (auto& s : series) {
        s.syntax = "1.2.840.10008.1.2.5";
        std::string bytes = s.bytes();
        bytes.replace(bytes.size() - 4, 4, "\xff\xff\xff\xff");  // the pixels' length: undefined
        const auto item = [&](std::uint32_t tag) {
            return s.number(0xfffe, 2, false) + s.number(tag, 2, false) + s.number(0, 4, false);
        };
        bytes += item(0xe000) + item(0xe000) + item(0xe0dd);
        test::writeBytes(folder_ / ("IM" + s.instance), bytes);
    }
    EXPECT_LT(test::peakGrowth([&] { text = error(); }), 64u << 20);
    EXPECT_THAT(text, AllOf(HasSubstr("1 packed pieces are there for 99999 frames"), HasSubstr("IM1")));
}

TEST_F(Dicom, WarnsOfBurnedInTextAndScreenPictures) {
    auto series = dicomSeries(3);
    series[1].burnedIn = "YES";
    writeSeries(series, folder_);
    EXPECT_THAT(readScan(folder_).series.notes, Contains(HasSubstr("burned-in")));
    for (auto& s : series)
        s.sopClass = "1.2.840.10008.5.1.4.1.1.7";
    writeSeries(series, folder_);
    EXPECT_THAT(readScan(folder_).series.notes, Contains(HasSubstr("secondary capture")));
}

TEST_F(Dicom, NothingPersonalComesIn) {
    writeSeries(dicomSeries(3), folder_);
    const Series s = findSeries(folder_)[0];
    std::string all = s.id + s.format + s.modality;
    for (const std::string& note : s.notes)
        all += note;
    for (const char* secret : {"Doe", "Jane", "4711", "1.2.3"})
        EXPECT_THAT(all, testing::Not(HasSubstr(secret)));
}

TEST_F(Dicom, ColourPicturesAndReportsAreToldOf) {
    DicomMaker colour = dicomSeries(1)[0];
    colour.samples = 3;
    colour.photometric = "RGB";
    test::writeBytes(folder_ / "colour.dcm", colour.bytes());
    EXPECT_THAT(error(), HasSubstr("1 with colour pictures"));
    writeSeries(dicomSeries(3), folder_);
    EXPECT_THAT(readScan(folder_).series.notes, Contains(HasSubstr("1 colour picture was left out")));
}

TEST_F(Dicom, EnhancedFramesAreSortedByTheirOwnPlaces) {
    DicomMaker d;
    d.frames = 4;
    d.position.clear();
    d.orientation.clear();
    d.spacing.clear();
    d.intercept.clear();
    d.slope.clear();
    d.isSigned = 1;
    const auto item = [&](const std::string& content) {
        const auto n = static_cast<std::uint32_t>(content.size());
        return d.number(0xfffe, 2, false) + d.number(0xe000, 2, false) + d.number(n, 4, false) + content;
    };
    const auto sequence = [&](std::uint32_t g, std::uint32_t e, const std::string& items) {
        return d.element(g, e, "SQ", items);
    };
    const int order[] = {2, 0, 3, 1};
    std::string perFrame;
    for (const int k : order) {
        perFrame += item(sequence(0x20, 0x9113, item(d.element(0x20, 0x32, "DS", "0\\0\\" + std::to_string(2 * k)))));
        for (int n = 0; n < 30; ++n)
            d.pixels.push_back(static_cast<std::int16_t>(100 * k + n / 5 * 10 + n % 5));
    }
    d.enhanced =
        sequence(0x5200, 0x9229,
                 item(sequence(0x20, 0x9116, item(d.element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0"))) +
                      sequence(0x28, 0x9110, item(d.element(0x28, 0x30, "DS", "0.5\\0.25"))) +
                      sequence(0x28, 0x9145,
                               item(d.element(0x28, 0x1052, "DS", "0") + d.element(0x28, 0x1053, "DS", "1"))))) +
        sequence(0x5200, 0x9230, perFrame);
    test::writeBytes(folder_ / "enhanced.dcm", d.bytes());
    const Scan scan = readScan(folder_ / "enhanced.dcm");
    expectOurValues(scan.volume, 4);
    EXPECT_EQ(scan.volume.grid.spacingMm, core::Vec3(0.25, 0.5, 2.0));
}

// As many dental CBCT devices write them: one file, one place for all.
TEST_F(Dicom, FramesOfOnePlaceLieAsTheHeaderSays) {
    const auto written = [&](const std::string& between, const std::string& more, bool isBackward) {
        DicomMaker d;
        d.frames = 4;
        d.between = between;
        d.enhanced = more;
        for (int at = 0; at < 4; ++at)
            for (int n = 0; n < 30; ++n)
                d.pixels.push_back(static_cast<std::int16_t>(100 * (isBackward ? 3 - at : at) + n / 5 * 10 + n % 5));
        test::writeBytes(folder_ / "frames.dcm", d.bytes());
    };
    const DicomMaker maker;
    const std::string thickness = maker.element(0x18, 0x50, "DS", "2"),
                      offsets = maker.element(0x3004, 0xc, "DS", "0\\2\\4\\6");
    struct Case {
        std::string between, more, by;
        bool isBackward;
    };
    for (const Case& one :
         {Case{"", thickness, "SliceThickness", false}, Case{"2", "", "SpacingBetweenSlices", false},
          Case{"2", maker.element(0x18, 0x50, "DS", "3"), "SpacingBetweenSlices", false},
          Case{"-2", "", "SpacingBetweenSlices", true},
          Case{"", maker.element(0x18, 0x50, "DS", "3") + offsets, "GridFrameOffsetVector", false},
          Case{"", maker.element(0x3004, 0xc, "DS", "0\\-2\\-4\\-6"), "GridFrameOffsetVector", true}}) {
        written(one.between, one.more, one.isBackward);
        const Scan scan = readScan(folder_ / "frames.dcm");
        EXPECT_EQ(scan.volume.grid.spacingMm, core::Vec3(0.25, 0.5, 2.0)) << one.by;
        expectOurValues(scan.volume, 4);
        EXPECT_THAT(scan.series.notes, Contains(HasSubstr(one.by)));
    }
    // Nothing tells it, or what tells it is of another number of frames.
    for (const std::string& more : {std::string(), maker.element(0x3004, 0xc, "DS", "0\\2\\4")}) {
        written("", more, false);
        EXPECT_THAT(error(), HasSubstr("same place"));
    }
}

// An archive's little picture, packed, in a sequence of undefined length: its bytes are no elements.
TEST_F(Dicom, APackedIconIsPassedOver) {
    auto series = dicomSeries(8);
    for (DicomMaker& d : series) {
        const auto head = [&](std::uint32_t group, std::uint32_t number, std::uint32_t length) {
            return d.number(group, 2, false) + d.number(number, 2, false) + d.number(length, 4, false);
        };
        const std::uint32_t open = 0xffffffffu;
        const std::string packed = d.number(0x7fe0, 2, false) + d.number(0x10, 2, false) + "OB" + std::string(2, '\0') +
                                   d.number(open, 4, false) + head(0xfffe, 0xe000, 0) + head(0xfffe, 0xe000, 8) +
                                   "\x01\x02\xff\xfe\x00\xe0zz"s + head(0xfffe, 0xe0dd, 0);
        d.enhanced = d.number(0x88, 2, false) + d.number(0x200, 2, false) + "SQ" + std::string(2, '\0') +
                     d.number(open, 4, false) + head(0xfffe, 0xe000, open) + d.us(0x10, 8) + packed +
                     head(0xfffe, 0xe00d, 0) + head(0xfffe, 0xe0dd, 0);
    }
    writeSeries(series, folder_);
    expectOurValues(readScan(folder_).volume, 8);
    // Cut off in the middle of it, it is told.
    const std::string whole = series[4].bytes();
    test::writeBytes(folder_ / "IM5", whole.substr(0, whole.find("zz") + 1));
    EXPECT_THAT(error(), HasSubstr("IM5"));
}

}  // namespace
}  // namespace handpiece::volume::dicom_test
