// SPDX-License-Identifier: Apache-2.0
// Edges smoothed with whole numbers, against FXAA's few lines in floating point; and what must not depend on how.
#include "handpiece/senses/view/smoothing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "support/random.h"

namespace handpiece::view::smoothing_test {
namespace {

using Shade = std::array<double, 3>;

/// Discs over a slanting wedge of colours.
Image discs(std::mt19937_64& random, int width, int height) {
    Image image;
    image.width = width;
    image.height = height;
    image.rgba.resize(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    struct Disc {
        double x, y, r;
        std::array<double, 3> colour;
    };
    std::array<Disc, 12> all{};
    for (Disc& d : all) {
        d = {test::uniform(random, 0, width), test::uniform(random, 0, height), test::uniform(random, 2, 30), {}};
        for (double& c : d.colour)
            c = test::uniform(random, 0, 255);
    }
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            std::array<double, 3> c{100.0 + 0.3 * x, 120.0 + 0.2 * y, 90.0};
            for (const Disc& d : all)
                if (std::hypot(x - d.x, y - d.y) < d.r) c = d.colour;
            std::uint8_t* to = &image.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                                static_cast<std::size_t>(x))];
            for (std::size_t k = 0; k < 3; ++k)
                to[k] = static_cast<std::uint8_t>(c[k]);
            to[3] = 255;
        }
    return image;
}

PixelRect whole(const Image& image) {
    return {0, 0, image.width, image.height};
}

Image smoothed(const Image& from) {
    Image out = from;
    smoothEdges(from, whole(from), out);
    return out;
}

Shade pixel(const Image& image, int x, int y) {
    const std::uint8_t* p = image.at(std::clamp(x, 0, image.width - 1), std::clamp(y, 0, image.height - 1));
    return {1.0 * p[0], 1.0 * p[1], 1.0 * p[2]};
}
Shade mixed(const Shade& a, const Shade& b, double share) {
    return {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])};
}
Shade between(const Image& image, double x, double y) {
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    return mixed(mixed(pixel(image, i, j), pixel(image, i + 1, j), x - i),
                 mixed(pixel(image, i, j + 1), pixel(image, i + 1, j + 1), x - i), y - j);
}
double bright(const Shade& c) {
    return (5.0 * c[0] + 9.0 * c[1] + 2.0 * c[2]) / 16.0;
}

Shade reference(const Image& image, int x, int y) {
    const double nw = bright(pixel(image, x - 1, y - 1)), ne = bright(pixel(image, x + 1, y - 1)),
                 sw = bright(pixel(image, x - 1, y + 1)), se = bright(pixel(image, x + 1, y + 1)),
                 here = bright(pixel(image, x, y));
    const double low = std::min({nw, ne, sw, se, here}), high = std::max({nw, ne, sw, se, here});
    if (high - low < std::max(3.9, 0.0313 * high)) return pixel(image, x, y);
    double dx = sw + se - nw - ne, dy = nw + sw - ne - se;
    const double scale = 1.0 / (std::min(std::abs(dx), std::abs(dy)) + std::max((nw + ne + sw + se) / 32.0, 2.0));
    dx = std::clamp(dx * scale, -6.0, 6.0);
    dy = std::clamp(dy * scale, -6.0, 6.0);
    const auto pair = [&](double share) {
        return mixed(between(image, x - share * dx, y - share * dy), between(image, x + share * dx, y + share * dy),
                     0.5);
    };
    const Shade near = pair(1.0 / 6.0), both = mixed(near, pair(0.5), 0.5);
    return bright(both) < low || bright(both) > high ? near : both;
}

TEST(Smoothing, IsWhatFloatingPointSays) {
    std::mt19937_64 random(test::seed());
    for (int round = 0; round < 10; ++round) {
        const Image from = discs(random, 90 + 7 * round, 70 + round), ours = smoothed(from);
        int others = 0, edges = 0;
        for (int y = 0; y < from.height; ++y)
            for (int x = 0; x < from.width; ++x) {
                const Shade expected = reference(from, x, y), was = pixel(from, x, y), is = pixel(ours, x, y);
                double most = 0.0, change = 0.0;
                for (std::size_t k = 0; k < 3; ++k) {
                    most = std::max(most, std::abs(expected[k] - is[k]));
                    change = std::max(change, std::abs(expected[k] - was[k]));
                }
                edges += change > 6.0 ? 1 : 0;
                // Brightness is rounded: whether it is an edge, and how far to look, may fall
                // otherwise.
                others += most > 12.0 ? 1 : 0;
            }
        EXPECT_GT(edges, 100);
        EXPECT_LT(others, edges / 10) << "round " << round;
    }
}

TEST(Smoothing, LeavesWhatHasNoEdges) {
    Image wedge;
    wedge.width = 200;
    wedge.height = 50;
    for (int i = 0; i < wedge.width * wedge.height; ++i)
        for (const int c : {40 + i % wedge.width / 2, 60 + i / wedge.width, 30, 255})
            wedge.rgba.push_back(static_cast<std::uint8_t>(c));
    EXPECT_EQ(smoothed(wedge).rgba, wedge.rgba);
}

TEST(Smoothing, InPiecesOrWithOtherChannelsItIsTheSame) {
    std::mt19937_64 random(test::seed());
    Image from = discs(random, 131, 97);
    const Image once = smoothed(from);
    Image pieces = from;
    for (const PixelRect& rect : {PixelRect{0, 0, 50, 97}, PixelRect{50, 0, 131, 33}, PixelRect{50, 33, 131, 97}})
        smoothEdges(from, rect, pieces);
    EXPECT_EQ(pieces.rgba, once.rgba);

    Image one = from;
    smoothEdges(from, {20, 30, 25, 40}, one);
    for (int y = 0; y < from.height; ++y)
        for (int x = 0; x < from.width; ++x) {
            const bool inside = x >= 20 && x < 25 && y >= 30 && y < 40;
            ASSERT_EQ(pixel(one, x, y), pixel(inside ? once : from, x, y));
        }

    const auto turned = [](Image image) {
        for (std::size_t i = 0; i < image.rgba.size(); i += 4)
            std::swap(image.rgba[i], image.rgba[i + 2]);
        image.blueFirst = !image.blueFirst;
        return image;
    };
    EXPECT_EQ(turned(smoothed(turned(from))).rgba, once.rgba);
}

}  // namespace
}  // namespace handpiece::view::smoothing_test
