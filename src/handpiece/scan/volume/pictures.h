// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Slices as pictures: BMP, JPEG, PNG and TIFF, to grey numbers and back.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "handpiece/scan/volume/candidate.h"

namespace handpiece::volume {

enum class PictureKind { bmp, jpeg, png, tiff };

struct PictureInfo {
    int columns = 0, rows = 0, bits = 8;  ///< as it is seen: picture_orientation.h
    int pages = 1;                        ///< TIFF alone may have more
    bool isColour = false;                ///< turned to grey
    /// Where the file says it in a way that can be trusted (ImageJ's stacks): x, y, z; z 0 where it does not tell.
    std::optional<core::Vec3> spacingMm;
    /// A pixel's size by its density, which may be a printer's that has nothing to do with the scan.
    std::optional<core::Vec2> densityMm;
};

[[nodiscard]] PictureInfo bmpInfo(Input& input);
[[nodiscard]] PictureInfo jpegInfo(Input& input);
[[nodiscard]] PictureInfo pngInfo(Input& input);
[[nodiscard]] PictureInfo tiffInfo(Input& input);
/// Rows from the top, as it is seen. Throws core::Error for damage and for another size than `info` tells.
void readBmp(Input& input, const PictureInfo& info, float* to);
void readJpeg(Input& input, const PictureInfo& info, float* to);
void readPng(Input& input, const PictureInfo& info, float* to);
/// Pages first .. first + count - 1, one after another.
void readTiff(Input& input, const PictureInfo& info, int first, int count, const SlicePlace& place,
              const core::Progress& progress);

/// All of a picture in colour, three bytes a pixel, as it lies in the file: into what `allocate` gives for its size,
/// which may throw. Throws core::Error for damage.
using AllocateColours = std::function<std::uint8_t*(int columns, int rows)>;
void readJpegColours(Input& input, const AllocateColours& allocate);
void readPngColours(Input& input, const AllocateColours& allocate);

/// Grey values as a file: 8 bit, or 16 where the format has them (PNG, TIFF).
[[nodiscard]] std::vector<std::byte> bmpBytes(std::span<const std::uint8_t> grey, int columns, int rows);
[[nodiscard]] std::vector<std::byte> jpegBytes(std::span<const std::uint8_t> grey, int columns, int rows);
[[nodiscard]] std::vector<std::byte> pngBytes(std::span<const std::uint16_t> grey, int columns, int rows);
[[nodiscard]] std::vector<std::byte> pngBytes(std::span<const std::uint8_t> grey, int columns, int rows);
[[nodiscard]] std::vector<std::byte> tiffBytes(std::span<const std::uint16_t> grey, int columns, int rows,
                                               const core::Vec3& spacingMm);

/// What a picture is told to be when it cannot be read.
[[nodiscard]] core::Error damagedPicture(const Input& input, const std::string& why);
/// The whole file, up to what one slice may have.
[[nodiscard]] std::vector<std::byte> wholeOf(Input& input);
/// Grey of inks, 255 the most of each.
[[nodiscard]] inline float greyOfInks(unsigned cyan, unsigned magenta, unsigned yellow, unsigned black) {
    const auto left = [&](unsigned ink) { return (255 - ink) * (255 - black); };
    return static_cast<float>((299 * left(cyan) + 587 * left(magenta) + 114 * left(yellow) + 127500) / 255000);
}
/// Grey of a colour; exact where all three are the same.
[[nodiscard]] inline float greyOf(unsigned red, unsigned green, unsigned blue) {
    return static_cast<float>((299 * red + 587 * green + 114 * blue + 500) / 1000);
}

}  // namespace handpiece::volume
