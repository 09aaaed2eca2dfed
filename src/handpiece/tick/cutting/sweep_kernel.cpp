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
inline unsigned bitsOf(Ints mask) {
    return _mm512_movepi32_mask((__m512i)mask);
}
inline bool anyTrue(Ints mask) {
    return _mm512_test_epi32_mask((__m512i)mask, (__m512i)mask) != 0;
}
inline Floats least(Floats a, Floats b) {
    return (Floats)_mm512_maskz_min_ps(0xffff, (__m512)a, (__m512)b);
}
inline Floats most(Floats a, Floats b) {
    return (Floats)_mm512_maskz_max_ps(0xffff, (__m512)a, (__m512)b);
}
inline Floats root(Floats x) {
    return (Floats)_mm512_maskz_sqrt_ps(0xffff, (__m512)x);
}
#else
inline Floats least(Floats a, Floats b) {
    return a < b ? a : b;
}
inline Floats most(Floats a, Floats b) {
    return a > b ? a : b;
}
#if HANDPIECE_SIMD_LEVEL == 2
inline unsigned bitsOf(Ints mask) {
    return static_cast<unsigned>(_mm256_movemask_ps((__m256)mask));
}
inline bool anyTrue(Ints mask) {
    return _mm256_movemask_ps((__m256)mask) != 0;
}
inline Floats root(Floats x) {
    return (Floats)_mm256_sqrt_ps((__m256)x);
}
#elif defined(__SSE2__)
inline unsigned bitsOf(Ints mask) {
    return static_cast<unsigned>(_mm_movemask_ps((__m128)mask));
}
inline bool anyTrue(Ints mask) {
    return _mm_movemask_ps((__m128)mask) != 0;
}
inline Floats root(Floats x) {
    return (Floats)_mm_sqrt_ps((__m128)x);
}
#else
inline Floats root(Floats x) {
    for (int i = 0; i < kLanes; ++i)
        x[i] = __builtin_sqrtf(x[i]);
    return x;
}
inline unsigned bitsOf(Ints mask) {
    unsigned bits = 0;
    for (int i = 0; i < kLanes; ++i)
        bits |= (mask[i] ? 1u : 0u) << i;
    return bits;
}
inline bool anyTrue(Ints mask) {
    for (int i = 0; i < kLanes; ++i)
        if (mask[i]) return true;
    return false;
}
#endif
#endif

/// The nearest so far: squared distance, signed distance, and whether an end is what is nearest: then only the sign of
/// `value` counts.
struct Nearest {
    Floats squared, value;
    Ints isEnd;
    inline void take(Floats s, Floats v, Ints end) {
        const Ints nearer = s < squared;
        squared = nearer ? s : squared;
        value = nearer ? v : value;
        isEnd = nearer ? end : isEnd;
    }
    [[nodiscard]] inline Floats distance() const {
        if (!anyTrue(isEnd)) return value;  // the root of a number's square is the number, to the bit
        const Floats d = root(squared);
        return isEnd ? (value < Floats{} ? -d : d) : value;
    }
};

inline Nearest lineAt(const SweepPiece& piece, Floats rho, Floats z) {
    const Floats r = rho - piece.r0, h = z - piece.z0;
    const Floats along = r * piece.ur + h * piece.uz, off = r * piece.uz - h * piece.ur;
    const Floats past = along - least(most(along, Floats{}), splat(piece.length));
    Floats value = off;
    // The rule of an end counts only beyond it; smooth ends have none.
    if (piece.endSign[0] != 0.0f) value = past < Floats{} ? splat(piece.endSign[0]) : value;
    if (piece.endSign[1] != 0.0f) value = past > Floats{} ? splat(piece.endSign[1]) : value;
    return {off * off + past * past, value, past != Floats{}};
}

inline void measureArc(const SweepPiece& piece, Floats rho2, Floats rho, Floats z, Nearest& nearest) {
    const Floats r = rho - piece.r0, h = z - piece.z0;
    // Round the axis as SweepForm::ball has it, to the bit.
    const Floats away = root((piece.r0 == 0.0f ? rho2 : r * r) + h * h);
    const Floats off = (away - piece.radius) * piece.bulge;
    const Ints faces = (piece.chordR * h - piece.chordZ * r) * piece.radius + away * piece.chordOffset <= Floats{};
    nearest.take(faces ? off * off : splat(3e38f), off, Ints{});
    for (int e = 0; e < 2; ++e) {
        if ((piece.endsCount >> e & 1) == 0) continue;
        const Floats er = rho - piece.ends[e][0], ez = z - piece.ends[e][1];
        const Floats d = er * er + ez * ez;
        nearest.take(faces ? splat(3e38f) : d, piece.endSign[e] != 0.0f ? splat(piece.endSign[e]) : off, ~Ints{});
    }
}

/// Signed distances in kernel units. Holds what it needs by value: the values that are written could be anything else.
template <SweepForm form>
class Distances {
  public:
    Distances(const SweepPass& pass, const std::uint16_t* list, std::int32_t count)
        : pieces_(pass.pieces), list_(list), count_(count), first_(pass.pieces[list[0]]) {
        if constexpr (form == SweepForm::lines) second_ = pass.pieces[list[1]];
    }
    [[nodiscard]] inline Floats at(Ints x, Ints y, Ints z) const {
        const Floats fx = toFloats(x), fy = toFloats(y), rho2 = fx * fx + fy * fy;
        if constexpr (form == SweepForm::wall) {
            return root(rho2) - first_.r0;
        } else if constexpr (form == SweepForm::line) {
            return (root(rho2) - first_.r0) * first_.uz - (toFloats(z) - first_.z0) * first_.ur;
        } else if constexpr (form == SweepForm::ball) {
            const Floats h = toFloats(z) - first_.z0;
            return (root(rho2 + h * h) - first_.radius) * first_.bulge;
        } else if constexpr (form == SweepForm::capsule) {
            const Floats h = least(toFloats(z) - first_.z0, Floats{});
            return root(rho2 + h * h) - first_.radius;
        } else if constexpr (form == SweepForm::lines) {
            const Floats rho = root(rho2), height = toFloats(z);
            Nearest nearest = lineAt(first_, rho, height);
            const Nearest other = lineAt(second_, rho, height);
            nearest.take(other.squared, other.value, other.isEnd);
            return nearest.distance();
        } else {
            const Floats rho = root(rho2), height = toFloats(z);
            Nearest nearest{splat(3e38f), splat(3e38f), Ints{}};
            for (std::int32_t i = 0; i < count_; ++i) {
                const SweepPiece& piece = pieces_[list_[i]];
                if (piece.radius > 0.0f) {
                    measureArc(piece, rho2, rho, height, nearest);
                } else {
                    const Nearest line = lineAt(piece, rho, height);
                    nearest.take(line.squared, line.value, line.isEnd);
                }
            }
            return nearest.distance();
        }
    }

  private:
    const SweepPiece* pieces_;
    const std::uint16_t* list_;
    std::int32_t count_;
    SweepPiece first_, second_{};
};

/// Plus kSweepQuanta: of a sum that is so large the float itself is rounded to a whole number, ties to even.
inline Ints quantaOf(const SweepPass& pass, Floats value) {
    const Floats q = splat(pass.half) - value * pass.perMm;
    const Floats full = splat(static_cast<float>(kSweepQuanta));
    return toInts(least(most(q, Floats{}), full) + full);
}

inline std::int64_t sumOf(Ints x) {
    std::int64_t sum = 0;
    for (int i = 0; i < kLanes; ++i)
        sum += x[i];
    return sum;
}
inline float leastOf(Floats x) {
    using Four = float __attribute__((vector_size(16)));
    Four fours[kLanes / 4];
    __builtin_memcpy(fours, &x, sizeof x);
    for (int i = 1; i < kLanes / 4; ++i)
        fours[0] = fours[i] < fours[0] ? fours[i] : fours[0];
    const float a = fours[0][1] < fours[0][0] ? fours[0][1] : fours[0][0];
    const float b = fours[0][3] < fours[0][2] ? fours[0][3] : fours[0][2];
    return b < a ? b : a;
}

constexpr int kStep = 16, kParts = kStep / kLanes;
/// The last step reaches back: raising twice changes nothing.
inline int firstOf(int step) {
    return step + 1 < kSweepSteps ? step * kStep : kSweepNodes - kStep;
}

// Pass by pass over the steps, so that no branch depends on what a step finds: which steps can rise at all; rising;
// for how long the others can rest; counting where the surface passes.
template <SweepForm form>
SweepOutcome raiseAs(const SweepPass& pass, const SweepBrick& brick, float* values, std::int64_t* quanta) {
    const Ints x = splat(brick.base[0]), y = splat(brick.base[1]), z = splat(brick.base[2]);
    const Floats out = splat(pass.bandOutMm), toMm = splat(-pass.unitMm), shows = splat(pass.showsMm);
    const Distances<form> distances(pass, brick.list, brick.count);
    const std::int32_t *const offsetX = pass.offset[0], *const offsetY = pass.offset[1],
                              *const offsetZ = pass.offset[2];
    alignas(64) float was[kSweepSteps * kStep], spare[kSweepSteps * kLanes];
    std::uint64_t active = 0, risen = 0, counting = 0;
    for (int i = 0; i < kSweepDues; i += kLanes)
        active |= std::uint64_t{bitsOf(load(brick.due + i) <= splat(brick.way))} << i;
    for (std::uint64_t left = active; left != 0; left &= left - 1) {
        const int step = __builtin_ctzll(left), first = firstOf(step);
        Ints rises{}, counts{};
        Floats low = splat(3e38f);
        for (int part = 0; part < kParts; ++part) {
            const int at = first + part * kLanes;
            const Floats before = load(values + at);
            const Floats reached =
                distances.at(x + load(offsetX + at), y + load(offsetY + at), z + load(offsetZ + at)) * toMm;
            const Floats after = most(least(reached, out), before);
            store(values + at, after);
            store(was + step * kStep + part * kLanes, before);
            low = least(before < out ? before - reached : splat(3e38f), low);
            const Ints higher = before < after;
            rises |= higher;
            // Deep under the surface nothing is counted and nothing shows.
            counts |= higher & (before < shows) & (after > -shows);
        }
        store(spare + step * kLanes, low);
        risen |= std::uint64_t{anyTrue(rises)} << step;
        counting |= std::uint64_t{anyTrue(counts)} << step;
    }
    for (std::uint64_t left = active & ~risen; left != 0; left &= left - 1) {
        const int step = __builtin_ctzll(left);
        // A hair less, so that rounding makes no node wait that rises in a neighbour.
        const float room = leastOf(load(spare + step * kLanes)) * (1.0f / kSweepWayMm) - 2.0f;
        const float most = static_cast<float>(kSweepMostWay - brick.way);
        brick.due[step] = room < most ? brick.way + static_cast<std::int32_t>(room) : kSweepMostWay;
    }
    Ints taken{};
    for (std::uint64_t left = counting; left != 0; left &= left - 1) {
        const int step = __builtin_ctzll(left);
        for (int part = 0; part < kParts; ++part) {
            const int at = firstOf(step) + part * kLanes;
            Ints lost = quantaOf(pass, load(was + step * kStep + part * kLanes)) - quantaOf(pass, load(values + at));
            lost &= load(pass.owned + at);
            if (brick.tissue == nullptr) {
                taken += lost;
            } else {
                for (int lane = 0; lane < kLanes; ++lane)
                    quanta[brick.tissue[at + lane]] += lost[lane];
            }
        }
    }
    if (brick.tissue == nullptr) quanta[brick.uniform] += sumOf(taken);
    SweepOutcome outcome{risen != 0, counting != 0, kSweepMostWay};
    Ints earliest = load(brick.due);
    for (int i = kLanes; i < kSweepDues; i += kLanes) {
        const Ints due = load(brick.due + i);
        earliest = due < earliest ? due : earliest;
    }
    for (int lane = 0; lane < kLanes; ++lane)
        outcome.due = earliest[lane] < outcome.due ? earliest[lane] : outcome.due;
    return outcome;
}

/// Calls `with` for the form as a template's argument.
template <class With>
auto inForm(SweepForm form, With&& with) {
    switch (form) {
        case SweepForm::wall:
            return with.template operator()<SweepForm::wall>();
        case SweepForm::line:
            return with.template operator()<SweepForm::line>();
        case SweepForm::ball:
            return with.template operator()<SweepForm::ball>();
        case SweepForm::capsule:
            return with.template operator()<SweepForm::capsule>();
        case SweepForm::lines:
            return with.template operator()<SweepForm::lines>();
        case SweepForm::general:
            break;
    }
    return with.template operator()<SweepForm::general>();
}

SweepOutcome raise(const SweepPass& pass, const SweepBrick& brick, float* values, std::int64_t* quanta) {
    return inForm(brick.form, [&]<SweepForm form>() { return raiseAs<form>(pass, brick, values, quanta); });
}

template <SweepForm form>
float highestAs(const SweepPass& pass, const SweepBrick& brick) {
    const Ints x = splat(brick.base[0]), y = splat(brick.base[1]), z = splat(brick.base[2]);
    const Distances<form> distances(pass, brick.list, brick.count);
    Floats low = splat(3e38f);
    for (int step = 0; step < kSweepSteps; ++step)
        for (int part = 0; part < kParts; ++part) {
            const int at = firstOf(step) + part * kLanes;
            low = least(distances.at(x + load(pass.offset[0] + at), y + load(pass.offset[1] + at),
                                     z + load(pass.offset[2] + at)),
                        low);
        }
    return -pass.unitMm * leastOf(low);
}

float highest(const SweepPass& pass, const SweepBrick& brick) {
    return inForm(brick.form, [&]<SweepForm form>() { return highestAs<form>(pass, brick); });
}

void makeOffsets(const std::int32_t (&axes)[3][3], std::int32_t* const (&offset)[3]) {
    // Rows of nine are written as whole vectors; what is too much the next row overwrites.
    constexpr int kRowParts = (field::kBrickNodes + kLanes - 1) / kLanes;
    for (int k = 0; k < 3; ++k) {
        alignas(64) std::int32_t along[kRowParts * kLanes];
        for (int x = 0; x < kRowParts * kLanes; ++x)
            along[x] = x * axes[0][k];
        std::int32_t* out = offset[k];
        for (int z = 0; z < field::kBrickNodes; ++z)
            for (int y = 0; y < field::kBrickNodes; ++y, out += field::kBrickNodes) {
                const Ints start = splat(y * axes[1][k] + z * axes[2][k]);
                for (int part = 0; part < kRowParts; ++part) {
                    const Ints places = load(along + part * kLanes) + start;
                    __builtin_memcpy(out + part * kLanes, &places, sizeof places);
                }
            }
    }
}

void raiseRow(const SweepPass& pass, const SweepRow& row, const std::uint16_t* list, std::int32_t listCount,
              const std::int32_t* brickIndex, float* coarse) {
    const Distances<SweepForm::general> distances(pass, list, listCount);
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
        const Floats reached = distances.at(place[0], place[1], place[2]) * (-pass.unitMm);
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
