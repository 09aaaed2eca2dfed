// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The laws that are always there. Private to this room.

#include <memory>

#include "handpiece/tick/force/force_law.h"

namespace handpiece::force {

/// Ours: F = k |proxy - device| + b x (filtered approach speed), towards the proxy; k and b weighted by the pressure on
/// each tissue; the damper ramped in; never pulling. Right in slots and on thin walls.
[[nodiscard]] std::unique_ptr<ForceLaw> makeProxyLaw();

/// The paper's: F = k depth + b x (filtered approach speed), along the normal at the device's pose, of one stiffness
/// for all tissues; never pulling. docs/physics.md#force says where that fails.
[[nodiscard]] std::unique_ptr<ForceLaw> makePenaltyLaw();

}  // namespace handpiece::force
