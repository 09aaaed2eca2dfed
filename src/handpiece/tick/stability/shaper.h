// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The force on its way to a real arm: what its own friction takes is added, what its motors cannot hold for long is
/// taken back, and no more energy is handed to the hand than the tooth took in.

#include <cstdint>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/tick/device/device.h"
#include "handpiece/tick/stability/friction_compensation.h"
#include "handpiece/tick/stability/passivity_controller.h"
#include "handpiece/tick/stability/thermal_budget.h"

namespace handpiece::stability {

/// Each part can be switched off. Sources of the models: docs/physics.md#stability.
struct ShaperSettings {
    bool passivityController = true;
    bool frictionCompensation = false;
    bool thermalBudget = true;
    double forceScale = 1.0;  ///< on everything, 0..2, before the limits
    // The device, at the hand.
    double maxForceN = 3.3, continuousForceN = 0.88;
    double thermalTauS = 60.0;                    ///< of the motors; unchecked
    double frictionN = 0.0, frictionShare = 0.6;  ///< of the arm; share of it that is given back
    double encoderStepMm = 0.055;
    double stiffnessNPerMm = 0.5, dampingNSPerMm = 0.005;  ///< largest that the force model renders, at the hand
    double delayS = 0.002;                                 ///< from a reading to the force that answers it, at most
    double massKg = 0.045;                                 ///< effective, of the arm at the grip: the least that moves
};
/// Throws core::Error naming the value.
void validate(const ShaperSettings& settings);
/// Takes what a capability record says; friction, delay and mass stay as they are.
void limitTo(const device::Capability& atTheHand, ShaperSettings& settings);

struct ShaperStatus {
    double energyNmm = 0.0;      ///< observed: work done on the hand beyond what the bound allows; <= 0 when passive
    double heat = 0.0;           ///< 0..1 of the thermal budget
    double dissipatedNmm = 0.0;  ///< by the controller so far
    std::uint64_t engaged = 0;   ///< ticks in which the controller changed the force
    float thermalScale = 1.0f;
};

/// One device's shaper; the tick's thread. Device frame or any other fixed one: hand's millimetres and newtons.
///
/// In this order: force scale, friction given back, thermal budget, largest force, passivity. What is active by nature
/// comes before the controller, so that it spends energy only where the tooth took some in.
class Shaper {
  public:
    explicit Shaper(const ShaperSettings& settings) noexcept;
    /// The force to send for the one wanted, at the position just read. Never longer than maxForceN. `fresh`: the pose
    /// does not follow from the last one (start, trouble, clutch).
    [[nodiscard]] core::Vec3 shape(const core::Vec3& positionMm, const core::Vec3& wantedN, double periodS,
                                   bool fresh) noexcept HANDPIECE_REALTIME;
    /// Keeps the heat, and what energy is known.
    void setSettings(const ShaperSettings& settings) noexcept HANDPIECE_REALTIME;
    [[nodiscard]] const ShaperStatus& status() const noexcept { return status_; }
    /// For tests.
    [[nodiscard]] const PassivityController& controller() const noexcept { return controller_; }

  private:
    ShaperSettings settings_;
    ShaperStatus status_;
    FrictionCompensation friction_;
    ThermalBudget thermal_;
    PassivityController controller_;
};

}  // namespace handpiece::stability
