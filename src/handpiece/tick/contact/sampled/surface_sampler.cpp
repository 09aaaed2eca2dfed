// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/sampled/surface_sampler.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace handpiece::contact {

using core::Vec3;

namespace {

constexpr std::uint64_t kNone = ~std::uint64_t{0};
/// Two walls that meet at an angle a in the middle of a cell leave cos(a / 2) of the slope there, and stand in by some
/// tan(a / 2) / 4 voxels: by a micron and a quarter of 50 at this slope.
constexpr float kCreaseSlope = 0.995f;
/// A wall of radius r turns by a voxel / r in a cell: by this of 50 um at 0.2 mm.
constexpr float kCreaseTwist = 0.25f;
/// So deep in the tooth, where a mixed value would hold the bur off, and so far outside, points are asked.
constexpr double kCreaseInVoxels = 0.4, kCreaseVoxels = 0.1;
/// Points of the patches are told so much farther out, for bearing() to count them for a bur so much ahead.
constexpr double kLeadMm = 0.005;

std::vector<std::uint8_t> tissuesOf(const field::DistanceField& field) {
    std::vector<std::uint8_t> numbers;
    for (const cases::Tissue tissue : field.storage().tissues->tissues())
        numbers.push_back(static_cast<std::uint8_t>(tissue));
    return numbers;
}

double sumOf(const float (&lanes)[8]) noexcept {
    double sum = 0.0;
    for (const float lane : lanes)
        sum += static_cast<double>(lane);
    return sum;
}

}  // namespace

SurfaceSampler::SurfaceSampler(KnownSurface& surface, const instrument::Bur& bur, core::SimdLevel level)
    : surface_(surface),
      field_(surface.field()),
      view_(field_.view()),
      kernels_(ringKernelsFor(level)),
      arrays_(bur.rings()),
      bands_(bearingBands(bur)),
      tissues_(tissuesOf(field_)),
      tissueOfAll_(tissues_.size() == 1 ? tissues_.front() : kManyTissues) {
    runs_.resize(kMaxRuns);
    candidates_.resize(arrays_.distance.size());
    nearest_.resize((arrays_.rings.size() + kRingsPerBlock - 1) / kRingsPerBlock * kSectors);
    query_.farOutMm = static_cast<float>(field_.reach().outMm);
    query_.farInMm = static_cast<float>(field_.reach().inMm);
    // Values that are not held to anything are distances however deep.
    query_.deepMm = field_.storage().heldTo ? static_cast<float>(kSaturated * field_.reach().inMm) : kNotLiveMm;
    query_.tissue = tissueOfAll_;
    query_.creaseSlope = kCreaseSlope;
    query_.creaseTwist = kCreaseTwist;
    query_.creaseMm = static_cast<float>(kCreaseVoxels * view_.voxelMm);
    query_.creaseInMm = static_cast<float>(kCreaseInVoxels * view_.voxelMm);
}

std::uint8_t SurfaceSampler::tissueAt(std::int32_t at) const noexcept {
    return tissueOfAll_ != kManyTissues ? tissueOfAll_ : arrays_.tissue[static_cast<std::size_t>(at)];
}

bool SurfaceSampler::isSensed(const core::Pose& pose) const noexcept {
    return sensedVersion_ == field_.version() && pose.positionMm == sensedPose_.positionMm &&
           pose.orientation.coeffs() == sensedPose_.orientation.coeffs();
}

void SurfaceSampler::sense(const core::Pose& burInTooth, double thresholdMm, bool skipsDeep) noexcept {
    frame_ = BurFrame(burInTooth);
    query_.tip = frame_.tip.data();
    query_.x = frame_.x.data();
    query_.y = frame_.y.data();
    query_.z = frame_.z.data();
    query_.thresholdMm = static_cast<float>(thresholdMm);
    query_.skipsDeep = skipsDeep;
    kernels_.sense(view_, arrays_.bur, query_, arrays_.touch);
    sharpen();
    sensedPose_ = burInTooth;
    sensedVersion_ = field_.version();
}

/// Where walls meet in a cell what is mixed there is off by up to a third of a voxel. For the proxy, which one point
/// can hold off, those points are asked; for sums over many it is enough to know where the bur has cut last.
void SurfaceSampler::sharpen() noexcept {
    const bool forProxy = query_.skipsDeep;
    if (!forProxy && !surface_.knowsCut()) return;
    for (std::size_t i = 0; i < arrays_.rings.size(); ++i) {
        if (arrays_.liveRing[i] == 0) continue;
        const BurRing& ring = arrays_.rings[i];
        float* const gaps = &arrays_.distance[static_cast<std::size_t>(ring.first)];
        bool any = false;
        for (std::int32_t e = 0; e < ring.eights; ++e)
            for (unsigned creased = arrays_.creased[static_cast<std::size_t>(ring.mask + e)]; creased != 0;
                 creased &= creased - 1) {
                const std::int32_t j = 8 * e + std::countr_zero(creased);
                const double mixed = static_cast<double>(gaps[j]);
                if (!forProxy && mixed >= 0.0) continue;
                const Vec3 place = placeOf(arrays_, frame_, ring, j);
                gaps[j] = static_cast<float>(forProxy ? surface_.distanceAtCrease(place, mixed)
                                                      : std::max(mixed, surface_.freeMm(place)));
                any = true;
            }
        if (!any) continue;
        arrays_.least[i] = *std::min_element(gaps, gaps + ring.count);
        if (ring.count == 1) continue;
        gaps[-1] = gaps[ring.count - 1];
        gaps[ring.count] = gaps[0];
    }
}

double SurfaceSampler::leastMm() const noexcept {
    return leastOf(arrays_);
}

bool SurfaceSampler::hasSensed(const core::Pose& burInTooth, double thresholdMm, double windowMm) const noexcept {
    if (!isSensed(burInTooth) || *arrays_.skippedDeep) return false;
    const double sensedMm = static_cast<double>(query_.thresholdMm);
    return sensedMm >= thresholdMm || leastMm() + windowMm <= sensedMm;
}

void SurfaceSampler::bearing(const core::Pose& burInTooth, const Vec3& direction, double leadMm, double leastRadiusMm,
                             Bearing& out) noexcept {
    out = Bearing{};
    for (Vec3& tangent : out.tangentMm)
        tangent.setZero();
    if (!burInTooth.isValid() || !direction.allFinite()) {
        out.status = Status::invalidPose;
        return;
    }
    // A point farther off than that does not count whichever way it faces.
    const double withinMm = kContactMarginMm + std::max(leadMm, 0.0);
    if (!isSensed(burInTooth) || query_.thresholdMm < static_cast<float>(withinMm) || query_.skipsDeep)
        sense(burInTooth, withinMm, false);
    const Vec3 along(direction.dot(frame_.x), direction.dot(frame_.y), direction.dot(frame_.z));
    BearingQuery query{};
    query.x = static_cast<float>(along.x());
    query.y = static_cast<float>(along.y());
    query.z = static_cast<float>(along.z());
    query.leadMm = static_cast<float>(leadMm);
    query.marginMm = static_cast<float>(kContactMarginMm);
    query.leastRadiusMm = static_cast<float>(leastRadiusMm);
    query.tissue = tissueOfAll_;
    std::array<BearingSums, cases::kTissueCount> sums;
    for (const std::uint8_t t : tissues_)
        sums[t] = {};
    kernels_.bear(arrays_.bur, arrays_.touch, bands_.data(), static_cast<std::int32_t>(bands_.size()), query,
                  sums.data());
    for (const std::uint8_t t : tissues_) {
        out.areaMm2[t] = sumOf(sums[t].area);
        out.resistanceMm[t] = sumOf(sums[t].resistance);
        out.tangentMm[t] = sumOf(sums[t].x) * frame_.x + sumOf(sums[t].y) * frame_.y;
    }
}

std::int32_t SurfaceSampler::rootOf(std::int32_t run) noexcept {
    while (runs_[static_cast<std::size_t>(run)].root != run) {
        auto& r = runs_[static_cast<std::size_t>(run)].root;
        r = runs_[static_cast<std::size_t>(r)].root;
        run = r;
    }
    return run;
}

void SurfaceSampler::joinRuns(std::size_t begin, std::size_t middle, std::size_t end) noexcept {
    const auto join = [&](std::size_t a, std::size_t b) {
        const std::int32_t ra = rootOf(static_cast<std::int32_t>(a)), rb = rootOf(static_cast<std::int32_t>(b));
        if (ra != rb) runs_[static_cast<std::size_t>(std::max(ra, rb))].root = std::min(ra, rb);
    };
    for (std::size_t b = middle; b < end; ++b)
        for (std::size_t a = begin; a < middle; ++a) {
            const Run &first = runs_[a], &second = runs_[b];
            const std::int64_t n = arrays_.rings[static_cast<std::size_t>(first.ring)].count;
            const std::int64_t m = arrays_.rings[static_cast<std::size_t>(second.ring)].count;
            // Arcs [from / n, to / n) and [from / m, to / m) share an angle; rings of one point are everywhere.
            if (first.from * m < second.to * n && second.from * n < first.to * m) join(a, b);
        }
    // Around the ring's seam.
    if (end > middle + 1) {
        const Run &first = runs_[middle], &last = runs_[end - 1];
        if (first.from == 0 && last.to == arrays_.rings[static_cast<std::size_t>(last.ring)].count)
            join(middle, end - 1);
    }
}

std::size_t SurfaceSampler::findRuns() noexcept {
    std::size_t count = 0, previousBegin = 0;
    std::int32_t previousRing = -2;
    for (std::size_t i = 0; i < arrays_.rings.size(); ++i) {
        if (arrays_.liveRing[i] == 0) continue;
        const BurRing& ring = arrays_.rings[i];
        const std::size_t begin = count;
        const auto add = [&](std::int32_t from, std::int32_t to) {
            runs_[count] = {static_cast<std::int32_t>(i), from, to, static_cast<std::int32_t>(count)};
            ++count;
        };
        std::int32_t from = -1;  // of the run that reaches into the eight at hand
        for (std::int32_t e = 0; e < ring.eights; ++e) {
            const bool any = arrays_.live[static_cast<std::size_t>(ring.mask + e)] != 0;
            const unsigned bits = any ? kernels_.within(arrays_.bur, arrays_.touch, static_cast<std::int32_t>(i), e,
                                                        static_cast<float>(kContactMarginMm))
                                      : 0u;
            if (bits == (from < 0 ? 0u : 0xffu)) continue;
            for (int bit = 0; bit < 8;) {
                const unsigned rest = bits >> bit;
                if (from < 0) {
                    if (rest == 0) break;
                    bit += std::countr_zero(rest);
                    from = 8 * e + bit;
                } else {
                    bit += std::countr_one(rest);
                    if (bit == 8) break;
                    if (count == kMaxRuns) return count;
                    add(from, 8 * e + bit);
                    from = -1;
                }
            }
        }
        if (from >= 0) {
            if (count == kMaxRuns) return count;
            add(from, ring.count);
        }
        joinRuns(previousRing + 1 == static_cast<std::int32_t>(i) ? previousBegin : begin, begin, count);
        previousBegin = begin;
        previousRing = static_cast<std::int32_t>(i);
    }
    return count;
}

std::size_t SurfaceSampler::sumRuns(std::size_t runs, Status& status) noexcept {
    constexpr auto kMargin = static_cast<float>(kContactMarginMm);
    std::size_t count = 0;
    for (std::size_t r = 0; r < runs; ++r) {
        const Run& run = runs_[r];
        const std::int32_t root = rootOf(static_cast<std::int32_t>(r));
        std::size_t s = 0;
        while (s < count && sums_[s].root != root)
            ++s;
        if (s == count) {
            if (count == kMaxSums) {
                status = Status::truncated;
                continue;
            }
            Sums& fresh = sums_[count++];
            fresh = Sums{};
            fresh.root = root;
        }
        Sums& sum = sums_[s];
        const BurRing& ring = arrays_.rings[static_cast<std::size_t>(run.ring)];
        kernels_.addRun(arrays_.bur, arrays_.touch, run.ring, run.from, run.to, kMargin, sum.lanes);
        sum.area += static_cast<double>(ring.areaMm2) * (run.to - run.from);
        if (tissueOfAll_ != kManyTissues) continue;
        for (std::int32_t at = ring.first + run.from; at < ring.first + run.to; ++at)
            sum.tissue[arrays_.tissue[static_cast<std::size_t>(at)]] +=
                static_cast<double>(ring.areaMm2 * (kMargin - arrays_.distance[static_cast<std::size_t>(at)]));
    }
    for (std::size_t s = 0; s < count; ++s) {
        sums_[s].pressure = sumOf(sums_[s].lanes.weight);
        if (tissueOfAll_ != kManyTissues) sums_[s].tissue[tissueOfAll_] = sums_[s].pressure;
    }
    return count;
}

void SurfaceSampler::patches(const core::Pose& burInTooth, PatchSet& out) noexcept {
    out.patches.clear();
    out.areaMm2 = out.pressureMm3 = 0.0;
    out.tissueShare.fill(0.0);
    out.status = Status::ok;
    if (!burInTooth.isValid()) {
        out.status = Status::invalidPose;
        return;
    }
    sense(burInTooth, kContactMarginMm + kLeadMm, false);
    const std::size_t runs = findRuns();
    if (runs == kMaxRuns) out.status = Status::truncated;
    const std::size_t count = sumRuns(runs, out.status);
    double pressure = 0.0, tissues = 0.0;
    std::array<std::size_t, kMaxSums> order;
    for (std::size_t s = 0; s < count; ++s) {
        order[s] = s;
        out.areaMm2 += sums_[s].area;
        pressure += sums_[s].pressure;
        for (std::size_t t = 0; t < cases::kTissueCount; ++t) {
            out.tissueShare[t] += sums_[s].tissue[t];
            tissues += sums_[s].tissue[t];
        }
    }
    if (!(pressure > 0.0)) return;
    out.pressureMm3 = pressure;
    for (double& share : out.tissueShare)
        share /= tissues;
    std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), [this](std::size_t a, std::size_t b) {
        return sums_[a].pressure != sums_[b].pressure ? sums_[a].pressure > sums_[b].pressure
                                                      : sums_[a].root < sums_[b].root;
    });
    for (std::size_t i = 0; i < count; ++i) {
        const Sums& sum = sums_[order[i]];
        if (!(sum.pressure > 0.0)) continue;
        const TouchSums& lanes = sum.lanes;
        const Vec3 gradient(sumOf(lanes.gradientX), sumOf(lanes.gradientY), sumOf(lanes.gradientZ));
        const double n = gradient.norm();
        const Vec3 centre =
            frame_.tip +
            (sumOf(lanes.x) * frame_.x + sumOf(lanes.y) * frame_.y + sumOf(lanes.z) * frame_.z) / sum.pressure;
        const float least = *std::min_element(std::begin(lanes.least), std::end(lanes.least));
        const auto most = std::max_element(sum.tissue.begin(), sum.tissue.end()) - sum.tissue.begin();
        if (!out.patches.pushBack({centre, n > 1e-12 ? Vec3(gradient / n) : Vec3::Zero(), sum.area,
                                   std::max(0.0, -static_cast<double>(least)), sum.pressure / pressure,
                                   static_cast<cases::Tissue>(most)}))
            out.status = Status::truncated;
    }
}

std::uint64_t SurfaceSampler::keyOf(std::size_t i, std::int32_t j) const noexcept {
    const auto bits =
        std::bit_cast<std::uint32_t>(arrays_.distance[static_cast<std::size_t>(arrays_.rings[i].first + j)]);
    // Floats sort like integers once the negative ones are turned round.
    const std::uint32_t ordered = bits >> 31 != 0 ? ~bits : bits | 0x80000000u;
    return std::uint64_t{ordered} << 32 | i << 16 | static_cast<std::uint64_t>(j);
}

bool SurfaceSampler::isLocalMinimum(std::size_t i, std::int32_t j) const noexcept {
    const BurRing& ring = arrays_.rings[i];
    const float own = arrays_.distance[static_cast<std::size_t>(ring.first + j)];
    // Of equal neighbours the first one counts.
    const auto below = [&](const BurRing& other, std::int32_t k, bool before) {
        const float d = arrays_.distance[static_cast<std::size_t>(other.first + k)];
        return d < own || (before && d == own);
    };
    const std::int32_t left = j == 0 ? ring.count - 1 : j - 1, right = j + 1 == ring.count ? 0 : j + 1;
    if (ring.count > 1 && (below(ring, left, left < j) || below(ring, right, right < j))) return false;
    for (int side = -1; side <= 1; side += 2) {
        if ((side < 0 && i == 0) || (side > 0 && i + 1 == arrays_.rings.size())) continue;
        const std::size_t beside = side < 0 ? i - 1 : i + 1;
        if (arrays_.liveRing[beside] == 0) continue;
        const BurRing& other = arrays_.rings[beside];
        const std::int32_t from = (j * other.count) / ring.count, to = ((j + 1) * other.count - 1) / ring.count;
        for (std::int32_t k = from; k <= to && k < other.count; ++k)
            if (below(other, k, side < 0)) return false;
    }
    return true;
}

std::size_t SurfaceSampler::findMinima() noexcept {
    std::size_t count = 0;
    for (std::size_t i = 0; i < arrays_.rings.size(); ++i) {
        if (arrays_.liveRing[i] == 0) continue;
        for (std::int32_t e = 0; e < arrays_.rings[i].eights; ++e) {
            if (arrays_.live[static_cast<std::size_t>(arrays_.rings[i].mask + e)] == 0) continue;
            unsigned low = kernels_.lowInRing(arrays_.bur, arrays_.touch, static_cast<std::int32_t>(i), e);
            for (; low != 0; low &= low - 1) {
                const std::int32_t j = 8 * e + std::countr_zero(low);
                if (isLocalMinimum(i, j)) candidates_[count++] = keyOf(i, j);
            }
        }
    }
    std::sort(candidates_.begin(), candidates_.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
}

/// Adds the nearest point of every sector of a few rings, but for those that are minima already.
std::size_t SurfaceSampler::addSectors(std::size_t minima) noexcept {
    std::size_t count = minima;
    std::fill(nearest_.begin(), nearest_.end(), kNone);
    float least[kSectors] = {};
    std::size_t lastBlock = kNone;
    for (std::size_t i = 0; i < arrays_.rings.size(); ++i) {
        if (arrays_.liveRing[i] == 0) continue;
        const BurRing& ring = arrays_.rings[i];
        const std::size_t block = i / kRingsPerBlock * kSectors;
        if (block != lastBlock) std::fill_n(least, kSectors, kNotLiveMm);
        lastBlock = block;
        for (std::int32_t e = 0; e < ring.eights; ++e)
            for (unsigned live = arrays_.live[static_cast<std::size_t>(ring.mask + e)]; live != 0; live &= live - 1) {
                const std::int32_t j = 8 * e + std::countr_zero(live);
                const float d = arrays_.distance[static_cast<std::size_t>(ring.first + j)];
                const std::size_t sector = arrays_.sector[static_cast<std::size_t>(ring.angles + j)];
                // Of equals the first one counts, as by their keys.
                if (!(d < least[sector])) continue;
                least[sector] = d;
                nearest_[block + sector] = keyOf(i, j);
            }
    }
    const auto placeOf = [this](std::uint64_t key) {
        const std::size_t i = key >> 16 & 0xffffu, j = key & 0xffffu;
        return i / kRingsPerBlock * kSectors + arrays_.sector[static_cast<std::size_t>(arrays_.rings[i].angles) + j];
    };
    for (std::size_t c = 0; c < minima; ++c) {
        std::uint64_t& nearest = nearest_[placeOf(candidates_[c])];
        if (nearest == candidates_[c]) nearest = kNone;
    }
    for (const std::uint64_t key : nearest_)
        if (key != kNone && count < candidates_.size()) candidates_[count++] = key;
    return count;
}

Status SurfaceSampler::constraints(const core::Pose& burInTooth, double reachMm, ConstraintSet& out) noexcept {
    out.clear();
    if (!burInTooth.isValid()) return Status::invalidPose;
    if (!isSensed(burInTooth) || query_.thresholdMm != static_cast<float>(reachMm) || !query_.skipsDeep)
        sense(burInTooth, reachMm, true);
    // Every local minimum of the gap, then the nearest point of each sector of a few rings: walls, slots, rims and
    // edges are all seen, and the whole stays well spread.
    const std::size_t minima = std::min(findMinima(), kMaxConstraints);
    const std::size_t count = addSectors(minima), taken = std::min(count, kMaxConstraints);
    const auto at = [this](std::size_t i) { return candidates_.begin() + static_cast<std::ptrdiff_t>(i); };
    if (count > taken) std::nth_element(at(minima), at(taken), at(count));
    std::sort(at(minima), at(taken));
    for (std::size_t c = 0; c < taken; ++c) {
        const BurRing& ring = arrays_.rings[candidates_[c] >> 16 & 0xffffu];
        const auto j = static_cast<std::int32_t>(candidates_[c] & 0xffffu);
        const auto point = static_cast<std::size_t>(ring.first + j);
        const Vec3 place = placeOf(arrays_, frame_, ring, j);
        const double gap = static_cast<double>(arrays_.distance[point]);
        // Where walls meet the mixed slope is one between theirs: a bur that moves along one into the other would be
        // lifted off it.
        const bool creased = (arrays_.creased[static_cast<std::size_t>(ring.mask + j / 8)] >> j % 8 & 1) != 0;
        Vec3 normal = creased ? surface_.normalAtCrease(place, gap) : Vec3(Vec3::Zero());
        if (normal.isZero()) {
            normal = Vec3(arrays_.gx[point], arrays_.gy[point], arrays_.gz[point]);
            const double n = normal.norm();
            if (!(n > 1e-12)) continue;
            normal /= n;
        }
        out.pushBack({normal, gap, place, static_cast<cases::Tissue>(tissueAt(ring.first + j))});
    }
    return count > kMaxConstraints ? Status::truncated : Status::ok;
}

}  // namespace handpiece::contact
