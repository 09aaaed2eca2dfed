// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Makes a loop tick: at a fixed rate, on simulated or on wall-clock time, for a while or until it is stopped.

#include <cstdint>
#include <functional>

#include "handpiece/base/rt/realtime_thread.h"
#include "handpiece/tick/loop/haptic_loop.h"

namespace handpiece::loop {

/// Percentiles of a quantity over a run.
struct Spread {
    double p50 = 0, p99 = 0, p999 = 0, max = 0;
};

struct RunReport : TickCount {
    rt::SchedulingGrant scheduling;   ///< as it was at the end
    std::uint64_t queueOverflow = 0;  ///< samples no listener fetched in time
    Spread workUs, latenessUs;        ///< over the samples fetched
};

/// As fast as possible on simulated time: the same inputs give the same samples, bit for bit, but for workUs and
/// lateUs. Throws core::Error for a duration that is none.
RunReport runSimulated(HapticLoop& loop, double durationS, const Listener& listener = {},
                       const BrickListener& bricks = {});
/// On the wall clock, in a thread with what real-time privileges there are; this thread feeds the listener meanwhile.
RunReport runRealTime(HapticLoop& loop, double durationS, const Listener& listener = {},
                      const BrickListener& bricks = {});
/// The same without an end, for a caller who does more than listen: `attend` is called every two milliseconds or so on
/// this thread, with what scheduling the tick has now; it calls the loop's fetch(), and requestStop() to end the run.
/// What it throws ends the run and comes out of here. However it ends, the device is left without force.
using Attend = std::function<void(const rt::SchedulingGrant& scheduling)>;
void runAttended(HapticLoop& loop, bool realTime, const Attend& attend);

}  // namespace handpiece::loop
