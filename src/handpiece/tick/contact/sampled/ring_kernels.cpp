// SPDX-License-Identifier: Apache-2.0
// Compiled once per instruction set; see cmake/handpiece.cmake.
//
// The bur's rings in the field, eight points at a time: docs/contact.md, "Rings". A point of ring (rho, z) at angle a
// is p = tip + z axis + rho (cos a x + sin a y). Its distance is trilinear in its cell,
//     phi = mix(mix(mix(v000, v100, tx), mix(v010, v110, tx), ty), mix(..., ..., ty), tz), mix(a, b, t) = a + t (b -
//     a),
// and the gradient is the slope of the same polynomial: d phi/dx = the mix over ty, tz of the four differences along x.
// What need not be looked up is left out by the Lipschitz bound, ring by ring from the axis (phi of a point is at least
// phi of the ring's middle less rho) and eight by eight from the middle of each (less the chord).
#include "handpiece/tick/contact/sampled/ring_kernels.h"

#include "handpiece/tick/contact/lanes.h"

namespace handpiece::contact::HANDPIECE_SIMD_NS {
namespace {

using field::FieldView;
using field::kBrickCells;
using field::kBrickNodes;
using field::kBrickValues;
constexpr int kBrickShift = 3;
static_assert(kBrickCells == 1 << kBrickShift);
constexpr int kY = kBrickNodes, kZ = kBrickNodes * kBrickNodes;
constexpr double kFarGrid = 1e6;  // voxels: no place in a grid, and no trouble as an integer

/// A bur pose in voxels of the grid.
struct GridPose {
    double tip[3], x[3], y[3], z[3];
    double reach[3];  ///< of a unit circle around the axis

    GridPose(const FieldView& field, const RingQuery& query) {
        for (int k = 0; k < 3; ++k) {
            const double place = (query.tip[k] - field.originMm[k]) * field.inverseVoxelMm;
            tip[k] = place < -kFarGrid ? -kFarGrid : place > kFarGrid ? kFarGrid : place;
            x[k] = query.x[k] * field.inverseVoxelMm;
            y[k] = query.y[k] * field.inverseVoxelMm;
            z[k] = query.z[k] * field.inverseVoxelMm;
            reach[k] = __builtin_sqrt(x[k] * x[k] + y[k] * y[k]);
        }
    }
};

/// Points centre + a x + b y in voxels, with a whole cell taken off, so that floats hold the rest well.
struct Row {
    std::int32_t base[3], last[3];  ///< last: the grid's last cell
    float rest[3], x[3], y[3];
    bool isInGrid = true;  ///< all of its points

    /// `reach`: how far the points are from the centre at most, along each axis.
    Row(const FieldView& field, const double (&centre)[3], const double (&u)[3], const double (&v)[3], double scale,
        const double (&reach)[3], double reachScale) {
        for (int k = 0; k < 3; ++k) {
            const double far = reachScale * reach[k] + 1e-3;
            const double low = __builtin_floor(centre[k] - far);
            base[k] = static_cast<std::int32_t>(low);
            rest[k] = static_cast<float>(centre[k] - low);
            x[k] = static_cast<float>(scale * u[k]);
            y[k] = static_cast<float>(scale * v[k]);
            last[k] = kBrickCells * field.bricks[k] - 1;
            isInGrid = isInGrid && low >= 0.0 && centre[k] + far < static_cast<double>(last[k] + 1);
        }
    }
};

/// Eight places: where each one's cell begins in the values and where in the cell it lies.
struct Places {
    Ints cell[3], dense, stored, inBrick;
    Floats fraction[3];
    Ints outside;   ///< of the grid
    unsigned bare;  ///< bit i: no brick is stored there

    Places(const FieldView& field, const Row& row, Floats a, Floats b) {
        const Floats place[3] = {row.rest[0] + a * row.x[0] + b * row.y[0], row.rest[1] + a * row.x[1] + b * row.y[1],
                                 row.rest[2] + a * row.x[2] + b * row.y[2]};
        find(field, row, place);
    }
    /// And c along `third`, in voxels.
    Places(const FieldView& field, const Row& row, Floats a, Floats b, Floats c, const float (&third)[3]) {
        Floats place[3];
        for (int k = 0; k < 3; ++k)
            place[k] = row.rest[k] + a * row.x[k] + b * row.y[k] + c * third[k];
        find(field, row, place);
    }

    void find(const FieldView& field, const Row& row, const Floats (&places)[3]) {
        outside = Ints{};
        for (int k = 0; k < 3; ++k) {
            const Floats place = places[k];
            const Ints whole = __builtin_convertvector(place, Ints);
            fraction[k] = place - __builtin_convertvector(whole, Floats);
            cell[k] = whole + row.base[k];
        }
        Ints near[3] = {cell[0], cell[1], cell[2]};
        if (!row.isInGrid)
            for (int k = 0; k < 3; ++k) {
                outside |= (cell[k] < 0) | (cell[k] > row.last[k]);
                near[k] = near[k] < 0 ? Ints{} : near[k] > row.last[k] ? Ints{} + row.last[k] : near[k];
            }
        dense = (near[0] >> kBrickShift) +
                field.bricks[0] * ((near[1] >> kBrickShift) + field.bricks[1] * (near[2] >> kBrickShift));
        constexpr int kInBrick = kBrickCells - 1;
        inBrick = (near[0] & kInBrick) + kY * (near[1] & kInBrick) + kZ * (near[2] & kInBrick);
        stored = fetch(field.brickIndex, dense) | outside;  // a mask is -1, no brick
        bare = bitsOf(stored < 0);
    }

    static Ints fetch(const std::int32_t* from, Ints at) {
#if defined(__AVX2__)
        return (Ints)_mm256_i32gather_epi32(from, (__m256i)at, 4);
#else
        Ints v;
        for (int lane = 0; lane < 8; ++lane)
            v[lane] = from[at[lane]];
        return v;
#endif
    }

    /// What is known without a brick: the sign, and a bound of the distance. A brick keeps the distance at its centre,
    /// and a place in it is nearer to the surface by no more than its way from there: |phi| >= |centre| - |p - centre|.
    /// Outside of the grid the surface is at least as far as the grid.
    [[nodiscard]] Floats farMm(const FieldView& field, const Row& row, float farOutMm, float farInMm) const {
        Floats away2{}, gap2{}, centre;
        for (int k = 0; k < 3; ++k) {
            const Floats place = __builtin_convertvector(cell[k], Floats) + fraction[k];
            const Floats inGrid = leastF(mostF(place, Floats{}), splatF(static_cast<float>(row.last[k] + 1)));
            gap2 += (place - inGrid) * (place - inGrid);
            const Floats away = __builtin_convertvector(cell[k] & (kBrickCells - 1), Floats) + fraction[k] -
                                0.5f * static_cast<float>(kBrickCells);
            away2 += away * away;
        }
        for (int lane = 0; lane < 8; ++lane)
            centre[lane] = field.coarse[dense[lane]];
        const auto voxelMm = static_cast<float>(field.voxelMm);
        const Floats bound = absolute(centre) - voxelMm * rootF(away2);
        const Floats in = -mostF(bound, splatF(farInMm)), out = mostF(bound, splatF(farOutMm));
        const Floats apart = mostF(voxelMm * rootF(gap2), splatF(farOutMm));
        return outside ? apart : centre < 0.0f ? in : out;
    }
};

#if defined(__SSE2__)
/// Two floats from each of eight places: the first ones and the second ones.
inline void loadPairs(const float* const (&corner)[8], int offset, Floats& first, Floats& second) {
    // Pairs of floats begin anywhere: these two read them wherever they are.
    const auto two = [&](int lane, int other) {
        const __m128i low = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(corner[lane] + offset));
        return _mm_loadh_pi(_mm_castsi128_ps(low), reinterpret_cast<const __m64*>(corner[other] + offset));
    };
    const __m128 a = two(0, 1), b = two(2, 3), c = two(4, 5), d = two(6, 7);
#if defined(__AVX__)
    const __m256 ac = _mm256_insertf128_ps(_mm256_castps128_ps256(a), c, 1);
    const __m256 bd = _mm256_insertf128_ps(_mm256_castps128_ps256(b), d, 1);
    first = (Floats)_mm256_shuffle_ps(ac, bd, 0x88);
    second = (Floats)_mm256_shuffle_ps(ac, bd, 0xdd);
#else
    const __m128 parts[4] = {_mm_shuffle_ps(a, b, 0x88), _mm_shuffle_ps(c, d, 0x88), _mm_shuffle_ps(a, b, 0xdd),
                             _mm_shuffle_ps(c, d, 0xdd)};
    __builtin_memcpy(&first, parts, sizeof first);
    __builtin_memcpy(&second, parts + 2, sizeof second);
#endif
}
#else
inline void loadPairs(const float* const (&corner)[8], int offset, Floats& first, Floats& second) {
    for (int lane = 0; lane < 8; ++lane) {
        first[lane] = corner[lane][offset];
        second[lane] = corner[lane][offset + 1];
    }
}
#endif

/// Values of the eight corners of each cell; zeros where no brick is stored.
struct Corners {
    Floats v[8];

    Corners(const FieldView& field, const Places& places) {
        static const float none[kZ + kY + 2] = {};
        const float* corner[8];
        const Ints first = places.stored * kBrickValues + places.inBrick;
        std::int32_t at[8];
        __builtin_memcpy(at, &first, sizeof at);
        for (int lane = 0; lane < 8; ++lane)
            corner[lane] = field.values + at[lane];
        if (places.bare != 0)
            for (int lane = 0; lane < 8; ++lane)
                if ((places.bare >> lane & 1u) != 0) corner[lane] = none;
        loadPairs(corner, 0, v[0], v[1]);
        loadPairs(corner, kY, v[2], v[3]);
        loadPairs(corner, kZ, v[4], v[5]);
        loadPairs(corner, kZ + kY, v[6], v[7]);
    }
};

/// One linear step of the trilinear sum.
inline Floats mix(Floats a, Floats b, Floats t) {
    return a + t * (b - a);
}

inline Ints bareMask(const Places& places) {
    return places.stored < 0;
}

/// Signed distances of eight places.
inline Floats distancesAt(const FieldView& field, const Row& row, const Places& places, float farOutMm, float farInMm) {
    if (places.bare == 0xffu) return places.farMm(field, row, farOutMm, farInMm);
    const Floats(&t)[3] = places.fraction;
    const Corners corners(field, places);
    const Floats(&v)[8] = corners.v;
    const Floats low = mix(mix(v[0], v[1], t[0]), mix(v[2], v[3], t[0]), t[1]);
    const Floats high = mix(mix(v[4], v[5], t[0]), mix(v[6], v[7], t[0]), t[1]);
    const Floats d = mix(low, high, t[2]);
    if (places.bare == 0) return d;
    return bareMask(places) ? places.farMm(field, row, farOutMm, farInMm) : d;
}

/// Signed distances of eight points of a row.
inline Floats distances(const FieldView& field, const RingQuery& query, const Row& row, Floats a, Floats b) {
    return distancesAt(field, row, Places(field, row, a, b), query.farOutMm, query.farInMm);
}

inline float leastOf(Floats d) {
    float lanes[8], least;
    __builtin_memcpy(lanes, &d, sizeof d);
    least = lanes[0];
    for (int i = 1; i < 8; ++i)
        least = lanes[i] < least ? lanes[i] : least;
    return least;
}

inline Floats spreadOf(Floats a, Floats b, Floats c, Floats d) {
    return mostF(mostF(a, b), mostF(c, d)) - leastF(leastF(a, b), leastF(c, d));
}

/// A point farther off than that is not told, and not creased.
inline float mostMm(const RingQuery& query) {
    return query.thresholdMm > query.creaseMm ? query.thresholdMm : query.creaseMm;
}

/// Looks eight points of a ring up: distance, gradient and tissue of those that are live, which it returns as bits.
inline unsigned senseEight(const FieldView& field, const BurRings& bur, const RingQuery& query, const RingTouch& touch,
                           const BurRing& ring, const Row& row, int eight, Floats& least) {
    const int lanes = ring.count - 8 * eight;
    const unsigned real = lanes >= 8 ? 0xffu : (1u << lanes) - 1u;
    const std::int32_t at = ring.first + 8 * eight, angle = ring.angles + 8 * eight;
    const Places places(field, row, loadFloats(bur.cosines + angle), loadFloats(bur.sines + angle));
    const Floats(&t)[3] = places.fraction;
    const Corners corners(field, places);
    const Floats(&v)[8] = corners.v;
    const Floats x00 = mix(v[0], v[1], t[0]), x10 = mix(v[2], v[3], t[0]);
    const Floats x01 = mix(v[4], v[5], t[0]), x11 = mix(v[6], v[7], t[0]);
    const Floats low = mix(x00, x10, t[1]), high = mix(x01, x11, t[1]);
    Floats d = mix(low, high, t[2]);
    unsigned candidates = real, bareInside = 0;
    if (places.bare != 0) {
        const Floats far = places.farMm(field, row, query.farOutMm, query.farInMm);
        d = bareMask(places) ? far : d;
        // Outside nothing is told beyond the bricks but that it is far.
        bareInside = bitsOf(far < 0.0f) & places.bare;
        candidates &= ~places.bare | bareInside;
    }
    if (query.skipsDeep) {
        const unsigned deep = (bitsOf(d <= -query.deepMm) | bareInside) & candidates;
        if (deep != 0) *touch.skippedDeep = true;
        candidates &= ~deep;
    }
    unsigned live = bitsOf(d <= mostMm(query)) & candidates;
    if (live == 0) {
        const Floats none = splatF(kNotLiveMm);
        __builtin_memcpy(touch.distanceMm + at, &none, sizeof none);
        touch.live[ring.mask + eight] = touch.creased[ring.mask + eight] = 0;
        return 0;
    }
    const Ints lane = {1, 2, 4, 8, 16, 32, 64, 128};
    if (query.onlyDistances) {
        d = ((Ints{} + static_cast<std::int32_t>(live)) & lane) != 0 ? d : splatF(kNotLiveMm);
        __builtin_memcpy(touch.distanceMm + at, &d, sizeof d);
        touch.live[ring.mask + eight] = static_cast<std::uint8_t>(live);
        least = leastF(least, d);
        return live;
    }
    const Floats gx = mix(mix(v[1] - v[0], v[3] - v[2], t[1]), mix(v[5] - v[4], v[7] - v[6], t[1]), t[2]);
    const Floats gy = mix(x10 - x00, x11 - x01, t[2]);
    const Floats gz = high - low;
    const auto voxelMm = static_cast<float>(field.voxelMm);
    const float least2 = query.creaseSlope * query.creaseSlope * voxelMm * voxelMm;
    const Floats twist = mostF(mostF(spreadOf(v[1] - v[0], v[3] - v[2], v[5] - v[4], v[7] - v[6]),
                                     spreadOf(v[2] - v[0], v[3] - v[1], v[6] - v[4], v[7] - v[5])),
                               spreadOf(v[4] - v[0], v[5] - v[1], v[6] - v[2], v[7] - v[3]));
    const unsigned creased = bitsOf(((gx * gx + gy * gy + gz * gz < least2) | (twist > query.creaseTwist * voxelMm)) &
                                    (d < query.creaseMm) & (d > -query.creaseInMm)) &
                             live & ~places.bare;
    live &= bitsOf(d <= query.thresholdMm) | creased;
    touch.live[ring.mask + eight] = static_cast<std::uint8_t>(live);
    touch.creased[ring.mask + eight] = static_cast<std::uint8_t>(creased);
    const Ints isLive = ((Ints{} + static_cast<std::int32_t>(live)) & lane) != 0;
    d = isLive ? d : splatF(kNotLiveMm);
    __builtin_memcpy(touch.distanceMm + at, &d, sizeof d);
    if (live == 0) return 0;
    least = leastF(least, d);
    __builtin_memcpy(touch.gradientX + at, &gx, sizeof gx);
    __builtin_memcpy(touch.gradientY + at, &gy, sizeof gy);
    __builtin_memcpy(touch.gradientZ + at, &gz, sizeof gz);
    if (query.tissue == kManyTissues) {
        const Ints nearest = places.inBrick + (t[0] > 0.5f ? Ints{} + 1 : Ints{}) +
                             (t[1] > 0.5f ? Ints{} + kY : Ints{}) + (t[2] > 0.5f ? Ints{} + kZ : Ints{});
        for (int i = 0; i < 8; ++i) {
            if ((live >> i & 1u) == 0) continue;
            const std::int32_t node = places.stored[i] < 0 ? field::kCentreNode : nearest[i];
            touch.tissue[at + i] = field.tissue[field.tissueStart[places.dense[i]] + static_cast<std::uint32_t>(node)];
        }
    }
    return live;
}

void sense(const FieldView& field, const BurRings& bur, const RingQuery& query, const RingTouch& touch) noexcept {
    const GridPose pose(field, query);
    const double still[3] = {};
    double reach[3];
    for (int k = 0; k < 3; ++k)
        reach[k] = pose.z[k] < 0.0 ? -pose.z[k] : pose.z[k];
    // In a trilinear cell the Lipschitz bound holds but for what the cell is off, a tenth of a voxel near an edge of
    // the surface: what lies beyond a bound by no more than that is looked up.
    const auto voxelMm = static_cast<float>(field.voxelMm);
    const float slackMm = 0.1f * voxelMm;
    float threshold = mostMm(query) + slackMm;
    for (std::int32_t i = 0; i < bur.count; i += 8) {
        // Eight rings: heights from the middle one on.
        const double middle = bur.heights[i + 4];
        double far = 0.0;
        for (int k = 0; k < 8; ++k) {
            const double away = bur.heights[i + k] - middle;
            far = away > far ? away : -away > far ? -away : far;
        }
        double centre[3];
        for (int k = 0; k < 3; ++k)
            centre[k] = pose.tip[k] + middle * pose.z[k];
        const Row row(field, centre, pose.z, still, 1.0, reach, far);
        const Floats along = loadFloats(bur.heights + i) - splatF(static_cast<float>(middle));
        const Floats d = distances(field, query, row, along, Floats{});
        __builtin_memcpy(touch.axisMm + i, &d, sizeof d);
    }
    *touch.skippedDeep = false;
    for (std::int32_t i = 0; i < bur.count; ++i) {
        const BurRing& ring = bur.rings[i];
        touch.liveRing[i] = 0;
        touch.leastMm[i] = kNotLiveMm;
        const auto rho = static_cast<float>(ring.rhoMm);
        if (touch.axisMm[i] - rho > threshold) continue;
        double centre[3];
        for (int k = 0; k < 3; ++k)
            centre[k] = pose.tip[k] + ring.zMm * pose.z[k];
        const Row row(field, centre, pose.x, pose.y, ring.rhoMm, pose.reach, ring.rhoMm);
        unsigned any = 0;
        Floats least = splatF(kNotLiveMm);
        for (int group = 0; group < ring.eights; group += 8) {
            unsigned near = 0xff;
            if (ring.eights > 3) {  // fewer are soon looked up themselves
                const std::int32_t at = ring.middles + group;
                const Floats d = distances(field, query, row, loadFloats(bur.cosines + at), loadFloats(bur.sines + at));
                near = bitsOf(d - ring.chordMm <= threshold);
            }
            const int end = ring.eights - group < 8 ? ring.eights : group + 8;
            for (int e = group; e < end; ++e, near >>= 1) {
                if ((near & 1u) != 0) {
                    any |= senseEight(field, bur, query, touch, ring, row, e, least);
                } else {
                    const Floats none = splatF(kNotLiveMm);
                    __builtin_memcpy(touch.distanceMm + ring.first + 8 * e, &none, sizeof none);
                    touch.live[ring.mask + e] = touch.creased[ring.mask + e] = 0;
                }
            }
        }
        if (any == 0) continue;
        touch.liveRing[i] = 1;
        touch.leastMm[i] = leastOf(least);
        const float enough = touch.leastMm[i] + query.windowMm + slackMm;
        if (query.windowMm > 0.0f && enough < threshold) threshold = enough;
        // Around the seam. Padding in the last eight is not live, so the neighbour is the last point itself.
        touch.distanceMm[ring.first - 1] = ring.count > 1 ? touch.distanceMm[ring.first + ring.count - 1] : kNotLiveMm;
        touch.distanceMm[ring.first + ring.count] = ring.count > 1 ? touch.distanceMm[ring.first] : kNotLiveMm;
    }
}

inline Floats get(const float* p) {
    return loadFloats(p);
}
inline void add(float (&sum)[8], Floats value) {
    value += get(sum);
    __builtin_memcpy(sum, &value, sizeof value);
}

/// Sums over a run of points, w = area (margin - phi): of w itself, of w times the place (x and y are scaled by the
/// ring's radius in the end), and of w times the gradient, whose direction is the patch's normal.
void addRun(const BurRings& bur, const RingTouch& touch, std::int32_t i, std::int32_t from, std::int32_t to,
            float marginMm, TouchSums& sums) noexcept {
    const BurRing& ring = bur.rings[i];
    Floats weight{}, x{}, y{}, gx{}, gy{}, gz{}, least = get(sums.least);
    for (std::int32_t j = from & ~7; j < to; j += 8) {
        const Ints place = Ints{0, 1, 2, 3, 4, 5, 6, 7} + j;
        const Ints isIn = (place >= from) & (place < to);
        const std::int32_t at = ring.first + j, angle = ring.angles + j;
        const Floats d = get(touch.distanceMm + at);
        const Floats w = isIn ? ring.areaMm2 * (marginMm - d) : Floats{};
        weight += w;
        x += w * get(bur.cosines + angle);
        y += w * get(bur.sines + angle);
        gx += w * get(touch.gradientX + at);
        gy += w * get(touch.gradientY + at);
        gz += w * get(touch.gradientZ + at);
        least = leastF(least, isIn ? d : least);
    }
    const auto rho = static_cast<float>(ring.rhoMm);
    add(sums.weight, weight);
    add(sums.x, rho * x);
    add(sums.y, rho * y);
    add(sums.z, static_cast<float>(ring.zMm) * weight);
    add(sums.gradientX, gx);
    add(sums.gradientY, gy);
    add(sums.gradientZ, gz);
    __builtin_memcpy(sums.least, &least, sizeof least);
}

unsigned within(const BurRings& bur, const RingTouch& touch, std::int32_t i, std::int32_t eight, float mm) noexcept {
    return bitsOf(get(touch.distanceMm + bur.rings[i].first + 8 * eight) <= mm);
}

unsigned lowInRing(const BurRings& bur, const RingTouch& touch, std::int32_t i, std::int32_t eight) noexcept {
    const BurRing& ring = bur.rings[i];
    const float* at = touch.distanceMm + ring.first + 8 * eight;
    const Floats d = get(at);
    return bitsOf((get(at - 1) >= d) & (get(at + 1) >= d)) & touch.live[ring.mask + eight];
}

void around(const FieldView& field, const AroundQuery& query, float* out) noexcept {
    double centre[3], reach[3];
    float third[3];
    double x[3], y[3];
    for (int k = 0; k < 3; ++k) {
        const double place = (query.centre[k] - field.originMm[k]) * field.inverseVoxelMm;
        centre[k] = place < -kFarGrid ? -kFarGrid : place > kFarGrid ? kFarGrid : place;
        reach[k] = query.reachMm * field.inverseVoxelMm;
        x[k] = query.alongU[k] * field.inverseVoxelMm;
        y[k] = query.alongArc[k] * field.inverseVoxelMm;
        third[k] = static_cast<float>(query.inward[k] * field.inverseVoxelMm);
    }
    Row row(field, centre, x, y, 1.0, reach, 1.0);
    row.isInGrid = false;  // where the bur curls up tightly steps may lead farther than the reach
    const Places places(field, row, loadFloats(query.u), loadFloats(query.arc), loadFloats(query.in), third);
    const Floats d = distancesAt(field, row, places, query.farOutMm, query.farInMm);
    __builtin_memcpy(out, &d, sizeof d);
}

/// Sums of eight points, scaled to a band.
inline void addBearing(BearingSums& sums, Floats area, Floats resistance, Floats x, Floats y, float areaMm2,
                       float perRho, float turns) {
    add(sums.area, areaMm2 * area);
    add(sums.resistance, areaMm2 * perRho * resistance);
    add(sums.x, turns * areaMm2 * perRho * x);
    add(sums.y, turns * areaMm2 * perRho * y);
}

/// What each live point bears when the bur is pushed along a direction d (Bearing in method.h): c = max(0, n . d) with
/// n the band's outward normal, a weight that falls from 1 at the surface to 0 at the margin above it, where the point
/// counts as lead c nearer. Sums of w c, w c^2 / rho and w c t / rho, t = (sin a, -cos a): docs/physics.md#cutting.
void bear(const BurRings& bur, const RingTouch& touch, const BearingBand* bands, std::int32_t count,
          const BearingQuery& query, BearingSums* byTissue) noexcept {
    const float across = __builtin_sqrtf(query.x * query.x + query.y * query.y), perMargin = 1.0f / query.marginMm;
    for (std::int32_t b = 0; b < count; ++b) {
        const BearingBand& band = bands[b];
        if (touch.liveRing[band.ring] == 0) continue;
        const float along = band.normalZ * query.z, most = __builtin_fabsf(band.normalRho) * across + along;
        if (!(most > 0.0f)) continue;
        const BurRing& ring = bur.rings[band.ring];
        const auto rho = static_cast<float>(ring.rhoMm);
        const float perRho = 1.0f / (rho > query.leastRadiusMm ? rho : query.leastRadiusMm);
        const float turns = rho > 0.0f ? 1.0f : 0.0f;  // on the axis nothing moves
        const float xPart = band.normalRho * query.x, yPart = band.normalRho * query.y;
        Floats area{}, resistance{}, x{}, y{};
        for (std::int32_t e = 0; e < ring.eights; ++e) {
            unsigned live = touch.live[ring.mask + e];
            if (live == 0) continue;
            const std::int32_t at = ring.first + 8 * e, angle = ring.angles + 8 * e;
            const Floats cosine = get(bur.cosines + angle), sine = get(bur.sines + angle);
            const Floats c = mostF(xPart * cosine + yPart * sine + along, Floats{});
            const Floats gap = get(touch.distanceMm + at) - query.leadMm * c;
            const Floats w = leastF(mostF(1.0f - perMargin * gap, Floats{}), splatF(1.0f)) * c;
            // Clockwise seen down the shank: the point at (cosine, sine) moves along (sine, -cosine).
            if (query.tissue != kManyTissues) {
                area += w;
                resistance += w * c;
                x += w * sine;
                y -= w * cosine;
                continue;
            }
            while (live != 0) {
                const std::uint8_t tissue = touch.tissue[at + __builtin_ctz(live)];
                unsigned same = 0;
                for (int i = 0; i < 8; ++i)
                    same |= (touch.tissue[at + i] == tissue ? 1u : 0u) << i;
                same &= live;
                live &= ~same;
                const Ints lane = {1, 2, 4, 8, 16, 32, 64, 128};
                const Floats own = ((Ints{} + static_cast<std::int32_t>(same)) & lane) != 0 ? w : Floats{};
                addBearing(byTissue[tissue], own, own * c, own * sine, -own * cosine, band.areaMm2, perRho, turns);
            }
        }
        if (query.tissue != kManyTissues)
            addBearing(byTissue[query.tissue], area, resistance, x, y, band.areaMm2, perRho, turns);
    }
}

}  // namespace

RingKernels ringKernels() noexcept {
    return {sense, around, bear, addRun, within, lowInRing};
}

}  // namespace handpiece::contact::HANDPIECE_SIMD_NS
