// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/rotor.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::instrument {
namespace {

constexpr double kRadSPerRpm = std::numbers::pi / 30.0;

}  // namespace

const std::vector<Drive>& drives() {
    // docs/physics.md#turbine says where each figure comes from.
    static const std::vector<Drive> all = {
        {"turbine", "high-speed air turbine", 400000, 1.2, 1e-5, 0.2},
        {"weak-turbine", "air turbine with worn bearings or too little air", 400000, 0.45, 1e-5, 0.075},
        {"low-speed", "contra-angle 1:1 on an electric motor (blue band)", 40000, 30.0, 2.5e-4, 5.0},
        {"speed-increasing", "contra-angle 1:5 on an electric motor (red band)", 200000, 6.0, 2e-5, 1.0},
    };
    return all;
}

const Drive& driveByName(std::string_view name) {
    std::string list;
    for (const Drive& drive : drives()) {
        if (drive.name == name) return drive;
        list += (list.empty() ? "" : ", ") + drive.name;
    }
    throw core::Error("there is no drive of this name", std::string(name), "choose one of " + list);
}

void validate(const Drive& drive) {
    const auto need = [&drive](double value, const char* what) {
        if (value > 0.0 && std::isfinite(value)) return;
        throw core::Error(fmt::format("{} is {}", what, value), "drive " + drive.name,
                          "give a finite value above zero");
    };
    need(drive.freeSpeedRpm, "the free speed [rpm]");
    need(drive.stallTorqueNmm, "the stall torque [N mm]");
    need(drive.inertiaNmmS2, "the inertia [N mm s2]");
    need(drive.bearingTorqueNmm, "the bearing's torque [N mm]");
}

Rotor::Rotor(const Drive& drive) noexcept {
    setDrive(drive);
}

void Rotor::setDrive(const Drive& drive) noexcept {
    freeRadS_ = drive.freeSpeedRpm * kRadSPerRpm;
    stallNmm_ = drive.stallTorqueNmm;
    inertia_ = drive.inertiaNmmS2;
    bearingNmm_ = drive.bearingTorqueNmm;
    stalled_ = false;
}

void Rotor::setSpeedRpm(double rpm) {
    if (!(rpm >= 0.0 && rpm * kRadSPerRpm <= std::fmax(freeRadS_, 1e6 * kRadSPerRpm)))
        throw core::Error(fmt::format("the bur turns at {} rpm", rpm), "rotor", "give a speed from 0 to 1,000,000 rpm");
    speedRadS_ = rpm * kRadSPerRpm;
    stalled_ = false;
}

void Rotor::step(double pedal, double loadTorqueNmm, double periodS) noexcept {
    // Written so that what is no number counts as zero.
    const double air = pedal > 0.0 ? std::fmin(pedal, 1.0) : 0.0;
    const double load = loadTorqueNmm > 0.0 ? loadTorqueNmm : 0.0;
    if (!(periodS > 0.0)) return;
    const double atRestNmm = stallNmm_ * air - bearingNmm_ * (1.0 - air);  // that the drive has left for a load
    const double slope = stallNmm_ * air / freeRadS_;
    const double accelerating = atRestNmm - load - slope * speedRadS_;
    // The speed is monotonous in time, so it stops on the way exactly when it would end below zero.
    const double rate = slope / inertia_;
    const double gained =
        slope > 0.0 ? accelerating / slope * (1.0 - core::exp(-rate * periodS)) : accelerating / inertia_ * periodS;
    const double after = speedRadS_ + gained;
    speedRadS_ = after > 0.0 ? after : 0.0;
    stalled_ = speedRadS_ == 0.0 && atRestNmm > 0.0 && load >= atRestNmm;
}

double Rotor::speedRpm() const noexcept {
    return speedRadS_ / kRadSPerRpm;
}

}  // namespace handpiece::instrument
