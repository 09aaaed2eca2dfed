// SPDX-License-Identifier: Apache-2.0
#include "support/brute_force_depth.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace handpiece::test {
namespace {

constexpr double kFinalMm = 2e-8;    // window at which refinement stops
constexpr std::size_t kRefined = 6;  // places refined per curve

/// One curve of the medial region seen as a surface (u, v): u a length along the curve, v an arc about the axis.
class Curve {
  public:
    Curve(const geometry::TriangleTree& tooth, const core::Pose& pose, const instrument::MedialCurve& curve)
        : tooth_(tooth), pose_(pose), balls_(curve.balls), onAxis_(curve.onAxis) {
        lengths_.push_back(0.0);
        for (std::size_t i = 1; i < balls_.size(); ++i)
            lengths_.push_back(lengths_.back() +
                               std::hypot(balls_[i].rhoMm - balls_[i - 1].rhoMm, balls_[i].zMm - balls_[i - 1].zMm));
        for (const auto& b : balls_)
            maxRho_ = std::max(maxRho_, b.rhoMm);
    }
    [[nodiscard]] double length() const { return lengths_.back(); }
    [[nodiscard]] bool onAxis() const { return onAxis_; }
    [[nodiscard]] double maxRho() const { return maxRho_; }

    [[nodiscard]] core::Vec3 at(double u, double angle, double& radius) const {
        u = std::clamp(u, 0.0, length());
        std::size_t i =
            static_cast<std::size_t>(std::upper_bound(lengths_.begin(), lengths_.end(), u) - lengths_.begin());
        i = std::clamp<std::size_t>(i, 1, std::max<std::size_t>(balls_.size() - 1, 1)) - 1;
        const std::size_t j = std::min(i + 1, balls_.size() - 1);
        const double span = lengths_[j] - lengths_[i], t = span > 0.0 ? (u - lengths_[i]) / span : 0.0;
        const double rho = balls_[i].rhoMm + t * (balls_[j].rhoMm - balls_[i].rhoMm);
        radius = balls_[i].radiusMm + t * (balls_[j].radiusMm - balls_[i].radiusMm);
        return pose_.apply(
            {rho * std::cos(angle), rho * std::sin(angle), balls_[i].zMm + t * (balls_[j].zMm - balls_[i].zMm)});
    }
    [[nodiscard]] double value(double u, double angle) const {
        double radius = 0.0;
        const core::Vec3 c = at(u, angle, radius);
        return radius - tooth_.signedDistance(c);
    }

  private:
    const geometry::TriangleTree& tooth_;
    core::Pose pose_;
    std::vector<instrument::MedialBall> balls_;
    std::vector<double> lengths_;
    bool onAxis_;
    double maxRho_ = 0.0;
};

struct Place {
    double value, u, angle;
};

/// Shrinking grids: robust where the function has kinks, which a gradient is not.
Place refine(const Curve& curve, Place best, double window) {
    const double rho = std::max(curve.maxRho(), 1e-9);
    while (window > kFinalMm) {
        const Place centre = best;
        const int steps = curve.onAxis() ? 8 : 4;
        for (int i = -steps; i <= steps; ++i)
            for (int j = curve.onAxis() ? 0 : -steps; j <= (curve.onAxis() ? 0 : steps); ++j) {
                const double u = std::clamp(centre.u + window * i / steps, 0.0, curve.length());
                const double angle = centre.angle + window * j / (steps * rho);
                const double v = curve.value(u, angle);
                if (v > best.value) best = {v, u, angle};
            }
        // Shrink only when the best is not at the window's rim, so that a slope is followed to its top.
        const double moved = std::max(std::abs(best.u - centre.u), rho * std::abs(best.angle - centre.angle));
        if (moved < 0.75 * window) window *= curve.onAxis() ? 0.3 : 0.5;
    }
    return best;
}

void searchCurve(const Curve& curve, double coarseMm, double& bestValue, core::Vec3& bestPoint) {
    // Cells that cannot beat the best are dropped: a ball's value changes by at most twice the way its centre moves.
    struct Cell {
        double value, u, angle, du, dAngle;
    };
    const double tau = 2.0 * std::numbers::pi;
    std::vector<Cell> cells, next;
    const int around = curve.onAxis() ? 1 : 8, along = std::max(1, static_cast<int>(std::ceil(curve.length() / 0.32)));
    for (int i = 0; i < along; ++i)
        for (int j = 0; j < around; ++j)
            cells.push_back({0.0, (i + 0.5) * curve.length() / along, (j + 0.5) * tau / around, curve.length() / along,
                             curve.onAxis() ? 0.0 : tau / around});
    std::vector<Place> places;
    for (;;) {
        double widest = 0.0;
        for (Cell& c : cells) {
            c.value = curve.value(c.u, c.angle);
            double r = 0.0;
            if (c.value > bestValue) bestValue = c.value, bestPoint = curve.at(c.u, c.angle, r);
            widest = std::max({widest, c.du, c.dAngle * curve.maxRho()});
        }
        next.clear();
        for (const Cell& c : cells)
            if (c.value + (c.du + 0.5 * c.dAngle * curve.maxRho()) + 1e-9 >= bestValue) next.push_back(c);
        cells.swap(next);
        if (widest <= coarseMm || cells.empty()) break;
        next.clear();
        for (const Cell& c : cells) {
            const bool splitU = c.du > 0.5 * coarseMm, splitAngle = c.dAngle * curve.maxRho() > 0.5 * coarseMm;
            for (int i = 0; i < (splitU ? 2 : 1); ++i)
                for (int j = 0; j < (splitAngle ? 2 : 1); ++j) {
                    Cell s = c;
                    if (splitU) s.du = 0.5 * c.du, s.u = c.u + (i - 0.5) * s.du;
                    if (splitAngle) s.dAngle = 0.5 * c.dAngle, s.angle = c.angle + (j - 0.5) * s.dAngle;
                    next.push_back(s);
                }
        }
        if (next.size() == cells.size()) break;
        cells.swap(next);
    }
    for (const Cell& c : cells)
        places.push_back({c.value, c.u, c.angle});
    if (!curve.onAxis()) {  // the ends of a sheet by themselves: a sharp rim often decides
        const double rho = std::max(curve.maxRho(), 1e-9);
        const int n = static_cast<int>(std::ceil(tau * rho / coarseMm));
        for (int j = 0; j < n; ++j)
            for (const double u : {0.0, curve.length()}) {
                const double v = curve.value(u, tau * j / n);
                if (v + 2.0 * coarseMm >= bestValue) places.push_back({v, u, tau * j / n});
            }
    } else {
        places.push_back({curve.value(0.0, 0.0), 0.0, 0.0});
        places.push_back({curve.value(curve.length(), 0.0), curve.length(), 0.0});
    }
    std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.value > b.value; });
    std::vector<Place> done;
    for (const Place& p : places) {
        if (done.size() >= kRefined) break;
        const bool seen = std::any_of(done.begin(), done.end(), [&](const Place& d) {
            return std::abs(d.u - p.u) < 2.0 * coarseMm &&
                   curve.maxRho() * std::abs(std::remainder(d.angle - p.angle, tau)) < 2.0 * coarseMm;
        });
        if (seen) continue;
        done.push_back(p);
        const Place r = refine(curve, p, coarseMm);
        double radius = 0.0;
        if (r.value > bestValue) bestValue = r.value, bestPoint = curve.at(r.u, r.angle, radius);
    }
}

}  // namespace

double summedDistance(const geometry::TriangleTree& tooth, const instrument::Bur& bur, const core::Pose& burInTooth,
                      const core::Vec3& pointMm) {
    return tooth.signedDistance(pointMm) + bur.signedDistance(burInTooth.applyInverse(pointMm));
}

BruteForceResult bruteForceDepth(const geometry::TriangleTree& tooth, const instrument::Bur& bur,
                                 const core::Pose& burInTooth, double coarseMm) {
    BruteForceResult result;
    double best = -std::numeric_limits<double>::infinity();
    core::Vec3 point = core::Vec3::Zero();
    // The tooth's corners against the bur's exact distance, and the bur's surface against the triangles: both are lower
    // bounds of the depth that know nothing of the medial region.
    for (const geometry::TreeTriangle& t : tooth.triangles()) {
        const core::Vec3 a(t.a[0], t.a[1], t.a[2]), ab(t.ab[0], t.ab[1], t.ab[2]), ac(t.ac[0], t.ac[1], t.ac[2]);
        if ((a - burInTooth.positionMm).norm() > bur.lengthMm() + 2.0 * bur.maxRadiusMm() + 1.0) continue;
        for (const core::Vec3& q : {a, core::Vec3(a + (ab + ac) / 3.0)}) {
            const double v = -bur.signedDistance(burInTooth.applyInverse(q));
            if (v > best) best = v, point = q;
        }
    }
    for (const instrument::SurfaceRing& ring : bur.rings())
        for (std::uint32_t j = 0; j < ring.count; j += 4) {
            const double angle = 2.0 * std::numbers::pi * (j + 0.5) / ring.count;
            const core::Vec3 x =
                burInTooth.apply({ring.rhoMm * std::cos(angle), ring.rhoMm * std::sin(angle), ring.zMm});
            if (best > 0.0 && tooth.nearest(x, best).triangle == geometry::kNoTriangle && tooth.signedDistance(x) > 0.0)
                continue;
            const double v = -tooth.signedDistance(x);
            if (v > best) best = v, point = x;
        }
    for (const instrument::MedialCurve& c : bur.medialAxis())
        if (!c.balls.empty()) searchCurve(Curve(tooth, burInTooth, c), coarseMm, best, point);
    result.depthMm = best;
    result.pointMm = point;
    return result;
}

}  // namespace handpiece::test
