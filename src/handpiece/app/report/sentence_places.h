// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Sentences that are kept in English, found again among the patterns that they were made of. Private to this room.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace handpiece::report {

/// What stands in the places ({}) of a sentence; none where it is of another pattern. A place reaches as far as the
/// next piece of the pattern is first found, the last one to the end.
[[nodiscard]] std::optional<std::vector<std::string>> placesIn(std::string_view sentence, std::string_view pattern);

}  // namespace handpiece::report
