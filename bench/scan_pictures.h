// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Slices of a scan with what was there and what was found.

#include <filesystem>
#include <string>

#include "handpiece/scan/segmentation/segment.h"
#include "handpiece/scan/volume/volume.h"

namespace handpiece::bench {

/// NAME-x.png, -y.png and -z.png: five slices each; outlines of the truth (where there is one) green, of the region's
/// solids red (outer), orange (dentine), magenta (pulp), yellow (caries, filling).
void writePictures(const std::filesystem::path& folder, const std::string& name, const volume::Volume& volume,
                   const volume::Labels* truth, const segmentation::Region& region);

}  // namespace handpiece::bench
