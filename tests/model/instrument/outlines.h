// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Outlines for tests: every shape at random sizes, and awkward ones with waists, ledges and round edges.

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/shapes.h"
#include "support/random.h"

namespace handpiece::instrument::test {

using NamedProfile = std::pair<std::string, Profile>;

inline Profile polygonOutline(std::vector<core::Vec2> corners) {
    Profile profile;
    for (std::size_t i = 1; i < corners.size(); ++i)
        profile.pieces.push_back({corners[i - 1], corners[i], false, core::Vec2::Zero(), 0.0, true});
    return profile;
}

/// Two balls joined by a smooth waist: arcs of both kinds, tangent to each other.
inline Profile dumbbell() {
    const core::Vec2 low(0.0, 0.5), waist(0.9, 1.3), high(0.0, 2.1);
    const double r = 0.5, waistRadius = (waist - low).norm() - r;
    const core::Vec2 a = low + r * (waist - low).normalized(), b = high + r * (waist - high).normalized();
    return {{{{0.0, 0.0}, a, true, low, r, true},
             {a, b, true, waist, waistRadius, false},
             {b, {0.0, 2.6}, true, high, r, true}}};
}

/// A cylinder whose upper and lower edges are rounded: arcs whose centres lie off the axis.
inline Profile roundEdged() {
    return {{{{0, 0}, {0.7, 0}, false, {0, 0}, 0, true},
             {{0.7, 0}, {1.0, 0.3}, true, {0.7, 0.3}, 0.3, true},
             {{1.0, 0.3}, {1.0, 1.2}, false, {0, 0}, 0, true},
             {{1.0, 1.2}, {0.8, 1.4}, true, {0.8, 1.2}, 0.2, true},
             {{0.8, 1.4}, {0, 1.4}, false, {0, 0}, 0, true}}};
}

/// A cylinder end on a concave fillet that meets its neighbours in corners.
inline Profile filleted() {
    return {{{{0, 0}, {0.4, 0}, false, {0, 0}, 0, true},
             {{0.4, 0}, {0.4, 1.0}, true, {1.0, 0.5}, std::hypot(0.6, 0.5), false},
             {{0.4, 1.0}, {0.9, 1.0}, false, {0, 0}, 0, true},
             {{0.9, 1.0}, {0.9, 1.5}, false, {0, 0}, 0, true},
             {{0.9, 1.5}, {0, 1.5}, false, {0, 0}, 0, true}}};
}

inline std::vector<NamedProfile> awkwardOutlines() {
    return {{"dumbbell", dumbbell()},
            {"round-edged", roundEdged()},
            {"filleted", filleted()},
            {"hourglass", polygonOutline({{0, 0}, {0.8, 0}, {0.3, 1.0}, {0.9, 2.2}, {0, 2.2}})},
            {"ledge", polygonOutline({{0, 0}, {0.3, 0}, {0.3, 1.0}, {0.8, 1.0}, {0.8, 2.0}, {0, 2.0}})},
            {"dish", polygonOutline({{0, 0}, {2.0, 0}, {2.0, 1.0}, {1.5, 1.0}, {1.5, 0.4}, {0, 0.4}})},
            {"double cone", polygonOutline({{0, 0}, {0.7, 0.9}, {0, 1.8}})},
            {"faceted ball",
             polygonOutline({{0, 0}, {0.3, 0.05}, {0.5, 0.2}, {0.6, 0.45}, {0.55, 0.8}, {0.3, 1.05}, {0, 1.1}})}};
}

/// Rising steps of random height and width, wide and narrow by turns: waists, ledges and needles.
inline Profile randomPolygon(std::mt19937_64& generator) {
    std::vector<core::Vec2> corners{{0.0, 0.0}};
    const int steps = 2 + static_cast<int>(generator() % 12);
    double z = 0.0;
    bool isLevel = true;  // two level pieces in a row could run back along each other
    for (int i = 0; i < steps; ++i) {
        corners.push_back({handpiece::test::uniform(generator, 0.15, 1.2), z});
        isLevel = !isLevel && generator() % 3 == 0;
        if (!isLevel) z += handpiece::test::uniform(generator, 0.05, 0.6);
    }
    z += 0.3;
    corners.push_back({handpiece::test::uniform(generator, 0.15, 1.2), z});
    corners.push_back({0.0, z});
    return polygonOutline(std::move(corners));
}

/// A shape at a random size that it can have.
inline Profile randomProfile(Shape shape, std::mt19937_64& generator) {
    for (;;) {
        const double d = handpiece::test::uniform(generator, 0.3, 3.0),
                     length = handpiece::test::uniform(generator, 0.2, 9.0);
        try {
            return makeProfile(shape, d, length);
        } catch (const core::Error&) {
            // this diameter is never this long: draw again
        }
    }
}

/// Every shape `each` times at random sizes, the awkward ones and random polygons.
inline std::vector<NamedProfile> manyOutlines(int each, std::mt19937_64& generator) {
    std::vector<NamedProfile> all = awkwardOutlines();
    for (const ShapeInfo& info : shapes())
        for (int i = 0; i < each; ++i)
            all.emplace_back(std::string(info.name), randomProfile(info.shape, generator));
    return all;
}

}  // namespace handpiece::instrument::test
