// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A scanned volume and a volume of labels, and where their voxels lie.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "handpiece/base/core/vec.h"

namespace handpiece::volume {

/// Where voxels lie in the scanner's frame [mm]: DICOM's patient frame (+x left, +y back, +z head) where the file
/// tells it, else the axes of the slices. Right-handed.
struct Grid {
    std::array<int, 3> size{};                  ///< voxels along i (columns), j (rows), k (slices)
    core::Vec3 spacingMm = core::Vec3::Ones();  ///< between voxel centres
    core::Vec3 originMm = core::Vec3::Zero();   ///< centre of voxel (0, 0, 0)
    core::Mat3 axes = core::Mat3::Identity();   ///< columns: unit directions of i, j and k

    [[nodiscard]] std::size_t count() const {
        return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
               static_cast<std::size_t>(size[2]);
    }
    /// Of voxel (i, j, k); i fastest.
    [[nodiscard]] std::size_t index(int i, int j, int k) const {
        return (static_cast<std::size_t>(k) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(j)) *
                   static_cast<std::size_t>(size[0]) +
               static_cast<std::size_t>(i);
    }
    /// From voxel coordinates (whole numbers at voxel centres) to the scanner's frame.
    [[nodiscard]] core::Vec3 toMm(const core::Vec3& ijk) const { return originMm + axes * ijk.cwiseProduct(spacingMm); }
    [[nodiscard]] core::Vec3 toVoxels(const core::Vec3& mm) const {
        return (axes.transpose() * (mm - originMm)).cwiseQuotient(spacingMm);
    }
    /// Of the voxel that a place [mm] lies in; none outside of it.
    [[nodiscard]] std::optional<std::size_t> indexAt(const core::Vec3& mm) const {
        const core::Vec3 at = (toVoxels(mm).array() + 0.5).floor();
        for (int a = 0; a < 3; ++a)
            if (!(at[a] >= 0.0 && at[a] < size[static_cast<std::size_t>(a)])) return std::nullopt;
        return index(static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2]));
    }
    [[nodiscard]] double voxelMm3() const { return spacingMm.prod(); }
};

/// Grey values: Hounsfield units where the scanner gives them, else as stored.
struct Volume {
    Grid grid;
    std::vector<float> values;  ///< i fastest
};

/// A tissue's number a voxel: 0 nothing, 1 caries, 2 enamel, 3 dentine, 4 pulp, 5 restoration, 6 bone, 7 gum or other
/// soft tissue; other numbers keep what a file meant by them until they are mapped.
struct Labels {
    Grid grid;
    std::vector<std::uint8_t> values;  ///< i fastest
};

}  // namespace handpiece::volume
