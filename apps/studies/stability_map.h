// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The closed loop of hand, arm and tooth with the passivity controller off and on: from contacts softer than the arm's
/// limit to far beyond it, touching, sliding, cutting and wedged.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/model/case/tissue.h"
#include "handpiece/tick/device/simulated_device.h"

namespace handpiece::studies {

/// Touch: the tip taps a plane and rests. The others on the starter molar, its real field: slide over a cusp, cut into
/// it and along, wedge in the fissure and pull sideways.
/// `between`: wedged between two teeth; `head`: on a cusp while the handpiece's head rests on the tooth beside.
enum class LoopMotion : std::uint8_t { touch, slide, cut, wedge, between, head };
[[nodiscard]] std::string_view nameOf(LoopMotion motion);

struct StabilitySweep {
    std::vector<LoopMotion> motions{LoopMotion::touch, LoopMotion::slide,   LoopMotion::cut,
                                    LoopMotion::wedge, LoopMotion::between, LoopMotion::head};
    /// Of enamel, the hardest, as the force model renders it; a tissue has its share of it.
    std::vector<double> stiffnessNPerMm{0.1, 0.25, 0.5, 1, 2, 5};
    std::vector<device::Hand> hands = device::hands();
    std::vector<double> frictionN{0.26, 0.05};
    std::vector<double> delayS{0.0, 0.001, 0.003};
    std::vector<double> rateHz{500, 1000, 2000, 4000, 8000};
    std::vector<cases::Tissue> tissues{cases::Tissue::enamel, cases::Tissue::dentine,   cases::Tissue::pulp,
                                       cases::Tissue::caries, cases::Tissue::cementum,  cases::Tissue::gum,
                                       cases::Tissue::bone,   cases::Tissue::neighbour, cases::Tissue::restoration};
    /// On the molar a tick costs twenty times as much: these instead.
    std::vector<double> molarFrictionN{0.05}, molarRateHz{500, 1000, 8000};
    device::Capability capability;  ///< the arm; its own stiffness limit is that of the bound
    double assumedDelayS = -1.0;    ///< that the controller is told, at most; below 0: the true one
    double loadN = 1.0;
    bool turbineForce = true;  ///< the turning bur's sideways force, an active one, goes through the loop as well
};
/// The same with less of everything: for a test.
[[nodiscard]] StabilitySweep quickStabilitySweep();

/// One loop, run twice.
struct StabilityRow {
    LoopMotion motion = LoopMotion::touch;
    cases::Tissue tissue = cases::Tissue::none;
    double limitNPerMm = 0;  ///< of enamel
    double stiffnessNPerMm = 0, dampingNSPerMm = 0;
    std::string_view hand;
    double frictionN = 0, delayS = 0, rateHz = 0;
    struct Outcome {
        /// True when at every tick the work of the force on the hand was at most
        /// delta TV(F) / 2 + max(0, k (T / 2 + delay) - b) sum v^2 T,
        /// k being what is rendered, but at most the arm's own limit.
        bool holds = false;
        double marginNmm = 0;          ///< the least by which it held since the first force
        double renderedMarginNmm = 0;  ///< the same with the k that is rendered, beyond the arm's limit too
        double rippleN = 0;            ///< of the force while the hand rests, peak to peak
        double restN = 0;              ///< mean force while the hand rests
        double stepN = 0;              ///< of the force from tick to tick, root mean square, in contact
        double deepestMm = 0;          ///< of the arm, along the way in
        double removedMm3 = 0;
        std::uint64_t engaged = 0, ticks = 0;  ///< in which the controller changed the force; in contact
    } off, on;
};

/// Rows in the order motion, tissue, limit, rate, hand, friction, delay, the last fastest; the same at any thread
/// count. Throws core::Error for an empty sweep.
[[nodiscard]] std::vector<StabilityRow> stabilityMap(const StabilitySweep& sweep, const core::Progress& progress = {});

[[nodiscard]] std::string stabilityCsv(const std::vector<StabilityRow>& rows);

}  // namespace handpiece::studies
