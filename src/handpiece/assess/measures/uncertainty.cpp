// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "handpiece/assess/measures/take.h"

namespace handpiece::measures {
namespace {

/// Half-width = fixed + perVoxelMm times the voxel + share times the value + residual times what the surface's
/// unevenness leaves open, in the kind's unit.
struct Row {
    std::string_view kind;
    double fixed, perVoxelMm, share, residual;
};
constexpr Row kRows[] = {
    {"floor-depth", 0.0, 0.0, 0.0, 1.0},
    {"floor-flatness", 0.0, 0.0, 0.0, 1.0},
    {"floor-tilt", 0.0, 0.0, 0.0, 1.0},
    {"isthmus", 0.0, 0.0, 0.0, 1.0},
    {"wall-angle", 0.0, 0.0, 0.0, 1.0},
    {"wall-height", 0.0, 0.0, 0.0, 1.0},
    {"cavosurface-angle", 0.0, 0.0, 0.0, 1.0},
};

}  // namespace

double uncertaintyOf(std::string_view kind, double voxelMm, double value, double residual) {
    for (const Row& row : kRows)
        if (row.kind == kind)
            return row.fixed + row.perVoxelMm * voxelMm + row.share * std::abs(value) + row.residual * residual;
    return 0.0;
}

}  // namespace handpiece::measures
