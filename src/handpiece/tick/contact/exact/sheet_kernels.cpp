// SPDX-License-Identifier: Apache-2.0
// Compiled once per instruction set; see cmake/handpiece.cmake.
#include "handpiece/tick/contact/exact/sheet_kernels.h"

#include "handpiece/tick/contact/exact/tree_search.h"
#include "handpiece/tick/contact/lanes.h"

namespace handpiece::contact::HANDPIECE_SIMD_NS {
namespace {

constexpr int kHalvings = 6;

inline Floats highestOf(const Floats (&v)[4]) {
    return mostF(mostF(v[0], v[1]), mostF(v[2], v[3]));
}

HighestCell lower(const SheetCells& cells, const float place[3], float freeMm, float floorMm) noexcept {
    Floats highest = splatF(-1e30f);
    Ints at{};
    for (int i = 0; i < cells.count; i += 8) {
        Floats upper = loadFloats(cells.upper + i);
        if (bitsOf(upper > floorMm) == 0) continue;
        Floats old[4], found[4], rise[4];
        for (int k = 0; k < 4; ++k) {
            const Floats dx = loadFloats(cells.x[k] + i) - place[0], dy = loadFloats(cells.y[k] + i) - place[1],
                         dz = loadFloats(cells.z[k] + i) - place[2];
            found[k] = loadFloats((k < 2 ? cells.lowRadius : cells.highRadius) + i) +
                       rootF(dx * dx + dy * dy + dz * dz) + (kBoundSlackMm - freeMm);
            old[k] = loadFloats(cells.corner[k] + i);
            rise[k] = found[k] - old[k];
        }
        // The highest corner is convex in the new bound's share: halve to where it is lowest.
        Floats low{}, high = splatF(1.0f), mixed[4];
        for (int step = 0; step < kHalvings; ++step) {
            const Floats share = 0.5f * (low + high);
            Floats most = old[0] + share * rise[0], slope = rise[0];
            for (int k = 1; k < 4; ++k) {
                const Floats value = old[k] + share * rise[k];
                slope = value > most ? rise[k] : slope;
                most = mostF(most, value);
            }
            high = slope > 0.0f ? share : high;
            low = slope > 0.0f ? low : share;
        }
        const Floats share = 0.5f * (low + high);
        for (int k = 0; k < 4; ++k)
            mixed[k] = high == 1.0f ? found[k] : old[k] + share * rise[k];
        const Floats before = highestOf(old), after = highestOf(mixed);
        const Ints isLower = after < before;
        for (int k = 0; k < 4; ++k) {
            const Floats kept = isLower ? mixed[k] : old[k];
            __builtin_memcpy(cells.corner[k] + i, &kept, sizeof kept);
        }
        upper = leastF(upper, leastF(before, after));
        __builtin_memcpy(cells.upper + i, &upper, sizeof upper);
        const Ints isHigher = upper > highest;
        at = isHigher ? Ints{} + i : at;
        highest = mostF(highest, upper);
    }
    HighestCell top{highest[0], at[0]};
    for (int lane = 1; lane < 8; ++lane) {
        const int cell = at[lane] + lane;
        if (highest[lane] > top.upper || (highest[lane] == top.upper && cell < top.cell)) top = {highest[lane], cell};
    }
    return top;
}

}  // namespace

LowerCells lowerCells() noexcept {
    return lower;
}

}  // namespace handpiece::contact::HANDPIECE_SIMD_NS
