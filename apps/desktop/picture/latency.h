// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How long it takes from the hand to the picture: measured while one works.

#include <chrono>
#include <cstddef>
#include <deque>
#include <vector>

namespace handpiece::desktop {

struct LatencyReport {
    std::size_t count = 0;
    double p50Ms = 0.0, p99Ms = 0.0, worstMs = 0.0;
};

/// From a pointer event to the first painted picture whose sample comes from a tick that had the event's target at
/// hand. Samples carry the tick's nominal time, so the tick's clock is laid against ours by the sample that came
/// soonest; kMarginS more is asked of a tick before it counts as an answer, so that the figure errs to the long side.
/// One thread.
class LatencyMeter {
  public:
    using Clock = std::chrono::steady_clock;
    static constexpr double kMarginS = 0.002;
    static constexpr std::size_t kMaxKept = 4096;

    /// A pointer event gave the hand a target.
    void target(Clock::time_point at);
    /// A sample of this nominal time was in the reader's hands at that moment.
    void sampleSeen(double timeS, Clock::time_point at);
    /// A picture made from the sample of this time is on the screen.
    void presented(double timeS, Clock::time_point at);
    void reset();

    [[nodiscard]] LatencyReport report() const;

  private:
    struct Window {
        double offsetS = 1e300;
        Clock::time_point since;
    };
    [[nodiscard]] double offsetS() const;

    Window now_, before_;  // the least offset of the last seconds, so that missed periods wear off
    std::deque<Clock::time_point> waiting_;
    std::vector<double> ms_;
    std::size_t next_ = 0;
};

}  // namespace handpiece::desktop
