// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What happened tick by tick, as arrays by name.

#include <memory>
#include <vector>

#include "handpiece/base/messages/haptic_sample.h"
#include "handpiece/record/session/record.h"
#include "python/arrays.h"

namespace handpiece::python {

/// Of a run: views, which keep the samples alive.
[[nodiscard]] py::dict samplesOf(std::shared_ptr<const std::vector<messages::HapticSample>> samples);
/// Of a session: views but for what its file holds in steps. `rateHz` gives the times.
[[nodiscard]] py::dict samplesOf(std::shared_ptr<const std::vector<session::Record>> records, double rateHz);

}  // namespace handpiece::python
