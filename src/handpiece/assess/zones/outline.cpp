// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/zones/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "handpiece/base/core/portable_math.h"

namespace handpiece::zones {
namespace {

using core::Vec2;

double toSegment(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 ab = b - a, ap = p - a;
    const double squared = ab.squaredNorm();
    const double t = squared > 0.0 ? std::clamp(ap.dot(ab) / squared, 0.0, 1.0) : 0.0;
    return (ap - t * ab).norm();
}

double toLine(const Vec2& p, const std::vector<Vec2>& points, bool isClosed) {
    if (points.size() == 1) return (p - points.front()).norm();
    double least = isClosed ? toSegment(p, points.back(), points.front()) : std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < points.size(); ++i)
        least = std::min(least, toSegment(p, points[i], points[i + 1]));
    return least;
}

bool isIn(const Vec2& p, const std::vector<Vec2>& polygon) {
    bool in = false;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        const Vec2 &a = polygon[i], &b = polygon[j];
        if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x())
            in = !in;
    }
    return in;
}

double toArea(const Vec2& p, const std::vector<Vec2>& polygon) {
    const double d = toLine(p, polygon, true);
    return isIn(p, polygon) ? -d : d;
}

}  // namespace

double Outline::distanceMm(const Vec2& p) const {
    double d = std::numeric_limits<double>::infinity();
    for (const Stroke& stroke : strokes)
        d = std::min(d, toLine(p, stroke.points, stroke.isClosed) - stroke.halfWidthMm);
    for (const std::vector<Vec2>& area : areas)
        d = std::min(d, toArea(p, area));
    for (const std::vector<Vec2>& hole : holes)
        d = std::max(d, -toArea(p, hole));
    return d;
}

std::pair<Vec2, Vec2> Outline::bounds() const {
    Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity()), high = -low;
    const auto extend = [&](const Vec2& p, double byMm) {
        low = low.cwiseMin(p - Vec2::Constant(byMm)), high = high.cwiseMax(p + Vec2::Constant(byMm));
    };
    for (const Stroke& stroke : strokes)
        for (const Vec2& p : stroke.points)
            extend(p, stroke.halfWidthMm);
    for (const std::vector<Vec2>& area : areas)
        for (const Vec2& p : area)
            extend(p, 0.0);
    return {low, high};
}

std::vector<Vec2> arc(const Vec2& centre, double radiusMm, double fromRad, double toRad) {
    // A chord of angle a is radius * (1 - cos(a / 2)) off the circle, about radius * a^2 / 8.
    constexpr double kOffMm = 1e-3;
    const double step = std::sqrt(8.0 * kOffMm / std::max(radiusMm, kOffMm));
    const int pieces = std::max(2, static_cast<int>(std::ceil(std::abs(toRad - fromRad) / step)));
    std::vector<Vec2> points;
    for (int i = 0; i <= pieces; ++i) {
        const double a = fromRad + (toRad - fromRad) * i / pieces;
        points.push_back(centre + radiusMm * Vec2(core::cos(a), core::sin(a)));
    }
    return points;
}

std::vector<Vec2> circle(const Vec2& centre, double radiusMm) {
    std::vector<Vec2> points = arc(centre, radiusMm, 0.0, 2.0 * std::numbers::pi);
    points.pop_back();
    return points;
}

std::vector<Vec2> convexOutline(std::vector<Vec2> points) {
    std::sort(points.begin(), points.end(),
              [](const Vec2& a, const Vec2& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3) return points;
    std::vector<Vec2> hull(2 * points.size());
    std::size_t n = 0;
    const auto turnsLeft = [&](const Vec2& p) {
        const Vec2 a = hull[n - 1] - hull[n - 2], b = p - hull[n - 1];
        return a.x() * b.y() - a.y() * b.x() > 0.0;
    };
    for (std::size_t i = 0; i < points.size(); ++i) {
        while (n >= 2 && !turnsLeft(points[i]))
            --n;
        hull[n++] = points[i];
    }
    for (std::size_t i = points.size() - 1, lower = n + 1; i-- > 0;) {
        while (n >= lower && !turnsLeft(points[i]))
            --n;
        hull[n++] = points[i];
    }
    hull.resize(n - 1);
    return hull;
}

}  // namespace handpiece::zones
