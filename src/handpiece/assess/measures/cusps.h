// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Cusps as what is selected.

#include <string_view>

namespace handpiece::measures {

/// What `reduction` takes for a side beside kSides: the cusp whose tip the case names so ("palatal" is lingual), else,
/// where its side has one cusp (premolars), that one's mesial or distal half.
inline constexpr std::string_view kCusps[] = {"mesiobuccal-cusp", "distobuccal-cusp", "mesiolingual-cusp",
                                              "distolingual-cusp"};

}  // namespace handpiece::measures
