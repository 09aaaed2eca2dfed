// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a person may turn about the force, and what the device forbids.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "handpiece/base/core/vec.h"
#include "handpiece/model/case/tissue.h"
#include "handpiece/tick/force/proxy.h"

namespace handpiece::force {

/// The law of force (force_law.h). Those of one's own have the numbers after these, in the order in which they are
/// added.
enum class LawId : std::uint8_t {
    proxy,    ///< Kelvin-Voigt between proxy and device: right in slots and on thin walls
    penalty,  ///< the paper's: depth and approach speed along the normal at the device's pose
};
/// "proxy", "penalty" or one's own; throws core::Error otherwise.
[[nodiscard]] LawId lawByName(std::string_view name);
[[nodiscard]] const std::string& nameOf(LawId law);

/// The part of a device's capability record that bounds the force.
struct Limits {
    double maxForceN = 3.3;
    double maxStiffnessNPerMm = 0.5;
    double maxDampingNSPerMm = 0.005;
    double maxForceSlopeNPerS = 5000;
    double maxTorqueNmm = 0.0;  ///< 0: no torque axes; torque is reported all the same
};

/// One tissue through this device.
struct TissueFeel {
    double stiffnessFraction = 1.0;  ///< of Limits::maxStiffnessNPerMm
    double dampingNSPerMm = 0.002;
    double friction = 0.0;  ///< Coulomb, of a still bur that slides
};

/// A short decaying sinusoid along the surface's normal when the bur strikes it.
/// docs/physics.md#crisp-contact-and-vibration.
struct ContactTransients {
    bool on = false;
    double gain = 1.0;  ///< on its amplitude, 0..4
};

/// What the turning bur makes the hand feel between 100 and 400 Hz. docs/physics.md#crisp-contact-and-vibration.
struct CuttingVibration {
    bool on = false;
    double gain = 1.0;  ///< on its amplitude, 0..4
};

/// Set off the tick, staged into it. defaultParameters() fills the tissues from the tooth's table.
struct Parameters {
    LawId law = LawId::proxy;
    double stiffnessMultiplier = 1.0;  ///< on every tissue; the device's limits stay
    double dampingMultiplier = 1.0;
    double frictionMultiplier = 1.0;      ///< 0: a wall without friction
    double cuttingForceMultiplier = 1.0;  ///< on the sideways force of the turning bur
    std::array<TissueFeel, cases::kTissueCount> tissues{};
    double penaltyStiffnessNPerMm = 0.5;  ///< of the penalty law, times the multiplier
    double penaltyDampingNSPerMm = 0.002;
    double velocityTauS = 0.005;        ///< low pass of the velocity
    double dampingRampMm = 0.05;        ///< the damper grows from none to all over this depth
    core::Vec3 gripMm{0.0, 0.0, 80.0};  ///< where the fingers hold, bur frame: torque is about it
    double fadeInS = 0.2;               ///< after a fault
    ProxySettings proxy;
    ContactTransients transients;  ///< felt, but no part of the load that cuts
    CuttingVibration vibration;    ///< likewise
};
/// docs/physics.md#force and docs/physics.md#tissues.
[[nodiscard]] Parameters defaultParameters(const cases::TissueTable& tissues = cases::builtInTissues());
/// Throws core::Error naming the value that is not finite or out of range.
void validate(const Parameters& parameters);

}  // namespace handpiece::force
