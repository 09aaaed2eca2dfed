// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/input/holding.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"

namespace handpiece::input {
namespace {

using core::Pose;
using core::Quat;
using core::Vec3;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kRollCosts = 0.4;  // of a tilt by as much: where the handle points matters less than the bur
constexpr double kHomeMm = 0.3;     // so much clearer than asked the student's own tilt is taken up again
constexpr int kMostLooks = 24;      // exact ones, for one place
constexpr double kRoughMm = 0.6;    // what is missing by more at the place of another orientation is not looked at

/// A turn of the student's own orientation: a tilt of the bur's axis, then one about it.
struct Turn {
    Quat tilt, roll;
    double costs;
};

/// By what they cost.
const std::vector<Turn>& turns() {
    static const std::vector<Turn> all = [] {
        std::vector<Turn> made;
        const double tilts[] = {0.0, 12.0, 25.0, 40.0, 60.0, 80.0};
        const double rolls[] = {0.0, 60.0, -60.0};
        for (const double tilt : tilts) {
            const int around = tilt == 0.0 ? 1 : 8;
            for (int i = 0; i < around; ++i) {
                const double at = 2.0 * std::numbers::pi * i / around;
                const Vec3 about(core::cos(at), core::sin(at), 0.0);
                for (const double roll : rolls)
                    made.push_back({core::rotationAbout(about, tilt * kDegree),
                                    core::rotationAbout(Vec3::UnitZ(), roll * kDegree),
                                    tilt + kRollCosts * std::abs(roll)});
            }
        }
        std::stable_sort(made.begin(), made.end(), [](const Turn& a, const Turn& b) { return a.costs < b.costs; });
        return made;
    }();
    return all;
}

/// By how much what is asked is missing at a pose; negative: it is more than that clear.
double missingMm(HandFeel& feel, const Pose& pose, const HoldingRequest& request, double share) {
    const double body = share * kBodyClearMm - feel.ofBodyMm(pose);
    return request.isOwn || body > 0.0 ? body : std::max(body, share * kSideClearMm - feel.ofSideMm(pose));
}

}  // namespace

std::optional<Quat> holdAt(HandFeel& feel, const view::Ray& ray, const HoldingRequest& request) {
    const auto touchOf = [&](const Quat& q) -> std::optional<Pose> {
        const LineOfSight sight = Leading(feel, q).alongRay(ray, request.hoverMm, request.farMm);
        if (!sight.touchAt) return {};
        return Pose{sight.at(*sight.touchAt), q};
    };
    const auto does = [&](const Quat& q, double share, double extraMm) {
        const std::optional<Pose> touch = touchOf(q);
        return !touch || missingMm(feel, *touch, request, share) <= -extraMm;
    };
    // Steady from pixel to pixel: the student's own where there is room for it, what is held where it does.
    const bool isHome = core::angleBetween(request.own, request.held) < 1e-6;
    if (!isHome && does(request.own, 1.0, kHomeMm)) return request.own;
    if (does(request.held, kKeptShare, 0.0)) return request.held;
    const std::optional<Pose> rough = touchOf(request.held);
    // With room if there is any, else where nothing is touched.
    std::optional<Quat> tight;
    int looks = 0;
    for (const Turn& turn : turns()) {
        const Quat q = (request.own * turn.tilt * turn.roll).normalized();
        if (rough && missingMm(feel, {rough->positionMm, q}, request, 1.0) > kRoughMm) continue;
        if (++looks > kMostLooks) break;
        const std::optional<Pose> touch = touchOf(q);
        if (!touch || missingMm(feel, *touch, request, 1.0) <= 0.0) return q;
        if (!tight && missingMm(feel, *touch, request, 0.0) <= 0.0) tight = q;
    }
    return tight;
}

}  // namespace handpiece::input
