// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// An energy tank on the force path: the hand is handed no more work than it put in, and what an encoder explains.

#include <array>
#include <cstddef>
#include <cstdint>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"

namespace handpiece::stability {

/// Observes, for every delay that the device may have, the energy S = step/2 TV(F) - sum F dx that is left, F being the
/// force as it acts that much later, and lets a force through only as far as the work that it and all forces still on
/// their way could do on a free arm is in the tank: v . I + I^2 / 2m, I their impulse. docs/physics.md#stability.
class PassivityController {
  public:
    static constexpr double kMaxDelayS = 0.01;

    struct Device {
        double encoderStepMm = 0.055;
        double delayS = 0.002;  ///< at most; any delay up to it is observed at once
        double massKg = 0.045;
        double stiffnessNPerMm = 0.5;  ///< the largest that is rendered
    };
    struct Outcome {
        core::Vec3 forceN = core::Vec3::Zero();
        double withheldNmm = 0.0;  ///< work the wanted force would have done more on the way since the last tick
        bool changed = false;
    };

    PassivityController() noexcept { sent_.fill(core::Vec3::Zero()); }
    void set(const Device& device) noexcept HANDPIECE_REALTIME;
    /// The force to send for the wanted one; observes only when not `active`.
    Outcome pass(const core::Vec3& positionMm, const core::Vec3& wantedN, double periodS, bool fresh,
                 bool active) noexcept HANDPIECE_REALTIME;
    /// The least that is left, over the delays.
    [[nodiscard]] double storedNmm() const noexcept;
    /// Where the arm is between the encoder's steps, and how fast: for tests.
    [[nodiscard]] const core::Vec3& positionMm() const noexcept { return position_; }
    [[nodiscard]] const core::Vec3& velocityMmS() const noexcept { return velocity_; }

  private:
    static constexpr std::size_t kRing = 128, kMaxLags = 100;
    [[nodiscard]] const core::Vec3& sent(std::size_t ago) const noexcept { return sent_[(head_ - ago) & (kRing - 1)]; }
    void push(const core::Vec3& force) noexcept;
    void takePeriod(double periodS) noexcept;
    void restart(const core::Vec3& positionMm) noexcept;
    void advance(const core::Vec3& readMm) noexcept;
    void settle() noexcept;
    [[nodiscard]] double share(const core::Vec3& wantedN) const noexcept;

    Device device_;
    double periodS_ = 0.0;
    std::size_t lags_ = 1;  // delays of 0 .. lags_ - 1 periods are observed
    bool started_ = false;
    core::Vec3 position_ = core::Vec3::Zero(), velocity_ = core::Vec3::Zero(), moved_ = core::Vec3::Zero();
    core::Vec3 held_ = core::Vec3::Zero();
    core::Vec3 ahead_ = core::Vec3::Zero(), behind_ = core::Vec3::Zero();  // to where the encoder steps, each axis
    std::array<core::Vec3, kRing> sent_{};                                 // newest at head_
    std::array<double, kRing> change_{};                                   // |sent - the one before|
    std::size_t head_ = 0, quiet_ = kRing;                                 // quiet_: ticks since the last force
    std::array<double, kMaxLags> stored_{};                                // by delay
    core::Vec3 lastWanted_ = core::Vec3::Zero();
    double lastShare_ = 1.0;
};

}  // namespace handpiece::stability
