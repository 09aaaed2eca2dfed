// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A file on its way to the server, in pieces, from where the server is.

#include <cstdint>
#include <filesystem>
#include <string>

#include "school/line.h"

namespace handpiece::school_station {

/// Returns how much of it went now; 0: the server had it. Throws core::Error as Line does.
std::uint64_t sendFile(Line& line, const std::filesystem::path& file, const std::string& sha256);

}  // namespace handpiece::school_station
