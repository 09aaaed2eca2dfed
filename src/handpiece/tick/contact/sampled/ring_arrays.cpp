// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/sampled/ring_arrays.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/instrument/piece.h"

namespace handpiece::contact {

RingKernels ringKernelsFor(core::SimdLevel level) {
    return HANDPIECE_AT_SIMD_LEVEL(level, ringKernels)();
}

RingArrays::RingArrays(std::span<const instrument::SurfaceRing> given) {
    struct Table {
        std::size_t angles, middles;
    };
    std::map<std::uint32_t, Table> tables;
    std::size_t points = kRingPad, eightsInAll = 0;
    const auto addAngle = [this](double angle, std::size_t inSector) {
        cosines.push_back(static_cast<float>(core::cos(angle)));
        sines.push_back(static_cast<float>(core::sin(angle)));
        sector.push_back(static_cast<std::uint8_t>(inSector));
    };
    for (const instrument::SurfaceRing& r : given) {
        if (r.count == 0) continue;
        const auto [it, added] = tables.try_emplace(r.count);
        const std::size_t count = r.count, eights = (count + 7) / 8;
        const double step = 2.0 * std::numbers::pi / static_cast<double>(count);
        if (added) {  // the padding repeats the last one
            it->second.angles = cosines.size();
            for (std::size_t j = 0; j < 8 * eights; ++j) {
                const std::size_t own = std::min(j, count - 1);
                addAngle(step * (static_cast<double>(own) + 0.5), own * kSectors / count);
            }
            it->second.middles = cosines.size();
            for (std::size_t e = 0; e < 8 * ((eights + 7) / 8); ++e)
                addAngle(step * static_cast<double>(8 * std::min(e, eights - 1) + 4), 0);
        }
        const double halfAngle = std::min(std::numbers::pi, 3.5 * step);
        BurRing ring{};
        ring.zMm = r.zMm;
        ring.rhoMm = r.rhoMm;
        ring.areaMm2 = static_cast<float>(r.areaMm2);
        ring.chordMm = static_cast<float>(2.0 * r.rhoMm * core::sin(0.5 * halfAngle));
        ring.count = static_cast<std::int32_t>(count);
        ring.eights = static_cast<std::int32_t>(eights);
        ring.first = static_cast<std::int32_t>(points);
        ring.mask = static_cast<std::int32_t>(eightsInAll);
        ring.angles = static_cast<std::int32_t>(it->second.angles);
        ring.middles = static_cast<std::int32_t>(it->second.middles);
        rings.push_back(ring);
        points += 8 * eights + kRingPad;
        eightsInAll += eights;
    }
    for (const BurRing& ring : rings)
        heights.push_back(static_cast<float>(ring.zMm));
    while (heights.size() % 8 != 0)
        heights.push_back(heights.back());
    axisDistance.assign(heights.size(), 0.0f);
    for (std::vector<float>* values : {&distance, &gx, &gy, &gz})
        values->assign(points, 0.0f);
    tissue.assign(points, 0);
    live.assign(eightsInAll, 0);
    creased.assign(eightsInAll, 0);
    liveRing.assign(rings.size(), 0);
    least.assign(rings.size(), kNotLiveMm);
    bur = {rings.data(), static_cast<std::int32_t>(rings.size()), cosines.data(), sines.data(), heights.data()};
    touch = {axisDistance.data(), distance.data(), gx.data(),       gy.data(),    gz.data(),        tissue.data(),
             live.data(),         creased.data(),  liveRing.data(), least.data(), skippedDeep.get()};
}

double leastOf(const RingArrays& arrays) noexcept {
    float least = kNotLiveMm;
    for (const float d : arrays.least)
        least = std::min(least, d);
    return static_cast<double>(least);
}

std::size_t pickNearest(const RingArrays& arrays, const float* inMm, double windowMm, double apartMm,
                        std::span<RingPoint> out) noexcept {
    std::size_t count = 0;
    float most = 0.5f * kNotLiveMm;
    while (count < out.size()) {
        float least = most;
        bool found = false;
        for (std::size_t i = 0; i < arrays.rings.size(); ++i) {
            const float in = inMm != nullptr ? inMm[i] : 0.0f;
            if (!(arrays.least[i] - in < least)) continue;
            const BurRing& ring = arrays.rings[i];
            const float* gaps = &arrays.distance[static_cast<std::size_t>(ring.first)];
            // Two points of rings are dz^2 + r^2 + s^2 - 2 r s cos(angle between them) apart, squared.
            const auto isApart = [&](const RingPoint& other, std::size_t angle) {
                const BurRing& its = arrays.rings[other.ring];
                const double dz = ring.zMm - its.zMm;
                const double cosine = static_cast<double>(arrays.cosines[angle] * arrays.cosines[other.angle] +
                                                          arrays.sines[angle] * arrays.sines[other.angle]);
                return dz * dz + ring.rhoMm * ring.rhoMm + its.rhoMm * its.rhoMm -
                           2.0 * ring.rhoMm * its.rhoMm * cosine >=
                       apartMm * apartMm;
            };
            for (std::int32_t j = 0; j < ring.count; ++j) {
                if (!(gaps[j] - in < least)) continue;
                const auto angle = static_cast<std::size_t>(ring.angles + j);
                bool taken = false;
                for (std::size_t k = 0; k < count && !taken; ++k)
                    taken = !isApart(out[k], angle);
                if (taken) continue;
                least = gaps[j] - in;
                found = true;
                out[count] = {i, angle, static_cast<double>(gaps[j])};
            }
        }
        if (!found) break;
        if (count == 0) most = least + static_cast<float>(windowMm);
        ++count;
    }
    return count;
}

std::vector<BearingBand> bearingBands(const instrument::Bur& bur) {
    constexpr double kSameNormal = 0.9999;
    std::vector<BearingBand> bands;
    const auto add = [&](std::size_t at, core::Vec2 normal, double areaMm2) {
        const instrument::SurfaceRing& ring = bur.rings()[at];
        if (ring.rhoMm < 1e-9) normal = {0.0, ring.normalZ};
        const auto area = static_cast<float>(areaMm2 / ring.count);
        if (!bands.empty() && bands.back().ring == static_cast<std::int32_t>(at) &&
            static_cast<double>(bands.back().normalRho) * normal.x() +
                    static_cast<double>(bands.back().normalZ) * normal.y() >
                kSameNormal) {
            bands.back().areaMm2 += area;
            return;
        }
        bands.push_back(
            {static_cast<std::int32_t>(at), static_cast<float>(normal.x()), static_cast<float>(normal.y()), area});
    };
    // As the bur lays its rings: every piece of the outline from its beginning in equal steps.
    std::size_t first = 0;
    for (const instrument::ProfilePiece& piece : bur.profile().pieces) {
        std::size_t steps = 1;
        while (first + steps + 1 < bur.rings().size() &&
               (core::Vec2(bur.rings()[first + steps].rhoMm, bur.rings()[first + steps].zMm) - piece.to).norm() > 1e-9)
            ++steps;
        const auto count = static_cast<double>(steps);
        for (std::size_t i = 0; i <= steps; ++i) {
            const double t = static_cast<double>(i) / count, half = 0.5 / count;
            add(first + i, -instrument::inwardNormalAt(piece, t),
                instrument::turnedAreaMm2(piece, std::max(0.0, t - half), std::min(1.0, t + half)));
        }
        first += steps;
    }
    return bands;
}

}  // namespace handpiece::contact
