// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Scans of balls in balls, of which everything is known in closed form.

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "handpiece/scan/segmentation/segment.h"

namespace handpiece::test {

inline double ballMm3(double radius) {
    return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

struct Greys {
    float outside = -1000, pulp = 60, dentine = 1500, enamel = 2700;
};

struct ScanSettings {
    double spacingMm = 0.2;
    double blurVoxels = 0.8;
    double noise = 0;  ///< of the step from outside to enamel
    core::Vec3 halfMm = core::Vec3::Constant(5.2);
};

/// Grey values of a place [mm], averaged over 3^3 places a voxel, blurred by a Gaussian, with noise.
inline volume::Volume scanOf(const std::function<float(const core::Vec3&)>& grey, const ScanSettings& s,
                             std::uint64_t seedOfNoise) {
    volume::Volume v;
    for (std::size_t axis = 0; axis < 3; ++axis)
        v.grid.size[axis] = 2 * static_cast<int>(std::ceil(s.halfMm[static_cast<int>(axis)] / s.spacingMm)) + 1;
    v.grid.spacingMm = core::Vec3::Constant(s.spacingMm);
    // A little off the balls' centres, so that no voxel lies where it is easy.
    for (int axis = 0; axis < 3; ++axis)
        v.grid.originMm[axis] =
            -0.5 * (v.grid.size[static_cast<std::size_t>(axis)] - 1) * s.spacingMm + 0.031 * (axis + 1);
    v.values.resize(v.grid.count());
    for (int k = 0; k < v.grid.size[2]; ++k)
        for (int j = 0; j < v.grid.size[1]; ++j)
            for (int i = 0; i < v.grid.size[0]; ++i) {
                float sum = 0;
                for (int n = 0; n < 27; ++n)
                    sum += grey(v.grid.toMm(
                        core::Vec3(i + (n % 3 - 1) / 3.0, j + (n / 3 % 3 - 1) / 3.0, k + (n / 9 - 1) / 3.0)));
                v.values[v.grid.index(i, j, k)] = sum / 27;
            }
    // Plain convolution along the three axes: nothing of the product's own.
    const int reach = static_cast<int>(std::ceil(4 * s.blurVoxels));
    for (std::size_t axis = 0; axis < 3 && s.blurVoxels > 0; ++axis) {
        std::vector<float> out(v.values.size());
        for (int k = 0; k < v.grid.size[2]; ++k)
            for (int j = 0; j < v.grid.size[1]; ++j)
                for (int i = 0; i < v.grid.size[0]; ++i) {
                    double sum = 0, weight = 0;
                    for (int d = -reach; d <= reach; ++d) {
                        std::array<int, 3> at{i, j, k};
                        at[axis] = std::clamp(at[axis] + d, 0, v.grid.size[axis] - 1);
                        const double w = std::exp(-0.5 * d * d / (s.blurVoxels * s.blurVoxels));
                        sum += w * static_cast<double>(v.values[v.grid.index(at[0], at[1], at[2])]);
                        weight += w;
                    }
                    out[v.grid.index(i, j, k)] = static_cast<float>(sum / weight);
                }
        v.values = out;
    }
    if (s.noise > 0) {
        const Greys g;
        std::mt19937_64 generator(seedOfNoise);
        std::normal_distribution<double> noise(0, s.noise * static_cast<double>(g.enamel - g.outside));
        for (float& value : v.values)
            value += static_cast<float>(noise(generator));
    }
    return v;
}

/// A "tooth": pulp, dentine and enamel as balls in balls about the origin.
inline constexpr double kPulpMm = 1.2, kDentineMm = 3.0, kEnamelMm = 4.0;
inline float ballsGrey(const core::Vec3& p) {
    const Greys g;
    const double r = p.norm();
    return r < kPulpMm ? g.pulp : (r < kDentineMm ? g.dentine : (r < kEnamelMm ? g.enamel : g.outside));
}
/// Enamel only on top: a cap that ends in a thin edge on the ball's equator.
inline float cappedGrey(const core::Vec3& p) {
    const Greys g;
    const double r = p.norm(), cap = (p + core::Vec3(0, 0, 1.0)).norm();
    return r < kPulpMm ? g.pulp : (r < kEnamelMm ? (cap < kEnamelMm ? g.dentine : g.enamel) : g.outside);
}

/// Distances [voxels] of a solid's zero, where it crosses the grid's lines, from a ball's surface.
inline std::vector<double> errorsFromBall(const volume::Grid& grid, const std::vector<float>& distances, double radius,
                                          const std::function<bool(const core::Vec3&)>& counts = {}) {
    std::vector<double> errors;
    const std::array<std::size_t, 3> stride{1, grid.index(0, 1, 0), grid.index(0, 0, 1)};
    for (int k = 0; k + 1 < grid.size[2]; ++k)
        for (int j = 0; j + 1 < grid.size[1]; ++j)
            for (int i = 0; i + 1 < grid.size[0]; ++i)
                for (int axis = 0; axis < 3; ++axis) {
                    const std::size_t at = grid.index(i, j, k);
                    const double a = distances[at], b = distances[at + stride[static_cast<std::size_t>(axis)]];
                    if ((a < 0) == (b < 0)) continue;
                    core::Vec3 p(i, j, k);
                    p[axis] += a / (a - b);
                    const core::Vec3 mm = grid.toMm(p);
                    if (!counts || counts(mm)) errors.push_back(std::abs(mm.norm() - radius) / grid.spacingMm.x());
                }
    std::sort(errors.begin(), errors.end());
    return errors;
}
inline double share(const std::vector<double>& sorted, double part) {
    return sorted.empty() ? 1e9 : sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
}

inline const segmentation::Solid* solidOf(const segmentation::Region& region, cases::Tissue tissue,
                                          bool authored = false) {
    for (const segmentation::Solid& solid : region.solids)
        if (solid.tissue == tissue && solid.isAuthored == authored) return &solid;
    return nullptr;
}
inline double volumeOf(const segmentation::Region& region, cases::Tissue tissue) {
    return segmentation::volumesMm3(region)[static_cast<std::size_t>(tissue)];
}

}  // namespace handpiece::test
