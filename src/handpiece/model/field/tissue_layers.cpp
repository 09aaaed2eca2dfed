// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/field/tissue_layers.h"

#include <algorithm>
#include <cmath>

namespace handpiece::field {
namespace {

/// To the nearest unit, never across zero: a node keeps its side.
std::int8_t quantised(float distanceMm, float perUnit) {
    const float units = std::clamp(std::round(distanceMm * perUnit), -127.0f, 127.0f);
    return static_cast<std::int8_t>(distanceMm < 0.0f ? std::min(units, -1.0f) : units);
}

}  // namespace

LayeredBrick layeredBrick(const std::vector<NearPart>& parts, cases::Tissue rest, bool nearest, double unitMm) {
    BrickLayers brick;
    brick.rest = rest;
    brick.values.resize(parts.size() * kBrickValues);
    const auto perUnit = static_cast<float>(1.0 / unitMm);
    for (std::size_t node = 0; node < kBrickValues; ++node) {
        float least = std::numeric_limits<float>::infinity(), second = least;
        std::size_t leastAt = 0;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            const float d = parts[i].distanceMm[node];
            if (d < least) {
                second = least;
                least = d;
                leastAt = i;
            } else {
                second = std::min(second, d);
            }
        }
        for (std::size_t i = 0; i < parts.size(); ++i) {
            float d = parts[i].distanceMm[node];
            // Outside all of them the boundary runs halfway between the two nearest.
            if (nearest && least >= 0.0f) d = i == leastAt ? 0.5f * (d - second) : 0.5f * (d - least);
            std::int8_t q = quantised(d, perUnit);
            if (nearest && least >= 0.0f && i == leastAt) q = std::min<std::int8_t>(q, -1);
            brick.values[i * kBrickValues + node] = q;
        }
    }
    // What is nowhere inside plays no part; what is inside everywhere hides all that comes after it.
    std::size_t kept = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const auto first = brick.values.begin() + static_cast<std::ptrdiff_t>(i * kBrickValues);
        const auto last = first + kBrickValues;
        if (std::all_of(first, last, [](std::int8_t q) { return q >= 0; })) continue;
        if (std::all_of(first, last, [](std::int8_t q) { return q < 0; })) {
            brick.rest = parts[i].tissue;
            break;
        }
        std::copy(first, last, brick.values.begin() + static_cast<std::ptrdiff_t>(kept++ * kBrickValues));
        brick.tissues.push_back(parts[i].tissue);
    }
    // Layers of the same tissue as what lies under all of them change nothing.
    while (kept > 0 && brick.tissues.back() == brick.rest) {
        brick.tissues.pop_back();
        --kept;
    }
    brick.values.resize(kept * kBrickValues);
    if (kept == 0) return {brick.rest, nullptr};
    for (std::size_t node = 0; node < kBrickValues; ++node) {
        std::size_t i = 0;
        while (i < kept && brick.values[i * kBrickValues + node] >= 0)
            ++i;
        brick.nodes[node] = static_cast<std::uint8_t>(i < kept ? brick.tissues[i] : brick.rest);
    }
    return {cases::Tissue::none, std::make_unique<BrickLayers>(std::move(brick))};
}

}  // namespace handpiece::field
