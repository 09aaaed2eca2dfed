// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/measure/pulp_surface.h"

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/parallel.h"

namespace handpiece::measure {
namespace {

using cases::Tissue;
using core::Vec3;
using field::kBrickCells;
using field::kBrickNodes;

constexpr int kBisections = 5;  // of a voxel: to a thirtieth

double distance2(const core::Box& box, const Vec3& p) {
    return (box.min - p).cwiseMax(p - box.max).cwiseMax(Vec3::Zero()).squaredNorm();
}

void addPoints(const tooth::ToothModel& base, std::uint32_t dense, std::vector<Vec3>& points) {
    constexpr auto kPulp = static_cast<std::uint8_t>(Tissue::pulp);
    constexpr int kWays[6][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}};
    const field::FieldView view = base.field.view();
    const std::uint8_t* nodes = base.tissues.nodes()->of(dense);
    if (!base.tissues.nodes()->isMixed(dense) ||
        std::find(nodes, nodes + field::kBrickValues, kPulp) == nodes + field::kBrickValues)
        return;
    for (int z = 0; z < kBrickCells; ++z)
        for (int y = 0; y < kBrickCells; ++y)
            for (int x = 0; x < kBrickCells; ++x)
                for (const auto& way : kWays) {
                    const int here = x + kBrickNodes * (y + kBrickNodes * z);
                    const int there = here + way[0] + kBrickNodes * (way[1] + kBrickNodes * way[2]);
                    const bool from = nodes[here] == kPulp, to = nodes[there] == kPulp;
                    if (from == to) continue;
                    Vec3 a = nodeMm(view, dense, x, y, z);
                    Vec3 b = nodeMm(view, dense, x + way[0], y + way[1], z + way[2]);
                    for (int i = 0; i < kBisections; ++i) {
                        const Vec3 middle = 0.5 * (a + b);
                        ((base.tissues.at(middle) == Tissue::pulp) == from ? a : b) = middle;
                    }
                    points.emplace_back(0.5 * (a + b));
                }
}

}  // namespace

Vec3 nodeMm(const field::FieldView& view, std::uint32_t dense, int x, int y, int z) {
    const auto bx = static_cast<std::uint32_t>(view.bricks[0]), by = static_cast<std::uint32_t>(view.bricks[1]);
    const std::uint32_t brick[3] = {dense % bx, dense / bx % by, dense / (bx * by)};
    const int node[3] = {x, y, z};
    Vec3 p;
    for (int k = 0; k < 3; ++k)
        p[k] = view.originMm[k] + view.voxelMm * (kBrickCells * static_cast<double>(brick[k]) + node[k]);
    return p;
}

PulpSurface::PulpSurface(const tooth::ToothModel& base) {
    const field::FieldView view = base.field.view();
    const std::uint32_t perLayer =
        static_cast<std::uint32_t>(view.bricks[0]) * static_cast<std::uint32_t>(view.bricks[1]);
    std::vector<std::vector<std::vector<Vec3>>> layers(static_cast<std::size_t>(view.bricks[2]));
    core::parallelFor(layers.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t layer = begin; layer < end; ++layer)
            for (std::uint32_t i = 0; i < perLayer; ++i) {
                std::vector<Vec3> points;
                addPoints(base, static_cast<std::uint32_t>(layer) * perLayer + i, points);
                if (!points.empty()) layers[layer].push_back(std::move(points));
            }
    });
    for (const auto& layer : layers)
        for (const std::vector<Vec3>& points : layer) {
            Cluster cluster{{}, points_.size(), points.size()};
            for (const Vec3& p : points)
                cluster.box.extend(p);
            clusters_.push_back(cluster);
            points_.insert(points_.end(), points.begin(), points.end());
        }
}

double PulpSurface::distanceMm(const Vec3& p, double boundMm) const {
    double best2 = boundMm * boundMm;
    bool found = false;
    const auto look = [&](const Cluster& cluster) {
        for (std::size_t i = cluster.first; i < cluster.first + cluster.count; ++i) {
            const double d2 = (points_[i] - p).squaredNorm();
            if (d2 > best2) continue;
            best2 = d2;
            found = true;
        }
    };
    // The nearest box first: it rules out nearly all the others.
    const Cluster* nearest = nullptr;
    double nearest2 = best2;
    for (const Cluster& cluster : clusters_) {
        const double d2 = distance2(cluster.box, p);
        if (d2 > nearest2) continue;
        nearest2 = d2;
        nearest = &cluster;
    }
    if (nearest == nullptr) return std::numeric_limits<double>::infinity();
    look(*nearest);
    for (const Cluster& cluster : clusters_)
        if (&cluster != nearest && distance2(cluster.box, p) < best2) look(cluster);
    return found ? std::sqrt(best2) : std::numeric_limits<double>::infinity();
}

}  // namespace handpiece::measure
