// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What stands around a tooth in its scan: to be seen, not cut. Private to scan_*.cpp.

#include <array>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/model/case/case.h"
#include "handpiece/scan/segmentation/label_key.h"
#include "handpiece/scan/segmentation/segment.h"
#include "handpiece/scan/volume/volume.h"

namespace handpiece::scan_case {

/// Hard things within reachMm of the tooth (other teeth and bone, which grey values alone do not tell apart), in the
/// scanner's frame, coarse.
[[nodiscard]] std::vector<cases::Part> sceneryOf(const volume::Volume& volume,
                                                 const segmentation::Thresholds& thresholds,
                                                 const geometry::TriangleMesh& outer, double reachMm,
                                                 const core::Progress& progress = {});
/// Neighbours, bone and gum by their labels.
[[nodiscard]] std::vector<cases::Part> sceneryOf(const volume::Labels& labels, const geometry::TriangleMesh& outer,
                                                 double reachMm, const core::Progress& progress = {});

/// The jaws' bone about the teeth, gingiva, and what else labels of a mouth tell, in the scanner's frame, coarse. Apart
/// from the teeth by about a quarter of a millimetre, and no farther than reachMm from the box about those of its jaw.
[[nodiscard]] std::vector<cases::Part> jawsOf(const volume::Labels& labels, const segmentation::LabelKey& key,
                                              const std::array<core::Box, 2>& teethOfJaws, double reachMm,
                                              const core::Progress& progress = {});

}  // namespace handpiece::scan_case
