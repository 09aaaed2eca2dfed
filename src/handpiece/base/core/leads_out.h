// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Names in strangers' folders stay inside of them; what a link of such a name leads to need not.

#include <filesystem>

namespace handpiece::core {

/// Whether a file, by its name in the folder, lies elsewhere: it is a link, or lies in one, that leads out. False where
/// that cannot be told: reading says what is wrong.
[[nodiscard]] bool leadsOut(const std::filesystem::path& folder, const std::filesystem::path& file);

}  // namespace handpiece::core
