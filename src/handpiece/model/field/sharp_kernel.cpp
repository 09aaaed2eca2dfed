// SPDX-License-Identifier: Apache-2.0
// Compiled once per instruction set; see cmake/handpiece.cmake.
//
// Along a line six nodes v0 .. v5 lie about the cell v2 .. v3. Where the field is smooth a cubic through the four in
// the middle is right to the fourth order; beside an edge, the cubic on the side of the smaller second
// difference does not cross it (ENO, A. Harten and others, J. Comput. Phys. 71, 1987 [recalled]). When the edge lies in
// the cell itself no polynomial is right: then both sides are continued as parabolas up to where they meet (subcell
// resolution, A. Harten, J. Comput. Phys. 83, 1989 [recalled]). Line by line along z, then y, then x.
#include "handpiece/model/field/sharp_kernel.h"

namespace handpiece::field::HANDPIECE_SIMD_NS {
namespace {

#if HANDPIECE_SIMD_LEVEL >= 2
constexpr int kLanes = 8;
#else
constexpr int kLanes = 4;
#endif
using Floats = float __attribute__((vector_size(4 * kLanes)));
constexpr int kParts = kSharpStride / kLanes;

inline float least(float a, float b) {
    return a < b ? a : b;
}
inline float most(float a, float b) {
    return a > b ? a : b;
}
inline float sizeOf(float x) {
    return x < 0.0f ? -x : x;
}
inline Floats least(Floats a, Floats b) {
    return a < b ? a : b;
}
inline Floats most(Floats a, Floats b) {
    return a > b ? a : b;
}
inline Floats sizeOf(Floats x) {
    return most(x, -x);
}

/// What depends on the place alone.
struct Weights {
    float t, tt, ttt, after;   // of the differences, in Newton's form
    float before2, s, after2;  // of the parabolas
    explicit Weights(float at)
        : t(at),
          tt(0.5f * at * (at - 1.0f)),
          ttt((at + 1.0f) * at * (at - 1.0f) * (1.0f / 6.0f)),
          after(at * (at - 1.0f) * (at - 2.0f) * (1.0f / 6.0f)),
          before2(0.5f * at * (at + 1.0f)),
          s(1.0f - at),
          after2(0.5f * (1.0f - at) * (2.0f - at)) {}
};

/// For a float and for a vector of them.
template <class T>
inline T along(const T (&v)[kSharpNodes], const Weights& w, float kink, float bend) {
    const T e0 = v[1] - v[0], e1 = v[2] - v[1], e2 = v[3] - v[2], e3 = v[4] - v[3], e4 = v[5] - v[4];
    const T d1 = e1 - e0, d2 = e2 - e1, d3 = e3 - e2, d4 = e4 - e3;
    const T third0 = d2 - d1, third1 = d3 - d2, third2 = d4 - d3;
    const T size0 = sizeOf(third0), size1 = sizeOf(third1), size2 = sizeOf(third2);
    const T linear = v[2] + w.t * e2;
    const T middle = linear + w.tt * d2 + w.ttt * third1;
    const T left = linear + w.tt * d2 + w.ttt * third0;
    const T right = linear + w.tt * d3 + w.after * third2;
    // Away from an edge beside the cell.
    const T smooth = sizeOf(d3) < sizeOf(d2) ? (size1 <= 2.0f * size2 + kink ? middle : right)
                                             : (size1 <= 2.0f * size0 + kink ? middle : left);
    // No wall bends more than that: a third wall within the six nodes would lead far off.
    const T bend1 = least(most(d1, T{} - bend), T{} + bend), bend4 = least(most(d4, T{} - bend), T{} + bend);
    const T before = v[2] + w.t * e1 + w.before2 * bend1, after = v[3] - w.s * e3 + w.after2 * bend4;
    const T meets = d2 + d3 > d1 + d4 ? most(before, after) : least(before, after);
    // An edge in the cell pulls the third differences on both sides apart and leaves the outer second ones alike.
    const T apart = least(size0, size2);
    return third0 * third2 < T{} ? (apart > kink ? (sizeOf(d4 - d1) < 2.0f * apart + kink ? meets : smooth) : smooth)
                                 : smooth;
}

float at(const SharpBlock& block, const float (&t)[3]) noexcept {
    const Weights wx(t[0]), wy(t[1]), wz(t[2]);
    alignas(32) float row[kSharpStride];
    for (int part = 0; part < kParts; ++part) {
        Floats rows[kSharpNodes];
        for (int y = 0; y < kSharpNodes; ++y) {
            Floats v[kSharpNodes];
            for (int z = 0; z < kSharpNodes; ++z)
                __builtin_memcpy(&v[z], block.values[z][y] + part * kLanes, sizeof v[z]);
            rows[y] = along(v, wz, block.kinkMm, block.bendMm);
        }
        const Floats result = along(rows, wy, block.kinkMm, block.bendMm);
        __builtin_memcpy(row + part * kLanes, &result, sizeof result);
    }
    float v[kSharpNodes];
    __builtin_memcpy(v, row, sizeof v);
    return along(v, wx, block.kinkMm, block.bendMm);
}

/// Of a wall whose bend is followed up to an edge.
constexpr double kLeastRadiusMm = 0.2;

void gather(const FieldView& field, const std::int32_t (&cell)[3], float farOutMm, float farInMm,
            SharpBlock& block) noexcept {
    // Along each axis the nodes lie in one brick or two.
    std::int32_t brick[3][2], split[3], local[3][kSharpNodes];
    for (int k = 0; k < 3; ++k) {
        const std::int32_t last = kBrickCells * field.bricks[k];
        split[k] = kSharpNodes;
        for (int i = 0; i < kSharpNodes; ++i) {
            std::int32_t node = cell[k] - 2 + i;
            node = node < 0 ? 0 : node > last ? last : node;
            std::int32_t in = node / kBrickCells;
            if (in == field.bricks[k]) --in;
            if (i == 0) brick[k][0] = brick[k][1] = in;
            // The last node of a brick is the first of the next.
            if (in != brick[k][0] && node == kBrickCells * in) in = brick[k][0];
            if (in != brick[k][0] && split[k] == kSharpNodes) {
                split[k] = i;
                brick[k][1] = in;
            }
            local[k][i] = node - kBrickCells * in;
        }
    }
    const float* values[2][2][2];
    float far[2][2][2];
    for (int c = 0; c < 8; ++c) {
        const int x = c & 1, y = c >> 1 & 1, z = c >> 2;
        const std::int64_t dense =
            brick[0][x] + static_cast<std::int64_t>(field.bricks[0]) *
                              (brick[1][y] + static_cast<std::int64_t>(field.bricks[1]) * brick[2][z]);
        const std::int32_t stored = field.brickIndex[dense];
        values[z][y][x] = stored >= 0 ? field.values + static_cast<std::int64_t>(stored) * kBrickValues : nullptr;
        far[z][y][x] = field.coarse[dense] < 0.0f ? -farInMm : farOutMm;
    }
    block.kinkMm = static_cast<float>(4e-3 * field.voxelMm);
    block.bendMm = static_cast<float>(field.voxelMm * field.voxelMm / kLeastRadiusMm);
    const bool isPlain = split[0] == kSharpNodes && local[0][kSharpNodes - 1] - local[0][0] == kSharpNodes - 1;
    for (int z = 0; z < kSharpNodes; ++z)
        for (int y = 0; y < kSharpNodes; ++y) {
            const int inZ = z >= split[2] ? 1 : 0, inY = y >= split[1] ? 1 : 0;
            const int row = kBrickNodes * (local[1][y] + kBrickNodes * local[2][z]);
            float* out = block.values[z][y];
            const float* first = values[inZ][inY][0];
            if (isPlain && first != nullptr) {
                __builtin_memcpy(out, first + row + local[0][0], kSharpNodes * sizeof(float));
            } else {
                for (int x = 0; x < kSharpNodes; ++x) {
                    const int inX = x >= split[0] ? 1 : 0;
                    const float* from = values[inZ][inY][inX];
                    out[x] = from != nullptr ? from[row + local[0][x]] : far[inZ][inY][inX];
                }
            }
            out[kSharpNodes] = out[kSharpNodes + 1] = 0.0f;
        }
}

}  // namespace

SharpKernels sharpKernels() noexcept {
    return {gather, at};
}

}  // namespace handpiece::field::HANDPIECE_SIMD_NS
