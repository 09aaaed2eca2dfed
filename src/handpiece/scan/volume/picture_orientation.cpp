// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/volume/picture_orientation.h"

#include <algorithm>
#include <array>

namespace handpiece::volume {

void Orientation::turn(const float* from, int columns, int rows, float* to) const {
    const bool fromRight = tag_ == 2 || tag_ == 3 || tag_ == 6 || tag_ == 7,
               fromBottom = tag_ == 3 || tag_ == 4 || tag_ == 7 || tag_ == 8;
    const auto width = static_cast<std::size_t>(columns), height = static_cast<std::size_t>(rows);
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x) {
            // In 5 to 8 what lies in a row is seen in a column: the file's rows go from the left or the right.
            const std::size_t seenX =
                isTransposed() ? (fromRight ? height - 1 - y : y) : (fromRight ? width - 1 - x : x);
            const std::size_t seenY =
                isTransposed() ? (fromBottom ? width - 1 - x : x) : (fromBottom ? height - 1 - y : y);
            to[seenY * (isTransposed() ? height : width) + seenX] = from[y * width + x];
        }
}

int exifOrientation(std::span<const std::uint8_t> segment) {
    constexpr std::array<std::uint8_t, 6> kExif{'E', 'x', 'i', 'f', 0, 0};
    if (segment.size() < kExif.size() + 8 || !std::equal(kExif.begin(), kExif.end(), segment.begin())) return 1;
    const std::span<const std::uint8_t> tiff = segment.subspan(kExif.size());
    const bool isBig = tiff[0] == 'M';
    const auto number = [&](std::size_t at, std::size_t bytes) -> std::size_t {
        std::size_t value = 0;
        for (std::size_t i = 0; i < bytes; ++i)
            value |= static_cast<std::size_t>(at + i < tiff.size() ? tiff[at + i] : 0u)
                     << 8 * (isBig ? bytes - 1 - i : i);
        return value;
    };
    const std::size_t directory = number(4, 4), count = directory < tiff.size() ? number(directory, 2) : 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t entry = directory + 2 + 12 * i;
        if (entry + 12 > tiff.size()) break;
        if (number(entry, 2) == 0x0112) return static_cast<int>(number(entry + 8, 2));
    }
    return 1;
}

}  // namespace handpiece::volume
