// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/points_beyond.h"

#include "handpiece/base/core/parallel.h"

namespace handpiece::geometry {

using core::Vec3;

std::vector<std::uint32_t> pointsBeyond(const TriangleTree& tree, std::span<const Vec3> points, double mostMm,
                                        double sign) {
    constexpr double kRoundingMm = 1e-9;
    std::vector<std::uint8_t> isBeyond(points.size(), 0);
    core::parallelFor(points.size(), 1024, [&](std::size_t begin, std::size_t end) {
        Vec3 asked = Vec3::Zero();
        double clearMm = -1.0;  // how far from `asked` all is well
        std::uint32_t seed = kNoTriangle;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3& p = points[i];
            if ((p - asked).norm() <= clearMm) continue;
            NearestPoint nearest;
            const double value = sign * tree.signedDistance(p, &nearest, seed);
            seed = nearest.triangle;
            isBeyond[i] = value > mostMm;
            asked = p;
            clearMm = mostMm - value - kRoundingMm;
        }
    });
    std::vector<std::uint32_t> found;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (isBeyond[i] != 0) found.push_back(static_cast<std::uint32_t>(i));
    return found;
}

}  // namespace handpiece::geometry
