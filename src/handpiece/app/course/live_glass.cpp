// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/course/live_glass.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "handpiece/assess/preparation/zone_surfaces.h"
#include "handpiece/base/core/alone.h"
#include "handpiece/senses/measure/tooth_probe.h"

namespace handpiece::course {
namespace {

using core::Vec3;

constexpr double kFinestMm = 0.16, kStripeMm = 0.22;
/// So far beside the target it is looked for what should still be there.
constexpr double kAroundMm = 1.5;
/// Less than this beyond the leeway is not told: a voxel's edge is no error.
constexpr double kOverMm = 0.05;

/// The part of a polygon on one side of a level of `slant`.
std::vector<Vec3> clipped(const std::vector<Vec3>& polygon, const Vec3& slant, double level, double side) {
    std::vector<Vec3> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double fromA = side * (slant.dot(a) - level), fromB = side * (slant.dot(b) - level);
        if (fromA >= 0.0) kept.push_back(a);
        if ((fromA >= 0.0) != (fromB >= 0.0)) kept.push_back(a + fromA / (fromA - fromB) * (b - a));
    }
    return kept;
}

}  // namespace

geometry::TriangleMesh hatched(const geometry::TriangleMesh& mesh, double stripeMm) {
    const Vec3 slant = Vec3(1.0, 1.0, 0.7).normalized();
    geometry::TriangleMesh stripes;
    for (const geometry::Triangle& t : mesh.triangles) {
        const std::vector<Vec3> whole{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
        double low = 1e300, high = -1e300;
        for (const Vec3& p : whole) {
            low = std::min(low, slant.dot(p));
            high = std::max(high, slant.dot(p));
        }
        const double step = 2.0 * stripeMm;
        for (double from = step * std::floor(low / step); from < high; from += step) {
            const std::vector<Vec3> piece = clipped(clipped(whole, slant, from, 1.0), slant, from + stripeMm, -1.0);
            if (piece.size() < 3) continue;
            const auto first = static_cast<std::uint32_t>(stripes.vertices.size());
            stripes.vertices.insert(stripes.vertices.end(), piece.begin(), piece.end());
            for (std::uint32_t i = 1; i + 1 < piece.size(); ++i)
                stripes.triangles.push_back({first, first + i, first + i + 1});
        }
    }
    return stripes;
}

LiveGlass liveGlass(const preparation::Laid& laid, const simulation::LiveTooth& tooth) {
    const core::Alone alone;
    tooth::ToothMirror mirror(tooth.modelShared());
    mirror.apply(tooth.state({}));
    const measure::ToothProbe probe(mirror);
    const zones::Zones& zones = *laid.zones;
    const core::Box& whole = laid.whole->bounds();
    const auto within = [&](const core::Box& box) {
        return core::Box{box.min.cwiseMax(whole.min), box.max.cwiseMin(whole.max)};
    };
    LiveGlass glass;
    glass.left = preparation::regionSurface(
        [&](const Vec3& p) { return std::max(zones.targetMm(p), -zones.protectedMm(p)); },
        [&](const Vec3& p) { return probe.signedDistanceMm(p); }, within(zones.box()), kFinestMm);
    const geometry::TriangleMesh over = preparation::regionSurface(
        [&](const Vec3& p) { return kOverMm - zones.allowedMm(p); },
        [&](const Vec3& p) { return std::max(-probe.signedDistanceMm(p), laid.whole->signedDistance(p)); },
        within(zones.box().grown(kAroundMm)), kFinestMm);
    glass.over = hatched(over, kStripeMm);
    return glass;
}

}  // namespace handpiece::course
