// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What an error says, for tests of messages.

#include <optional>
#include <string>

#include "handpiece/base/core/error.h"

namespace handpiece::test {

/// The core::Error that `work` throws.
template <class Work>
std::optional<core::Error> errorFrom(const Work& work) {
    try {
        work();
    } catch (const core::Error& e) {
        return e;
    }
    return std::nullopt;
}

/// Its text; empty when none is thrown.
template <class Work>
std::string errorOf(const Work& work) {
    const std::optional<core::Error> error = errorFrom(work);
    return error ? error->what() : std::string();
}

/// Its id; empty when none is thrown or it has none.
template <class Work>
std::string errorIdOf(const Work& work) {
    const std::optional<core::Error> error = errorFrom(work);
    return error ? error->id() : std::string();
}

}  // namespace handpiece::test
