// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A simulated radiograph as a file.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace handpiece::volume {

struct RadiographFile {
    int width = 0, height = 0;
    std::span<const std::uint16_t> grey;  ///< rows from the top, 65535 dense and white
    double pixelMm = 0.0;                 ///< on the detector
    std::string view;                     ///< "bitewing", "periapical"
    int fdiNumber = 0;                    ///< of the tooth in the middle; 0 unknown
    double kv = 0.0, focalSpotMm = 0.0, sourceMm = 0.0;
    bool isWide = true;  ///< of a PNG: 16 bit, else 8; DICOM has 16
};

/// A .png (grey) or a .dcm (Digital Intra-Oral X-Ray Image, for presentation; marked as derived and simulated, no
/// patient, the same picture the same bytes). Throws core::Error: another ending, a place that cannot be written.
void writeRadiograph(const RadiographFile& radiograph, const std::filesystem::path& file);
/// Throws core::Error for what writeRadiograph() would not write.
void requireRadiographName(const std::filesystem::path& file);

}  // namespace handpiece::volume
