// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Words and numbers out of the text headers of formats.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace handpiece::volume {

[[nodiscard]] std::string_view trimmed(std::string_view text);
[[nodiscard]] std::string lowered(std::string_view text);
/// Separated by blanks.
[[nodiscard]] std::vector<std::string_view> wordsOf(std::string_view text);
/// The whole text is one number, "nan" and "inf" too; independent of the language of the machine.
[[nodiscard]] std::optional<double> numberOf(std::string_view text);
[[nodiscard]] std::optional<std::int64_t> wholeOf(std::string_view text);
/// As it may be shown: short, no control characters.
[[nodiscard]] std::string shown(std::string_view text);

}  // namespace handpiece::volume
