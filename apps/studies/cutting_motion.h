// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a hand intends when it cuts: plunge, class I cavity, crown shoulder, excavation of decay.

#include <array>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/model/case/tissue.h"
#include "handpiece/tick/contact/method.h"
#include "handpiece/tick/device/motion.h"
#include "studies/built_in_motion.h"

namespace handpiece::studies {

/// Where excavation holds off the pulp unless asked for otherwise [mm]. A mark for a simulated hand, not clinical
/// advice.
inline constexpr double kPulpGuardMm = 0.5;

struct CuttingOptions {
    double pedal = 1.0;
    double depthMm = 0.0;      ///< below the surface where the bur first touches; 0: 1.5 (shoulder: 1.0; excavate: all)
    double lengthMm = 0.0;     ///< of a class I cavity, mesial to distal; 0: 4
    double isthmusMm = 1.2;    ///< its width
    double heightMm = 2.5;     ///< of a shoulder over z = 0 of the tooth
    double feedMmS = 2.0;      ///< of strokes; a third of it going in
    double dwellS = 4.0;       ///< at the end of the cut: the hand is ahead of the bur by load over stiffness
    double clearanceMm = 1.0;  ///< above the surface at the start
    core::Vec2 offsetMm =
        core::Vec2::Zero();             ///< of the first touch from the middle of the tooth, (x, y); not excavate
    double pulpGuardMm = kPulpGuardMm;  ///< excavate comes no nearer to the pulp; 0: does not heed it
};

/// How fast the bur comes through each tissue under a hand that is ahead of it: docs/physics.md#cutting.
struct CuttingRates {
    std::array<double, cases::kTissueCount> stiffnessNPerMm{};  ///< of what the hand presses against
    std::array<double, cases::kTissueCount> cuttingMm2PerN{};   ///< K, of this bur
    double speedRadS = 0.0;                                     ///< of the rotor under load
    double loadN = 1.0, loadCapN = 1.5;  ///< what the hand presses with at most; more cuts no faster
    double maxFeedMmS = 10.0;            ///< that the chips allow
    double centreRadius = 0.3;           ///< of the bur's: nearer to the axis it cuts as if it were there
};

/// What the cut is aimed at, in the tooth frame. All but excavate need only the bounds and the bur's size.
struct CuttingScene {
    core::Box toothBounds;
    double burRadiusMm = 0.5, burLengthMm = 4.0;
    std::function<double(double)> burBottomMm;  ///< the bur's lowest point at a distance from its axis; empty: a ball's
    std::vector<geometry::TriangleMesh> decay;  ///< closed; each connected part of them is a lesion
    std::function<double(const core::Vec3&)> outerMm;  ///< signed distance to the uncut surface, negative inside
    std::function<double(const core::Vec3&)> pulpMm;   ///< the same to the pulp; empty: there is none
    std::function<cases::Tissue(const core::Vec3&)> tissueAt;  ///< of the uncut tooth; empty: dentine
    std::optional<CuttingRates> rates;                         ///< what excavation waits for; empty: for nothing
};

/// Throws core::Error for what is out of range.
void validate(const CuttingOptions& options);

/// "plunge", "class-one", "crown-shoulder", "excavate".
[[nodiscard]] const std::vector<BuiltInMotion>& cuttingMotions();

/// The named cut, the bur's shank up (+z), the pedal down from the start until the bur is out again. It is what the
/// hand intends: a hand and a device that give way lag behind it. Feels for the surface with `method`, so not from the
/// tick while that uses it. Throws core::Error for a name there is not, options out of range, a bur too wide for the
/// cavity, or a place where there is nothing to cut.
[[nodiscard]] device::Motion cuttingMotionByName(std::string_view name, contact::Method& method,
                                                 const CuttingScene& scene, const CuttingOptions& options = {});

}  // namespace handpiece::studies
