// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What an error says, for tests of messages.

#include <string>

#include "handpiece/base/core/error.h"

namespace handpiece::test {

/// The text of the core::Error that `work` throws; empty when it throws none.
template <class Work>
std::string errorOf(const Work& work) {
    try {
        work();
    } catch (const core::Error& e) {
        return e.what();
    }
    return {};
}

/// Its id; empty when none is thrown or it has none.
template <class Work>
std::string errorIdOf(const Work& work) {
    try {
        work();
    } catch (const core::Error& e) {
        return e.id();
    }
    return {};
}

}  // namespace handpiece::test
