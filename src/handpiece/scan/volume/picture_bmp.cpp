// SPDX-License-Identifier: Apache-2.0
// BMP of 8, 24 and 32 bit, not packed: what scanners and reconstruction programs write.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "handpiece/scan/volume/pictures.h"

namespace handpiece::volume {
namespace {

constexpr std::size_t kFileHeader = 14, kInfoHeader = 40;

struct Layout {
    PictureInfo info;
    bool isFromTop = false;
    std::uint32_t pixelsAt = 0;
    std::size_t rowBytes = 0, pixelBytes = 1;
    std::array<float, 256> palette{};
};

std::uint32_t u32(const std::uint8_t* p) {
    return p[0] | static_cast<std::uint32_t>(p[1]) << 8 | static_cast<std::uint32_t>(p[2]) << 16 |
           static_cast<std::uint32_t>(p[3]) << 24;
}

Layout layoutOf(Input& input) {
    std::array<std::uint8_t, kFileHeader + kInfoHeader> head{};
    if (input.readAt(0, head.data(), head.size()) != head.size() || head[0] != 'B' || head[1] != 'M')
        throw damagedPicture(input, "it ends in its header");
    Layout layout;
    layout.pixelsAt = u32(&head[10]);
    const std::uint32_t headerBytes = u32(&head[14]);
    if (headerBytes < kInfoHeader)
        throw core::Error("this BMP is of a kind that is not read", input.where(), "save it as an 8-bit BMP again");
    const auto width = static_cast<std::int32_t>(u32(&head[18])), height = static_cast<std::int32_t>(u32(&head[22]));
    const int bits = head[28] | head[29] << 8;
    const std::uint32_t packing = u32(&head[30]);
    if ((bits != 8 && bits != 24 && bits != 32) || !(packing == 0 || (packing == 3 && bits == 32)))
        throw core::Error(fmt::format("this BMP has {} bits a pixel{}", bits, packing == 0 ? "" : " and is packed"),
                          input.where(), "save it as an 8-bit or 24-bit BMP that is not packed");
    if (width < 1 || height == 0 || width > 100000 || std::abs(static_cast<std::int64_t>(height)) > 100000)
        throw damagedPicture(input, fmt::format("its size is {} x {}", width, height));
    layout.isFromTop = height < 0;
    layout.info.columns = width;
    layout.info.rows = std::abs(height);
    layout.info.isColour = bits != 8;
    layout.pixelBytes = static_cast<std::size_t>(bits) / 8;
    layout.rowBytes = (static_cast<std::size_t>(width) * static_cast<std::size_t>(bits) / 8 + 3) / 4 * 4;
    if (bits == 8) {
        std::uint32_t colours = u32(&head[46]);
        if (colours == 0 || colours > 256) colours = 256;
        std::array<std::uint8_t, 1024> table{};
        const std::size_t got = input.readAt(kFileHeader + headerBytes, table.data(), 4ul * colours);
        for (std::size_t i = 0; i < got / 4; ++i) {
            const std::uint8_t* c = &table[4 * i];
            layout.palette[i] = greyOf(c[2], c[1], c[0]);
            layout.info.isColour = layout.info.isColour || c[0] != c[1] || c[1] != c[2];
        }
    }
    return layout;
}

}  // namespace

PictureInfo bmpInfo(Input& input) {
    return layoutOf(input).info;
}

void readBmp(Input& input, const PictureInfo& info, float* to) {
    const Layout layout = layoutOf(input);
    if (layout.info.columns != info.columns || layout.info.rows != info.rows)
        throw damagedPicture(input, "its size changed");
    const auto columns = static_cast<std::size_t>(info.columns), rows = static_cast<std::size_t>(info.rows);
    const std::size_t bytes = layout.pixelBytes;
    std::vector<std::uint8_t> row(layout.rowBytes);
    for (std::size_t y = 0; y < rows; ++y) {
        if (input.readAt(layout.pixelsAt + y * layout.rowBytes, row.data(), row.size()) < columns * bytes)
            throw damagedPicture(input, fmt::format("its pixel data is truncated after {} of {} rows", y, rows));
        float* const line = to + (layout.isFromTop ? y : rows - 1 - y) * columns;
        for (std::size_t x = 0; x < columns; ++x)
            line[x] =
                bytes == 1 ? layout.palette[row[x]] : greyOf(row[x * bytes + 2], row[x * bytes + 1], row[x * bytes]);
    }
}

std::vector<std::byte> bmpBytes(std::span<const std::uint8_t> grey, int columns, int rows) {
    const auto w = static_cast<std::size_t>(columns), h = static_cast<std::size_t>(rows);
    const std::size_t rowBytes = (w + 3) / 4 * 4, begin = kFileHeader + kInfoHeader + 1024;
    std::vector<std::byte> out(begin + rowBytes * h);
    const auto put = [&](std::size_t at, std::uint32_t value, int bytes) {
        for (int i = 0; i < bytes; ++i)
            out[at + static_cast<std::size_t>(i)] = static_cast<std::byte>(value >> 8 * i & 0xff);
    };
    put(0, 'B' | 'M' << 8, 2);
    put(2, static_cast<std::uint32_t>(out.size()), 4);
    put(10, static_cast<std::uint32_t>(begin), 4);
    put(14, kInfoHeader, 4);
    put(18, static_cast<std::uint32_t>(columns), 4);
    put(22, static_cast<std::uint32_t>(rows), 4);
    put(26, 1, 2);
    put(28, 8, 2);
    put(34, static_cast<std::uint32_t>(rowBytes * h), 4);
    put(46, 256, 4);
    for (std::uint32_t i = 0; i < 256; ++i)
        put(kFileHeader + kInfoHeader + 4 * i, i * 0x010101u, 4);
    for (std::size_t y = 0; y < h; ++y)
        std::memcpy(out.data() + begin + (h - 1 - y) * rowBytes, grey.data() + y * w, w);
    return out;
}

}  // namespace handpiece::volume
