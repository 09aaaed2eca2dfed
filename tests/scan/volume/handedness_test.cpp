// SPDX-License-Identifier: Apache-2.0
// One tooth is no mirror image of itself: a body of four blobs that has a left and a right, written in every format and
// from every side. It comes in with the right hand, or the scan says that nobody can tell and can be turned.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nifti1_io.h>
#include <tiffio.h>

#include <functional>

#include "scan_support.h"

namespace handpiece::volume::handedness_test {
namespace {

namespace fs = std::filesystem;
using test::DicomMaker;
using testing::Contains;
using testing::HasSubstr;

class Handedness : public testing::Test {
  protected:
    test::TemporaryFolder temporary_;
    fs::path at_ = temporary_.path() / "scan";
    const Volume phantom_ = test::chiralPhantom();
    int cases_ = 0;

    /// `side` 0: nobody can tell.
    void expect(int side, const std::string& what, const std::string& why = "") {
        ++cases_;
        ReadSettings settings;
        settings.spacingMm = core::Vec3::Constant(0.2);
        const Scan scan = readScan(at_, settings);
        const std::vector<Series> found = findSeries(at_);
        ASSERT_EQ(found.size(), 1u) << what;
        EXPECT_NEAR(scan.volume.grid.axes.determinant(), 1.0, 1e-9) << what;
        const auto isTold = Contains(HasSubstr("left and right may be swapped: " + why));
        for (const Series& series : {scan.series, found[0]}) {
            EXPECT_EQ(series.isSideKnown, side != 0) << what;
            if (side == 0)
                EXPECT_THAT(series.notes, isTold) << what;
            else
                EXPECT_THAT(series.notes, testing::Not(isTold)) << what;
        }
        const int seen = test::sideOf(scan.volume);
        if (side == 0)
            EXPECT_NE(seen, 0) << what;
        else
            EXPECT_EQ(seen, side) << what;
        settings.reverseSlices = true;
        const Scan turned = readScan(at_, settings);
        EXPECT_EQ(test::sideOf(turned.volume), -seen) << what;
        EXPECT_TRUE(turned.volume.grid.originMm.isApprox(scan.volume.grid.originMm)) << what;
        EXPECT_THAT(turned.series.notes, Contains(HasSubstr("read from the other end"))) << what;
        EXPECT_THAT(turned.series.notes, testing::Not(isTold)) << what;
        fs::remove_all(at_);
    }
    [[nodiscard]] std::vector<std::int16_t> numbersOf(int first, int count) const {
        const std::size_t each = phantom_.grid.index(0, 0, 1);
        const auto begin =
            phantom_.values.begin() + static_cast<std::ptrdiff_t>(each * static_cast<std::size_t>(first));
        return {begin, begin + static_cast<std::ptrdiff_t>(each * static_cast<std::size_t>(count))};
    }
    [[nodiscard]] DicomMaker dicom(int first, int count) const {
        DicomMaker d;
        d.columns = 24;
        d.rows = 18;
        d.frames = count;
        d.spacing = "0.2\\0.2";
        d.instance = std::to_string(first + 1);
        d.pixels = numbersOf(first, count);
        return d;
    }
    void writePixels(const std::string& name, const std::string& header) const {
        test::writeBytes(at_ / name, header + test::numbers(numbersOf(0, 10)));
    }
};

/// Each way to turn two of the axes over, and the third.
const std::vector<std::array<int, 3>> kSigns = [] {
    std::vector<std::array<int, 3>> all;
    for (int n = 0; n < 8; ++n)
        all.push_back({n & 1 ? -1 : 1, n & 2 ? -1 : 1, n & 4 ? -1 : 1});
    return all;
}();
int product(const std::array<int, 3>& s) {
    return s[0] * s[1] * s[2];
}
std::string named(const std::array<int, 3>& s) {
    return std::to_string(s[0]) + " " + std::to_string(s[1]) + " " + std::to_string(s[2]);
}

TEST_F(Handedness, OfDicom) {
    for (const bool isTurned : {false, true})
        for (const auto& s : kSigns) {
            for (int k = 0; k < 10; ++k) {
                DicomMaker d = dicom(k, 1);
                const std::string i = std::to_string(s[0]), j = std::to_string(s[1]);
                // Columns along x and rows along y, or the other way round.
                d.orientation = isTurned ? "0\\" + i + "\\0\\" + j + "\\0\\0" : i + "\\0\\0\\0\\" + j + "\\0";
                d.position = "5\\6\\" + std::to_string(0.2 * k * s[2]);
                test::writeBytes(at_ / ("IM" + std::to_string(k)), d.bytes());
            }
            expect(isTurned ? -product(s) : product(s), "DICOM " + named(s));
        }
    for (const bool isBackward : {false, true}) {
        for (int k = 0; k < 10; ++k) {
            DicomMaker d = dicom(k, 1);
            d.position.clear();
            d.orientation.clear();
            d.between = "0.2";
            if (isBackward) d.instance = std::to_string(20 - k);
            test::writeBytes(at_ / ("IM" + std::to_string(k)), d.bytes());
        }
        expect(0, "DICOM by number", "the files do not tell where the slices lie");
    }
    EXPECT_EQ(cases_, 18);
}

TEST_F(Handedness, OfDicomInOneFile) {
    const auto written = [&](const std::string& between, const std::string& more, bool isPlaced = true) {
        DicomMaker d = dicom(0, 10);
        d.between = between;
        d.enhanced = more;
        if (!isPlaced) {
            d.position.clear();
            d.orientation.clear();
        }
        test::writeBytes(at_ / "frames.dcm", d.bytes());
    };
    const DicomMaker maker;
    std::string forth, back;
    for (int k = 0; k < 10; ++k) {
        forth += (k > 0 ? "\\" : "") + std::to_string(0.2 * k);
        back += (k > 0 ? "\\" : "") + std::to_string(-0.2 * k);
    }
    written("", maker.element(0x3004, 0xc, "DS", forth));
    expect(1, "offsets");
    written("", maker.element(0x3004, 0xc, "DS", back));
    expect(-1, "offsets back");
    written("-0.2", "");
    expect(-1, "minus between");
    written("0.2", "");
    expect(0, "between", "the file does not tell whether its slices are counted upwards or downwards");
    written("", maker.element(0x18, 0x50, "DS", "0.2"));
    expect(0, "thickness", "the file does not tell whether its slices are counted upwards or downwards");
    written("0.2", "", false);
    expect(0, "no place", "the file does not tell where its frames lie");
    EXPECT_EQ(cases_, 6);
}

TEST_F(Handedness, OfNifti) {
    nifti_1_header plain{};
    plain.sizeof_hdr = 348;
    plain.dim[0] = 3;
    plain.dim[1] = 24;
    plain.dim[2] = 18;
    plain.dim[3] = 10;
    plain.datatype = 4;
    plain.bitpix = 16;
    plain.vox_offset = 352;
    plain.pixdim[0] = plain.pixdim[1] = plain.pixdim[2] = plain.pixdim[3] = 0.2f;
    std::memcpy(plain.magic, "n+1", 4);
    const auto written = [&](const nifti_1_header& h) {
        writePixels("a.nii", std::string(reinterpret_cast<const char*>(&h), sizeof h) + std::string(4, '\0'));
    };
    for (const auto& s : kSigns) {
        nifti_1_header h = plain;
        h.sform_code = 1;
        h.srow_x[0] = 0.2f * static_cast<float>(s[0]);
        h.srow_y[1] = 0.2f * static_cast<float>(s[1]);
        h.srow_z[2] = 0.2f * static_cast<float>(s[2]);
        written(h);
        expect(product(s), "sform " + named(s));
    }
    for (const int qfac : {1, -1})
        for (const float turned : {0.0f, 0.6f}) {
            nifti_1_header h = plain;
            h.qform_code = 1;
            h.pixdim[0] = static_cast<float>(qfac);
            h.quatern_c = turned;
            written(h);
            expect(qfac, "qform");
        }
    written(plain);
    expect(0, "neither", "its header tells no orientation");
    EXPECT_EQ(cases_, 13);
}

TEST_F(Handedness, OfNrrd) {
    const std::string head = "NRRD0005\ntype: short\ndimension: 3\nsizes: 24 18 10\nendian: little\nencoding: raw\n";
    const auto directions = [](int sign) {
        return "space directions: (0.2,0,0) (0,0.2,0) (0,0," + std::string(sign < 0 ? "-" : "") + "0.2)\n\n";
    };
    const std::map<std::string, int> spaces{{"left-posterior-superior", 1}, {"RAS", 1},         {"LAS", -1},
                                            {"left-anterior-superior", -1}, {"scanner-xyz", 1}, {"3D-left-handed", -1},
                                            {"3D-right-handed", 1}};
    for (const auto& [space, hand] : spaces)
        for (const int sign : {1, -1}) {
            writePixels("a.nrrd", head + "space: " + space + "\n" + directions(sign));
            expect(hand * sign, space);
        }
    writePixels("a.nrrd", head + "space dimension: 3\n" + directions(1));
    expect(0, "no name", "its header does not name the space");
    writePixels("a.nrrd", head + "space: somebodys\n" + directions(1));
    expect(0, "odd name", "the space that its header names is not known");
    writePixels("a.nrrd", head + "spacings: 0.2 0.2 0.2\n\n");
    expect(0, "no directions", "its header tells no space directions");
    EXPECT_EQ(cases_, 17);
}

TEST_F(Handedness, OfMetaImageAndRaw) {
    const std::string meta =
        "ObjectType = Image\nNDims = 3\nDimSize = 24 18 10\nElementType = MET_SHORT\nElementSpacing = 0.2 0.2 0.2\n";
    for (const auto& s : kSigns) {
        writePixels("a.mha", meta + "TransformMatrix = " + std::to_string(s[0]) + " 0 0 0 " + std::to_string(s[1]) +
                                 " 0 0 0 " + std::to_string(s[2]) + "\nElementDataFile = LOCAL\n");
        expect(product(s), "MetaImage " + named(s));
    }
    writePixels("a.mha", meta + "ElementDataFile = LOCAL\n");
    expect(0, "MetaImage", "its header tells no TransformMatrix");
    const std::string raw = "file = \"a.raw\"\nsize = [24, 18, 10]\ntype = \"int16\"\nspacing_mm = [0.2, 0.2, 0.2]\n";
    for (const int sign : {1, -1}) {
        writePixels("a.raw", "");
        test::writeBytes(at_ / "scan.toml", raw + "axes = [1, 0, 0, 0, 1, 0, 0, 0, " + std::to_string(sign) + "]\n");
        expect(sign, "raw");
    }
    writePixels("a.raw", "");
    test::writeBytes(at_ / "scan.toml", raw);
    expect(0, "raw", "the description of its numbers tells no axes");
    EXPECT_EQ(cases_, 12);
}

TEST_F(Handedness, OfPictures) {
    const ScanFormat all[] = {ScanFormat::bmp, ScanFormat::jpeg, ScanFormat::png, ScanFormat::tiff};
    for (const ScanFormat format : all)
        for (const bool isBackward : {false, true}) {
            writeScan(phantom_, at_, format);
            fs::remove(at_ / "scan.toml");
            if (isBackward)  // numbered from the other end
                for (const auto& e : fs::directory_iterator(at_)) {
                    const std::string name = e.path().filename().string();
                    fs::rename(e.path(), at_ / ("z" + std::to_string(90 - std::stoi(name.substr(6, 4))) +
                                                e.path().extension().string()));
                }
            expect(0, "pictures", "pictures do not tell from which end they are numbered");
        }
    for (const int sign : {1, -1}) {
        Volume one = phantom_;
        writeScan(one, at_, ScanFormat::png);
        test::writeBytes(at_ / "scan.toml", "spacing_mm = [0.2, 0.2, 0.2]\naxes = [1, 0, 0, 0, 1, 0, 0, 0, " +
                                                std::to_string(sign) + "]\n");
        expect(sign, "pictures with axes");
    }
    // Pages, told by nobody and by a description.
    for (const bool isTold : {false, true}) {
        fs::create_directories(at_);
        TIFF* tiff = TIFFOpen((at_ / "stack.tif").c_str(), "w");
        for (int k = 0; k < 10; ++k) {
            TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 24);
            TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 18);
            TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
            TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
            TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
            std::vector<std::int16_t> page = numbersOf(k, 1);
            for (int y = 0; y < 18; ++y)
                TIFFWriteScanline(tiff, page.data() + 24 * y, static_cast<std::uint32_t>(y), 0);
            TIFFWriteDirectory(tiff);
        }
        TIFFClose(tiff);
        if (isTold) test::writeBytes(at_ / "scan.toml", "axes = [1, 0, 0, 0, 1, 0, 0, 0, -1]\n");
        expect(isTold ? -1 : 0, "pages", "pages do not tell from which end");
    }
    EXPECT_EQ(cases_, 12);
}

TEST_F(Handedness, OneSliceHasNoOtherEnd) {
    Volume one = phantom_;
    one.grid.size[2] = 1;
    one.values.resize(one.grid.count());
    writeScan(one, at_, ScanFormat::png);
    fs::remove(at_ / "scan.toml");
    EXPECT_TRUE(findSeries(at_)[0].isSideKnown);
}

}  // namespace
}  // namespace handpiece::volume::handedness_test
