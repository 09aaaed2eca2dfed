// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/report_figures.h"

#include <algorithm>
#include <cmath>

#include "handpiece/app/simulation/working_way.h"

namespace handpiece::report {
namespace {

constexpr std::size_t kStretch = 4096;
/// Forces are counted in bins so fine.
constexpr double kBinN = 0.002;
constexpr std::size_t kBins = 20000;

}  // namespace

SessionFigures figuresOf(const session::SessionReader& reader) {
    SessionFigures f;
    const double period = 1.0 / reader.info().rateHz;
    std::vector<std::uint64_t> bins(kBins, 0);
    std::uint64_t contact = 0, limited = 0, cutting = 0;
    double forceSum = 0.0, rpmSum = 0.0;
    std::vector<session::Event> ways = reader.events();
    std::erase_if(ways, [](const auto& e) { return e.name != nameOf(session::EventName::workingWay); });
    auto next = ways.cbegin();
    simulation::WorkingWay way;
    for (std::uint64_t first = 0; first < reader.size(); first += kStretch)
        for (const session::Record& r : reader.records(first, kStretch)) {
            const double lasts = period * r.elapsedPeriods;
            ++f.ticks;
            f.missedPeriods += r.elapsedPeriods - 1u;
            f.totalS = period * static_cast<double>(r.tick);
            if (r.pedal > 0) f.pedalS += lasts;
            // An event bears the number of the last tick that went before it.
            for (; next != ways.cend() && next->tick < r.tick; ++next)
                way = simulation::workingWayFromJson(next->text);
            if (way.mirrorOnly) f.byMirrorS += lasts;
            if (way.fingerRest) f.fingerRestS += lasts;
            if (way.hour > 0) f.atHourS[way.hour] += lasts;
            // A file may say anything: what is no number counts for nothing.
            const double rpm = std::isfinite(r.speedRpm) ? static_cast<double>(r.speedRpm) : 0.0;
            f.mostRpm = std::max(f.mostRpm, rpm);
            f.removedMm3 = r.removedMm3;
            if ((r.flags & messages::kCutting) != 0) {
                f.cuttingS += lasts;
                rpmSum += rpm;
                ++cutting;
            }
            const double force = std::hypot(static_cast<double>(r.forceN[0]), static_cast<double>(r.forceN[1]),
                                            static_cast<double>(r.forceN[2]));
            if (!(r.depthMm > 0.0f) || !std::isfinite(force)) continue;
            f.contactS += lasts;
            ++contact;
            forceSum += force;
            f.peakForceN = std::max(f.peakForceN, force);
            limited += (r.flags & messages::kForceLimited) != 0;
            ++bins[std::min(static_cast<std::size_t>(std::min(force / kBinN, 1.0 * kBins)), kBins - 1)];
        }
    if (contact > 0) {
        f.meanForceN = forceSum / static_cast<double>(contact);
        f.limitedShare = static_cast<double>(limited) / static_cast<double>(contact);
        std::uint64_t below = 0;
        std::size_t bin = 0;
        for (; bin + 1 < kBins && static_cast<double>(below += bins[bin]) < 0.95 * static_cast<double>(contact);
             ++bin) {
        }
        f.p95ForceN = std::min((static_cast<double>(bin) + 1.0) * kBinN, f.peakForceN);
    }
    if (cutting > 0) f.meanCuttingRpm = rpmSum / static_cast<double>(cutting);
    return f;
}

}  // namespace handpiece::report
