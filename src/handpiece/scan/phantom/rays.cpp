// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/phantom/rays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/error.h"

namespace handpiece::phantom {
namespace {

using core::Vec3;

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

std::int64_t floorDivide(std::int64_t a, std::int64_t b) {
    return a >= 0 ? a / b : -((-a + b - 1) / b);
}

std::int64_t ceilDivide(std::int64_t a, std::int64_t b) {
    return -floorDivide(-a, b);
}

}  // namespace

Rays::Rays(const cases::Case& toothCase, const core::Pose& toothInScan, const volume::Grid& grid, bool scenery)
    : grid_(grid) {
    if (!toothCase.outer.triangles.empty()) {
        hasOuter_ = true;
        add(toothCase.outer, "outer", cases::Tissue::enamel, 0, Surface::Role::outer, toothInScan);
    }
    for (const cases::Part& part : toothCase.parts)
        if (!part.mesh.triangles.empty())
            add(part.mesh, part.name, part.tissue, part.priority, Surface::Role::part, toothInScan);
    if (surfaces_.empty())
        throw core::Error("the case has no surface that could be imaged", toothCase.name, "give one with an outer.stl");
    hasParts_ = surfaces_.size() > (hasOuter_ ? 1u : 0u);
    if (scenery)
        for (const cases::Part& part : toothCase.scenery)
            if (!part.mesh.triangles.empty())
                add(part.mesh, part.name, part.tissue, part.priority, Surface::Role::scenery, toothInScan);
    // Of equal priorities the later one wins.
    for (std::uint32_t s = 0; s < surfaces_.size(); ++s)
        if (surfaces_[s].role != Surface::Role::outer) byPriority_.insert(byPriority_.begin(), s);
    std::stable_sort(byPriority_.begin(), byPriority_.end(), [&](std::uint32_t a, std::uint32_t b) {
        if (surfaces_[a].role != surfaces_[b].role) return surfaces_[a].role == Surface::Role::part;
        return surfaces_[a].priority > surfaces_[b].priority;
    });
    facetsOfSlice_.resize(static_cast<std::size_t>(grid_.size[2]));
    for (std::uint32_t f = 0; f < facets_.size(); ++f) {
        const Facet& facet = facets_[f];
        const auto [low, high] = std::minmax({facet.corner[0].k, facet.corner[1].k, facet.corner[2].k});
        const std::int64_t first = std::max<std::int64_t>(0, ceilDivide(low - kUnits / 2, kUnits));
        const std::int64_t last = std::min<std::int64_t>(grid_.size[2] - 1, floorDivide(high + kUnits / 2, kUnits));
        for (std::int64_t k = first; k <= last; ++k)
            facetsOfSlice_[static_cast<std::size_t>(k)].push_back(f);
    }
}

void Rays::add(const geometry::TriangleMesh& mesh, std::string name, cases::Tissue tissue, int priority,
               Surface::Role role, const core::Pose& toothInScan) {
    constexpr double kFar = 1e6;  // Voxels; beyond it products of whole coordinates would not fit.
    Surface surface{std::move(name), tissue, priority, role, nullptr};
    geometry::TriangleMesh placed = mesh;
    for (Vec3& v : placed.vertices) {
        v = grid_.toVoxels(toothInScan.apply(v));
        if (!(v.cwiseAbs().maxCoeff() < kFar))
            throw core::Error("the surface lies too far from the scan, or is not finite", surface.name,
                              "give larger voxels");
    }
    std::vector<Corner> corners(placed.vertices.size());
    for (std::size_t v = 0; v < corners.size(); ++v) {
        const Vec3& p = placed.vertices[v];
        corners[v] = {p.x(), std::llround(p.y() * kUnits), std::llround(p.z() * kUnits)};
    }
    const auto index = static_cast<std::uint32_t>(surfaces_.size());
    for (const geometry::Triangle& t : mesh.triangles)
        facets_.push_back({{corners.at(t[0]), corners.at(t[1]), corners.at(t[2])}, index});
    if (role == Surface::Role::part) surface.tree = std::make_unique<geometry::TriangleTree>(placed);
    surfaces_.push_back(std::move(surface));
}

void Rays::cross(const Facet& facet, int k, int ray, std::vector<Crossing>& out) const {
    const std::int64_t rayK = k * kUnits + offset(ray, true), shift = offset(ray, false);
    const Corner* a = &facet.corner[0];
    const Corner* b = &facet.corner[1];
    const Corner* c = &facet.corner[2];
    const auto [lowK, highK] = std::minmax({a->k, b->k, c->k});
    if (rayK < lowK || rayK > highK) return;
    const auto [lowJ, highJ] = std::minmax({a->j, b->j, c->j});
    const std::int64_t first = std::max<std::int64_t>(0, ceilDivide(lowJ - shift, kUnits));
    const std::int64_t last = std::min<std::int64_t>(grid_.size[1] - 1, floorDivide(highJ - shift, kUnits));
    if (first > last) return;
    const auto area = [](const Corner& p, const Corner& q, std::int64_t j, std::int64_t kk) {
        return (q.j - p.j) * (kk - p.k) - (q.k - p.k) * (j - p.j);
    };
    std::int64_t whole = area(*a, *b, c->j, c->k);
    if (whole == 0) return;
    const std::int16_t step = whole > 0 ? -1 : 1;
    if (whole < 0) {
        std::swap(b, c);
        whole = -whole;
    }
    // A ray through an edge belongs to one side of it, whichever triangle asks.
    const auto isIn = [](const Corner& p, const Corner& q, std::int64_t value) {
        return value > 0 || (value == 0 && (q.k > p.k || (q.k == p.k && q.j < p.j)));
    };
    for (std::int64_t row = first; row <= last; ++row) {
        const std::int64_t j = row * kUnits + shift;
        const std::int64_t ofC = area(*a, *b, j, rayK), ofA = area(*b, *c, j, rayK), ofB = area(*c, *a, j, rayK);
        if (!isIn(*a, *b, ofC) || !isIn(*b, *c, ofA) || !isIn(*c, *a, ofB)) continue;
        const double at =
            (static_cast<double>(ofA) * a->i + static_cast<double>(ofB) * b->i + static_cast<double>(ofC) * c->i) /
            static_cast<double>(whole);
        out.push_back(
            {at, static_cast<std::uint32_t>(row * (kRays + 1) + ray), static_cast<std::uint16_t>(facet.surface), step});
    }
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
        for (const Surface& surface : surfaces_) {
            if (surface.tree == nullptr) continue;
            const double distance = surface.tree->nearest({0.5 * (low + high), j, kAt}, nearest).distanceMm;
            if (distance < nearest) {
                nearest = distance;
                tissue = surface.tissue;
            }
        }
        out.push_back({low, high, tissue, false});
    }
}

void Rays::follow(int k, std::span<const Crossing> crossings, std::vector<int>& winding,
                  std::vector<Stretch>& out) const {
    /// Tooth in which no part lies.
    struct Gap {
        double from, to;
        std::size_t before;  ///< stretches before it
    };
    std::fill(winding.begin(), winding.end(), 0);
    std::vector<Gap> gaps;
    out.clear();
    for (std::size_t c = 0; c + 1 <= crossings.size(); ++c) {
        winding[crossings[c].surface] += crossings[c].step;
        if (c + 1 == crossings.size()) break;
        const double from = crossings[c].at, to = crossings[c + 1].at;
        if (!(to > from)) continue;
        const bool inOuter = hasOuter_ && winding[0] > 0;
        const Surface* owner = nullptr;
        for (const std::uint32_t s : byPriority_) {
            const bool counts = surfaces_[s].role == Surface::Role::scenery ? !inOuter : inOuter || !hasOuter_;
            if (counts && winding[s] > 0) {
                owner = &surfaces_[s];
                break;
            }
        }
        if (owner == nullptr && inOuter && hasParts_) {
            if (!gaps.empty() && gaps.back().to == from && gaps.back().before == out.size())
                gaps.back().to = to;
            else
                gaps.push_back({from, to, out.size()});
            continue;
        }
        if (owner == nullptr && !inOuter) continue;
        const cases::Tissue tissue = owner != nullptr ? owner->tissue : cases::Tissue::enamel;
        const bool isScenery = owner != nullptr && owner->role == Surface::Role::scenery;
        if (!out.empty() && out.back().to == from && out.back().tissue == tissue && out.back().isScenery == isScenery &&
            (gaps.empty() || gaps.back().before < out.size()))
            out.back().to = to;
        else
            out.push_back({from, to, tissue, isScenery});
    }
    for (std::size_t s = 0; s < winding.size(); ++s)
        if (winding[s] != 0)
            throw core::Error("the surface is not closed: a ray goes in and does not come out", surfaces_[s].name,
                              "mend it with `handpiece mesh repair`");
    if (gaps.empty()) return;
    std::vector<Stretch> filled;
    std::size_t next = 0;
    for (const Gap& gap : gaps) {
        while (next < gap.before)
            filled.push_back(out[next++]);
        const Stretch* before = !filled.empty() && filled.back().to == gap.from ? &filled.back() : nullptr;
        const Stretch copy = before != nullptr ? *before : Stretch{};
        const Stretch* after = next < out.size() && out[next].from == gap.to ? &out[next] : nullptr;
        fillGap(k, crossings[0].row, gap.from, gap.to, before != nullptr ? &copy : nullptr, after, filled);
    }
    filled.insert(filled.end(), out.begin() + static_cast<std::ptrdiff_t>(next), out.end());
    out.swap(filled);
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
    std::vector<Crossing> sorted(found.size());
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (const Crossing& c : found)
        sorted[next[c.row]++] = c;
    std::vector<int> winding(surfaces_.size());
    std::vector<Stretch> stretches;
    for (std::size_t r = 0; r + 1 < begin.size(); ++r) {
        const std::span<Crossing> row(sorted.data() + begin[r], begin[r + 1] - begin[r]);
        if (row.empty()) continue;
        std::stable_sort(row.begin(), row.end(), [](const Crossing& a, const Crossing& b) { return a.at < b.at; });
        follow(k, row, winding, stretches);
        if (!stretches.empty()) visit(static_cast<int>(r / (kRays + 1)), static_cast<int>(r % (kRays + 1)), stretches);
    }
}

}  // namespace handpiece::phantom
