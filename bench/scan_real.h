// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Real teeth, of which only some figures are known.

#include <filesystem>
#include <string>

namespace handpiece::bench {

/// The GE tooth and the carious molar of ../shared/data: what is found, beside what is known of them.
void measureReal(const std::filesystem::path& folder, const std::string& pictures, bool segmentOnly);

}  // namespace handpiece::bench
