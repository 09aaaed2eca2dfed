// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Scans in: DICOM series (GDCM), slices as BMP, JPEG, PNG and TIFF, NRRD, MetaImage, NIfTI, raw with a description.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/scan/volume/volume.h"

namespace handpiece::volume {

/// What a label volume's own header calls a number.
struct LabelName {
    int value = 0;
    std::string name;
};

/// One thing that can be read out of a file, a folder, a ZIP or a DICOMDIR. Nothing in it names a patient: no name, no
/// UID, no date, no private tag, no path.
struct Series {
    std::string id;        ///< "1", "2", ... as readScan takes it
    std::string format;    ///< "DICOM", "TIFF slices", "NRRD", ...
    std::string modality;  ///< "CT" where it is told
    int slices = 0;
    std::array<int, 3> size{};
    core::Vec3 spacingMm = core::Vec3::Zero();
    bool isSpacingKnown = false;  ///< else spacing must be given
    bool isSideKnown = true;      ///< else nobody can tell it from its mirror image; a note says why
    int bits = 0;                 ///< a stored value
    /// The middle slice, fitted into 128 x 128, 8 bit, rows from the top.
    std::array<int, 2> thumbnailSize{};
    std::vector<std::uint8_t> thumbnail;
    std::vector<std::string> notes;  ///< what a person should know: gaps, tilt, burned-in text, left-out files
    /// Of 3D Slicer's segments and of the label table in a NIfTI file's extension; empty where a file tells none.
    std::vector<LabelName> labelNames{};
};

/// What there is, the largest first. Throws core::Error when nothing fits, saying what was found instead.
[[nodiscard]] std::vector<Series> findSeries(const std::filesystem::path& path, const core::Progress& progress = {});

struct ReadSettings {
    std::string series;  ///< id; empty: the only one, or the largest when `takeLargest`
    bool takeLargest = false;
    std::optional<core::Vec3> spacingMm;  ///< wins over the file's
    /// Slices are numbered from the other end than is taken for granted: a mirror image of what is read without it.
    bool reverseSlices = false;
    bool isLabels = false;  ///< values are numbers of tissues: of several the commonest counts, never their mean
    /// Two corners of a box in the scan's frame: only what lies in it is read.
    std::optional<std::array<core::Vec3, 2>> regionMm;
    /// Of the volume in memory; a larger one is read at a half or a quarter of its size along each axis, and told; what
    /// is too large even so is refused before it is allocated.
    std::uint64_t limitBytes = 4ull << 30;
};

struct Scan {
    Volume volume;
    Series series;
};

/// Reads one series; spacing and orientation are right or it throws core::Error (what, which file, what to do).
/// The same bytes at any thread count.
[[nodiscard]] Scan readScan(const std::filesystem::path& path, const ReadSettings& settings = {},
                            const core::Progress& progress = {});

struct LabelScan {
    Labels labels;
    Series series;
};
/// The same of labels, whole numbers 0..255 (as floats: within 0.001), in the quarter of the memory. Throws core::Error
/// for any other.
[[nodiscard]] LabelScan readLabels(const std::filesystem::path& path, ReadSettings settings = {},
                                   const core::Progress& progress = {});
/// A volume whose values are whole numbers 0..255 (as floats: within 0.001), as labels. Throws core::Error otherwise.
[[nodiscard]] Labels toLabels(const Volume& volume, const std::string& where);

}  // namespace handpiece::volume
