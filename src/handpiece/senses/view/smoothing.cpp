// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/smoothing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "handpiece/base/core/parallel.h"

namespace handpiece::view {
namespace {

constexpr std::size_t kRowsAtOnce = 16;
/// Of brightness, in 16ths.
constexpr std::uint32_t kRed = 5, kGreen = 9, kBlue = 2;
/// Brightness may differ by less than this, or by less than a 32nd, without being an edge: the rim of a cut in enamel
/// differs by little from what lies beside it.
constexpr int kLeastContrast = 4;
constexpr float kMostPixels = 6.0f;
constexpr std::uint64_t kLanes = 0x00ff00ff00ff00ffull;

/// The four channels, 16 bits each, so that all are blended at once.
std::uint64_t spread(std::uint32_t pixel) {
    std::uint64_t x = pixel;
    x = (x | x << 16) & 0x0000ffff0000ffffull;
    return (x | x << 8) & kLanes;
}
std::uint32_t joined(std::uint64_t x) {
    x = (x | x >> 8) & 0x0000ffff0000ffffull;
    return static_cast<std::uint32_t>(x | x >> 16);
}
std::uint64_t blend(std::uint64_t a, std::uint64_t b, std::uint32_t share) {
    return (a * (256 - share) + b * share) >> 8 & kLanes;
}

struct Smoother {
    const Image& from;
    std::uint32_t first, third;  ///< weights of the channels beside green

    [[nodiscard]] const std::uint32_t* row(int y) const {
        return reinterpret_cast<const std::uint32_t*>(from.at(0, std::clamp(y, 0, from.height - 1)));
    }
    [[nodiscard]] std::uint32_t brightness(std::uint32_t pixel) const {
        return ((pixel & 255) * first + (pixel >> 8 & 255) * kGreen + (pixel >> 16 & 255) * third) >> 4;
    }
    /// Of x0 - 1 to x1, as far as there are pixels.
    void brightness(int y, int x0, int x1, std::uint8_t* to) const {
        const std::uint32_t* pixels = row(y);
        const int begin = std::max(x0 - 1, 0), end = std::min(x1 + 1, from.width);
        for (int x = begin; x < end; ++x)
            to[x - x0 + 1] = static_cast<std::uint8_t>(brightness(pixels[x]));
        if (begin == x0) to[0] = to[1];
        if (end == x1) to[x1 - x0 + 1] = to[x1 - x0];
    }
    /// Between the four pixels around a place; pixels are at whole numbers.
    [[nodiscard]] std::uint64_t at(float x, float y) const {
        x = std::clamp(x, 0.0f, static_cast<float>(from.width - 1));
        y = std::clamp(y, 0.0f, static_cast<float>(from.height - 1));
        const int left = static_cast<int>(x), top = static_cast<int>(y), right = std::min(left + 1, from.width - 1);
        const auto u = static_cast<std::uint32_t>(256.0f * (x - static_cast<float>(left)));
        const auto v = static_cast<std::uint32_t>(256.0f * (y - static_cast<float>(top)));
        const std::uint32_t *upper = row(top), *lower = row(top + 1);
        return blend(blend(spread(upper[left]), spread(upper[right]), u),
                     blend(spread(lower[left]), spread(lower[right]), u), v);
    }
    /// The pixel x, y along its edge. `above`, `here`, `below`: brightness from the pixel left of it on.
    [[nodiscard]] std::uint32_t along(int x, int y, const std::uint8_t* above, const std::uint8_t* here,
                                      const std::uint8_t* below) const {
        const int nw = above[0], ne = above[2], sw = below[0], se = below[2];
        const auto across = static_cast<float>(sw + se - nw - ne), down = static_cast<float>(nw + sw - ne - se);
        const float least = std::max(static_cast<float>(nw + ne + sw + se) / 32.0f, 2.0f);
        const float scale = 1.0f / (std::min(std::abs(across), std::abs(down)) + least);
        const float dx = std::clamp(across * scale, -kMostPixels, kMostPixels);
        const float dy = std::clamp(down * scale, -kMostPixels, kMostPixels);
        const auto px = static_cast<float>(x), py = static_cast<float>(y);
        const std::uint64_t near = at(px - dx / 6.0f, py - dy / 6.0f) + at(px + dx / 6.0f, py + dy / 6.0f);
        const std::uint64_t far = at(px - 0.5f * dx, py - 0.5f * dy) + at(px + 0.5f * dx, py + 0.5f * dy);
        const std::uint32_t both = joined((near + far) >> 2 & kLanes);
        const int bright = static_cast<int>(brightness(both));
        return bright < std::min({static_cast<int>(here[1]), nw, ne, sw, se}) ||
                       bright > std::max({static_cast<int>(here[1]), nw, ne, sw, se})
                   ? joined(near >> 1 & kLanes)
                   : both;
    }
};

/// Where there are edges, for rows of brightness as above.
void findEdges(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below, int count,
               std::uint8_t* isEdge) {
    for (int i = 0; i < count; ++i) {
        const std::uint8_t low =
            std::min(std::min(std::min(above[i], above[i + 2]), std::min(below[i], below[i + 2])), here[i + 1]);
        const std::uint8_t high =
            std::max(std::max(std::max(above[i], above[i + 2]), std::max(below[i], below[i + 2])), here[i + 1]);
        const auto contrast = static_cast<std::uint8_t>(high - low);
        const auto least = static_cast<std::uint8_t>(high >> 5);
        isEdge[i] = contrast >= std::max<std::uint8_t>(least, kLeastContrast) ? 1 : 0;
    }
}

}  // namespace

void smoothEdges(const Image& from, const PixelRect& rect, Image& out) {
    if (rect.isEmpty()) return;
    const Smoother smoother{from, from.blueFirst ? kBlue : kRed, from.blueFirst ? kRed : kBlue};
    const int width = rect.x1 - rect.x0;
    const auto padded = static_cast<std::size_t>(width) + 2;
    core::parallelFor(
        static_cast<std::size_t>(rect.y1 - rect.y0), kRowsAtOnce, [&](std::size_t first, std::size_t last) {
            std::vector<std::uint8_t> brightness(3 * padded), isEdge((padded + 7) / 8 * 8);
            const auto line = [&](int y) { return brightness.data() + padded * static_cast<std::size_t>((y + 3) % 3); };
            const int begin = rect.y0 + static_cast<int>(first), end = rect.y0 + static_cast<int>(last);
            for (int y = begin - 1; y <= begin; ++y)
                smoother.brightness(y, rect.x0, rect.x1, line(y));
            for (int y = begin; y < end; ++y) {
                smoother.brightness(y + 1, rect.x0, rect.x1, line(y + 1));
                const std::uint8_t *above = line(y - 1), *here = line(y), *below = line(y + 1);
                findEdges(above, here, below, width, isEdge.data());
                auto* to = reinterpret_cast<std::uint32_t*>(&out.rgba[4 * (static_cast<std::size_t>(y) * out.width)]);
                std::copy_n(smoother.row(y) + rect.x0, width, to + rect.x0);
                for (int i = 0; i < width; i += 8) {
                    std::uint64_t eight = 0;
                    std::memcpy(&eight, &isEdge[static_cast<std::size_t>(i)], sizeof eight);
                    if (eight == 0) continue;
                    for (int k = i; k < std::min(i + 8, width); ++k)
                        if (isEdge[static_cast<std::size_t>(k)] != 0)
                            to[rect.x0 + k] = smoother.along(rect.x0 + k, y, above + k, here + k, below + k);
                }
            }
        });
}

}  // namespace handpiece::view
