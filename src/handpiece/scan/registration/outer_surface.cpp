// SPDX-License-Identifier: Apache-2.0
// A registered crown as the tooth's outer surface: two distances blended on a grid, so that the result is closed and
// two-manifold whatever the crown is like.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/base/geometry/mesh_edges.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/scan/registration/registration.h"

namespace handpiece::registration {
namespace {

using core::Vec3;
using geometry::TriangleMesh;
using geometry::TriangleTree;

constexpr double kFinestMm = 0.05, kCoarsestMm = 0.15;  ///< of the grid
constexpr double kRimBlendMm = 0.8;                     ///< from none of the crown to all of it, along its rim
constexpr double kBlendMm = 0.3;                        ///< the same around a place where the two do not agree
constexpr double kMendMm = 0.6;                         ///< around such a place the surface may be evened out
constexpr int kMaxMending = 64;                         ///< passes over the grid
constexpr double kMinLayerMm = 0.01;                    ///< left around a tissue that the crown would bare
constexpr double kMinCosine = 0.1;                      ///< of the normals where the two agree
constexpr double kFollowMm = 0.3;                       ///< tissues this near below the surface move with it
constexpr int kBlock = 8;

double smoothStep(double t) {
    const double x = std::clamp(t, 0.0, 1.0);
    return x * x * (3.0 - 2.0 * x);
}

Vec3 pseudonormal(const TriangleTree& tree, const geometry::NearestPoint& n) {
    const float* v = tree.pseudonormals().data() + (std::size_t{n.triangle} * 7 + n.feature) * 3;
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

double meanEdge(const TriangleMesh& mesh) {
    double sum = 0.0;
    for (const geometry::Triangle& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            sum += (mesh.vertices[t[k]] - mesh.vertices[t[(k + 1) % 3]]).norm();
    return sum / (3.0 * static_cast<double>(mesh.triangles.size()));
}

/// Vertices as triangles without area: a tree of points.
std::unique_ptr<TriangleTree> treeOf(const std::vector<Vec3>& vertices, const std::vector<std::uint8_t>& which) {
    TriangleMesh points;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (!which[i]) continue;
        const auto index = static_cast<std::uint32_t>(points.vertices.size());
        points.vertices.push_back(vertices[i]);
        points.triangles.push_back({index, index, index});
    }
    return points.triangles.empty() ? nullptr : std::make_unique<TriangleTree>(points);
}

/// The two surfaces and how far each counts.
class Blend {
  public:
    Blend(const TriangleMesh& ct, const TriangleMesh& crown, double reachMm)
        : ct_(ct), crown_(crown), reachMm_(reachMm) {
        const std::size_t n = crown.vertices.size();
        std::vector<std::uint8_t> isRim(n, 0), differs(n, 0);
        std::vector<Vec3> normals(n, Vec3::Zero());
        std::vector<double> areas(n, 0.0);
        for (const geometry::Triangle& t : crown.triangles) {
            const Vec3 normal =
                0.5 * (crown.vertices[t[1]] - crown.vertices[t[0]]).cross(crown.vertices[t[2]] - crown.vertices[t[0]]);
            for (const std::uint32_t v : t) {
                normals[v] += normal;
                areas[v] += normal.norm() / 3.0;
            }
        }
        const geometry::MeshEdges edges(crown);
        for (const auto& e : edges.edges())
            if (e.count != 2) isRim[e.low] = isRim[e.high] = 1;
        core::parallelFor(n, 256, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (!(areas[i] > 0.0)) continue;
                const auto nearest = ct_.nearest(crown.vertices[i], reachMm);
                differs[i] = nearest.triangle == geometry::kNoTriangle ||
                             pseudonormal(ct_, nearest).dot(normals[i].normalized()) < kMinCosine;
            }
        });
        // A few vertices with wild normals are noise; a patch of them is another surface.
        std::vector<std::uint32_t> around(n, 0), with(n, 0);
        for (const auto& e : edges.edges()) {
            ++around[e.low], ++around[e.high];
            with[e.low] += differs[e.high], with[e.high] += differs[e.low];
        }
        double good = 0.0, all = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            if (2 * with[i] < around[i]) differs[i] = 0;
            all += areas[i];
            if (!differs[i]) good += areas[i];
        }
        agreeing_ = all > 0.0 ? good / all : 0.0;
        rim_ = treeOf(crown.vertices, isRim);
        differing_ = treeOf(crown.vertices, differs);
    }

    [[nodiscard]] double agreeing() const { return agreeing_; }
    [[nodiscard]] const TriangleTree& ct() const { return ct_; }
    /// Where the surface may be evened out: 1 near places of the crown that differ, 0 elsewhere.
    [[nodiscard]] double mending(const Vec3& p) const {
        return differing_ ? 1.0 - awayFrom(differing_.get(), p, kMendMm, kMendMm) : 0.0;
    }

    /// Signed distance of the blended surface near it, negative inside; `weight` of the crown.
    [[nodiscard]] double value(const Vec3& p, double ctMm, double& weight) const {
        weight = weightAt(p);
        if (!(weight > 0.0)) return ctMm;
        return (1.0 - weight) * ctMm + weight * crown_.signedDistance(p);
    }

  private:
    /// 0 at the points of a tree, or within `fromMm` of them; 1 from overMm farther.
    [[nodiscard]] static double awayFrom(const TriangleTree* tree, const Vec3& p, double fromMm, double overMm) {
        if (tree == nullptr) return 1.0;
        const geometry::NearestPoint n = tree->nearest(p, fromMm + overMm);
        return n.triangle == geometry::kNoTriangle ? 1.0 : smoothStep((n.distanceMm - fromMm) / overMm);
    }
    [[nodiscard]] double weightAt(const Vec3& p) const {
        const double farMm = 1.5 * reachMm_;
        const geometry::NearestPoint n = crown_.nearest(p, farMm);
        if (n.triangle == geometry::kNoTriangle) return 0.0;
        const double near = 1.0 - smoothStep((n.distanceMm - reachMm_) / (farMm - reachMm_));
        // Nothing counts whose nearest place may be the rim: on which side of the crown it lies would be a guess.
        const double within = awayFrom(rim_.get(), p, farMm, kRimBlendMm);
        return within > 0.0 ? near * within * awayFrom(differing_.get(), p, 0.0, kBlendMm) : 0.0;
    }

    TriangleTree ct_, crown_;
    double reachMm_, agreeing_ = 0.0;
    std::unique_ptr<TriangleTree> rim_, differing_;  ///< vertices; null where there are none
};

/// The surface where a function is zero, on a regular grid.
class Sampled {
  public:
    /// `newValue(p, ct)` within bandMm of the tree's surface, its own distance elsewhere; `mending` says where even()
    /// works.
    template <class Value, class Mending>
    Sampled(const TriangleTree& ct, const core::Box& box, double h, double bandMm, const Value& newValue,
            const Mending& mending, const core::Progress& progress) {
        grid_.originMm = box.min;
        grid_.spacingMm = h;
        std::array<std::size_t, 3> blocks{};
        for (std::size_t a = 0; a < 3; ++a) {
            blocks[a] = static_cast<std::size_t>(std::ceil(box.size()[static_cast<Eigen::Index>(a)] / h / kBlock)) + 1;
            nodes_[a] = blocks[a] * kBlock;
            grid_.nodes[a] = static_cast<std::uint32_t>(nodes_[a]);
        }
        values_.resize(nodes_[0] * nodes_[1] * nodes_[2]);
        mending_.resize(values_.size(), 0.0f);
        const double halfBlock = 0.5 * std::sqrt(3.0) * kBlock * h;
        const std::size_t count = blocks[0] * blocks[1] * blocks[2];
        core::parallelFor(count, 8, [&](std::size_t begin, std::size_t end) {
            for (std::size_t block = begin; block < end; ++block) {
                const std::array<std::size_t, 3> first{kBlock * (block % blocks[0]),
                                                       kBlock * (block / blocks[0] % blocks[1]),
                                                       kBlock * (block / blocks[0] / blocks[1])};
                const auto node = [&](std::size_t i, std::size_t j, std::size_t k) {
                    return Vec3(box.min + h * Vec3(static_cast<double>(first[0] + i), static_cast<double>(first[1] + j),
                                                   static_cast<double>(first[2] + k)));
                };
                geometry::NearestPoint seed;
                const double middleMm =
                    ct.signedDistance(0.5 * (node(0, 0, 0) + node(kBlock - 1, kBlock - 1, kBlock - 1)), &seed);
                const bool isFar = std::abs(middleMm) > halfBlock + bandMm;
                for (std::size_t k = 0; k < kBlock; ++k)
                    for (std::size_t j = 0; j < kBlock; ++j)
                        for (std::size_t i = 0; i < kBlock; ++i) {
                            const std::size_t at =
                                ((first[2] + k) * nodes_[1] + first[1] + j) * nodes_[0] + first[0] + i;
                            values_[at] = static_cast<float>(middleMm > 0.0 ? bandMm : -bandMm);
                            if (isFar) continue;
                            const Vec3 p = node(i, j, k);
                            const double ctMm = ct.signedDistance(p, nullptr, seed.triangle);
                            values_[at] = static_cast<float>(
                                std::clamp(std::abs(ctMm) < bandMm ? newValue(p, ctMm) : ctMm, -bandMm, bandMm));
                            if (std::abs(ctMm) < bandMm) mending_[at] = static_cast<float>(mending(p));
                        }
                core::report(progress, static_cast<double>(block) / static_cast<double>(count));
            }
        });
    }

    /// The largest shell of the surface; specks and bubbles are left out.
    [[nodiscard]] TriangleMesh surface() {
        grid_.values = values_;
        TriangleMesh mesh = geometry::isosurface(grid_);
        const geometry::Shells shells = geometry::shellsOf(mesh, geometry::MeshEdges(mesh));
        if (shells.count < 2) return mesh;
        const std::vector<double> volumes = geometry::shellVolumesMm3(mesh, shells);
        const auto largest =
            static_cast<std::uint32_t>(std::max_element(volumes.begin(), volumes.end()) - volumes.begin());
        TriangleMesh kept;
        std::vector<std::uint32_t> number(mesh.vertices.size(), geometry::kNoTriangle);
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            if (shells.ofFace[t] != largest) continue;
            geometry::Triangle made{};
            for (std::size_t k = 0; k < 3; ++k) {
                std::uint32_t& n = number[mesh.triangles[t][k]];
                if (n == geometry::kNoTriangle) {
                    n = static_cast<std::uint32_t>(kept.vertices.size());
                    kept.vertices.push_back(mesh.vertices[mesh.triangles[t][k]]);
                }
                made[k] = n;
            }
            kept.triangles.push_back(made);
        }
        return kept;
    }

    /// Each value nearer to the mean of its six neighbours, as far as it may be mended.
    void even() {
        const std::vector<float> before = values_;
        const std::size_t row = nodes_[0], slice = nodes_[0] * nodes_[1];
        core::parallelFor(nodes_[2] - 2, 4, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin + 1; k < end + 1; ++k)
                for (std::size_t j = 1; j + 1 < nodes_[1]; ++j)
                    for (std::size_t i = 1; i + 1 < nodes_[0]; ++i) {
                        const std::size_t at = k * slice + j * row + i;
                        if (!(mending_[at] > 0.0f)) continue;
                        const float mean = (before[at - 1] + before[at + 1] + before[at - row] + before[at + row] +
                                            before[at - slice] + before[at + slice]) /
                                           6.0f;
                        values_[at] += mending_[at] * (mean - before[at]);
                    }
        });
    }

  private:
    geometry::ScalarGrid grid_;
    std::array<std::size_t, 3> nodes_{};
    std::vector<float> values_, mending_;
};

/// The mesh with its vertices moved; by less where it would cross itself, as where both walls of a fissure pull.
TriangleMesh followed(const TriangleMesh& mesh, std::vector<Vec3> moves) {
    if (std::all_of(moves.begin(), moves.end(), [](const Vec3& m) { return m.isZero(); })) return mesh;
    const geometry::MeshEdges edges(mesh);
    constexpr int kEvening = 4;
    for (int pass = 0; pass < kEvening; ++pass) {
        std::vector<Vec3> sums(moves);
        std::vector<double> counts(moves.size(), 1.0);
        for (const auto& e : edges.edges()) {
            sums[e.low] += moves[e.high];
            sums[e.high] += moves[e.low];
            counts[e.low] += 1.0;
            counts[e.high] += 1.0;
        }
        for (std::size_t i = 0; i < moves.size(); ++i)
            moves[i] = sums[i] / counts[i];
    }
    constexpr double kMinShare = 0.1;
    for (double share = 1.0; share > kMinShare; share *= 0.5) {
        TriangleMesh moved = mesh;
        for (std::size_t i = 0; i < moves.size(); ++i)
            moved.vertices[i] += share * moves[i];
        if (geometry::selfIntersections(moved).empty()) return moved;
    }
    return mesh;
}

}  // namespace

surfacing::Surfaces withOuterSurface(const surfacing::Surfaces& surfaces, const TriangleMesh& crown, double reachMm,
                                     const core::Progress& progress) {
    if (surfaces.outer.mesh.triangles.empty() || crown.triangles.empty())
        throw core::Error("a surface is empty", "intraoral scan", "give meshes with triangles");
    if (!(reachMm > 0.0 && reachMm <= 2.0))
        throw core::Error("the reach must lie above 0 and not above 2 mm", fmt::format("{}", reachMm),
                          "half a millimetre is usual");
    const TriangleMesh& outer = surfaces.outer.mesh;
    const Blend blend(outer, crown, reachMm);
    if (blend.agreeing() < 0.05)
        throw core::Error(fmt::format("only {:.0f} % of the crown lies within {:.2f} mm of the tooth",
                                      100.0 * blend.agreeing(), reachMm),
                          "intraoral scan", "register it first, or give a larger reach");
    std::vector<TriangleTree> tissues;
    for (const surfacing::Surface& s : surfaces.tissues)
        if (!s.mesh.triangles.empty()) tissues.emplace_back(s.mesh);
    const double layer = std::max(surfaces.leastGapMm, kMinLayerMm);
    /// The new surface, negative inside; never within a layer of a tissue that the old one covered.
    const auto newOuter = [&](const Vec3& p, double ctMm) {
        double weight = 0.0;
        const double blended = blend.value(p, ctMm, weight);
        if (!(weight > 0.0)) return blended;
        double tissue = 1e300;
        for (const TriangleTree& tree : tissues)
            tissue = std::min(tissue, tree.signedDistance(p));
        return std::min(blended, std::max(tissue - layer, ctMm));
    };

    const double h = std::clamp(std::min(meanEdge(outer), meanEdge(crown)), kFinestMm, kCoarsestMm);
    const core::Box box = outer.bounds().grown(reachMm + 3.0 * h);
    surfacing::Surfaces result = surfaces;
    Sampled sampled(
        blend.ct(), box, h, reachMm + 2.0 * h, newOuter, [&](const Vec3& p) { return blend.mending(p); },
        core::part(progress, 0.0, 0.8));
    // Where the two differ (a fissure that the CT does not resolve) bridges and tunnels may be left between them: they
    // are evened out until the tooth has no more holes through it than before.
    const auto genusOf = [](const TriangleMesh& mesh) { return geometry::inspect(mesh).genus.value_or(1 << 20); };
    const auto genus = genusOf(outer);
    result.outer.mesh = sampled.surface();
    for (int passes = 0, next = 1; genusOf(result.outer.mesh) > genus; next *= 2) {
        if (passes >= kMaxMending)
            throw core::Error("the crown and the tooth differ so much that no surface joins them", "intraoral scan",
                              "cut away what is not this tooth, or give another reach");
        for (; passes < next; ++passes)
            sampled.even();
        result.outer.mesh = sampled.surface();
        core::report(progress, 0.85);
    }
    // Tissues at the surface (a lesion, roots at the neck) follow it, else a film of enamel would lie over them.
    for (surfacing::Surface& s : result.tissues) {
        std::vector<Vec3> moves(s.mesh.vertices.size(), Vec3::Zero());
        core::parallelFor(moves.size(), 256, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const Vec3& v = s.mesh.vertices[i];
                geometry::NearestPoint n;
                const double ctMm = blend.ct().signedDistance(v, &n);
                if (ctMm < -kFollowMm) continue;
                double weight = 0.0;
                const double moved = ctMm - blend.value(v, ctMm, weight);
                moves[i] = smoothStep(1.0 + std::min(ctMm, 0.0) / kFollowMm) * moved * pseudonormal(blend.ct(), n);
            }
        });
        s.mesh = followed(s.mesh, moves);
    }
    core::report(progress, 1.0);
    return result;
}

}  // namespace handpiece::registration
