// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A case as its files hold it, without the files.

#include <filesystem>

#include "handpiece/model/case/case.h"

namespace handpiece::cases {

/// As readCase() gives it back from where writeCase() would put it: an STL holds less than a double.
[[nodiscard]] Case asWritten(const Case& toothCase, const std::filesystem::path& path);

}  // namespace handpiece::cases
