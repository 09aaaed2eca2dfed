// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// libccd GJK and EPA with a linear scan as support, over all vertices or over those of the hulls.

#include <memory>

#include "query.h"

namespace handpiece::bench {

[[nodiscard]] std::unique_ptr<Query> makeLibccd(const PeerInput& input, bool hullVerticesOnly);

}  // namespace handpiece::bench
