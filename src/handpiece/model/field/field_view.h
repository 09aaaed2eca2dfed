// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The arrays of a DistanceField as plain data, for kernels that may include nothing else.

#include <cstdint>

namespace handpiece::field {

inline constexpr int kBrickCells = 8;                ///< cells along a brick's edge
inline constexpr int kBrickNodes = kBrickCells + 1;  ///< nodes along it: neighbours share (and repeat) a face of nodes
inline constexpr int kBrickValues = kBrickNodes * kBrickNodes * kBrickNodes;  ///< 729; index x + 9 y + 81 z
inline constexpr int kCentreNode = kBrickValues / 2;

/// Plain view of the field for kernels (no Eigen, no standard containers).
struct FieldView {
    double originMm[3];  ///< node 0 of brick 0
    double voxelMm, inverseVoxelMm;
    std::int32_t bricks[3];          ///< bricks along x, y, z
    const std::int32_t* brickIndex;  ///< dense, x fastest: >= 0 a stored brick, -1 none (see coarse)
    const float* values;             ///< kBrickValues per stored brick: signed distance [mm], negative inside
    const float* coarse;  ///< per brick (dense): signed distance at the brick's centre [mm], exact where known
    const std::uint32_t* tissueStart;  ///< per brick (dense): where its kBrickValues lie in `tissue`
    const std::uint8_t* tissue;
};

}  // namespace handpiece::field
