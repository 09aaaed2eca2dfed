// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/repair_base.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/geometry/clear_patch.h"
#include "handpiece/base/geometry/mesh_edges.h"
#include "handpiece/base/geometry/polygons.h"
#include "handpiece/base/geometry/repair_holes.h"
#include "handpiece/base/geometry/self_intersection.h"

namespace handpiece::geometry {
namespace {

using core::Vec3;
using Point = std::array<double, 2>;

class BaseMaker {
  public:
    /// `centreMm`: of the surface that ends at the loop.
    BaseMaker(TriangleMesh& mesh, Loop loop, const Vec3& centreMm, double depthMm)
        : mesh_(mesh), loop_(std::move(loop)), depthMm_(depthMm), taken_(edgesBetween(mesh, {loop_})) {
        Vec3 middle = Vec3::Zero(), area = Vec3::Zero();
        for (const std::uint32_t v : loop_)
            middle += mesh_.vertices[v] / static_cast<double>(loop_.size());
        for (std::size_t i = 0; i < loop_.size(); ++i)
            area += (mesh_.vertices[loop_[i]] - middle).cross(mesh_.vertices[loop_[(i + 1) % loop_.size()]] - middle);
        // A scan that came inside out is turned only when it is closed.
        sign_ = area.dot(centreMm - middle) > 0.0 ? -1.0 : 1.0;
        area_ = area.norm() > 0.0 ? (sign_ * area.normalized()).eval() : Vec3::Zero().eval();
    }

    /// Nothing where every base would cross something.
    std::optional<MadeBase> make() {
        // Straight down first, then to an outline without the border's dents. Where that does not do, under a part of
        // what closes the border without a base: what of it is too steep to look down, as the ends of an arch are, is
        // wall already.
        constexpr double kSteep[] = {0.2, 0.5, 0.8};  // cosines
        constexpr int kSmoothings[] = {0, 3, 10, 40};
        const std::vector<Vec3> directions = downwards();
        const auto standOn = [&](const Loop& border, const std::vector<Triangle>& kept, const Vec3& down) {
            std::optional<MadeBase> made;
            for (const int smoothings : kSmoothings)
                if (!made) made = stand(border, kept, down, smoothings);
            return made;
        };
        for (const Vec3& down : directions)
            if (auto made = standOn(loop_, {}, down)) return made;
        const auto patch = ClearPatch(mesh_, taken_, loop_).find();
        if (!patch) return std::nullopt;
        for (const double steep : kSteep)
            for (const Vec3& down : directions) {
                std::vector<Triangle> kept;
                const Loop rest = lookingDown(*patch, down, steep, kept);
                if (rest.empty()) continue;
                if (auto made = standOn(rest, kept, down)) return made;
            }
        return std::nullopt;
    }

  private:
    // The border of the largest part that looks down; what is left of the patch goes to `kept`. The patch has no vertex
    // inside, so each part has one border, and no vertex in it twice.
    [[nodiscard]] Loop lookingDown(const std::vector<Triangle>& patch, const Vec3& down, double steep,
                                   std::vector<Triangle>& kept) const {
        TriangleMesh low;
        low.vertices = mesh_.vertices;
        std::vector<double> shadowMm2;
        for (const Triangle& t : patch) {
            const Vec3& a = mesh_.vertices[t[0]];
            const Vec3 area = sign_ * (mesh_.vertices[t[1]] - a).cross(mesh_.vertices[t[2]] - a);
            if (!(area.dot(down) > steep * area.norm())) {
                kept.push_back(t);
                continue;
            }
            low.triangles.push_back(t);
            shadowMm2.push_back(area.dot(down));
        }
        if (low.triangles.empty()) return {};
        const Shells parts = shellsOf(low, MeshEdges(low));
        std::vector<double> whole(parts.count, 0.0);
        for (std::size_t f = 0; f < low.triangles.size(); ++f)
            whole[parts.ofFace[f]] += shadowMm2[f];
        const auto largest = static_cast<std::uint32_t>(std::max_element(whole.begin(), whole.end()) - whole.begin());
        TriangleMesh turned;  // its open edges run as the border of what is missing
        turned.vertices = mesh_.vertices;
        for (std::size_t f = 0; f < low.triangles.size(); ++f) {
            const Triangle& t = low.triangles[f];
            if (parts.ofFace[f] == largest)
                turned.triangles.push_back({t[0], t[2], t[1]});
            else
                kept.push_back(t);
        }
        std::vector<Loop> borders = openLoops(turned);
        return borders.size() == 1 ? std::move(borders[0]) : Loop();
    }

    // Away from the surface: the plane that most of the border lies in, the border's area, the axis near it.
    [[nodiscard]] std::vector<Vec3> downwards() const {
        if (area_.isZero()) return {};
        std::vector<Vec3> all;
        const auto add = [&](Vec3 n) {
            constexpr double kFarthest = 0.8, kSame = 0.9998;  // cosines: 37 and 1 degrees
            if (n.dot(area_) < 0.0) n = -n;
            if (n.dot(area_) > kFarthest &&
                std::none_of(all.begin(), all.end(), [&](const Vec3& other) { return n.dot(other) > kSame; }))
                all.push_back(n);
        };
        add(planeNormal());
        add(area_);
        for (int k = 0; k < 3; ++k)
            add(Vec3::Unit(k));
        return all;
    }

    // What stands out of the plane, as the ends of an arch do, counts the less the farther it is.
    [[nodiscard]] Vec3 planeNormal() const {
        std::vector<double> weight(loop_.size(), 1.0);
        Vec3 normal = Vec3::Zero();
        for (int round = 0; round < 12; ++round) {
            Vec3 centre = Vec3::Zero();
            double whole = 0.0;
            for (std::size_t i = 0; i < loop_.size(); ++i) {
                centre += weight[i] * mesh_.vertices[loop_[i]];
                whole += weight[i];
            }
            centre /= whole;
            Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
            for (std::size_t i = 0; i < loop_.size(); ++i) {
                const Vec3 p = mesh_.vertices[loop_[i]] - centre;
                spread += weight[i] * p * p.transpose();
            }
            const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread / whole);
            normal = axes.eigenvectors().col(0);
            const double least = 1e-3 * std::sqrt(std::max(axes.eigenvalues()[2], 1e-300));
            for (std::size_t i = 0; i < loop_.size(); ++i)
                weight[i] = 1.0 / (least + std::abs(normal.dot(mesh_.vertices[loop_[i]] - centre)));
        }
        return normal;
    }

    // `border`: what of the loop stands on the base; `kept`: faces between it and the loop.
    std::optional<MadeBase> stand(const Loop& border, const std::vector<Triangle>& kept, const Vec3& down,
                                  int smoothings) {
        const Vec3 u = down.unitOrthogonal(), v = down.cross(u);
        std::vector<Point> outline;
        double lowest = -HUGE_VAL;
        for (const std::uint32_t i : border) {
            const Vec3& p = mesh_.vertices[i];
            outline.push_back({u.dot(p), v.dot(p)});
            lowest = std::max(lowest, down.dot(p));
        }
        for (int k = 0; k < smoothings; ++k)
            outline = smoothed(outline);
        if (!isSimple(outline)) return std::nullopt;

        const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
        const std::size_t facesBefore = mesh_.triangles.size();
        const auto count = static_cast<std::uint32_t>(border.size());
        const double floor = lowest + depthMm_;
        Loop corners;
        for (std::uint32_t i = 0; i < count; ++i) {
            mesh_.vertices.push_back(u * outline[i][0] + v * outline[i][1] + down * floor);
            corners.push_back(first + i);
        }
        mesh_.triangles.insert(mesh_.triangles.end(), kept.begin(), kept.end());
        formats::Polygons polygon;
        polygon.add(mesh_.triangles, corners);
        const bool isWhole = polygon.settle(mesh_).count() == 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            const std::uint32_t j = i + 1 == count ? 0 : i + 1;
            mesh_.triangles.push_back({border[i], border[j], first + j});
            mesh_.triangles.push_back({border[i], first + j, first + i});
        }
        if (!isWhole || !crossesNothing(facesBefore)) {
            mesh_.vertices.resize(first);
            mesh_.triangles.resize(facesBefore);
            return std::nullopt;
        }
        MadeBase made;
        made.edges = loop_.size();
        made.perimeterMm = perimeterMm(mesh_, loop_);
        made.depthMm = depthMm_;
        made.downMm = down;
        made.areaMm2 = areaMm2(mesh_, std::span<const Triangle>(mesh_.triangles).subspan(facesBefore));
        return made;
    }

    // What crosses otherwise was there before.
    [[nodiscard]] bool crossesNothing(std::size_t facesBefore) const {
        const std::vector<CrossingFaces> crossings = selfIntersections(mesh_);
        return std::none_of(crossings.begin(), crossings.end(),
                            [&](const CrossingFaces& c) { return c.second >= facesBefore; });
    }

    static std::vector<Point> smoothed(const std::vector<Point>& outline) {
        std::vector<Point> result(outline.size());
        for (std::size_t i = 0; i < outline.size(); ++i) {
            const Point &before = outline[(i + outline.size() - 1) % outline.size()],
                        &after = outline[(i + 1) % outline.size()];
            for (std::size_t k = 0; k < 2; ++k)
                result[i][k] = 0.25 * (before[k] + 2.0 * outline[i][k] + after[k]);
        }
        return result;
    }

    // Goes round once, without crossing itself and without two corners in one place.
    static bool isSimple(const std::vector<Point>& p) {
        const std::size_t n = p.size();
        const auto area = [](const Point& a, const Point& b, const Point& c) {
            return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        };
        double around = 0.0, whole = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            around += core::hypot(p[(i + 1) % n][0] - p[i][0], p[(i + 1) % n][1] - p[i][1]);
            whole += area(p[0], p[i], p[(i + 1) % n]);
        }
        if (whole == 0.0) return false;
        const double least = 1e-3 * around / static_cast<double>(n);
        for (std::size_t i = 0; i < n; ++i)
            if (core::hypot(p[(i + 1) % n][0] - p[i][0], p[(i + 1) % n][1] - p[i][1]) < least) return false;
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = i + 2; j < n; ++j) {
                if (i == 0 && j == n - 1) continue;
                const Point &a = p[i], &b = p[i + 1], &c = p[j], &d = p[(j + 1) % n];
                if (std::max(a[0], b[0]) < std::min(c[0], d[0]) || std::max(c[0], d[0]) < std::min(a[0], b[0]) ||
                    std::max(a[1], b[1]) < std::min(c[1], d[1]) || std::max(c[1], d[1]) < std::min(a[1], b[1]))
                    continue;
                if ((area(a, b, c) > 0.0) != (area(a, b, d) > 0.0) && (area(c, d, a) > 0.0) != (area(c, d, b) > 0.0))
                    return false;
            }
        return true;
    }

    TriangleMesh& mesh_;
    Loop loop_;
    double depthMm_;
    EdgeList taken_;
    Vec3 area_ = Vec3::Zero();  ///< of the loop, unit, away from the surface
    double sign_ = 1.0;         ///< -1 where new faces over the loop would face the surface
};

}  // namespace

std::vector<MadeBase> addBases(TriangleMesh& mesh, double depthMm) {
    const std::vector<Loop> loops = openLoops(mesh);
    const Shells shells = shellsOf(mesh, MeshEdges(mesh));
    std::vector<std::uint32_t> shellOf(mesh.vertices.size(), 0);
    std::vector<core::Box> boxes(shells.count);
    std::vector<Vec3> centre(shells.count, Vec3::Zero());
    std::vector<double> areaMm2(shells.count, 0.0);
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        const std::uint32_t s = shells.ofFace[f];
        const Triangle& t = mesh.triangles[f];
        const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        const double area = 0.5 * (b - a).cross(c - a).norm();
        areaMm2[s] += area;
        centre[s] += area * (a + b + c) / 3.0;
        for (const std::uint32_t v : t) {
            shellOf[v] = s;
            boxes[s].extend(mesh.vertices[v]);
        }
    }
    std::vector<const Loop*> border(shells.count, nullptr);
    std::vector<double> length(shells.count, 0.0);
    double longest = 0.0;
    for (const Loop& loop : loops) {
        const std::uint32_t s = shellOf[loop[0]];
        const double mm = perimeterMm(mesh, loop);
        longest = std::max(longest, mm);
        if (mm < boxes[s].size().norm() || mm <= length[s]) continue;
        length[s] = mm;
        border[s] = &loop;
    }
    std::vector<MadeBase> made;
    for (std::size_t s = 0; s < shells.count; ++s) {
        if (!border[s]) continue;
        constexpr double kShare = 0.05, kLeastMm = 1.0, kMostMm = 5.0;
        const double mm = depthMm >= 0.0 ? depthMm : std::clamp(kShare * boxes[s].size().norm(), kLeastMm, kMostMm);
        const auto base = BaseMaker(mesh, *border[s], centre[s] / areaMm2[s], mm).make();
        if (!base)
            throw core::Error(fmt::format("every base under the border of {} edges, {:.4g} mm around, would cross the "
                                          "surface",
                                          border[s]->size(), length[s]),
                              "mesh", "trim the border where it folds under, or leave --base out");
        made.push_back(*base);
    }
    if (made.empty())
        throw core::Error(loops.empty() ? std::string("the surface is closed, and has no border to stand on a base")
                                        : fmt::format("there is no border to stand on a base, only {} of {:.3g} mm "
                                                      "around at most",
                                                      loops.size() == 1 ? "a hole" : "holes", longest),
                          "mesh", "leave --base out");
    return made;
}

}  // namespace handpiece::geometry
