// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What of a task's zones is gone while one works, counted as the score counts it.

#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/assess/zones/zones.h"

namespace handpiece::course {

struct LiveShares {
    double targetRemoved = 0.0;               ///< 0 to 1
    double leewayMm3 = 0.0, beyondMm3 = 0.0;  ///< gone of the leeway; of what must stay beside it
    double protectedMm3 = 0.0;                ///< gone of what is protected
};

/// Of the tooth worked on, as its listeners know it; `whole` is zones::wholeVolumes() of it. Takes tens of milliseconds
/// of this thread and of no other: for a thread that nobody waits for. The tick is not asked, nor held up.
[[nodiscard]] LiveShares liveShares(const zones::Zones& zones, const zones::WholeVolumes& whole,
                                    const simulation::LiveTooth& tooth);

}  // namespace handpiece::course
