// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How long work tells how far it is and learns that it should stop.

#include <functional>

#include "handpiece/base/core/error.h"

namespace handpiece::core {

/// Called now and then with the fraction done (0..1); returns false to cancel. May be empty. May be called from any
/// thread.
using Progress = std::function<bool(double)>;

/// Reports `fraction` and throws core::Error("cancelled") when the listener asked to stop.
inline void report(const Progress& progress, double fraction) {
    if (progress && !progress(fraction)) throw Error("cancelled");
}

/// The share from..to of a longer work, as a listener of its own.
inline Progress part(const Progress& progress, double from, double to) {
    if (!progress) return {};
    return [progress, from, to](double fraction) { return progress(from + (to - from) * fraction); };
}

}  // namespace handpiece::core
