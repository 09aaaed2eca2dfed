// SPDX-License-Identifier: Apache-2.0
// Compiled once per instruction set; see cmake/handpiece.cmake.
#include "handpiece/tick/contact/ring_kernels.h"

#include "handpiece/tick/contact/lanes.h"

namespace handpiece::contact::HANDPIECE_SIMD_NS {
namespace {

using tooth::kBrickCells;
using tooth::kBrickNodes;
using tooth::kBrickValues;
constexpr int kBrickShift = 3;
static_assert(kBrickCells == 1 << kBrickShift);

/// Eight places in the grid: where each one's cell begins in the values (or -1) and where in the cell it lies.
struct Places {
    Longs corner;
    Floats fraction[3];
    float far[8];  ///< for places without a brick
    bool allStored = true;

    Places(const tooth::FieldView& field, const FieldRow& row, int first) {
        Doubles cosine, sine;
        __builtin_memcpy(&cosine, row.cosines + first, sizeof cosine);
        __builtin_memcpy(&sine, row.sines + first, sizeof sine);
        Doubles grid[3];
        Ints brick[3], cell[3];
        for (int k = 0; k < 3; ++k) {
            grid[k] = (row.centre[k] - field.originMm[k] + cosine * row.x[k] + sine * row.y[k]) * field.inverseVoxelMm;
            // The last face of the grid belongs to the last cell.
            const std::int32_t last = kBrickCells * field.bricks[k] - 1;
            const Doubles inGrid = clampTo(grid[k], Doubles{}, splat(last + 1.0));
            Ints c = __builtin_convertvector(inGrid, Ints);
            c = c > last ? Ints{} + last : c;
            fraction[k] = __builtin_convertvector(inGrid - __builtin_convertvector(c, Doubles), Floats);
            brick[k] = c >> kBrickShift;
            cell[k] = c & (kBrickCells - 1);
        }
        const Ints dense = brick[0] + field.bricks[0] * (brick[1] + field.bricks[1] * brick[2]);
        const Ints inBrick = cell[0] + kBrickNodes * (cell[1] + kBrickNodes * cell[2]);
        Ints stored;
        for (int lane = 0; lane < 8; ++lane)
            stored[lane] = field.brickIndex[dense[lane]];
        corner = __builtin_convertvector(stored, Longs) * kBrickValues + __builtin_convertvector(inBrick, Longs);
        Ints outside = stored < 0;
        for (int k = 0; k < 3; ++k) {
            const Longs beyond = (grid[k] < 0.0) | (grid[k] > static_cast<double>(kBrickCells * field.bricks[k]));
            outside |= __builtin_convertvector(beyond, Ints);
        }
        if (bitsOf(outside) == 0) return;
        allStored = false;
        for (int lane = 0; lane < 8; ++lane) {
            if (!outside[lane]) continue;
            corner[lane] = -1;
            double away2 = 0.0, outside2 = 0.0;
            for (int k = 0; k < 3; ++k) {
                const double g = grid[k][lane], top = kBrickCells * field.bricks[k];
                const double inGrid = g < 0.0 ? 0.0 : g > top ? top : g;
                outside2 += (g - inGrid) * (g - inGrid);
                const double d = cell[k][lane] + static_cast<double>(fraction[k][lane]) - 0.5 * kBrickCells;
                away2 += d * d;
            }
            if (outside2 > 0.0) {
                const float gap = static_cast<float>(field.voxelMm * __builtin_sqrt(outside2));
                far[lane] = gap > row.farOutMm ? gap : row.farOutMm;
            } else {
                const float centre = field.coarse[dense[lane]];
                const float bound = __builtin_fabsf(centre) - static_cast<float>(field.voxelMm * __builtin_sqrt(away2));
                far[lane] = centre < 0.0f ? -(bound > row.farInMm ? bound : row.farInMm)
                                          : (bound > row.farOutMm ? bound : row.farOutMm);
            }
        }
    }
};

constexpr int kY = kBrickNodes, kZ = kBrickNodes * kBrickNodes;

/// Values of the eight corners of each cell: two neighbours along x come in one load.
inline void load(const tooth::FieldView& field, const Places& places, Floats (&v)[8]) {
    static const float none[kZ + kY + 2] = {};
    const float* corner[8];
    for (int lane = 0; lane < 8; ++lane)
        corner[lane] = places.allStored || places.corner[lane] >= 0 ? field.values + places.corner[lane] : none;
    constexpr int kPair[4] = {0, kY, kZ, kZ + kY};
    for (int i = 0; i < 4; ++i) {
        Longs pair;
        for (int lane = 0; lane < 8; ++lane) {
            long long two;
            __builtin_memcpy(&two, corner[lane] + kPair[i], sizeof two);
            pair[lane] = two;
        }
        const Ints low = __builtin_convertvector(pair, Ints), high = __builtin_convertvector(pair >> 32, Ints);
        __builtin_memcpy(&v[2 * i], &low, sizeof low);
        __builtin_memcpy(&v[2 * i + 1], &high, sizeof high);
    }
}

inline Floats mix(Floats a, Floats b, Floats t) {
    return a + t * (b - a);
}

void distances(const tooth::FieldView& field, const FieldRow& row, int first, float* out) noexcept {
    const Places places(field, row, first);
    const Floats(&t)[3] = places.fraction;
    Floats v[8];
    load(field, places, v);
    const Floats low = mix(mix(v[0], v[1], t[0]), mix(v[2], v[3], t[0]), t[1]);
    const Floats high = mix(mix(v[4], v[5], t[0]), mix(v[6], v[7], t[0]), t[1]);
    const Floats d = mix(low, high, t[2]);
    for (int lane = 0; lane < 8; ++lane)
        out[lane] = places.corner[lane] >= 0 ? d[lane] : places.far[lane];
}

void gradients(const tooth::FieldView& field, const FieldRow& row, int first, FieldEight& out) noexcept {
    const Places places(field, row, first);
    const Floats(&t)[3] = places.fraction;
    Floats v[8];
    load(field, places, v);
    const Floats x00 = mix(v[0], v[1], t[0]), x10 = mix(v[2], v[3], t[0]);
    const Floats x01 = mix(v[4], v[5], t[0]), x11 = mix(v[6], v[7], t[0]);
    const Floats low = mix(x00, x10, t[1]), high = mix(x01, x11, t[1]);
    const Floats d = mix(low, high, t[2]);
    const Floats gx = mix(mix(v[1] - v[0], v[3] - v[2], t[1]), mix(v[5] - v[4], v[7] - v[6], t[1]), t[2]);
    const Floats gy = mix(x10 - x00, x11 - x01, t[2]);
    const Floats gz = high - low;
    for (int lane = 0; lane < 8; ++lane)
        out.distance[lane] = places.corner[lane] >= 0 ? d[lane] : places.far[lane];
    // The nearest node tells the tissue.
    const Ints nearest = (t[0] > 0.5f ? Ints{} + 1 : Ints{}) + (t[1] > 0.5f ? Ints{} + kY : Ints{}) +
                         (t[2] > 0.5f ? Ints{} + kZ : Ints{});
    for (int lane = 0; lane < 8; ++lane)
        out.tissue[lane] = places.allStored || places.corner[lane] >= 0
                               ? field.tissue[places.corner[lane] + nearest[lane]]
                               : kDeepTissue;
    __builtin_memcpy(out.x, &gx, sizeof gx);
    __builtin_memcpy(out.y, &gy, sizeof gy);
    __builtin_memcpy(out.z, &gz, sizeof gz);
}

}  // namespace

RingKernels ringKernels() noexcept {
    return {distances, gradients};
}

}  // namespace handpiece::contact::HANDPIECE_SIMD_NS
