// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The reference device: an arm with mass, dry friction, encoder steps and delay, held by a hand with an impedance.

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "handpiece/tick/device/device.h"
#include "handpiece/tick/device/motion.h"

namespace handpiece::device {

/// The hand as a mass on a spring and a damper that follow the intended motion.
struct Hand {
    std::string_view name;
    double massKg;
    double dampingNSPerMm;
    double stiffnessNPerMm;  ///< 0 for a rigid hand: see SimulatedDeviceSettings::rigidHand
};
/// "loose", "normal", "stiff". Unchecked figures: docs/physics.md#device.
[[nodiscard]] const std::vector<Hand>& hands();
/// Throws core::Error naming the hands there are.
[[nodiscard]] const Hand& handByName(std::string_view name);

struct SimulatedDeviceSettings {
    Capability capability;
    double massKg = 0.045;    ///< effective, of the arm at the grip
    double frictionN = 0.26;  ///< Coulomb, whatever the direction; 0.05 is the hard case
    double delayS = 0.0;      ///< from the command to the force
    Hand hand{"normal", 0.05, 0.003, 0.3};
    bool rigidHand = false;   ///< the device is exactly on the intended path, no encoder: for exact experiments
    bool quantise = true;     ///< positions in encoder steps
    double subStepS = 20e-6;  ///< largest integration step
};

/// One degree of freedom an axis: (m_arm + m_hand) x'' = F + friction - b (x' - x_i') - k (x - x_i), integrated
/// semi-implicitly with dry friction that truly sticks. Orientation and pedal are those of the motion. Deterministic in
/// simulated time.
class SimulatedDevice final : public Device {
  public:
    /// Throws core::Error for figures that cannot be simulated.
    SimulatedDevice(SimulatedDeviceSettings settings, Motion motion);

    [[nodiscard]] const Capability& capability() const noexcept override { return settings_.capability; }
    /// Lets `periodS` pass with the forces commanded so far (none at the first call, at time 0), then reads the
    /// encoders.
    Reading read(double periodS) noexcept HANDPIECE_REALTIME override;
    void command(const core::Vec3& forceN, const core::Vec3& torqueNmm) noexcept HANDPIECE_REALTIME override;
    core::Vec3 truePositionMm() const noexcept override { return position_; }
    core::Vec3 appliedForceN() const noexcept override { return applied_; }

    [[nodiscard]] const Motion& motion() const noexcept { return motion_; }
    [[nodiscard]] double timeS() const noexcept { return time_; }
    /// Work the applied force has done on device and hand so far [N mm], exactly, sub-step by sub-step.
    [[nodiscard]] double appliedWorkNmm() const noexcept { return workNmm_; }
    /// Total variation of the applied force so far [N].
    [[nodiscard]] double forceVariationN() const noexcept { return variationN_; }

  private:
    struct Command {
        double atS = 0.0;
        core::Vec3 forceN = core::Vec3::Zero();
    };
    void advance(double periodS) noexcept;
    void applyCommandsDue() noexcept;
    [[nodiscard]] core::Vec3 quantised(const core::Vec3& p) const noexcept;

    SimulatedDeviceSettings settings_;
    Motion motion_;
    double time_ = 0.0;
    bool started_ = false;
    core::Vec3 position_, velocity_ = core::Vec3::Zero(), applied_ = core::Vec3::Zero();
    double workNmm_ = 0.0, variationN_ = 0.0;
    std::array<Command, 512> pending_{};  // a ring: commands under way
    std::size_t first_ = 0, count_ = 0;
};

}  // namespace handpiece::device
