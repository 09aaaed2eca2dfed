// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Times a query along a trajectory, tick by tick.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "query.h"

namespace handpiece::bench {

struct MeasureSettings {
    int repeats = 3;  ///< passes over the trajectory
    int batch = 1;    ///< ticks timed together, for what is shorter than the clock
    double budgetS =
        1.2;  ///< slower queries are asked at every n-th tick only, so that all passes take about this long
};

struct Timing {
    std::vector<double>
        bestUs;  ///< of each tick (or batch), the fastest of its passes: what the work itself takes; ascending
    std::vector<double> rawUs;  ///< of every tick of every pass, with all that the machine did in between; ascending
    int ticks = 0;              ///< asked in one pass
};

/// Runs pinned to one core where that is permitted. The clock's own time (about 20 ns) is included.
[[nodiscard]] Timing measure(Query& query, std::span<const core::Pose> poses, const MeasureSettings& settings);

/// The value below which `share` of `ascending` lies (nearest rank).
[[nodiscard]] double percentile(const std::vector<double>& ascending, double share);

/// Keeps the calling thread on one core while it lives: the last of those it may use, or HANDPIECE_BENCH_CORE.
class PinnedToCore {
  public:
    PinnedToCore();
    ~PinnedToCore();
    PinnedToCore(const PinnedToCore&) = delete;
    PinnedToCore& operator=(const PinnedToCore&) = delete;
    /// "core 1", or why not.
    [[nodiscard]] static std::string description();

  private:
    std::vector<unsigned char> before_;
};

/// The whole of a benchmark's main: reads the options, tells machine and mode in the output, lets `registerAll(quick)`
/// register, runs. Quick, for smoke tests, when HANDPIECE_BENCH_QUICK is set. Returns the exit code.
int runBenchmarks(int argc, char** argv, const char* name, const std::function<void(bool quick)>& registerAll);

/// A fixed amount of arithmetic that takes about `us` on this machine: shows the machine's own tails.
class ConstantLoad final : public Query {
  public:
    explicit ConstantLoad(double us);
    double depthMm(const core::Pose& burInTooth) override;

  private:
    long steps_;
};

}  // namespace handpiece::bench
