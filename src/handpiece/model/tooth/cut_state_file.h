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

#include "handpiece/model/tooth/cut_field.h"

namespace handpiece::tooth {

/// A number that two prepared teeth share only when a state of one is a state of the other: the hash of the whole
/// field, its tissues and the band. Reads all of it: some 10 ms.
[[nodiscard]] std::uint64_t identityOf(const CuttableTooth& base);

/// The state, or a change, bit for bit, compressed; the same bytes at any thread count. `baseKey` says of which tooth
/// it is, as identityOf() gives it. In parallel, off the tick.
[[nodiscard]] std::vector<std::byte> encodeState(const StateDelta& state, std::uint64_t baseKey);

/// What encodeState() was given. Throws core::Error for bytes that are no state, cut short, damaged, of a newer version
/// or of another tooth, naming `where`. Sizes are believed only after the checksums, and what comes back fits `base`:
/// bricks in the grid, rising, stored or inside; values within the band.
[[nodiscard]] StateDelta decodeState(std::span<const std::byte> data, std::uint64_t baseKey, const CuttableTooth& base,
                                     const std::string& where = "cut state");

}  // namespace handpiece::tooth
