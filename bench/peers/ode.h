// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// ODE, triangle mesh against capsule.

#include <memory>

#include "query.h"

namespace handpiece::bench {

[[nodiscard]] std::unique_ptr<Query> makeOde(const PeerInput& input);

}  // namespace handpiece::bench
