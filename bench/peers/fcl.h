// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// FCL, two meshes in OBBRSS trees, all contacts; depth is the largest one FCL reports.

#include <memory>

#include "query.h"

namespace handpiece::bench {

[[nodiscard]] std::unique_ptr<Query> makeFcl(const PeerInput& input);

}  // namespace handpiece::bench
