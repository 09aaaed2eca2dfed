// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The test's hand on the double of the HD library.

#include "devices/drivers/double_hd.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/devices/link/shared_library.h"

namespace handpiece::drivers {

/// Its functions, of the library that the product loads too. Sets HANDPIECE_HD_LIBRARY to it.
struct HdDouble {
    DoubleReset* reset = nullptr;
    DoubleMove* move = nullptr;
    DoubleSprung* sprung = nullptr;
    DoublePress* press = nullptr;
    DoubleForce* force = nullptr;
    DoubleUnplug* unplug = nullptr;
    DoubleStall* stall = nullptr;
    DoubleWake* wake = nullptr;
    DoubleError* error = nullptr;
    DoubleCalibration* calibration = nullptr;
    DoubleSwitches* switches = nullptr;
    DoubleTemperature* temperature = nullptr;
    DoubleInitError* initError = nullptr;
    DoubleKill* kill = nullptr;
    DoubleCount* breaches = nullptr;
    DoubleText* lastBreach = nullptr;

    void place(int device, const core::Pose& pose) const {
        const double numbers[7] = {pose.positionMm.x(),  pose.positionMm.y(),  pose.positionMm.z(),
                                   pose.orientation.w(), pose.orientation.x(), pose.orientation.y(),
                                   pose.orientation.z()};
        move(device, numbers);
    }
    [[nodiscard]] core::Vec3 newton(int device) const {
        double out[6] = {};
        (void)force(device, out);
        return {out[0], out[1], out[2]};
    }
};

[[nodiscard]] const HdDouble& hdDouble();

}  // namespace handpiece::drivers
