// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Rotations whose template machinery is heavy to compile: here once for everybody.

#include "handpiece/base/core/vec.h"

namespace handpiece::core {

/// The shortest rotation that takes the direction of `from` to that of `to`; of opposite directions, one of the half
/// turns. Neither vector may be zero.
[[nodiscard]] Quat rotationBetween(const Vec3& from, const Vec3& to);

}  // namespace handpiece::core
