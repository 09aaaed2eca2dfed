// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What an arm's motors can hold: a little for ever, much for seconds.

#include "handpiece/base/core/realtime.h"

namespace handpiece::stability {

/// A winding as one heat capacity that cools towards the room: h' = ((F / Fc)^2 - h) / tau, with Fc the force that can
/// be held for ever. h reaches 1 there and never passes it: above kKnee the force is scaled down, all of it alike, so
/// that tissues still differ, to Fc at h = 1 for the largest force there is.
class ThermalBudget {
  public:
    static constexpr double kKnee = 0.8;

    void set(double maxForceN, double continuousForceN, double tauS) noexcept;
    /// What to scale a force with now, 0..1.
    [[nodiscard]] double scale() const noexcept HANDPIECE_REALTIME;
    /// A force of this size has acted for so long. Exact for a constant force.
    void spend(double forceN, double periodS) noexcept HANDPIECE_REALTIME;
    [[nodiscard]] double heat() const noexcept { return heat_; }

  private:
    double leastScale_ = 1.0, continuousN_ = 1.0, tauS_ = 60.0;
    double heat_ = 0.0;
};

}  // namespace handpiece::stability
