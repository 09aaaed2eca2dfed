// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A case as the packages carry it: its files, the surfaces a tenth of their STL. docs/formats/prepared.md has the
/// format.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "handpiece/model/case/case.h"

namespace handpiece::cases {

[[nodiscard]] std::vector<std::byte> packCase(const Case& toothCase);

/// As readCase() gives it back from where writeCase() would put it; nothing for bytes that are damaged.
[[nodiscard]] std::optional<Case> unpackCase(std::span<const std::byte> packed, const std::filesystem::path& place);

}  // namespace handpiece::cases
