// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The hum of a bur at work, where a hand feels best and a loop still carries it: 100 to 400 Hz.

#include <array>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/model/case/tissue.h"
#include "handpiece/tick/force/parameters.h"

namespace handpiece::force {

/// How a tissue shakes the bur that turns against it. docs/physics.md#crisp-contact-and-vibration.
struct Hum {
    double nPerN = 0.0;  ///< amplitude for each newton of load, while it is cut
    double grain = 0.0;  ///< 0..1: share of the upper tone; a brittle tissue is coarse
};
[[nodiscard]] const Hum& humOf(cases::Tissue tissue) noexcept;

/// Two tones, 120 to 220 Hz and 1.6 times that, across the bur's shank. Their pitch follows the rotor, whose own
/// frequency (6.7 kHz) no loop could carry; their amplitudes follow load, tissue and feed, so slowly that starting and
/// stopping does not click. One thread.
class BurHum {
  public:
    /// `rateHz`: of the loop; a tone above 0.45 of it is left out. `mostN`: largest amplitude of both together.
    BurHum(double rateHz, double mostN) noexcept : rateHz_(rateHz), mostN_(mostN) {}

    struct Work {
        double loadN = 0.0;                                ///< with which the bur presses
        double speedRpm = 0.0;                             ///< of the rotor
        double feedMmS = 0.0;                              ///< speed at which the bur eats into the tooth
        std::array<double, cases::kTissueCount> shares{};  ///< of the tissues in the contact
        cases::Tissue tissue = cases::Tissue::none;        ///< for when no share is known
        double headroomN = 0.0;                            ///< that the device has left
    };
    /// What to add in this tick, along the bur's x axis.
    [[nodiscard]] double step(const Work& work, const CuttingVibration& settings,
                              double periodS) noexcept HANDPIECE_REALTIME;
    /// Ends it at once: for faults, where silence matters more than a click.
    void stop() noexcept HANDPIECE_REALTIME;
    /// Of both tones together, now.
    [[nodiscard]] double amplitudeN() const noexcept { return low_.back() + high_.back(); }
    [[nodiscard]] double lowerHz() const noexcept;

  private:
    using Smooth = std::array<double, 3>;  // three low passes in a row
    static void follow(Smooth& smooth, double target, double periodS) noexcept;

    double rateHz_, mostN_;
    Smooth low_{}, high_{}, pitch_{};
    double lowTurns_ = 0.0, highTurns_ = 0.0;
};

}  // namespace handpiece::force
