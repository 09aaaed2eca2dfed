// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/sheet_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace handpiece::contact {

using core::Vec3;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kCellMm = 0.15;  // cells are climbed, not cut, below this
constexpr double kFirstCellMm = 0.35;
constexpr double kToleranceMm = 2e-8;
constexpr double kFinalWindowMm = 5e-6;
constexpr int kMaxSteps = 48, kMaxClimbs = 5;
constexpr double kArcFloorMm = 0.05;  // about the axis an angle is no measure of length

/// A triangle near the ball being climbed: what it says of the depth there and how that changes.
struct Support {
    double value, alongU, alongArc;
};

/// Largest of min over supports of (value + slopes . step) within the box, by its corners: four supports and four sides
/// leave few.
double solve(const Support* supports, int count, double lowU, double highU, double window, double& stepU,
             double& stepArc) noexcept {
    double best = -std::numeric_limits<double>::infinity();
    const auto offer = [&](double u, double arc) {
        constexpr double kSlack = 1e-12;
        if (!(u >= lowU - kSlack && u <= highU + kSlack && std::abs(arc) <= window + kSlack)) return;
        double least = std::numeric_limits<double>::infinity();
        for (int i = 0; i < count; ++i)
            least = std::min(least, supports[i].value + supports[i].alongU * u + supports[i].alongArc * arc);
        if (least > best) {
            best = least;
            stepU = u;
            stepArc = arc;
        }
    };
    for (const double u : {lowU, highU})
        for (const double arc : {-window, window})
            offer(u, arc);
    for (int i = 0; i < count; ++i)
        for (int j = i + 1; j < count; ++j) {
            // Where two are equal: a U + b arc = c.
            const double a = supports[i].alongU - supports[j].alongU, b = supports[i].alongArc - supports[j].alongArc;
            const double c = supports[j].value - supports[i].value;
            if (std::abs(b) > 1e-12)
                for (const double u : {lowU, highU})
                    offer(u, (c - a * u) / b);
            if (std::abs(a) > 1e-12)
                for (const double arc : {-window, window})
                    offer((c - b * arc) / a, arc);
            for (int k = j + 1; k < count; ++k) {
                const double d = supports[i].alongU - supports[k].alongU,
                             e = supports[i].alongArc - supports[k].alongArc;
                const double f = supports[k].value - supports[i].value, det = a * e - b * d;
                if (std::abs(det) > 1e-14) offer((c * e - b * f) / det, (a * f - c * d) / det);
            }
        }
    return best;
}

}  // namespace

SheetSearch::SheetSearch(const instrument::Bur& bur) {
    for (const instrument::MedialCurve& curve : bur.medialAxis()) {
        if (curve.onAxis || curve.balls.empty()) continue;
        Sheet sheet;
        for (const instrument::MedialBall& ball : curve.balls) {
            double u = 0.0;
            if (!sheet.u.empty()) {
                const double length = std::hypot(ball.rhoMm - sheet.rho.back(), ball.zMm - sheet.z.back());
                if (length < 1e-10) continue;
                u = sheet.u.back() + length;
                sheet.steepest = std::max(sheet.steepest, std::abs(ball.radiusMm - sheet.radius.back()) / length);
            }
            sheet.u.push_back(u);
            sheet.rho.push_back(ball.rhoMm);
            sheet.z.push_back(ball.zMm);
            sheet.radius.push_back(ball.radiusMm);
            sheet.maxRho = std::max(sheet.maxRho, ball.rhoMm);
        }
        const auto reachFrom = [&](double z) {
            double reach = 0.0;
            for (std::size_t i = 0; i < sheet.u.size(); ++i)
                reach = std::max(reach, sheet.radius[i] + std::hypot(sheet.rho[i], sheet.z[i] - z));
            return reach;
        };
        double low = -1.0, high = bur.lengthMm() + 1.0;  // the reach is convex in z
        for (int i = 0; i < 80; ++i) {
            const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
            (reachFrom(a) < reachFrom(b) ? high : low) = reachFrom(a) < reachFrom(b) ? b : a;
        }
        sheet.centreZ = 0.5 * (low + high);
        sheet.reachMm = reachFrom(sheet.centreZ);
        sheets_.push_back(std::move(sheet));
    }
    cells_.resize(kMaxCells);
    next_.resize(kMaxCells);
}

void SheetSearch::search(const ExactSurface& surface, const core::Pose& burInTooth, BallDepth& best) noexcept {
    if (sheets_.empty()) return;
    const core::Mat3 rotation = burInTooth.orientation.toRotationMatrix();
    const Frame frame{burInTooth.positionMm, rotation.col(0), rotation.col(1), rotation.col(2)};
    for (const Sheet& sheet : sheets_) {
        const Vec3 centre = frame.tip + sheet.centreZ * frame.z;
        const double far = surface.farBound(centre);
        if (far > 0.0 && sheet.reachMm - far <= best.depthMm) continue;
        std::uint32_t seed = best.triangle;
        if (far > 0.0) {
            const BallDepth around = surface.ball(centre, sheet.reachMm, seed, sheet.reachMm - best.depthMm);
            if (around.triangle == geometry::kNoTriangle) continue;
            seed = around.triangle;
        }
        searchSheet(surface, sheet, frame, seed, best);
    }
}

SheetSearch::Spot SheetSearch::spotAt(const Sheet& sheet, const Frame& frame, double u, double angle) const noexcept {
    const std::size_t last = sheet.u.size() - 1;
    std::size_t low = 0, high = last;
    while (high - low > 1) {
        const std::size_t middle = (low + high) / 2;
        (u < sheet.u[middle] ? high : low) = middle;
    }
    const double span = sheet.u[high] - sheet.u[low], scale = span > 0.0 ? 1.0 / span : 0.0,
                 t = (u - sheet.u[low]) * scale;
    const double dRho = (sheet.rho[high] - sheet.rho[low]) * scale, dZ = (sheet.z[high] - sheet.z[low]) * scale;
    const double rho = sheet.rho[low] + t * (sheet.rho[high] - sheet.rho[low]);
    const double z = sheet.z[low] + t * (sheet.z[high] - sheet.z[low]);
    const double c = std::cos(angle), s = std::sin(angle);
    const Vec3 outward = c * frame.x + s * frame.y, around = c * frame.y - s * frame.x;
    Spot spot;
    spot.centre = frame.tip + rho * outward + z * frame.z;
    spot.alongU = dRho * outward + dZ * frame.z;
    spot.arcPerRad = std::max(rho, kArcFloorMm);
    spot.alongArc = (rho / spot.arcPerRad) * around;
    spot.radius = sheet.radius[low] + t * (sheet.radius[high] - sheet.radius[low]);
    spot.radiusAlongU = (sheet.radius[high] - sheet.radius[low]) * scale;
    return spot;
}

void SheetSearch::searchSheet(const ExactSurface& surface, const Sheet& sheet, const Frame& frame, std::uint32_t seed,
                              BallDepth& best) noexcept {
    const double length = sheet.u.back();
    const int along = std::max(1, static_cast<int>(std::ceil(length / kFirstCellMm)));
    const int around = std::clamp(static_cast<int>(std::ceil(2.0 * kPi * sheet.maxRho / kFirstCellMm)), 4, 32);
    std::size_t count = 0;
    for (int i = 0; i < along; ++i)
        for (int j = 0; j < around; ++j)
            if (count < kMaxCells)
                cells_[count++] = {(i + 0.5) * length / along,
                                   0.5 * length / along,
                                   (j + 0.5) * 2.0 * kPi / around,
                                   kPi / around,
                                   0.0,
                                   0.0,
                                   geometry::kNoTriangle};
    bool split = true;
    while (split) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count; ++i) {
            Cell cell = cells_[i];
            const Spot spot = spotAt(sheet, frame, cell.u, cell.angle);
            // The outermost ball of the cell: along the sheet, then around the axis.
            const double rho =
                std::min(sheet.maxRho, std::abs((spot.centre - frame.tip).cross(frame.z).norm()) + cell.halfU);
            const double arc = rho * cell.halfAngle;
            const double reach = std::hypot(cell.halfU, arc) + 0.5 * arc * cell.halfAngle + cell.halfU * sheet.steepest;
            const double far = surface.farBound(spot.centre);
            if (far > 0.0 && spot.radius + reach - far <= best.depthMm) continue;
            const double sure = 0.2;
            const double bound =
                far > sure ? spot.radius + reach - best.depthMm : std::numeric_limits<double>::infinity();
            const BallDepth found = surface.ball(spot.centre, spot.radius, seed, bound);
            if (found.triangle == geometry::kNoTriangle) continue;
            seed = found.triangle;
            if (found.depthMm > best.depthMm) best = found;
            cell.value = found.depthMm;
            cell.upper = found.depthMm + reach;
            if (found.inside) {
                // No ball of the cell is deeper than its own distance to this surface point allows: to first order the
                // slope at the middle, and a sphere's curvature beyond.
                const Vec3 to = found.surfaceMm - spot.centre;
                const double d = to.norm(),
                             arcHalf = spot.arcPerRad * cell.halfAngle * (rho / std::max(spot.arcPerRad, rho));
                if (d > 1e-6) {
                    const double slopeU = std::abs(spot.radiusAlongU - to.dot(spot.alongU) / d);
                    const double slopeArc = std::abs(to.dot(spot.alongArc) / d);
                    const double move = std::hypot(cell.halfU, arc);
                    cell.upper = std::min(cell.upper, found.depthMm + slopeU * cell.halfU + slopeArc * arcHalf +
                                                          0.5 * move * move / d + 2.0 * arc * cell.halfAngle);
                }
            }
            cell.triangle = found.triangle;
            cells_[kept++] = cell;
        }
        count = 0;
        split = false;
        for (std::size_t i = 0; i < kept; ++i) {
            const Cell& cell = cells_[i];
            if (cell.upper <= best.depthMm + kToleranceMm) continue;
            const double arc = sheet.maxRho * cell.halfAngle;
            const bool splitU = cell.halfU > 0.5 * kCellMm && cell.halfU >= 0.5 * arc,
                       splitArc = arc > 0.5 * kCellMm && arc >= 0.5 * cell.halfU;
            const std::size_t needed = (splitU ? 2u : 1u) * (splitArc ? 2u : 1u);
            if (count + needed > kMaxCells) break;
            for (int a = 0; a < (splitU ? 2 : 1); ++a)
                for (int b = 0; b < (splitArc ? 2 : 1); ++b) {
                    Cell part = cell;
                    if (splitU) {
                        part.halfU *= 0.5;
                        part.u += (a == 0 ? -1.0 : 1.0) * part.halfU;
                    }
                    if (splitArc) {
                        part.halfAngle *= 0.5;
                        part.angle += (b == 0 ? -1.0 : 1.0) * part.halfAngle;
                    }
                    next_[count++] = part;
                }
            split = split || splitU || splitArc;
        }
        std::swap(cells_, next_);
    }
    std::sort(cells_.begin(), cells_.begin() + static_cast<std::ptrdiff_t>(count), [](const Cell& a, const Cell& b) {
        return a.value != b.value ? a.value > b.value : a.u != b.u ? a.u < b.u : a.angle < b.angle;
    });
    std::array<std::array<double, 4>, kMaxClimbs> tops;
    int climbs = 0;
    for (std::size_t i = 0; i < count && climbs < kMaxClimbs; ++i) {
        const Cell& cell = cells_[i];
        if (cell.upper <= best.depthMm + kToleranceMm) continue;
        const auto isNear = [&](double u, double angle) {
            return std::abs(u - cell.u) < 1.5 * kCellMm &&
                   sheet.maxRho * std::abs(std::remainder(angle - cell.angle, 2.0 * kPi)) < 1.5 * kCellMm;
        };
        bool known = false;
        for (int c = 0; c < climbs && !known; ++c) {
            const auto& top = tops[static_cast<std::size_t>(c)];
            known = isNear(top[0], top[1]) || isNear(top[2], top[3]);
        }
        if (known) continue;
        auto& top = tops[static_cast<std::size_t>(climbs++)];
        top = {cell.u, cell.angle, 0.0, 0.0};
        climb(surface, sheet, frame, cell.u, cell.angle, cell.triangle, kCellMm, best, top[2], top[3]);
    }
}

void SheetSearch::climb(const ExactSurface& surface, const Sheet& sheet, const Frame& frame, double u, double angle,
                        std::uint32_t seed, double window, BallDepth& best, double& endU,
                        double& endAngle) const noexcept {
    constexpr int kKnown = 8, kActive = 4;
    std::uint32_t known[kKnown];
    int knownCount = 0, oldest = 0;
    const auto remember = [&](std::uint32_t triangle) {
        for (int i = 0; i < knownCount; ++i)
            if (known[i] == triangle) return;
        if (knownCount < kKnown)
            known[knownCount++] = triangle;
        else
            known[oldest++ % kKnown] = triangle;
    };
    Spot spot = spotAt(sheet, frame, u, angle);
    BallDepth here = surface.ball(spot.centre, spot.radius, seed);
    endU = u;
    endAngle = angle;
    if (here.triangle == geometry::kNoTriangle) return;
    remember(here.triangle);
    for (int step = 0; step < kMaxSteps && window > kFinalWindowMm; ++step) {
        if (here.depthMm + 4.0 * window < best.depthMm) break;  // another top is higher than what is left to climb
        Support supports[kActive];
        int count = 0;
        const auto addSupport = [&](const Vec3& outOfTooth, double depth) {
            const Support s{depth, spot.radiusAlongU - outOfTooth.dot(spot.alongU), -outOfTooth.dot(spot.alongArc)};
            if (count < kActive) {
                supports[count++] = s;
                return;
            }
            // Full: the one that limits least makes room. The first is the surface that is touched and stays.
            int most = 1;
            for (int i = 2; i < kActive; ++i)
                if (supports[i].value > supports[most].value) most = i;
            if (s.value < supports[most].value) supports[most] = s;
        };
        const Vec3 away = spot.centre - here.surfaceMm;
        const double distance = away.norm();
        addSupport(distance > 1e-9 ? Vec3((here.inside ? -1.0 : 1.0) * away / distance) : surface.outward(here),
                   here.depthMm);
        if (here.inside)
            for (int i = 0; i < knownCount; ++i) {
                if (known[i] == here.triangle) continue;
                const Vec3 q = surface.closestOn(known[i], spot.centre);
                const Vec3 to = q - spot.centre;
                const double d = to.norm();
                if (d > 1e-9 && spot.radius + d < here.depthMm + 4.0 * window) addSupport(to / d, spot.radius + d);
            }
        double stepU = 0.0, stepArc = 0.0;
        const double lowU = std::max(-window, -u), highU = std::min(window, sheet.u.back() - u);
        const double hoped = solve(supports, count, lowU, highU, window, stepU, stepArc) - here.depthMm;
        if (hoped < kToleranceMm) {
            window *= 0.25;
            continue;
        }
        const double newU = std::clamp(u + stepU, 0.0, sheet.u.back()), newAngle = angle + stepArc / spot.arcPerRad;
        const Spot there = spotAt(sheet, frame, newU, newAngle);
        const BallDepth found = surface.ball(there.centre, there.radius, here.triangle);
        const double gained = found.depthMm - here.depthMm;  // nothing found: minus infinity
        if (found.triangle != geometry::kNoTriangle) remember(found.triangle);
        if (gained > 0.0) {
            u = newU;
            angle = newAngle;
            spot = there;
            here = found;
        }
        window *= gained > 0.75 * hoped ? 1.5 : gained > 0.25 * hoped ? 0.7 : 0.3;
    }
    if (here.depthMm > best.depthMm) best = here;
    endU = u;
    endAngle = angle;
}

}  // namespace handpiece::contact
