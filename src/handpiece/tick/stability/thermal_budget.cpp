// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/stability/thermal_budget.h"

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/portable_math.h"

namespace handpiece::stability {

void ThermalBudget::set(double maxForceN, double continuousForceN, double tauS) noexcept {
    continuousN_ = continuousForceN;
    leastScale_ = std::min(1.0, continuousForceN / maxForceN);
    tauS_ = tauS;
}

double ThermalBudget::scale() const noexcept {
    if (heat_ <= kKnee) return 1.0;
    const double t = std::min(1.0, (heat_ - kKnee) / (1.0 - kKnee));
    return 1.0 - (1.0 - leastScale_) * t * t * (3.0 - 2.0 * t);
}

void ThermalBudget::spend(double forceN, double periodS) noexcept {
    const double share = forceN / continuousN_, aim = share * share;
    heat_ = std::clamp(aim + (heat_ - aim) * core::exp(-periodS / tauS_), 0.0, 1.0);
}

}  // namespace handpiece::stability
