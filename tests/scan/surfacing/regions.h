// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Regions made out of closed forms, so that the surfaces of them have a truth.

#include <algorithm>
#include <cmath>
#include <functional>

#include "handpiece/scan/segmentation/segment.h"
#include "handpiece/scan/surfacing/surfaces.h"
#include "scan/segmentation/balls.h"

namespace handpiece::test {

using Shape = std::function<double(const core::Vec3&)>;  ///< signed distance [mm] in the grid's axes, negative inside

inline Shape ball(const core::Vec3& centre, double radiusMm) {
    return [=](const core::Vec3& p) { return (p - centre).norm() - radiusMm; };
}
/// A ball cut by a half-space: what lies below z.
inline Shape below(const Shape& shape, double z) {
    return [=](const core::Vec3& p) { return std::max(shape(p), p.z() - z); };
}

inline segmentation::Solid solidOf(const volume::Grid& grid, cases::Tissue tissue, const Shape& shape,
                                   bool isBinary = false) {
    segmentation::Solid solid;
    solid.tissue = tissue;
    solid.distanceMm.resize(grid.count());
    const double h = grid.spacingMm.x();
    for (int k = 0; k < grid.size[2]; ++k)
        for (int j = 0; j < grid.size[1]; ++j)
            for (int i = 0; i < grid.size[0]; ++i) {
                const double d = shape(h * core::Vec3(i, j, k));
                solid.distanceMm[grid.index(i, j, k)] =
                    static_cast<float>(isBinary ? (d < 0.0 ? -0.5 * h : 0.5 * h) : std::clamp(d, -3.0 * h, 3.0 * h));
            }
    return solid;
}

inline volume::Grid cubeGrid(double sideMm, double voxelMm) {
    volume::Grid grid;
    const int n = static_cast<int>(std::ceil(sideMm / voxelMm)) + 1;
    grid.size = {n, n, n};
    grid.spacingMm = core::Vec3::Constant(voxelMm);
    return grid;
}

/// A tooth of balls: the enamel covers the upper part (z above the neck) by `enamelMm`, below it the dentine is the
/// outside; a pulp in the middle; caries from the top into the dentine.
struct BallTooth {
    core::Vec3 middle{4.02, 4.01, 4.03};
    double radiusMm = 3.4, enamelMm = 0.9, neckMm = 3.4, pulpMm = 0.8, cariesMm = 0.9;

    [[nodiscard]] Shape outer() const { return ball(middle, radiusMm); }
    [[nodiscard]] Shape dentine() const {
        // The cap's thickness falls to nothing at the neck: a smaller ball set down so that they touch there.
        const Shape all = outer(), core = ball(middle - core::Vec3(0, 0, enamelMm), radiusMm);
        return [=](const core::Vec3& p) { return std::max(all(p), core(p)); };
    }
    [[nodiscard]] Shape pulp() const { return ball(middle, pulpMm); }
    [[nodiscard]] Shape caries() const {
        const Shape all = outer(), lesion = ball(middle + core::Vec3(0.3, 0, radiusMm - 0.3), cariesMm);
        return [=](const core::Vec3& p) { return std::max(all(p), lesion(p)); };
    }

    [[nodiscard]] segmentation::Region region(double voxelMm, bool isBinary = false) const {
        segmentation::Region region;
        region.grid = cubeGrid(8.0, voxelMm);
        region.outer = solidOf(region.grid, cases::Tissue::none, outer(), isBinary);
        region.solids.push_back(solidOf(region.grid, cases::Tissue::dentine, dentine(), isBinary));
        region.solids.push_back(solidOf(region.grid, cases::Tissue::pulp, pulp(), isBinary));
        region.solids.push_back(solidOf(region.grid, cases::Tissue::caries, caries(), isBinary));
        return region;
    }
};

/// Volume of what two balls of equal radius share, their centres `apartMm` from each other.
inline double lensMm3(double radiusMm, double apartMm) {
    return M_PI / 12.0 * (4.0 * radiusMm + apartMm) * (2.0 * radiusMm - apartMm) * (2.0 * radiusMm - apartMm);
}

inline const surfacing::Surface* tissueOf(const surfacing::Surfaces& surfaces, cases::Tissue tissue) {
    for (const surfacing::Surface& surface : surfaces.tissues)
        if (surface.tissue == tissue) return &surface;
    return nullptr;
}

}  // namespace handpiece::test
