// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/input/way_over.h"

#include <algorithm>

#include "handpiece/base/core/rotation.h"

namespace handpiece::input {
namespace {

using core::Pose;
using core::Vec3;

constexpr double kClearMm = 0.15;  // of an instrument that travels
constexpr double kLeastStepMm = 0.1;
constexpr int kMostSteps = 120;
constexpr double kLengthMm = 100.0;  // of the instrument: what turns with it
constexpr double kHighestMm = 40.0;
constexpr double kArrivedMm = 0.2, kSoTurnedRad = 0.05;

template <class Clear>
bool isFree(const Pose& from, const Pose& to, const Clear& clearOf) {
    const double angle = core::angleBetween(from.orientation, to.orientation);
    const double length = (to.positionMm - from.positionMm).norm() + angle * kLengthMm;
    if (length < 1e-9) return true;
    const double asked = std::min({kClearMm, clearOf(from), clearOf(to)}) - 1e-3;
    double at = 0.0;
    for (int i = 0; i < kMostSteps && at < length; ++i) {
        const double share = at / length;
        Pose pose;
        pose.positionMm = from.positionMm + share * (to.positionMm - from.positionMm);
        pose.orientation = angle > 0.0 ? core::interpolated(from.orientation, share, to.orientation) : from.orientation;
        const double clear = clearOf(pose);
        if (clear < asked) return false;
        at += std::max(clear - asked, kLeastStepMm + 0.02 * angle * kLengthMm);
    }
    return true;
}

}  // namespace

bool isWayFree(HandFeel& feel, const Pose& from, const Pose& to) {
    return isFree(from, to, [&](const Pose& p) { return std::min(feel.ofBur(p).mm, feel.ofBodyMm(p)); });
}

Pose nextOnWayOver(HandFeel& feel, const Pose& from, const Pose& to, const Vec3& up) {
    const auto clearOf = [&](const Pose& p) { return feel.ofBur(p).mm; };
    const bool isTurned = core::angleBetween(from.orientation, to.orientation) < kSoTurnedRad;
    if (isTurned && isFree(from, to, clearOf)) return to;
    const double fromHigh = from.positionMm.dot(up), toHigh = to.positionMm.dot(up);
    for (double over = 0.0; over <= kHighestMm; over = over == 0.0 ? 1.0 : 1.8 * over) {
        const double level = std::max(fromHigh, toHigh) + over;
        const Pose above{from.positionMm + (level - fromHigh) * up, from.orientation};
        const Pose aboveTo{to.positionMm + (level - toHigh) * up, to.orientation};
        if (!isFree(from, above, clearOf) || !isFree(aboveTo, to, clearOf)) continue;
        if (!isFree({above.positionMm, to.orientation}, aboveTo, clearOf)) continue;
        // Turned on the way across.
        return (above.positionMm - from.positionMm).norm() > kArrivedMm ? above : aboveTo;
    }
    return to;
}

}  // namespace handpiece::input
