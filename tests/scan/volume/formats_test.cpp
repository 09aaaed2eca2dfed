// SPDX-License-Identifier: Apache-2.0
// NRRD, MetaImage, NIfTI and raw numbers, made by hand after their descriptions and by NIfTI's own library.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nifti1_io.h>
#include <zlib.h>

#include "scan_support.h"

namespace handpiece::volume::formats_test {
namespace {

using test::errorOf;
using test::numbers;
using test::zipped;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

class Formats : public testing::Test {
  protected:
    test::TemporaryFolder temporary_;
    [[nodiscard]] std::filesystem::path at(const std::string& name) const { return temporary_.path() / name; }
    [[nodiscard]] Scan read(const std::string& name, const std::string& bytes,
                            const ReadSettings& settings = {}) const {
        test::writeBytes(at(name), bytes);
        return readScan(at(name), settings);
    }
    [[nodiscard]] std::string error(const std::string& name, const std::string& bytes) const {
        return errorOf([&] { (void)read(name, bytes); });
    }
};

/// 4 x 3 x 2, the value of (i, j, k) is 100 k + 10 j + i.
template <class T>
std::vector<T> small() {
    std::vector<T> v;
    for (int k = 0; k < 2; ++k)
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 4; ++i)
                v.push_back(static_cast<T>(100 * k + 10 * j + i));
    return v;
}
const std::vector<float> kSmall = small<float>();

std::string nrrd(const std::string& type, const std::string& more, const std::string& data) {
    return "NRRD0005\n# somebody's remark\ntype: " + type + "\ndimension: 3\nsizes: 4 3 2\n" + more + "\n" + data;
}
const std::string kLittle = "endian: little\nencoding: raw\nspacings: 0.1 0.2 0.3\n";

TEST_F(Formats, NrrdTypesAndByteOrders) {
    for (const bool isBig : {false, true}) {
        const std::string order =
            std::string("endian: ") + (isBig ? "big" : "little") + "\nencoding: raw\nspacings: 0.1 0.2 0.3\n";
        const std::map<std::string, std::string> data{{"uchar", numbers(small<std::uint8_t>())},
                                                      {"signed char", numbers(small<std::int8_t>())},
                                                      {"short", numbers(small<std::int16_t>(), isBig)},
                                                      {"uint16_t", numbers(small<std::uint16_t>(), isBig)},
                                                      {"int", numbers(small<std::int32_t>(), isBig)},
                                                      {"unsigned int", numbers(small<std::uint32_t>(), isBig)},
                                                      {"longlong", numbers(small<std::int64_t>(), isBig)},
                                                      {"float", numbers(small<float>(), isBig)},
                                                      {"double", numbers(small<double>(), isBig)}};
        for (const auto& [type, bytes] : data) {
            const Scan scan = read("a.nrrd", nrrd(type, order, bytes));
            EXPECT_EQ(scan.volume.values, kSmall) << type << isBig;
            EXPECT_EQ(scan.volume.grid.spacingMm, core::Vec3(0.1, 0.2, 0.3));
        }
    }
}

TEST_F(Formats, NrrdPackedDetachedAndSkipped) {
    const std::string data = numbers(small<std::int16_t>());
    const std::string packed = "endian: little\nencoding: gzip\nspacings: 1 1 1\n";
    EXPECT_EQ(read("a.nrrd", nrrd("short", packed, zipped(data, true))).volume.values, kSmall);
    // Two gzip members, as parallel packers write them.
    EXPECT_EQ(read("a.nrrd", nrrd("short", packed, zipped(data.substr(0, 20), true) + zipped(data.substr(20), true)))
                  .volume.values,
              kSmall);
    test::writeBytes(at("b.bin"), "line\nxx" + data);
    EXPECT_EQ(
        read("b.nhdr", nrrd("short", kLittle + "data file: b.bin\nline skip: 1\nbyte skip: 2\n", "")).volume.values,
        kSmall);
    EXPECT_EQ(read("b.nhdr", nrrd("short", kLittle + "data file: b.bin\nbyte skip: -1\n", "")).volume.values, kSmall);
    EXPECT_THAT(error("c.nhdr", nrrd("short", kLittle + "data file: ../b.bin\n", "")), HasSubstr("is missing"));
    EXPECT_THAT(error("c.nhdr", nrrd("short", kLittle + "data file: c%03d.raw 1 9 1\n", "")),
                HasSubstr("a list of files is not read"));
}

TEST_F(Formats, NrrdDirectionsBecomeLpsAndRightHanded) {
    const std::string directions =
        "endian: little\nencoding: raw\nspace: right-anterior-superior\nspace directions: (0,0.5,0) (0.25,0,0) "
        "(0,0,2)\n"
        "space origin: (1,2,3)\nspace units: \"mm\" \"mm\" \"mm\"\n";
    const Volume v = read("a.nrrd", nrrd("float", directions, numbers(kSmall))).volume;
    const Grid& g = v.grid;
    EXPECT_NEAR(g.axes.determinant(), 1.0, 1e-12);
    EXPECT_TRUE(g.spacingMm.isApprox(core::Vec3(0.5, 0.25, 2)));
    // Voxel (i, j, k) of the file lies at (1 + j/4, 2 + i/2, 3 + 2k) in RAS, whatever the order of slices is now.
    for (int k = 0; k < 2; ++k)
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 4; ++i) {
                const core::Vec3 ras(1 + j * 0.25, 2 + i * 0.5, 3 + 2 * k), lps(-ras.x(), -ras.y(), ras.z());
                const core::Vec3 at = g.toVoxels(lps);
                const auto index = g.index(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())),
                                           static_cast<int>(std::lround(at.z())));
                EXPECT_LE((at - at.array().round().matrix()).norm(), 1e-9);
                EXPECT_EQ(v.values[index], static_cast<float>(100 * k + 10 * j + i));
            }
}

TEST_F(Formats, NrrdUnitsShearAndBadSpacing) {
    const std::string um =
        "endian: little\nencoding: raw\nspace dimension: 3\nspace directions: (50,0,0) (0,50,0) (0,0,60)\nspace units: "
        "\"um\" \"um\" \"um\"\n";
    EXPECT_TRUE(read("a.nrrd", nrrd("float", um, numbers(kSmall)))
                    .volume.grid.spacingMm.isApprox(core::Vec3(0.05, 0.05, 0.06)));
    const std::string skew = "endian: little\nencoding: raw\nspace directions: (1,0,0) (1,1,0) (0,0,1)\n";
    EXPECT_THAT(error("a.nrrd", nrrd("float", skew, numbers(kSmall))), HasSubstr("right angles"));
    for (const char* wrong : {"0 1 1", "nan 1 1", "-1 1 1", "inf 1 1", "1 1"})
        EXPECT_THAT(
            error("a.nrrd", nrrd("float", "endian: little\nencoding: raw\nspacings: " + std::string(wrong) + "\n",
                                 numbers(kSmall))),
            AllOf(HasSubstr("spacing"), HasSubstr("a.nrrd")))
            << wrong;
    EXPECT_THAT(error("a.nrrd", nrrd("float", "endian: little\nencoding: raw\n", numbers(kSmall))),
                HasSubstr("tells no spacing"));
}

TEST_F(Formats, NrrdUnitsAreKnownOrAskedFor) {
    const auto written = [](const std::string& first, const std::string& last, double step) {
        const std::string n = std::to_string(step);
        return nrrd("float",
                    "endian: little\nencoding: raw\nspace dimension: 3\nspace directions: (" + n + ",0,0) (0," + n +
                        ",0) (0,0," + n + ")\nspace origin: (" + n + ",0,0)\nspace units: \"" + first + "\" \"" +
                        first + "\" \"" + last + "\"\n",
                    numbers(kSmall));
    };
    const std::map<std::string, double> units{
        {"micrometers", 1e-3}, {"micrometres", 1e-3}, {"Microns", 1e-3}, {"\xc2\xb5m", 1e-3}, {"\xce\xbcm", 1e-3},
        {"millimeters", 1.0},  {"centimetres", 10.0}, {"inches", 25.4},  {"in", 25.4},        {"", 1.0}};
    for (const auto& [unit, mm] : units) {
        const Grid grid = read("a.nrrd", written(unit, unit, 0.2 / mm)).volume.grid;
        EXPECT_TRUE(grid.spacingMm.isApprox(core::Vec3::Constant(0.2), 1e-3)) << unit;
        EXPECT_NEAR(grid.originMm.x(), 0.2, 1e-3) << unit;
    }
    EXPECT_TRUE(read("a.nrrd", written("mm", "um", 50)).volume.grid.spacingMm.isApprox(core::Vec3(50, 50, 0.05)));
    for (const auto& [first, last] : {std::pair("cubits", "cubits"), std::pair("mm", "cubits")}) {
        EXPECT_THAT(error("a.nrrd", written(first, last, 0.2)),
                    AllOf(HasSubstr("unit \"cubits\" is not known"), HasSubstr("give the spacing")));
        ReadSettings settings;
        settings.spacingMm = core::Vec3(0.1, 0.1, 0.2);
        EXPECT_EQ(read("a.nrrd", written(first, last, 0.2), settings).volume.grid.spacingMm, *settings.spacingMm);
    }
}

TEST_F(Formats, NrrdBadInput) {
    const std::string data = numbers(small<std::int16_t>());
    EXPECT_THAT(error("a.nrrd", nrrd("short", kLittle, data.substr(0, 30))),
                AllOf(HasSubstr("truncated: 30 of 48"), HasSubstr("a.nrrd")));
    EXPECT_THAT(error("a.nrrd", nrrd("short", "encoding: raw\n", data)), HasSubstr("byte order"));
    EXPECT_THAT(error("a.nrrd", nrrd("block", kLittle, data)), HasSubstr("\"block\""));
    EXPECT_THAT(error("a.nrrd", nrrd("short", "endian: little\nencoding: bzip2\n", data)), HasSubstr("bzip2"));
    EXPECT_THAT(error("a.nrrd", "NRRD0005\ntype: short\n"), HasSubstr("does not end"));
    EXPECT_THAT(error("a.nrrd", nrrd("short", "endian: little\nencoding: gzip\nspacings: 1 1 1\n",
                                     zipped(data, true).substr(0, 25))),
                HasSubstr("ends before"));
    EXPECT_THAT(error("a.nrrd", "NRRD0005\ntype: uchar\ndimension: 4\nsizes: 2 2 2 2\nencoding: raw\n\n"),
                HasSubstr("dimensions"));
}

TEST_F(Formats, HeadersThatClaim40GigabytesAreRefused) {
    EXPECT_THAT(error("a.nrrd", "NRRD0005\ntype: short\ndimension: 3\nsizes: 3000 3000 1100\n" + kLittle + "\nabc"),
                HasSubstr("GB of memory"));
    EXPECT_THAT(
        error("a.nrrd", "NRRD0005\ntype: short\ndimension: 3\nsizes: 900000 900000 900000\n" + kLittle + "\nabc"),
        HasSubstr("no memory holds"));
    EXPECT_THAT(error("a.nrrd", "NRRD0005\ntype: short\ndimension: 3\nsizes: 3000 -3000 9000000000000000000000\n" +
                                    kLittle + "\nabc"),
                HasSubstr("cannot be"));
    EXPECT_THAT(error("a.mha",
                      "NDims = 3\nDimSize = 3000 3000 1100\nElementType = MET_FLOAT\nElementSpacing = 1 1 "
                      "1\nElementDataFile = LOCAL\n"),
                HasSubstr("GB of memory"));
    nifti_1_header h{};
    h.sizeof_hdr = 348;
    h.dim[0] = 3;
    h.dim[1] = h.dim[2] = 30000;
    h.dim[3] = 11;
    h.datatype = 4;
    h.vox_offset = 352;
    std::memcpy(h.magic, "n+1", 4);
    EXPECT_THAT(error("a.nii", std::string(reinterpret_cast<const char*>(&h), sizeof h)), HasSubstr("GB of memory"));
    test::writeBytes(at("scan.raw"), "abc");
    EXPECT_THAT(error("scan.toml",
                      "file = \"scan.raw\"\nsize = [3000, 3000, 1100]\ntype = \"uint16\"\nspacing_mm = [1, 1, 1]\n"),
                HasSubstr("GB of memory"));
    // Within the limit and not within the file.
    EXPECT_THAT(error("a.nrrd",
                      "NRRD0005\ntype: short\ndimension: 3\nsizes: 300 300 300\nendian: little\nencoding: "
                      "gzip\nspacings: 1 1 1\n\nabc"),
                HasSubstr("cannot hold"));
    ReadSettings tight;
    tight.limitBytes = 95;
    EXPECT_THAT(errorOf([&] { (void)read("b.nrrd", nrrd("float", kLittle, numbers(kSmall)), tight); }),
                HasSubstr("memory"));
    tight.limitBytes = 96;
    EXPECT_EQ(read("b.nrrd", nrrd("float", kLittle, numbers(kSmall)), tight).volume.values, kSmall);
}

std::string metaImage(const std::string& more, const std::string& data, const std::string& type = "MET_SHORT") {
    return "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = " + type + "\n" + more +
           "ElementDataFile = LOCAL\n" + data;
}

TEST_F(Formats, MetaImage) {
    const std::string data = numbers(small<std::int16_t>()), big = numbers(small<std::int16_t>(), true);
    const std::string spacing = "ElementSpacing = 0.1 0.2 0.3\n";
    EXPECT_EQ(read("a.mha", metaImage(spacing, data)).volume.values, kSmall);
    EXPECT_EQ(read("a.mha", metaImage(spacing + "BinaryDataByteOrderMSB = True\n", big)).volume.values, kSmall);
    EXPECT_EQ(read("a.mha", metaImage(spacing + "CompressedData = True\n", zipped(data, false))).volume.values, kSmall);
    const Grid g =
        read("a.mha", metaImage(spacing + "Offset = 1 2 3\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\n", data)).volume.grid;
    EXPECT_EQ(g.originMm, core::Vec3(1, 2, 3));
    EXPECT_TRUE(core::Vec3(g.axes.col(0)).isApprox(core::Vec3(0, 1, 0)));
    EXPECT_TRUE(core::Vec3(g.axes.col(1)).isApprox(core::Vec3(-1, 0, 0)));
    test::writeBytes(at("v.raw"), "head" + data);
    std::string detached = metaImage(spacing + "HeaderSize = -1\n", "");
    detached.replace(detached.find("LOCAL"), 5, "v.raw");
    EXPECT_EQ(read("v.mhd", detached).volume.values, kSmall);
    EXPECT_EQ(readScan(temporary_.path(),
                       [] {
                           ReadSettings s;
                           s.takeLargest = true;
                           return s;
                       }())
                  .volume.values,
              kSmall);
    EXPECT_THAT(error("a.mha", metaImage(spacing, data.substr(1))), HasSubstr("truncated"));
    EXPECT_THAT(error("a.mha", metaImage("", data)), HasSubstr("tells no spacing"));
    EXPECT_THAT(error("a.mha", metaImage("ElementSpacing = 0 1 1\n", data)), HasSubstr("spacing of 0 x 1 x 1"));
    EXPECT_THAT(error("a.mha", metaImage(spacing + "ElementNumberOfChannels = 3\n", data)),
                HasSubstr("3 values a voxel"));
    EXPECT_THAT(error("a.mha", "ObjectType = Image\n"), HasSubstr("ElementDataFile"));
}

TEST_F(Formats, ALinkOutOfTheFolderIsNotFollowed) {
    namespace fs = std::filesystem;
    const std::string data = numbers(small<std::int16_t>());
    test::writeBytes(at("outside.raw"), data);
    std::string mhd = metaImage("ElementSpacing = 1 1 1\n", "");
    mhd.replace(mhd.find("LOCAL"), 5, "link.raw");
    test::writeBytes(at("scan/a.mhd"), mhd);
    test::writeBytes(at("scan/b.nhdr"), nrrd("short", kLittle + "data file: link.raw\n", ""));
    const auto readBoth = [&](const fs::path& target) {
        fs::remove(at("scan/link.raw"));
        fs::create_symlink(target, at("scan/link.raw"));
        std::array<std::string, 2> told;
        told[0] = errorOf([&] { (void)readScan(at("scan/a.mhd")); });
        told[1] = errorOf([&] { (void)readScan(at("scan/b.nhdr")); });
        return told;
    };
    for (const fs::path& target : {at("outside.raw"), fs::path("../outside.raw")})
        for (const std::string& told : readBoth(target))
            EXPECT_THAT(told, AllOf(HasSubstr("leads out of the scan's folder"), HasSubstr("link.raw")));
    // Within the folder a link is as good as a file.
    test::writeBytes(at("scan/v.raw"), data);
    for (const std::string& told : readBoth("v.raw"))
        EXPECT_EQ(told, "");
}

TEST_F(Formats, DamagedDirectionsAreToldAsSuch) {
    const std::string data = numbers(small<std::int16_t>()),
                      spacing = "ElementSpacing = 0.1 0.1 0.1\nTransformMatrix = ";
    for (const char* wrong : {"1 0 0 0 1 0 0 0 x", "1 0 0 0 1 0 0 0", "1 0 0 0 1 0 0 0 1 0", "1 0 0 0 1 0 0 0 nan"})
        EXPECT_THAT(error("a.mha", metaImage(spacing + wrong + "\n", data)),
                    AllOf(HasSubstr("TransformMatrix is not nine numbers"), HasSubstr("a.mha")))
            << wrong;
    EXPECT_THAT(error("a.mha", metaImage(spacing + "1 0 0 0 1 0 0 0 0\n", data)), HasSubstr("is 0 0 0"));
    EXPECT_THAT(error("a.mha", metaImage(spacing + "1 0 0 0 1 0 0 1 0\n", data)), HasSubstr("directions are damaged"));
    EXPECT_THAT(
        error("a.nrrd",
              nrrd("short", "endian: little\nencoding: raw\nspace directions: (1,0,0) (0,1,0) (1,1,0)\n", data)),
        HasSubstr("directions are damaged"));
}

TEST_F(Formats, ValuesAsTextAreRefused) {
    std::string text;
    for (const float v : kSmall)
        text += "0" + std::to_string(static_cast<int>(v)) + " ";
    for (const char* no : {"False", "false", "0"})
        EXPECT_THAT(error("a.mha", metaImage("ElementSpacing = 1 1 1\nBinaryData = " + std::string(no) + "\n", text)),
                    AllOf(HasSubstr("as text"), HasSubstr("a.mha"), HasSubstr("binary values")));
    EXPECT_EQ(read("a.mha", metaImage("ElementSpacing = 1 1 1\nBinaryData = True\n", numbers(small<std::int16_t>())))
                  .volume.values,
              kSmall);
    for (const char* encoding : {"ascii", "text", "txt", "hex"})
        EXPECT_THAT(
            error("a.nrrd",
                  nrrd("short", "endian: little\nspacings: 1 1 1\nencoding: " + std::string(encoding) + "\n", text)),
            AllOf(HasSubstr(encoding), HasSubstr("raw or gzip")));
}

std::vector<std::pair<int, std::string>> namesIn(const Scan& scan) {
    std::vector<std::pair<int, std::string>> names;
    for (const LabelName& name : scan.series.labelNames)
        names.emplace_back(name.value, name.name);
    return names;
}

TEST_F(Formats, NamesOfLabelsAreRead) {
    using Names = std::vector<std::pair<int, std::string>>;
    const std::string data = numbers(small<std::uint8_t>());
    const std::string slicer =
        kLittle +
        "Segment0_Color:=0.5 0.5 0.5\nSegment0_ID:=Segment_1\nSegment0_LabelValue:=46\nSegment0_Name:=Lower right "
        "first molar\nSegment1_LabelValue:=2\nSegment1_Name:=Mandible\nSegment2_Name:=of no value\n"
        "Segment3_LabelValue:=400\nSegment3_Name:=too large\nPatient:=whose is nobody's business\n";
    EXPECT_EQ(namesIn(read("a.seg.nrrd", nrrd("uchar", slicer, data))),
              (Names{{2, "Mandible"}, {46, "Lower right first molar"}}));
    EXPECT_TRUE(namesIn(read("a.nrrd", nrrd("uchar", kLittle, data))).empty());
    EXPECT_THAT(error("a.seg.nrrd",
                      "NRRD0005\ntype: uchar\ndimension: 4\nsizes: 2 4 3 2\nkinds: list domain domain "
                      "domain\nencoding: raw\nSegment0_LabelValue:=1\nSegment0_Name:=a\n\n" +
                          data + data),
                HasSubstr("several layers of labels"));
    EXPECT_THAT(error("a.nrrd",
                      "NRRD0005\ntype: uchar\ndimension: 4\nsizes: 3 4 3 2\nkinds: RGB-color domain domain "
                      "domain\nencoding: raw\n\n" +
                          data + data + data),
                HasSubstr("colours"));
    // The table that TotalSegmentator writes behind a NIfTI header.
    const std::string xml =
        "<?xml version=\"1.0\"?><CaretExtension><VolumeInformation Index=\"0\"><LabelTable>"
        "<Label Key=\"11\" Red=\"1\" Alpha=\"1\"><![CDATA[upper_right_central_incisor_fdi11]]></Label>\n"
        "<Label Key=\"19\">upper_left_central_incisor_fdi21</Label><Label Key=\"0\"><![CDATA[nothing]]></Label>"
        "</LabelTable></VolumeInformation></CaretExtension>";
    for (const bool isPacked : {false, true}) {
        std::string bytes(348, '\0');
        const auto put = [&](std::size_t place, auto value) { std::memcpy(&bytes[place], &value, sizeof value); };
        put(0, std::int32_t{348});
        const std::int16_t dim[4] = {3, 4, 3, 2};
        std::memcpy(&bytes[40], dim, sizeof dim);
        put(70, std::int16_t{2});
        for (std::size_t i = 1; i < 4; ++i)
            put(76 + 4 * i, 0.3f);
        put(108, static_cast<float>(348 + 4 + 8 + xml.size()));
        std::memcpy(&bytes[344], "n+1", 4);
        bytes += std::string("\1\0\0\0", 4);
        std::string size(8, '\0');
        const auto whole = static_cast<std::int32_t>(8 + xml.size());
        std::memcpy(size.data(), &whole, 4);
        bytes += size + xml + data;
        const Scan scan = read(isPacked ? "a.nii.gz" : "a.nii", isPacked ? zipped(bytes, true) : bytes);
        EXPECT_EQ(scan.volume.values, kSmall);
        EXPECT_EQ(namesIn(scan),
                  (Names{{11, "upper_right_central_incisor_fdi11"}, {19, "upper_left_central_incisor_fdi21"}}));
        std::memcpy(&bytes[70], "\200\0", 2);  // RGB
        EXPECT_THAT(error("b.nii", bytes), HasSubstr("colours"));
    }
}

TEST_F(Formats, LabelsMayBeFloats) {
    Volume volume;
    volume.grid.size = {2, 1, 1};
    volume.values = {46.0f, 10.9999f};
    EXPECT_EQ(toLabels(volume, "x").values, (std::vector<std::uint8_t>{46, 11}));
    volume.values[1] = 10.9f;
    EXPECT_THAT(errorOf([&] { (void)toLabels(volume, "x"); }), HasSubstr("10.9"));
}

TEST_F(Formats, NiftiOfItsOwnLibraryIsReadTheSame) {
    for (const char* name : {"n.nii", "n.nii.gz", "n.hdr"}) {
        const std::int64_t dims[8] = {3, 4, 3, 2, 1, 1, 1, 1};
#ifdef NIFTI2_IO_H
        nifti_image* image = nifti_make_new_nim(dims, DT_INT16, 1);
#else
        const int narrow[8] = {3, 4, 3, 2, 1, 1, 1, 1};
        (void)dims;
        nifti_image* image = nifti_make_new_nim(narrow, DT_INT16, 1);
#endif
        const auto values = small<std::int16_t>();
        std::memcpy(image->data, values.data(), values.size() * 2);
        image->xyz_units = NIFTI_UNITS_MICRON;
        image->dx = image->pixdim[1] = 100;
        image->dy = image->pixdim[2] = 200;
        image->dz = image->pixdim[3] = 300;
        image->scl_slope = 2;
        image->scl_inter = -5;
        image->qform_code = 1;
        image->quatern_d = 0.5f;  // turned about z
        image->qoffset_x = 1000;
        image->qoffset_y = 2000;
        image->qoffset_z = 3000;
        image->qfac = 1;
        image->qto_xyz = nifti_quatern_to_mat44(image->quatern_b, image->quatern_c, image->quatern_d, image->qoffset_x,
                                                image->qoffset_y, image->qoffset_z, image->dx, image->dy, image->dz, 1);
        if (std::string(name) == "n.hdr") image->nifti_type = NIFTI_FTYPE_NIFTI1_2;
        ASSERT_EQ(nifti_set_filenames(image, at(name).c_str(), 0, 1), 0);
        nifti_image_write(image);
        const Volume v = readScan(at(name)).volume;
        for (int k = 0; k < 2; ++k)
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < 4; ++i) {
                    const auto& m = image->qto_xyz.m;
                    core::Vec3 ras;
                    for (int r = 0; r < 3; ++r)
                        ras[r] = 1e-3 *
                                 static_cast<double>(m[r][0] * static_cast<float>(i) + m[r][1] * static_cast<float>(j) +
                                                     m[r][2] * static_cast<float>(k) + m[r][3]);
                    EXPECT_LE((v.grid.toMm({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}) -
                               core::Vec3(-ras.x(), -ras.y(), ras.z()))
                                  .norm(),
                              1e-5);
                    EXPECT_EQ(v.values[v.grid.index(i, j, k)], static_cast<float>(2 * (100 * k + 10 * j + i) - 5));
                }
        nifti_image_free(image);
    }
}

TEST_F(Formats, NiftiOfOursIsReadByItsLibrary) {
    Volume scan = test::sampleVolume({12, 9, 5}, -800);
    scan.grid.axes = test::obliqueAxes();
    writeScan(scan, temporary_.path(), ScanFormat::nifti);
    nifti_image* image = nifti_image_read(at("scan.nii").c_str(), 1);
    ASSERT_TRUE(image);
    ASSERT_EQ(image->nvox, 12u * 9u * 5u);
    const auto* data = static_cast<const std::int16_t*>(image->data);
    for (std::size_t i = 0; i < scan.values.size(); ++i)
        ASSERT_EQ(static_cast<float>(data[i]), scan.values[i]);
    const core::Vec3 mm = scan.grid.toMm({3, 4, 2});
    for (int r = 0; r < 3; ++r) {
        const auto& m = image->sto_xyz.m[r];
        EXPECT_NEAR(static_cast<double>(m[0] * 3 + m[1] * 4 + m[2] * 2 + m[3]), (r < 2 ? -1 : 1) * mm[r], 1e-4);
    }
    nifti_image_free(image);
}

TEST_F(Formats, NiftiSwappedLeftHandedAndBroken) {
    nifti_1_header h{};
    h.sizeof_hdr = 348;
    h.dim[0] = 3;
    h.dim[1] = 4;
    h.dim[2] = 3;
    h.dim[3] = 2;
    h.datatype = 512;
    h.bitpix = 16;
    h.vox_offset = 352;
    h.pixdim[1] = h.pixdim[2] = h.pixdim[3] = 0.5f;
    h.sform_code = 1;
    h.srow_x[0] = -0.5f;  // right to left: with LPS' two flips this is left-handed
    h.srow_y[1] = 0.5f;
    h.srow_z[2] = 0.5f;
    std::memcpy(h.magic, "n+1", 4);
    const auto bytes = [](const nifti_1_header& header) {
        return std::string(reinterpret_cast<const char*>(&header), sizeof header) + std::string(4, '\0');
    };
    const Volume v = read("a.nii", bytes(h) + numbers(small<std::uint16_t>())).volume;
    EXPECT_NEAR(v.grid.axes.determinant(), 1.0, 1e-9);
    EXPECT_EQ(v.values[0], 100.0f);  // the last slice comes first now
    EXPECT_TRUE(v.grid.toMm({0, 0, 0}).isApprox(core::Vec3(0, 0, 0.5)));
    nifti_1_header swapped = h;
    swap_nifti_header(&swapped, 1);
    EXPECT_EQ(read("b.nii", bytes(swapped) + numbers(small<std::uint16_t>(), true)).volume.values, v.values);
    EXPECT_THAT(error("c.nii", bytes(h) + "abc"), HasSubstr("truncated"));
    EXPECT_THAT(error("c.nii", bytes(h).substr(0, 200)), HasSubstr("header"));
    h.sform_code = 0;
    for (const float wrong : {0.0f, NAN, INFINITY}) {
        h.pixdim[2] = wrong;
        EXPECT_THAT(error("c.nii", bytes(h) + numbers(small<std::uint16_t>())), HasSubstr("spacing")) << wrong;
    }
    h.datatype = 128;
    EXPECT_THAT(error("c.nii", bytes(h)), HasSubstr("colours"));
}

TEST_F(Formats, LabelsAreReadAsWhatTheyAre) {
    std::string values(10 * 9 * 8, '\0');
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<char>(i % 7 == 0 ? 46 : i % 5 == 0 ? 11 : 0);
    const std::string head = "spacings: 0.3 0.3 0.3\nencoding: raw\n";
    test::writeBytes(at("a.nrrd"), "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 10 9 8\n" + head + "\n" + values);
    for (const bool isReversed : {false, true})
        for (const std::uint64_t limit : {std::uint64_t{1} << 20, std::uint64_t{10 * 9 * 8 * 4}}) {
            ReadSettings settings;
            settings.reverseSlices = isReversed;
            settings.limitBytes = limit;
            settings.isLabels = true;
            settings.regionMm = std::array{core::Vec3(0.3, 0, 0), core::Vec3(2.1, 2.4, 1.5)};
            const Scan scan = readScan(at("a.nrrd"), settings);
            const LabelScan labels = readLabels(at("a.nrrd"), settings);
            EXPECT_EQ(labels.labels.values, toLabels(scan.volume, "a").values);
            EXPECT_EQ(labels.labels.grid.originMm, scan.volume.grid.originMm);
            EXPECT_EQ(labels.series.thumbnail, scan.series.thumbnail);
        }
    test::writeBytes(at("b.nrrd"),
                     "NRRD0004\ntype: short\ndimension: 3\nsizes: 5 9 8\nendian: little\n" + head + "\n" + values);
    EXPECT_THAT(errorOf([&] { (void)readLabels(at("b.nrrd")); }), AllOf(HasSubstr("b.nrrd"), HasSubstr("no label")));
    values[315] = static_cast<char>(200);
    // Slices that lie askew are put straight, and no number comes up that was not there.
    test::writeBytes(at("c.nrrd"),
                     "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 10 9 8\nspace: left-posterior-superior\n"
                     "space directions: (1,0,0) (0,1,0) (0.4,0.3,1)\nencoding: raw\n\n" +
                         values);
    const LabelScan straight = readLabels(at("c.nrrd"));
    EXPECT_THAT(straight.series.notes, testing::Contains(HasSubstr("straightened")));
    EXPECT_EQ(straight.labels.grid.size, (std::array{13, 12, 8}));
    EXPECT_EQ(std::count(straight.labels.values.begin(), straight.labels.values.end(), 200), 1);
    EXPECT_THAT(straight.labels.values, testing::Each(testing::AnyOf(0, 11, 46, 200)));
}

// Some kilobytes that claim millions of voxels, and have them: nothing is in them.
TEST_F(Formats, APackedVolumeOfOneValueIsToldBeforeRoomIsMadeForIt) {
    const std::string head =
        "NRRD0004\ntype: short\ndimension: 3\nsizes: 400 400 250\nendian: little\nencoding: gzip\nspacings: 1 1 1\n\n";
    std::string values(2 * 400 * 400 * 250, '\0');
    for (const char value : {'\0', '\7'}) {
        for (std::size_t i = 0; i < values.size(); i += 2)
            values[i] = value;
        EXPECT_THAT(error("a.nrrd", head + zipped(values, true)),
                    AllOf(HasSubstr("a.nrrd"), HasSubstr("all its voxels have the same value")));
    }
    values.resize(values.size() - 1);
    EXPECT_THAT(error("a.nrrd", head + zipped(values, true)), HasSubstr("ends before the last value"));
    values += '\1';
    const Volume v = read("a.nrrd", head + zipped(values, true)).volume;
    EXPECT_EQ(v.values.front(), 7.0f);
    EXPECT_EQ(v.values.back(), 256.0f + 7.0f);
}

TEST_F(Formats, RawByItsDescription) {
    const std::string text = "file = \"t.raw\"\nsize = [4, 3, 2]\ntype = \"uint16\"\nspacing_mm = [0.1, 0.2, 0.3]\n";
    test::writeBytes(at("t.raw"), numbers(small<std::uint16_t>(), true));
    test::writeBytes(at("scan.toml"), text + "byte_order = \"big\"\n");
    for (const char* name : {"t.raw", "scan.toml", ""})
        EXPECT_EQ(readScan(at(name)).volume.values, kSmall) << name;
    test::writeBytes(at("scan.toml"), text + "byte_order = \"big\"\nslope = 0.5\nintercept = 7\n");
    EXPECT_EQ(readScan(at("")).volume.values[23], 0.5f * 123 + 7);
    EXPECT_THAT(error("scan.toml", text + "header_bytes = 1\n"), HasSubstr("truncated"));
    EXPECT_THAT(error("scan.toml", "file = \"t.raw\"\nsize = [4, 3, 1]\ntype = \"uint16\"\nspacing_mm = [1, 1, 1]\n"),
                AllOf(HasSubstr("48 bytes"), HasSubstr("are 24")));
    EXPECT_THAT(error("scan.toml", "file = \"t.raw\"\nsize = [4, 3, 2]\ntype = \"uint16\"\n"), HasSubstr("spacing_mm"));
    EXPECT_THAT(error("scan.toml", text + "byteorder = \"big\"\n"), HasSubstr("byteorder"));
    EXPECT_THAT(error("scan.toml", "file = \"none.raw\"\nsize = [4, 3, 2]\ntype = \"uint16\"\n"),
                HasSubstr("\"none.raw\" is missing"));
    EXPECT_THAT(error("scan.toml", "file = \"/etc/passwd\"\nsize = [4, 3, 2]\ntype = \"uint8\"\n"),
                HasSubstr("is missing"));
    EXPECT_THAT(error("scan.toml", "file = \"t.raw\"\nsize = [4, 3, 2]\ntype = \"uint17\"\n"), HasSubstr("uint17"));
    for (const char* wrong : {"[0, 1, 1]", "[nan, 1, 1]", "[1, 1]", "[-1, 1, 1]"})
        EXPECT_THAT(error("scan.toml", "file = \"t.raw\"\nsize = [4, 3, 2]\ntype = \"uint16\"\nspacing_mm = " +
                                           std::string(wrong) + "\n"),
                    HasSubstr("spacing_mm"))
            << wrong;
    std::filesystem::remove(at("scan.toml"));
    EXPECT_THAT(errorOf([&] { (void)readScan(at("t.raw")); }), HasSubstr("write a scan.toml"));
}

TEST_F(Formats, WrongByteOrderIsToldAndRightOneIsNot) {
    std::mt19937_64 generator(test::seed());
    const Volume smooth = test::sampleVolume({40, 40, 30}, 300, 3000);
    std::vector<std::uint16_t> values(smooth.values.begin(), smooth.values.end()), noise(values.size()),
        dark(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        noise[i] = static_cast<std::uint16_t>(generator());
        dark[i] = static_cast<std::uint16_t>(generator() & 0xff);
    }
    const auto told = [&](const std::vector<std::uint16_t>& v, bool isBigInFile, bool isBigInHeader) {
        test::writeBytes(at("s.raw"), numbers(v, isBigInFile));
        return error(
            "scan.toml",
            std::string(
                "file = \"s.raw\"\nsize = [40, 40, 30]\ntype = \"uint16\"\nspacing_mm = [1, 1, 1]\nbyte_order = \"") +
                (isBigInHeader ? "big" : "little") + "\"\n");
    };
    EXPECT_EQ(told(values, false, false), "");
    EXPECT_EQ(told(values, true, true), "");
    EXPECT_THAT(told(values, true, false), AllOf(HasSubstr("s.raw"), HasSubstr("byte_order = \"big\"")));
    EXPECT_THAT(told(values, false, true), HasSubstr("byte_order = \"little\""));
    // What is noise either way, or nothing, is let pass.
    EXPECT_EQ(told(noise, false, false), "");
    EXPECT_EQ(told(dark, false, false), "");
    EXPECT_EQ(told(std::vector<std::uint16_t>(values.size(), 7), false, false), "");
    EXPECT_THAT(error("o.nrrd", "NRRD0005\ntype: ushort\ndimension: 3\nsizes: 40 40 30\n" + kLittle + "\n" +
                                    numbers(values, true)),
                HasSubstr("endian: big"));
}

TEST_F(Formats, NonNumbersAreReadAsNothingAndTold) {
    std::vector<float> values = kSmall;
    values[3] = NAN;
    values[5] = INFINITY;
    const Scan scan = read("a.nrrd", nrrd("float", kLittle, numbers(values)));
    EXPECT_EQ(scan.volume.values[3], 0.0f);
    EXPECT_EQ(scan.volume.values[5], 0.0f);
    EXPECT_THAT(scan.series.notes, Contains(HasSubstr("2 values are no numbers")));
    values[5] = 7.0f;
    EXPECT_THAT(read("a.nrrd", nrrd("float", kLittle, numbers(values))).series.notes,
                Contains("1 value is no number and was read as 0"));
}

TEST_F(Formats, ValuesOfNoScannerAreReadAsNothing) {
    std::vector<float> values = kSmall;
    values[3] = 3e38f;
    values[13] = -3e38f;
    const Scan scan = read("a.nrrd", nrrd("float", kLittle, numbers(values)));
    EXPECT_EQ(scan.volume.values[3], 0.0f);
    EXPECT_EQ(scan.volume.values[13], 0.0f);
    EXPECT_THAT(scan.series.notes, Contains(HasSubstr("2 values are no numbers")));
    EXPECT_EQ(findSeries(at("a.nrrd"))[0].thumbnail, scan.series.thumbnail);
}

TEST_F(Formats, GivenSpacingWins) {
    ReadSettings settings;
    settings.spacingMm = core::Vec3(0.034, 0.034, 0.034);
    const Scan scan = read("a.nrrd", nrrd("float", kLittle, numbers(kSmall)), settings);
    EXPECT_EQ(scan.volume.grid.spacingMm, *settings.spacingMm);
    EXPECT_EQ(scan.series.spacingMm, *settings.spacingMm);
    settings.spacingMm = core::Vec3(0.034, NAN, 0.034);
    EXPECT_NE(errorOf([&] { (void)read("a.nrrd", nrrd("float", kLittle, numbers(kSmall)), settings); }), "");
}

}  // namespace
}  // namespace handpiece::volume::formats_test
