// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How a picture lies in its file. Without it a slice that a program wrote from the bottom up is a mirror image.

#include <cstddef>
#include <cstdint>
#include <span>

namespace handpiece::volume {

/// Tag 274 of TIFF 6.0, and of EXIF: 1 from the top left, row by row (as built); 2 to 4 mirrored or turned by half; 5
/// to 8 with rows and columns changed over.
class Orientation {
  public:
    /// 1 for what the standard does not know.
    explicit Orientation(int tag = 1) : tag_(tag >= 1 && tag <= 8 ? tag : 1) {}
    /// Rows as seen are columns in the file.
    [[nodiscard]] bool isTransposed() const { return tag_ >= 5; }
    [[nodiscard]] bool isUpright() const { return tag_ == 1; }
    /// `from`: rows as they lie, `columns` wide; `to`: as they are seen.
    void turn(const float* from, int columns, int rows, float* to) const;

  private:
    int tag_;
};

/// Of an APP1 segment of a JPEG ("Exif", two zeros, a TIFF header): its first directory's tag; 1 where there is none.
[[nodiscard]] int exifOrientation(std::span<const std::uint8_t> segment);

}  // namespace handpiece::volume
