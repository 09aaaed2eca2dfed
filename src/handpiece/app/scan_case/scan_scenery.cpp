// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/scan_case/scan_scenery.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/decimate.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/base/geometry/mesh_edges.h"
#include "handpiece/base/geometry/triangle_tree.h"

namespace handpiece::scan_case {
namespace {

using core::Vec3;

constexpr double kCoarsestMm = 0.3;    ///< between samples, unless the scan is coarser
constexpr double kGapMm = 0.15;        ///< kept around the tooth itself
constexpr double kMinVolumeMm3 = 4.0;  ///< smaller pieces are noise
constexpr std::size_t kMaxFaces = 40000, kFewestFaces = 200, kMaxPieces = 12;
constexpr std::uint8_t kNeighbourLabel = 8;  ///< another tooth as a whole, where labels tell it

/// Trilinear, `outside` beyond the border.
template <class Values>
double sample(const volume::Grid& grid, const Values& values, const Vec3& mm, double outside) {
    const Vec3 at = grid.toVoxels(mm);
    std::array<int, 3> low{};
    std::array<double, 3> part{};
    for (std::size_t a = 0; a < 3; ++a) {
        const double x = at[static_cast<Eigen::Index>(a)];
        if (!(x >= 0.0 && x <= grid.size[a] - 1.0)) return outside;
        low[a] = std::min(static_cast<int>(x), std::max(0, grid.size[a] - 2));
        part[a] = x - low[a];
    }
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1.0;
        std::array<int, 3> ijk = low;
        for (std::size_t a = 0; a < 3; ++a) {
            const bool isHigh = (corner >> a & 1) != 0;
            weight *= isHigh ? part[a] : 1.0 - part[a];
            if (isHigh) ijk[a] = std::min(ijk[a] + 1, grid.size[a] - 1);
        }
        if (weight > 0.0) sum += weight * values(grid.index(ijk[0], ijk[1], ijk[2]));
    }
    return sum;
}

/// The pieces of a mesh that are large enough, the largest first, together with at most about kMaxFaces. Pieces of
/// their own, so that a view can leave out one that stands in its way.
std::vector<geometry::TriangleMesh> piecesOf(const geometry::TriangleMesh& mesh) {
    if (mesh.triangles.empty()) return {};
    const geometry::Shells shells = geometry::shellsOf(mesh, geometry::MeshEdges(mesh));
    const std::vector<double> volumes = geometry::shellVolumesMm3(mesh, shells);
    std::vector<std::uint32_t> order;
    for (std::uint32_t s = 0; s < shells.count; ++s)
        if (volumes[s] > kMinVolumeMm3) order.push_back(s);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t x, std::uint32_t y) { return volumes[x] > volumes[y]; });
    if (order.size() > kMaxPieces) order.resize(kMaxPieces);
    std::vector<std::size_t> place(shells.count, order.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        place[order[i]] = i;
    std::vector<geometry::TriangleMesh> pieces(order.size());
    std::vector<std::uint32_t> number(mesh.vertices.size(), geometry::kNoTriangle);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (place[shells.ofFace[t]] == order.size()) continue;
        geometry::TriangleMesh& piece = pieces[place[shells.ofFace[t]]];
        geometry::Triangle made{};
        for (std::size_t k = 0; k < 3; ++k) {
            std::uint32_t& n = number[mesh.triangles[t][k]];
            if (n == geometry::kNoTriangle) {
                n = static_cast<std::uint32_t>(piece.vertices.size());
                piece.vertices.push_back(mesh.vertices[mesh.triangles[t][k]]);
            }
            made[k] = n;
        }
        piece.triangles.push_back(made);
    }
    std::size_t faces = 0;
    for (const geometry::TriangleMesh& piece : pieces)
        faces += piece.triangles.size();
    if (faces > kMaxFaces)
        for (geometry::TriangleMesh& piece : pieces)
            piece = geometry::decimate(piece,
                                       std::max<std::size_t>(kFewestFaces, kMaxFaces * piece.triangles.size() / faces))
                        .mesh;
    return pieces;
}

/// The surface where `outsideMm` (about a distance near zero, negative in the thing) is zero, near the tooth but
/// apart from it.
std::vector<geometry::TriangleMesh> around(const volume::Grid& scan, const geometry::TriangleMesh& outer,
                                           double reachMm, const std::function<double(const Vec3&)>& outsideMm,
                                           const core::Progress& progress) {
    const geometry::TriangleTree tree(outer);
    geometry::ScalarGrid grid;
    grid.spacingMm = std::max(kCoarsestMm, scan.spacingMm.maxCoeff());
    const core::Box box = outer.bounds().grown(reachMm);
    grid.originMm = box.min;
    for (std::size_t a = 0; a < 3; ++a)
        grid.nodes[a] = static_cast<std::uint32_t>(box.size()[static_cast<Eigen::Index>(a)] / grid.spacingMm) + 2;
    const std::size_t slice = std::size_t{grid.nodes[0]} * grid.nodes[1];
    std::vector<float> values(slice * grid.nodes[2]);
    core::parallelFor(grid.nodes[2], 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            for (std::size_t ij = 0; ij < slice; ++ij) {
                const Vec3 p = grid.originMm + grid.spacingMm * Vec3(static_cast<double>(ij % grid.nodes[0]),
                                                                     static_cast<double>(ij / grid.nodes[0]),
                                                                     static_cast<double>(k));
                double value = outsideMm(p);
                if (value < 0.0) {
                    const double toTooth = tree.signedDistance(p);
                    value = std::max({value, kGapMm - toTooth, toTooth - reachMm});
                }
                values[k * slice + ij] = static_cast<float>(value);
            }
            core::report(progress, 0.8 * static_cast<double>(k) / grid.nodes[2]);
        }
    });
    grid.values = values;
    return piecesOf(geometry::isosurface(grid, core::part(progress, 0.8, 1.0)));
}

void add(std::vector<cases::Part>& parts, const char* name, cases::Tissue tissue,
         std::vector<geometry::TriangleMesh> pieces) {
    for (std::size_t i = 0; i < pieces.size(); ++i)
        parts.push_back(
            {fmt::format("{} {}", name, i + 1), tissue, cases::properties(tissue).priority, std::move(pieces[i])});
}

}  // namespace

std::vector<cases::Part> sceneryOf(const volume::Volume& volume, const segmentation::Thresholds& thresholds,
                                   const geometry::TriangleMesh& outer, double reachMm,
                                   const core::Progress& progress) {
    const double from = static_cast<double>(thresholds.toothFrom);
    const double step = std::max(1e-6, std::abs(from - static_cast<double>(thresholds.outside)));
    const double voxelMm = volume.grid.spacingMm.maxCoeff();
    std::vector<cases::Part> parts;
    add(parts, "neighbour or bone", cases::Tissue::neighbour,
        around(
            volume.grid, outer, reachMm,
            [&](const Vec3& p) {
                const double value = sample(
                    volume.grid, [&](std::size_t i) { return static_cast<double>(volume.values[i]); }, p,
                    static_cast<double>(thresholds.outside));
                return voxelMm * std::clamp((from - value) / step, -1.0, 1.0);
            },
            progress));
    return parts;
}

std::vector<cases::Part> sceneryOf(const volume::Labels& labels, const geometry::TriangleMesh& outer, double reachMm,
                                   const core::Progress& progress) {
    struct Kind {
        const char* name;
        cases::Tissue tissue;
        std::uint8_t from, to;
    };
    constexpr std::array<Kind, 3> kKinds{{{"neighbour", cases::Tissue::neighbour, 1, 5},
                                          {"bone", cases::Tissue::bone, 6, 6},
                                          {"gum", cases::Tissue::gum, 7, 7}}};
    const double voxelMm = labels.grid.spacingMm.maxCoeff();
    std::vector<cases::Part> parts;
    double done = 0.0;
    for (const Kind& kind : kKinds) {
        const auto isIt = [&](std::size_t i) {
            const std::uint8_t label = labels.values[i];
            const bool isOther = label == kNeighbourLabel && kind.tissue == cases::Tissue::neighbour;
            return (label >= kind.from && label <= kind.to) || isOther ? 1.0 : 0.0;
        };
        add(parts, kind.name, kind.tissue,
            around(
                labels.grid, outer, reachMm,
                [&](const Vec3& p) { return 2.0 * voxelMm * (0.5 - sample(labels.grid, isIt, p, 0.0)); },
                core::part(progress, done, done + 1.0 / 3.0)));
        done += 1.0 / 3.0;
    }
    return parts;
}

}  // namespace handpiece::scan_case
