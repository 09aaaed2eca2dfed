// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The knock of a hard surface: what a spring that an arm can hold does not tell.

#include <array>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/model/case/tissue.h"
#include "handpiece/tick/force/parameters.h"

namespace handpiece::force {

/// How a tissue answers a tap. docs/physics.md#crisp-contact-and-vibration.
struct Knock {
    double nPerMmS = 0.0;  ///< amplitude for each mm/s of approach; 0: none
    double hz = 0.0;
    double decayPerS = 0.0;
};
[[nodiscard]] const Knock& knockOf(cases::Tissue tissue) noexcept;

/// A strike starts it, then it runs open loop: f(t) = a v exp(-d t) sin(2 pi f t) along the normal of the strike.
/// One thread.
class ContactTransient {
  public:
    /// `rateHz`: of the loop; no frequency above three tenths of it. `mostN`: largest amplitude.
    ContactTransient(double rateHz, double mostN) noexcept : mostHz_(0.3 * rateHz), mostN_(mostN) {}

    struct Strike {
        bool touching = false;
        core::Vec3 normal = core::Vec3::Zero();            ///< out of the tooth, unit
        core::Vec3 velocityMmS = core::Vec3::Zero();       ///< of the bur
        std::array<double, cases::kTissueCount> shares{};  ///< of the tissues in the contact; they need not add up
        cases::Tissue tissue = cases::Tissue::none;        ///< for when no share is known
    };
    /// What to add in this tick. Only a surface that was left for some milliseconds and is met at some speed knocks.
    [[nodiscard]] core::Vec3 step(const Strike& strike, const ContactTransients& settings,
                                  double periodS) noexcept HANDPIECE_REALTIME;
    /// Ends it at once.
    void stop() noexcept HANDPIECE_REALTIME { amplitudeN_ = 0.0; }
    /// Of the sinusoid now; zero when there is none.
    [[nodiscard]] double amplitudeN() const noexcept { return amplitudeN_; }
    [[nodiscard]] const core::Vec3& normal() const noexcept { return normal_; }

  private:
    double mostHz_, mostN_;
    double amplitudeN_ = 0.0, turns_ = 0.0, hz_ = 0.0, decayPerS_ = 0.0;
    double apartS_ = 1.0;  // how long the bur has been away
    core::Vec3 normal_ = core::Vec3::Zero();
};

}  // namespace handpiece::force
