// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// One slice as a DICOM file (CT image storage), through GDCM: nobody's name in it, the same scan the same bytes.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "handpiece/scan/volume/volume.h"

namespace handpiece::volume {

struct DicomScale {
    double slope = 1.0, intercept = 0.0;
    bool isSigned = false;
};

/// Out of all that is in a scan: its UIDs are made of this.
[[nodiscard]] std::uint64_t scanKey(const Volume& volume);
[[nodiscard]] std::vector<std::byte> dicomBytes(std::span<const std::uint16_t> stored, const Grid& grid, int k,
                                                const DicomScale& scale, std::uint64_t key);

}  // namespace handpiece::volume
