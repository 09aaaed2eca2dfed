// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/parameters.h"

#include <fmt/format.h>

#include "handpiece/base/core/error.h"
#include "handpiece/tick/force/force_law.h"

namespace handpiece::force {

void validate(const Parameters& p) {
    const auto require = [](double value, double low, double high, const char* what) {
        if (!(value >= low && value <= high)) {
            throw core::Error(fmt::format("{} is {}", what, value), "force", fmt::format("give {} to {}", low, high))
                .as("parameter-refused",
                    {what, fmt::format("{}", value), fmt::format("{}", low), fmt::format("{}", high)});
        }
    };
    require(static_cast<double>(p.law), 0.0, static_cast<double>(lawCount() - 1), "the number of the law of force");
    require(p.stiffnessMultiplier, 0.0, 100.0, "the stiffness multiplier");
    require(p.dampingMultiplier, 0.0, 100.0, "the damping multiplier");
    for (const TissueFeel& t : p.tissues) {
        require(t.stiffnessFraction, 0.0, 1.0, "a tissue's stiffness fraction");
        require(t.dampingNSPerMm, 0.0, 10.0, "a tissue's damping [N s/mm]");
        require(t.friction, 0.0, 10.0, "a tissue's friction");
    }
    require(p.frictionMultiplier, 0.0, 100.0, "the friction multiplier");
    require(p.cuttingForceMultiplier, 0.0, 10.0, "the cutting force multiplier");
    require(p.penaltyStiffnessNPerMm, 0.0, 100.0, "the penalty stiffness [N/mm]");
    require(p.penaltyDampingNSPerMm, 0.0, 10.0, "the penalty damping [N s/mm]");
    require(p.velocityTauS, 0.0, 1.0, "the velocity filter's time constant [s]");
    require(p.dampingRampMm, 1e-6, 10.0, "the damper's ramp [mm]");
    for (int i = 0; i < 3; ++i)
        require(p.gripMm[i], -500.0, 500.0, "the grip [mm]");
    require(p.fadeInS, 0.0, 10.0, "the fade-in [s]");
    require(p.proxy.iterations, 1, 64, "the proxy's iterations");
    require(p.proxy.maxStepMm, 1e-4, 1.0, "the proxy's largest step [mm]");
    require(p.transients.gain, 0.0, 4.0, "the gain of the contact transients");
    require(p.vibration.gain, 0.0, 4.0, "the gain of the cutting vibration");
    require(p.proxy.toleranceMm, 1e-6, 0.1, "the proxy's tolerance [mm]");
}

}  // namespace handpiece::force
