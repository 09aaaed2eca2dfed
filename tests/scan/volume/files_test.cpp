// SPDX-License-Identifier: Apache-2.0
// Folders, ZIPs, discs and pictures: what belongs together, and what is told where nothing does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tiffio.h>
#include <zip.h>

#include <array>
#include <map>

#include "handpiece/scan/volume/files.h"
#include "scan_support.h"

namespace handpiece::volume::files_test {
namespace {

namespace fs = std::filesystem;
using test::errorOf;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

class ScanFiles : public testing::Test {
  protected:
    test::TemporaryFolder temporary_;
    fs::path folder_ = temporary_.path() / "scan";

    void SetUp() override { fs::create_directories(folder_); }
    [[nodiscard]] std::string error(const fs::path& path) const {
        return errorOf([&] { (void)readScan(path); });
    }
    [[nodiscard]] std::string error() const { return error(folder_); }
    /// The folder as a ZIP.
    [[nodiscard]] fs::path zipped(bool isPacked = true) const {
        const fs::path file = temporary_.path() / "scan.zip";
        fs::remove(file);
        int code = 0;
        zip_t* zip = zip_open(file.c_str(), ZIP_CREATE, &code);
        for (const auto& e : fs::recursive_directory_iterator(folder_)) {
            const std::string name = e.path().lexically_relative(folder_.parent_path()).generic_string();
            if (e.is_directory()) {
                zip_dir_add(zip, name.c_str(), 0);
                continue;
            }
            const zip_int64_t i = zip_file_add(zip, name.c_str(), zip_source_file(zip, e.path().c_str(), 0, -1), 0);
            zip_set_file_compression(zip, static_cast<zip_uint64_t>(i), isPacked ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 0);
        }
        zip_close(zip);
        return file;
    }
};

TEST(NaturalOrder, CountsAsPeopleDo) {
    std::vector<std::string> names{"s10", "s9", "s1", "s01", "a", "s9b", "s9a2", "s9a10", "t"};
    std::sort(names.begin(), names.end(), [](const auto& a, const auto& b) { return naturalLess(a, b); });
    EXPECT_THAT(names, testing::ElementsAre("a", "s01", "s1", "s9", "s9a2", "s9a10", "s9b", "s10", "t"));
}

TEST_F(ScanFiles, NothingFitsSaysWhatIsThere) {
    EXPECT_THAT(error(), HasSubstr("it is empty"));
    EXPECT_THAT(error(temporary_.path() / "none"), HasSubstr("no such file"));
    for (int i = 0; i < 12; ++i)
        test::writeBytes(folder_ / ("a" + std::to_string(i) + ".pdf"), "%PDF");
    fs::create_directories(folder_ / "x" / "y");
    fs::create_directories(folder_ / "z");
    test::writeBytes(folder_ / "README", "hello");
    EXPECT_THAT(error(),
                AllOf(HasSubstr("12 PDF files"), HasSubstr("3 folders"), HasSubstr("1 file without an ending")));
    EXPECT_THAT(errorOf([&] { (void)findSeries(zipped()); }), AllOf(HasSubstr("12 PDF files"), HasSubstr("folder")));
    test::writeBytes(temporary_.path() / "one.pdf", "%PDF");
    EXPECT_THAT(error(temporary_.path() / "one.pdf"), HasSubstr("1 PDF file"));
}

TEST_F(ScanFiles, SlicesNumberedByTheirEndingsAreOneKind) {
    for (int i = 1; i <= 113; ++i)
        test::writeBytes(folder_ / ("CThead." + std::to_string(i)), std::string(64, 'x'));
    EXPECT_THAT(error(), HasSubstr("no scan is in it: 113 files with a number for an ending"));
    for (char c = 'a'; c <= 'z'; ++c)
        test::writeBytes(folder_ / (std::string("a.q") + c), "?");
    EXPECT_THAT(error(), AllOf(HasSubstr("19 other files"), testing::SizeIs(testing::Lt(500u))));
}

TEST_F(ScanFiles, ZipIsReadAsItsFolder) {
    for (const ScanFormat format : {ScanFormat::dicom, ScanFormat::tiff, ScanFormat::raw, ScanFormat::nrrd}) {
        writeScan(test::sampleVolume(), folder_, format);
        const Scan folder = readScan(folder_);
        for (const bool isPacked : {true, false}) {
            const Scan zip = readScan(zipped(isPacked));
            EXPECT_EQ(folder.volume.values, zip.volume.values);
            EXPECT_EQ(folder.volume.grid.spacingMm, zip.volume.grid.spacingMm);
            EXPECT_EQ(folder.volume.grid.axes, zip.volume.grid.axes);
        }
    }
    const fs::path zip = zipped();
    test::cutFile(zip, 0.7);
    EXPECT_THAT(error(zip), HasSubstr("ZIP"));
    writeScan(test::sampleVolume(), folder_, ScanFormat::nrrd);
    std::string bytes = test::readBytes(zipped(false));
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    test::writeBytes(zip, bytes);
    EXPECT_THAT(error(zip), HasSubstr("damaged"));
}

TEST_F(ScanFiles, MixedFolderShowsAllSeriesAndWhatWasLeftOut) {
    writeScan(test::sampleVolume({20, 20, 20}), folder_ / "ct", ScanFormat::dicom);
    writeScan(test::sampleVolume({20, 20, 10}), folder_ / "micro", ScanFormat::tiff);
    writeScan(test::sampleVolume({20, 20, 5}), folder_ / "n", ScanFormat::nrrd);
    test::writeBytes(folder_ / "broken.nrrd", "NRRD0004\n");
    test::writeBytes(folder_ / "settings.toml", "colour = \"blue\"\n");
    test::writeBytes(folder_ / ".hidden" / "x.dcm", "rubbish");
    writeScan(test::sampleVolume({90, 90, 1}), temporary_.path() / "photo", ScanFormat::jpeg);
    fs::copy_file(temporary_.path() / "photo" / "slice_0001.jpg", folder_ / "clinic.jpg");
    const auto found = findSeries(folder_);
    ASSERT_EQ(found.size(), 3u);
    EXPECT_EQ(found[0].format, "DICOM");
    EXPECT_EQ(found[1].format, "TIFF slices");
    EXPECT_EQ(found[2].format, "NRRD");
    EXPECT_THAT(found[0].notes, Contains(AllOf(HasSubstr("left out"), HasSubstr("broken.nrrd"))));
    EXPECT_THAT(found[0].notes, Contains(HasSubstr("1 single picture was left out")));
    ReadSettings settings;
    settings.series = "2";
    EXPECT_EQ(readScan(folder_, settings).volume.grid.size, (std::array{20, 20, 10}));
}

TEST_F(ScanFiles, PicturesInNaturalOrderWithGapsDoublesAndSizesTold) {
    const Volume scan = test::sampleVolume({9, 7, 12});
    writeScan(scan, folder_, ScanFormat::png);
    for (int k = 1; k <= 12; ++k) {
        char old[32];
        std::snprintf(old, sizeof old, "slice_%04d.png", k);
        fs::rename(folder_ / old, folder_ / ("tooth" + std::to_string(k) + "_rec.png"));
    }
    EXPECT_EQ(readScan(folder_).volume.values, scan.values);
    fs::copy_file(folder_ / "tooth7_rec.png", folder_ / "tooth07_rec.png");
    EXPECT_THAT(error(), AllOf(HasSubstr("slice 7 is there twice"), HasSubstr("tooth07_rec.png")));
    fs::remove(folder_ / "tooth07_rec.png");
    fs::remove(folder_ / "tooth8_rec.png");
    EXPECT_THAT(error(), AllOf(HasSubstr("missing"), HasSubstr("tooth7_rec.png"), HasSubstr("tooth9_rec.png")));
    writeScan(test::sampleVolume({10, 7, 1}), temporary_.path() / "other", ScanFormat::png);
    fs::copy_file(temporary_.path() / "other" / "slice_0001.png", folder_ / "tooth8_rec.png");
    EXPECT_THAT(error(), AllOf(HasSubstr("different sizes"), HasSubstr("tooth8_rec.png"), HasSubstr("10 x 7")));
}

TEST_F(ScanFiles, PicturesWithoutADescriptionNeedTheirSpacing) {
    for (const ScanFormat format : {ScanFormat::bmp, ScanFormat::jpeg, ScanFormat::png, ScanFormat::tiff}) {
        writeScan(test::sampleVolume(), folder_, format);
        fs::remove(folder_ / "scan.toml");
        EXPECT_FALSE(findSeries(folder_)[0].isSpacingKnown);
        EXPECT_THAT(error(), HasSubstr("give the spacing"));
        ReadSettings settings;
        settings.spacingMm = core::Vec3::Constant(0.1);
        const Scan scan = readScan(folder_, settings);
        EXPECT_EQ(scan.volume.grid.spacingMm, core::Vec3::Constant(0.1));
        EXPECT_EQ(scan.volume.grid.axes, core::Mat3(core::Mat3::Identity()));
    }
}

TEST_F(ScanFiles, TruncatedPicturesAreNamed) {
    for (const auto& [format, name] : std::map<ScanFormat, std::string>{{ScanFormat::bmp, "slice_0004.bmp"},
                                                                        {ScanFormat::jpeg, "slice_0004.jpg"},
                                                                        {ScanFormat::png, "slice_0004.png"},
                                                                        {ScanFormat::tiff, "slice_0004.tif"}}) {
        for (const double share : {0.6, 0.02, 0.0}) {
            writeScan(test::sampleVolume({64, 64, 6}), folder_, format);
            test::cutFile(folder_ / name, share);
            EXPECT_THAT(error(), AllOf(HasSubstr(name), HasSubstr("damaged"))) << share;
        }
    }
}

TEST_F(ScanFiles, PicturesThatClaimGigabytesAreRefused) {
    const auto put = [](std::string& s, std::size_t at, std::uint32_t v, bool isBig) {
        for (std::size_t i = 0; i < 4; ++i)
            s[at + i] = static_cast<char>(v >> 8 * (isBig ? 3 - i : i) & 0xff);
    };
    writeScan(test::sampleVolume({16, 16, 1}), folder_, ScanFormat::bmp);
    std::string bmp = test::readBytes(folder_ / "slice_0001.bmp");
    put(bmp, 18, 99999, false);
    put(bmp, 22, 99999, false);
    test::writeBytes(folder_ / "slice_0001.bmp", bmp);
    EXPECT_THAT(error(), HasSubstr("GB of memory"));
    EXPECT_EQ(findSeries(folder_).size(), 1u);
    writeScan(test::sampleVolume({16, 16, 1}), folder_, ScanFormat::tiff);
    TIFF* tiff = TIFFOpen((folder_ / "slice_0001.tif").c_str(), "r+");
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 99999);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 99999);
    TIFFRewriteDirectory(tiff);
    TIFFClose(tiff);
    EXPECT_THAT(error(), HasSubstr("GB of memory"));
    // PNG: the sum over the header must fit the new size, computed bit by bit.
    writeScan(test::sampleVolume({16, 16, 1}), folder_, ScanFormat::png);
    std::string png = test::readBytes(folder_ / "slice_0001.png");
    put(png, 16, 99999, true);
    put(png, 20, 99999, true);
    std::uint32_t crc = ~0u;
    for (std::size_t i = 12; i < 29; ++i) {
        crc ^= static_cast<unsigned char>(png[i]);
        for (int bit = 0; bit < 8; ++bit)
            crc = crc & 1 ? crc >> 1 ^ 0xedb88320u : crc >> 1;
    }
    put(png, 29, ~crc, true);
    test::writeBytes(folder_ / "slice_0001.png", png);
    EXPECT_THAT(error(), HasSubstr("GB of memory"));
    writeScan(test::sampleVolume({16, 16, 1}), folder_, ScanFormat::jpeg);
    std::string jpeg = test::readBytes(folder_ / "slice_0001.jpg");
    const std::size_t frame = jpeg.find("\xff\xc0");
    jpeg.replace(frame + 5, 4, "\xff\xdc\xff\xdc");  // 65500 x 65500
    test::writeBytes(folder_ / "slice_0001.jpg", jpeg);
    EXPECT_THAT(error(), HasSubstr("GB of memory"));
}

TEST_F(ScanFiles, ClaimsThatNoPackingHoldsTakeNoMemory) {
    writeScan(test::sampleVolume({16, 16, 1}), folder_, ScanFormat::tiff);
    TIFF* tiff = TIFFOpen((folder_ / "slice_0001.tif").c_str(), "r+");
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 30000);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 30000);
    TIFFRewriteDirectory(tiff);
    TIFFClose(tiff);
    std::string text;
    EXPECT_LT(test::peakGrowth([&] {
                  text = error();
                  EXPECT_EQ(findSeries(folder_).size(), 1u);
              }),
              64u << 20);
    EXPECT_THAT(text, HasSubstr("cannot hold the 900000000 voxels"));
}

TEST_F(ScanFiles, PaletteOfSignedSamplesCountsFromZero) {
    std::vector<std::uint16_t> ramp(256);
    for (std::size_t i = 0; i < ramp.size(); ++i)
        ramp[i] = static_cast<std::uint16_t>(257 * (255 - i));
    const fs::path file = folder_ / "a.tif";
    TIFF* tiff = TIFFOpen(file.c_str(), "w");
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 16);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 16);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_INT);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_PALETTE);
    TIFFSetField(tiff, TIFFTAG_COLORMAP, ramp.data(), ramp.data(), ramp.data());
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    for (int y = 0; y < 16; ++y) {
        std::uint8_t line[16];
        for (int x = 0; x < 16; ++x)
            line[x] = static_cast<std::uint8_t>(16 * y + x);
        TIFFWriteScanline(tiff, line, static_cast<std::uint32_t>(y), 0);
    }
    TIFFClose(tiff);
    ReadSettings settings;
    settings.spacingMm = core::Vec3::Ones();
    const Volume v = readScan(file, settings).volume;
    ASSERT_EQ(v.values.size(), 256u);
    for (std::size_t i = 0; i < 256; ++i)
        EXPECT_EQ(v.values[i], static_cast<float>(255 - i)) << i;
}

TEST_F(ScanFiles, ZipThatClaimsMoreThanItHoldsTakesNoMemory) {
    // A little over a megabyte that does not pack, said to become one of gigabytes.
    std::string noise(1200000, '\0');
    std::mt19937 generator(3);
    for (char& c : noise)
        c = static_cast<char>(generator());
    test::writeBytes(folder_ / "a.tif", noise);
    std::string bytes = test::readBytes(zipped());
    bytes.replace(bytes.rfind("PK\1\2") + 24, 4, std::string("\0\0\0\x40", 4));
    test::writeBytes(temporary_.path() / "claims.zip", bytes);
    std::string text;
    EXPECT_LT(test::peakGrowth([&] { text = error(temporary_.path() / "claims.zip"); }), 64u << 20);
    EXPECT_THAT(text, AllOf(HasSubstr("claims.zip"), HasSubstr("\"scan/a.tif\" in this ZIP is damaged")));
}

TEST_F(ScanFiles, ZipWhoseEntriesShareTheirBytesIsRefused) {
    test::writeBytes(folder_ / "a.tif", std::string(3000, 'x'));
    std::string bytes = test::readBytes(zipped(false));
    // The directory's last record once more, under another name.
    const std::size_t record = bytes.rfind("PK\1\2"), end = bytes.rfind("PK\5\6");
    std::string again = bytes.substr(record, end - record);
    again[again.find("a.tif")] = 'b';
    bytes.insert(end, again);
    const std::size_t count = end + again.size();
    for (const std::size_t at : {count + 8, count + 10})
        ++bytes[at];
    const std::size_t size = count - bytes.find("PK\1\2");
    for (std::size_t i = 0; i < 4; ++i)
        bytes[count + 12 + i] = static_cast<char>(size >> 8 * i & 0xff);
    test::writeBytes(temporary_.path() / "shared.zip", bytes);
    EXPECT_THAT(error(temporary_.path() / "shared.zip"), HasSubstr("its entries lie over each other"));
}

TEST_F(ScanFiles, ZipHasALimitForOneFileAndForAll) {
    for (const char* name : {"a.tif", "b.tif", "c.tif"})
        test::writeBytes(folder_ / name, std::string(3 << 20, 'x'));
    const fs::path zip = zipped();
    const auto opened = [&](std::uint64_t file, std::uint64_t all) {
        return errorOf([&] { (void)FileSet::open(zip, {file, all}); });
    };
    EXPECT_EQ(opened(3 << 20, 9 << 20), "");
    EXPECT_THAT(opened(2 << 20, 9 << 20), AllOf(HasSubstr("one file of this ZIP unpacks to more than 2 MB")));
    EXPECT_THAT(opened(3 << 20, 8 << 20), AllOf(HasSubstr("the files of this ZIP unpack to more than 8 MB")));
}

TEST_F(ScanFiles, BmpOf24And32BitsAndFromTheTop) {
    for (const int bits : {24, 32})
        for (const bool isFromTop : {false, true}) {
            const int w = 5, h = 3, row = (w * bits / 8 + 3) / 4 * 4;
            std::string out = "BM" + std::string(52, '\0') + std::string(static_cast<std::size_t>(row * h), '\0');
            const auto put = [&](std::size_t at, int v, int n) {
                for (int i = 0; i < n; ++i)
                    out[at + static_cast<std::size_t>(i)] = static_cast<char>(v >> 8 * i & 0xff);
            };
            put(10, 54, 4);
            put(14, 40, 4);
            put(18, w, 4);
            put(22, isFromTop ? -h : h, 4);
            put(26, 1, 2);
            put(28, bits, 2);
            for (int y = 0; y < h; ++y)
                for (int x = 0; x < w; ++x)
                    for (int c = 0; c < 3; ++c)
                        put(static_cast<std::size_t>(54 + (isFromTop ? y : h - 1 - y) * row + x * bits / 8 + c),
                            40 * y + 3 * x, 1);
            test::writeBytes(folder_ / "a.bmp", out);
            ReadSettings settings;
            settings.spacingMm = core::Vec3::Ones();
            const Volume v = readScan(folder_ / "a.bmp", settings).volume;
            ASSERT_EQ(v.grid.size, (std::array{5, 3, 1}));
            for (int y = 0; y < h; ++y)
                for (int x = 0; x < w; ++x)
                    EXPECT_EQ(v.values[v.grid.index(x, y, 0)], static_cast<float>(40 * y + 3 * x)) << bits << isFromTop;
        }
}

/// A TIFF of several pages, floats in tiles or packed 8-bit strips, described as ImageJ does.
void writePages(const fs::path& file, int pages, bool isFloat, const char* description) {
    TIFF* tiff = TIFFOpen(file.c_str(), "w");
    for (int k = 0; k < pages; ++k) {
        TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 20);
        TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 18);
        TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, isFloat ? 32 : 8);
        TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
        TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, isFloat ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
        TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
        TIFFSetField(tiff, TIFFTAG_COMPRESSION, isFloat ? COMPRESSION_NONE : COMPRESSION_LZW);
        if (k == 0 && description) {
            TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, description);
            TIFFSetField(tiff, TIFFTAG_XRESOLUTION, 10.0);
            TIFFSetField(tiff, TIFFTAG_YRESOLUTION, 20.0);
        }
        if (isFloat) {
            TIFFSetField(tiff, TIFFTAG_TILEWIDTH, 16);
            TIFFSetField(tiff, TIFFTAG_TILELENGTH, 16);
            for (int ty = 0; ty < 2; ++ty)
                for (int tx = 0; tx < 2; ++tx) {
                    float tile[256];
                    for (int n = 0; n < 256; ++n)
                        tile[n] = 0.25f * static_cast<float>(1000 * k + 20 * (16 * ty + n / 16) + 16 * tx + n % 16);
                    TIFFWriteTile(tiff, tile, static_cast<std::uint32_t>(16 * tx), static_cast<std::uint32_t>(16 * ty),
                                  0, 0);
                }
        } else {
            for (int y = 0; y < 18; ++y) {
                std::uint8_t line[20];
                for (int x = 0; x < 20; ++x)
                    line[x] = static_cast<std::uint8_t>(7 * k + 9 * y + x);
                TIFFWriteScanline(tiff, line, static_cast<std::uint32_t>(y), 0);
            }
        }
        TIFFWriteDirectory(tiff);
    }
    TIFFClose(tiff);
}

TEST_F(ScanFiles, TiffPagesOfFloatsAndOfImageJ) {
    writePages(folder_ / "stack.tif", 4, true, "ImageJ=1.53t\nimages=4\nslices=4\nunit=mm\nspacing=0.3\nloop=false\n");
    const Volume v = readScan(folder_ / "stack.tif").volume;
    ASSERT_EQ(v.grid.size, (std::array{20, 18, 4}));
    EXPECT_TRUE(v.grid.spacingMm.isApprox(core::Vec3(0.1, 0.05, 0.3), 1e-6));
    for (int k = 0; k < 4; ++k)
        for (int y = 0; y < 18; ++y)
            for (int x = 0; x < 20; ++x)
                ASSERT_EQ(v.values[v.grid.index(x, y, k)], 0.25f * static_cast<float>(1000 * k + 20 * y + x));
    writePages(folder_ / "stack.tif", 3, false, "Made by somebody\nunit=mm\nspacing=3\n");
    EXPECT_THAT(error(), HasSubstr("give the spacing"));
    ReadSettings settings;
    settings.spacingMm = core::Vec3::Ones();
    const Volume bytes = readScan(folder_, settings).volume;
    EXPECT_EQ(bytes.values[bytes.grid.index(5, 4, 2)], 14.0f + 36 + 5);
    EXPECT_FALSE(findSeries(folder_)[0].thumbnail.empty());
    test::cutFile(folder_ / "stack.tif", 0.5);
    EXPECT_THAT(error(), HasSubstr("stack.tif"));
}

TEST_F(ScanFiles, TiffOfChannelsOrTimesIsNoStackOfSlices) {
    const fs::path file = folder_ / "stack.tif";
    const std::string ome = "<?xml version=\"1.0\"?><OME><Image><Pixels SizeX=\"20\" SizeY=\"18\" SizeZ=\"2\" SizeC=";
    const std::string imageJ = "ImageJ=1.53t\nimages=4\nunit=mm\nspacing=0.3\n";
    for (const std::string& wrong :
         {imageJ + "channels=2\nslices=2\nhyperstack=true\n", imageJ + "slices=2\nframes=2\nhyperstack=true\n",
          imageJ + "frames=4\n", ome + "\"2\" SizeT=\"1\"/></Image></OME>",
          ome + "\"1\" SizeT=\"2\"/></Image></OME>"}) {
        writePages(file, 4, false, wrong.c_str());
        EXPECT_THAT(error(), AllOf(HasSubstr("stack.tif"), HasSubstr("not the slices of one scan"),
                                   HasSubstr("one channel and one time point")))
            << wrong;
    }
    ReadSettings settings;
    settings.spacingMm = core::Vec3::Ones();
    for (const std::string& right :
         {imageJ + "channels=1\nslices=4\nframes=1\n", ome + "\"1\" SizeT=\"1\"/></Image></OME>",
          std::string("SizeC=\"2\" channels=2")}) {
        writePages(file, 4, false, right.c_str());
        EXPECT_EQ(readScan(folder_, settings).volume.grid.size[2], 4) << right;
    }
    writePages(file, 4, true, (imageJ + "channels=2\nslices=2\n").c_str());
    EXPECT_THAT(error(), HasSubstr("2 channels and 1 time point,"));
}

TEST_F(ScanFiles, TiffPagesThatAreMissingOrLeadBackAreTold) {
    const fs::path file = folder_ / "stack.tif";
    for (const char* tells : {"ImageJ=1.53t\nimages=7\nslices=7\nunit=mm\nspacing=0.3\n",
                              "<OME><Image><Pixels SizeZ=\"7\" SizeC=\"1\" SizeT=\"1\"/></Image></OME>"}) {
        writePages(file, 4, false, tells);
        EXPECT_THAT(error(), AllOf(HasSubstr("7 pages, and 4 are there"), HasSubstr("stack.tif"))) << tells;
    }
    // The last page names the first, the second or itself as the next.
    for (const int back : {0, 1, 3}) {
        writePages(file, 4, false, nullptr);
        std::string bytes = test::readBytes(file);
        const auto number = [&](std::size_t at, int count) {
            std::size_t value = 0;
            for (int i = count; i-- > 0;)
                value = value << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
            return value;
        };
        std::vector<std::size_t> directories;
        std::size_t next = 4;
        for (std::size_t at = number(4, 4); at != 0; at = number(next, 4)) {
            directories.push_back(at);
            next = at + 2 + 12 * number(at, 2);
        }
        ASSERT_EQ(directories.size(), 4u);
        bytes.replace(
            next, 4,
            test::numbers(std::vector{static_cast<std::uint32_t>(directories[static_cast<std::size_t>(back)])}));
        test::writeBytes(file, bytes);
        EXPECT_THAT(error(), AllOf(HasSubstr("behind its page 4"), HasSubstr("stack.tif"))) << back;
    }
}

// ImageJ's large stacks: one directory, all pages one after another behind it.
TEST_F(ScanFiles, TiffOfOneDirectoryAndManyPages) {
    constexpr int kWidth = 20, kHeight = 18, kPages = 5;
    for (const bool isBig : {false, true}) {
        const fs::path file = folder_ / "stack.tif";
        TIFF* tiff = TIFFOpen(file.c_str(), isBig ? "wb" : "wl");
        TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, kWidth);
        TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, kHeight);
        TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
        TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
        TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, kHeight);
        TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION,
                     "ImageJ=1.53t\nimages=5\nslices=5\nunit=mm\nspacing=0.3\nloop=false\n");
        TIFFSetField(tiff, TIFFTAG_XRESOLUTION, 10.0);
        TIFFSetField(tiff, TIFFTAG_YRESOLUTION, 10.0);
        std::string pixels;
        for (int n = 0; n < kWidth * kHeight * kPages; ++n) {
            const int value = 3 * n;
            pixels += static_cast<char>(isBig ? value >> 8 : value & 0xff);
            pixels += static_cast<char>(isBig ? value & 0xff : value >> 8);
        }
        TIFFWriteRawStrip(tiff, 0, pixels.data(), static_cast<tmsize_t>(pixels.size()));
        TIFFClose(tiff);
        const Volume v = readScan(folder_).volume;
        ASSERT_EQ(v.grid.size, (std::array{kWidth, kHeight, kPages})) << isBig;
        EXPECT_TRUE(v.grid.spacingMm.isApprox(core::Vec3(0.1, 0.1, 0.3), 1e-6));
        for (int n = 0; n < kWidth * kHeight * kPages; ++n)
            ASSERT_EQ(v.values[static_cast<std::size_t>(n)], static_cast<float>(3 * n)) << isBig;
        std::string odd = test::readBytes(file), two = odd;
        two.replace(two.find("slices=5"), 8, "frames=5");
        test::writeBytes(file, two);
        EXPECT_THAT(error(), HasSubstr("5 time points"));
        // Of more pages than there are it is told.
        odd.replace(odd.find("images=5"), 8, "images=9");
        test::writeBytes(file, odd);
        EXPECT_THAT(error(), HasSubstr("too short"));
    }
}

/// Where TIFF 6.0 (tag 274) says that a file's first row and first column are seen.
struct Lies {
    bool rowsAreColumns, rowsBackward, columnsBackward;
    [[nodiscard]] std::pair<int, int> seen(int row, int column, int rows, int columns) const {
        const int r = rowsBackward ? rows - 1 - row : row, c = columnsBackward ? columns - 1 - column : column;
        return rowsAreColumns ? std::pair(r, c) : std::pair(c, r);
    }
};
constexpr std::array<Lies, 9> kLies{{{false, false, false},
                                     {false, false, false},  // top, left
                                     {false, false, true},   // top, right
                                     {false, true, true},    // bottom, right
                                     {false, true, false},   // bottom, left
                                     {true, false, false},   // left, top
                                     {true, true, false},    // right, top
                                     {true, true, true},     // right, bottom
                                     {true, false, true}}};  // left, bottom

TEST_F(ScanFiles, ATiffThatLiesOtherwiseIsNoMirrorImage) {
    constexpr int kWidth = 20, kHeight = 18;  // as seen
    const auto grey = [](int x, int y, int k) { return static_cast<std::uint8_t>(7 * k + 9 * y + x); };
    for (int tag = 0; tag <= 9; ++tag) {
        const Lies lies = kLies[static_cast<std::size_t>(tag > 8 ? 0 : tag)];
        const int columns = lies.rowsAreColumns ? kHeight : kWidth, rows = lies.rowsAreColumns ? kWidth : kHeight;
        TIFF* tiff = TIFFOpen((folder_ / "stack.tif").c_str(), "w");
        for (int k = 0; k < 3; ++k) {
            TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, columns);
            TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, rows);
            TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
            TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
            TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
            if (tag >= 1 && tag <= 8) TIFFSetField(tiff, TIFFTAG_ORIENTATION, tag);
            for (int r = 0; r < rows; ++r) {
                std::vector<std::uint8_t> line;
                for (int c = 0; c < columns; ++c) {
                    const auto [x, y] = lies.seen(r, c, rows, columns);
                    line.push_back(grey(x, y, k));
                }
                TIFFWriteScanline(tiff, line.data(), static_cast<std::uint32_t>(r), 0);
            }
            TIFFWriteDirectory(tiff);
        }
        TIFFClose(tiff);
        ReadSettings settings;
        settings.spacingMm = core::Vec3::Ones();
        const Volume v = readScan(folder_, settings).volume;
        ASSERT_EQ(v.grid.size, (std::array{kWidth, kHeight, 3})) << tag;
        for (int k = 0; k < 3; ++k)
            for (int y = 0; y < kHeight; ++y)
                for (int x = 0; x < kWidth; ++x)
                    ASSERT_EQ(v.values[v.grid.index(x, y, k)], static_cast<float>(grey(x, y, k))) << tag;
    }
}

TEST_F(ScanFiles, AJpegThatLiesOtherwiseIsNoMirrorImage) {
    const Volume sample = test::sampleVolume({20, 17, 3}, 0, 250);
    writeScan(sample, folder_, ScanFormat::jpeg);
    ReadSettings settings;
    settings.spacingMm = core::Vec3::Ones();
    const Volume upright = readScan(folder_, settings).volume;
    const std::vector<std::string> files{"slice_0001.jpg", "slice_0002.jpg", "slice_0003.jpg"};
    std::map<std::string, std::string> plain;
    for (const std::string& name : files)
        plain[name] = test::readBytes(folder_ / name);
    for (int tag = 1; tag <= 9; ++tag)
        for (const bool isBig : {false, true}) {
            const auto number = [&](std::uint32_t value, int bytes) {
                std::string text;
                for (int i = 0; i < bytes; ++i)
                    text += static_cast<char>(value >> 8 * (isBig ? bytes - 1 - i : i));
                return text;
            };
            const std::string exif = std::string("Exif\0\0", 6) + (isBig ? "MM" : "II") + number(42, 2) + number(8, 4) +
                                     number(2, 2) + number(0x0100, 2) + number(3, 2) + number(1, 4) + number(20, 2) +
                                     number(0, 2) + number(0x0112, 2) + number(3, 2) + number(1, 4) +
                                     number(static_cast<std::uint32_t>(tag), 2) + number(0, 2) + number(0, 4);
            const std::size_t size = exif.size() + 2;
            const std::string segment =
                std::string("\xff\xe1") + static_cast<char>(size >> 8) + static_cast<char>(size) + exif;
            for (const std::string& name : files)
                test::writeBytes(folder_ / name, plain[name].substr(0, 2) + segment + plain[name].substr(2));
            const Lies lies = kLies[static_cast<std::size_t>(tag > 8 ? 0 : tag)];
            const Volume v = readScan(folder_, settings).volume;
            ASSERT_EQ(v.grid.size, (lies.rowsAreColumns ? std::array{17, 20, 3} : std::array{20, 17, 3})) << tag;
            for (int k = 0; k < 3; ++k)
                for (int r = 0; r < 17; ++r)
                    for (int c = 0; c < 20; ++c) {
                        const auto [x, y] = lies.seen(r, c, 17, 20);
                        ASSERT_EQ(v.values[v.grid.index(x, y, k)], upright.values[upright.grid.index(c, r, k)])
                            << tag << isBig;
                    }
        }
    // A segment that is cut off anywhere is as none.
    const std::string whole = test::readBytes(folder_ / files[0]);
    for (std::size_t at = 4; at < 44; ++at) {
        std::string odd = whole;
        odd[at] = static_cast<char>(odd[at] ^ 0x5a);
        test::writeBytes(folder_ / files[0], odd);
        (void)error();
    }
}

TEST_F(ScanFiles, DicomdirOfTheFilesItLists) {
    // Only what a reader needs of it: the file ids in the records.
    test::writeSeries(test::dicomSeries(4), folder_ / "DATA" / "CT");
    test::writeSeries(test::dicomSeries(2), folder_ / "OTHER");
    const test::DicomMaker d;
    const auto item = [&](const std::string& content) {
        return d.number(0xfffe, 2, false) + d.number(0xe000, 2, false) +
               d.number(static_cast<std::uint32_t>(content.size()), 4, false) + content;
    };
    std::string records;
    for (int k = 1; k <= 5; ++k)
        records +=
            item(d.element(4, 0x1430, "CS", "IMAGE") + d.element(4, 0x1500, "CS", "data\\CT\\IM" + std::to_string(k)));
    test::writeBytes(folder_ / "DICOMDIR", std::string(128, '\0') + "DICM" + d.element(2, 0x10, "UI", d.syntax, true) +
                                               d.element(4, 0x1220, "SQ", records));
    const auto found = findSeries(folder_ / "DICOMDIR");
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].slices, 4);
    EXPECT_THAT(found[0].notes, Contains(HasSubstr("1 file that the DICOMDIR lists is missing")));
    fs::remove_all(folder_ / "DATA");
    EXPECT_THAT(error(folder_ / "DICOMDIR"), HasSubstr("none of the files"));
}

}  // namespace
}  // namespace handpiece::volume::files_test
