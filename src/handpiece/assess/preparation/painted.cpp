// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/preparation/painted.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "handpiece/base/core/error.h"

namespace handpiece::preparation {
namespace {

using core::Vec3;
using geometry::NearestPoint;
using geometry::TriangleMesh;
using geometry::TriangleTree;

/// Two points of a stroke, or its only one twice.
struct Segment {
    Vec3 a, b;
    double radiusMm;
    std::uint32_t stroke;

    [[nodiscard]] Vec3 nearest(const Vec3& p) const {
        const Vec3 ab = b - a;
        const double squared = ab.squaredNorm();
        return squared > 0.0 ? Vec3(a + std::clamp((p - a).dot(ab) / squared, 0.0, 1.0) * ab) : a;
    }
};

/// What is painted, as signed distances along the surface: negative where it is.
class Paint {
  public:
    Paint(std::span<const BrushStroke> strokes, double reachMm, const TriangleMesh& mesh, const TriangleTree& tree) {
        for (std::uint32_t s = 0; s < strokes.size(); ++s) {
            erases_.push_back(strokes[s].erases);
            const std::vector<Vec3>& points = strokes[s].pointsMm;
            for (std::size_t i = 0; i + (points.size() > 1 ? 1 : 0) < points.size(); ++i)
                segments_.push_back({points[i], points[std::min(i + 1, points.size() - 1)], strokes[s].radiusMm, s});
        }
        // Who meets whom at a vertex, by the mesh's order; the tree's own order is another.
        std::vector<std::uint32_t> treeOf(mesh.triangles.size());
        for (std::uint32_t i = 0; i < tree.triangles().size(); ++i)
            treeOf[tree.triangles()[i].index] = i;
        std::vector<std::uint32_t> first(mesh.vertices.size() + 1), fan(3 * mesh.triangles.size());
        for (const geometry::Triangle& t : mesh.triangles)
            for (const std::uint32_t v : t)
                ++first[v + 1];
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
            first[v + 1] += first[v];
        std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
        for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
            for (const std::uint32_t v : mesh.triangles[i])
                fan[next[v]++] = i;

        std::vector<std::vector<std::uint32_t>> at(mesh.triangles.size());
        std::vector<std::uint32_t> seen(mesh.triangles.size(), 0), front;
        std::uint32_t round = 0;
        std::size_t entries = 0;
        for (std::uint32_t s = 0; s < segments_.size(); ++s) {
            const Segment& segment = segments_[s];
            const NearestPoint on = tree.nearest(segment.a);
            // All that hangs together within the brush, and from there on what may be asked how far off it is.
            front = {tree.triangles()[on.triangle].index};
            std::vector<std::uint32_t> inside;
            for (const bool isBrush : {true, false}) {
                constexpr double kSlackMm = 0.05;  // farther in, a place's own distance decides
                const double withinMm = segment.radiusMm + (isBrush ? kSlackMm : kSlackMm + reachMm);
                ++round;
                for (const std::uint32_t t : front)
                    seen[t] = round;
                for (std::size_t k = 0; k < front.size(); ++k)
                    for (const std::uint32_t v : mesh.triangles[front[k]])
                        for (std::uint32_t f = first[v]; f < first[v + 1]; ++f) {
                            const std::uint32_t t = fan[f];
                            if (seen[t] == round || !isWithin(segment, tree, treeOf[t], withinMm)) continue;
                            seen[t] = round;
                            front.push_back(t);
                        }
                if (isBrush) inside = front;
            }
            for (std::size_t k = 0; k < front.size(); ++k)
                at[treeOf[front[k]]].push_back(2 * s + (k < inside.size() ? 1 : 0));
            entries += front.size();
            constexpr std::size_t kMostEntries = 8'000'000;
            if (entries > kMostEntries)
                throw core::Error("too much is painted over too often", "painting",
                                  "paint with fewer strokes, or a smaller brush");
        }
        begin_.push_back(0);
        for (const std::vector<std::uint32_t>& one : at) {
            entries_.insert(entries_.end(), one.begin(), one.end());
            begin_.push_back(static_cast<std::uint32_t>(entries_.size()));
        }
    }

    /// Of a place `q` of a triangle, in the tree's order [mm]; far outside where no brush came near.
    [[nodiscard]] double distanceMm(std::uint32_t triangle, const Vec3& q) const {
        double painted = zones::kFarMm;
        for (std::uint32_t k = begin_[triangle]; k < begin_[triangle + 1];) {
            const std::uint32_t stroke = segments_[entries_[k] / 2].stroke;
            double brush = zones::kFarMm;
            for (; k < begin_[triangle + 1] && segments_[entries_[k] / 2].stroke == stroke; ++k) {
                const Segment& segment = segments_[entries_[k] / 2];
                const double d = (q - segment.nearest(q)).norm() - segment.radiusMm;
                brush = std::min(brush, (entries_[k] & 1) != 0 ? d : std::max(d, 0.0));
            }
            painted = erases_[stroke] ? std::max(painted, -brush) : std::min(painted, brush);
        }
        return painted;
    }

  private:
    /// Both are convex: going to and fro between them comes to where they are nearest.
    static bool isWithin(const Segment& segment, const TriangleTree& tree, std::uint32_t triangle, double mm) {
        constexpr int kRounds = 6;
        Vec3 p = segment.nearest(tree.nearestOn(triangle, 0.5 * (segment.a + segment.b)).pointMm);
        for (int i = 0; i < kRounds; ++i) {
            const NearestPoint on = tree.nearestOn(triangle, p);
            if (on.distanceMm < mm) return true;
            p = segment.nearest(on.pointMm);
        }
        return false;
    }

    std::vector<Segment> segments_;
    std::vector<bool> erases_;                    ///< by stroke
    std::vector<std::uint32_t> begin_, entries_;  ///< by triangle: twice a segment, and 1 where the brush itself lies
};

Vec3 axisOf(const Vec3& way) {
    const std::array<Vec3, 5> axes{Vec3::UnitZ(), Vec3::UnitY(), -Vec3::UnitY(), Vec3::UnitX(), -Vec3::UnitX()};
    return *std::max_element(axes.begin(), axes.end(),
                             [&](const Vec3& a, const Vec3& b) { return a.dot(way) < b.dot(way); });
}

}  // namespace

std::vector<BrushStroke> readStrokes(const config::Table& table) {
    constexpr double kMostMm = 200.0;
    const std::vector<config::Table> all = table.tables("stroke");
    if (all.empty()) table.fail("nothing is painted", "add [[stroke]] with radius_mm and points_mm");
    if (all.size() > kMostStrokes)
        table.fail(fmt::format("{} strokes", all.size()), fmt::format("{} at most", kMostStrokes), "stroke");
    std::vector<BrushStroke> strokes;
    std::size_t points = 0;
    for (const config::Table& one : all) {
        one.allowOnly({"radius_mm", "points_mm", "erase"});
        BrushStroke stroke;
        stroke.radiusMm = one.number("radius_mm").value_or(0.0);
        if (!(stroke.radiusMm >= kLeastBrushMm && stroke.radiusMm <= kMostBrushMm))
            one.fail(fmt::format("a brush of {} mm", stroke.radiusMm),
                     fmt::format("give radius_mm = {} to {}", kLeastBrushMm, kMostBrushMm),
                     one.has("radius_mm") ? "radius_mm" : "");
        stroke.erases = one.flag("erase").value_or(false);
        for (const std::vector<double>& row : one.numberRows("points_mm")) {
            if (row.size() != 3 ||
                !std::all_of(row.begin(), row.end(), [](double v) { return std::abs(v) <= kMostMm; }))
                one.fail("a place of the stroke is none", "give three numbers [mm], as in [1.2, -0.5, 6]", "points_mm");
            stroke.pointsMm.emplace_back(row[0], row[1], row[2]);
        }
        if (stroke.pointsMm.empty()) one.fail("the stroke has no places", "add points_mm = [[x, y, z], ...]");
        points += stroke.pointsMm.size();
        if (points > kMostBrushPoints)
            one.fail(fmt::format("more than {} places of strokes", kMostBrushPoints), "leave some out", "points_mm");
        strokes.push_back(std::move(stroke));
    }
    return strokes;
}

std::string strokesToml(std::span<const BrushStroke> strokes, const std::string& prefix) {
    std::string out;
    for (const BrushStroke& stroke : strokes) {
        out += fmt::format("\n[[{}stroke]]\nradius_mm = {}\n", prefix.empty() ? "" : prefix + ".", stroke.radiusMm);
        if (stroke.erases) out += "erase = true\n";
        out += "points_mm = [";
        for (std::size_t i = 0; i < stroke.pointsMm.size(); ++i) {
            const Vec3& p = stroke.pointsMm[i];
            out += fmt::format("{}[{}, {}, {}]", i == 0 ? "" : ", ", p.x(), p.y(), p.z());
        }
        out += "]\n";
    }
    return out;
}

Painting paintedTarget(std::span<const BrushStroke> strokes, double depthMm, const zones::Leeway& leeway,
                       const TriangleMesh& mesh, std::shared_ptr<const TriangleTree> whole) {
    constexpr double kOnToothMm = 0.3;
    std::vector<BrushStroke> placed(strokes.begin(), strokes.end());
    core::Box box;
    for (std::size_t s = 0; s < placed.size(); ++s)
        for (std::size_t i = 0; i < placed[s].pointsMm.size(); ++i) {
            Vec3& p = placed[s].pointsMm[i];
            const NearestPoint on = whole->nearest(p);
            if (!(on.distanceMm <= kOnToothMm))
                throw core::Error(fmt::format("stroke {}, place {}, lies {:.2f} mm off the tooth's surface", s + 1,
                                              i + 1, on.distanceMm),
                                  "painting", "paint on this very tooth");
            p = on.pointMm;
            if (!placed[s].erases) {
                const Vec3 reach = Vec3::Constant(placed[s].radiusMm + depthMm);
                box.extend(p - reach), box.extend(p + reach);
            }
        }
    const double reachMm = leeway.sideMm + 0.5;
    const auto paint = std::make_shared<const Paint>(placed, reachMm, mesh, *whole);

    // Triangles may be larger than the brush: its own places count too.
    Vec3 facing = Vec3::Zero(), under = Vec3::Zero();
    for (std::uint32_t i = 0; i < whole->triangles().size(); ++i) {
        const geometry::TreeTriangle& t = whole->triangles()[i];
        const Vec3 a(t.a[0], t.a[1], t.a[2]), ab(t.ab[0], t.ab[1], t.ab[2]), ac(t.ac[0], t.ac[1], t.ac[2]);
        if (paint->distanceMm(i, a + (ab + ac) / 3.0) < 0.0) facing += ab.cross(ac);
    }
    for (const BrushStroke& stroke : placed)
        for (const Vec3& p : stroke.pointsMm) {
            const NearestPoint on = whole->nearest(p);
            if (paint->distanceMm(on.triangle, on.pointMm) < 0.0) under += whole->pseudonormal(on.triangle);
        }
    if (facing.isZero(0.0)) facing = under;
    if (facing.isZero(0.0))
        throw core::Error("nothing is painted", "painting", "what was painted is erased again: paint anew")
            .as("lay-not-painted");
    zones::TargetFunction target = [paint, whole, depthMm](const Vec3& p) {
        NearestPoint on;
        const double outMm = whole->signedDistance(p, &on);
        return zones::PastTarget{paint->distanceMm(on.triangle, on.pointMm), -outMm - depthMm};
    };
    return {std::move(target), box, axisOf(facing)};
}

}  // namespace handpiece::preparation
