// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/phantom/rays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/error.h"

namespace handpiece::phantom {
namespace {

using core::Vec3;
using Role = cases::RaySurface::Role;

constexpr std::int64_t kUnits = 65536;  ///< of a voxel
/// The Fibonacci lattice's second step.
constexpr int kLatticeStep = 21;
/// A gap in the parts up to this long [voxels] is shared by what lies at its ends; a longer one goes to the nearest
/// part, looked up at steps of this length.
constexpr double kSlit = 0.25;

std::int64_t offset(int ray, bool second) {
    if (ray == 0) return 0;
    const int step = second ? ((ray - 1) * kLatticeStep) % kRays : ray - 1;
    return ((2 * step + 1) * kUnits) / (2 * kRays) - kUnits / 2;
}

}  // namespace

Rays::Rays(const cases::Case& toothCase, const core::Pose& toothInScan, const volume::Grid& grid, bool scenery)
    : grid_(grid) {
    if (!toothCase.outer.triangles.empty())
        add(toothCase.outer, {"outer", cases::Tissue::enamel, 0, Role::outer}, toothInScan);
    for (const cases::Part& part : toothCase.parts)
        if (!part.mesh.triangles.empty())
            add(part.mesh, {part.name, part.tissue, part.priority, Role::part}, toothInScan);
    if (surfaces_.empty())
        throw core::Error("the case has no surface that could be imaged", toothCase.name, "give one with an outer.stl");
    if (scenery)
        for (const cases::Part& part : toothCase.scenery)
            if (!part.mesh.triangles.empty())
                add(part.mesh, {part.name, part.tissue, part.priority, Role::scenery}, toothInScan);
    tissues_ = std::make_unique<cases::RayTissues>(surfaces_);
    facetsOfSlice_.resize(static_cast<std::size_t>(grid_.size[2]));
    for (std::uint32_t f = 0; f < facets_.size(); ++f) {
        const Facet& facet = facets_[f];
        const auto [low, high] = std::minmax({facet.corner[0].k, facet.corner[1].k, facet.corner[2].k});
        const std::int64_t first = std::max<std::int64_t>(0, geometry::ceilDivide(low - kUnits / 2, kUnits));
        const std::int64_t last =
            std::min<std::int64_t>(grid_.size[2] - 1, geometry::floorDivide(high + kUnits / 2, kUnits));
        for (std::int64_t k = first; k <= last; ++k)
            facetsOfSlice_[static_cast<std::size_t>(k)].push_back(f);
    }
}

void Rays::add(const geometry::TriangleMesh& mesh, cases::RaySurface surface, const core::Pose& toothInScan) {
    constexpr double kFar = 1e6;  // Voxels; beyond it products of whole coordinates would not fit.
    geometry::TriangleMesh placed = mesh;
    for (Vec3& v : placed.vertices) {
        v = grid_.toVoxels(toothInScan.apply(v));
        if (!(v.cwiseAbs().maxCoeff() < kFar))
            throw core::Error("the surface lies too far from the scan, or is not finite", surface.name,
                              "give larger voxels");
    }
    std::vector<geometry::RayCorner> corners(placed.vertices.size());
    for (std::size_t v = 0; v < corners.size(); ++v) {
        const Vec3& p = placed.vertices[v];
        corners[v] = {p.x(), std::llround(p.y() * kUnits), std::llround(p.z() * kUnits)};
    }
    const auto index = static_cast<std::uint32_t>(surfaces_.size());
    for (const geometry::Triangle& t : mesh.triangles)
        facets_.push_back({{corners.at(t[0]), corners.at(t[1]), corners.at(t[2])}, index});
    trees_.push_back(surface.role == Role::part ? std::make_unique<geometry::TriangleTree>(placed) : nullptr);
    surfaces_.push_back(std::move(surface));
}

void Rays::cross(const Facet& facet, int k, int ray, std::vector<Crossing>& out) const {
    geometry::crossRays(facet.corner, k * kUnits + offset(ray, true), offset(ray, false), kUnits, grid_.size[1],
                        [&](std::int64_t row, double at, int step) {
                            out.push_back({static_cast<std::uint32_t>(row * (kRays + 1) + ray),
                                           {at, facet.surface, static_cast<std::int32_t>(step)}});
                        });
}

void Rays::fillGap(int k, std::uint32_t row, double from, double to, const Stretch* before, const Stretch* after,
                   std::vector<Stretch>& out) const {
    const auto isTooth = [](const Stretch* s) { return s != nullptr && !s->isScenery; };
    if (to - from <= kSlit && (isTooth(before) || isTooth(after))) {
        const double middle = !isTooth(before) ? from : !isTooth(after) ? to : 0.5 * (from + to);
        if (middle > from) out.push_back({from, middle, before->tissue, false});
        if (to > middle) out.push_back({middle, to, after->tissue, false});
        return;
    }
    const int ray = static_cast<int>(row % (kRays + 1));
    const double j =
        static_cast<double>(row / (kRays + 1)) + static_cast<double>(offset(ray, false)) / static_cast<double>(kUnits);
    const double kAt = k + static_cast<double>(offset(ray, true)) / static_cast<double>(kUnits);
    const int pieces = static_cast<int>(std::ceil((to - from) / kSlit));
    for (int piece = 0; piece < pieces; ++piece) {
        const double low = from + (to - from) * piece / pieces, high = from + (to - from) * (piece + 1) / pieces;
        double nearest = std::numeric_limits<double>::infinity();
        cases::Tissue tissue = cases::Tissue::enamel;
        for (std::size_t s = 0; s < surfaces_.size(); ++s) {
            if (trees_[s] == nullptr) continue;
            const double distance = trees_[s]->nearest({0.5 * (low + high), j, kAt}, nearest).distanceMm;
            if (distance < nearest) {
                nearest = distance;
                tissue = surfaces_[s].tissue;
            }
        }
        out.push_back({low, high, tissue, false});
    }
}

void Rays::slice(int k, bool middles, bool lattice, const Visit& visit) const {
    std::vector<Crossing> found;
    for (const std::uint32_t f : facetsOfSlice_[static_cast<std::size_t>(k)])
        for (int ray = middles ? 0 : 1; ray <= (lattice ? kRays : 0); ++ray)
            cross(facets_[f], k, ray, found);
    // Rows side by side, then each along its ray.
    std::vector<std::uint32_t> begin(static_cast<std::size_t>(grid_.size[1]) * (kRays + 1) + 1, 0);
    for (const Crossing& c : found)
        ++begin[c.row + 1];
    for (std::size_t r = 1; r < begin.size(); ++r)
        begin[r] += begin[r - 1];
    std::vector<cases::RayCrossing> sorted(found.size());
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (const Crossing& c : found)
        sorted[next[c.row]++] = c.crossing;
    cases::RayTissues::Work work;
    std::vector<Stretch> stretches;
    for (std::size_t r = 0; r + 1 < begin.size(); ++r) {
        const std::span<cases::RayCrossing> row(sorted.data() + begin[r], begin[r + 1] - begin[r]);
        if (row.empty()) continue;
        std::stable_sort(row.begin(), row.end(),
                         [](const cases::RayCrossing& a, const cases::RayCrossing& b) { return a.at < b.at; });
        tissues_->follow(
            row,
            [&](std::uint32_t, double from, double to, const Stretch* before, const Stretch* after,
                std::vector<Stretch>& out) { fillGap(k, static_cast<std::uint32_t>(r), from, to, before, after, out); },
            work, stretches);
        if (!stretches.empty()) visit(static_cast<int>(r / (kRays + 1)), static_cast<int>(r % (kRays + 1)), stretches);
    }
}

}  // namespace handpiece::phantom
