// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the pointer's hand feels of a tooth that is being cut, and of all that stands around it.

#include <memory>

#include "handpiece/app/input/hand_feel.h"
#include "handpiece/app/simulation/live_tooth.h"

namespace handpiece::simulation {

/// Exact on the triangles; lips and cheeks are held aside and not minded. One thread, not the feeder's. Null without a
/// tooth or a bur.
[[nodiscard]] std::shared_ptr<input::HandFeel> feelMouth(std::shared_ptr<LiveTooth> tooth,
                                                         std::shared_ptr<const instrument::Bur> bur);

}  // namespace handpiece::simulation
