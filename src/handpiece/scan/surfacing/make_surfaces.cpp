// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/memory.h"
#include "handpiece/scan/surfacing/nesting.h"
#include "handpiece/scan/surfacing/smoothing.h"
#include "handpiece/scan/surfacing/solid_field.h"
#include "handpiece/scan/surfacing/surfaces.h"

namespace handpiece::surfacing {
namespace {

using cases::Tissue;
using core::Vec3;
using geometry::TriangleMesh;
using segmentation::Region;
using segmentation::Solid;

constexpr double kMinGapMm = 0.005;
constexpr int kRounds = 40;
constexpr std::int64_t kMaxHandles = 6;  ///< of canals that join and part; more are noise
constexpr int kMaxEvenings = 3;
constexpr double kMinShellVoxels = 20.0;
constexpr Smoothing kDistanceSmoothing{10, 0.5};    ///< reach in voxels
constexpr Smoothing kStaircaseSmoothing{40, 0.75};  ///< half a voxel is the step itself

void check(const Region& region) {
    const volume::Grid& grid = region.grid;
    const double h = grid.spacingMm.x();
    if (!(h > 0.0) || !(grid.spacingMm - Vec3::Constant(h)).isZero(1e-6 * h))
        throw core::Error(fmt::format("the region's voxels are {} x {} x {} mm, not cubes", grid.spacingMm.x(),
                                      grid.spacingMm.y(), grid.spacingMm.z()),
                          "surfaces", "segment the scan again");
    const auto fits = [&](const Solid& solid, std::string_view name) {
        if (solid.distanceMm.size() != grid.count())
            throw core::Error(fmt::format("{} values of {} do not fill a grid of {} x {} x {}", solid.distanceMm.size(),
                                          name, grid.size[0], grid.size[1], grid.size[2]),
                              "surfaces", "segment the scan again");
        if (const auto bad = std::find_if_not(solid.distanceMm.begin(), solid.distanceMm.end(),
                                              [](float v) { return std::isfinite(v); });
            bad != solid.distanceMm.end())
            throw core::Error(
                fmt::format("{} has a value that is no number, the {}th", name, bad - solid.distanceMm.begin() + 1),
                "surfaces", "segment the scan again");
    };
    fits(region.outer, "the tooth");
    for (const Solid& solid : region.solids)
        fits(solid, cases::properties(solid.tissue).name);
    if (std::none_of(region.outer.distanceMm.begin(), region.outer.distanceMm.end(), [](float v) { return v < 0.0f; }))
        throw core::Error("there is no tooth in the region", "surfaces",
                          "lower the tooth's threshold, or point at the tooth");
}

/// The shells that are a tissue and not a speck. Of the tooth and its dentine the largest alone, without hollows.
TriangleMesh withoutSpecks(const TriangleMesh& mesh, bool isWhole, double voxelMm3, std::size_t& left) {
    const Shells shells = shellsOf(mesh);
    std::vector<bool> keep(shells.volumeMm3.size());
    const auto largest = std::max_element(shells.volumeMm3.begin(), shells.volumeMm3.end());
    for (std::size_t s = 0; s < keep.size(); ++s) {
        keep[s] = isWhole ? s == static_cast<std::size_t>(largest - shells.volumeMm3.begin()) && *largest > 0.0
                          : std::abs(shells.volumeMm3[s]) >= kMinShellVoxels * voxelMm3;
        left += keep[s] ? 0 : 1;
    }
    if (std::all_of(keep.begin(), keep.end(), [](bool k) { return k; })) return mesh;
    return keptShells(mesh, shells, keep);
}

/// Tunnels through a surface of any number of shells.
std::int64_t handlesOf(const TriangleMesh& mesh) {
    const auto shells = static_cast<std::int64_t>(shellsOf(mesh).volumeMm3.size());
    return shells +
           (static_cast<std::int64_t>(mesh.triangles.size()) / 2 - static_cast<std::int64_t>(mesh.vertices.size())) / 2;
}

/// What of a solid is not in its surface.
struct LeftOut {
    std::size_t specks = 0;
    std::int64_t handles = 0;
    std::int64_t kept = 0;  ///< handles that stay
};

/// A solid's surface in the grid's own axes as marched out of its field, and how the field runs there.
struct Marched {
    TriangleMesh mesh;
    std::vector<Vec3> normals;  ///< empty: a staircase, of which they say nothing
    LeftOut left;
};
/// The field is left as evened out. `outer`: where the tooth's own surface lies, which no tissue leaves; null for that
/// surface itself and for what is held inside by other means.
Marched marched(std::vector<float>& field, const std::vector<float>* outer, const volume::Grid& grid, bool isWhole,
                const Settings& settings, const core::Progress& progress) {
    const double h = grid.spacingMm.x();
    Marched made;
    for (int evened = 0;; ++evened) {
        std::size_t specks = 0;
        made.mesh = withoutSpecks(fieldSurface(field, grid.size, h, progress), isWhole, h * h * h, specks);
        core::giveBackFreeMemory();
        if (evened == 0) made.left.specks = specks;
        if (made.mesh.triangles.empty() || !settings.smooth) return made;
        const std::int64_t handles = handlesOf(made.mesh);
        if (evened == 0) made.left.handles = handles;
        if (evened == kMaxEvenings || handles <= kMaxHandles) {
            made.left.handles -= handles;
            made.left.kept = handles;
            break;
        }
        evenOut(field, grid.size, h);
        // Its level went outwards as far as what is thin had to swell, out of the tooth as well.
        if (outer) keepInTooth(field, *outer, h);
    }
    if (!isStaircase(made.mesh, h)) made.normals = fieldNormals(field, grid.size, h, made.mesh);
    return made;
}

void smooth(Marched& made, const Settings& settings, double voxelMm, const core::Progress& progress) {
    if (made.mesh.triangles.empty() || !settings.smooth) return;
    Smoothing smoothing = made.normals.empty() ? kStaircaseSmoothing : kDistanceSmoothing;
    smoothing.reachMm *= voxelMm;
    smoothKeepingVolume(made.mesh, made.normals, smoothing, progress);
    made.normals = {};
    core::giveBackFreeMemory();
}

/// Keeps the pulp inside a surface around it; only where a solid's values say that the two come near.
void keepPulpInside(TriangleMesh& pulp, const TriangleMesh& around, const Region& region, const Solid& solid,
                    std::string_view name) {
    const volume::Grid& grid = region.grid;
    const double h = grid.spacingMm.x();
    std::vector<Vec3> close;
    for (const Vec3& p : pulp.vertices) {
        std::array<int, 3> at{};
        for (int a = 0; a < 3; ++a)
            at[static_cast<std::size_t>(a)] =
                std::clamp(static_cast<int>(std::lround(p[a] / h)), 0, grid.size[static_cast<std::size_t>(a)] - 1);
        if (solid.distanceMm[grid.index(at[0], at[1], at[2])] > -2.0 * h) close.push_back(p);
    }
    if (close.empty()) return;
    const TriangleMesh piece = facesNear(around, close, 3.0 * h);
    // Twice the gap at the vertices leaves it between the faces too.
    const std::vector<Bounds> inside(pulp.vertices.size(), {Bounds{}.low, -2.0 * kMinGapMm}),
        outside(piece.vertices.size(), {2.0 * kMinGapMm, Bounds{}.high});
    const Apart apart =
        holdApart(pulp, inside, piece, outside, std::max(h, 4.0 * kMinGapMm), 4.0 * h, kRounds, true, {});
    if (apart.failed > 0) {
        const Vec3 at = grid.originMm + grid.axes * apart.failedMm;
        throw core::Error(
            fmt::format("the pulp comes out of {} at ({:.2f}, {:.2f}, {:.2f}) mm", name, at.x(), at.y(), at.z()),
            "surfaces", "mark what is there as dentine, or close the pulp there");
    }
}

/// Smoothing moves the tooth's surface and a tissue's apart by a voxel at most: where that is much, what stands out by
/// more than a case allows is drawn back. Only where the values say that a tissue may is the tooth looked at.
void holdInTooth(Surfaces& made, std::vector<float>&& outer, const volume::Grid& grid) {
    const double h = grid.spacingMm.x();
    const auto mayStandOut = [&](const Vec3& p) {
        std::array<int, 3> at{};
        for (std::size_t a = 0; a < 3; ++a)
            at[a] = std::clamp(static_cast<int>(std::lround(p[static_cast<int>(a)] / h)), 0, grid.size[a] - 1);
        // Half a diagonal to the node, and what the tooth's own vertices were moved by.
        return static_cast<double>(outer[grid.index(at[0], at[1], at[2])]) > kMaxStandOutMm - 2.0 * h;
    };
    std::vector<Surface*> doubtful;
    for (Surface& tissue : made.tissues)
        if (tissue.tissue != Tissue::pulp &&
            std::any_of(tissue.mesh.vertices.begin(), tissue.mesh.vertices.end(), mayStandOut))
            doubtful.push_back(&tissue);
    std::vector<float>().swap(outer);  // the tree is as large
    if (doubtful.empty()) return;
    const geometry::TriangleTree tree(made.outer.mesh);
    for (Surface* tissue : doubtful) {
        const DrawnBack back = drawBack(tissue->mesh, tree);
        tissue->errorBoundMm += back.movedMm;
        if (back.moved > 0)
            made.notes.push_back(
                fmt::format("{}: drawn back by at most {:.3f} mm at {} {} where it stood out of the tooth",
                            cases::properties(tissue->tissue).name, back.movedMm, back.moved,
                            back.moved == 1 ? "place" : "places"));
    }
}

}  // namespace

Surfaces makeSurfaces(const Region& region, const Settings& settings, const core::Progress& progress) {
    check(region);
    core::report(progress, 0.0);
    Surfaces made;
    const double h = region.grid.spacingMm.x();
    made.leastGapMm = kMinGapMm;
    made.standOutMm = standOutMm(h);
    const double share = 0.95 / static_cast<double>(region.solids.size() + 1);
    const auto tell = [&](std::string_view name, const LeftOut& left) {
        if (left.specks > 0)
            made.notes.push_back(
                fmt::format("{}: {} loose {} left out", name, left.specks, left.specks == 1 ? "speck" : "specks"));
        if (left.handles > 0)
            made.notes.push_back(fmt::format("{}: {} {} of about a voxel closed", name, left.handles,
                                             left.handles == 1 ? "tunnel" : "tunnels"));
        if (left.kept > 0)
            made.notes.push_back(
                fmt::format("{}: {} wider than a voxel {} through it and {} kept (where canals join and part, or "
                            "noise: look at it)",
                            name, left.kept == 1 ? "a tunnel" : fmt::format("{} tunnels", left.kept),
                            left.kept == 1 ? "goes" : "go", left.kept == 1 ? "is" : "are"));
    };
    std::vector<float> outer = region.outer.distanceMm;
    {
        Marched tooth = marched(outer, nullptr, region.grid, true, settings, core::part(progress, 0.0, 0.4 * share));
        smooth(tooth, settings, h, core::part(progress, 0.4 * share, share));
        tell("the tooth", tooth.left);
        made.outer.mesh = std::move(tooth.mesh);
    }
    made.outer.isAuthored = region.outer.isAuthored;
    const Solid* dentine = nullptr;
    const Surface* dentineSurface = nullptr;
    made.tissues.reserve(region.solids.size());
    for (std::size_t i = 0; i < region.solids.size(); ++i) {
        const Solid& solid = region.solids[i];
        const double from = share * static_cast<double>(i + 1);
        Marched tissue;
        {
            std::vector<float> field = fieldOf(region, i, outer);
            tissue = marched(field, solid.tissue == Tissue::pulp ? nullptr : &outer, region.grid,
                             solid.tissue == Tissue::dentine, settings, core::part(progress, from, from + 0.4 * share));
        }
        smooth(tissue, settings, h, core::part(progress, from + 0.4 * share, from + share));
        TriangleMesh& mesh = tissue.mesh;
        if (mesh.triangles.empty()) {
            made.notes.push_back(fmt::format("{} is left out: nothing of it is as large as {} voxels",
                                             cases::properties(solid.tissue).name, kMinShellVoxels));
            continue;
        }
        tell(cases::properties(solid.tissue).name, tissue.left);
        if (solid.tissue == Tissue::pulp) {
            if (dentine) keepPulpInside(mesh, dentineSurface->mesh, region, *dentine, "the dentine");
            keepPulpInside(mesh, made.outer.mesh, region, region.outer, "the tooth");
        }
        made.tissues.push_back({solid.tissue, std::move(mesh), 0.0, solid.isAuthored});
        if (solid.tissue == Tissue::dentine) {
            dentine = &solid;
            dentineSurface = &made.tissues.back();
        }
    }
    holdInTooth(made, std::move(outer), region.grid);
    const auto place = [&](TriangleMesh& mesh) {
        for (Vec3& v : mesh.vertices)
            v = region.grid.originMm + region.grid.axes * v;
    };
    place(made.outer.mesh);
    for (Surface& tissue : made.tissues)
        place(tissue.mesh);
    core::report(progress, 1.0);
    return made;
}

}  // namespace handpiece::surfacing
