// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/volume/colour_picture.h"

#include <fmt/format.h>

#include <array>
#include <cstring>

#include "handpiece/scan/volume/pictures.h"

namespace handpiece::volume {

ColourPicture readColourPicture(const std::filesystem::path& file, const PictureBounds& bounds) {
    Input input(file);
    const auto refuse = [&](const std::string& what) {
        throw core::Error(what, input.where(), "save it smaller, as JPEG or PNG").as("too-large");
    };
    if (input.size() > bounds.bytes)
        refuse(fmt::format("the picture has {} bytes, more than the {} that are read", input.size(), bounds.bytes));
    std::array<unsigned char, 8> start{};
    const std::size_t known = input.readAt(0, start.data(), start.size());
    constexpr std::array<unsigned char, 8> kPng{0x89, 'P', 'N', 'G', 0x0d, 0x0a, 0x1a, 0x0a};
    const bool isPng = known == kPng.size() && start == kPng;
    const bool isJpeg = known >= 3 && start[0] == 0xff && start[1] == 0xd8 && start[2] == 0xff;
    if (!isPng && !isJpeg)
        throw core::Error("this picture is neither JPEG nor PNG", input.where(), "save it as one of them");
    ColourPicture picture;
    const auto allocate = [&](int columns, int rows) {
        if (columns < 1 || rows < 1 || std::int64_t{columns} * rows > bounds.pixels)
            refuse(fmt::format("a picture of {} x {} pixels", columns, rows));
        picture.columns = columns;
        picture.rows = rows;
        picture.rgb.resize(3 * static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
        return picture.rgb.data();
    };
    if (isPng)
        readPngColours(input, allocate);
    else
        readJpegColours(input, allocate);
    return picture;
}

}  // namespace handpiece::volume
