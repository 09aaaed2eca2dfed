// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Bullet, triangle mesh against convex hull, margins 0, single precision.

#include <memory>

#include "query.h"

namespace handpiece::bench {

[[nodiscard]] std::unique_ptr<Query> makeBullet(const PeerInput& input);

}  // namespace handpiece::bench
