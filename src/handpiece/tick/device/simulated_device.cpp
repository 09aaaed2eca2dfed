// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/device/simulated_device.h"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/tick/device/capability.h"
#include "handpiece/tick/device/units.h"

namespace handpiece::device {
namespace {

using core::Vec3;

constexpr double kMaxDelayS = 0.05;   // fits the ring of commands at 8 kHz
constexpr double kSameTimeS = 1e-10;  // sums of periods differ by rounding

}  // namespace

const std::vector<Hand>& hands() {
    static const std::vector<Hand> list{
        {"loose", 0.01, 0.0005, 0.05}, {"normal", 0.05, 0.003, 0.3}, {"stiff", 0.10, 0.010, 1.0}};
    return list;
}

const Hand& handByName(std::string_view name) {
    for (const Hand& h : hands()) {
        if (h.name == name) return h;
    }
    throw core::Error(fmt::format("no hand is called \"{}\"", name), "hand", "there are loose, normal and stiff");
}

SimulatedDevice::SimulatedDevice(SimulatedDeviceSettings settings, Motion motion)
    : settings_(std::move(settings)), motion_(std::move(motion)), position_(motion_.at(0.0).burInTooth.positionMm) {
    validate(settings_.capability);
    const auto require = [](bool good, const char* what, double value) {
        if (!good) throw core::Error(fmt::format("{} of {}", what, value), "simulated device");
    };
    require(settings_.massKg > 0 && settings_.massKg < 100, "a mass [kg]", settings_.massKg);
    require(settings_.frictionN >= 0 && settings_.frictionN < 100, "a friction [N]", settings_.frictionN);
    require(settings_.delayS >= 0 && settings_.delayS <= kMaxDelayS, "a delay [s]", settings_.delayS);
    require(settings_.subStepS >= 1e-7 && settings_.subStepS <= 1e-3, "a sub-step [s]", settings_.subStepS);
    const Hand& h = settings_.hand;
    require(h.massKg >= 0 && h.massKg < 100, "a hand's mass [kg]", h.massKg);
    require(h.dampingNSPerMm >= 0 && h.dampingNSPerMm < 1, "a hand's damping [N s/mm]", h.dampingNSPerMm);
    require(h.stiffnessNPerMm >= 0 && h.stiffnessNPerMm < 100, "a hand's stiffness [N/mm]", h.stiffnessNPerMm);
}

Reading SimulatedDevice::read(double periodS) noexcept {
    if (started_) advance(periodS);
    started_ = true;
    const TimedPose intended = motion_.at(time_);
    Reading reading;
    reading.burInTooth = {quantised(position_), intended.burInTooth.orientation};
    reading.pedal = intended.pedal;
    return reading;
}

void SimulatedDevice::command(const Vec3& forceN, const Vec3& /*torqueNmm: no torque axes*/) noexcept {
    if (count_ == pending_.size()) {
        // Cannot happen within kMaxDelayS at 8 kHz; at faster rates the oldest takes effect early.
        first_ = (first_ + 1) % pending_.size();
        --count_;
    }
    pending_[(first_ + count_) % pending_.size()] = {time_ + settings_.delayS, forceN};
    ++count_;
    applyCommandsDue();
}

void SimulatedDevice::applyCommandsDue() noexcept {
    while (count_ > 0 && pending_[first_].atS <= time_ + kSameTimeS) {
        variationN_ += (pending_[first_].forceN - applied_).norm();
        applied_ = pending_[first_].forceN;
        first_ = (first_ + 1) % pending_.size();
        --count_;
    }
}

void SimulatedDevice::advance(double periodS) noexcept {
    const double start = time_;
    const Vec3 from = motion_.at(start).burInTooth.positionMm;
    const Vec3 to = motion_.at(start + periodS).burInTooth.positionMm;
    const int steps = std::max(1, static_cast<int>(std::ceil(periodS / settings_.subStepS - 1e-9)));
    const double h = periodS / steps;
    const Vec3 intendedVelocity = (to - from) / periodS;
    const double mass = (settings_.massKg + settings_.hand.massKg) / kKgPerUnit;
    const double k = settings_.hand.stiffnessNPerMm, b = settings_.hand.dampingNSPerMm;
    // The hand's spring and damper act at the end of the step: stable whatever their size.
    const double response = 1.0 / (mass + h * b + h * h * k);
    const double stick = settings_.frictionN * h * response;
    for (int i = 0; i < steps; ++i) {
        const Vec3 before = position_;
        const Vec3 intendedAfter = from + (to - from) * ((i + 1.0) / steps);
        if (settings_.rigidHand) {
            position_ = intendedAfter;
            velocity_ = intendedVelocity;
        } else {
            Vec3 v =
                response * (mass * velocity_ + h * (applied_ + b * intendedVelocity + k * (intendedAfter - position_)));
            const double speed = v.norm();
            v *= speed > stick ? 1.0 - stick / speed : 0.0;
            velocity_ = v;
            position_ += h * v;
        }
        workNmm_ += applied_.dot(position_ - before);
        time_ = start + periodS * ((i + 1.0) / steps);
        applyCommandsDue();
    }
}

Vec3 SimulatedDevice::quantised(const Vec3& p) const noexcept {
    const double step = settings_.capability.encoderStepMm;
    if (settings_.rigidHand || !settings_.quantise || step <= 0.0) return p;
    return {std::round(p.x() / step) * step, std::round(p.y() / step) * step, std::round(p.z() / step) * step};
}

}  // namespace handpiece::device
