// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Point sets with known or interesting hulls, for the tests of hulls, GJK and EPA.

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "support/random.h"

namespace handpiece::test {

inline std::vector<core::Vec3> boxCorners(const core::Vec3& half) {
    std::vector<core::Vec3> points;
    for (int i = 0; i < 8; ++i)
        points.emplace_back(i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(), i & 4 ? half.z() : -half.z());
    return points;
}

/// Random points on an ellipsoid with random axes of 0.3 to 3 mm.
inline std::vector<core::Vec3> randomEllipsoid(std::mt19937_64& generator, int count) {
    const core::Vec3 axes(uniform(generator, 0.3, 3), uniform(generator, 0.3, 3), uniform(generator, 0.3, 3));
    const core::Quat turn = randomRotation(generator);
    std::vector<core::Vec3> points;
    for (int i = 0; i < count; ++i)
        points.push_back(turn * axes.cwiseProduct(randomDirection(generator)));
    return points;
}

/// Evenly spread points (golden spiral) on a sphere about the origin, pushed in and out by waves of `bumpMm`.
inline std::vector<core::Vec3> bumpySphere(int count, double radiusMm, double bumpMm) {
    std::vector<core::Vec3> points;
    const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
    for (int i = 0; i < count; ++i) {
        const double z = 1.0 - (2.0 * i + 1.0) / count, rho = std::sqrt(1.0 - z * z), angle = golden * i;
        const core::Vec3 direction(rho * std::cos(angle), rho * std::sin(angle), z);
        points.push_back((radiusMm + bumpMm * std::sin(5.0 * angle) * std::cos(9.0 * z)) * direction);
    }
    return points;
}

/// A bur as the hull sees it: a hemispherical tip and a cylinder, tip at the origin, rings of 24 points.
inline std::vector<core::Vec3> roundEndedCylinder(double radiusMm, double lengthMm) {
    std::vector<core::Vec3> points{core::Vec3::Zero()};
    for (int ring = 1; ring <= 7; ++ring) {
        const double polar = 0.5 * std::numbers::pi * std::min(ring, 6) / 6;
        const double rho = radiusMm * std::sin(polar), z = ring == 7 ? lengthMm : radiusMm * (1.0 - std::cos(polar));
        for (int j = 0; j < 24; ++j) {
            const double angle = 2.0 * std::numbers::pi * j / 24;
            points.emplace_back(rho * std::cos(angle), rho * std::sin(angle), z);
        }
    }
    return points;
}

}  // namespace handpiece::test
