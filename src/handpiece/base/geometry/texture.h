// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Pictures that colour a mesh. They are decoded elsewhere: a program says once by what, and without that they are left
/// out, which the reader of the mesh tells.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

namespace handpiece::geometry {

/// sRGB, three bytes a pixel, rows from the top.
struct Picture {
    int columns = 0, rows = 0;
    std::vector<std::uint8_t> rgb;
};

/// What is read of one: its file, and its pixels.
inline constexpr std::uint64_t kMaxPictureBytes = 256ull << 20;
inline constexpr std::int64_t kMaxPicturePixels = std::int64_t{1} << 26;

/// The picture in a file of at most these bounds. Throws core::Error.
using PictureReader = std::function<Picture(const std::filesystem::path& file)>;

/// For this process, in place of the one before.
void readPicturesWith(PictureReader reader);
/// By what was said; nothing where nothing was. Throws core::Error.
[[nodiscard]] std::optional<Picture> readPicture(const std::filesystem::path& file);

}  // namespace handpiece::geometry
