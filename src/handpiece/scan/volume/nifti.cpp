// SPDX-License-Identifier: Apache-2.0
// NIfTI 1 and 2, one file or .hdr and .img, plain or gzip. https://nifti.nimh.nih.gov. Read here and not by its
// library, which reads only files on disk and trusts their headers.
#include <fmt/format.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "handpiece/scan/volume/header_text.h"
#include "handpiece/scan/volume/samples.h"

namespace handpiece::volume {
namespace {

constexpr std::size_t kHeader1 = 348, kHeader2 = 540;
constexpr std::size_t kMaxExtensions = 1 << 18;
constexpr int kRgb = 128, kRgba = 2304;

/// The numbers of a header, at their places of version 1 and 2.
struct Reader {
    std::array<std::byte, kHeader2> bytes{};
    bool isSwapped = false;

    template <class T>
    [[nodiscard]] T at(std::size_t place) const {
        std::array<std::byte, sizeof(T)> raw;
        std::memcpy(raw.data(), bytes.data() + place, sizeof(T));
        if (isSwapped)
            for (std::size_t i = 0; i < sizeof(T) / 2; ++i)
                std::swap(raw[i], raw[sizeof(T) - 1 - i]);
        return std::bit_cast<T>(raw);
    }
};

/// The first bytes of what is packed.
std::size_t unpackHead(Input& input, void* to, std::size_t count) {
    std::vector<std::byte> packed(std::min<std::uint64_t>(65536, input.size()));
    packed.resize(input.readAt(0, packed.data(), packed.size()));
    z_stream zlib{};
    if (inflateInit2(&zlib, 15 + 32) != Z_OK) return 0;
    zlib.next_in = reinterpret_cast<Bytef*>(packed.data());
    zlib.avail_in = static_cast<uInt>(packed.size());
    zlib.next_out = static_cast<Bytef*>(to);
    zlib.avail_out = static_cast<uInt>(count);
    (void)inflate(&zlib, Z_SYNC_FLUSH);
    const std::size_t got = count - zlib.avail_out;
    inflateEnd(&zlib);
    return got;
}

std::optional<SampleType> typeOf(int code) {
    using enum SampleType;
    switch (code) {
        case 2:
            return u8;
        case 4:
            return i16;
        case 8:
            return i32;
        case 16:
            return f32;
        case 64:
            return f64;
        case 256:
            return i8;
        case 512:
            return u16;
        case 768:
            return u32;
        case 1024:
            return i64;
        case 1280:
            return u64;
        default:
            return {};
    }
}

/// <Label Key="46" ...><![CDATA[name]]></Label> of the table that Connectome Workbench defined and TotalSegmentator
/// writes into an extension of the header.
std::vector<LabelName> labelTableOf(std::string_view text) {
    std::vector<LabelName> names;
    std::size_t at = text.find("<LabelTable");
    if (at == std::string_view::npos) return names;
    while ((at = text.find("<Label ", at)) != std::string_view::npos) {
        const std::size_t open = text.find('>', at), end = text.find("</Label>", at);
        const std::size_t key = text.find("Key=\"", at);
        if (open == std::string_view::npos || end == std::string_view::npos) break;
        at = end;
        if (key == std::string_view::npos || key > open) continue;
        const std::size_t number = key + 5;
        const auto value = wholeOf(text.substr(number, text.find('"', number) - number));
        std::string_view name = trimmed(text.substr(open + 1, end - open - 1));
        constexpr std::string_view kData = "<![CDATA[";
        if (name.starts_with(kData) && name.ends_with("]]>"))
            name = name.substr(kData.size(), name.size() - kData.size() - 3);
        if (value && *value > 0 && *value <= 255 && !name.empty())
            names.push_back({static_cast<int>(*value), std::string(trimmed(name))});
    }
    return names;
}

}  // namespace

Candidate openNifti(const Files& files, std::size_t index) {
    Candidate out;
    out.where = files->where(index);
    out.series.format = "NIfTI";
    const auto wrong = [&](const std::string& what, const std::string& remedy = "save the file again") {
        return core::Error(what, out.where, remedy);
    };
    Input input = files->open(index);
    const auto isPacked = [](Input& file) {
        std::array<std::byte, 2> magic{};
        (void)file.readAt(0, magic.data(), 2);
        return magic == std::array{std::byte{0x1f}, std::byte{0x8b}};
    };
    Samples samples;
    samples.files = files;
    samples.file = index;
    samples.isPacked = isPacked(input);
    Reader header;
    const std::size_t got = samples.isPacked ? unpackHead(input, header.bytes.data(), header.bytes.size())
                                             : input.readAt(0, header.bytes.data(), header.bytes.size());
    if (got < kHeader1) throw wrong("it ends in its header", "copy or save the file again");
    std::int32_t headerBytes = header.at<std::int32_t>(0);
    if (headerBytes != 348 && headerBytes != 540) {
        header.isSwapped = true;
        headerBytes = header.at<std::int32_t>(0);
    }
    const bool is2 = headerBytes == 540;
    char word[4] = {};
    std::memcpy(word, header.bytes.data() + (is2 ? 4 : 344), 4);
    const bool isOneFile = std::memcmp(word, is2 ? "n+2" : "n+1", 4) == 0;
    if ((!isOneFile && std::memcmp(word, is2 ? "ni2" : "ni1", 4) != 0) || (is2 && got < kHeader2))
        throw wrong("this is no NIfTI file", "name another file");
    samples.isBigEndian = header.isSwapped != (std::endian::native == std::endian::big);

    const auto dim = [&](std::size_t i) -> std::int64_t {
        return is2 ? header.at<std::int64_t>(16 + 8 * i) : header.at<std::int16_t>(40 + 2 * i);
    };
    const auto pixdim = [&](std::size_t i) {
        return is2 ? header.at<double>(104 + 8 * i) : static_cast<double>(header.at<float>(76 + 4 * i));
    };
    const auto real = [&](std::size_t place1, std::size_t place2) {
        return is2 ? header.at<double>(place2) : static_cast<double>(header.at<float>(place1));
    };
    const auto code = [&](std::size_t place1, std::size_t place2) -> int {
        return is2 ? header.at<std::int32_t>(place2) : header.at<std::int16_t>(place1);
    };
    if (dim(0) < 3 || dim(0) > 7)
        throw wrong(fmt::format("it has {} dimensions, not three", dim(0)), "save one volume of grey values");
    for (std::size_t i = 4; i <= static_cast<std::size_t>(dim(0)); ++i)
        if (dim(i) > 1) throw wrong("it holds several volumes", "save one volume of grey values");
    checkSize({dim(1), dim(2), dim(3)}, out.where);
    samples.size = {static_cast<int>(dim(1)), static_cast<int>(dim(2)), static_cast<int>(dim(3))};
    const int typeCode = is2 ? header.at<std::int16_t>(12) : header.at<std::int16_t>(70);
    const auto type = typeOf(typeCode);
    if (typeCode == kRgb || typeCode == kRgba)
        throw wrong("its voxels are colours, no grey values or labels", "save one number a voxel");
    if (!type)
        throw wrong(fmt::format("values of the NIfTI type {} are not read", typeCode),
                    "save it as whole numbers or floats");
    samples.type = *type;
    const double slope = real(112, 176), intercept = real(116, 184);
    if (std::isfinite(slope) && slope != 0.0 && std::isfinite(intercept)) {
        samples.slope = slope;
        samples.intercept = intercept;
    }
    const double offset =
        is2 ? static_cast<double>(header.at<std::int64_t>(168)) : static_cast<double>(header.at<float>(108));
    std::uint64_t begin = offset >= 0.0 && offset < 1e15 ? static_cast<std::uint64_t>(offset) : 0;
    if (isOneFile) {
        const std::size_t own = is2 ? kHeader2 : kHeader1;
        begin = std::max<std::uint64_t>(begin, own);
        if (begin > own + 12) {
            std::string head(std::min<std::uint64_t>(begin, own + kMaxExtensions), '\0');
            head.resize(samples.isPacked ? unpackHead(input, head.data(), head.size())
                                         : input.readAt(0, head.data(), head.size()));
            if (head.size() > own) out.series.labelNames = labelTableOf(std::string_view(head).substr(own));
        }
    } else {
        const std::string& name = files->entries()[index].name;
        std::string image = name.substr(folderOf(name).size());
        if (const std::size_t dot = image.rfind(".hdr"); dot != std::string::npos)
            image.replace(dot, image.size() - dot, ".img");
        auto found = files->find(name, image);
        if (!found) found = files->find(name, image + ".gz");
        if (!found || *found == index)
            throw wrong(fmt::format("its data file \"{}\" is missing", shown(image)), "put it beside the header");
        samples.file = *found;
        Input data = files->open(*found);
        samples.isPacked = isPacked(data);
    }
    (samples.isPacked ? samples.skip : samples.offset) = begin;

    // Units of space: 1 metres, 2 millimetres, 3 micrometres; none told means millimetres.
    const int units = (is2 ? header.at<std::int32_t>(500) : static_cast<int>(header.bytes[123])) & 7;
    const double unit = units == 1 ? 1000.0 : units == 3 ? 1e-3 : 1.0;
    core::Mat3 neighbours = core::Mat3::Zero();
    core::Vec3 origin = core::Vec3::Zero();
    const core::Vec3 spacing(pixdim(1), pixdim(2), pixdim(3));
    bool isPlaced = false;
    if (code(254, 348) > 0) {
        for (int row = 0; row < 3; ++row) {
            const auto r = static_cast<std::size_t>(row);
            for (int c = 0; c < 4; ++c) {
                const double v = real(280 + 16 * r + 4 * static_cast<std::size_t>(c),
                                      400 + 32 * r + 8 * static_cast<std::size_t>(c));
                (c < 3 ? neighbours(row, c) : origin[row]) = v;
            }
        }
        isPlaced = neighbours.allFinite() && origin.allFinite() && std::abs(neighbours.determinant()) > 0.0;
    }
    if (!isPlaced && code(252, 344) > 0) {
        const core::Vec3 q(real(256, 352), real(260, 360), real(264, 368));
        origin = {real(268, 376), real(272, 384), real(276, 392)};
        const double a = std::sqrt(std::max(0.0, 1.0 - q.squaredNorm()));
        core::Mat3 axes = core::Quat(a, q.x(), q.y(), q.z()).normalized().toRotationMatrix();
        if (pixdim(0) < 0.0) axes.col(2) *= -1.0;
        neighbours = axes * spacing.asDiagonal();
        isPlaced = neighbours.allFinite() && origin.allFinite();
    }
    setSpacing(out, unit * spacing.cwiseAbs());
    if (isPlaced && (out.spacingProblem.empty() || code(254, 348) > 0)) {
        const core::Vec3 toLps(-1, -1, 1);  // NIfTI's world is right, front, head
        setVectors(out, unit * toLps.asDiagonal() * neighbours);
        out.grid.originMm = unit * toLps.cwiseProduct(origin);
    } else {
        out.sideProblem = "its header tells no orientation (neither qform nor sform)";
    }
    setSamples(out, std::move(samples));
    return out;
}

}  // namespace handpiece::volume
