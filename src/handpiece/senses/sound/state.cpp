// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/sound/state.h"

#include <algorithm>

namespace handpiece::sound {

DrillState drillStateOf(const messages::HapticSample& before, const messages::HapticSample& now, double periodS,
                        double burRadiusMm, int edges, double freeSpeedRpm) {
    DrillState drill;
    drill.speedRpm = now.speedRpm;
    drill.freeSpeedRpm = freeSpeedRpm;
    drill.pedal = now.pedal;
    drill.loadTorqueNmm = now.loadTorqueNmm;
    double removed = 0.0;
    for (std::size_t t = 0; t < now.removedMm3.size(); ++t)
        removed += now.removedMm3[t] - before.removedMm3[t];
    // Samples may have been left out in between; an undo gives volume back, which is no sound.
    const double passedS = now.tick > before.tick ? std::max(now.timeS - before.timeS, periodS)
                                                  : periodS * std::max(1, now.elapsedPeriods);
    drill.removalMm3S = passedS > 0.0 ? std::max(0.0, removed / passedS) : 0.0;
    drill.tissue = static_cast<cases::Tissue>(now.tissue < cases::kTissueCount ? now.tissue : 0);
    drill.burRadiusMm = burRadiusMm;
    drill.edges = edges;
    drill.cutting = (now.flags & messages::kCutting) != 0;
    drill.stalled = (now.flags & messages::kStalled) != 0;
    drill.water = now.pedal > 0.0;
    drill.positionMm = {now.proxyPositionMm[0], now.proxyPositionMm[1], now.proxyPositionMm[2]};
    const auto& q = now.proxyOrientation;
    drill.axis = core::Quat(q[0], q[1], q[2], q[3]) * core::Vec3::UnitZ();
    return drill;
}

}  // namespace handpiece::sound
