// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How stiff and how damped a contact a device renders stably without help, found by simulating it in three hands.

#include "handpiece/base/core/progress.h"

namespace handpiece::stability {

/// What is known of a device, at the hand.
struct DeviceFigures {
    double massKg = 0.045, frictionN = 0.05;
    double delayS = 0.001;  ///< from a reading to the force that answers it
    double rateHz = 1000.0, encoderStepMm = 0.055, maxForceN = 3.3;
    double velocityTauS = 0.005;  ///< low pass of the velocity, as in force::Parameters
};

struct StableLimits {
    double stiffnessNPerMm = 0.0, dampingNSPerMm = 0.0;  ///< together; what to set
    double withoutDampingNPerMm = 0.0;                   ///< the stiffness that is stable alone
    double foundNPerMm = 0.0;  ///< the largest that was passive and came to rest; what to set is 0.8 of it
};

/// Off the tick; a second or so. A wall is tapped at 60 mm/s by a loose, a normal and a stiff hand, each coming to rest
/// at 1 N or half of what the device can; stable is what keeps the bound of docs/physics.md#passivity at that stiffness
/// and leaves no growing force at rest. Searched for 0, 0.0005, 0.001, 0.002, 0.005 and 0.01 N s/mm and from 0.02 to
/// 20 N/mm. Zero stiffness when not even the softest is stable. Throws core::Error for figures out of range.
[[nodiscard]] StableLimits limitsFor(const DeviceFigures& device, const core::Progress& progress = {});

}  // namespace handpiece::stability
