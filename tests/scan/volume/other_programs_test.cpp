// SPDX-License-Identifier: Apache-2.0
// DICOM files that other programs wrote or rewrote are read bit for bit; what we write, they read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "scan_support.h"

namespace handpiece::volume::other_programs_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

bool hasTool(const std::string& name) {
    return std::system(("command -v " + name + " >/dev/null 2>&1").c_str()) == 0;
}
bool hasPydicom() {
    return std::system("/usr/bin/python3 -c 'import pydicom, numpy' >/dev/null 2>&1") == 0;
}
bool run(const std::string& command) {
    return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

class OtherPrograms : public testing::Test {
  protected:
    test::TemporaryFolder temporary_;
    fs::path ours_ = temporary_.path() / "ours", theirs_ = temporary_.path() / "theirs";
    Volume scan_;

    /// A scan in Hounsfield units, or one that needs all 16 bits.
    void write(bool isSigned) {
        scan_ = isSigned ? test::sampleVolume({48, 40, 3}, -1000, 4000) : test::sampleVolume({48, 40, 3}, 0, 60000);
        scan_.grid.axes = test::obliqueAxes();
        fs::remove_all(ours_);
        writeScan(scan_, ours_, ScanFormat::dicom);
    }
    /// Runs `command IN OUT` on each slice.
    void convert(const std::string& command) {
        fs::remove_all(theirs_);
        fs::create_directories(theirs_);
        for (const auto& e : fs::directory_iterator(ours_))
            ASSERT_TRUE(run(command + " " + e.path().string() + " " + (theirs_ / e.path().filename()).string()))
                << command;
    }
    void expectSame(const std::string& what) {
        const Scan read = readScan(theirs_);
        EXPECT_EQ(read.volume.values, scan_.values) << what;
        EXPECT_LE((read.volume.grid.axes - scan_.grid.axes).cwiseAbs().maxCoeff(), 1e-9) << what;
        EXPECT_LE((read.volume.grid.originMm - scan_.grid.originMm).norm(), 1e-9) << what;
        EXPECT_LE((read.volume.grid.spacingMm - scan_.grid.spacingMm).norm(), 1e-9) << what;
        EXPECT_THAT(read.series.notes, testing::Not(Contains(HasSubstr("loss")))) << what;
    }
    void convertAndCompare(const std::vector<std::string>& commands) {
        for (const bool isSigned : {true, false}) {
            write(isSigned);
            for (const std::string& command : commands) {
                convert(command);
                if (HasFatalFailure()) return;
                expectSame(command + (isSigned ? " signed" : " unsigned"));
            }
        }
    }
};

TEST_F(OtherPrograms, Gdcmconv) {
    if (!hasTool("gdcmconv")) GTEST_SKIP() << "no gdcmconv on this machine (package libgdcm-tools)";
    convertAndCompare({"gdcmconv --raw", "gdcmconv --rle", "gdcmconv --jpeg", "gdcmconv --jpegls", "gdcmconv --j2k",
                       "gdcmconv --implicit"});
}

TEST_F(OtherPrograms, Dcmtk) {
    if (!hasTool("dcmcjpeg")) GTEST_SKIP() << "no dcmtk on this machine (package dcmtk)";
    convertAndCompare(
        {"dcmcjpeg +e1", "dcmcjpeg +el", "dcmcjpls", "dcmcrle", "dcmconv +ti", "dcmconv +tb", "dcmconv -F"});
}

TEST_F(OtherPrograms, Pydicom) {
    if (!hasPydicom()) GTEST_SKIP() << "no pydicom on this machine (package python3-pydicom)";
    const fs::path script = temporary_.path() / "rewrite.py";
    // Reads ours, checks nothing is in it that names anybody, and writes every slice anew in three ways.
    test::writeBytes(script, R"(
import sys, glob, os, numpy, pydicom
from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
from pydicom.uid import ImplicitVRLittleEndian, ExplicitVRBigEndian, RLELossless, generate_uid
ours, theirs = sys.argv[1:]
for kind in ('implicit', 'big', 'rle'):
    os.makedirs(os.path.join(theirs, kind))
series = generate_uid()
with open(os.path.join(theirs, 'values'), 'wb') as values:
    for n, name in enumerate(sorted(glob.glob(os.path.join(ours, '*.dcm')))):
        d = pydicom.dcmread(name)
        assert not str(d.get('PatientName', '')) and not d.get('PatientID', ''), 'a person'
        assert d.SOPClassUID == pydicom.uid.CTImageStorage and d.file_meta.MediaStorageSOPInstanceUID == d.SOPInstanceUID
        stored = d.pixel_array
        values.write((stored * float(d.RescaleSlope) + float(d.RescaleIntercept)).astype('<f4').tobytes())
        for kind, syntax in (('implicit', ImplicitVRLittleEndian), ('big', ExplicitVRBigEndian), ('rle', RLELossless)):
            meta = FileMetaDataset()
            meta.MediaStorageSOPClassUID = d.SOPClassUID
            meta.MediaStorageSOPInstanceUID = generate_uid()
            meta.TransferSyntaxUID = ImplicitVRLittleEndian if kind == 'rle' else syntax
            f = FileDataset(None, Dataset(), file_meta=meta, preamble=b'\0' * 128)
            f.is_little_endian = kind != 'big'
            f.is_implicit_VR = kind != 'big'
            for key in ('SOPClassUID', 'Modality', 'ImagePositionPatient', 'ImageOrientationPatient', 'PixelSpacing', 'Rows',
                        'Columns', 'BitsAllocated', 'BitsStored', 'HighBit', 'PixelRepresentation', 'SamplesPerPixel',
                        'PhotometricInterpretation', 'RescaleSlope', 'RescaleIntercept'):
                setattr(f, key, getattr(d, key))
            f.SOPInstanceUID = meta.MediaStorageSOPInstanceUID
            f.SeriesInstanceUID = series
            f.StudyInstanceUID = generate_uid()
            f.PatientName = 'Doe^Jane'
            f.add_new((0x0009, 0x0010), 'LO', 'SOMEBODY')
            f.add_new((0x0009, 0x1001), 'UN', b'private')
            item = Dataset(); item.CodeValue = '1'
            f.AnatomicRegionSequence = [item]
            f.PixelData = stored.astype('>i2' if kind == 'big' and d.PixelRepresentation else '>u2' if kind == 'big' else stored.dtype).tobytes()
            if kind == 'rle':
                f.compress(RLELossless)
            f.save_as(os.path.join(theirs, kind, 'Z%d' % (99 - n)), write_like_original=False)
)");
    for (const bool isSigned : {true, false}) {
        write(isSigned);
        fs::remove_all(theirs_);
        ASSERT_TRUE(run("/usr/bin/python3 " + script.string() + " " + ours_.string() + " " + theirs_.string()));
        EXPECT_EQ(test::readBytes(theirs_ / "values"), test::numbers(scan_.values)) << "as pydicom reads ours";
        const fs::path all = theirs_;
        for (const char* kind : {"implicit", "big", "rle"}) {
            theirs_ = all / kind;
            expectSame(kind);
        }
        theirs_ = all;
    }
}

TEST_F(OtherPrograms, PicturesThatDcmtkMakesAreWarnedOf) {
    if (!hasTool("img2dcm")) GTEST_SKIP() << "no dcmtk on this machine (package dcmtk)";
    const Volume scan = test::sampleVolume({32, 24, 2});
    writeScan(scan, ours_, ScanFormat::jpeg);
    fs::create_directories(theirs_);
    ASSERT_TRUE(run("img2dcm " + (ours_ / "slice_0001.jpg").string() + " " + (theirs_ / "x.dcm").string()));
    ReadSettings settings;
    settings.spacingMm = core::Vec3::Ones();
    const Scan read = readScan(theirs_, settings);
    EXPECT_THAT(read.series.notes, Contains(HasSubstr("secondary capture")));
    // JPEG inside and outside must be unpacked to the same grey values.
    fs::remove(ours_ / "scan.toml");
    fs::remove(ours_ / "slice_0002.jpg");
    EXPECT_EQ(read.volume.values, readScan(ours_, settings).volume.values);
}

TEST_F(OtherPrograms, DicomdirThatDcmtkMakes) {
    if (!hasTool("dcmgpdir")) GTEST_SKIP() << "no dcmtk on this machine (package dcmtk)";
    write(true);
    fs::create_directories(theirs_);
    int n = 0;
    for (const auto& e : fs::directory_iterator(ours_))
        fs::copy_file(e.path(), theirs_ / ("IM" + std::to_string(n++)));
    ASSERT_TRUE(run("cd " + theirs_.string() + " && dcmgpdir +I -W +D DICOMDIR IM0 IM1 IM2"));
    fs::copy_file(theirs_ / "IM0", theirs_ / "NOTLISTED");  // would be a doubled slice
    EXPECT_EQ(readScan(theirs_ / "DICOMDIR").volume.values, scan_.values);
}

TEST_F(OtherPrograms, FramesInOneFilePackedByGdcm) {
    if (!hasTool("gdcmconv")) GTEST_SKIP() << "no gdcmconv on this machine (package libgdcm-tools)";
    // Multi-frame secondary capture of 16 bits, and its packed forms.
    test::DicomMaker d;
    d.sopClass = "1.2.840.10008.5.1.4.1.1.7.3";
    d.frames = 3;
    d.rows = 40;
    d.columns = 48;
    d.isSigned = 0;
    d.position.clear();
    d.orientation.clear();
    d.between = "0.5";
    scan_ = test::sampleVolume({48, 40, 3}, 0, 4000);
    for (const float v : scan_.values)
        d.pixels.push_back(static_cast<std::int16_t>(v));
    test::writeBytes(ours_ / "frames.dcm", d.bytes());
    fs::create_directories(theirs_);
    for (const char* way : {"--rle", "--jpeg", "--jpegls", "--j2k"}) {
        ASSERT_TRUE(run(std::string("gdcmconv ") + way + " " + (ours_ / "frames.dcm").string() + " " +
                        (theirs_ / "frames.dcm").string()))
            << way;
        EXPECT_EQ(readScan(theirs_).volume.values, scan_.values) << way;
    }
}

TEST_F(OtherPrograms, DamagedPackedPixelsAreTold) {
    if (!hasTool("gdcmconv")) GTEST_SKIP() << "no gdcmconv on this machine (package libgdcm-tools)";
    write(true);
    for (const char* way : {"--rle", "--jpeg", "--jpegls", "--j2k"}) {
        convert(std::string("gdcmconv ") + way);
        const fs::path file = theirs_ / "slice_0002.dcm";
        test::cutFile(file, 0.6);
        EXPECT_THAT(test::errorOf([&] { (void)readScan(theirs_); }), HasSubstr("slice_0002.dcm")) << way;
        // Another syntax than it is packed in: the first letters of the UID stay, the last change.
        convert(std::string("gdcmconv ") + way);
        std::string bytes = test::readBytes(file);
        const std::string from = std::string(way) == "--rle" ? "1.2.840.10008.1.2.5" : "1.2.840.10008.1.2.4.";
        const std::size_t at = bytes.find(from);
        ASSERT_NE(at, std::string::npos);
        if (std::string(way) == "--rle")
            bytes[at + 18] = '1';
        else
            bytes.replace(at + 20, 2, std::string(way) == "--j2k" ? "70" : "90");
        test::writeBytes(file, bytes);
        EXPECT_THAT(test::errorOf([&] { (void)readScan(theirs_); }), HasSubstr("slice_0002.dcm")) << way;
    }
    // JPEG 2000 whose header leaps beyond the end of the data, or tells no coding: GDCM would follow it.
    for (const auto& [marker, second] : {std::pair("\xff\x5c", '\xff'), {"\xff\x90", '\xff'}, {"\xff\x52", '\x00'}}) {
        convert("gdcmconv --j2k");
        const fs::path file = theirs_ / "slice_0002.dcm";
        std::string bytes = test::readBytes(file);
        const std::size_t at = bytes.find(marker, bytes.find("\xff\x4f\xff\x51"));
        ASSERT_NE(at, std::string::npos);
        bytes[at + 2] = second;
        bytes[at + 3] = second == '\0' ? '\x02' : '\xf0';
        test::writeBytes(file, bytes);
        EXPECT_THAT(test::errorOf([&] { (void)readScan(theirs_); }),
                    AllOf(HasSubstr("slice_0002.dcm"), HasSubstr("damaged")));
    }
}

}  // namespace
}  // namespace handpiece::volume::other_programs_test
