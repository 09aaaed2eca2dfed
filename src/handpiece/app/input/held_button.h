// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The stylus' lower button: a press that is meant, not one that comes of gripping harder.

#include "handpiece/base/messages/haptic_sample.h"

namespace handpiece::input {

inline constexpr std::uint32_t kLowerButton = 2;
inline constexpr double kHoldS = 0.5;

/// Sees every sample; true once a press, when the button has been held for kHoldS with the bur clear of the tooth and
/// the pedal up. What comes in between starts the time anew; a pose that is not believed does, too.
class HeldButton {
  public:
    [[nodiscard]] bool take(const messages::HapticSample& sample) noexcept {
        // In doubt a device tells no button: the finger may be down all the same.
        if ((sample.flags & (messages::kInvalidPose | messages::kFault)) != 0) {
            since_ = -1.0;
            return false;
        }
        if ((sample.buttons & kLowerButton) == 0) {
            since_ = -1.0;
            done_ = false;
            return false;
        }
        if (sample.depthMm >= 0.0 || sample.pedal > 0.0 || (sample.flags & messages::kWaiting) != 0) {
            since_ = -1.0;
            return false;
        }
        if (since_ < 0.0) since_ = sample.timeS;
        if (done_ || sample.timeS - since_ < kHoldS) return false;
        done_ = true;
        return true;
    }

  private:
    double since_ = -1.0;
    bool done_ = false;
};

}  // namespace handpiece::input
