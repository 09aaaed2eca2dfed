// SPDX-License-Identifier: Apache-2.0
// Compiled once per instruction set; see cmake/handpiece.cmake.
#include "handpiece/tick/contact/sampled/field_row.h"

#include "handpiece/tick/contact/lanes.h"

namespace handpiece::contact::HANDPIECE_SIMD_NS {
namespace {

using field::kBrickCells;
using field::kBrickNodes;
using field::kBrickValues;

/// Eight places in the grid: the first value of each one's cell (or nothing) and where in the cell it lies.
struct Places {
    const float* corner[8];
    float fraction[3][8];
    float far[8];  ///< for places without a brick

    Places(const field::FieldView& field, const FieldRow& row, int first) {
        double grid[3][8];
        for (int k = 0; k < 3; ++k)
            for (int lane = 0; lane < 8; ++lane)
                grid[k][lane] = (row.centre[k] - field.originMm[k] + row.cosines[first + lane] * row.x[k] +
                                 row.sines[first + lane] * row.y[k]) *
                                field.inverseVoxelMm;
        for (int lane = 0; lane < 8; ++lane) {
            int cell[3], brick[3];
            double away2 = 0.0, outside2 = 0.0;
            for (int k = 0; k < 3; ++k) {
                const double g = grid[k][lane], last = kBrickCells * field.bricks[k];
                const double inGrid = g < 0.0 ? 0.0 : g > last ? last : g;
                outside2 += (g - inGrid) * (g - inGrid);
                int c = static_cast<int>(inGrid);
                if (c >= kBrickCells * field.bricks[k]) c = kBrickCells * field.bricks[k] - 1;
                brick[k] = c / kBrickCells;
                cell[k] = c - kBrickCells * brick[k];
                const double t = inGrid - c;
                fraction[k][lane] = static_cast<float>(t);
                const double d = cell[k] + t - 0.5 * kBrickCells;
                away2 += d * d;
            }
            const std::int64_t dense =
                brick[0] + static_cast<std::int64_t>(field.bricks[0]) *
                               (brick[1] + static_cast<std::int64_t>(field.bricks[1]) * brick[2]);
            const std::int32_t stored = field.brickIndex[dense];
            corner[lane] = nullptr;
            if (outside2 > 0.0) {
                const float gap = static_cast<float>(field.voxelMm * __builtin_sqrt(outside2));
                far[lane] = gap > row.farOutMm ? gap : row.farOutMm;
            } else if (stored >= 0) {
                corner[lane] = field.values + static_cast<std::int64_t>(stored) * kBrickValues + cell[0] +
                               kBrickNodes * (cell[1] + kBrickNodes * cell[2]);
            } else {
                const float centre = field.coarse[dense];
                const float bound = __builtin_fabsf(centre) - static_cast<float>(field.voxelMm * __builtin_sqrt(away2));
                far[lane] = centre < 0.0f ? -(bound > row.farInMm ? bound : row.farInMm)
                                          : (bound > row.farOutMm ? bound : row.farOutMm);
            }
        }
    }
};

constexpr int kY = kBrickNodes, kZ = kBrickNodes * kBrickNodes;
constexpr int kCorner[8] = {0, 1, kY, kY + 1, kZ, kZ + 1, kZ + kY, kZ + kY + 1};

inline void load(const Places& places, Floats (&v)[8], Floats (&t)[3]) {
    static const float none[kZ + kY + 2] = {};
    for (int lane = 0; lane < 8; ++lane) {
        const float* corner = places.corner[lane] != nullptr ? places.corner[lane] : none;
        for (int i = 0; i < 8; ++i)
            v[i][lane] = corner[kCorner[i]];
    }
    for (int k = 0; k < 3; ++k)
        t[k] = loadFloats(places.fraction[k]);
}

inline Floats mix(Floats a, Floats b, Floats t) {
    return a + t * (b - a);
}

void distances(const field::FieldView& field, const FieldRow& row, int first, float* out) noexcept {
    const Places places(field, row, first);
    Floats v[8], t[3];
    load(places, v, t);
    const Floats low = mix(mix(v[0], v[1], t[0]), mix(v[2], v[3], t[0]), t[1]);
    const Floats high = mix(mix(v[4], v[5], t[0]), mix(v[6], v[7], t[0]), t[1]);
    const Floats d = mix(low, high, t[2]);
    for (int lane = 0; lane < 8; ++lane)
        out[lane] = places.corner[lane] != nullptr ? d[lane]
                    : places.far[lane] < 0.0f      ? places.far[lane] - kBoundMm
                                                   : places.far[lane] + kBoundMm;
}

}  // namespace

FieldLookup fieldLookup() noexcept {
    return distances;
}

}  // namespace handpiece::contact::HANDPIECE_SIMD_NS
