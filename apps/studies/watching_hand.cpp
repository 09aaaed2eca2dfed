// SPDX-License-Identifier: Apache-2.0
#include "studies/watching_hand.h"

#include <algorithm>

namespace handpiece::studies {
namespace {

using core::Vec3;

// How a steady hand goes about it; judgements, not measured on people.
constexpr double kFreeMm = 0.01, kHeldMm = 0.05;  ///< left to go: at full speed, and nearly standing
constexpr double kLeastPace = 0.02;
constexpr double kBeyond = 20.0;    ///< presses so many times beyond what is left
constexpr double kMostLoadN = 1.0;  ///< `handpiece run` presses with as much
constexpr double kMostBeyondMm = 4.0, kPressS = 0.01;

}  // namespace

device::Reading WatchingHand::read(double periodS) noexcept {
    if (started_) {
        const double left = leftMm_.norm();
        const double pace = std::clamp((kHeldMm - left) / (kHeldMm - kFreeMm), kLeastPace, 1.0);
        timeS_ = std::min(timeS_ + pace * periodS, motion_.durationS());
        Vec3 wanted = kBeyond * leftMm_;
        const double most = loadN_ > kMostLoadN ? pushMm_.norm() * kMostLoadN / loadN_ : kMostBeyondMm;
        if (wanted.norm() > most) wanted *= most / wanted.norm();
        pushMm_ += std::min(1.0, periodS / kPressS) * (wanted - pushMm_);
    }
    started_ = true;
    const device::TimedPose intended = motion_.at(timeS_);
    positionMm_ = intended.burInTooth.positionMm + pushMm_;
    device::Reading reading;
    reading.burInTooth = {positionMm_, intended.burInTooth.orientation};
    reading.pedal = intended.pedal;
    return reading;
}

void WatchingHand::command(const Vec3& forceN, const Vec3& /*torqueNmm: no torque axes*/) noexcept {
    forceN_ = forceN;
}

void WatchingHand::watch(const Vec3& tipMm, const Vec3& loadN) noexcept {
    leftMm_ = motion_.at(timeS_).burInTooth.positionMm - tipMm;
    loadN_ = loadN.norm();
    // A bur that hangs free is where the hand is.
    if (!(loadN_ > 0.0)) leftMm_.setZero();
}

}  // namespace handpiece::studies
