// SPDX-License-Identifier: Apache-2.0
#include "studies/passivity.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <iterator>
#include <limits>
#include <memory>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/tick/loop/loop_run.h"
#include "studies/plane_method.h"

namespace handpiece::studies {
namespace {

using core::Vec3;

constexpr double kWindowS = 0.5;  // ripple is judged over this
constexpr double kStartAboveMm = 0.5;

/// Smallest and largest of a force over a time.
struct Range {
    double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
    void add(double v) {
        low = std::min(low, v);
        high = std::max(high, v);
    }
    [[nodiscard]] double size() const { return high > low ? high - low : 0.0; }
};

void simulate(const PassivitySweep& sweep, const device::Hand& hand, PassivityRow& row) {
    const double limit = sweep.capability.maxStiffnessNPerMm;
    const force::TissueFeel& feel = sweep.parameters.tissues[static_cast<std::size_t>(row.tissue)];
    row.stiffnessNPerMm = std::min(limit, feel.stiffnessFraction * limit * sweep.parameters.stiffnessMultiplier);
    row.dampingNSPerMm =
        std::min(sweep.capability.maxDampingNSPerMm, feel.dampingNSPerMm * sweep.parameters.dampingMultiplier);
    const double k = row.stiffnessNPerMm, b = row.dampingNSPerMm, delta = sweep.capability.encoderStepMm;
    row.rippleBoundN = 2.1 * k * delta + b * delta / sweep.parameters.velocityTauS;

    device::SimulatedDeviceSettings settings;
    settings.capability = sweep.capability;
    settings.frictionN = row.frictionN;
    settings.delayS = row.delayS;
    settings.hand = hand;
    // Hand and tooth are two springs in series: this far in they meet at the load.
    const double depth = sweep.loadN / hand.stiffnessNPerMm + sweep.loadN / k;
    device::Motion motion = device::drop({Vec3(0, 0, kStartAboveMm), core::Quat::Identity()}, {0, 0, -1},
                                         kStartAboveMm + depth, sweep.approachMmS, sweep.dwellS);
    const double duration = motion.durationS();
    auto owned = std::make_unique<device::SimulatedDevice>(settings, std::move(motion));
    const device::SimulatedDevice& device = *owned;
    loop::LoopSettings loopSettings;
    loopSettings.rateHz = row.rateHz;
    loopSettings.queueCapacity = 16;
    loop::HapticLoop loop(loopSettings, std::move(owned), std::make_unique<PlaneMethod>(row.tissue), sweep.parameters);

    const double period = loop.periodS();
    const double activity = std::max(0.0, k * (0.5 * period + row.delayS) - b);
    double motionSum = 0.0, lastZ = 0.0;
    Range before, last;
    row.marginNmm = std::numeric_limits<double>::infinity();
    row.worstWorkNmm = -std::numeric_limits<double>::infinity();
    (void)runSimulated(loop, duration, [&](const messages::HapticSample& s) {
        const double z = s.truePositionMm[2];
        if (s.tick > 0) motionSum += (z - lastZ) * (z - lastZ) / period;
        lastZ = z;
        const double work = device.appliedWorkNmm();
        if (device.forceVariationN() == 0.0) return;  // not touched yet
        row.worstWorkNmm = std::max(row.worstWorkNmm, work);
        row.marginNmm = std::min(row.marginNmm, 0.5 * delta * device.forceVariationN() + activity * motionSum - work);
        if (s.timeS > duration - kWindowS) {
            last.add(s.forceN[2]);
        } else if (s.timeS > duration - 2 * kWindowS) {
            before.add(s.forceN[2]);
        }
    });
    row.holds = row.marginNmm >= -1e-9;
    row.rippleN = last.size();
    row.growing = last.size() > 1.05 * before.size() + 1e-6;
}

}  // namespace

std::vector<PassivityRow> passivityMap(const PassivitySweep& sweep, const core::Progress& progress) {
    validate(sweep.parameters);
    if (!(sweep.dwellS >= 3 * kWindowS))
        throw core::Error("the dwell is too short to judge", "passivity", "1.5 s or more");
    std::vector<PassivityRow> rows;
    std::vector<const device::Hand*> hands;
    for (const device::Hand& hand : sweep.hands) {
        for (const double friction : sweep.frictionN) {
            for (const double delay : sweep.delayS) {
                for (const cases::Tissue tissue : sweep.tissues) {
                    if (!(sweep.parameters.tissues[static_cast<std::size_t>(tissue)].stiffnessFraction > 0.0)) {
                        throw core::Error("a tissue without stiffness cannot be pressed",
                                          std::string(cases::properties(tissue).name), "leave it out of the sweep");
                    }
                    for (const double rate : sweep.rateHz) {
                        PassivityRow row;
                        row.hand = hand.name;
                        row.frictionN = friction;
                        row.delayS = delay;
                        row.tissue = tissue;
                        row.rateHz = rate;
                        rows.push_back(row);
                        hands.push_back(&hand);
                    }
                }
            }
        }
    }
    if (rows.empty()) throw core::Error("there is nothing to sweep over", "passivity");
    std::atomic<std::size_t> done{0};
    core::parallelFor(rows.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            simulate(sweep, *hands[i], rows[i]);
            core::report(progress, static_cast<double>(++done) / static_cast<double>(rows.size()));
        }
    });
    return rows;
}

std::string passivityCsv(const std::vector<PassivityRow>& rows) {
    std::string csv =
        "hand,friction_n,delay_ms,tissue,rate_hz,stiffness_n_mm,damping_n_s_mm,holds,margin_n_mm,worst_work_n_mm,"
        "ripple_n,"
        "ripple_bound_n,growing\n";
    for (const PassivityRow& r : rows) {
        fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{}\n", r.hand,
                       r.frictionN, 1e3 * r.delayS, cases::properties(r.tissue).name, r.rateHz, r.stiffnessNPerMm,
                       r.dampingNSPerMm, r.holds ? 1 : 0, r.marginNmm, r.worstWorkNmm, r.rippleN, r.rippleBoundN,
                       r.growing ? 1 : 0);
    }
    return csv;
}

}  // namespace handpiece::studies
