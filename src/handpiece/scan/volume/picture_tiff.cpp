// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>

#include "handpiece/scan/volume/header_text.h"
#include "handpiece/scan/volume/picture_orientation.h"
#include "handpiece/scan/volume/pictures.h"
#include "handpiece/scan/volume/samples.h"

namespace handpiece::volume {
namespace {

constexpr int kMaxPages = 100000;
constexpr std::uint32_t kMaxSide = 100000;
constexpr tmsize_t kMaxPiece = 1ll << 30;

/// What libtiff reads from or writes to.
struct Stream {
    Input* input = nullptr;
    std::vector<std::byte>* out = nullptr;
    std::uint64_t at = 0;
    std::string text;  ///< the first error
};

tmsize_t readSome(thandle_t handle, void* to, tmsize_t count) {
    auto* s = static_cast<Stream*>(handle);
    if (count < 0) return -1;
    std::size_t got = 0;
    if (s->out) {
        got =
            s->at < s->out->size() ? std::min<std::size_t>(static_cast<std::size_t>(count), s->out->size() - s->at) : 0;
        std::memcpy(to, s->out->data() + s->at, got);
    } else {
        got = s->input->readAt(s->at, to, static_cast<std::size_t>(count));
    }
    s->at += got;
    return static_cast<tmsize_t>(got);
}
tmsize_t writeSome(thandle_t handle, void* from, tmsize_t count) {
    auto* s = static_cast<Stream*>(handle);
    if (!s->out || count < 0) return -1;
    s->out->resize(std::max<std::size_t>(s->out->size(), s->at + static_cast<std::size_t>(count)));
    std::memcpy(s->out->data() + s->at, from, static_cast<std::size_t>(count));
    s->at += static_cast<std::uint64_t>(count);
    return count;
}
toff_t sizeOf(thandle_t handle) {
    auto* s = static_cast<Stream*>(handle);
    return s->out ? s->out->size() : s->input->size();
}
toff_t seek(thandle_t handle, toff_t offset, int from) {
    auto* s = static_cast<Stream*>(handle);
    s->at = from == SEEK_SET ? offset : from == SEEK_CUR ? s->at + offset : sizeOf(handle) + offset;
    return s->at;
}
int closeNothing(thandle_t /*handle*/) {
    return 0;
}

int onError(TIFF* /*tiff*/, void* user, const char* /*module*/, const char* format, va_list arguments) {
    auto* s = static_cast<Stream*>(user);
    if (s->text.empty()) {
        char text[200];
        std::vsnprintf(text, sizeof text, format, arguments);
        s->text = shown(text);
    }
    return 1;
}
int onWarning(TIFF* /*tiff*/, void* /*user*/, const char* /*module*/, const char* /*format*/, va_list /*arguments*/) {
    return 1;
}

struct Close {
    void operator()(TIFF* tiff) const noexcept { TIFFClose(tiff); }
};
using Tiff = std::unique_ptr<TIFF, Close>;

Tiff open(Stream& stream, const char* mode) {
    TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
    TIFFOpenOptionsSetErrorHandlerExtR(options, onError, &stream);
    TIFFOpenOptionsSetWarningHandlerExtR(options, onWarning, &stream);
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, kMaxPiece);
    Tiff tiff(TIFFClientOpenExt("slice", mode, &stream, readSome, writeSome, seek, closeNothing, sizeOf, nullptr,
                                nullptr, options));
    TIFFOpenOptionsFree(options);
    return tiff;
}

struct Page {
    int columns = 0, rows = 0;  ///< as they lie in the file
    Orientation orientation{};
    SampleType type = SampleType::u8;
    std::uint16_t samples = 1, bits = 8, photometric = PHOTOMETRIC_MINISBLACK;
    bool isReduced = false, isInks = false;
    [[nodiscard]] int seenColumns() const { return orientation.isTransposed() ? rows : columns; }
    [[nodiscard]] int seenRows() const { return orientation.isTransposed() ? columns : rows; }
};

Page pageOf(TIFF* tiff, const Input& input) {
    Page page;
    std::uint32_t columns = 0, rows = 0, kind = 0;
    std::uint16_t format = SAMPLEFORMAT_UINT, planar = PLANARCONFIG_CONTIG, lies = ORIENTATION_TOPLEFT;
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &columns);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &rows);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &page.bits);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &page.samples);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &format);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &planar);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SUBFILETYPE, &kind);
    TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &page.photometric);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &lies);
    page.orientation = Orientation(lies);
    if (columns < 1 || rows < 1 || columns > kMaxSide || rows > kMaxSide)
        throw damagedPicture(input, fmt::format("its size is {} x {}", columns, rows));
    page.columns = static_cast<int>(columns);
    page.rows = static_cast<int>(rows);
    page.isReduced = (kind & FILETYPE_REDUCEDIMAGE) != 0;
    const bool isColour = page.samples >= 3;
    std::uint16_t compression = COMPRESSION_NONE, inks = INKSET_CMYK;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_INKSET, &inks);
    page.isInks = page.photometric == PHOTOMETRIC_SEPARATED;
    if (page.isInks && (inks != INKSET_CMYK || page.samples != 4))
        throw core::Error("its pixels are inks other than cyan, magenta, yellow and black", input.where(),
                          "save it as 8-bit or 16-bit grey");
    // Of a JPEG within, libtiff makes red, green and blue.
    const bool isJpeg = page.photometric == PHOTOMETRIC_YCBCR && compression == COMPRESSION_JPEG;
    if (isJpeg) TIFFSetField(tiff, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
    if (isColour && !page.isInks && !isJpeg && page.photometric != PHOTOMETRIC_RGB &&
        page.photometric != PHOTOMETRIC_MINISBLACK && page.photometric != PHOTOMETRIC_MINISWHITE)
        throw core::Error(fmt::format("its colours are of a kind that is not read ({})",
                                      page.photometric == PHOTOMETRIC_YCBCR    ? "YCbCr"
                                      : page.photometric == PHOTOMETRIC_CIELAB ? "CIE L*a*b*"
                                                                               : "neither grey, RGB nor CMYK"),
                          input.where(), "save it as 8-bit or 16-bit grey");
    if ((isColour && (page.bits != 8 || planar != PLANARCONFIG_CONTIG)) ||
        (page.samples == 2 && planar != PLANARCONFIG_CONTIG) || page.samples > 4)
        throw core::Error("its pixels are of a kind that is not read", input.where(),
                          "save it as 8-bit or 16-bit grey");
    using enum SampleType;
    const bool isFloat = format == SAMPLEFORMAT_IEEEFP, isSigned = format == SAMPLEFORMAT_INT;
    const bool isPalette = page.photometric == PHOTOMETRIC_PALETTE;
    if (page.bits == 8 && !isFloat)
        page.type = isSigned && !isPalette ? i8 : u8;  // places in a palette have no sign, whatever the tag says
    else if (page.bits == 16 && !isFloat)
        page.type = isSigned ? i16 : u16;
    else if (page.bits == 32)
        page.type = isFloat ? f32 : isSigned ? i32 : u32;
    else if (page.bits == 64 && isFloat)
        page.type = f64;
    else
        throw core::Error(fmt::format("it has {} bits a pixel", page.bits), input.where(),
                          "save it as 8-bit or 16-bit grey");
    return page;
}

/// What ImageJ says of a stack in its description; empty where there is none. Only its own keys are looked for.
std::string_view imageJValue(TIFF* tiff, std::string_view key) {
    const char* text = nullptr;
    if (TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &text) != 1 || !text) return {};
    const std::string_view description(text);
    if (!description.starts_with("ImageJ=")) return {};
    const std::size_t at = description.find(key);
    if (at == std::string_view::npos) return {};
    const std::size_t begin = at + key.size();
    return trimmed(description.substr(begin, description.find('\n', begin) - begin));
}

/// ImageJ writes large stacks with one directory, all pages one after another behind it.
struct RawStack {
    std::uint64_t at = 0;  ///< of the first page
    int pages = 0;
};
std::optional<RawStack> rawStackOf(TIFF* tiff, const Page& page, const Input& input) {
    const double images = numberOf(imageJValue(tiff, "\nimages=")).value_or(1.0);
    std::uint16_t compression = COMPRESSION_NONE;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
    if (!(images > 1.0) || compression != COMPRESSION_NONE || TIFFIsTiled(tiff) != 0 || page.samples != 1) return {};
    if (images > kMaxPages) throw damagedPicture(input, "it claims too many pages");
    const RawStack stack{TIFFGetStrileOffset(tiff, 0), static_cast<int>(images)};
    const std::uint64_t each =
        static_cast<std::uint64_t>(page.columns) * static_cast<std::uint64_t>(page.rows) * bytesOf(page.type);
    if (stack.at > input.size() || static_cast<std::uint64_t>(stack.pages) > (input.size() - stack.at) / each)
        throw damagedPicture(input, fmt::format("it says that it has {} pages, and is too short for them", images));
    return stack;
}

/// How often one place is there, and how many pages that makes, by ImageJ's description or OME's.
struct StackLayout {
    double channels = 1, times = 1;
    std::optional<double> pages;
};
StackLayout layoutOf(TIFF* tiff, const Page& page) {
    StackLayout layout;
    layout.channels = numberOf(imageJValue(tiff, "\nchannels=")).value_or(1.0);
    layout.times = numberOf(imageJValue(tiff, "\nframes=")).value_or(1.0);
    layout.pages = numberOf(imageJValue(tiff, "\nimages="));
    const char* text = nullptr;
    if (TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &text) != 1 || !text) return layout;
    std::string_view pixels(text);
    const std::size_t at = pixels.find("Pixels ");
    if (pixels.find("<OME") == std::string_view::npos || at == std::string_view::npos) return layout;
    pixels = pixels.substr(at, pixels.find('>', at) - at);
    const auto value = [&](std::string_view key) -> std::optional<double> {
        const std::size_t begin = pixels.find(key);
        if (begin == std::string_view::npos) return {};
        const std::string_view rest = pixels.substr(begin + key.size());
        return numberOf(rest.substr(0, rest.find('"')));
    };
    // The parts of a colour are channels too, and lie in one page.
    layout.channels = value(" SizeC=\"").value_or(1.0) / (page.samples >= 3 ? page.samples : 1);
    layout.times = value(" SizeT=\"").value_or(1.0);
    if (const auto slices = value(" SizeZ=\"")) layout.pages = *slices * std::max(1.0, layout.channels) * layout.times;
    return layout;
}

/// Pages that are no slices one after another, and pages that are not there.
void checkLayout(const StackLayout& layout, int pages, const Input& input) {
    if (pages < 2) return;
    if (layout.channels > 1.0 || layout.times > 1.0)
        throw core::Error(
            fmt::format("its {} pages are {:g} channel{} and {:g} time point{}, not the slices of one scan", pages,
                        std::max(1.0, layout.channels), layout.channels > 1.0 ? "s" : "", layout.times,
                        layout.times > 1.0 ? "s" : ""),
            input.where(),
            "save one channel and one time point; if they are slices, say so in ImageJ (Image, Properties) and save it "
            "again");
    if (layout.pages && *layout.pages > pages)
        throw damagedPicture(input,
                             fmt::format("it says that it has {:g} pages, and {} are there", *layout.pages, pages));
}

/// True where the directory at `at` names another behind it.
bool namesAnother(Input& input, std::uint64_t at, bool isBigEndian) {
    const auto number = [&](std::uint64_t from, std::size_t bytes) {
        std::array<std::uint8_t, 8> raw{};
        (void)input.readAt(from, raw.data(), bytes);
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < bytes; ++i)
            value = value << 8 | raw[isBigEndian ? i : bytes - 1 - i];
        return value;
    };
    constexpr std::uint64_t kBigTiff = 43;
    if (number(2, 2) == kBigTiff) return number(at + 8 + 20 * number(at, 8), 8) != 0;
    return number(at + 2 + 12 * number(at, 2), 4) != 0;
}

/// It writes their spacing as text and resolution.
std::optional<core::Vec3> imageJSpacing(TIFF* tiff) {
    float x = 0.0f, y = 0.0f;
    const auto value = [tiff](std::string_view key) { return imageJValue(tiff, key); };
    const std::string_view unit = value("\nunit=");
    const double mm = unit == "mm"   ? 1.0
                      : unit == "cm" ? 10.0
                      : unit == "um" || unit == "micron" || unit == "\\u00B5m" || unit == "\xc2\xb5m" || unit == "\xb5m"
                          ? 1e-3
                          : 0.0;
    if (mm == 0.0 || TIFFGetField(tiff, TIFFTAG_XRESOLUTION, &x) != 1 ||
        TIFFGetField(tiff, TIFFTAG_YRESOLUTION, &y) != 1)
        return {};
    const core::Vec3 spacing(mm / static_cast<double>(x), mm / static_cast<double>(y),
                             mm * numberOf(value("\nspacing=")).value_or(0.0));
    if (!isSpacing(spacing.x()) || !isSpacing(spacing.y())) return {};
    return spacing;
}

/// As TIFF itself tells it: dots an inch or a centimetre. ImageJ writes other units there.
std::optional<core::Vec2> densityOf(TIFF* tiff) {
    float x = 0.0f, y = 0.0f;
    std::uint16_t unit = RESUNIT_INCH;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_RESOLUTIONUNIT, &unit);
    const double mm = unit == RESUNIT_INCH ? 25.4 : unit == RESUNIT_CENTIMETER ? 10.0 : 0.0;
    const char* text = nullptr;
    const bool isImageJ = TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &text) == 1 && text &&
                          std::string_view(text).starts_with("ImageJ=");
    if (mm == 0.0 || isImageJ || TIFFGetField(tiff, TIFFTAG_XRESOLUTION, &x) != 1 ||
        TIFFGetField(tiff, TIFFTAG_YRESOLUTION, &y) != 1 || !(x > 0.0f) || !(y > 0.0f))
        return {};
    return core::Vec2(mm / static_cast<double>(x), mm / static_cast<double>(y));
}

/// A row or a tile to grey numbers.
void toGrey(const Page& page, const std::uint16_t* const palette[3], const std::byte* from, std::size_t count,
            float* to) {
    if (page.isInks) {
        const auto* inks = reinterpret_cast<const std::uint8_t*>(from);
        for (std::size_t i = 0; i < count; ++i, inks += page.samples)
            to[i] = greyOfInks(inks[0], inks[1], inks[2], inks[3]);
        return;
    }
    if (page.samples >= 3) {
        const auto* rgb = reinterpret_cast<const std::uint8_t*>(from);
        for (std::size_t i = 0; i < count; ++i, rgb += page.samples)
            to[i] = greyOf(rgb[0], rgb[1], rgb[2]);
        return;
    }
    const std::size_t each = bytesOf(page.type);
    constexpr bool kIsBig = std::endian::native == std::endian::big;  // libtiff has put them in the machine's order
    if (page.samples == 1)
        convert(page.type, kIsBig, 1.0, 0.0, from, count, to);
    else
        for (std::size_t i = 0; i < count; ++i)
            convert(page.type, kIsBig, 1.0, 0.0, from + i * each * page.samples, 1, to + i);
    if (palette[0] && page.bits == 8) {
        for (std::size_t i = 0; i < count; ++i) {
            const auto c = static_cast<std::size_t>(to[i]);
            to[i] = greyOf(palette[0][c] >> 8, palette[1][c] >> 8, palette[2][c] >> 8);
        }
    } else if (page.photometric == PHOTOMETRIC_MINISWHITE && page.bits <= 16) {
        const float white = page.bits == 8 ? 255.0f : 65535.0f;
        for (std::size_t i = 0; i < count; ++i)
            to[i] = white - to[i];
    }
}

void readAsItLies(TIFF* tiff, Stream& stream, const Page& page, float* to) {
    const auto cut = [&] {
        return damagedPicture(*stream.input, stream.text.empty() ? "its pixel data is truncated" : stream.text);
    };
    std::uint16_t* palette[3] = {};
    if (page.photometric == PHOTOMETRIC_PALETTE)
        TIFFGetField(tiff, TIFFTAG_COLORMAP, &palette[0], &palette[1], &palette[2]);
    const auto columns = static_cast<std::size_t>(page.columns), rows = static_cast<std::size_t>(page.rows);
    const std::size_t pixel = bytesOf(page.type) * page.samples;
    if (TIFFIsTiled(tiff) == 0) {
        const tmsize_t bytes = TIFFScanlineSize(tiff);
        if (bytes < static_cast<tmsize_t>(columns * pixel) || bytes > kMaxPiece) throw cut();
        std::vector<std::byte> row(static_cast<std::size_t>(bytes));
        for (std::size_t y = 0; y < rows; ++y) {
            if (TIFFReadScanline(tiff, row.data(), static_cast<std::uint32_t>(y), 0) != 1) throw cut();
            toGrey(page, palette, row.data(), columns, to + y * columns);
        }
        return;
    }
    std::uint32_t width = 0, height = 0;
    TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_TILELENGTH, &height);
    const tmsize_t bytes = TIFFTileSize(tiff);
    if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide || bytes > kMaxPiece ||
        static_cast<std::uint64_t>(width) * height * pixel > static_cast<std::uint64_t>(bytes))
        throw cut();
    std::vector<std::byte> tile(static_cast<std::size_t>(bytes));
    for (std::size_t y0 = 0; y0 < rows; y0 += height)
        for (std::size_t x0 = 0; x0 < columns; x0 += width) {
            if (TIFFReadTile(tiff, tile.data(), static_cast<std::uint32_t>(x0), static_cast<std::uint32_t>(y0), 0, 0) <
                0)
                throw cut();
            for (std::size_t y = y0; y < std::min<std::size_t>(rows, y0 + height); ++y)
                toGrey(page, palette, tile.data() + (y - y0) * width * pixel,
                       std::min<std::size_t>(width, columns - x0), to + y * columns + x0);
        }
}

void readPage(TIFF* tiff, Stream& stream, const Page& page, float* to) {
    if (page.orientation.isUpright()) return readAsItLies(tiff, stream, page, to);
    std::vector<float> lies(static_cast<std::size_t>(page.columns) * static_cast<std::size_t>(page.rows));
    readAsItLies(tiff, stream, page, lies.data());
    page.orientation.turn(lies.data(), page.columns, page.rows, to);
}

void readRaw(TIFF* tiff, Input& input, const RawStack& stack, const Page& page, int index, float* to) {
    const std::size_t count = static_cast<std::size_t>(page.columns) * static_cast<std::size_t>(page.rows),
                      bytes = count * bytesOf(page.type);
    std::vector<std::byte> pixels(bytes);
    if (input.readAt(stack.at + static_cast<std::uint64_t>(index) * bytes, pixels.data(), bytes) != bytes)
        throw damagedPicture(input, "its pixel data is truncated");
    std::vector<float> lies(count);
    convert(page.type, TIFFIsBigEndian(tiff) != 0, 1.0, 0.0, pixels.data(), count, lies.data());
    if (page.photometric == PHOTOMETRIC_MINISWHITE && page.bits <= 16)
        for (float& one : lies)
            one = (page.bits == 8 ? 255.0f : 65535.0f) - one;
    page.orientation.turn(lies.data(), page.columns, page.rows, to);
}

}  // namespace

PictureInfo tiffInfo(Input& input) {
    Stream stream;
    stream.input = &input;
    const Tiff tiff = open(stream, "rm");
    if (!tiff) throw damagedPicture(input, stream.text.empty() ? "this is no TIFF" : stream.text);
    PictureInfo info;
    const Page first = pageOf(tiff.get(), input);
    info.columns = first.seenColumns();
    info.rows = first.seenRows();
    info.bits = first.bits;
    info.isColour = first.samples >= 3;
    info.spacingMm = imageJSpacing(tiff.get());
    info.densityMm = densityOf(tiff.get());
    if (first.orientation.isTransposed()) {
        if (info.spacingMm) std::swap(info.spacingMm->x(), info.spacingMm->y());
        if (info.densityMm) std::swap(info.densityMm->x(), info.densityMm->y());
    }
    const StackLayout layout = layoutOf(tiff.get(), first);
    bool hasOneDirectory = true;
    std::uint64_t last = TIFFCurrentDirOffset(tiff.get());
    while (TIFFReadDirectory(tiff.get()) == 1) {
        hasOneDirectory = false;
        last = TIFFCurrentDirOffset(tiff.get());
        const Page page = pageOf(tiff.get(), input);
        if (page.isReduced) continue;
        if (page.seenColumns() != info.columns || page.seenRows() != info.rows)
            throw core::Error(fmt::format("its pages have different sizes: {} x {} and, page {}, {} x {}", info.columns,
                                          info.rows, info.pages + 1, page.seenColumns(), page.seenRows()),
                              input.where(), "save pages of one size");
        if (++info.pages > kMaxPages) throw damagedPicture(input, "it claims too many pages");
    }
    if (!stream.text.empty()) throw damagedPicture(input, stream.text);
    // libtiff ends silently where pages lead back to one that was there.
    if (namesAnother(input, last, TIFFIsBigEndian(tiff.get()) != 0))
        throw damagedPicture(input, fmt::format("behind its page {} comes one that was there before", info.pages));
    if (hasOneDirectory) {
        TIFFSetDirectory(tiff.get(), 0);
        if (const std::optional<RawStack> stack = rawStackOf(tiff.get(), first, input)) info.pages = stack->pages;
    }
    checkLayout(layout, info.pages, input);
    return info;
}

void readTiff(Input& input, const PictureInfo& info, int first, int count, const SlicePlace& place,
              const core::Progress& progress) {
    Stream stream;
    stream.input = &input;
    const Tiff tiff = open(stream, "rm");
    if (!tiff) throw damagedPicture(input, stream.text.empty() ? "this is no TIFF" : stream.text);
    int index = -1, done = 0;
    if (info.pages > 1 && TIFFNumberOfDirectories(tiff.get()) == 1) {
        TIFFSetDirectory(tiff.get(), 0);
        const Page page = pageOf(tiff.get(), input);
        const std::optional<RawStack> stack = rawStackOf(tiff.get(), page, input);
        if (!stack || page.seenColumns() != info.columns || page.seenRows() != info.rows ||
            first + count > stack->pages)
            throw damagedPicture(input, "its size changed");
        for (; done < count; core::report(progress, static_cast<double>(++done) / count))
            readRaw(tiff.get(), input, *stack, page, first + done, place(first + done));
        return;
    }
    do {
        const Page page = pageOf(tiff.get(), input);
        if (page.isReduced && index >= 0) continue;
        if (++index < first) continue;
        if (page.seenColumns() != info.columns || page.seenRows() != info.rows)
            throw damagedPicture(input, "its size changed");
        readPage(tiff.get(), stream, page, place(first + done));
        core::report(progress, static_cast<double>(++done) / count);
        if (done == count) return;
    } while (TIFFReadDirectory(tiff.get()) == 1);
    throw damagedPicture(input, stream.text.empty() ? "it has fewer pages than before" : stream.text);
}

std::vector<std::byte> tiffBytes(std::span<const std::uint16_t> grey, int columns, int rows,
                                 const core::Vec3& spacingMm) {
    std::vector<std::byte> out;
    Stream stream;
    stream.out = &out;
    Tiff tiff = open(stream, "wl");
    const auto failed = [&] {
        return core::Error(fmt::format("cannot be made a TIFF: {}", stream.text), "slice", "choose another format");
    };
    if (!tiff) throw failed();
    TIFFSetField(tiff.get(), TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(columns));
    TIFFSetField(tiff.get(), TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(rows));
    TIFFSetField(tiff.get(), TIFFTAG_BITSPERSAMPLE, 16);
    TIFFSetField(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff.get(), TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
    TIFFSetField(tiff.get(), TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff.get(), TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff.get(), TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    TIFFSetField(tiff.get(), TIFFTAG_ROWSPERSTRIP, static_cast<std::uint32_t>(rows));
    TIFFSetField(tiff.get(), TIFFTAG_RESOLUTIONUNIT, RESUNIT_CENTIMETER);
    TIFFSetField(tiff.get(), TIFFTAG_XRESOLUTION, 10.0 / spacingMm.x());
    TIFFSetField(tiff.get(), TIFFTAG_YRESOLUTION, 10.0 / spacingMm.y());
    if (TIFFWriteEncodedStrip(tiff.get(), 0, const_cast<std::uint16_t*>(grey.data()),
                              static_cast<tmsize_t>(grey.size_bytes())) < 0 ||
        TIFFFlush(tiff.get()) != 1)
        throw failed();
    tiff.reset();
    return out;
}

}  // namespace handpiece::volume
