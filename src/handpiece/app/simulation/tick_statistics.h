// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How the tick keeps its time, over the last seconds.

#include <vector>

#include "handpiece/app/simulation/histogram.h"
#include "handpiece/app/simulation/live_session.h"
#include "handpiece/base/messages/haptic_sample.h"
#include "handpiece/tick/loop/loop_run.h"

namespace handpiece::simulation {

/// Counts every sample, keeps ten seconds of work and lateness, and of all of them how often which. One thread.
class TickStatistics {
  public:
    explicit TickStatistics(double rateHz);

    void take(const messages::HapticSample& sample);
    /// Fills in ticks, lateTicks, missedPeriods, workUs, latenessUs, load, timeS. Some milliseconds.
    void fill(LiveSessionStatus& status) const;
    /// Fills in allWorkUs and allLatenessUs.
    void fillAll(LiveSessionStatus& status) const;

  private:
    struct Ring {
        std::vector<float> values;
        std::size_t next = 0;
        void add(float value, std::size_t most);
    };
    [[nodiscard]] static loop::Spread spreadOf(std::vector<float> values);

    double periodUs_;
    std::size_t tenSeconds_, oneSecond_;
    Histogram allWorkUs_, allLateUs_;
    Ring workUs_, lateUs_, busyUs_;
    std::uint64_t ticks_ = 0, late_ = 0, missed_ = 0;
    double timeS_ = 0.0;
};

}  // namespace handpiece::simulation
