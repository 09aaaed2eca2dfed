// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A scanned case as one page to print.

#include <filesystem>
#include <string>
#include <vector>

#include "handpiece/app/scan_case/scan_job.h"
#include "handpiece/base/core/progress.h"

namespace handpiece::scan_case {

struct ScanReportSettings {
    bool pictures = true;
    int pictureWidth = 620, pictureHeight = 520;
};
/// One HTML page that needs nothing beside it: pictures of the tooth, whole and cut open, slices with contours,
/// volumes, thicknesses, quality, times, what the scan cannot show, and how to try it now. `places`: where its cases
/// are, as casePlaces(); only the last of their names stand in it. Nothing of where the scan came from does. Seconds.
/// Throws core::Error.
[[nodiscard]] std::string scanReport(const ScanResult& result, const std::vector<std::filesystem::path>& places,
                                     const ScanReportSettings& settings = {}, const core::Progress& progress = {});

/// Where it goes: into a case's folder; beside a .handpiece file, and beside several cases, as NAME-report.html.
[[nodiscard]] std::filesystem::path scanReportPlace(const std::filesystem::path& out,
                                                    const std::vector<std::filesystem::path>& places);

}  // namespace handpiece::scan_case
