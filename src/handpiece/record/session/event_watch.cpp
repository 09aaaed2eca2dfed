// SPDX-License-Identifier: Apache-2.0
#include "handpiece/record/session/event_watch.h"

#include <fmt/format.h>

namespace handpiece::session {

using cases::Tissue;
using messages::HapticSample;

void EventWatch::tellOnce(const HapticSample& s, std::uint32_t flag, EventName name) {
    if ((s.flags & flag) == 0 || (lastFlags_ & flag) != 0) return;
    double& told = toldAtS_[static_cast<std::size_t>(name)];
    if (told > 0.0 && s.timeS - told < kPauseS) return;
    told = s.timeS;
    tell_(s.tick, name, "");
}

std::string EventWatch::nameOf(std::uint16_t tooth) const {
    if (tooth == 0) return {};
    const int fdi = tooth <= fdiNumbers_.size() ? fdiNumbers_[tooth - 1u] : 0;
    return fdi > 0 ? fmt::format(R"({{"tooth": {}, "fdi": {}}})", tooth, fdi)
                   : fmt::format(R"({{"tooth": {}}})", tooth);
}

void EventWatch::look(const HapticSample& s) {
    if (first_) toldAtS_.fill(0.0);
    first_ = false;
    if (s.pedal > 0.0 && !inStroke_) {
        inStroke_ = true;
        strokeStartMm3_ = s.removedMm3;
        tell_(s.tick, EventName::strokeBegin, "");
    } else if (s.pedal <= 0.0 && inStroke_ && s.waitingBricks == 0) {
        inStroke_ = false;
        ++strokes_;
        double removed = 0.0;
        for (std::size_t t = 0; t < cases::kTissueCount; ++t)
            removed += s.removedMm3[t] - strokeStartMm3_[t];
        tell_(s.tick, EventName::strokeEnd, fmt::format("{{\"removed_mm3\": {:.6g}}}", removed));
    }
    const auto reach = [&](Tissue tissue, EventName name) {
        const auto t = static_cast<std::size_t>(tissue);
        // An undo takes the exposure back: reached again it is told again.
        const bool now = s.removedMm3[t] > kTellMm3;
        if (now && !reached_[t]) tell_(s.tick, name, "");
        reached_[t] = now;
    };
    reach(Tissue::dentine, EventName::firstDentine);
    reach(Tissue::pulp, EventName::pulpExposure);
    // A part of the one surface in cases of a single tooth, and a tooth of its own in a mouth.
    const bool isPart = s.tooth == 0 && s.tissue == static_cast<std::uint8_t>(Tissue::neighbour);
    const int neighbour = isPart ? 0 : s.touchedNeighbour > 0 ? s.touchedNeighbour : kNoNeighbour;
    if (neighbour != kNoNeighbour && lastNeighbour_ != neighbour)
        tell_(s.tick, EventName::neighbourTouched, nameOf(s.touchedNeighbour));
    lastNeighbour_ = neighbour;
    const bool hasCut = s.removedOthersMm3 > kTellMm3;
    if (hasCut && !hasCutNeighbour_) tell_(s.tick, EventName::neighbourCut, nameOf(s.cutNeighbour));
    hasCutNeighbour_ = hasCut;
    tellOnce(s, messages::kCutsGingiva, EventName::gingivaCut);
    tellOnce(s, messages::kShankTouches | messages::kHeadTouches | messages::kHandleTouches, EventName::headTouched);
    tellOnce(s, messages::kStalled, EventName::stall);
    tellOnce(s, messages::kForceLimited, EventName::forceLimit);
    tellOnce(s, messages::kFault, EventName::fault);
    lastFlags_ = s.flags;
}

}  // namespace handpiece::session
