// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Samples gathered into points of a plot, so that no peak is lost however few points there are.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/case/tissue.h"

namespace handpiece::simulation {

/// One point of the live plots: the extremes over some ticks.
struct PlotPoint {
    double timeS = 0.0;                                    ///< of the last of its ticks
    float forceN = 0.0f, depthMm = 0.0f, speedRpm = 0.0f;  ///< largest, largest, last
    float leastRpm = 0.0f;
    std::array<float, cases::kTissueCount> removedMm3{};
    std::uint32_t flags = 0;  ///< messages::SampleFlag, all that were set
};
inline constexpr double kPlotStepS = 0.01;

/// One point for every `stepS` of ticks that come in their order.
class PlotGatherer {
  public:
    explicit PlotGatherer(double stepS = kPlotStepS) : stepS_(stepS) {}

    /// Of a messages::HapticSample or a session::Record; calls done(point) when the tick begins another point.
    template <class Tick, class Done>
    void take(double timeS, const Tick& tick, Done&& done) {
        const double place = std::floor(timeS / stepS_ + 1e-9);
        if (any_ && place != place_) finish(done);
        const auto force = static_cast<float>(core::hypot(tick.forceN[0], tick.forceN[1], tick.forceN[2]));
        const auto depth = static_cast<float>(tick.depthMm), rpm = static_cast<float>(tick.speedRpm);
        point_.timeS = timeS;
        point_.forceN = any_ ? std::max(point_.forceN, force) : force;
        point_.depthMm = any_ ? std::max(point_.depthMm, depth) : depth;
        point_.leastRpm = any_ ? std::min(point_.leastRpm, rpm) : rpm;
        point_.speedRpm = rpm;
        for (std::size_t t = 0; t < cases::kTissueCount; ++t)
            point_.removedMm3[t] = static_cast<float>(tick.removedMm3[t]);
        point_.flags |= tick.flags;
        place_ = place;
        any_ = true;
    }
    /// The point under way, when there is one.
    template <class Done>
    void finish(Done&& done) {
        if (any_) done(point_);
        point_ = PlotPoint{};
        any_ = false;
    }

  private:
    double stepS_, place_ = 0.0;
    PlotPoint point_;
    bool any_ = false;
};

}  // namespace handpiece::simulation
