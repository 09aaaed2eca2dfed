// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A scan and what became of it, made ready to be looked at. Any thread, no widgets.

#include <array>
#include <memory>
#include <vector>

#include "desktop/features/scan/scan_figures.h"
#include "handpiece/app/scan_case/scan_job.h"
#include "handpiece/base/core/progress.h"

namespace handpiece::desktop {

/// How often grey values occur, between those of all but a thousandth at either end.
struct GreyHistogram {
    float low = 0, high = 1;
    std::vector<std::uint64_t> counts;  ///< evenly from low to high; one a value where values are few whole numbers
};
[[nodiscard]] GreyHistogram histogramOf(const volume::Volume& volume);

struct ShownScan {
    std::shared_ptr<const volume::Scan> scan;
    std::shared_ptr<const volume::Scan>
        coarse;  ///< for previews: at least kPreviewMm; the scan itself where it is that
    std::shared_ptr<const volume::Labels> labels, coarseLabels;  ///< of a scan that is labels
    std::shared_ptr<const segmentation::LabelKey> labelKey;
    GreyHistogram histogram;
};
inline constexpr double kPreviewMm = 0.1;
inline constexpr std::size_t kPreviewVoxels = 12'000'000;  ///< more would not be seen within about a second

/// Means of blocks of voxels (of labels: their first) so that a preview of it is quick.
[[nodiscard]] volume::Volume coarsened(const volume::Volume& volume, bool isLabels);
/// `job` says whether it is labels, and what they mean. Throws core::Error for labels that are none.
/// What a preview is made of: the coarse scan, or of a jaw the surroundings of the tooth that was picked, less coarse.
[[nodiscard]] std::shared_ptr<const volume::Scan> previewScan(const ShownScan& shown,
                                                              const segmentation::Settings& settings);
[[nodiscard]] ShownScan shownScan(volume::Scan scan, const scan_case::ScanJob& job, const core::Progress& progress);

/// A result, and its surfaces as one sees them: in the tooth's frame, the outside in pieces by tissue.
struct ShownResult {
    scan_case::ScanResult result;
    std::vector<cases::Part> parts;
    core::Box bounds;     ///< tooth frame
    ScanFigures figures;  ///< of a finished one
};
/// With figures when the result holds cases.
[[nodiscard]] ShownResult shownResult(scan_case::ScanResult result, const core::Progress& progress = {});

/// Teeth are about this long, crown to apex [mm]: the mean of lower and upper first molars.
inline constexpr double kMeanMolarMm = 21.0;
/// What the millimetres of a scan must be multiplied with for its largest tooth to be as long as a mean molar.
[[nodiscard]] double scaleByMolar(const volume::Volume& volume, const core::Progress& progress);

}  // namespace handpiece::desktop
