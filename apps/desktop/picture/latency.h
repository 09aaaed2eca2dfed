// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How long it takes from the hand to the picture: measured while one works.

#include <array>
#include <chrono>
#include <cstddef>
#include <deque>
#include <vector>

namespace handpiece::desktop {

/// Where the time between the hand and the picture goes: until the tick whose sample the picture shows, from there into
/// the drawing thread's hands, until it began to draw, until the picture was there, until it was painted.
inline constexpr std::array<const char*, 5> kLatencyStages{"handToSample", "sampleToSeen", "seenToBegun",
                                                           "begunToDrawn", "drawnToShown"};

struct LatencyReport {
    std::size_t count = 0;
    double p50Ms = 0.0, p99Ms = 0.0, worstMs = 0.0;
    /// Of each stage by itself, and its mean in the slowest hundredth of all: these means add up to what is slow.
    struct Stage {
        double p50Ms = 0.0, p99Ms = 0.0, inSlowestMs = 0.0;
    };
    std::array<Stage, kLatencyStages.size()> stages;
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
    /// A picture is on the screen.
    struct Picture {
        double timeS = 0.0;  ///< of the sample that it was made from
        Clock::time_point seen, begun,
            drawn;  ///< the sample in the drawing thread's hands; the drawing's begin and end
    };
    void presented(const Picture& picture, Clock::time_point at);
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
    struct Answer {
        double ms;
        std::array<double, kLatencyStages.size()> stagesMs;
    };
    std::vector<Answer> answers_;
    std::size_t next_ = 0;
};

}  // namespace handpiece::desktop
