// SPDX-License-Identifier: Apache-2.0
// Scans as other programs write them: the body that has a left and a right in DICOM, NRRD, MetaImage, NIfTI, TIFF and
// raw numbers, each with oddities that public reports tell of, drawn at random. It comes in with its values, its size
// and its right hand, or the scan says that nobody can tell; a damaged one comes in right or says so.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nifti1_io.h>
#include <tiffio.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "scan_support.h"
#include "support/dice.h"

namespace handpiece::volume::corpus_test {
namespace {

namespace fs = std::filesystem;
using test::DicomMaker;

/// What a maker says of what it has written.
struct Made {
    std::string how;
    int side = 0;  ///< 0: nobody can tell
    double slope = 1.0, intercept = 0.0;
};

class Corpus : public testing::Test {
  protected:
    test::TemporaryFolder temporary_;
    fs::path at_ = temporary_.path() / "scan";
    const Volume phantom_ = test::chiralPhantom();

    template <class T>
    [[nodiscard]] std::vector<T> as(int first = 0, int count = 10) const {
        const auto each = static_cast<std::ptrdiff_t>(phantom_.grid.index(0, 0, 1));
        const auto begin = phantom_.values.begin() + first * each;
        std::vector<T> out;
        std::transform(begin, begin + count * each, std::back_inserter(out), [](float v) { return static_cast<T>(v); });
        return out;
    }
    void put(const std::string& name, const std::string& bytes) const { test::writeBytes(at_ / name, bytes); }

    [[nodiscard]] Made dicomSlices(test::Dice& dice) const {
        Made made{"DICOM", 0, dice.oneOf({1.0, 2.0, 0.5}), dice.oneOf({0.0, -1024.0, 10.0})};
        DicomMaker d;
        d.columns = 24;
        d.rows = 18;
        d.syntax = dice.oneOf<std::string>({"1.2.840.10008.1.2.1", "1.2.840.10008.1.2", "1.2.840.10008.1.2.2"});
        d.spacing = dice.oneOf<std::string>({"0.2\\0.2", "0.200000\\0.200000 ", "2.0E-1\\2.0E-1", ".2\\.2"});
        d.isSigned = dice.upTo(2);
        d.stored = dice.oneOf({12, 16, 9});
        d.slope = fmt::format("{}", made.slope);
        d.intercept = fmt::format("{:.3f}", made.intercept);
        const bool isPlaced = !dice.once(4), isTurned = dice.once(2), isWobbly = dice.once(4);
        const int s[] = {dice.sign(), dice.sign(), dice.sign()};
        if (isPlaced) made.side = s[0] * s[1] * s[2] * (isTurned ? -1 : 1);
        const std::string undefined = "\xff\xff\xff\xff";
        if (d.syntax == "1.2.840.10008.1.2.1" && dice.once(3))  // an icon in a sequence of undefined length
            d.enhanced = std::string("\x88\x00\x00\x02SQ\0\0", 8) + undefined + std::string("\xfe\xff\x00\xe0", 4) +
                         undefined + std::string("\x28\x00\x10\x00US\x02\0\x08\0", 10) +
                         std::string("\xfe\xff\x0d\xe0\0\0\0\0", 8) + std::string("\xfe\xff\xdd\xe0\0\0\0\0", 8);
        const std::string more =
            dice.once(2) ? d.element(0x29, 0x10, "LO", "SOMEBODY 1.0") + d.element(0x29, 0x1010, "OB", "\x01\x02") : "";
        std::vector<int> order{0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
        if (isPlaced) dice.shuffle(order);  // names have nothing to do with places
        const int names = dice.upTo(4);
        for (int k = 0; k < 10; ++k) {
            DicomMaker slice = d;
            slice.pixels = as<std::int16_t>(k, 1);
            slice.instance = std::to_string(k + 1);
            if (isPlaced && dice.once(3)) slice.instance.clear();
            const double wobble = isWobbly && k % 2 == 0 ? 0.001 : 0.0;
            const std::string i = fmt::format("{:.6f}", s[0] * std::sqrt(1.0 - wobble * wobble));
            const std::string w = fmt::format("{:.6f}", wobble), j = std::to_string(s[1]);
            slice.orientation =
                isTurned ? "0\\" + i + "\\" + w + "\\" + j + "\\0\\0" : i + "\\0\\" + w + "\\0\\" + j + "\\0";
            slice.position = fmt::format("-12.5\\7\\{:.4f}", 0.2 * k * s[2]);
            if (!isPlaced) {
                slice.position.clear();
                slice.orientation.clear();
                slice.between = "0.2";
            }
            if (!more.empty() && slice.enhanced.empty()) slice.enhanced = more;
            const int n = order[static_cast<std::size_t>(k)];
            put(names == 0   ? fmt::format("IM{}", n)
                : names == 1 ? fmt::format("1.2.840.{}.dcm", 90 + n)
                : names == 2 ? fmt::format("S{0}/{0:03}.DCM", n)
                             : fmt::format("\xe6\xad\xaf {}", n),
                slice.bytes());
        }
        if (dice.once(3)) put("README.txt", "made by somebody");
        if (dice.once(3)) put("Thumbs.db", std::string("\xd0\xcf\x11\xe0", 4) + std::string(600, 'x'));
        made.how += fmt::format(" {} turned {} placed {} names {} signed {} wobbly {} icon {} private {}", d.syntax,
                                isTurned, isPlaced, names, d.isSigned, isWobbly, !d.enhanced.empty(), !more.empty());
        return made;
    }

    [[nodiscard]] Made dicomFrames(test::Dice& dice) const {
        Made made{"DICOM in one file", 0};
        DicomMaker d;
        d.columns = 24;
        d.rows = 18;
        d.frames = 10;
        d.spacing = "0.2\\0.2";
        d.syntax = dice.oneOf<std::string>({"1.2.840.10008.1.2.1", "1.2.840.10008.1.2", "1.2.840.10008.1.2.2"});
        d.isSigned = dice.upTo(2);
        d.pixels = as<std::int16_t>();
        const int how = dice.upTo(4);
        if (how < 2) {  // offsets
            std::string offsets;
            made.side = how == 0 ? 1 : -1;
            for (int k = 0; k < 10; ++k)
                offsets += fmt::format("{}{:.1f}", k > 0 ? "\\" : "", 0.2 * k * made.side);
            d.enhanced = d.element(0x3004, 0xc, "DS", offsets);
        } else if (how == 2) {
            d.between = "-0.2";
            made.side = -1;
        } else {
            d.between = "0.2";
        }
        put(dice.oneOf<std::string>({"volume.dcm", "CBCT", "0001"}), d.bytes());
        made.how += fmt::format(" {} way {}", d.syntax, how);
        return made;
    }

    /// The numbers as `type`, of which each format has its own names.
    [[nodiscard]] std::string numbersAs(int type, bool isBig) const {
        switch (type) {
            case 0:
                return test::numbers(as<std::uint8_t>());
            case 1:
                return test::numbers(as<std::int16_t>(), isBig);
            case 2:
                return test::numbers(as<std::uint16_t>(), isBig);
            case 3:
                return test::numbers(as<std::int32_t>(), isBig);
            case 4:
                return test::numbers(as<float>(), isBig);
            default:
                return test::numbers(as<double>(), isBig);
        }
    }

    [[nodiscard]] Made nrrd(test::Dice& dice) const {
        Made made{"NRRD"};
        const int type = dice.upTo(6), encoding = dice.upTo(3);
        const bool isBig = dice.once(2), isDetached = dice.once(3);
        const int s[] = {dice.sign(), dice.sign(), dice.sign()};
        const char* names[] = {"unsigned char", "int16", "ushort", "int", "float", "double"};
        const char* encodings[] = {"raw", "gzip", "gz"};
        std::vector<std::string> lines{std::string("type: ") + names[type], "dimension: 3", "sizes: 24 18 10",
                                       std::string("endian: ") + (isBig ? "big" : "little"),
                                       std::string("encoding: ") + encodings[encoding]};
        const int space = dice.upTo(4);
        if (space < 3) {
            const char* spaces[] = {"left-posterior-superior", "RAS", "LAS"};
            made.side = s[0] * s[1] * s[2] * (space == 2 ? -1 : 1);
            lines.push_back(std::string("space: ") + spaces[space]);
            lines.push_back(
                fmt::format("space directions: ({},0,0) (0, {},0) (0,0,{:.6f})", 0.2 * s[0], 0.2 * s[1], 0.2 * s[2]));
            if (dice.once(2)) lines.emplace_back("space origin: (-12.5,3,1e2)");
            if (dice.once(3)) lines.emplace_back("kinds: domain domain domain");
        } else {
            lines.emplace_back("spacings: 0.2 0.2 0.2");
        }
        if (dice.once(3)) lines.emplace_back("# a remark");
        if (dice.once(3)) lines.emplace_back("content: somebody's tooth: 46");
        if (dice.once(3)) lines.emplace_back("Segmentation_Key:=a value: of a kind");
        const bool isDos = dice.once(3);
        std::string head = "NRRD000" + std::to_string(4 + dice.upTo(2)) + (isDos ? "\r\n" : "\n");
        if (isDetached) lines.emplace_back("data file: tooth.data");
        for (const std::string& line : lines)
            head += line + (isDos ? "\r\n" : "\n");
        std::string data = numbersAs(type, isBig);
        if (encoding > 0) data = test::zipped(data, true);
        if (isDetached) {
            put("tooth.data", data);
            put("tooth.nhdr", head);
        } else {
            put("tooth.nrrd", head + (isDos ? "\r\n" : "\n") + data);
        }
        made.how += fmt::format(" {} {} big {} detached {} DOS {} space {}", names[type], encodings[encoding], isBig,
                                isDetached, isDos, space);
        return made;
    }

    [[nodiscard]] Made metaImage(test::Dice& dice) const {
        Made made{"MetaImage"};
        const int type = dice.upTo(6);
        const bool isBig = dice.once(2), isPacked = dice.once(2), isDetached = dice.once(2), isTold = !dice.once(3);
        const int s[] = {dice.sign(), dice.sign(), dice.sign()};
        const char* names[] = {"MET_UCHAR", "MET_SHORT", "MET_USHORT", "MET_INT", "MET_FLOAT", "MET_DOUBLE"};
        std::vector<std::string> lines{"DimSize = 24 18 10", std::string("ElementType = ") + names[type],
                                       "ElementSpacing = 0.2 0.2 0.2",
                                       std::string(dice.once(2) ? "BinaryDataByteOrderMSB" : "ElementByteOrderMSB") +
                                           (isBig ? " = True" : " = False")};
        if (isTold) {
            made.side = s[0] * s[1] * s[2];
            lines.push_back(fmt::format("{} = {} 0 0 0 {} 0 0 0 {}",
                                        dice.oneOf<std::string>({"TransformMatrix", "Rotation", "Orientation"}), s[0],
                                        s[1], s[2]));
            lines.push_back(dice.oneOf<std::string>({"Offset", "Position", "Origin"}) + " = -12.5 3 100");
        }
        for (const char* more : {"BinaryData = True", "CenterOfRotation = 0 0 0", "AnatomicalOrientation = RAI",
                                 "ElementNumberOfChannels = 1", "Comment = a tooth"})
            if (dice.once(2)) lines.emplace_back(more);
        dice.shuffle(lines);
        std::string data = numbersAs(type, isBig);
        if (isPacked) {
            data = test::zipped(data, false);
            lines.emplace_back("CompressedData = True");
            if (dice.once(2)) lines.push_back(fmt::format("CompressedDataSize = {}", data.size()));
        }
        std::string head = "ObjectType = Image\nNDims = 3\n";
        for (const std::string& line : lines)
            head += line + "\n";
        if (isDetached) {
            put("tooth.zraw", data);
            put("tooth.mhd", head + "ElementDataFile = tooth.zraw\n");
        } else {
            put("tooth.mha", head + "ElementDataFile = LOCAL\n" + data);
        }
        made.how +=
            fmt::format(" {} big {} packed {} detached {} told {}", names[type], isBig, isPacked, isDetached, isTold);
        return made;
    }

    [[nodiscard]] Made nifti(test::Dice& dice) const {
        Made made{"NIfTI", 0, dice.oneOf({1.0, 2.0, 0.5}), dice.oneOf({0.0, -1000.0})};
        const int type = dice.upTo(6);
        const bool isBig = dice.once(3);
        nifti_1_header h{};
        h.sizeof_hdr = 348;
        h.dim[0] = dice.once(3) ? 4 : 3;
        h.dim[1] = 24;
        h.dim[2] = 18;
        h.dim[3] = 10;
        h.dim[4] = h.dim[5] = h.dim[6] = h.dim[7] = 1;
        h.datatype = std::array<short, 6>{2, 4, 512, 8, 16, 64}[static_cast<std::size_t>(type)];
        h.bitpix = std::array<short, 6>{8, 16, 16, 32, 32, 64}[static_cast<std::size_t>(type)];
        h.pixdim[0] = 1.0f;
        const bool isMicrons = dice.once(4);
        const float step = isMicrons ? 200.0f : 0.2f;
        h.xyzt_units = isMicrons ? 3 : 2;
        h.pixdim[1] = h.pixdim[2] = h.pixdim[3] = step;
        h.scl_slope = static_cast<float>(made.slope);
        h.scl_inter = static_cast<float>(made.intercept);
        if (made.slope == 1.0 && made.intercept == 0.0 && dice.once(2)) h.scl_slope = 0.0f;  // "none"
        const int form = dice.upTo(3);
        if (form == 0) {
            const int s[] = {dice.sign(), dice.sign(), dice.sign()};
            made.side = s[0] * s[1] * s[2];
            h.sform_code = 1;
            h.srow_x[0] = step * static_cast<float>(s[0]);
            h.srow_y[1] = step * static_cast<float>(s[1]);
            h.srow_z[2] = step * static_cast<float>(s[2]);
        } else if (form == 1) {
            made.side = dice.sign();
            h.qform_code = 1;
            h.pixdim[0] = static_cast<float>(made.side);
            h.quatern_c = dice.once(2) ? 0.6f : 0.0f;
        }
        const bool isPair = dice.once(3), isPacked = dice.once(2);
        const int skipped = isPair ? 0 : dice.once(2) ? 352 : 368;
        h.vox_offset = static_cast<float>(skipped);
        std::memcpy(h.magic, isPair ? "ni1" : "n+1", 4);
        if (isBig) swap_nifti_header(&h, 1);
        std::string head(reinterpret_cast<const char*>(&h), sizeof h);
        const std::string data = numbersAs(type, isBig), end = isPacked ? ".gz" : "";
        const auto packed = [&](const std::string& bytes) { return isPacked ? test::zipped(bytes, true) : bytes; };
        if (isPair) {
            put("tooth.hdr" + end, packed(head + std::string(4, '\0')));
            put("tooth.img" + end, packed(data));
        } else {
            head.resize(static_cast<std::size_t>(skipped), '\0');
            put("tooth.nii" + end, packed(head + data));
        }
        made.how += fmt::format(" type {} big {} form {} pair {} packed {} microns {}", type, isBig, form, isPair,
                                isPacked, isMicrons);
        return made;
    }

    [[nodiscard]] Made tiff(test::Dice& dice) const {
        Made made{"TIFF"};
        const bool isBytes = dice.once(2), isOneFile = dice.once(3), isTiled = dice.once(3);
        const int compression =
            dice.oneOf({COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_PACKBITS});
        const int names = dice.upTo(4);
        fs::create_directories(at_);
        TIFF* file = nullptr;
        for (int k = 0; k < 10; ++k) {
            const std::string name = names == 0   ? fmt::format("slice{}.tif", k + 1)  // 1, 10, 2, ...
                                     : names == 1 ? fmt::format("tooth_2019-04-0{:04}.TIF", k)
                                     : names == 2 ? fmt::format("a{:03}.tiff", 7 * k)
                                                  : fmt::format("{}_rec{:08}.tif", "46", k);
            if (!isOneFile || k == 0) file = TIFFOpen((at_ / name).c_str(), dice.once(2) ? "wl" : "wb");
            TIFFSetField(file, TIFFTAG_IMAGEWIDTH, 24);
            TIFFSetField(file, TIFFTAG_IMAGELENGTH, 18);
            TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, isBytes ? 8 : 16);
            TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 1);
            TIFFSetField(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
            TIFFSetField(file, TIFFTAG_COMPRESSION, compression);
            const auto page = as<std::uint16_t>(k, 1);
            const auto at = [&](int x, int y) {
                return x < 24 && y < 18 ? page[static_cast<std::size_t>(24 * y + x)] : std::uint16_t{0};
            };
            const int wide = isTiled ? 32 : 24, high = isTiled ? 32 : 18;
            std::vector<std::uint8_t> bytes;
            std::vector<std::uint16_t> words;
            for (int y = 0; y < high; ++y)
                for (int x = 0; x < wide; ++x) {
                    bytes.push_back(static_cast<std::uint8_t>(at(x, y)));
                    words.push_back(at(x, y));
                }
            const auto row = [&](int y) -> void* {
                if (isBytes) return bytes.data() + wide * y;
                return words.data() + wide * y;
            };
            if (isTiled) {
                TIFFSetField(file, TIFFTAG_TILEWIDTH, 32);
                TIFFSetField(file, TIFFTAG_TILELENGTH, 32);
                TIFFWriteTile(file, row(0), 0, 0, 0, 0);
            } else {
                TIFFSetField(file, TIFFTAG_ROWSPERSTRIP, dice.oneOf({1, 5, 18}));
                for (int y = 0; y < 18; ++y)
                    TIFFWriteScanline(file, row(y), static_cast<std::uint32_t>(y), 0);
            }
            if (isOneFile) TIFFWriteDirectory(file);
            if (!isOneFile || k == 9) TIFFClose(file);
        }
        made.how += fmt::format(" bytes {} one file {} tiled {} compression {} names {}", isBytes, isOneFile, isTiled,
                                compression, names);
        return made;
    }

    [[nodiscard]] Made raw(test::Dice& dice) const {
        Made made{"raw", 0, dice.oneOf({1.0, 2.0}), dice.oneOf({0.0, -10.0})};
        const int type = dice.upTo(6), header = dice.oneOf({0, 17, 512});
        const bool isBig = dice.once(2), isTold = !dice.once(3);
        const char* names[] = {"uint8", "int16", "uint16", "int32", "float32", "float64"};
        std::string text = fmt::format(
            "file = \"a.raw\"\nsize = [24, 18, 10]\ntype = \"{}\"\nbyte_order = \"{}\"\nheader_bytes = {}\n"
            "spacing_mm = [0.2, 0.2, 0.2]\nslope = {:.1f}\nintercept = {:.1f}\n",
            names[type], isBig ? "big" : "little", header, made.slope, made.intercept);
        if (isTold) {
            made.side = dice.sign();
            text += fmt::format("axes = [0, 1, 0, 1, 0, 0, 0, 0, {}]\n", -made.side);
        }
        put("a.raw", std::string(static_cast<std::size_t>(header), 'h') + numbersAs(type, isBig));
        put("scan.toml", text);
        made.how += fmt::format(" {} big {} header {} told {}", names[type], isBig, header, isTold);
        return made;
    }

    /// In words what is wrong with it; nothing when it is as it was made.
    [[nodiscard]] std::string wrong(const Scan& scan, const Made& made) const {
        Volume v = scan.volume;
        for (float& x : v.values)
            x = static_cast<float>((static_cast<double>(x) - made.intercept) / made.slope);
        std::vector<float> there = v.values, wanted = phantom_.values;
        std::sort(there.begin(), there.end());
        std::sort(wanted.begin(), wanted.end());
        if (there != wanted) return "other values";
        if (!v.grid.spacingMm.isApproxToConstant(0.2, 1e-5)) return "another spacing";
        if (std::abs(v.grid.axes.determinant() - 1.0) > 1e-6) return "left-handed axes";
        const int side = test::sideOf(v);
        if (scan.series.isSideKnown != (made.side != 0)) return "who knows its side?";
        if (side == 0 || (made.side != 0 && side != made.side)) return "a mirror image";
        return {};
    }
    /// Of the largest file under it, a share of its bytes.
    void breakOff(double share) const {
        fs::path largest;
        for (const auto& e : fs::recursive_directory_iterator(at_))
            if (e.is_regular_file() && (largest.empty() || e.file_size() > fs::file_size(largest))) largest = e.path();
        test::cutFile(largest, share);
    }
};

TEST_F(Corpus, AsOtherProgramsWriteThem) {
    const std::uint64_t seed = test::seed();
    const int count = test::corpusSize(320);
    int refused = 0, said = 0, unharmed = 0;
    ReadSettings settings;
    settings.takeLargest = true;
    for (int i = 0; i < count; ++i) {
        test::Dice dice(seed + static_cast<std::uint64_t>(i));
        const auto make = [&] {
            switch (i % 8) {
                case 0:
                case 1:
                    return dicomSlices(dice);
                case 2:
                    return dicomFrames(dice);
                case 3:
                    return nrrd(dice);
                case 4:
                    return metaImage(dice);
                case 5:
                    return nifti(dice);
                case 6:
                    return tiff(dice);
                default:
                    return raw(dice);
            }
        };
        const Made made = make();
        settings.spacingMm.reset();
        if (i % 8 == 6) settings.spacingMm = core::Vec3::Constant(0.2);
        const std::string which = fmt::format("scan {} of seed {}: {}", i, seed, made.how);
        EXPECT_NO_THROW(EXPECT_EQ(wrong(readScan(at_, settings), made), "") << which) << which;
        // Broken off: never wrong without a word.
        breakOff(0.05 + 0.01 * dice.upTo(90));
        try {
            const Scan scan = readScan(at_, settings);
            const bool isRight = wrong(scan, made).empty();
            unharmed += isRight;
            said += !isRight;
            EXPECT_TRUE(isRight || !scan.series.notes.empty()) << which << ", broken off: " << wrong(scan, made);
        } catch (const core::Error& e) {
            ++refused;
            EXPECT_FALSE(std::string(e.what()).empty()) << which;
        }
        fs::remove_all(at_);
    }
    std::cout << fmt::format("{} scans right; broken off: {} refused, {} with a note, {} unharmed\n", count, refused,
                             said, unharmed);
}

}  // namespace
}  // namespace handpiece::volume::corpus_test
