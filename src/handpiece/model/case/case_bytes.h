// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A case as bytes and back, so that a session holds the tooth it was cut from and can be replayed anywhere.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "handpiece/model/case/case.h"

namespace handpiece::cases {

/// The tooth of a case, bit for bit: name, outer surface, parts, landmarks, and so the others and what is felt. Without
/// the rest of the scenery, exercise, source or any path.
[[nodiscard]] std::vector<std::byte> encodeCase(const Case& toothCase);
/// Throws core::Error naming `where` for bytes that are damaged, cut off or of a newer version.
[[nodiscard]] Case decodeCase(std::span<const std::byte> bytes, const std::string& where);

}  // namespace handpiece::cases
