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
using Ints = std::int32_t __attribute__((vector_size(4 * kLanes)));
constexpr int kParts = kSharpStride / kLanes;
using Four = float __attribute__((vector_size(16)));

template <class T>
inline T load(const float* from) {
    T v;
    __builtin_memcpy(&v, from, sizeof v);
    return v;
}
template <class T>
inline void store(float* to, const T& v) {
    __builtin_memcpy(to, &v, sizeof v);
}
template <class T>
inline T least(T a, T b) {
    return a < b ? a : b;
}
template <class T>
inline T most(T a, T b) {
    return a > b ? a : b;
}
template <class T>
inline T sizeOf(T x) {
    return most(x, -x);
}

/// A line of six nodes between its third and fourth: v2 + t first + tt second + ttt third, where tt = t (t - 1) / 2 and
/// ttt = (t + 1) tt / 3. Where `meets`, two parabolas: that one, and otherStart + t otherFirst + tt otherSecond.
template <class T>
struct Line {
    T first, second, third, otherStart, otherFirst, otherSecond, sign;

    Line(const T (&v)[kSharpNodes], float kink, float bend) {
        const T e0 = v[1] - v[0], e1 = v[2] - v[1], e2 = v[3] - v[2], e3 = v[4] - v[3], e4 = v[5] - v[4];
        const T d1 = e1 - e0, d2 = e2 - e1, d3 = e3 - e2, d4 = e4 - e3;
        const T third0 = d2 - d1, third1 = d3 - d2, third2 = d4 - d3;
        const T size0 = sizeOf(third0), size2 = sizeOf(third2);
        // The cubic in the middle, or away from an edge beside the cell.
        const auto isRight = sizeOf(d3) < sizeOf(d2);
        const T beside = isRight ? third2 : third0;
        const auto isMiddle = sizeOf(third1) <= 2.0f * (isRight ? size2 : size0) + kink;
        third = isMiddle ? third1 : beside;
        second = isMiddle ? d2 : isRight ? d3 - third2 : d2;
        first = e2;
        // An edge in the cell pulls the third differences on both sides apart and leaves the outer second ones alike.
        const T apart = least(size0, size2);
        const auto alike = (third0 * third2 < T{}) & (apart > kink) & (sizeOf(d4 - d1) < 2.0f * apart + kink);
        // With another edge on one side they are not alike: then the other side tells, if no wall bends so much.
        const T outer = least(sizeOf(d1), sizeOf(d4)), inner = least(sizeOf(d2), sizeOf(d3));
        const auto strong = (inner > kink) & (sizeOf(d2 + d3) > 4.0f * outer + 2.2f * bend);
        const auto meets = (d2 * d3 > T{}) & (alike | strong);
        // What bends more is no wall: a third one begins within the six nodes.
        const T bend1 = sizeOf(d1) <= bend ? d1 : T{}, bend4 = sizeOf(d4) <= bend ? d4 : T{};
        third = meets ? T{} : third;
        second = meets ? bend1 : second;
        first = meets ? e1 + bend1 : first;
        otherStart = v[3] - e3 + bend4;
        otherFirst = e3 - bend4;
        otherSecond = bend4;
        const T rise = strong ? d2 : d2 + d3 - d1 - d4;
        sign = meets ? (rise > T{} ? T{} + 1.0f : T{} - 1.0f) : T{};
    }
    [[nodiscard]] T at(T start, T t, T tt, T ttt) const {
        return meeting(start + t * first + tt * second + ttt * third, otherStart + t * otherFirst + tt * otherSecond,
                       sign);
    }
    static T meeting(T value, T other, T sign) { return value + sign * most(sign * (other - value), T{}); }
};

void locate(const FieldView& field, SharpPlaces& places) noexcept {
    for (int i = 0; i < kSharpPlaces; ++i)
        places.isInGrid[i] = 1;
    for (int k = 0; k < 3; ++k) {
        const std::int32_t last = kBrickCells * field.bricks[k] - 1;
        const double end = last + 1, origin = field.originMm[k], inverse = field.inverseVoxelMm;
        for (int i = 0; i < kSharpPlaces; ++i) {
            const double g = (places.mm[k][i] - origin) * inverse;
            const std::int32_t isIn = g >= 0.0 ? (g <= end ? 1 : 0) : 0;
            const double near = isIn != 0 ? g : 0.0;
            const auto whole = static_cast<std::int32_t>(near);
            const std::int32_t cell = whole < last ? whole : last;
            places.isInGrid[i] &= isIn;
            places.cell[k][i] = cell;
            places.t[k][i] = static_cast<float>(near - cell);
        }
    }
}

/// Of the four nodes -1, 0, 1, 2 at t: the cubic through them.
template <class T>
inline void cubicWeights(T t, T (&w)[4]) {
    const T before = t * (t - 1.0f), after = (t + 1.0f) * (t - 2.0f);
    w[0] = (-1.0f / 6.0f) * before * (t - 2.0f);
    w[1] = 0.5f * after * (t - 1.0f);
    w[2] = -0.5f * after * t;
    w[3] = (1.0f / 6.0f) * before * (t + 1.0f);
}
template <class T>
inline T weighed(const T (&v)[4], const float (&w)[4]) {
    return (w[0] * v[0] + w[1] * v[1]) + (w[2] * v[2] + w[3] * v[3]);
}

/// The rows of nodes along x at the t along z and y of a place in a smooth block: the four in the middle.
inline void smoothRow(const SharpBlock& block, const float (&z)[4], const float (&y)[4], float* row) {
    Four rows[4];
    for (int j = 0; j < 4; ++j) {
        Four v[4];
        for (int i = 0; i < 4; ++i)
            v[i] = load<Four>(block.values[i + 1][j + 1] + 1);
        rows[j] = weighed(v, z);
    }
    store(row + 1, weighed(rows, y));
}
/// The same, all six, beside an edge. Both: t, tt, ttt.
inline void sharpRow(const SharpBlock& block, const float (&z)[3], const float (&y)[3], float* row) {
    for (int part = 0; part < kParts; ++part) {
        Floats rows[kSharpNodes];
        for (int j = 0; j < kSharpNodes; ++j) {
            const SharpBlock::Lines& lines = block.lines[j];
            const int from = part * kLanes;
            rows[j] = load<Floats>(block.values[2][j] + from) + z[0] * load<Floats>(lines.first + from) +
                      z[1] * load<Floats>(lines.second + from) + z[2] * load<Floats>(lines.third + from);
            if (block.meets[j])
                rows[j] = Line<Floats>::meeting(rows[j],
                                                load<Floats>(lines.otherStart + from) +
                                                    z[0] * load<Floats>(lines.otherFirst + from) +
                                                    z[1] * load<Floats>(lines.otherSecond + from),
                                                load<Floats>(lines.sign + from));
        }
        const Line<Floats> line(rows, block.kinkMm, block.bendMm);
        store(row + part * kLanes, line.at(rows[2], Floats{} + y[0], Floats{} + y[1], Floats{} + y[2]));
    }
}

inline Floats column(const float (&rows)[kSharpPlaces][kSharpStride], int first, int k) {
#if HANDPIECE_SIMD_LEVEL >= 2
    return Floats{rows[first][k],     rows[first + 1][k], rows[first + 2][k], rows[first + 3][k],
                  rows[first + 4][k], rows[first + 5][k], rows[first + 6][k], rows[first + 7][k]};
#else
    return Floats{rows[first][k], rows[first + 1][k], rows[first + 2][k], rows[first + 3][k]};
#endif
}

/// Along z and y place by place with the nodes along x in lanes, then along x with the places in lanes.
void at(const SharpPlaces& places, float (&out)[kSharpPlaces]) noexcept {
    float cubic[3][4][kSharpPlaces], newton[3][3][kSharpPlaces];
    for (int k = 0; k < 3; ++k)
        for (int first = 0; first < kSharpPlaces; first += kLanes) {
            const auto t = load<Floats>(places.t[k] + first);
            Floats w[4];
            cubicWeights(t, w);
            for (int i = 0; i < 4; ++i)
                store(cubic[k][i] + first, w[i]);
            const Floats tt = 0.5f * t * (t - 1.0f);
            store(newton[k][0] + first, t);
            store(newton[k][1] + first, tt);
            store(newton[k][2] + first, (1.0f / 3.0f) * (t + 1.0f) * tt);
        }
    alignas(32) float rows[kSharpPlaces][kSharpStride] = {};
    std::int32_t isSmooth[kSharpPlaces] = {};
    float kink = 0.0f, bend = 0.0f;
    bool anySharp = false;
    for (int i = 0; i < kSharpPlaces; ++i) {
        const SharpBlock* block = places.block[i];
        if (block == nullptr) continue;
        const auto of = [i](const auto& all, auto& own) {
            for (int j = 0; j < static_cast<int>(sizeof own / sizeof own[0]); ++j)
                own[j] = all[j][i];
        };
        if (block->isSmooth) {
            float z[4], y[4];
            of(cubic[2], z);
            of(cubic[1], y);
            smoothRow(*block, z, y, rows[i]);
            isSmooth[i] = -1;
        } else {
            float z[3], y[3];
            of(newton[2], z);
            of(newton[1], y);
            sharpRow(*block, z, y, rows[i]);
            anySharp = true;
            kink = block->kinkMm;
            bend = block->bendMm;
        }
    }
    for (int first = 0; first < kSharpPlaces; first += kLanes) {
        Floats v[kSharpNodes];
        for (int k = 0; k < kSharpNodes; ++k)
            v[k] = column(rows, first, k);
        const auto w = [&](int i) { return load<Floats>(cubic[0][i] + first); };
        Floats d = (w(0) * v[1] + w(1) * v[2]) + (w(2) * v[3] + w(3) * v[4]);
        if (anySharp) {
            const auto of = [&](int i) { return load<Floats>(newton[0][i] + first); };
            Ints smooth;
            __builtin_memcpy(&smooth, isSmooth + first, sizeof smooth);
            d = smooth ? d : Line<Floats>(v, kink, bend).at(v[2], of(0), of(1), of(2));
        }
        store(out + first, d);
    }
}

/// Weights of the four nodes, and of the slope and the bend there.
struct JetWeights {
    Four value, slope, bend;
    explicit JetWeights(float t)
        : value((Four{0.0f, 6.0f, 0.0f, 0.0f} +
                 t * (Four{-2.0f, -3.0f, 6.0f, -1.0f} +
                      t * (Four{3.0f, -6.0f, 3.0f, 0.0f} + t * Four{-1.0f, 3.0f, -3.0f, 1.0f}))) *
                (1.0f / 6.0f)),
          slope((Four{-2.0f, -3.0f, 6.0f, -1.0f} +
                 t * (Four{6.0f, -12.0f, 6.0f, 0.0f} + t * Four{-3.0f, 9.0f, -9.0f, 3.0f})) *
                (1.0f / 6.0f)),
          bend(Four{1.0f, -2.0f, 1.0f, 0.0f} + t * Four{-1.0f, 3.0f, -3.0f, 1.0f}) {}
};
inline Four weighed(const Four (&v)[4], Four w) {
    return (w[0] * v[0] + w[1] * v[1]) + (w[2] * v[2] + w[3] * v[3]);
}
inline float across(Four v, Four w) {
    const Four p = v * w;
    return (p[0] + p[1]) + (p[2] + p[3]);
}

void jet(const SharpBlock& block, const float (&t)[3], SharpJet& out) noexcept {
    const JetWeights x(t[0]), y(t[1]), z(t[2]);
    Four value[4], slope[4], bend[4];
    for (int j = 0; j < 4; ++j) {
        Four v[4];
        for (int i = 0; i < 4; ++i)
            v[i] = load<Four>(block.values[i + 1][j + 1] + 1);
        value[j] = weighed(v, z.value);
        slope[j] = weighed(v, z.slope);
        bend[j] = weighed(v, z.bend);
    }
    const Four row = weighed(value, y.value), rowY = weighed(value, y.slope), rowZ = weighed(slope, y.value);
    out.value = across(row, x.value);
    out.slope[0] = across(row, x.slope);
    out.slope[1] = across(rowY, x.value);
    out.slope[2] = across(rowZ, x.value);
    out.xx = across(row, x.bend);
    out.yy = across(weighed(value, y.bend), x.value);
    out.zz = across(weighed(bend, y.value), x.value);
    out.yz = across(weighed(slope, y.slope), x.value);
    out.xz = across(rowZ, x.slope);
    out.xy = across(rowY, x.slope);
}

template <class T>
inline bool any(T mask) {
    long long parts[sizeof mask / sizeof(long long)], all = 0;
    __builtin_memcpy(parts, &mask, sizeof mask);
    for (const long long part : parts)
        all |= part;
    return all != 0;
}
template <class T>
inline T difference(T v0, T v1, T v2, T v3, T v4) {
    return sizeOf((v0 + v4) + 6.0f * v2 - 4.0f * (v1 + v3));
}

/// Whether fourth differences along the lines through the block's middle tell of no edge: where the field is smooth
/// they are some nanometres, and a cubic across an edge is off by at most 0.4 of them. Values of `endMm` and more only
/// say "at least": no cubic goes through those, and a difference that does tells nothing.
bool isSmooth(const SharpBlock& block, float endMm) noexcept {
    // Of a row along x the four in the middle count, of differences along it the first two.
    constexpr std::int32_t kMiddle[kSharpStride] = {0, -1, -1, -1, -1, 0, 0, 0};
    const float kink = block.kinkMm;
    for (int a = 1; a < kSharpNodes - 1; ++a) {
        for (int part = 0; part < kParts; ++part) {
            Ints middle;
            __builtin_memcpy(&middle, kMiddle + part * kLanes, sizeof middle);
            const auto hasEdge = [&](const Floats(&v)[kSharpNodes]) {
                const Floats before = difference(v[0], v[1], v[2], v[3], v[4]),
                             after = difference(v[1], v[2], v[3], v[4], v[5]);
                const Floats high = most(most(v[1], v[2]), most(v[3], v[4]));
                return any((((before > kink) & (v[0] < endMm)) | ((after > kink) & (v[5] < endMm)) | (high >= endMm)) &
                           middle);
            };
            Floats z[kSharpNodes], y[kSharpNodes];
            for (int i = 0; i < kSharpNodes; ++i) {
                z[i] = load<Floats>(block.values[i][a] + part * kLanes);
                y[i] = load<Floats>(block.values[a][i] + part * kLanes);
            }
            if (hasEdge(z) || hasEdge(y)) return false;
        }
        for (int b = 1; b < kSharpNodes - 1; ++b) {
            const float* row = block.values[a][b];
            const Four v0 = load<Four>(row), v4 = load<Four>(row + 4);
            const Four end{v0[0], v4[1], endMm, endMm};
            const Four d = difference(v0, load<Four>(row + 1), load<Four>(row + 2), load<Four>(row + 3), v4);
            if (any((d > kink) & (end < endMm))) return false;
        }
    }
    return true;
}

void findLines(SharpBlock& block) noexcept {
    for (int j = 0; j < kSharpNodes; ++j) {
        SharpBlock::Lines& lines = block.lines[j];
        block.meets[j] = false;
        for (int part = 0; part < kParts; ++part) {
            const int from = part * kLanes;
            Floats v[kSharpNodes];
            for (int i = 0; i < kSharpNodes; ++i)
                v[i] = load<Floats>(block.values[i][j] + from);
            const Line<Floats> line(v, block.kinkMm, block.bendMm);
            store(lines.first + from, line.first);
            store(lines.second + from, line.second);
            store(lines.third + from, line.third);
            store(lines.otherStart + from, line.otherStart);
            store(lines.otherFirst + from, line.otherFirst);
            store(lines.otherSecond + from, line.otherSecond);
            store(lines.sign + from, line.sign);
            block.meets[j] = block.meets[j] || any(line.sign != Floats{});
        }
    }
}

/// Of a wall whose bend is followed up to an edge.
constexpr double kLeastRadiusMm = 0.2;

inline float kinkOf(const FieldView& field) {
    return static_cast<float>(4e-3 * field.voxelMm);
}
inline float bendOf(const FieldView& field) {
    return static_cast<float>(field.voxelMm * field.voxelMm / kLeastRadiusMm);
}

using Values = float[kSharpNodes][kSharpNodes][kSharpStride];

void gatherValues(const FieldView& field, const std::int32_t (&cell)[3], float farOutMm, float farInMm,
                  Values& block) noexcept {
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
    // Eight nodes of a row in each of the two bricks, and which of the sixteen are asked.
    using Eight = float __attribute__((vector_size(4 * kSharpStride)));
    using Lanes = std::int32_t __attribute__((vector_size(4 * kSharpStride)));
    const std::int32_t begin = local[0][0] == 0 ? 0 : 1;
    Lanes which{}, isNode{};
    for (int x = 0; x < kSharpNodes; ++x) {
        which[x] = x >= split[0] ? kSharpStride + local[0][x] - 1 : local[0][x] - begin;
        isNode[x] = -1;
    }
    for (int z = 0; z < kSharpNodes; ++z)
        for (int y = 0; y < kSharpNodes; ++y) {
            const int inZ = z >= split[2] ? 1 : 0, inY = y >= split[1] ? 1 : 0;
            const int row = kBrickNodes * (local[1][y] + kBrickNodes * local[2][z]);
            const float *first = values[inZ][inY][0], *second = values[inZ][inY][1];
            const Eight a = first != nullptr ? load<Eight>(first + row + begin) : Eight{} + far[inZ][inY][0];
            const Eight b = second != nullptr ? load<Eight>(second + row + 1) : Eight{} + far[inZ][inY][1];
#if defined(__clang__)  // of the fuzzers; it has no shuffle by a variable
            Eight nodes{};
            for (int x = 0; x < kSharpStride; ++x)
                nodes[x] = which[x] < kSharpStride ? a[which[x]] : b[which[x] - kSharpStride];
#else
            const Eight nodes = __builtin_shuffle(a, b, which);
#endif
            store(block[z][y], isNode ? nodes : Eight{});
        }
}

void gather(const FieldView& field, const std::int32_t (&cell)[3], float farOutMm, float farInMm,
            SharpBlock& block) noexcept {
    gatherValues(field, cell, farOutMm, farInMm, block.values);
    block.kinkMm = kinkOf(field);
    block.bendMm = bendOf(field);
    block.isSmooth = isSmooth(block, 0.999f * farOutMm);
    if (!block.isSmooth) findLines(block);
}

float once(const FieldView& field, const std::int32_t (&cell)[3], const float (&t)[3], float farOutMm,
           float farInMm) noexcept {
    alignas(32) Values values;
    gatherValues(field, cell, farOutMm, farInMm, values);
    const float kink = kinkOf(field), bend = bendOf(field);
    float tt[3], ttt[3], row[kSharpStride];
    for (int k = 0; k < 3; ++k) {
        tt[k] = 0.5f * t[k] * (t[k] - 1.0f);
        ttt[k] = (1.0f / 3.0f) * (t[k] + 1.0f) * tt[k];
    }
    const auto alongAxis = [&]<class T>(const T(&v)[kSharpNodes], int k) {
        return Line<T>(v, kink, bend).at(v[2], T{} + t[k], T{} + tt[k], T{} + ttt[k]);
    };
    for (int part = 0; part < kParts; ++part) {
        Floats rows[kSharpNodes];
        for (int y = 0; y < kSharpNodes; ++y) {
            Floats v[kSharpNodes];
            for (int z = 0; z < kSharpNodes; ++z)
                v[z] = load<Floats>(values[z][y] + part * kLanes);
            rows[y] = alongAxis(v, 2);
        }
        store(row + part * kLanes, alongAxis(rows, 1));
    }
    float v[kSharpNodes];
    __builtin_memcpy(v, row, sizeof v);
    return alongAxis(v, 0);
}

}  // namespace

SharpKernels sharpKernels() noexcept {
    return {locate, gather, at, once, jet};
}

}  // namespace handpiece::field::HANDPIECE_SIMD_NS
