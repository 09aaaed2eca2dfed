// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/simulation/recorded_gingiva.h"

#include <algorithm>

namespace handpiece::simulation {
namespace {

using session::Event;
using session::EventName;

bool tells(const Event& event, EventName name) {
    return event.name == session::nameOf(name);
}

}  // namespace

void hearRecorded(GingivaCuts& cuts, const session::SessionReader& reader, const std::vector<Event>& events,
                  const SimulationSettings& first, std::uint64_t toTick, const std::string& where) {
    cuts.clear();
    // The first of a row of cuts is told as an event: most sessions have none, and need not be read.
    const bool any = std::any_of(events.begin(), events.end(), [toTick](const Event& event) {
        return event.tick <= toTick && tells(event, EventName::gingivaCut);
    });
    if (!any) return;
    SimulationSettings settings = first;
    auto event = events.begin();
    constexpr std::size_t kStretch = 4096;
    for (std::uint64_t from = 0; from < reader.size(); from += kStretch)
        for (const session::Record& record : reader.records(from, kStretch)) {
            if (record.tick > toTick) return;
            for (; event != events.end() && event->tick <= record.tick; ++event) {
                if (tells(*event, EventName::reset)) cuts.clear();
                if (tells(*event, EventName::burChange)) (void)applyChange(event->text, settings, where);
                if (tells(*event, EventName::resume)) settings = resumptionFromJson(event->text, where).settings;
            }
            if ((record.flags & messages::kCutsGingiva) == 0) continue;
            const session::Inputs in = session::inputsOf(record);
            messages::HapticSample sample;
            sample.timeS = static_cast<double>(record.tick) / first.rateHz;
            sample.flags = record.flags;
            sample.proxyPositionMm = in.positionMm;
            sample.proxyOrientation = in.orientation;
            cuts.hear(sample, *settings.bur);
        }
}

}  // namespace handpiece::simulation
