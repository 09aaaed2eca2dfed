// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Scans out: for the phantom scanner, and labels for other programs.

#include <filesystem>
#include <string_view>

#include "handpiece/base/core/progress.h"
#include "handpiece/scan/volume/volume.h"

namespace handpiece::volume {

enum class ScanFormat { dicom, tiff, bmp, jpeg, png, nrrd, raw, metaimage, nifti };
/// "dicom", "tiff", ...; throws core::Error naming those there are.
[[nodiscard]] ScanFormat scanFormatByName(std::string_view name);

/// Writes a scan into a folder (slices, or one file named "scan"). Values are rounded; 16-bit formats hold
/// -32768..32767 (DICOM) or 0..65535, 8-bit ones (BMP, JPEG) are scaled from the volume's range. Slices that cannot
/// hold their spacing get a scan.toml beside them, which readScan reads. Whole or not at all.
void writeScan(const Volume& volume, const std::filesystem::path& folder, ScanFormat format,
               const core::Progress& progress = {});
/// As NRRD (gzip), 8 bit.
void writeLabels(const Labels& labels, const std::filesystem::path& file);

}  // namespace handpiece::volume
