// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Wall-clock time and a metronome for the tick.

#include <cstdint>

#include "handpiece/base/core/realtime.h"

namespace handpiece::rt {

/// Monotonic time [ns]; costs some 20 ns. Any thread.
[[nodiscard]] std::int64_t monotonicNs() noexcept HANDPIECE_REALTIME;

/// One beat of the metronome.
struct Beat {
    std::int64_t periods = 1;    ///< since the beat before: more than 1 when whole periods were slept or worked through
    std::int64_t nominalNs = 0;  ///< when it should have started
    std::int64_t lateNs = 0;     ///< how long after that it did, >= 0
};

/// Beats at multiples of a period of the monotonic clock: sleeps to an absolute time, so that errors do not add up, and
/// spins through the last `spinNs` where wake-ups are coarse. Who has been behind for 20 ms rests for 100 us all the
/// same: Linux takes real time from a thread that never waits (requestRealtime()).
class PeriodicClock {
  public:
    /// Throws core::Error unless the period lies between 10 us and 10 s and `spinNs` is shorter than it.
    explicit PeriodicClock(std::int64_t periodNs, std::int64_t spinNs = 0);

    /// Begins now: the first wait() ends one period later. Tick's thread.
    void start() noexcept;
    /// Sleeps to the next beat; beats that have passed entirely are left out and told in Beat::periods. Tick's thread,
    /// between ticks.
    Beat wait() noexcept;
    [[nodiscard]] std::int64_t periodNs() const noexcept { return periodNs_; }

  private:
    std::int64_t periodNs_, spinNs_, nextNs_ = 0, restedNs_ = 0;
};

}  // namespace handpiece::rt
