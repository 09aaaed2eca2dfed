// SPDX-License-Identifier: Apache-2.0
// Pixels of DICOM files: plain ones and run lengths here, JPEG's family by GDCM's decoders, which get nothing but the
// packed frame.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <mutex>
#include <optional>

#include <gdcmDataElement.h>
#include <gdcmFragment.h>
#include <gdcmImageCodec.h>
#include <gdcmJPEG2000Codec.h>
#include <gdcmJPEGCodec.h>
#include <gdcmJPEGLSCodec.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>

#include "handpiece/base/core/error.h"
#include "handpiece/scan/volume/dicom_header.h"
#include "handpiece/scan/volume/samples.h"

namespace handpiece::volume {
namespace {

enum class Packing { none, rle, jpeg, jpegLs, jpeg2000 };

std::optional<Packing> packingOf(const std::string& syntax) {
    constexpr std::string_view kBase = "1.2.840.10008.1.2";
    const std::string_view all = syntax;
    if (all == kBase || all == "1.2.840.10008.1.2.1" || all == "1.2.840.10008.1.2.2") return Packing::none;
    if (all == "1.2.840.10008.1.2.5") return Packing::rle;
    constexpr std::string_view kJpeg = "1.2.840.10008.1.2.4.";
    if (all.rfind(kJpeg, 0) != 0) return {};
    const std::string_view kind = all.substr(kJpeg.size());
    if (kind == "50" || kind == "51" || kind == "57" || kind == "70") return Packing::jpeg;
    if (kind == "80" || kind == "81") return Packing::jpegLs;
    if (kind == "90" || kind == "91") return Packing::jpeg2000;
    return {};
}

/// Columns, rows and components as the packed picture itself tells them, or nothing: GDCM's decoders trust these.
/// Of a JPEG the segments that say nothing of the pixels are taken out. Values of more bits than the file says are
/// nothing: GDCM's decoder shifts by the difference.
std::optional<std::array<unsigned, 3>> packedSize(Packing packing, unsigned bits, std::vector<char>& data) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned>(static_cast<unsigned char>(data[i])); };
    const auto two = [&](std::size_t i) { return byte(i) << 8 | byte(i + 1); };
    const auto four = [&](std::size_t i) { return two(i) << 16 | two(i + 2); };
    if (packing == Packing::jpeg2000) {
        // SOC and SIZ stand first; files in their box format are not allowed in DICOM.
        if (data.size() < 48 || two(0) != 0xff4f || two(2) != 0xff51) return {};
        const unsigned count = two(40);
        if ((byte(42) & 0x7f) + 1 > bits) return {};
        if (four(16) != 0 || four(20) != 0 || (count == 1 && (byte(43) != 1 || byte(44) != 1))) return {};
        // Segments within the data up to the first tile's own, how it is coded among them: GDCM looks for that by leaps
        // of the lengths it reads, without looking where the data end.
        bool isCodingTold = false, isInTile = false;
        for (std::size_t at = 2; at + 4 <= data.size();) {
            const unsigned marker = two(at), length = two(at + 2);
            if (marker == 0xff93 && isInTile && isCodingTold) return std::array{four(8), four(12), count};
            const bool isTile = marker == 0xff90;
            if (marker < 0xff50 || marker > 0xff90 || length < 2 || at + 2 + length > data.size() ||
                (isTile && (isInTile || length != 10)))
                return {};
            isInTile = isInTile || isTile;
            isCodingTold = isCodingTold || (marker == 0xff52 && length >= 12);
            at += 2 + length;
        }
        return {};
    }
    // Segments one after the other up to the first scan, nothing between them: GDCM's decoder stops the program at
    // what its header reader only warns of (stray bytes, odd application segments), so these are dropped or refused.
    if (data.size() < 4 || two(0) != 0xffd8) return {};
    std::vector<char> clean = {data[0], data[1]};
    std::optional<std::array<unsigned, 3>> size;
    unsigned component = 0;
    for (std::size_t at = 2; at + 4 <= data.size();) {
        if (byte(at) != 0xff) return {};
        const unsigned marker = byte(at + 1);
        if (marker == 0xff) {
            ++at;
            continue;
        }
        const unsigned length = two(at + 2);
        if (length < 2 || at + 2 + length > data.size()) return {};
        const bool isFrame =
            packing == Packing::jpegLs ? marker == 0xf7 : marker == 0xc0 || marker == 0xc1 || marker == 0xc3;
        const bool isTable = marker == 0xc4 || marker == 0xdb || marker == 0xdd || marker == 0xf8;
        const bool isNote = (marker >= 0xe0 && marker <= 0xef) || marker == 0xfe;
        if (isFrame) {
            if (size || length < 11 || length != 8 + 3 * byte(at + 9)) return {};
            if (byte(at + 4) < 2 || byte(at + 4) > std::min(bits, 16u)) return {};
            size = std::array{two(at + 7), two(at + 5), byte(at + 9)};
            component = byte(at + 10);
        } else if (marker == 0xda) {
            // Of several components the size alone is told: the caller refuses them.
            if (!size) return {};
            if ((*size)[2] == 1 && (length != 8 || byte(at + 4) != 1 || byte(at + 5) != component)) return {};
            clean.insert(clean.end(), data.begin() + static_cast<std::ptrdiff_t>(at), data.end());
            data = std::move(clean);
            return size;
        } else if (!isTable && !isNote) {
            return {};
        }
        if (!isNote)
            clean.insert(clean.end(), data.begin() + static_cast<std::ptrdiff_t>(at),
                         data.begin() + static_cast<std::ptrdiff_t>(at + 2 + length));
        at += 2 + length;
    }
    return {};
}

/// The packed bytes of one frame.
std::vector<char> packedFrame(Input& input, const DicomHeader& header, int index) {
    const auto cut = [&] {
        return core::Error("its pixel data is truncated", input.where(), "copy or export it again");
    };
    const auto& fragments = header.fragments;
    std::size_t begin = 0, end = fragments.size();
    if (header.frames > 1) {
        const auto frame = static_cast<std::size_t>(index), count = static_cast<std::size_t>(header.frames);
        if (fragments.size() == count) {
            begin = frame;
            end = frame + 1;
        } else if (header.frameOffsets.size() == count) {
            // Offsets count from the first fragment's item, 8 bytes before its data.
            const auto find = [&](std::size_t f) {
                for (std::size_t i = 0; f < count && i < fragments.size(); ++i)
                    if (fragments[i].at - fragments[0].at == header.frameOffsets[f]) return i;
                return fragments.size();
            };
            begin = find(frame);
            end = find(frame + 1);
        } else {
            throw core::Error("its packed frames cannot be told apart", input.where(),
                              "convert it with \"gdcmconv --raw IN OUT\"");
        }
    }
    if (begin >= end) throw cut();
    std::vector<char> data;
    for (std::size_t i = begin; i < end; ++i) {
        if (fragments[i].at + fragments[i].bytes > input.size()) throw cut();
        const std::size_t old = data.size();
        data.resize(old + fragments[i].bytes);
        if (input.readAt(fragments[i].at, data.data() + old, fragments[i].bytes) != fragments[i].bytes) throw cut();
    }
    return data;
}

/// Run lengths, a segment for each byte of a value, the highest first (PS3.5 annex G). Not by GDCM: its decoder reads
/// beyond the end of damaged data.
bool unpackRle(const std::vector<char>& data, std::size_t planes, std::size_t frameBytes, std::vector<std::byte>& out) {
    const auto number = [&](std::size_t at) {
        std::uint32_t v = 0;
        for (std::size_t i = 0; i < 4; ++i)
            v |= static_cast<std::uint32_t>(static_cast<unsigned char>(data[at + i])) << 8 * i;
        return v;
    };
    // At best 128 values come out of two bytes.
    if (data.size() < 64 || number(0) != planes || frameBytes / 64 > data.size()) return false;
    out.resize(frameBytes);
    const std::size_t count = frameBytes / planes;
    for (std::size_t plane = 0; plane < planes; ++plane) {
        std::size_t at = number(4 + 4 * plane), done = 0;
        const auto put = [&](char value) {
            out[done++ * planes + (planes - 1 - plane)] = static_cast<std::byte>(value);
        };
        if (at < 64) return false;
        while (done < count) {
            if (at >= data.size()) return false;
            const int run = static_cast<signed char>(data[at++]);
            if (run == -128) continue;
            const std::size_t length = static_cast<std::size_t>(run < 0 ? 1 - run : run + 1);
            if (at + (run < 0 ? 1 : length) > data.size()) return false;
            for (std::size_t i = 0; i < length && done < count; ++i)
                put(data[run < 0 ? at : at + i]);
            at += run < 0 ? 1 : length;
        }
    }
    return true;
}

std::vector<std::byte> unpack(Input& input, const DicomHeader& header, int index, Packing packing,
                              std::size_t frameBytes) {
    static std::once_flag silent;
    std::call_once(silent, [] {
        gdcm::Trace::DebugOff();
        gdcm::Trace::WarningOff();
        gdcm::Trace::ErrorOff();
    });
    const auto wrong = [&](const std::string& why) {
        return core::Error(why, input.where(), "copy or export it again, or convert it with \"gdcmconv --raw IN OUT\"");
    };
    std::vector<char> data = packedFrame(input, header, index);
    if (packing == Packing::rle) {
        std::vector<std::byte> bytes;
        if (!unpackRle(data, static_cast<std::size_t>(header.allocated / 8), frameBytes, bytes))
            throw wrong("its packed pixel data is damaged or truncated");
        return bytes;
    }
    {
        const auto size = packedSize(packing, static_cast<unsigned>(header.allocated), data);
        if (!size) throw wrong("its pixel data is not packed as its transfer syntax says, or damaged");
        if ((*size)[0] != static_cast<unsigned>(header.columns) || (*size)[1] != static_cast<unsigned>(header.rows) ||
            (*size)[2] != 1)
            throw wrong(fmt::format("its packed picture is {} x {}, its header says {} x {}", (*size)[0], (*size)[1],
                                    header.columns, header.rows));
    }
    if (data.size() % 2 != 0) data.push_back(0);
    const gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments = new gdcm::SequenceOfFragments;
    gdcm::Fragment fragment;
    fragment.SetByteValue(data.data(), gdcm::VL(static_cast<std::uint32_t>(data.size())));
    fragments->AddFragment(fragment);
    gdcm::DataElement in(gdcm::Tag(0x7fe0, 0x0010)), out;
    in.SetVR(gdcm::VR::OB);
    in.SetValue(*fragments);

    const auto decode = [&](gdcm::ImageCodec& codec) {
        const unsigned size[3] = {static_cast<unsigned>(header.columns), static_cast<unsigned>(header.rows), 1};
        codec.SetDimensions(size);
        codec.SetNumberOfDimensions(2);
        codec.SetPlanarConfiguration(0);
        codec.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
        codec.SetPixelFormat(gdcm::PixelFormat(1, static_cast<unsigned short>(header.allocated),
                                               static_cast<unsigned short>(header.stored),
                                               static_cast<unsigned short>(header.high), header.isSigned ? 1 : 0));
        return codec.Decode(in, out);
    };
    bool isGood = false;
    try {
        switch (packing) {
            case Packing::jpeg: {
                gdcm::JPEGCodec codec;
                isGood = decode(codec);
                break;
            }
            case Packing::jpegLs: {
                gdcm::JPEGLSCodec codec;
                codec.SetBufferLength(frameBytes);
                isGood = decode(codec);
                break;
            }
            case Packing::jpeg2000: {
                gdcm::JPEG2000Codec codec;
                isGood = decode(codec);
                break;
            }
            case Packing::rle:
            case Packing::none:
                break;
        }
    } catch (const std::exception&) {
        isGood = false;  // GDCM and CharLS throw their own
    }
    const gdcm::ByteValue* value = isGood ? out.GetByteValue() : nullptr;
    if (!value || value->GetLength() < frameBytes) throw wrong("its packed pixel data is damaged or truncated");
    std::vector<std::byte> bytes(frameBytes);
    std::memcpy(bytes.data(), value->GetPointer(), frameBytes);
    return bytes;
}

/// Takes the stored bits out of what is allocated, with their sign.
template <class Unsigned, class Signed>
void bitsToFloat(const std::byte* from, std::size_t count, const DicomHeader& header, bool isBig, double slope,
                 double intercept, float* to) {
    constexpr int kBits = 8 * sizeof(Unsigned);
    const int right = header.high + 1 - header.stored, left = kBits - header.stored;
    const bool isPlain = slope == 1.0 && intercept == 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        std::array<std::byte, sizeof(Unsigned)> raw;
        std::memcpy(raw.data(), from + i * sizeof(Unsigned), sizeof(Unsigned));
        Unsigned bits = 0;
        for (std::size_t b = 0; b < sizeof(Unsigned); ++b)
            bits = static_cast<Unsigned>(
                bits |
                static_cast<Unsigned>(static_cast<Unsigned>(raw[isBig ? sizeof(Unsigned) - 1 - b : b]) << 8 * b));
        bits = static_cast<Unsigned>(static_cast<Unsigned>(bits >> right) << left);
        const double value = header.isSigned
                                 ? static_cast<double>(static_cast<Signed>(static_cast<Signed>(bits) >> left))
                                 : static_cast<double>(static_cast<Unsigned>(bits >> left));
        to[i] = static_cast<float>(isPlain ? value : slope * value + intercept);
    }
}

}  // namespace

std::optional<std::pair<std::string, std::string>> unreadable(const DicomHeader& h) {
    using Answer = std::pair<std::string, std::string>;
    if (!packingOf(h.transferSyntax))
        return Answer(fmt::format("its transfer syntax {} is not read", h.transferSyntax),
                      "convert it with \"gdcmconv --raw IN OUT\"");
    const bool isPlain = *packingOf(h.transferSyntax) == Packing::none;
    if (isPlain == h.isEncapsulated)
        return Answer("its transfer syntax does not fit its pixel data", "export it again from where it was made");
    if (h.rows < 1 || h.columns < 1 || h.frames < 1)
        return Answer(fmt::format("its size of {} x {} x {} cannot be", h.columns, h.rows, h.frames),
                      "copy or export it again");
    if ((h.allocated != 8 && h.allocated != 16 && h.allocated != 32) || h.stored < 1 || h.stored > h.allocated ||
        h.high + 1 < h.stored || h.high >= h.allocated)
        return Answer(fmt::format("its values of {} bits in {} are not read", h.stored, h.allocated),
                      "convert it with \"gdcmconv --raw IN OUT\"");
    if (isPlain) {
        const std::uint64_t needed = static_cast<std::uint64_t>(h.rows) * static_cast<std::uint64_t>(h.columns) *
                                     static_cast<std::uint64_t>(h.frames) * static_cast<std::uint64_t>(h.allocated / 8);
        if (h.pixelBytes < needed)
            return Answer(fmt::format("its pixel data is truncated: {} of {} bytes are there", h.pixelBytes, needed),
                          "copy or export it again");
        const std::uint64_t frameBytes = needed / static_cast<std::uint64_t>(h.frames);
        if (h.pixelBytes >= needed + frameBytes)
            return Answer(fmt::format("it tells of {} frame{}, and its pixels are those of {}", h.frames,
                                      h.frames == 1 ? "" : "s", h.pixelBytes / frameBytes),
                          "export it again from where it was made");
    } else if (h.fragments.size() < static_cast<std::size_t>(h.frames)) {
        return Answer(fmt::format("its pixel data is truncated: {} packed pieces are there for {} frames",
                                  h.fragments.size(), h.frames),
                      "copy or export it again");
    } else if (h.frames > 1 && h.frameOffsets.size() > static_cast<std::size_t>(h.frames)) {
        return Answer(
            fmt::format("it tells of {} frames, and its pixels are those of {}", h.frames, h.frameOffsets.size()),
            "export it again from where it was made");
    }
    return {};
}

void readDicomFrame(Input& input, const DicomHeader& header, int index, float* to) {
    if (const auto why = unreadable(header)) throw core::Error(why->first, input.where(), why->second);
    const std::size_t count = static_cast<std::size_t>(header.rows) * static_cast<std::size_t>(header.columns);
    const std::size_t frameBytes = count * static_cast<std::size_t>(header.allocated / 8);
    const Packing packing = *packingOf(header.transferSyntax);
    std::vector<std::byte> bytes;
    if (packing == Packing::none) {
        bytes.resize(frameBytes);
        const std::size_t got =
            input.readAt(header.pixelAt + static_cast<std::uint64_t>(index) * frameBytes, bytes.data(), frameBytes);
        if (got != frameBytes)
            throw core::Error(fmt::format("its pixel data is truncated: {} of {} bytes are there", got, frameBytes),
                              input.where(), "copy or export it again");
    } else {
        bytes = unpack(input, header, index, packing, frameBytes);
    }
    const DicomPlace place = header.placeOf(index);
    const double slope = place.slope.value_or(1.0) == 0.0 ? 1.0 : place.slope.value_or(1.0),
                 intercept = place.intercept.value_or(0.0);
    const bool isBig = header.isBigEndian && packing == Packing::none;
    switch (header.allocated) {
        case 8:
            return bitsToFloat<std::uint8_t, std::int8_t>(bytes.data(), count, header, isBig, slope, intercept, to);
        case 16:
            return bitsToFloat<std::uint16_t, std::int16_t>(bytes.data(), count, header, isBig, slope, intercept, to);
        default:
            return bitsToFloat<std::uint32_t, std::int32_t>(bytes.data(), count, header, isBig, slope, intercept, to);
    }
}

}  // namespace handpiece::volume
