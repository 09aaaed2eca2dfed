// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A radiograph as a DICOM file, through GDCM. Private to this room.

#include <cstddef>
#include <vector>

#include "handpiece/scan/volume/write_radiograph.h"

namespace handpiece::volume {

[[nodiscard]] std::vector<std::byte> dicomRadiographBytes(const RadiographFile& radiograph);

}  // namespace handpiece::volume
