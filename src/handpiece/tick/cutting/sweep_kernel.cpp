// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/cutting/sweep_kernel.h"

#if HANDPIECE_SIMD_LEVEL > 0 || defined(__SSE2__)
#include <immintrin.h>
#endif

namespace handpiece::cutting::HANDPIECE_SIMD_NS {
namespace {

#if HANDPIECE_SIMD_LEVEL >= 3
constexpr int kLanes = 16;
#elif HANDPIECE_SIMD_LEVEL == 2
constexpr int kLanes = 8;
#else
constexpr int kLanes = 4;
#endif
using Floats = float __attribute__((vector_size(4 * kLanes)));
using Ints = std::int32_t __attribute__((vector_size(4 * kLanes)));

inline Floats splat(float x) {
    return Floats{} + x;
}
inline Ints splat(std::int32_t x) {
    return Ints{} + x;
}
inline Floats load(const float* p) {
    Floats v;
    __builtin_memcpy(&v, p, sizeof v);
    return v;
}
inline Ints load(const std::int32_t* p) {
    Ints v;
    __builtin_memcpy(&v, p, sizeof v);
    return v;
}
inline void store(float* p, Floats v) {
    __builtin_memcpy(p, &v, sizeof v);
}
inline Floats toFloats(Ints x) {
    return __builtin_convertvector(x, Floats);
}
inline Ints toInts(Floats x) {
    return __builtin_convertvector(x, Ints);
}
// Of two equal values (0 and -0 too) every level gives the second, as the instructions do.
#if HANDPIECE_SIMD_LEVEL >= 3
inline Floats least(Floats a, Floats b) {
    return (Floats)_mm512_maskz_min_ps(0xffff, (__m512)a, (__m512)b);
}
inline Floats most(Floats a, Floats b) {
    return (Floats)_mm512_maskz_max_ps(0xffff, (__m512)a, (__m512)b);
}
inline Floats root(Floats x) {
    return (Floats)_mm512_maskz_sqrt_ps(0xffff, (__m512)x);
}
inline bool anyLess(Floats a, Floats b) {
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ) != 0;
}
#else
inline Floats least(Floats a, Floats b) {
    return a < b ? a : b;
}
inline Floats most(Floats a, Floats b) {
    return a > b ? a : b;
}
#if HANDPIECE_SIMD_LEVEL == 2
inline Floats root(Floats x) {
    return (Floats)_mm256_sqrt_ps((__m256)x);
}
inline bool anyLess(Floats a, Floats b) {
    return _mm256_movemask_ps((__m256)(a < b)) != 0;
}
#elif defined(__SSE2__)
inline Floats root(Floats x) {
    return (Floats)_mm_sqrt_ps((__m128)x);
}
inline bool anyLess(Floats a, Floats b) {
    return _mm_movemask_ps((__m128)(a < b)) != 0;
}
#else
inline Floats root(Floats x) {
    for (int i = 0; i < kLanes; ++i)
        x[i] = __builtin_sqrtf(x[i]);
    return x;
}
inline bool anyLess(Floats a, Floats b) {
    const Ints mask = a < b;
    for (int i = 0; i < kLanes; ++i)
        if (mask[i]) return true;
    return false;
}
#endif
#endif

/// Squared distance from the axis, and the height.
struct Places {
    Floats rho2, z;
};

inline Places placesOf(Ints x, Ints y, Ints z) {
    const Floats fx = toFloats(x), fy = toFloats(y);
    return {fx * fx + fy * fy, toFloats(z)};
}

inline Floats beyond(const SweepPiece& piece, Floats before, Floats after, Floats own) {
    // The rule of an end counts only beyond it; most ends have none.
    if (piece.endSign[0] != 0.0f) own = before < Floats{} ? splat(piece.endSign[0]) : own;
    if (piece.endSign[1] != 0.0f) own = after > Floats{} ? splat(piece.endSign[1]) : own;
    return own;
}

/// The nearest so far: squared distance, and a number whose sign tells the side.
struct Nearest {
    Floats squared, side;
    inline void take(Floats s, Floats sign) {
        const Ints nearer = s < squared;
        squared = nearer ? s : squared;
        side = nearer ? sign : side;
    }
};

inline void measureLine(const SweepPiece& piece, Floats rho, Floats z, Nearest& nearest) {
    const Floats r = rho - piece.r0, h = z - piece.z0;
    const Floats along = r * piece.ur + h * piece.uz, off = r * piece.uz - h * piece.ur;
    const Floats past = along - least(most(along, Floats{}), splat(piece.length));
    nearest.take(off * off + past * past, beyond(piece, past, past, off));
}

inline void measureArc(const SweepPiece& piece, Floats rho2, Floats rho, Floats z, Nearest& nearest) {
    const Floats r = rho - piece.r0, h = z - piece.z0;
    // Round the axis as SweepForm::ball has it, to the bit.
    const Floats away = root((piece.r0 == 0.0f ? rho2 : r * r) + h * h);
    const Floats off = (away - piece.radius) * piece.bulge;
    const Ints faces = (piece.chordR * h - piece.chordZ * r) * piece.radius + away * piece.chordOffset <= Floats{};
    nearest.take(faces ? off * off : splat(3e38f), off);
    for (int e = 0; e < 2; ++e) {
        if ((piece.endsCount >> e & 1) == 0) continue;
        const Floats er = rho - piece.ends[e][0], ez = z - piece.ends[e][1];
        const Floats d = er * er + ez * ez;
        nearest.take(faces ? splat(3e38f) : d, piece.endSign[e] != 0.0f ? splat(piece.endSign[e]) : off);
    }
}

/// Signed distances in kernel units.
template <SweepForm form>
inline Floats distances(const SweepPass& pass, const std::uint16_t* list, std::int32_t count, Places at) {
    if constexpr (form == SweepForm::line) {
        const SweepPiece& piece = pass.pieces[list[0]];
        return (root(at.rho2) - piece.r0) * piece.uz - (at.z - piece.z0) * piece.ur;
    } else if constexpr (form == SweepForm::ball) {
        const SweepPiece& piece = pass.pieces[list[0]];
        const Floats h = at.z - piece.z0;
        return (root(at.rho2 + h * h) - piece.radius) * piece.bulge;
    } else {
        const Floats rho = root(at.rho2);
        Nearest nearest{splat(3e38f), Floats{} + 1.0f};
        for (std::int32_t i = 0; i < count; ++i) {
            const SweepPiece& piece = pass.pieces[list[i]];
            if (piece.radius > 0.0f)
                measureArc(piece, at.rho2, rho, at.z, nearest);
            else
                measureLine(piece, rho, at.z, nearest);
        }
        const Floats d = root(nearest.squared);
        return nearest.side < Floats{} ? -d : d;
    }
}

inline Ints quantaOf(const SweepPass& pass, Floats value) {
    const Floats q = splat(pass.half) - value * pass.perMm;
    return toInts(least(most(q, Floats{}), splat(static_cast<float>(kSweepQuanta))) + 0.5f);
}

inline std::int64_t sumOf(Ints x) {
    std::int64_t sum = 0;
    for (int i = 0; i < kLanes; ++i)
        sum += x[i];
    return sum;
}
inline float leastOf(Floats x) {
    float low = x[0];
    for (int i = 1; i < kLanes; ++i)
        low = x[i] < low ? x[i] : low;
    return low;
}

template <SweepForm form>
SweepOutcome raiseAs(const SweepPass& pass, const SweepBrick& brick, float* values, std::int64_t* quanta) {
    const Ints x = splat(brick.base[0]), y = splat(brick.base[1]), z = splat(brick.base[2]);
    const Floats out = splat(pass.bandOutMm), toMm = splat(-pass.unitMm), shows = splat(pass.showsMm);
    Floats low = out;
    Ints taken{};
    SweepOutcome outcome{};
    for (int i = 0; i < kSweepNodes; i += kLanes) {
        // The last step reaches back: raising twice changes nothing.
        const int first = i + kLanes <= kSweepNodes ? i : kSweepNodes - kLanes;
        const Floats before = load(values + first);
        if (!anyLess(before, out)) continue;
        const Places at = placesOf(x + load(pass.offset[0] + first), y + load(pass.offset[1] + first),
                                   z + load(pass.offset[2] + first));
        const Floats reached = distances<form>(pass, brick.list, brick.count, at) * toMm;
        const Floats after = most(least(reached, out), before);
        low = least(after, low);
        if (!anyLess(before, after)) continue;
        store(values + first, after);
        outcome.rose = true;
        // Deep under the surface nothing is counted and nothing shows.
        if (!anyLess(-shows, after)) continue;
        const Ints risen = (before < after) & (before < shows) & (after > -shows);
        outcome.shows = outcome.shows || anyLess(toFloats(risen), Floats{});
        const Ints lost = (quantaOf(pass, before) - quantaOf(pass, after)) & load(pass.owned + first);
        if (brick.tissue == nullptr) {
            taken += lost;
        } else {
            for (int lane = 0; lane < kLanes; ++lane)
                quanta[brick.tissue[first + lane]] += lost[lane];
        }
    }
    if (brick.tissue == nullptr) quanta[brick.uniform] += sumOf(taken);
    outcome.least = leastOf(low);
    return outcome;
}

SweepOutcome raise(const SweepPass& pass, const SweepBrick& brick, float* values, std::int64_t* quanta) {
    switch (brick.form) {
        case SweepForm::line:
            return raiseAs<SweepForm::line>(pass, brick, values, quanta);
        case SweepForm::ball:
            return raiseAs<SweepForm::ball>(pass, brick, values, quanta);
        case SweepForm::general:
            break;
    }
    return raiseAs<SweepForm::general>(pass, brick, values, quanta);
}

float highest(const SweepPass& pass, const SweepBrick& brick) {
    const Ints x = splat(brick.base[0]), y = splat(brick.base[1]), z = splat(brick.base[2]);
    Floats low = splat(3e38f);
    for (int i = 0; i < kSweepNodes; i += kLanes) {
        const int first = i + kLanes <= kSweepNodes ? i : kSweepNodes - kLanes;
        const Places at = placesOf(x + load(pass.offset[0] + first), y + load(pass.offset[1] + first),
                                   z + load(pass.offset[2] + first));
        low = least(distances<SweepForm::general>(pass, brick.list, brick.count, at), low);
    }
    return -pass.unitMm * leastOf(low);
}

void makeOffsets(const std::int32_t (&axes)[3][3], std::int32_t* const (&offset)[3]) {
    for (int k = 0; k < 3; ++k) {
        std::int32_t* out = offset[k];
        for (int z = 0; z < tooth::kBrickNodes; ++z)
            for (int y = 0; y < tooth::kBrickNodes; ++y)
                for (int x = 0; x < tooth::kBrickNodes; ++x)
                    *out++ = x * axes[0][k] + y * axes[1][k] + z * axes[2][k];
    }
}

void raiseRow(const SweepPass& pass, const SweepRow& row, const std::uint16_t* list, std::int32_t listCount,
              const std::int32_t* brickIndex, float* coarse) {
    for (std::int32_t i = 0; i < row.count; i += kLanes) {
        const std::int32_t lanes = row.count - i < kLanes ? row.count - i : kLanes;
        Ints place[3]{};
        bool inside = false;
        for (std::int32_t lane = 0; lane < lanes; ++lane)
            inside = inside || (brickIndex[i + lane] < 0 && coarse[i + lane] < 0.0f);
        if (!inside) continue;
        for (int k = 0; k < 3; ++k)
            for (int lane = 0; lane < kLanes; ++lane)
                place[k][lane] = row.base[k] + (i + (lane < lanes ? lane : 0)) * row.step[k];
        const Floats reached =
            distances<SweepForm::general>(pass, list, listCount, placesOf(place[0], place[1], place[2])) *
            (-pass.unitMm);
        for (std::int32_t lane = 0; lane < lanes; ++lane)
            if (brickIndex[i + lane] < 0 && coarse[i + lane] < 0.0f && reached[lane] > coarse[i + lane] &&
                reached[lane] < 0.0f)
                coarse[i + lane] = reached[lane];
    }
}

}  // namespace

SweepKernels sweepKernels() noexcept {
    return {makeOffsets, raise, highest, raiseRow};
}

}  // namespace handpiece::cutting::HANDPIECE_SIMD_NS
