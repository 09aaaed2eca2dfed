// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/safety/gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/rt/second.h"
#include "handpiece/tick/device/capability.h"

namespace handpiece::safety {
namespace {

using link::DeviceFault;
using link::DriverCommand;
using link::DriverReading;
using Triple = std::array<double, 3>;
using rt::kNsPerS;
constexpr double kMaxMm = 1e4, kMaxN = 1e6;  // beyond these a number is no place and no force
constexpr double kUnitWithin = 0.01;         // of a quaternion's length
constexpr double kJitterMm = 1.0;            // two readings close in time may differ by this all the same
constexpr double kMaxTurnRad = 0.6, kMaxTurnRadS = 100.0;
constexpr double kMinStepS = 1e-4;  // a release goes on by this at least, also when time does not

double secondsBetween(std::int64_t earlierNs, std::int64_t laterNs) noexcept {
    // In double: the difference of two times that are garbage does not overflow.
    return (static_cast<double>(laterNs) - static_cast<double>(earlierNs)) / kNsPerS;
}

bool finite(const Triple& v) noexcept {
    return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

double length(const Triple& v) noexcept {
    return core::hypot(v[0], v[1], v[2]);
}

Triple scaled(const Triple& v, double by) noexcept {
    return {v[0] * by, v[1] * by, v[2] * by};
}

/// At most `most` long.
Triple clamped(const Triple& v, double most, bool& did) noexcept {
    const double size = length(v);
    if (size <= most) return v;
    did = true;
    return most > 0.0 ? scaled(v, most / size) : Triple{};
}

/// From `from` towards `to`, by no more than `most`.
Triple stepped(const Triple& from, const Triple& to, double most, bool& did) noexcept {
    const Triple change{to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    const double size = length(change);
    if (!(size > most)) return to;
    did = true;
    const Triple part = scaled(change, most / size);
    return {from[0] + part[0], from[1] + part[1], from[2] + part[2]};
}

bool withinReach(const Triple& v, double most) noexcept {
    return std::abs(v[0]) <= most && std::abs(v[1]) <= most && std::abs(v[2]) <= most;
}

bool isUnit(const std::array<double, 4>& q) noexcept {
    const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    return std::abs(square - 1.0) < 2.0 * kUnitWithin;
}

/// Angle between two rotations; q and -q are the same one.
double turnRad(const std::array<double, 4>& a, const std::array<double, 4>& b) noexcept {
    const double dot = std::abs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]);
    return 2.0 * core::acos(std::min(1.0, dot));
}

}  // namespace

void validate(const GateSettings& s) {
    const auto require = [](bool good, const char* what, double value) {
        if (!good || !std::isfinite(value)) {
            throw core::Error(fmt::format("{} of {}", what, value), "safety gate", "correct the device's record")
                .as("gate-setting", {what, fmt::format("{}", value)});
        }
    };
    require(s.maxForceN > 0.0 && s.maxForceN <= 100.0, "a largest force [N]", s.maxForceN);
    require(s.maxTorqueNmm >= 0.0 && s.maxTorqueNmm <= 1e5, "a largest torque [N mm]", s.maxTorqueNmm);
    require(s.maxSlopeNPerS > 0.0 && s.maxSlopeNPerS <= 1e6, "a largest slope of force [N/s]", s.maxSlopeNPerS);
    require(s.maxTorqueSlopeNmmPerS > 0.0 && s.maxTorqueSlopeNmmPerS <= 1e9, "a largest slope of torque [N mm/s]",
            s.maxTorqueSlopeNmmPerS);
    require(s.fadeInS >= 0.0 && s.fadeInS <= 10.0, "a fade-in [s]", s.fadeInS);
    require(s.commandTimeoutS > 0.0 && s.commandTimeoutS <= 1.0, "a time-out of commands [s]", s.commandTimeoutS);
    require(s.readingTimeoutS > 0.0 && s.readingTimeoutS <= 1.0, "a time-out of readings [s]", s.readingTimeoutS);
    require(s.releaseS >= 0.0 && s.releaseS <= 0.05, "a release [s]", s.releaseS);
    require(s.maxSpeedMmS > 0.0 && s.maxSpeedMmS <= 1e5, "a largest speed [mm/s]", s.maxSpeedMmS);
    require(s.clearAfterS >= 0.0 && s.clearAfterS <= 10.0, "a time without doubt [s]", s.clearAfterS);
    require(s.warmFrom >= 0.0 && s.warmFrom < s.hotFrom, "a warm motor's temperature", s.warmFrom);
    require(s.hotFrom <= 10.0, "a hot motor's temperature", s.hotFrom);
}

GateSettings gateSettingsFor(const device::Capability& capability) {
    device::validate(capability);
    GateSettings settings;
    settings.maxForceN = capability.maxForceN;
    settings.maxTorqueNmm = capability.maxTorqueNmm;
    settings.maxSlopeNPerS = capability.maxForceSlopeNPerS;
    if (capability.maxTorqueNmm > 0.0)
        settings.maxTorqueSlopeNmmPerS = capability.maxTorqueNmm * capability.maxForceSlopeNPerS / capability.maxForceN;
    if (capability.rateHz > 0.0) settings.readingTimeoutS = std::max(settings.readingTimeoutS, 2.5 / capability.rateHz);
    validate(settings);
    return settings;
}

Gate::Gate(const GateSettings& settings) noexcept : settings_(settings) {}

DeviceFault Gate::judgePose(const DriverReading& reading, double elapsedS) noexcept {
    const auto& q = reading.orientation;
    const bool numbers = finite(reading.positionMm) && std::isfinite(q[0]) && std::isfinite(q[1]) &&
                         std::isfinite(q[2]) && std::isfinite(q[3]) && std::isfinite(reading.motorTemperature) &&
                         std::isfinite(reading.pedal);
    if (!numbers) return DeviceFault::notFinite;
    if (!withinReach(reading.positionMm, kMaxMm) || !isUnit(q)) return DeviceFault::badData;
    const bool seen = posed_;
    const DriverReading before = lastReading_;
    lastReading_ = reading;
    posed_ = true;
    if (!seen) return DeviceFault::none;
    const Triple moved{reading.positionMm[0] - before.positionMm[0], reading.positionMm[1] - before.positionMm[1],
                       reading.positionMm[2] - before.positionMm[2]};
    const bool jumped = length(moved) > kJitterMm + settings_.maxSpeedMmS * elapsedS ||
                        turnRad(q, before.orientation) > kMaxTurnRad + kMaxTurnRadS * elapsedS;
    return jumped ? DeviceFault::jumped : DeviceFault::none;
}

DeviceFault Gate::judgeCommand(const DriverCommand& latest, std::int64_t nowNs) noexcept {
    if (latest.number == 0) return DeviceFault::starting;
    // By its own stamp, and by when it was first seen here: a stamp of the future does not keep it young.
    if (latest.number != number_) {
        number_ = latest.number;
        commandSinceNs_ = nowNs;
    }
    const double ageS = secondsBetween(latest.timeNs, nowNs);
    if (!(std::abs(ageS) <= settings_.commandTimeoutS)) return DeviceFault::tickStalled;
    if (!(secondsBetween(commandSinceNs_, nowNs) <= settings_.commandTimeoutS)) return DeviceFault::tickStalled;
    if (!finite(latest.forceN) || !finite(latest.torqueNmm)) return DeviceFault::notFinite;
    if (!withinReach(latest.forceN, kMaxN) || !withinReach(latest.torqueNmm, kMaxN * 1e3))
        return DeviceFault::notFinite;
    return DeviceFault::none;
}

DeviceFault Gate::judge(const DriverReading& reading, const DriverCommand& latest, std::int64_t nowNs) noexcept {
    const double elapsedS = any_ ? secondsBetween(lastNs_, nowNs) : 0.0;
    if (reading.frame != frame_ || !any_) {
        frame_ = reading.frame;
        frameSinceNs_ = nowNs;
    }
    // Looked at whatever else is wrong: what comes next is compared with it.
    const DeviceFault pose = judgePose(reading, std::max(0.0, elapsedS));
    const DeviceFault command = judgeCommand(latest, nowNs);
    if (reading.trouble != DeviceFault::none)
        return reading.trouble <= DeviceFault::stopped ? reading.trouble : DeviceFault::badData;
    if (!(elapsedS >= 0.0 && elapsedS <= settings_.readingTimeoutS)) return DeviceFault::stalled;
    const double ageS = secondsBetween(reading.timeNs, nowNs);
    if (!(ageS >= -settings_.readingTimeoutS)) return DeviceFault::badData;
    if (!(ageS <= settings_.readingTimeoutS)) return DeviceFault::stalled;
    if (!(secondsBetween(frameSinceNs_, nowNs) <= settings_.readingTimeoutS)) return DeviceFault::stalled;
    if (pose != DeviceFault::none) return pose;
    if (reading.motorTemperature >= static_cast<float>(settings_.hotFrom)) return DeviceFault::hot;
    return command;
}

void Gate::believe(DeviceFault found, const DriverReading& reading, std::int64_t nowNs) noexcept {
    if (found == DeviceFault::none) {
        if (status_.trouble == DeviceFault::none) {
            status_.vendorCode = reading.vendorCode;  // a warning
            return;
        }
        if (!well_) {
            well_ = true;
            wellSinceNs_ = nowNs;
        }
        if (secondsBetween(wellSinceNs_, nowNs) < settings_.clearAfterS) return;
        status_.trouble = DeviceFault::none;
        status_.vendorCode = 0;
        fade_ = 0.0;
        fading_ = false;
        return;
    }
    well_ = false;
    status_.vendorCode = reading.vendorCode;
    if (found == status_.trouble) return;
    if (status_.trouble == DeviceFault::none) {
        held_ = sent_;
        release_ = 1.0;
    }
    status_.trouble = status_.last = found;
    status_.troubleSinceNs = nowNs;
    ++status_.troubles;
}

DriverCommand Gate::released(double elapsedS) noexcept {
    const double step = settings_.releaseS > 0.0 ? elapsedS / settings_.releaseS : 1.0;
    release_ -= step;
    // What is left of it is not worth another exchange: it would come too late at a slow servo.
    if (!(release_ >= 0.5 * step) || !(release_ <= 1.0)) release_ = 0.0;
    DriverCommand out;
    out.forceN = scaled(held_.forceN, release_);
    out.torqueNmm = scaled(held_.torqueNmm, release_);
    out.vibration = static_cast<float>(held_.vibration * release_);
    status_.gain = release_;
    return out;
}

DriverCommand Gate::let(const DriverCommand& latest, float temperature, double elapsedS) noexcept {
    DriverCommand out;
    const bool wanted = length(latest.forceN) > 0.0 || length(latest.torqueNmm) > 0.0 || latest.vibration > 0.0f;
    if (fading_) fade_ = settings_.fadeInS > 0.0 ? std::min(1.0, fade_ + elapsedS / settings_.fadeInS) : 1.0;
    fading_ = fading_ || wanted;  // from zero, at the first force
    const double heat =
        std::clamp((settings_.hotFrom - temperature) / (settings_.hotFrom - settings_.warmFrom), 0.0, 1.0);
    status_.gain = fade_ * heat;
    out.forceN = scaled(clamped(latest.forceN, settings_.maxForceN, status_.clamped), status_.gain);
    out.torqueNmm = scaled(clamped(latest.torqueNmm, settings_.maxTorqueNmm, status_.clamped), status_.gain);
    out.vibration = static_cast<float>(std::clamp(static_cast<double>(latest.vibration), 0.0, 1.0) * status_.gain);
    if (!std::isfinite(out.vibration)) out.vibration = 0.0f;
    out.forceN = stepped(sent_.forceN, out.forceN, settings_.maxSlopeNPerS * elapsedS, status_.slopeLimited);
    out.torqueNmm =
        stepped(sent_.torqueNmm, out.torqueNmm, settings_.maxTorqueSlopeNmmPerS * elapsedS, status_.slopeLimited);
    return out;
}

DriverCommand Gate::pass(const DriverReading& reading, const DriverCommand& latest, std::int64_t nowNs) noexcept {
    const DeviceFault found = judge(reading, latest, nowNs);
    const double elapsedS = any_ ? std::max(0.0, secondsBetween(lastNs_, nowNs)) : 0.0;
    lastNs_ = nowNs;
    any_ = true;
    believe(found, reading, nowNs);
    status_.clamped = status_.slopeLimited = false;
    status_.motorTemperature = reading.motorTemperature;
    DriverCommand out = status_.trouble == DeviceFault::none ? let(latest, reading.motorTemperature, elapsedS)
                                                             : released(std::max(elapsedS, kMinStepS));
    // Whatever was overlooked above: nothing but numbers within the limits leaves here.
    bool beyond = false;
    out.forceN = finite(out.forceN) ? clamped(out.forceN, settings_.maxForceN, beyond) : Triple{};
    out.torqueNmm = finite(out.torqueNmm) ? clamped(out.torqueNmm, settings_.maxTorqueNmm, beyond) : Triple{};
    out.timeNs = nowNs;
    out.number = latest.number;
    sent_ = out;
    return out;
}

}  // namespace handpiece::safety
