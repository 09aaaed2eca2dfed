// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/hash_text.h"

#include <charconv>
#include <system_error>

namespace handpiece::core {

std::optional<std::uint64_t> readHash(std::string_view text) {
    std::uint64_t value = 0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value, 16);
    if (text.size() != 16 || error != std::errc{} || stop != end) return std::nullopt;
    return value;
}

}  // namespace handpiece::core
