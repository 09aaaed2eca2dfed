// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What is drawn over the tooth: mouth mirror, arrows, chips and spray, scale bar; and two pictures made into one for
/// two eyes. Private to this room. To be drawn in the order of makeEffects().

#include <functional>
#include <memory>
#include <vector>

#include "handpiece/senses/view/passes.h"

namespace handpiece::view {

/// Length of the force arrow, and of the contact arrow, which only says where to.
inline constexpr double kForceArrowMmPerN = 2.0, kContactArrowMm = 2.5;
inline constexpr double kScaleBarMm = 5.0, kScaleTickMm = 1.0;

/// A round glass with rim and handle; the glass shows the scene as seen from behind it (PassContext::drawScene), at
/// half the resolution on a software renderer.
[[nodiscard]] std::unique_ptr<Pass> makeMirrorPass();
/// Contact and force arrows; their hidden parts shine through.
[[nodiscard]] std::unique_ptr<Pass> makeArrowPass();
/// Chips and water. `headRadiusMm`: of the bur, asked for at every picture. draw() blends; depth is tested, not
/// written.
[[nodiscard]] std::unique_ptr<Pass> makeParticlePass(std::function<double()> headRadiusMm);
[[nodiscard]] std::unique_ptr<Pass> makeScaleBarPass();

/// All of them in the order to be drawn, solid ones first.
[[nodiscard]] std::vector<std::unique_ptr<Pass>> makeEffects(std::function<double()> headRadiusMm);

/// Left (-1) or right (+1) eye: moved aside by half of the separation, looking the same way, its frustum leaning so
/// that what lies at the target's depth is at the same place in both pictures.
[[nodiscard]] Eye stereoEye(const Camera& camera, const Viewport& viewport, double separationMm, int side);
/// The size at which each eye's picture is to be drawn: half as wide side by side, else the same.
[[nodiscard]] Viewport stereoViewport(const Viewport& viewport, Stereo stereo);
/// One picture of two. Side by side: left on the left (one column stays dark where the width is odd). Anaglyph for
/// red-cyan glasses: E. Dubois, "A projection method to generate anaglyph stereo images", ICASSP 2001, in linear light.
void composeStereo(const Image& left, const Image& right, const Viewport& viewport, Stereo stereo, Image& out);

}  // namespace handpiece::view
