// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What of the instrument can touch.

#include <cstddef>
#include <cstdint>

namespace handpiece::instrument {

/// Only the bur cuts; the others are behind it.
enum class BodyPart : std::uint8_t { bur, shank, head, handle };
inline constexpr std::size_t kBodyPartCount = 4;

}  // namespace handpiece::instrument
