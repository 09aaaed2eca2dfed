// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/pose_guard.h"

#include <algorithm>

namespace handpiece::force {

void PoseGuard::look(const core::Pose& read, bool lost, double periodS, double fadeInS) noexcept {
    const bool valid = !lost && read.isValid();
    const bool jumped = valid && seen_ && (read.positionMm - lastValid_.positionMm).norm() > kMaxJumpMm;
    bad_ = !valid || jumped;
    startsAnew_ = false;
    if (valid) {
        lastValid_ = read;
        seen_ = true;
    }
    if (bad_) {
        fault_ = true;
        goodS_ = 0.0;
    } else if (fault_) {
        goodS_ += periodS;
        if (goodS_ >= kClearAfterS) {
            fault_ = false;
            startsAnew_ = true;
            gain_ = 0.0;
        }
    } else if (!started_) {
        startsAnew_ = true;
    }
    if (fault_) {
        gain_ = std::max(0.0, gain_ - periodS / kReleaseS);
        return;
    }
    started_ = true;
    pose_ = read;
    gain_ = fadeInS > 0.0 ? std::min(1.0, gain_ + periodS / fadeInS) : 1.0;
}

}  // namespace handpiece::force
