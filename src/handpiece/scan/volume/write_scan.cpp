// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/volume/write_scan.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/scan/volume/candidate.h"
#include "handpiece/scan/volume/dicom_write.h"
#include "handpiece/scan/volume/pictures.h"

namespace handpiece::volume {
namespace {

namespace fs = std::filesystem;

/// stored = round((value - intercept) / slope)
struct Scale {
    double slope = 1.0, intercept = 0.0;
    bool isSigned = false;
};

struct Range {
    double low = 0.0, high = 0.0;
};

Range rangeOf(const Volume& volume) {
    const auto [low, high] = std::minmax_element(volume.values.begin(), volume.values.end());
    return {static_cast<double>(*low), static_cast<double>(*high)};
}

/// Whole numbers as they are where 16 bits hold them; else as many steps as there are.
Scale scale16(const Range& range, bool mayBeSigned) {
    if (range.low >= -0.5 && range.high < 65535.5) return {};
    if (mayBeSigned && range.low >= -32768.5 && range.high < 32767.5) return {1.0, 0.0, true};
    const double low = std::floor(range.low);
    if (range.high - low < 65535.0) return {1.0, low, false};
    return {(range.high - range.low) / 65535.0, range.low, false};
}

Scale scale8(const Range& range) {
    if (range.high <= range.low) return {1.0, range.low, false};
    return {(range.high - range.low) / 255.0, range.low, false};
}

std::uint16_t stored(float value, const Scale& scale, double most) {
    const double v = std::round((static_cast<double>(value) - scale.intercept) / scale.slope);
    if (scale.isSigned) return static_cast<std::uint16_t>(static_cast<std::int16_t>(std::clamp(v, -32768.0, 32767.0)));
    return static_cast<std::uint16_t>(std::clamp(v, 0.0, most));
}

std::vector<std::uint16_t> sliceOf(const Volume& volume, int k, const Scale& scale, double most = 65535.0) {
    const std::size_t each = volume.grid.index(0, 0, 1);
    const float* from = volume.values.data() + static_cast<std::size_t>(k) * each;
    std::vector<std::uint16_t> out(each);
    std::transform(from, from + each, out.begin(), [&](float v) { return stored(v, scale, most); });
    return out;
}

std::string description(const Grid& grid, const Scale& scale, const std::string& more) {
    const core::Vec3 &s = grid.spacingMm, &o = grid.originMm;
    const core::Mat3& a = grid.axes;
    std::string text = fmt::format(
        "# What the files beside this one do not tell themselves.\nformat = 1\n{}spacing_mm = [{}, {}, {}]\n"
        "origin_mm = [{}, {}, {}]\naxes = [{}, {}, {}, {}, {}, {}, {}, {}, {}]\n",
        more, s.x(), s.y(), s.z(), o.x(), o.y(), o.z(), a(0, 0), a(1, 0), a(2, 0), a(0, 1), a(1, 1), a(2, 1), a(0, 2),
        a(1, 2), a(2, 2));
    if (scale.slope != 1.0 || scale.intercept != 0.0)
        text += fmt::format("slope = {}\nintercept = {}\n", scale.slope, scale.intercept);
    return text;
}

/// A file that is written piece by piece.
class Output {
  public:
    explicit Output(const fs::path& path) : path_(path), file_(std::fopen(path.string().c_str(), "wb")) {
        if (!file_) fail();
    }
    void add(const void* from, std::size_t bytes) {
        if (bytes > 0 && std::fwrite(from, 1, bytes, file_.get()) != bytes) fail();
    }
    void add(const std::string& text) { add(text.data(), text.size()); }
    void close() {
        if (std::fflush(file_.get()) != 0 || std::fclose(file_.release()) != 0) fail();
    }

  private:
    [[noreturn]] void fail() const {
        throw core::Error(fmt::format("cannot be written: {}", std::strerror(errno)), path_.string(),
                          "check the folder, its permissions and the free space")
            .as(core::writeErrorId(errno), {std::strerror(errno)});
    }
    struct Close {
        void operator()(std::FILE* f) const noexcept { std::fclose(f); }
    };
    fs::path path_;
    std::unique_ptr<std::FILE, Close> file_;
};

/// Little-endian 16-bit numbers of all slices.
void addNumbers(Output& out, const Volume& volume, const Scale& scale, const core::Progress& progress) {
    for (int k = 0; k < volume.grid.size[2]; ++k) {
        std::vector<std::uint16_t> slice = sliceOf(volume, k, scale);
        std::vector<std::uint8_t> bytes(2 * slice.size());
        for (std::size_t i = 0; i < slice.size(); ++i) {
            bytes[2 * i] = static_cast<std::uint8_t>(slice[i] & 0xff);
            bytes[2 * i + 1] = static_cast<std::uint8_t>(slice[i] >> 8);
        }
        out.add(bytes.data(), bytes.size());
        core::report(progress, static_cast<double>(k + 1) / volume.grid.size[2]);
    }
}

std::string nrrdHeader(const Grid& grid, const char* type, const char* encoding) {
    std::string directions;
    for (int axis = 0; axis < 3; ++axis) {
        const core::Vec3 d = grid.axes.col(axis) * grid.spacingMm[axis];
        directions += fmt::format("{}({},{},{})", axis == 0 ? "" : " ", d.x(), d.y(), d.z());
    }
    const core::Vec3& o = grid.originMm;
    return fmt::format(
        "NRRD0004\ntype: {}\ndimension: 3\nspace: left-posterior-superior\nsizes: {} {} {}\nspace directions: {}\n"
        "kinds: domain domain domain\nendian: little\nencoding: {}\nspace origin: ({},{},{})\n",
        type, grid.size[0], grid.size[1], grid.size[2], directions, encoding, o.x(), o.y(), o.z());
}

std::string metaImageHeader(const Grid& grid, const Scale& scale) {
    const core::Vec3 &s = grid.spacingMm, &o = grid.originMm;
    const core::Mat3& a = grid.axes;
    return fmt::format(
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
        "TransformMatrix = {} {} {} {} {} {} {} {} {}\nOffset = {} {} {}\nElementSpacing = {} {} {}\nDimSize = {} {} "
        "{}\n"
        "ElementType = {}\nElementDataFile = LOCAL\n",
        a(0, 0), a(1, 0), a(2, 0), a(0, 1), a(1, 1), a(2, 1), a(0, 2), a(1, 2), a(2, 2), o.x(), o.y(), o.z(), s.x(),
        s.y(), s.z(), grid.size[0], grid.size[1], grid.size[2], scale.isSigned ? "MET_SHORT" : "MET_USHORT");
}

std::vector<std::byte> niftiHeader(const Grid& grid, const Scale& scale) {
    std::vector<std::byte> h(352);
    const auto put = [&]<class T>(std::size_t at, T value) { std::memcpy(h.data() + at, &value, sizeof value); };
    put(0, std::int32_t{348});
    put(40, std::int16_t{3});
    for (std::size_t i = 0; i < 3; ++i)
        put(42 + 2 * i, static_cast<std::int16_t>(grid.size[i]));
    for (std::size_t i = 3; i < 7; ++i)
        put(42 + 2 * i, std::int16_t{1});
    put(70, std::int16_t{static_cast<std::int16_t>(scale.isSigned ? 4 : 512)});
    put(72, std::int16_t{16});
    put(76, 1.0f);
    for (int i = 0; i < 3; ++i)
        put(80 + 4 * static_cast<std::size_t>(i), static_cast<float>(grid.spacingMm[i]));
    put(108, 352.0f);
    put(112, static_cast<float>(scale.slope));
    put(116, static_cast<float>(scale.intercept));
    h[123] = std::byte{2};  // millimetres
    put(254, std::int16_t{1});
    const core::Vec3 toRas(-1, -1, 1);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) {
            const double v = column < 3 ? grid.axes(row, column) * grid.spacingMm[column] : grid.originMm[row];
            put(280 + 16 * static_cast<std::size_t>(row) + 4 * static_cast<std::size_t>(column),
                static_cast<float>(toRas[row] * v));
        }
    std::memcpy(h.data() + 344, "n+1", 4);
    return h;
}

/// One file a slice.
void writeSlices(const Volume& volume, const fs::path& folder, ScanFormat format, const core::Progress& progress) {
    const Grid& grid = volume.grid;
    const Range range = rangeOf(volume);
    const bool isNarrow = format == ScanFormat::bmp || format == ScanFormat::jpeg;
    const Scale scale = isNarrow ? scale8(range) : scale16(range, format == ScanFormat::dicom);
    const std::string extension = format == ScanFormat::dicom  ? "dcm"
                                  : format == ScanFormat::bmp  ? "bmp"
                                  : format == ScanFormat::jpeg ? "jpg"
                                  : format == ScanFormat::png  ? "png"
                                                               : "tif";
    const std::uint64_t key = format == ScanFormat::dicom ? scanKey(volume) : 0;
    std::atomic<int> done{0};
    core::parallelFor(static_cast<std::size_t>(grid.size[2]), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t slice = begin; slice < end; ++slice) {
            const int k = static_cast<int>(slice);
            const std::vector<std::uint16_t> wide = sliceOf(volume, k, scale, isNarrow ? 255.0 : 65535.0);
            const fs::path file = folder / fmt::format("slice_{:04}.{}", k + 1, extension);
            if (isNarrow) {
                std::vector<std::uint8_t> grey(wide.begin(), wide.end());
                core::writeFile(file, format == ScanFormat::bmp ? bmpBytes(grey, grid.size[0], grid.size[1])
                                                                : jpegBytes(grey, grid.size[0], grid.size[1]));
            } else if (format == ScanFormat::png) {
                core::writeFile(file, pngBytes(wide, grid.size[0], grid.size[1]));
            } else if (format == ScanFormat::tiff) {
                core::writeFile(file, tiffBytes(wide, grid.size[0], grid.size[1], grid.spacingMm));
            } else {
                const DicomScale told{scale.slope, scale.intercept, scale.isSigned};
                core::writeFile(file, dicomBytes(wide, grid, k, told, key));
            }
            core::report(progress, static_cast<double>(++done) / grid.size[2]);
        }
    });
    if (format != ScanFormat::dicom) core::writeFile(folder / "scan.toml", description(grid, scale, ""));
}

void writeOneFile(const Volume& volume, const fs::path& folder, ScanFormat format, const core::Progress& progress) {
    const Grid& grid = volume.grid;
    Scale scale = scale16(rangeOf(volume), true);
    const bool hasScale = format == ScanFormat::raw || format == ScanFormat::nifti;
    if (!hasScale && (scale.slope != 1.0 || scale.intercept != 0.0))
        throw core::Error("its values do not fit 16 bits, and this format cannot scale them", folder.string(),
                          "choose DICOM, TIFF, raw or NIfTI");
    if (format == ScanFormat::nifti && *std::max_element(grid.size.begin(), grid.size.end()) > 32767)
        throw core::Error("it has more than 32767 voxels along an axis", folder.string(),
                          "choose another format than NIfTI");
    const char* name = format == ScanFormat::nrrd        ? "scan.nrrd"
                       : format == ScanFormat::metaimage ? "scan.mha"
                       : format == ScanFormat::nifti     ? "scan.nii"
                                                         : "scan.raw";
    Output out(folder / name);
    if (format == ScanFormat::nrrd) out.add(nrrdHeader(grid, scale.isSigned ? "short" : "ushort", "raw") + "\n");
    if (format == ScanFormat::metaimage) out.add(metaImageHeader(grid, scale));
    if (format == ScanFormat::nifti) {
        const std::vector<std::byte> header = niftiHeader(grid, scale);
        out.add(header.data(), header.size());
    }
    addNumbers(out, volume, scale, progress);
    out.close();
    if (format == ScanFormat::raw)
        core::writeFile(
            folder / "scan.toml",
            description(
                grid, scale,
                fmt::format("file = \"scan.raw\"\nsize = [{}, {}, {}]\ntype = \"{}\"\nbyte_order = \"little\"\n",
                            grid.size[0], grid.size[1], grid.size[2], scale.isSigned ? "int16" : "uint16")));
}

/// A name that writeScan gives its files.
bool isOurs(const std::string& name) {
    if (name.rfind("scan.", 0) == 0) {
        for (const char* ours : {"scan.nrrd", "scan.mha", "scan.nii", "scan.raw", "scan.toml"})
            if (name == ours) return true;
        return false;
    }
    if (name.rfind("slice_", 0) != 0) return false;
    const std::string extension = extensionOf(name);
    const std::string number = name.substr(6, name.size() - 6 - extension.size());
    const bool isNumber = !number.empty() && number.find_first_not_of("0123456789") == std::string::npos;
    return isNumber && (extension == ".dcm" || extension == ".tif" || extension == ".bmp" || extension == ".jpg" ||
                        extension == ".png");
}

}  // namespace

ScanFormat scanFormatByName(std::string_view name) {
    constexpr std::array<std::pair<std::string_view, ScanFormat>, 9> kNames{{{"dicom", ScanFormat::dicom},
                                                                             {"tiff", ScanFormat::tiff},
                                                                             {"bmp", ScanFormat::bmp},
                                                                             {"jpeg", ScanFormat::jpeg},
                                                                             {"png", ScanFormat::png},
                                                                             {"nrrd", ScanFormat::nrrd},
                                                                             {"raw", ScanFormat::raw},
                                                                             {"metaimage", ScanFormat::metaimage},
                                                                             {"nifti", ScanFormat::nifti}}};
    std::string all;
    for (const auto& [known, format] : kNames) {
        if (name == known) return format;
        all += fmt::format("{}{}", all.empty() ? "" : ", ", known);
    }
    throw core::Error(fmt::format("there is no format \"{}\"", name.substr(0, 60)), "format",
                      fmt::format("one of {}", all));
}

void writeScan(const Volume& volume, const fs::path& folder, ScanFormat format, const core::Progress& progress) {
    if (volume.grid.count() == 0 || volume.values.size() != volume.grid.count())
        throw core::Error("the scan is empty", folder.string(), "read or make one first");
    if (!std::all_of(volume.values.begin(), volume.values.end(), [](float v) { return std::isfinite(v); }))
        throw core::Error("the scan holds values that are no numbers", folder.string(), "mend it first");
    core::prepareOutputFolder(folder);
    core::Hasher salt;
    salt.add(core::wholePath(folder).string());
    salt.add(fs::file_time_type::clock::now().time_since_epoch().count());
    const fs::path part = folder / fmt::format(".scan-{:x}.part", salt.value());
    std::error_code ec;
    try {
        core::prepareOutputFolder(part);
        const bool isOneFile = format == ScanFormat::nrrd || format == ScanFormat::raw ||
                               format == ScanFormat::metaimage || format == ScanFormat::nifti;
        isOneFile ? writeOneFile(volume, part, format, progress) : writeSlices(volume, part, format, progress);
        // A scan of before goes: its slices would be read with the new ones.
        for (const fs::directory_entry& old : fs::directory_iterator(folder))
            if (old.is_regular_file() && isOurs(old.path().filename().string())) fs::remove(old.path());
        for (const fs::directory_entry& made : fs::directory_iterator(part))
            fs::rename(made.path(), folder / made.path().filename());
        fs::remove_all(part);
    } catch (const fs::filesystem_error& e) {
        fs::remove_all(part, ec);
        throw core::Error(fmt::format("cannot be written: {}", e.code().message()), folder.string(),
                          "check the folder, its permissions and the free space")
            .as("not-writable", {e.code().message()});
    } catch (...) {
        fs::remove_all(part, ec);
        throw;
    }
}

void writeLabels(const Labels& labels, const fs::path& file) {
    if (labels.grid.count() == 0 || labels.values.size() != labels.grid.count())
        throw core::Error("there are no labels", file.string(), "segment a scan first");
    const std::string header = nrrdHeader(labels.grid, "uchar", "gzip") + "\n";
    z_stream zlib{};
    if (deflateInit2(&zlib, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        throw core::Error("zlib does not start", file.string(), "free some memory");
    std::vector<std::byte> out(header.size());
    std::memcpy(out.data(), header.data(), header.size());
    std::vector<std::byte> chunk(1 << 16);
    constexpr std::size_t kMost = 1u << 30;  // zlib counts in 32 bits
    for (std::size_t at = 0; at < labels.values.size(); at += kMost) {
        const std::size_t part = std::min(kMost, labels.values.size() - at);
        zlib.next_in = const_cast<Bytef*>(labels.values.data() + at);
        zlib.avail_in = static_cast<uInt>(part);
        const int flush = at + part == labels.values.size() ? Z_FINISH : Z_NO_FLUSH;
        do {
            zlib.next_out = reinterpret_cast<Bytef*>(chunk.data());
            zlib.avail_out = static_cast<uInt>(chunk.size());
            (void)deflate(&zlib, flush);
            out.insert(out.end(), chunk.begin(),
                       chunk.begin() + static_cast<std::ptrdiff_t>(chunk.size() - zlib.avail_out));
        } while (zlib.avail_out == 0);
    }
    deflateEnd(&zlib);
    core::writeFile(file, out);
}

}  // namespace handpiece::volume
