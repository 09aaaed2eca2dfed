// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the fuzz targets of the model's readers share: any bytes give a value or one core::Error.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "handpiece/base/core/error.h"

namespace handpiece::fuzz {

/// Calls work(bytes as text); an Error must name what is wrong on one line.
template <class Work>
int readText(const std::uint8_t* data, std::size_t size, const Work& work) {
    try {
        work(std::string_view(reinterpret_cast<const char*>(data), size));
    } catch (const core::Error& e) {
        if (e.problem().empty()) __builtin_trap();
    }
    return 0;
}

}  // namespace handpiece::fuzz
