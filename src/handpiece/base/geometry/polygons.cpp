// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/polygons.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace handpiece::geometry::formats {
namespace {

using Point = std::array<double, 2>;

/// Twice the signed area.
double area(const Point& a, const Point& b, const Point& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Turned so that it goes round to the left; empty where it has no area.
std::vector<Point> flattened(const TriangleMesh& mesh, std::span<const std::uint32_t> corners) {
    core::Vec3 normal = core::Vec3::Zero();
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const core::Vec3 &a = mesh.vertices[corners[i]], &b = mesh.vertices[corners[(i + 1) % corners.size()]];
        normal += core::Vec3((a.y() - b.y()) * (a.z() + b.z()), (a.z() - b.z()) * (a.x() + b.x()),
                             (a.x() - b.x()) * (a.y() + b.y()));
    }
    int axis = 0;
    for (int k = 1; k < 3; ++k)
        if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
    if (!(std::abs(normal[axis]) > 0.0)) return {};
    const int first = normal[axis] > 0.0 ? (axis + 1) % 3 : (axis + 2) % 3,
              second = normal[axis] > 0.0 ? (axis + 2) % 3 : (axis + 1) % 3;
    std::vector<Point> points;
    points.reserve(corners.size());
    for (const std::uint32_t corner : corners)
        points.push_back({mesh.vertices[corner][first], mesh.vertices[corner][second]});
    return points;
}

bool isInside(const Point& p, const Point& a, const Point& b, const Point& c) {
    return area(a, b, p) >= 0.0 && area(b, c, p) >= 0.0 && area(c, a, p) >= 0.0;
}

bool crossesItself(const std::vector<Point>& points) {
    const std::size_t count = points.size();
    const auto isBetween = [](double a, double b) { return (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0); };
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = i + 2; j < count; ++j) {
            const Point &a = points[i], &b = points[i + 1], &c = points[j], &d = points[(j + 1) % count];
            if (isBetween(area(a, b, c), area(a, b, d)) && isBetween(area(c, d, a), area(c, d, b))) return true;
        }
    return false;
}

/// Corners by their place in the polygon; empty where there are none, as in one that crosses itself.
std::vector<std::array<std::size_t, 3>> ears(const std::vector<Point>& points) {
    const std::size_t count = points.size();
    std::vector<std::size_t> before(count), after(count);
    for (std::size_t i = 0; i < count; ++i)
        before[i] = (i + count - 1) % count, after[i] = (i + 1) % count;
    const auto turn = [&](std::size_t i) { return area(points[before[i]], points[i], points[after[i]]); };
    const auto isEar = [&](std::size_t i) {
        if (!(turn(i) > 0.0)) return false;
        const std::size_t a = before[i], c = after[i];
        for (std::size_t other = after[c]; other != a; other = after[other])
            if (turn(other) <= 0.0 && points[other] != points[a] && points[other] != points[i] &&
                points[other] != points[c] && isInside(points[other], points[a], points[i], points[c]))
                return false;
        return true;
    };
    std::vector<std::array<std::size_t, 3>> all;
    std::size_t at = 0, left = count, refused = 0;
    const auto cut = [&](std::size_t i) {
        all.push_back({before[i], i, after[i]});
        after[before[i]] = after[i], before[after[i]] = before[i];
        --left;
    };
    while (left > 3) {
        if (isEar(at)) {
            cut(at);
            // The ears lie all round, not as a fan about one corner.
            at = after[after[at]], refused = 0;
        } else if (++refused > left) {
            // What is straight, or of no area, is no ear and must go all the same.
            std::size_t flat = at;
            for (std::size_t i = 0; i < left && turn(flat) != 0.0; ++i)
                flat = after[flat];
            if (turn(flat) != 0.0) return {};
            cut(flat);
            at = after[flat], refused = 0;
        } else {
            at = after[at];
        }
    }
    all.push_back({before[at], at, after[at]});
    return all;
}

}  // namespace

void Polygons::add(std::vector<Triangle>& triangles, std::span<const std::uint32_t> corners) {
    if (corners.size() > 3) {
        polygons_.push_back({triangles.size(), corners_.size(), corners.size()});
        corners_.insert(corners_.end(), corners.begin(), corners.end());
    }
    for (std::size_t i = 2; i < corners.size(); ++i)
        triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

std::size_t Polygons::settle(TriangleMesh& mesh) const {
    constexpr std::size_t kMostCorners = 20'000;
    std::size_t crossing = 0;
    for (const Polygon& one : polygons_) {
        const std::span<const std::uint32_t> corners(corners_.data() + one.corner, one.count);
        const std::vector<Point> points = flattened(mesh, corners);
        if (points.empty()) continue;
        // A fan whose triangles all go round as the polygon does covers it, and nothing else. What is straight but for
        // the last digits is no dent.
        constexpr double kStraight = 1e-9;
        double least = 0.0, whole = 0.0;
        for (std::size_t i = 2; i < one.count; ++i) {
            const double piece = area(points[0], points[i - 1], points[i]);
            least = std::min(least, piece), whole += piece;
        }
        if (least >= -kStraight * whole) continue;
        const auto cut = one.count <= kMostCorners && !crossesItself(points)
                             ? ears(points)
                             : std::vector<std::array<std::size_t, 3>>();
        if (cut.empty()) {
            ++crossing;
            continue;
        }
        for (std::size_t i = 0; i < cut.size(); ++i)
            mesh.triangles[one.triangle + i] = {corners[cut[i][0]], corners[cut[i][1]], corners[cut[i][2]]};
    }
    return crossing;
}

}  // namespace handpiece::geometry::formats
