// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A picture that colours a surface: JPEG and PNG, in colour.

#include <cstdint>
#include <filesystem>
#include <vector>

namespace handpiece::volume {

/// sRGB, three bytes a pixel, rows from the top as they lie in the file.
struct ColourPicture {
    int columns = 0, rows = 0;
    std::vector<std::uint8_t> rgb;
};

/// What is read at most of one.
struct PictureBounds {
    std::uint64_t bytes = 0;
    std::int64_t pixels = 0;
};

/// Grey ones too; 16 bits become 8, what is transparent is not. Throws core::Error for damage, for another kind of file
/// and beyond the bounds.
[[nodiscard]] ColourPicture readColourPicture(const std::filesystem::path& file, const PictureBounds& bounds);

}  // namespace handpiece::volume
