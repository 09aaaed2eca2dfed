// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/scan_case/scan_scenery.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "handpiece/base/core/error.h"
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
constexpr double kJawStepMm = 0.5;
constexpr float kLeastTooth = 0.2f;          ///< share of a tooth in what is still beside it
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

/// What is felt must be one; what is not is still seen.
bool isSolid(const geometry::TriangleMesh& mesh) {
    try {
        cases::requireSolid(mesh, "scenery");
        return true;
    } catch (const core::Error&) {
        return false;
    }
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

namespace {

/// Evens samples out over about one of them.
void evenOut(std::vector<float>& values, const std::array<std::uint32_t, 3>& nodes) {
    const std::array<std::size_t, 3> stride{1, nodes[0], std::size_t{nodes[0]} * nodes[1]};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        core::parallelFor(nodes[u], 4, [&](std::size_t from, std::size_t to) {
            for (std::size_t a = from; a < to; ++a)
                for (std::size_t b = 0; b < nodes[v]; ++b) {
                    float before = 0.0f;
                    for (std::size_t i = 0; i < nodes[axis]; ++i) {
                        float& here = values[a * stride[u] + b * stride[v] + i * stride[axis]];
                        const float was = here;
                        const float after = i + 1 < nodes[axis] ? (&here)[stride[axis]] : was;
                        if (i == 0) before = was;
                        here = 0.25f * before + 0.5f * was + 0.25f * after;
                        before = was;
                    }
                }
        });
    }
}

/// What of a mouth's labels has this meaning, within a box of the scanner's axes.
std::vector<geometry::TriangleMesh> thingOf(const volume::Labels& labels, const segmentation::LabelKey& key,
                                            segmentation::LabelMeaning::What which, bool isApart, const core::Box& box,
                                            const core::Progress& progress) {
    using What = segmentation::LabelMeaning::What;
    geometry::ScalarGrid grid;
    grid.spacingMm = std::max(kJawStepMm, labels.grid.spacingMm.maxCoeff());
    grid.originMm = box.min;
    for (std::size_t a = 0; a < 3; ++a)
        grid.nodes[a] = static_cast<std::uint32_t>(box.size()[static_cast<Eigen::Index>(a)] / grid.spacingMm) + 2;
    const std::size_t slice = std::size_t{grid.nodes[0]} * grid.nodes[1];
    std::vector<float> thing(slice * grid.nodes[2]), teeth(isApart ? thing.size() : 0);
    const auto share = [&](const Vec3& p, const auto& is) {
        return static_cast<float>(sample(
            labels.grid, [&](std::size_t i) { return is(key.of[labels.values[i]].what) ? 1.0 : 0.0; }, p, 0.0));
    };
    core::parallelFor(grid.nodes[2], 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            for (std::size_t ij = 0; ij < slice; ++ij) {
                const Vec3 p = grid.originMm + grid.spacingMm * Vec3(static_cast<double>(ij % grid.nodes[0]),
                                                                     static_cast<double>(ij / grid.nodes[0]),
                                                                     static_cast<double>(k));
                thing[k * slice + ij] = share(p, [&](What what) { return what == which; });
                if (isApart)
                    teeth[k * slice + ij] =
                        share(p, [&](What what) { return what == What::tooth || what == What::pulp; });
            }
            core::report(progress, 0.8 * static_cast<double>(k) / grid.nodes[2]);
        }
    });
    evenOut(thing, grid.nodes);
    if (isApart) evenOut(teeth, grid.nodes);
    const auto scale = static_cast<float>(2.0 * grid.spacingMm);
    for (std::size_t n = 0; n < thing.size(); ++n) {
        thing[n] = scale * (0.5f - thing[n]);
        if (isApart) thing[n] = std::max(thing[n], scale * (teeth[n] - kLeastTooth));
    }
    grid.values = std::move(thing);
    return piecesOf(geometry::isosurface(grid, core::part(progress, 0.8, 1.0)));
}

}  // namespace

std::vector<cases::Part> jawsOf(const volume::Labels& labels, const segmentation::LabelKey& key,
                                const std::array<core::Box, 2>& teethOfJaws, double reachMm,
                                const core::Progress& progress) {
    using What = segmentation::LabelMeaning::What;
    struct Kind {
        const char* name;
        cases::Tissue tissue;
        What what;
        bool isApart, isFelt;
        int priority;
    };
    // The gingiva's solid goes on through the bone, as in a generated mouth.
    constexpr int kBonePriority = 6;
    const int gum = cases::properties(cases::Tissue::gum).priority,
              made = cases::properties(cases::Tissue::restoration).priority;
    const std::array<Kind, 4> kinds{{{"upper-bone", cases::Tissue::bone, What::upperBone, true, true, kBonePriority},
                                     {"lower-bone", cases::Tissue::bone, What::lowerBone, true, true, kBonePriority},
                                     {"gingiva", cases::Tissue::gum, What::gum, true, true, gum},
                                     {"prosthesis", cases::Tissue::restoration, What::prosthesis, false, false, made}}};
    core::Box both;
    for (const core::Box& box : teethOfJaws)
        if (!box.isEmpty()) {
            both.extend(box.min);
            both.extend(box.max);
        }
    std::array<bool, 256> isThere{};
    for (const std::uint8_t v : labels.values)
        isThere[v] = true;
    std::vector<cases::Part> parts;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        const Kind& kind = kinds[i];
        bool any = false;
        for (std::size_t v = 0; v < isThere.size(); ++v)
            any = any || (isThere[v] && key.of[v].what == kind.what);
        core::Box box = kind.what == What::upperBone   ? teethOfJaws[0]
                        : kind.what == What::lowerBone ? teethOfJaws[1]
                                                       : both;
        if (!any || box.isEmpty()) continue;
        std::vector<geometry::TriangleMesh> pieces =
            thingOf(labels, key, kind.what, kind.isApart, box.grown(reachMm),
                    core::part(progress, static_cast<double>(i) / 4.0, static_cast<double>(i + 1) / 4.0));
        for (std::size_t p = 0; p < pieces.size(); ++p) {
            cases::Part part{fmt::format("{} {}", kind.name, p + 1), kind.tissue, kind.priority, std::move(pieces[p])};
            part.isFelt = kind.isFelt && isSolid(part.mesh);
            parts.push_back(std::move(part));
        }
    }
    return parts;
}

}  // namespace handpiece::scan_case
