// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstring>

#include "handpiece/scan/volume/pictures.h"

namespace handpiece::volume {
namespace {

/// What libpng reads from and writes to; its errors jump, so no object with a destructor stands between.
struct Stream {
    const std::byte* data = nullptr;
    std::size_t size = 0, at = 0;
    std::vector<std::byte>* out = nullptr;
    std::jmp_buf jump;
    char text[128] = {};
};

[[noreturn]] void onError(png_structp png, png_const_charp text) {
    auto* stream = static_cast<Stream*>(png_get_error_ptr(png));
    std::strncpy(stream->text, text, sizeof stream->text - 1);
    std::longjmp(stream->jump, 1);
}
void onWarning(png_structp /*png*/, png_const_charp /*text*/) {}

void readSome(png_structp png, png_bytep to, std::size_t count) {
    auto* stream = static_cast<Stream*>(png_get_io_ptr(png));
    if (count > stream->size - stream->at) png_error(png, "its pixel data is truncated");
    std::memcpy(to, stream->data + stream->at, count);
    stream->at += count;
}
void writeSome(png_structp png, png_bytep from, std::size_t count) {
    auto* stream = static_cast<Stream*>(png_get_io_ptr(png));
    const auto* bytes = reinterpret_cast<const std::byte*>(from);
    stream->out->insert(stream->out->end(), bytes, bytes + count);
}
void flushNothing(png_structp /*png*/) {}

enum class As { grey, colours };

/// Header alone without `rows`; else all pixels as 16-bit or 8-bit grey in the machine's order, or as red, green, blue.
bool decode(Stream& stream, png_structp& png, png_infop& head, PictureInfo& info, png_bytepp rows, As as = As::grey) {
    if (setjmp(stream.jump) != 0) return false;
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &stream, onError, onWarning);
    head = png ? png_create_info_struct(png) : nullptr;
    if (!head) return false;
    png_set_user_limits(png, 100000, 100000);
    png_set_read_fn(png, &stream, readSome);
    png_read_info(png, head);
    const int type = png_get_color_type(png, head), depth = png_get_bit_depth(png, head);
    const auto columns = static_cast<int>(png_get_image_width(png, head)),
               height = static_cast<int>(png_get_image_height(png, head));
    if (!rows) {
        info.columns = columns;
        info.rows = height;
        info.bits = depth == 16 ? 16 : 8;
        info.isColour = (type & PNG_COLOR_MASK_COLOR) != 0;
        png_uint_32 x = 0, y = 0;
        int unit = PNG_RESOLUTION_UNKNOWN;
        if (png_get_pHYs(png, head, &x, &y, &unit) != 0 && unit == PNG_RESOLUTION_METER && x > 0 && y > 0)
            info.densityMm = core::Vec2(1000.0 / x, 1000.0 / y);
        return true;
    }
    if (columns != info.columns || height != info.rows) png_error(png, "its size changed");
    if (type == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
    if (type == PNG_COLOR_TYPE_GRAY && depth < 8) png_set_expand_gray_1_2_4_to_8(png);
    if ((type & PNG_COLOR_MASK_ALPHA) != 0 || png_get_valid(png, head, PNG_INFO_tRNS) != 0) png_set_strip_alpha(png);
    if (as == As::colours) {
        png_set_scale_16(png);
        png_set_gray_to_rgb(png);
    } else if ((type & PNG_COLOR_MASK_COLOR) != 0) {
        png_set_rgb_to_gray(png, PNG_ERROR_ACTION_NONE, -1.0, -1.0);
    }
    if (as == As::grey && depth == 16 && std::endian::native == std::endian::little) png_set_swap(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, head);
    const std::size_t needed = static_cast<std::size_t>(columns) * (as == As::colours ? 3 : depth == 16 ? 2 : 1);
    if (png_get_rowbytes(png, head) != needed) png_error(png, "its pixels are of a kind that is not read");
    png_read_image(png, rows);
    png_read_end(png, nullptr);
    return true;
}

bool encode(Stream& stream, png_structp& png, png_infop& head, const void* grey, int bits, int columns, int rows) {
    if (setjmp(stream.jump) != 0) return false;
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &stream, onError, onWarning);
    head = png ? png_create_info_struct(png) : nullptr;
    if (!head) return false;
    png_set_write_fn(png, &stream, writeSome, flushNothing);
    png_set_compression_level(png, 3);
    png_set_IHDR(png, head, static_cast<png_uint_32>(columns), static_cast<png_uint_32>(rows), bits,
                 PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, head);
    if (bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
    const std::size_t each = static_cast<std::size_t>(columns) * static_cast<std::size_t>(bits / 8);
    for (int y = 0; y < rows; ++y)
        png_write_row(png, static_cast<png_const_bytep>(grey) + static_cast<std::size_t>(y) * each);
    png_write_end(png, nullptr);
    return true;
}

PictureInfo infoOf(Input& input, const std::vector<std::byte>& data) {
    PictureInfo info;
    Stream stream;
    stream.data = data.data();
    stream.size = data.size();
    png_structp png = nullptr;
    png_infop head = nullptr;
    const bool good = decode(stream, png, head, info, nullptr);
    png_destroy_read_struct(&png, &head, nullptr);
    if (!good) throw damagedPicture(input, stream.text);
    return info;
}

}  // namespace

PictureInfo pngInfo(Input& input) {
    // The header stands before the pixels, but other chunks may stand before those.
    return infoOf(input, wholeOf(input));
}

void readPng(Input& input, const PictureInfo& info, float* to) {
    const std::vector<std::byte> data = wholeOf(input);
    PictureInfo same = infoOf(input, data);
    if (same.columns != info.columns || same.rows != info.rows) throw damagedPicture(input, "its size changed");
    const std::size_t columns = static_cast<std::size_t>(info.columns), height = static_cast<std::size_t>(info.rows);
    const std::size_t each = same.bits == 16 ? 2 : 1;
    std::vector<png_byte> pixels(columns * height * each);
    std::vector<png_bytep> rows(height);
    for (std::size_t y = 0; y < height; ++y)
        rows[y] = pixels.data() + y * columns * each;
    Stream stream;
    stream.data = data.data();
    stream.size = data.size();
    png_structp png = nullptr;
    png_infop head = nullptr;
    const bool good = decode(stream, png, head, same, rows.data());
    png_destroy_read_struct(&png, &head, nullptr);
    if (!good) throw damagedPicture(input, stream.text);
    for (std::size_t i = 0; i < columns * height; ++i) {
        std::uint16_t wide = 0;
        if (each == 2) std::memcpy(&wide, pixels.data() + 2 * i, 2);
        to[i] = static_cast<float>(each == 2 ? wide : pixels[i]);
    }
}

void readPngColours(Input& input, const AllocateColours& allocate) {
    const std::vector<std::byte> data = wholeOf(input);
    PictureInfo info = infoOf(input, data);
    std::uint8_t* const to = allocate(info.columns, info.rows);
    std::vector<png_bytep> rows(static_cast<std::size_t>(info.rows));
    for (std::size_t y = 0; y < rows.size(); ++y)
        rows[y] = to + 3 * y * static_cast<std::size_t>(info.columns);
    Stream stream;
    stream.data = data.data();
    stream.size = data.size();
    png_structp png = nullptr;
    png_infop head = nullptr;
    const bool good = decode(stream, png, head, info, rows.data(), As::colours);
    png_destroy_read_struct(&png, &head, nullptr);
    if (!good) throw damagedPicture(input, stream.text);
}

namespace {

std::vector<std::byte> encoded(const void* grey, int bits, int columns, int rows) {
    std::vector<std::byte> out;
    Stream stream;
    stream.out = &out;
    png_structp png = nullptr;
    png_infop head = nullptr;
    const bool good = encode(stream, png, head, grey, bits, columns, rows);
    png_destroy_write_struct(&png, &head);
    if (!good)
        throw core::Error(fmt::format("cannot be made a PNG: {}", stream.text), "picture", "choose another format");
    return out;
}

}  // namespace

std::vector<std::byte> pngBytes(std::span<const std::uint16_t> grey, int columns, int rows) {
    return encoded(grey.data(), 16, columns, rows);
}

std::vector<std::byte> pngBytes(std::span<const std::uint8_t> grey, int columns, int rows) {
    return encoded(grey.data(), 8, columns, rows);
}

}  // namespace handpiece::volume
