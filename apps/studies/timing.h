// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How long single contact queries take, along a path as a hand would lead it.

#include <cstddef>
#include <string>
#include <vector>

#include "handpiece/tick/contact/method.h"

namespace handpiece::studies {

/// Of single queries [us].
struct Timing {
    double p50 = 0.0, p99 = 0.0, p999 = 0.0, max = 0.0;
};

/// Poses along a zigzag over the middle of the crown, the bur upright, `depthMm` below where it touches (negative:
/// above). Throws core::Error when there is nothing below.
[[nodiscard]] std::vector<core::Pose> sweepAt(contact::Method& method, const core::Box& toothBounds, double depthMm,
                                              std::size_t count);
/// Asks for the depth (and the patches) at each pose, pose after pose; of each the fastest of three passes counts. The
/// clock's own 20 to 30 ns are included.
[[nodiscard]] Timing timeQueries(contact::Method& method, const std::vector<core::Pose>& poses, bool withPatches);
/// Plain arithmetic of about `us`, timed the same way: what the machine itself adds.
[[nodiscard]] Timing timeConstantLoad(double us, std::size_t count);
/// Processor and number of threads; no name of the machine.
[[nodiscard]] std::string machineDescription();

/// The bur upright at (x, y), just touching from above, to 1e-7 mm. Throws core::Error when it meets nothing.
[[nodiscard]] core::Pose touchAt(contact::Method& method, const core::Box& toothBounds, const core::Vec2& xyMm);

}  // namespace handpiece::studies
