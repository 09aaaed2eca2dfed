// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A scan of a real preparation as work on an exercise.

#include "handpiece/app/assessment/score_work.h"
#include "handpiece/app/scan_work/scan_work.h"

namespace handpiece::assessment {

/// Throws core::Error as scan_work::readScan().
[[nodiscard]] Work readScan(const scan_work::Files& files, const tasks::Task& task,
                            const core::Progress& progress = {});
[[nodiscard]] Work workOfScan(scan_work::ScannedTeeth scanned);

}  // namespace handpiece::assessment
