// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/radiograph/projection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/senses/radiograph/bone.h"

namespace handpiece::radiograph {
namespace {

using cases::RayStretch;
using cases::RaySurface;
using cases::Tissue;
using core::Vec3;
using Role = RaySurface::Role;

constexpr std::int64_t kUnits = 16384;  ///< of a pixel
/// Corners lie so far from the picture's first pixel at most, so that products of whole numbers fit [pixels].
constexpr double kFar = 32768.0;
/// The beam meets nothing nearer to the spot [share of its distance to the detector].
constexpr double kNearSpot = 0.05;
/// A gap in the parts up to this long is shared by what lies at its ends; a longer one goes to the nearest part, looked
/// up at steps of the second.
constexpr double kSlitMm = 0.03, kGapStepMm = 0.2;

}  // namespace

Scene::Scene(const cases::Case& toothCase) {
    std::vector<RaySurface> surfaces;
    addTooth(toothCase, {}, surfaces);
    for (const cases::PlacedTooth& other : toothCase.others)
        addTooth(other, other.inCase, surfaces);
    if (surfaces.empty())
        throw core::Error("the case has no surface that could be imaged", toothCase.name, "give one with an outer.stl");
    for (const cases::Part& part : toothCase.scenery) {
        if (part.mesh.triangles.empty()) continue;
        // What is only seen need be no solid.
        if (!part.isFelt && !geometry::inspect(part.mesh).closed()) continue;
        // A tooth in soft tissue and bone, however they were meshed.
        const int tooth = part.tissue != Tissue::gum && part.tissue != Tissue::bone ? 1000 : 0;
        surfaces.push_back({part.name, part.tissue, part.priority + tooth, Role::scenery, 0});
        bodies_.push_back({&part.mesh, {}});
    }
    tissues_ = std::make_unique<cases::RayTissues>(std::move(surfaces));
    for (std::size_t b = 0; b < bodies_.size(); ++b)
        trees_.push_back(std::make_unique<Tree>());
}

void Scene::addTooth(const cases::Tooth& tooth, const core::Pose& inCase, std::vector<RaySurface>& surfaces) {
    const auto number = static_cast<std::uint32_t>(partsOfTooth_.size());
    partsOfTooth_.emplace_back();
    const std::string of = number == 0 ? "" : fmt::format("{}: ", tooth.name);
    if (!tooth.outer.triangles.empty()) {
        surfaces.push_back({of + "outer", Tissue::enamel, 0, Role::outer, number});
        bodies_.push_back({&tooth.outer, inCase});
    }
    for (const cases::Part& part : tooth.parts) {
        if (part.mesh.triangles.empty()) continue;
        partsOfTooth_.back().push_back(static_cast<std::uint32_t>(bodies_.size()));
        surfaces.push_back({of + part.name, part.tissue, part.priority, Role::part, number});
        bodies_.push_back({&part.mesh, inCase});
    }
}

Tissue Scene::nearestPart(std::uint32_t tooth, const Vec3& p) const {
    double nearest = std::numeric_limits<double>::infinity();
    Tissue tissue = Tissue::enamel;
    for (const std::uint32_t body : partsOfTooth_[tooth]) {
        const Body& b = bodies_[body];
        Tree& t = *trees_[body];
        std::call_once(t.made, [&] { t.tree = std::make_unique<geometry::TriangleTree>(*b.mesh); });
        const double distance = t.tree->nearest(b.inCase.applyInverse(p), nearest).distanceMm;
        if (distance < nearest) {
            nearest = distance;
            tissue = tissues_->surfaces()[body].tissue;
        }
    }
    return tissue;
}

Shadow::Shadow(const Scene& scene, const Bone& bone, const Projection& projection, const core::Vec2& spotMm,
               const core::Vec2& offset)
    : scene_(scene), bone_(bone), projection_(projection) {
    const Vec3 normal = projection.normal();
    spotMm_ =
        projection.centreMm + projection.sourceMm * normal + spotMm.x() * projection.right + spotMm.y() * projection.up;
    for (int axis = 0; axis < 2; ++axis)
        shift_[axis] = std::llround(offset[axis] * static_cast<double>(kUnits));
    const double middle[2] = {0.5 * (projection.width - 1), 0.5 * (projection.height - 1)};
    std::vector<geometry::RayCorner> corners;
    for (std::uint32_t s = 0; s < scene.bodies().size(); ++s) {
        const Scene::Body& body = scene.bodies()[s];
        corners.resize(body.mesh->vertices.size());
        for (std::size_t v = 0; v < corners.size(); ++v) {
            const Vec3 p = body.inCase.apply(body.mesh->vertices[v]) - projection.centreMm;
            const double depth = (projection.sourceMm - p.dot(normal)) / projection.sourceMm;
            const std::string& name = scene.tissues().surfaces()[s].name;
            if (!(depth > kNearSpot))
                throw core::Error("the surface reaches to the tube, or is not finite", name,
                                  "check its unit: lengths are millimetres");
            const double x = (spotMm.x() + (p.dot(projection.right) - spotMm.x()) / depth) / projection.pixelMm;
            const double y = (spotMm.y() + (p.dot(projection.up) - spotMm.y()) / depth) / projection.pixelMm;
            const double column = middle[0] + x, row = middle[1] - y;
            if (!(std::abs(column) < kFar && std::abs(row) < kFar))
                throw core::Error("the surface lies too far from the picture, or is not finite", name,
                                  "check its unit: lengths are millimetres; or give larger pixels");
            // Rising from the spot to the detector, where it is -1.
            corners[v] = {-1.0 / depth, std::llround(column * static_cast<double>(kUnits)),
                          std::llround(row * static_cast<double>(kUnits))};
        }
        for (const geometry::Triangle& t : body.mesh->triangles) {
            const Facet facet{{corners.at(t[0]), corners.at(t[1]), corners.at(t[2])}, s};
            const auto& c = facet.corner;
            const auto [lowJ, highJ] = std::minmax({c[0].j, c[1].j, c[2].j});
            const auto [lowK, highK] = std::minmax({c[0].k, c[1].k, c[2].k});
            if (highJ < -kUnits || highK < -kUnits || lowJ > projection.width * kUnits ||
                lowK > projection.height * kUnits)
                continue;
            facets_.push_back(facet);
        }
    }
    // Facets by row.
    const auto rowsOf = [&](const Facet& facet) {
        const auto [low, high] = std::minmax({facet.corner[0].k, facet.corner[1].k, facet.corner[2].k});
        return std::pair(
            std::max<std::int64_t>(0, geometry::ceilDivide(low - shift_[1], kUnits)),
            std::min<std::int64_t>(projection.height - 1, geometry::floorDivide(high - shift_[1], kUnits)));
    };
    rowBegin_.assign(static_cast<std::size_t>(projection.height) + 2, 0);
    for (const Facet& facet : facets_)
        for (auto [row, last] = rowsOf(facet); row <= last; ++row)
            ++rowBegin_[static_cast<std::size_t>(row) + 2];
    for (std::size_t r = 2; r < rowBegin_.size(); ++r)
        rowBegin_[r] += rowBegin_[r - 1];
    rowFacets_.resize(rowBegin_.back());
    for (std::uint32_t f = 0; f < facets_.size(); ++f)
        for (auto [row, last] = rowsOf(facets_[f]); row <= last; ++row)
            rowFacets_[rowBegin_[static_cast<std::size_t>(row) + 1]++] = f;
}

void Shadow::row(int y, Work& work, const Visit& visit) const {
    const auto columns = static_cast<std::size_t>(projection_.width);
    work.columns.clear();
    work.found.clear();
    work.begin.assign(columns + 1, 0);
    for (std::uint32_t n = rowBegin_[static_cast<std::size_t>(y)]; n < rowBegin_[static_cast<std::size_t>(y) + 1];
         ++n) {
        const Facet& facet = facets_[rowFacets_[n]];
        geometry::crossRays(facet.corner, y * kUnits + shift_[1], shift_[0], kUnits, projection_.width,
                            [&](std::int64_t column, double at, int step) {
                                work.columns.push_back(static_cast<std::uint32_t>(column));
                                ++work.begin[static_cast<std::size_t>(column) + 1];
                                // The share of the way from the spot to the detector.
                                work.found.push_back({-1.0 / at, facet.surface, step});
                            });
    }
    for (std::size_t c = 1; c < work.begin.size(); ++c)
        work.begin[c] += work.begin[c - 1];
    work.sorted.resize(work.found.size());
    for (std::size_t n = work.found.size(); n-- > 0;) {
        // From behind, so that what was found first comes first; begin[c + 1] becomes the start of column c.
        work.sorted[--work.begin[work.columns[n] + 1]] = work.found[n];
    }
    for (std::size_t column = 0; column < columns; ++column) {
        const std::size_t from = work.begin[column + 1],
                          to = column + 2 <= columns ? work.begin[column + 2] : work.found.size();
        if (from == to) continue;
        const std::span<cases::RayCrossing> ray(work.sorted.data() + from, to - from);
        std::stable_sort(ray.begin(), ray.end(), [](const auto& a, const auto& b) { return a.at < b.at; });
        const double right =
            (static_cast<double>(column) + static_cast<double>(shift_[0]) / kUnits - 0.5 * (projection_.width - 1)) *
            projection_.pixelMm;
        const double up =
            (0.5 * (projection_.height - 1) - y - static_cast<double>(shift_[1]) / kUnits) * projection_.pixelMm;
        const Vec3 along = projection_.centreMm + right * projection_.right + up * projection_.up - spotMm_;
        const double lengthMm = along.norm();
        scene_.tissues().follow(
            ray,
            [&](std::uint32_t tooth, double begin, double end, const RayStretch* before, const RayStretch* after,
                std::vector<RayStretch>& out) { fillGap(tooth, along, begin, end, before, after, out); },
            work.tissues, work.stretches);
        Paths paths{};
        // What lies behind the detector throws no shadow on it.
        for (const RayStretch& s : work.stretches) {
            if (!(s.from < 1.0)) continue;
            const double until = std::min(s.to, 1.0), pathMm = (until - s.from) * lengthMm;
            if (s.tissue != Tissue::bone) {
                paths[static_cast<std::size_t>(s.tissue)] += pathMm;
                continue;
            }
            // Compact bone and marrow, which is soft tissue.
            const double share = bone_.meanShare(spotMm_ + s.from * along, spotMm_ + until * along);
            paths[static_cast<std::size_t>(Tissue::bone)] += share * pathMm;
            paths[static_cast<std::size_t>(Tissue::gum)] += (1.0 - share) * pathMm;
        }
        visit(static_cast<int>(column), paths);
    }
}

void Shadow::fillGap(std::uint32_t tooth, const Vec3& along, double from, double to, const RayStretch* before,
                     const RayStretch* after, std::vector<RayStretch>& out) const {
    const auto isTooth = [](const RayStretch* s) { return s != nullptr && !s->isScenery; };
    const double lengthMm = along.norm() * (to - from);
    if (lengthMm <= kSlitMm && (isTooth(before) || isTooth(after))) {
        const double middle = !isTooth(before) ? from : !isTooth(after) ? to : 0.5 * (from + to);
        if (middle > from) out.push_back({from, middle, before->tissue, false});
        if (to > middle) out.push_back({middle, to, after->tissue, false});
        return;
    }
    const int pieces = static_cast<int>(std::ceil(lengthMm / kGapStepMm));
    for (int piece = 0; piece < pieces; ++piece) {
        const double low = from + (to - from) * piece / pieces, high = from + (to - from) * (piece + 1) / pieces;
        out.push_back({low, high, scene_.nearestPart(tooth, spotMm_ + 0.5 * (low + high) * along), false});
    }
}

}  // namespace handpiece::radiograph
