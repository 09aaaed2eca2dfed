// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/envelope.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/error.h"

namespace handpiece::instrument {

using core::Vec2;
using core::Vec3;

namespace {

constexpr double kSameHeightMm = 1e-7;
constexpr double kShortStretchMm = 1e-3;
constexpr double kChordToleranceMm = 0.4 * kEnvelopeToleranceMm;
constexpr double kThinningToleranceMm = 0.5 * kEnvelopeToleranceMm;

/// An edge as the straight motion of a point with its height: squared radius is a parabola in z.
struct Edge {
    double low, high;     ///< z [mm], low < high
    double x, y, dx, dy;  ///< place at low, change per mm of height

    [[nodiscard]] double squaredRadius(double z) const {
        const double px = x + dx * (z - low), py = y + dy * (z - low);
        return px * px + py * py;
    }
};

class Envelope {
  public:
    explicit Envelope(const geometry::TriangleMesh& mesh) {
        std::vector<double> heights;
        double bottom = mesh.bounds().min.z();
        for (const geometry::Triangle& t : mesh.triangles)
            for (int k = 0; k < 3; ++k) {
                Vec3 a = mesh.vertices[t[static_cast<std::size_t>(k)]],
                     b = mesh.vertices[t[static_cast<std::size_t>((k + 1) % 3)]];
                a.z() -= bottom;
                b.z() -= bottom;
                heights.push_back(a.z());
                if (a.z() > b.z()) std::swap(a, b);
                const double rise = b.z() - a.z();
                // A level edge adds nothing: the edges beside it pass through its ends.
                if (rise > kSameHeightMm)
                    edges_.push_back({a.z(), b.z(), a.x(), a.y(), (b.x() - a.x()) / rise, (b.y() - a.y()) / rise});
            }
        std::sort(heights.begin(), heights.end());
        for (const double z : heights)
            if (heights_.empty() || z - heights_.back() > kSameHeightMm) heights_.push_back(z);
        std::sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) { return a.low < b.low; });
    }

    /// Radius against height, from the bottom up; two points at a height where it jumps.
    std::vector<Vec2> points() {
        std::size_t next = 0;
        for (std::size_t i = 0; i + 1 < heights_.size(); ++i) {
            const double low = heights_[i], high = heights_[i + 1], middle = 0.5 * (low + high);
            while (next < edges_.size() && edges_[next].low < middle)
                active_.push_back(next++);
            active_.erase(
                std::remove_if(active_.begin(), active_.end(), [&](std::size_t e) { return edges_[e].high < middle; }),
                active_.end());
            if (active_.empty())
                throw core::Error("this bur is in two pieces",
                                  fmt::format("nothing at {:.4g} mm above its lower end", middle),
                                  "keep only the bur's head in the file");
            const double atLow = radius(low), atHigh = radius(high);
            append({atLow, low});
            if (high - low > kShortStretchMm) subdivide({atLow, low}, {atHigh, high}, 0);
            append({atHigh, high});
        }
        return std::move(points_);
    }

  private:
    [[nodiscard]] double radius(double z) const {
        double most = 0.0;
        for (const std::size_t e : active_)
            most = std::max(most, edges_[e].squaredRadius(std::clamp(z, edges_[e].low, edges_[e].high)));
        return std::sqrt(most);
    }

    void append(const Vec2& p) {
        if (points_.empty() || (p - points_.back()).norm() > kSameHeightMm) points_.push_back(p);
    }

    void subdivide(const Vec2& a, const Vec2& b, int depth) {
        const auto chord = [&](double u) { return a.x() + u * (b.x() - a.x()); };
        const auto height = [&](double u) { return a.y() + u * (b.y() - a.y()); };
        double worst = 0.0;
        for (const double u : {0.25, 0.5, 0.75})
            worst = std::max(worst, std::abs(radius(height(u)) - chord(u)));
        if (worst < kChordToleranceMm || depth == 20) return;
        const Vec2 middle(radius(height(0.5)), height(0.5));
        subdivide(a, middle, depth + 1);
        append(middle);
        subdivide(middle, b, depth + 1);
    }

    std::vector<Edge> edges_;
    std::vector<double> heights_;
    std::vector<std::size_t> active_;
    std::vector<Vec2> points_;
};

/// Leaves out points within the tolerance of the line between those that stay (Douglas and Peucker).
std::vector<Vec2> thinned(const std::vector<Vec2>& points) {
    std::vector<char> keep(points.size(), 0);
    keep.front() = keep.back() = 1;
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, points.size() - 1}};
    while (!open.empty()) {
        const auto [first, last] = open.back();
        open.pop_back();
        const Vec2 d = points[last] - points[first];
        double worst = kThinningToleranceMm;
        std::size_t at = first;
        for (std::size_t i = first + 1; i < last; ++i) {
            const Vec2 w = points[i] - points[first];
            const double u = d.squaredNorm() > 0.0 ? std::clamp(w.dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
            const double off = (w - u * d).norm();
            if (off > worst) {
                worst = off;
                at = i;
            }
        }
        if (at == first) continue;
        keep[at] = 1;
        open.push_back({first, at});
        open.push_back({at, last});
    }
    std::vector<Vec2> kept;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (keep[i]) kept.push_back(points[i]);
    return kept;
}

}  // namespace

Profile envelopeOfRevolution(const geometry::TriangleMesh& mesh) {
    std::vector<Vec2> points = Envelope(mesh).points();
    const double top = points.back().y();
    // A radius of less than the tolerance at an end is a point.
    if (points.front().x() < kEnvelopeToleranceMm) points.front().x() = 0.0;
    if (points.back().x() < kEnvelopeToleranceMm) points.back().x() = 0.0;
    if (points.front().x() > 0.0) points.insert(points.begin(), Vec2(0.0, 0.0));
    if (points.back().x() > 0.0) points.push_back({0.0, top});
    points = thinned(points);
    Profile profile;
    for (std::size_t i = 1; i < points.size(); ++i) {
        if (i + 1 < points.size() && points[i].x() < kEnvelopeToleranceMm)
            throw core::Error("this bur has no thickness in between its ends",
                              fmt::format("{:.4g} mm above its lower end", points[i].y()),
                              "keep only the bur's head in the file");
        profile.pieces.push_back({points[i - 1], points[i], false, Vec2::Zero(), 0.0, true});
    }
    return profile;
}

}  // namespace handpiece::instrument
