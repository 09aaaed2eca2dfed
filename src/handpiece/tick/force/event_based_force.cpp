// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/event_based_force.h"

#include <algorithm>

namespace handpiece::force {
namespace {

using core::Vec3;

constexpr double kKnockShare = 0.3, kHumShare = 0.15;  // of the device's largest force, at most

/// Out of the tooth where the bur has struck it: where the proxy holds it, or where the depth points.
Vec3 normalOf(const Touch& touch) noexcept {
    const Vec3 spring = touch.proxyInTooth.positionMm - touch.deviceInTooth.positionMm;
    const double length = spring.norm();
    return length > 1e-9 ? Vec3(spring / length) : touch.depth.normal;
}

}  // namespace

EventBasedForce::EventBasedForce(const Limits& limits, double rateHz) noexcept
    : limits_(limits), knock_(rateHz, kKnockShare * limits.maxForceN), hum_(rateHz, kHumShare * limits.maxForceN) {}

const Vec3& EventBasedForce::add(const ForceModel& feel, const Touch& touch, const ForceCommand& command,
                                 const BurAtWork& bur, double periodS) noexcept {
    const Parameters& parameters = feel.parameters();
    const Vec3 last = forceN_;
    forceN_ = command.forceN;
    forceLimited_ = slopeLimited_ = false;
    const bool wasAdding = adding_;
    const bool held = feel.guard().faulted() || feel.waiting();
    ContactTransient::Strike strike;
    strike.touching = touch.touching && !held;
    if (strike.touching) {
        strike.normal = normalOf(touch);
        strike.velocityMmS = feel.velocityMmS();
        strike.shares = touch.patches.tissueShare;
        strike.tissue = touch.tissue;
    }
    Vec3 added = feel.guard().gain() * knock_.step(strike, parameters.transients, periodS);
    // A tooth does not pull: of the wave's other half only what the contact's own force outweighs.
    const double along = added.dot(knock_.normal()), room = std::max(0.0, command.forceN.dot(knock_.normal()));
    if (along < -room) added *= room / -along;

    if (held) {
        hum_.stop();
    } else {
        const BurHum::Work work{
            strike.touching ? command.loadN.norm() : 0.0, bur.speedRpm, bur.feedMmS, strike.shares, touch.tissue,
            limits_.maxForceN - command.forceN.norm()};
        const double hum = hum_.step(work, parameters.vibration, periodS);
        added += feel.guard().gain() * hum * (touch.proxyInTooth.orientation * Vec3::UnitX());
    }
    adding_ = knock_.amplitudeN() > 0.0 || hum_.amplitudeN() > 0.0;
    if (!adding_ && !wasAdding) return forceN_;

    forceN_ += added;
    const double size = forceN_.norm();
    forceLimited_ = size > limits_.maxForceN;
    if (forceLimited_) forceN_ *= limits_.maxForceN / size;
    const Vec3 change = forceN_ - last;
    const double most = limits_.maxForceSlopeNPerS * periodS;
    slopeLimited_ = change.norm() > most;
    if (slopeLimited_) {
        forceN_ = last + change * (most / change.norm());
        adding_ = true;  // the force is still on its way
    }
    return forceN_;
}

}  // namespace handpiece::force
