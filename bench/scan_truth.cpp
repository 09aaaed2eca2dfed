// SPDX-License-Identifier: Apache-2.0
#include "scan_truth.h"

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/isosurface.h"

namespace handpiece::bench {
namespace {

using cases::Tissue;
using core::Vec3;

constexpr std::size_t kPoints = 20000;
/// How far on either side of a true surface the tissues are looked up: a face that bounds nothing (a slit of the case's
/// own meshes, a stretch under another part) does not count.
constexpr double kLookMm = 0.02;

std::size_t indexOf(SolidKind kind) {
    return static_cast<std::size_t>(kind);
}

bool holds(SolidKind kind, Tissue tissue) {
    switch (kind) {
        case SolidKind::outer:
            return tissue != Tissue::none;
        case SolidKind::enamel:
            return tissue == Tissue::enamel;
        case SolidKind::dentine:
            return tissue != Tissue::none && tissue != Tissue::enamel;
        case SolidKind::pulp:
            return tissue == Tissue::pulp;
        case SolidKind::caries:
            return tissue == Tissue::caries;
    }
    return false;
}

SolidKind kindOf(Tissue tissue) {
    return tissue == Tissue::dentine ? SolidKind::dentine
           : tissue == Tissue::pulp  ? SolidKind::pulp
                                     : SolidKind::caries;
}

SurfaceError summed(std::vector<double> distances, double sum) {
    SurfaceError error;
    error.points = distances.size();
    if (distances.empty()) return error;
    error.biasMm = sum / static_cast<double>(distances.size());
    std::sort(distances.begin(), distances.end());
    const auto at = [&](double share) {
        return distances[static_cast<std::size_t>(share * static_cast<double>(distances.size() - 1))];
    };
    error.medianMm = at(0.5);
    error.p95Mm = at(0.95);
    error.worstMm = distances.back();
    return error;
}

/// `sign`: of the distances' mean.
SurfaceError errorOf(const std::vector<SurfacePoint>& points, const ComparedSurface& surface, double sign) {
    std::vector<double> distances(points.size());
    core::parallelFor(points.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n)
            distances[n] = sign * surface.signedDistance(points[n].atMm);
    });
    double sum = 0.0;
    for (double& d : distances) {
        sum += d;
        d = std::abs(d);
    }
    return summed(std::move(distances), sum);
}

std::vector<SurfacePoint> filtered(const std::vector<SurfacePoint>& points,
                                   const std::function<bool(const SurfacePoint&)>& keep) {
    std::vector<std::uint8_t> kept(points.size());
    core::parallelFor(points.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n)
            kept[n] = keep(points[n]) ? 1 : 0;
    });
    std::vector<SurfacePoint> out;
    for (std::size_t n = 0; n < points.size(); ++n)
        if (kept[n] != 0) out.push_back(points[n]);
    return out;
}

ComparedSurface compared(const geometry::TriangleMesh& mesh) {
    if (mesh.triangles.empty()) return {};
    return {{{std::make_shared<const geometry::TriangleTree>(mesh)}}, sampled(mesh, kPoints)};
}

geometry::TriangleMesh zeroOf(const volume::Grid& grid, std::vector<float> distanceMm) {
    geometry::ScalarGrid scalar;
    scalar.nodes = {static_cast<std::uint32_t>(grid.size[0]), static_cast<std::uint32_t>(grid.size[1]),
                    static_cast<std::uint32_t>(grid.size[2])};
    scalar.spacingMm = 1.0;
    scalar.values = std::move(distanceMm);
    geometry::TriangleMesh mesh = geometry::isosurface(scalar);
    for (Vec3& v : mesh.vertices)
        v = grid.toMm(v);
    return mesh;
}

/// Trilinear between the grid's voxels; `p` in voxels, inside the grid.
float between(const volume::Grid& grid, const std::vector<float>& values, const Vec3& p) {
    int low[3];
    double share[3];
    for (int a = 0; a < 3; ++a) {
        low[a] =
            std::clamp(static_cast<int>(std::floor(p[a])), 0, std::max(0, grid.size[static_cast<std::size_t>(a)] - 2));
        share[a] = grid.size[static_cast<std::size_t>(a)] > 1 ? p[a] - low[a] : 0.0;
    }
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1.0;
        int at[3];
        for (int a = 0; a < 3; ++a) {
            const bool up = (corner >> a & 1) != 0;
            at[a] = std::min(low[a] + (up ? 1 : 0), grid.size[static_cast<std::size_t>(a)] - 1);
            weight *= up ? share[a] : 1.0 - share[a];
        }
        if (weight != 0.0) sum += weight * static_cast<double>(values[grid.index(at[0], at[1], at[2])]);
    }
    return static_cast<float>(sum);
}

}  // namespace

const char* nameOf(SolidKind kind) {
    constexpr std::array<const char*, kSolidKinds.size()> kNames = {"outer", "enamel", "dentine", "pulp", "caries"};
    return kNames.at(indexOf(kind));
}

double ComparedSurface::signedDistance(const Vec3& p) const {
    double most = -std::numeric_limits<double>::infinity();
    for (const Bound& bound : bounds) {
        const double distance = bound.tree->signedDistance(p);
        most = std::max(most, bound.isHollow ? -distance : distance);
    }
    return most;
}

std::vector<SurfacePoint> sampled(const geometry::TriangleMesh& mesh, std::size_t points) {
    std::vector<double> upTo(mesh.triangles.size());
    std::vector<Vec3> normals(mesh.triangles.size());
    double area = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        normals[t] = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
        area += 0.5 * normals[t].norm();
        upTo[t] = area;
    }
    std::vector<SurfacePoint> out;
    if (!(area > 0.0)) return out;
    std::size_t t = 0;
    for (std::size_t n = 0; n < points; ++n) {
        const double at = area * (static_cast<double>(n) + 0.5) / static_cast<double>(points);
        while (t + 1 < upTo.size() && upTo[t] < at)
            ++t;
        if (!(normals[t].norm() > 0.0)) continue;
        // Two irrational steps scatter the points in their triangles.
        double u = std::fmod(static_cast<double>(n) * 0.7548776662466927, 1.0);
        double v = std::fmod(static_cast<double>(n) * 0.5698402909980532, 1.0);
        if (u + v > 1.0) {
            u = 1.0 - u;
            v = 1.0 - v;
        }
        const auto& [a, b, c] = mesh.triangles[t];
        out.push_back(
            {(1.0 - u - v) * mesh.vertices[a] + u * mesh.vertices[b] + v * mesh.vertices[c], normals[t].normalized()});
    }
    return out;
}

ToothTruth::ToothTruth(const cases::Case& toothCase, const phantom::Image& image)
    : image_(image), voxelMm_(image.volume.grid.spacingMm.x()) {
    std::vector<const cases::Part*> parts;
    for (const cases::Part& part : toothCase.parts)
        parts.push_back(&part);
    if (image.filling) parts.push_back(&*image.filling);
    const geometry::TriangleMesh outer = geometry::transformed(toothCase.outer, image.toothInScan);
    outer_ = std::make_unique<geometry::TriangleTree>(outer);
    std::vector<geometry::TriangleMesh> meshes;
    for (const cases::Part* part : parts) {
        meshes.push_back(geometry::transformed(part->mesh, image.toothInScan));
        trees_.push_back(std::make_unique<geometry::TriangleTree>(meshes.back()));
        parts_.push_back({trees_.back().get(), part->tissue, part->priority});
    }
    tissues_ = std::make_unique<field::PartTissues>(parts_);

    surfaces_[indexOf(SolidKind::outer)] = compared(outer);
    for (std::size_t n = 0; n < parts.size(); ++n)
        for (const SolidKind kind : {SolidKind::enamel, SolidKind::dentine, SolidKind::pulp, SolidKind::caries})
            if (parts[n]->tissue == (kind == SolidKind::enamel    ? Tissue::enamel
                                     : kind == SolidKind::dentine ? Tissue::dentine
                                     : kind == SolidKind::pulp    ? Tissue::pulp
                                                                  : Tissue::caries))
                surfaces_[indexOf(kind)] = compared(meshes[n]);
    for (const SolidKind kind : kSolidKinds) {
        ComparedSurface& surface = surfaces_[indexOf(kind)];
        surface.points = filtered(surface.points, [&](const SurfacePoint& p) {
            return !isHidden(kind, p.atMm) && holds(kind, tissueAt(p.atMm - kLookMm * p.normal)) &&
                   !holds(kind, tissueAt(p.atMm + kLookMm * p.normal));
        });
    }
}

Tissue ToothTruth::tissueAt(const Vec3& p) const {
    return outer_->signedDistance(p) < 0.0 ? tissues_->at(p) : Tissue::none;
}

bool ToothTruth::isHidden(SolidKind kind, const Vec3& p) const {
    for (const field::PartSurface& part : parts_) {
        const bool hides = part.tissue == Tissue::restoration ||
                           (part.tissue == Tissue::caries && kind != SolidKind::caries && kind != SolidKind::outer);
        if (hides && part.tree->signedDistance(p) < 2.0 * voxelMm_) return true;
    }
    return false;
}

std::array<std::optional<SolidErrors>, kSolidKinds.size()> ToothTruth::errors(const ComparedSurfaces& found) const {
    std::array<std::optional<SolidErrors>, kSolidKinds.size()> all;
    for (const SolidKind kind : kSolidKinds) {
        const ComparedSurface& truth = surfaces_[indexOf(kind)];
        const ComparedSurface& other = found[indexOf(kind)];
        if (truth.bounds.empty() || other.bounds.empty()) continue;
        const std::vector<SurfacePoint> seen =
            filtered(other.points, [&](const SurfacePoint& p) { return !isHidden(kind, p.atMm); });
        all[indexOf(kind)] = {errorOf(truth.points, other, -1.0), errorOf(seen, truth, 1.0)};
    }
    return all;
}

std::array<double, cases::kTissueCount> ToothTruth::dice(const segmentation::Region& region) const {
    const volume::Grid &grid = image_.truth.grid, &own = region.grid;
    using Counts = std::array<std::size_t, 256>;
    struct Slice {
        Counts truth{}, found{}, both{};
    };
    std::vector<Slice> slices(static_cast<std::size_t>(grid.size[2]));
    const auto surely = static_cast<float>(own.spacingMm.maxCoeff());
    const auto inside = [&](const segmentation::Solid& solid, const Vec3& p, std::size_t nearest) {
        const float there = solid.distanceMm[nearest];
        return std::abs(there) > surely ? there < 0.0f : between(own, solid.distanceMm, p) < 0.0f;
    };
    core::parallelFor(slices.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
            for (int j = 0; j < grid.size[1]; ++j)
                for (int i = 0; i < grid.size[0]; ++i) {
                    std::uint8_t truth = image_.truth.values[grid.index(i, j, static_cast<int>(k))];
                    if (truth > 5) truth = 0;  // The scenery is nobody's tooth.
                    const Vec3 p = own.toVoxels(grid.toMm(Vec3(i, j, static_cast<double>(k))));
                    std::uint8_t found = 0;
                    bool isIn = true;
                    std::array<int, 3> at{};
                    for (int a = 0; a < 3; ++a) {
                        at[static_cast<std::size_t>(a)] = static_cast<int>(std::lround(p[a]));
                        isIn = isIn && p[a] >= 0.0 && p[a] <= own.size[static_cast<std::size_t>(a)] - 1;
                    }
                    if (isIn) {
                        const std::size_t nearest = own.index(at[0], at[1], at[2]);
                        if (inside(region.outer, p, nearest)) {
                            found = phantom::labelOf(Tissue::enamel);
                            for (const segmentation::Solid& solid : region.solids)
                                if (inside(solid, p, nearest)) found = phantom::labelOf(solid.tissue);
                        }
                    }
                    ++slices[k].truth[truth];
                    ++slices[k].found[found];
                    if (truth == found) ++slices[k].both[truth];
                }
    });
    std::array<double, cases::kTissueCount> dice{};
    for (std::size_t t = 1; t < dice.size(); ++t) {
        const std::uint8_t label = phantom::labelOf(static_cast<Tissue>(t));
        double truth = 0, found = 0, both = 0;
        for (const Slice& slice : slices) {
            truth += static_cast<double>(slice.truth[label]);
            found += static_cast<double>(slice.found[label]);
            both += static_cast<double>(slice.both[label]);
        }
        dice[t] = truth + found > 0.0 ? 2.0 * both / (truth + found) : 0.0;
    }
    return dice;
}

ComparedSurfaces surfacesOf(const segmentation::Region& region) {
    ComparedSurfaces all;
    all[indexOf(SolidKind::outer)] = compared(zeroOf(region.grid, region.outer.distanceMm));
    std::vector<float> enamel = region.outer.distanceMm;
    for (const segmentation::Solid& solid : region.solids) {
        for (std::size_t n = 0; n < enamel.size(); ++n)
            enamel[n] = std::max(enamel[n], -solid.distanceMm[n]);
        if (solid.tissue == Tissue::restoration) continue;
        all[indexOf(kindOf(solid.tissue))] = compared(zeroOf(region.grid, solid.distanceMm));
    }
    all[indexOf(SolidKind::enamel)] = compared(zeroOf(region.grid, std::move(enamel)));
    return all;
}

ComparedSurfaces surfacesOf(const surfacing::Surfaces& surfaces) {
    ComparedSurfaces all;
    const ComparedSurface outer = compared(surfaces.outer.mesh);
    all[indexOf(SolidKind::outer)] = outer;
    ComparedSurface& enamel = all[indexOf(SolidKind::enamel)] = outer;
    for (const surfacing::Surface& surface : surfaces.tissues) {
        if (surface.tissue == Tissue::enamel) continue;
        const ComparedSurface whole = compared(surface.mesh);
        if (whole.bounds.empty()) continue;
        // What stands out of the tooth is bounded by the tooth's own surface; the points on that one are found there.
        ComparedSurface own = whole;
        own.bounds.push_back(outer.bounds[0]);
        for (SurfacePoint& p : own.points) {
            geometry::NearestPoint nearest;
            if (outer.bounds[0].tree->signedDistance(p.atMm, &nearest) > 0.0) p.atMm = nearest.pointMm;
        }
        // Enamel: outside of all of them. A point where two surfaces run together bounds no enamel.
        const double gap = std::max(surfaces.leastGapMm, 1e-3);
        enamel.points =
            filtered(enamel.points, [&](const SurfacePoint& p) { return whole.signedDistance(p.atMm) > gap; });
        for (SurfacePoint p :
             filtered(whole.points, [&](const SurfacePoint& q) { return enamel.signedDistance(q.atMm) < -gap; })) {
            p.normal = -p.normal;
            enamel.points.push_back(p);
        }
        enamel.bounds.push_back({whole.bounds[0].tree, true});
        if (surface.tissue != Tissue::restoration) all[indexOf(kindOf(surface.tissue))] = std::move(own);
    }
    return all;
}

std::array<double, cases::kTissueCount> volumesOf(const surfacing::Surfaces& surfaces) {
    cases::Case nested;
    nested.name = "found";
    nested.outer = surfaces.outer.mesh;
    int priority = 0;
    nested.parts.push_back({"enamel", Tissue::enamel, priority, surfaces.outer.mesh});
    for (const surfacing::Surface& surface : surfaces.tissues)
        nested.parts.push_back({"tissue", surface.tissue, ++priority, surface.mesh});
    return phantom::volumesMm3(nested);
}

}  // namespace handpiece::bench
