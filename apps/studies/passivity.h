// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where the closed loop of hand, device and tooth stays passive: a map over hands, friction, delay, tissues and rates.

#include <string>
#include <string_view>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/model/case/tissue.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/force/parameters.h"

namespace handpiece::studies {

/// What to vary. The defaults are the whole map that docs/physics.md#device asks about.
struct PassivitySweep {
    std::vector<device::Hand> hands = device::hands();
    std::vector<double> frictionN{0.26, 0.05};
    std::vector<double> delayS{0.0, 0.001, 0.003};
    std::vector<cases::Tissue> tissues{cases::Tissue::enamel, cases::Tissue::dentine,   cases::Tissue::pulp,
                                       cases::Tissue::caries, cases::Tissue::cementum,  cases::Tissue::gum,
                                       cases::Tissue::bone,   cases::Tissue::neighbour, cases::Tissue::restoration};
    std::vector<double> rateHz{1000, 2000, 4000, 8000};
    device::Capability capability;
    force::Parameters parameters = force::defaultParameters();
    double loadN = 1.0;  ///< that the hand comes to rest with, as far as the device can
    double approachMmS = 60.0;
    double dwellS = 1.5;
};

/// One closed loop: a hand taps a plane of one tissue and comes to rest on it.
struct PassivityRow {
    std::string_view hand;
    double frictionN = 0, delayS = 0, rateHz = 0;
    cases::Tissue tissue = cases::Tissue::none;
    double stiffnessNPerMm = 0, dampingNSPerMm = 0;  ///< as rendered
    /// True when at every tick the work done by the device, sum F dx, was at most
    /// delta TV(F) / 2 + max(0, k (T / 2 + delay) - b) sum v^2 T.
    bool holds = false;
    double marginNmm =
        0;  ///< the least that bound exceeded the work by since first touch; negative where it does not hold
    double worstWorkNmm = 0;  ///< largest work done by the device on the hand so far, over time
    double rippleN = 0;       ///< of the commanded force, peak to peak over the last 0.5 s
    double rippleBoundN = 0;  ///< 2.1 k delta + b delta / tau
    bool growing = false;     ///< the ripple of the last 0.5 s exceeds that of the 0.5 s before by 5 %
};

/// Simulates every combination, in parallel; rows in the order hand, friction, delay, tissue, rate, the last fastest.
/// The same rows at any thread count. Throws core::Error for an empty sweep or values out of range.
[[nodiscard]] std::vector<PassivityRow> passivityMap(const PassivitySweep& sweep = {},
                                                     const core::Progress& progress = {});

/// The rows as CSV, with a header; for a plot or a table.
[[nodiscard]] std::string passivityCsv(const std::vector<PassivityRow>& rows);

}  // namespace handpiece::studies
