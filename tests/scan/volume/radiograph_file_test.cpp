// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include <gdcmAttribute.h>
#include <gdcmImageReader.h>
#include <gdcmStringFilter.h>

#include "handpiece/base/core/file.h"
#include "handpiece/scan/volume/read_scan.h"
#include "handpiece/scan/volume/write_radiograph.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::volume::radiograph_file_test {
namespace {

using testing::HasSubstr;

class RadiographFiles : public testing::Test {
  protected:
    void SetUp() override {
        std::mt19937_64 random(7);
        for (std::uint16_t& g : grey_)
            g = static_cast<std::uint16_t>(random());
        grey_[0] = 0;
        grey_[1] = 65535;
        file_ = {61, 40, grey_, 0.03, "periapical", 46, 65.0, 0.7, 300.0};
    }
    std::vector<std::uint16_t> grey_ = std::vector<std::uint16_t>(61 * 40);
    RadiographFile file_;
    test::TemporaryFolder temporary_;
};

TEST_F(RadiographFiles, GdcmReadsADerivedIntraOralImageWithoutAPatient) {
    const auto path = temporary_.path() / "r.dcm";
    writeRadiograph(file_, path);
    gdcm::ImageReader reader;
    reader.SetFileName(path.c_str());
    ASSERT_TRUE(reader.Read());
    const gdcm::Image& image = reader.GetImage();
    EXPECT_EQ(image.GetDimension(0), 61u);
    EXPECT_EQ(image.GetDimension(1), 40u);
    EXPECT_EQ(image.GetPixelFormat(), gdcm::PixelFormat::UINT16);
    EXPECT_EQ(image.GetPhotometricInterpretation(), gdcm::PhotometricInterpretation::MONOCHROME2);
    EXPECT_NEAR(image.GetSpacing(0), 0.03, 1e-9);
    std::vector<std::uint16_t> pixels(grey_.size());
    ASSERT_EQ(image.GetBufferLength(), 2 * pixels.size());
    ASSERT_TRUE(image.GetBuffer(reinterpret_cast<char*>(pixels.data())));
    EXPECT_EQ(pixels, grey_);
    gdcm::StringFilter filter;
    filter.SetFile(reader.GetFile());
    const auto text = [&](std::uint16_t group, std::uint16_t element) {
        std::string value = filter.ToString(gdcm::Tag(group, element));
        while (!value.empty() && (value.back() == ' ' || value.back() == '\0'))
            value.pop_back();
        return value;
    };
    EXPECT_EQ(text(0x0008, 0x0008), "DERIVED\\SECONDARY");
    EXPECT_EQ(text(0x0008, 0x0016), "1.2.840.10008.5.1.4.1.1.1.3");
    EXPECT_EQ(text(0x0008, 0x0060), "IO");
    EXPECT_THAT(text(0x0008, 0x103e), HasSubstr("SIMULATED"));
    EXPECT_THAT(text(0x0008, 0x2111), HasSubstr("46"));
    EXPECT_EQ(text(0x0018, 0x0060), "65");
    EXPECT_EQ(text(0x0018, 0x1190), "0.7");
    EXPECT_EQ(text(0x0020, 0x0062), "R");
    EXPECT_EQ(text(0x0020, 0x0020), "A\\F");
    EXPECT_EQ(text(0x0028, 0x0301), "YES");
    EXPECT_EQ(text(0x0028, 0x1040), "LOG");
    EXPECT_EQ(text(0x0028, 0x1041), "-1");
    for (const auto& [group, element] :
         {std::pair(0x0010, 0x0010), {0x0010, 0x0020}, {0x0010, 0x0030}, {0x0008, 0x0020}})
        EXPECT_EQ(text(static_cast<std::uint16_t>(group), static_cast<std::uint16_t>(element)), "") << group << element;
    const gdcm::DataSet& data = reader.GetFile().GetDataSet();
    for (const gdcm::Tag& tag : {gdcm::Tag(0x0008, 0x2218), gdcm::Tag(0x0040, 0x0555)})
        EXPECT_TRUE(data.FindDataElement(tag)) << tag;
    // The same picture the same bytes.
    const auto again = temporary_.path() / "again.dcm";
    writeRadiograph(file_, again);
    EXPECT_EQ(core::readFile(path), core::readFile(again));
}

TEST_F(RadiographFiles, OurOwnReaderReadsWhatIsWritten) {
    for (const bool isWide : {true, false})
        for (const char* name : {"r.dcm", "r.png"}) {
            file_.isWide = isWide;
            const auto path = temporary_.path() / name;
            writeRadiograph(file_, path);
            ReadSettings settings;
            settings.spacingMm = core::Vec3(0.03, 0.03, 1.0);
            const Scan scan = readScan(path, settings);
            EXPECT_EQ(scan.volume.grid.size, (std::array{61, 40, 1}));
            const bool isNarrow = !isWide && path.extension() == ".png";
            for (std::size_t n = 0; n < grey_.size(); ++n)
                ASSERT_NEAR(static_cast<double>(scan.volume.values[n]),
                            isNarrow ? std::round(grey_[n] / 257.0) : static_cast<double>(grey_[n]), 0.0)
                    << name;
        }
}

TEST_F(RadiographFiles, OtherNamesAndSizesAreRefused) {
    EXPECT_THAT(test::errorOf([&] { writeRadiograph(file_, temporary_.path() / "r.jpg"); }), HasSubstr(".png or .dcm"));
    EXPECT_THAT(test::errorOf([&] { writeRadiograph(file_, temporary_.path() / "no" / "such" / "r.png"); }),
                HasSubstr("r.png"));
    file_.height = 41;
    EXPECT_THAT(test::errorOf([&] { writeRadiograph(file_, temporary_.path() / "r.png"); }), HasSubstr("no size"));
}

}  // namespace
}  // namespace handpiece::volume::radiograph_file_test
