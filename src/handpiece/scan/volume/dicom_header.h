// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a scan needs of a DICOM file's header. Only the elements named here are ever read: no name, number, date or
/// private element enters the program, so none can leave it.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/scan/volume/files.h"

namespace handpiece::volume {

/// Geometry and scale, of a file or of one frame.
struct DicomPlace {
    std::optional<std::array<double, 3>> positionMm;
    std::optional<std::array<double, 6>> orientation;  ///< along a row, down a column
    std::optional<std::array<double, 2>> spacingMm;    ///< from row to row, from column to column
    std::optional<double> thicknessMm, betweenMm, locationMm, slope, intercept;
};

struct DicomHeader {
    std::uint64_t seriesKey = 0;  ///< of the series' UID, which is not kept
    std::string modality, transferSyntax, photometric;
    int rows = 0, columns = 0, frames = 1, samplesPerPixel = 1;
    int allocated = 0, stored = 0, high = -1;
    bool isSigned = false, isBigEndian = false, isExplicit = true;
    bool hasBurnedInText = false, isLossy = false, isSecondaryCapture = false, isOverview = false, isFloat = false;
    std::optional<int> instance;
    DicomPlace place;                   ///< of the file, and what its frames share
    std::vector<DicomPlace> frame;      ///< what they have of their own
    std::vector<std::string> files;     ///< of a DICOMDIR
    std::vector<double> gridOffsetsMm;  ///< of frames along the normal (GridFrameOffsetVector)

    bool hasPixels = false, isEncapsulated = false;
    std::uint64_t pixelAt = 0, pixelBytes = 0;
    struct Fragment {
        std::uint64_t at = 0, bytes = 0;
    };
    std::vector<Fragment> fragments;          ///< of encapsulated pixels, without the offset table
    std::vector<std::uint64_t> frameOffsets;  ///< the offset table

    /// How far a frame lies from the next where all have one place.
    struct FrameStep {
        const char* by = nullptr;  ///< the element that tells it; null: each has its own place, or nothing tells it
        double mm = 0.0;           ///< along the normal; 0: as `gridOffsetsMm` says
        bool tellsSide = true;     ///< else the others may as well lie on the other side of the first
    };
    [[nodiscard]] FrameStep frameStep() const;
    [[nodiscard]] DicomPlace placeOf(int index) const;
};

/// Throws core::Error for what is no DICOM file or ends in its header.
[[nodiscard]] DicomHeader readDicomHeader(Input& input);
/// Frame `index` as stored, rescaled; columns x rows values. Throws core::Error.
void readDicomFrame(Input& input, const DicomHeader& header, int index, float* to);
/// Why frames cannot be read, or empty.
[[nodiscard]] std::optional<std::pair<std::string, std::string>> unreadable(const DicomHeader& header);

}  // namespace handpiece::volume
