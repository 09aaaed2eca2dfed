// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The parts of a scan's job as text, stage by stage: equal texts, equal results. Private to scan_*.cpp.

#include <string>

#include "handpiece/app/scan_case/scan_job.h"

namespace handpiece::scan_case {

[[nodiscard]] std::string readToml(const ScanJob& job);
[[nodiscard]] std::string segmentToml(const ScanJob& job);
[[nodiscard]] std::string surfaceToml(const ScanJob& job);
[[nodiscard]] std::string placeToml(const ScanJob& job);

}  // namespace handpiece::scan_case
