// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What has been cut, as bytes: for saved attempts and for key frames of sessions. docs/formats/cut-state.md has the
/// format.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "handpiece/model/tooth/state_delta.h"
#include "handpiece/model/tooth/tooth_mirror.h"

namespace handpiece::tooth {

/// The state, or a change, bit for bit, compressed; the same bytes at any thread count. `identity` is that of the teeth
/// it belongs to. In parallel, off the tick.
[[nodiscard]] std::vector<std::byte> encodeState(const StateDelta& state, std::uint64_t identity);

/// What encodeState() was given. Throws core::Error for bytes that are no state, cut short, damaged, of a newer version
/// or of other teeth, naming `where`. Sizes are believed only after the checksums, and what comes back fits the teeth:
/// bricks in their grids, rising, stored or inside; values within the band.
[[nodiscard]] StateDelta decodeState(std::span<const std::byte> data, const Teeth& teeth,
                                     const std::string& where = "cut state");

}  // namespace handpiece::tooth
