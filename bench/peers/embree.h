// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Embree, one point query for each vertex of the bur; the sign by the angle-weighted pseudonormal.

#include <memory>

#include "query.h"

namespace handpiece::bench {

[[nodiscard]] std::unique_ptr<Query> makeEmbree(const PeerInput& input);

}  // namespace handpiece::bench
