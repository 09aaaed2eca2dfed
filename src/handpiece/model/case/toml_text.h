// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Values as TOML writes them, for those who write files of the product.

#include <span>
#include <string>
#include <string_view>

namespace handpiece::cases {

/// In quotes, with all that needs it escaped; what is no UTF-8 becomes '?'.
[[nodiscard]] std::string tomlText(std::string_view text);
/// ["a", "b"]
[[nodiscard]] std::string tomlList(std::span<const std::string> texts);
/// With 17 digits and a point or an exponent: comes back as the same bits.
[[nodiscard]] std::string tomlNumber(double value);

}  // namespace handpiece::cases
