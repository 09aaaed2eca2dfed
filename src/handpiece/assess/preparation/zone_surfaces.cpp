// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/preparation/zone_surfaces.h"

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/isosurface.h"

namespace handpiece::preparation {
namespace {

using core::Vec3;

constexpr double kMostNodes = 300e3;

core::Box common(const core::Box& a, const core::Box& b) {
    return {a.min.cwiseMax(b.min), a.max.cwiseMin(b.max)};
}

/// f < 0 in the tooth. Where f is clear of the border the tooth, which is dear to ask, is not asked.
template <class F, class Tooth>
geometry::TriangleMesh surfaceIn(const F& f, const Tooth& tooth, const core::Box& box, double finestMm,
                                 const core::Progress& progress) {
    if (box.isEmpty()) return {};
    double spacingMm = finestMm;
    while (box.size().prod() > kMostNodes * spacingMm * spacingMm * spacingMm)
        spacingMm *= 1.05;
    const core::Box around = box.grown(spacingMm);
    geometry::ScalarGrid grid;
    grid.originMm = around.min;
    grid.spacingMm = spacingMm;
    for (int k = 0; k < 3; ++k)
        grid.nodes[static_cast<std::size_t>(k)] =
            static_cast<std::uint32_t>(std::ceil(around.size()[k] / spacingMm)) + 1;
    const std::size_t row = grid.nodes[0], layer = row * grid.nodes[1];
    std::vector<float> values(layer * grid.nodes[2]);
    constexpr std::size_t kLayers = 4;  // between two looks at whether it is still wanted
    for (std::size_t z0 = 0; z0 < grid.nodes[2]; z0 += kLayers) {
        core::report(progress, 0.9 * static_cast<double>(z0) / grid.nodes[2]);
        const std::size_t z1 = std::min<std::size_t>(z0 + kLayers, grid.nodes[2]);
        core::parallelFor((z1 - z0) * grid.nodes[1], 4, [&](std::size_t begin, std::size_t end) {
            for (std::size_t r = begin; r < end; ++r) {
                const std::size_t z = z0 + r / grid.nodes[1], y = r % grid.nodes[1];
                for (std::size_t x = 0; x < row; ++x) {
                    const Vec3 p = grid.originMm + spacingMm * Vec3(static_cast<double>(x), static_cast<double>(y),
                                                                    static_cast<double>(z));
                    double value = f(p);
                    if (value < 2.0 * spacingMm) value = std::max(value, tooth(p));
                    values[z * layer + y * row + x] = static_cast<float>(value);
                }
            }
        });
    }
    grid.values = values;
    return geometry::isosurface(grid, core::part(progress, 0.9, 1.0));
}

template <class F>
geometry::TriangleMesh surfaceOf(const F& f, const geometry::TriangleTree& whole, const core::Box& box, double finestMm,
                                 const core::Progress& progress) {
    return surfaceIn(
        f, [&whole](const Vec3& p) { return whole.signedDistance(p); }, box, finestMm, progress);
}

}  // namespace

geometry::TriangleMesh regionSurface(const geometry::ScalarFunction& region, const geometry::ScalarFunction& tooth,
                                     const core::Box& box, double finestMm, const core::Progress& progress) {
    return surfaceIn(region, tooth, box, finestMm, progress);
}

geometry::TriangleMesh zoneSurface(SeenZone zone, const cases::Tooth& tooth, const Recipe& recipe, const Laid& laid,
                                   const core::Progress& progress, double finestMm) {
    const zones::Zones& zones = *laid.zones;
    const core::Box& whole = laid.whole->bounds();
    const zones::Leeway& leeway = zones.leeway();
    switch (zone) {
        case SeenZone::target:
            return surfaceOf([&](const Vec3& p) { return std::max(zones.targetMm(p), -zones.protectedMm(p)); },
                             *laid.whole, common(zones.box(), whole), finestMm, progress);
        case SeenZone::leeway:
            return surfaceOf([&](const Vec3& p) { return std::max(zones.allowedMm(p), -zones.protectedMm(p)); },
                             *laid.whole, common(zones.box().grown(std::max(leeway.sideMm, leeway.floorMm)), whole),
                             finestMm, progress);
        case SeenZone::container:
            return surfaceOf([&](const Vec3& p) { return std::max(-zones.allowedMm(p), -zones.protectedMm(p)); },
                             *laid.whole, whole, finestMm, progress);
        case SeenZone::protectedZone:
            break;
    }
    geometry::TriangleMesh pulp;
    core::Box box;
    for (const cases::Part& part : tooth.parts) {
        if (part.tissue != cases::Tissue::pulp) continue;
        const auto first = static_cast<std::uint32_t>(pulp.vertices.size());
        pulp.vertices.insert(pulp.vertices.end(), part.mesh.vertices.begin(), part.mesh.vertices.end());
        for (auto t : part.mesh.triangles) {
            for (auto& corner : t)
                corner += first;
            pulp.triangles.push_back(t);
        }
    }
    for (const Vec3& v : pulp.vertices)
        box.extend(v);
    // The pulp alone is known exactly.
    if (pulp.triangles.empty() || recipe.pulpMm <= 0.0) return pulp;
    return surfaceOf([&](const Vec3& p) { return zones.protectedMm(p); }, *laid.whole,
                     common(box.grown(recipe.pulpMm), whole), finestMm, progress);
}

}  // namespace handpiece::preparation
