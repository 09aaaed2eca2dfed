// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The pictures of a scanned case's report: slices with contours, and the tooth as the window draws it. Private to
/// scan_*.cpp.

#include <string>
#include <vector>

#include "handpiece/app/scan_case/scan_job.h"
#include "handpiece/base/core/progress.h"
#include "handpiece/senses/view/image.h"

namespace handpiece::scan_case {

struct NamedPicture {
    view::Image image;
    std::string caption;
};

/// The region's three middle slices, grey values as scanned (labels: their colours) with the tissues' outlines. Rows
/// and columns as in the scan; nothing beyond the region is shown.
[[nodiscard]] std::vector<NamedPicture> slicesOf(const ScanResult& result);
/// The case of most faces from the standard views and cut open. Throws core::Error where there is no OpenGL.
[[nodiscard]] std::vector<NamedPicture> viewsOf(const ScanResult& result, int width, int height,
                                                const core::Progress& progress);

}  // namespace handpiece::scan_case
