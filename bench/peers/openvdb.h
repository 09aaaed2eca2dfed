// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// OpenVDB, a level set of 50 um looked up (trilinear) at each vertex of the bur.

#include <memory>

#include "query.h"

namespace handpiece::bench {

[[nodiscard]] std::unique_ptr<Query> makeOpenvdb(const PeerInput& input);

}  // namespace handpiece::bench
