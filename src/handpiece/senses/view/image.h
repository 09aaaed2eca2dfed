// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A picture in memory, and as a PNG file.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "handpiece/senses/view/camera.h"

namespace handpiece::view {

/// Pixels row by row from the top, 8 bits each of red, green, blue, alpha (in this order in memory); sRGB.
struct Image {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba;
    /// Blue, green, red, alpha instead, as windows have their pictures: for Renderer::draw() alone, which keeps to it.
    bool blueFirst = false;
    /// Which of whose pictures it holds, told by Renderer::draw(): given the same image again, it reads what changed
    /// since. To be cleared by whoever else writes into the image.
    struct Picture {
        std::uint64_t source = 0, number = 0;
    };
    Picture picture{};

    [[nodiscard]] const std::uint8_t* at(int x, int y) const {
        return &rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x))];
    }
};

/// The bytes of a PNG file. Throws core::Error.
[[nodiscard]] std::vector<std::byte> pngOf(const Image& image);
/// Written beside its place and renamed into it. Throws core::Error.
void writePng(const Image& image, const std::filesystem::path& path);
/// Throws core::Error: missing, no PNG, damaged, larger than 16384 a side.
[[nodiscard]] Image readPng(const std::filesystem::path& path);

/// The picture at another, larger size, between its pixels as a blend of the nearest four. `out` keeps its memory.
void enlarge(const Image& image, const Viewport& size, Image& out);

/// How far two pictures of one size are apart: root mean square and largest difference of a channel (0..255), and the
/// share of pixels that differ by more than `tolerance` in any channel. Throws core::Error when the sizes differ.
struct ImageDifference {
    double rms = 0.0, largest = 0.0, differingShare = 0.0;
};
[[nodiscard]] ImageDifference compareImages(const Image& a, const Image& b, int tolerance = 8);

}  // namespace handpiece::view
