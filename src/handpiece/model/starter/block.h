// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Blocks to practise on: as hard as a tooth, and flat, so that what the hand does is all that counts.

#include <array>
#include <string_view>

#include "handpiece/model/case/case.h"

namespace handpiece::starter {

enum class BlockLayers {
    hard,     ///< enamel throughout
    layered,  ///< enamel on dentine
    carious   ///< enamel on dentine, with a bowl of carious dentine that goes from soft inside to firm outside
};
inline constexpr std::array<std::string_view, 3> kBlockLayers = {"hard", "layered", "carious"};

/// 16 x 12 x 8 mm, its top at z = 0, buccal at -y; layered: the enamel is 1.5 mm thick; the bowl is 6 by 5 mm and
/// 3 mm deep. The same bytes at any thread count.
[[nodiscard]] cases::Case makeBlock(BlockLayers layers);

}  // namespace handpiece::starter
