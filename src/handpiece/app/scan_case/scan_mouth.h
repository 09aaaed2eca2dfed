// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Labels of a mouth: its teeth one by one, where they stand, and the case that they make. Private to scan_*.cpp.

#include "handpiece/app/scan_case/scan_job.h"

namespace handpiece::scan_case {

/// The tooth that is worked on: as the job asks for, else the one most suited.
[[nodiscard]] segmentation::Region segmentMouth(ScanResult& result, const core::Progress& progress);
/// The other teeth's surfaces, all of them held apart.
void surfaceOthers(ScanResult& result, surfacing::Surfaces& own, const core::Progress& progress);
/// Where all of them stand, and the jaws.
void placeMouth(ScanResult& result, const core::Progress& progress);
/// Adds them to a case of the tooth that is worked on; `percent`: of their faces.
void addOthers(const ScanResult& result, double percent, cases::Case& made);
/// Name and kind of a tooth by its number; empty where it has none.
struct ToothWords {
    std::string name, kind;
};
[[nodiscard]] ToothWords wordsOf(int fdi);

}  // namespace handpiece::scan_case
