// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How a run of the window kept its time, for measuring scripts.

#include <string>

#include "desktop/picture/latency.h"
#include "handpiece/app/simulation/histogram.h"
#include "handpiece/app/simulation/live_session.h"
#include "handpiece/senses/sound/player.h"
#include "handpiece/senses/view/renderer.h"

namespace handpiece::desktop {

/// The pictures of a run. One thread.
struct PictureStatistics {
    simulation::Histogram drawMs;  ///< drawing and reading back
    LatencyReport latency;         ///< from the hand to the picture

    void take(const view::FrameReport& report) { drawMs.add(report.drawMs + report.readMs); }
};

/// JSON: tick (ticks, lateTicks, missedPeriods, workUs and latenessUs with p50, p99, p999, max, samplesLost), picture,
/// firstPictureMs, sound. `sitting`: of a sitting that has ended.
[[nodiscard]] std::string runStatistics(const simulation::LiveSessionStatus& liveSession,
                                        const sound::PlayerStatus& sound, const PictureStatistics& picture,
                                        double firstPictureMs);

/// Since the system started this program [ms], to within 10 ms; 0 where the system does not tell.
[[nodiscard]] double sinceProgramStartMs();

}  // namespace handpiece::desktop
