// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/hand/tip_path.h"

#include <cmath>

namespace handpiece::hand {

void TipPath::take(double timeS, const core::Vec3& placeMm) {
    const auto stretch = static_cast<std::int64_t>(std::floor(timeS / stretchS_ + 1e-6));
    if (count_ > 0 && stretch != stretch_) finishStretch();
    stretch_ = stretch;
    sum_ += placeMm;
    ++count_;
}

void TipPath::finishStretch() {
    const core::Vec3 place = sum_ / static_cast<double>(count_);
    sum_.setZero();
    count_ = 0;
    if (before_) {
        const core::Vec3 from = *before_;
        const std::int64_t steps = std::max<std::int64_t>(1, stretch_ - beforeStretch_);
        // A machine that stood for long is no movement.
        constexpr std::int64_t kMostFilled = 100;
        if (steps <= kMostFilled)
            for (std::int64_t i = 1; i < steps; ++i)
                tell_(from + (place - from) * (static_cast<double>(i) / static_cast<double>(steps)),
                      beforeStretch_ + i);
    }
    tell_(place, stretch_);
    before_ = place;
    beforeStretch_ = stretch_;
}

void TipPath::end() {
    if (count_ > 0) finishStretch();
    before_.reset();
}

}  // namespace handpiece::hand
