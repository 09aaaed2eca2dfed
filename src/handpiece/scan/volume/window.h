// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What of a scan is read: all of it, a region, or what fits into memory when it is shrunk. Private to this room.

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/scan/volume/candidate.h"
#include "handpiece/scan/volume/volume.h"

namespace handpiece::volume {

/// Bytes of so many voxels. Throws core::Error where they are more.
[[nodiscard]] std::uint64_t checkedBytes(const std::array<int, 3>& size, const std::string& where,
                                         std::uint64_t limitBytes);

[[nodiscard]] inline std::array<int, 3> shrunk(const std::array<int, 3>& size, int by) {
    return {size[0] / by, size[1] / by, size[2] / by};
}
/// By how much a scan must shrink along each axis to fit; 1 where it fits or no shrinking helps.
[[nodiscard]] int shrinkingOf(const std::array<int, 3>& size, std::uint64_t limitBytes);
[[nodiscard]] std::string shrinkingText(const std::array<int, 3>& size, int by, std::uint64_t limitBytes);

/// From one slice to the next, where `stepMm` tells no other way than along the normal.
[[nodiscard]] inline core::Vec3 stepOf(const Grid& grid, const core::Vec3& stepMm) {
    return stepMm.isZero() ? core::Vec3(grid.axes.col(2) * grid.spacingMm.z()) : stepMm;
}

/// What is read of a scan: whole slices are passed through, these voxels kept, `by` of them made one along each axis.
struct Window {
    std::array<int, 3> first{}, count{};
    int by = 1;
    [[nodiscard]] bool isAll(const Grid& grid) const { return by == 1 && count == grid.size; }
};
/// The voxels of `grid` within a box of the scan's frame. Throws core::Error where there are none.
[[nodiscard]] Window windowOf(const Grid& grid, const core::Vec3& stepMm, const std::array<core::Vec3, 2>& regionMm,
                              const std::string& where);
/// Takes slice `k` of those that are kept; from several threads at once.
using TakeSlice = std::function<void(int k, const float* slice)>;
/// Reads what the window keeps, slice by slice of the file.
void readWindow(const Candidate& candidate, const Window& window, bool isLabels, const TakeSlice& take,
                const core::Progress& progress);

}  // namespace handpiece::volume
