// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A content hash as files have it: 16 hexadecimal digits.

#include <cstdint>
#include <optional>
#include <string_view>

namespace handpiece::core {

/// Of either case, leading zeros included; none for any other text.
[[nodiscard]] std::optional<std::uint64_t> readHash(std::string_view text);

}  // namespace handpiece::core
