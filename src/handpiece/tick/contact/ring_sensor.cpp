// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/ring_sensor.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace handpiece::contact {

using core::Vec3;

namespace {

constexpr float kFarMm = 1e3f;

RingKernels kernelsFor(core::SimdLevel level) {
#if defined(__x86_64__)
    if (level == core::SimdLevel::avx512) return simd_avx512::ringKernels();
    if (level == core::SimdLevel::avx2) return simd_avx2::ringKernels();
#endif
    static_cast<void>(level);
    return simd_base::ringKernels();
}

void store(double (&to)[3], const Vec3& v) noexcept {
    for (int k = 0; k < 3; ++k)
        to[k] = v[k];
}

}  // namespace

RingSensor::RingSensor(const tooth::ToothField& field, const instrument::Bur& bur, core::SimdLevel level)
    : field_(field), view_(field.view()), kernels_(kernelsFor(level)) {
    struct Table {
        std::size_t angles, middles;
    };
    std::map<std::uint32_t, Table> tables;
    std::size_t points = 0;
    const auto addAngle = [this](double angle) {
        cosines_.push_back(std::cos(angle));
        sines_.push_back(std::sin(angle));
    };
    for (const instrument::SurfaceRing& r : bur.rings()) {
        if (r.count == 0) continue;
        const auto [it, added] = tables.try_emplace(r.count);
        const int count = static_cast<int>(r.count), eights = (count + 7) / 8;
        const double step = 2.0 * std::numbers::pi / count;
        if (added) {  // the padding repeats the last one
            it->second.angles = cosines_.size();
            for (int j = 0; j < 8 * eights; ++j)
                addAngle(step * (std::min(j, count - 1) + 0.5));
            it->second.middles = cosines_.size();
            for (int e = 0; e < 8 * ((eights + 7) / 8); ++e)
                addAngle(step * (8 * std::min(e, eights - 1) + 4));
        }
        const double halfAngle = std::min(std::numbers::pi, 3.5 * step);
        rings_.push_back({r.zMm, r.rhoMm, r.areaMm2, count, eights, points, it->second.angles, it->second.middles,
                          2.0 * r.rhoMm * std::sin(0.5 * halfAngle)});
        points += static_cast<std::size_t>(8 * eights);
    }
    for (const Ring& ring : rings_)
        heights_.push_back(ring.z);
    while (heights_.size() % 8 != 0)
        heights_.push_back(heights_.back());
    zeros_.assign(heights_.size(), 0.0);
    axisDistance_.assign(heights_.size(), 0.0f);
    tissue_.assign(points, 0);
    distance_.assign(points, kFarMm);
    gx_.assign(points, 0.0f);
    gy_.assign(points, 0.0f);
    gz_.assign(points, 0.0f);
    live_.assign(points, 0);
    liveRing_.assign(rings_.size(), 0);
    runs_.resize(kMaxRuns);
    candidates_.resize(points);
}

Vec3 RingSensor::pointMm(const Ring& ring, int j) const noexcept {
    const std::size_t a = ring.angles + static_cast<std::size_t>(j);
    return tip_ + ring.z * z_ + ring.rho * (cosines_[a] * x_ + sines_[a] * y_);
}

Vec3 RingSensor::normalAt(std::size_t at) const noexcept {
    const Vec3 g(gx_[at], gy_[at], gz_[at]);
    const double n = g.norm();
    return n > 1e-12 ? Vec3(g / n) : Vec3::Zero();
}

void RingSensor::sense(const core::Pose& burInTooth, double thresholdMm) noexcept {
    const core::Mat3 rotation = burInTooth.orientation.toRotationMatrix();
    tip_ = burInTooth.positionMm;
    x_ = rotation.col(0);
    y_ = rotation.col(1);
    z_ = rotation.col(2);
    FieldRow row;
    row.farOutMm = static_cast<float>(field_.settings().bandOutMm);
    row.farInMm = static_cast<float>(field_.settings().bandInMm);
    store(row.centre, tip_);
    store(row.x, z_);
    store(row.y, Vec3::Zero());
    row.cosines = heights_.data();
    row.sines = zeros_.data();
    // No point of a ring is farther than rho from its middle, and one middle's distance bounds those of its neighbours.
    double clearFrom = 0.0, clearRoom = -1e30;
    for (std::size_t i = 0; i < heights_.size(); i += 8) {
        bool clear = true;
        for (std::size_t k = i; k < std::min(i + 8, rings_.size()) && clear; ++k)
            clear = clearRoom - std::abs(rings_[k].z - clearFrom) - rings_[k].rho > thresholdMm;
        if (clear) {
            std::fill_n(axisDistance_.begin() + static_cast<std::ptrdiff_t>(i), 8, kFarMm);
            continue;
        }
        kernels_.distances(view_, row, static_cast<int>(i), &axisDistance_[i]);
        const std::size_t last = std::min(i + 8, rings_.size()) - 1;
        clearFrom = rings_[last].z;
        clearRoom = axisDistance_[last];
    }
    for (std::size_t i = 0; i < rings_.size(); ++i) {
        const Ring& ring = rings_[i];
        if (liveRing_[i] != 0) {
            std::fill_n(live_.begin() + static_cast<std::ptrdiff_t>(ring.first), 8 * ring.eights, std::uint8_t{0});
            liveRing_[i] = 0;
        }
        if (static_cast<double>(axisDistance_[i]) - ring.rho > thresholdMm) continue;
        store(row.centre, tip_ + ring.z * z_);
        store(row.x, ring.rho * x_);
        store(row.y, ring.rho * y_);
        for (int group = 0; group < ring.eights; group += 8) {
            float middles[8] = {};
            if (ring.eights > 1) {
                row.cosines = &cosines_[ring.middles];
                row.sines = &sines_[ring.middles];
                kernels_.distances(view_, row, group, middles);
            }
            row.cosines = &cosines_[ring.angles];
            row.sines = &sines_[ring.angles];
            for (int e = group; e < std::min(group + 8, ring.eights); ++e)
                if (ring.eights == 1 || static_cast<double>(middles[e - group]) - ring.chordMm <= thresholdMm)
                    senseEight(i, row, e, thresholdMm);
        }
    }
}

void RingSensor::senseEight(std::size_t i, const FieldRow& row, int e, double thresholdMm) noexcept {
    const Ring& ring = rings_[i];
    FieldEight eight;
    kernels_.gradients(view_, row, 8 * e, eight);
    const std::size_t first = ring.first + static_cast<std::size_t>(8 * e);
    const int lanes = std::min(8, ring.count - 8 * e);
    const auto threshold = static_cast<float>(thresholdMm);
    std::uint8_t any = 0;
    for (int lane = 0; lane < 8; ++lane) {
        const std::uint8_t near = lane < lanes && eight.distance[lane] <= threshold ? 1 : 0;
        live_[first + static_cast<std::size_t>(lane)] = near;
        any |= near;
    }
    if (any == 0) return;
    liveRing_[i] = 1;
    std::copy_n(eight.distance, 8, &distance_[first]);
    std::copy_n(eight.x, 8, &gx_[first]);
    std::copy_n(eight.y, 8, &gy_[first]);
    std::copy_n(eight.z, 8, &gz_[first]);
    std::copy_n(eight.tissue, 8, &tissue_[first]);
}

tooth::Tissue RingSensor::tissueAt(const Ring& ring, int j) const noexcept {
    const std::uint8_t tissue = tissue_[ring.first + static_cast<std::size_t>(j)];
    return tissue != kDeepTissue ? static_cast<tooth::Tissue>(tissue) : field_.tissueAt(pointMm(ring, j));
}

std::int32_t RingSensor::rootOf(std::int32_t run) noexcept {
    while (runs_[static_cast<std::size_t>(run)].root != run) {
        auto& r = runs_[static_cast<std::size_t>(run)].root;
        r = runs_[static_cast<std::size_t>(r)].root;
        run = r;
    }
    return run;
}

void RingSensor::joinRuns(std::size_t begin, std::size_t middle, std::size_t end) noexcept {
    const auto join = [&](std::size_t a, std::size_t b) {
        const std::int32_t ra = rootOf(static_cast<std::int32_t>(a)), rb = rootOf(static_cast<std::int32_t>(b));
        if (ra != rb) runs_[static_cast<std::size_t>(std::max(ra, rb))].root = std::min(ra, rb);
    };
    for (std::size_t b = middle; b < end; ++b)
        for (std::size_t a = begin; a < middle; ++a) {
            const Run &first = runs_[a], &second = runs_[b];
            const std::int64_t n = rings_[static_cast<std::size_t>(first.ring)].count;
            const std::int64_t m = rings_[static_cast<std::size_t>(second.ring)].count;
            // Arcs [from / n, to / n) and [from / m, to / m) share an angle; rings of one point are everywhere.
            if (first.from * m < second.to * n && second.from * n < first.to * m) join(a, b);
        }
    // Around the ring's seam.
    if (end > middle + 1) {
        const Run &first = runs_[middle], &last = runs_[end - 1];
        if (first.from == 0 && last.to == rings_[static_cast<std::size_t>(last.ring)].count) join(middle, end - 1);
    }
}

std::size_t RingSensor::findRuns() noexcept {
    std::size_t count = 0, previousBegin = 0;
    std::int32_t previousRing = -2;
    for (std::size_t i = 0; i < rings_.size(); ++i) {
        if (liveRing_[i] == 0) continue;
        const Ring& ring = rings_[i];
        const std::size_t begin = count;
        for (int j = 0; j < ring.count;) {
            if (live_[ring.first + static_cast<std::size_t>(j)] == 0) {
                ++j;
                continue;
            }
            const int from = j;
            while (j < ring.count && live_[ring.first + static_cast<std::size_t>(j)] != 0)
                ++j;
            if (count == kMaxRuns) return count;
            runs_[count] = {static_cast<std::int32_t>(i), from, j, static_cast<std::int32_t>(count)};
            ++count;
        }
        joinRuns(previousRing + 1 == static_cast<std::int32_t>(i) ? previousBegin : begin, begin, count);
        previousBegin = begin;
        previousRing = static_cast<std::int32_t>(i);
    }
    return count;
}

void RingSensor::patches(const core::Pose& burInTooth, PatchSet& out) noexcept {
    out = PatchSet{};
    if (!burInTooth.isValid()) {
        out.status = Status::invalidPose;
        return;
    }
    sense(burInTooth, kContactMarginMm);
    const std::size_t runs = findRuns();
    if (runs == kMaxRuns) out.status = Status::truncated;

    struct Sums {
        std::int32_t root;
        double area = 0.0, pressure = 0.0, deepest = 0.0;
        Vec3 centre = Vec3::Zero(), normal = Vec3::Zero();
        std::array<double, tooth::kTissueCount> tissue{};
    };
    constexpr std::size_t kSums = 2 * kMaxPatches;
    std::array<Sums, kSums> sums;
    std::size_t count = 0;
    double pressure = 0.0;
    for (std::size_t r = 0; r < runs; ++r) {
        const Run& run = runs_[r];
        const std::int32_t root = rootOf(static_cast<std::int32_t>(r));
        std::size_t s = 0;
        while (s < count && sums[s].root != root)
            ++s;
        if (s == count) {
            if (count == kSums) {
                out.status = Status::truncated;
                continue;
            }
            sums[count] = Sums{};
            sums[count++].root = root;
        }
        Sums& sum = sums[s];
        const Ring& ring = rings_[static_cast<std::size_t>(run.ring)];
        double total = 0.0, alongX = 0.0, alongY = 0.0;
        Vec3 normal = Vec3::Zero();
        for (int j = run.from; j < run.to; ++j) {
            const std::size_t at = ring.first + static_cast<std::size_t>(j),
                              angle = ring.angles + static_cast<std::size_t>(j);
            const double gap = distance_[at], share = kContactMarginMm - gap;
            total += share;
            alongX += share * cosines_[angle];
            alongY += share * sines_[angle];
            normal += share * Vec3(gx_[at], gy_[at], gz_[at]);
            sum.deepest = std::max(sum.deepest, -gap);
            sum.tissue[static_cast<std::size_t>(tissueAt(ring, j))] += ring.area * share;
        }
        sum.area += ring.area * (run.to - run.from);
        sum.pressure += ring.area * total;
        sum.centre += ring.area * (total * (tip_ + ring.z * z_) + ring.rho * (alongX * x_ + alongY * y_));
        sum.normal += ring.area * normal;
    }
    for (std::size_t s = 0; s < count; ++s) {
        out.areaMm2 += sums[s].area;
        pressure += sums[s].pressure;
        for (std::size_t t = 0; t < tooth::kTissueCount; ++t)
            out.tissueShare[t] += sums[s].tissue[t];
    }
    if (!(pressure > 0.0)) return;
    for (double& share : out.tissueShare)
        share /= pressure;
    std::sort(sums.begin(), sums.begin() + static_cast<std::ptrdiff_t>(count), [](const Sums& a, const Sums& b) {
        return a.pressure != b.pressure ? a.pressure > b.pressure : a.root < b.root;
    });
    for (std::size_t s = 0; s < count; ++s) {
        const Sums& sum = sums[s];
        if (!(sum.pressure > 0.0)) continue;
        const double n = sum.normal.norm();
        const auto most = std::max_element(sum.tissue.begin(), sum.tissue.end()) - sum.tissue.begin();
        if (!out.patches.pushBack({sum.centre / sum.pressure, n > 1e-12 ? Vec3(sum.normal / n) : Vec3::Zero(), sum.area,
                                   sum.deepest, sum.pressure / pressure, static_cast<tooth::Tissue>(most)}))
            out.status = Status::truncated;
    }
}

bool RingSensor::isLocalMinimum(std::size_t i, int j) const noexcept {
    const Ring& ring = rings_[i];
    const float own = distance_[ring.first + static_cast<std::size_t>(j)];
    // Of equal neighbours the first one counts.
    const auto below = [&](const Ring& other, int k, bool before) {
        const std::size_t at = other.first + static_cast<std::size_t>(k);
        return live_[at] != 0 && (distance_[at] < own || (before && distance_[at] == own));
    };
    const int left = j == 0 ? ring.count - 1 : j - 1, right = j + 1 == ring.count ? 0 : j + 1;
    if (ring.count > 1 && (below(ring, left, left < j) || below(ring, right, right < j))) return false;
    for (int side = -1; side <= 1; side += 2) {
        if ((side < 0 && i == 0) || (side > 0 && i + 1 == rings_.size())) continue;
        const Ring& other = rings_[side < 0 ? i - 1 : i + 1];
        const int from = (j * other.count) / ring.count, to = ((j + 1) * other.count - 1) / ring.count;
        for (int k = from; k <= to && k < other.count; ++k)
            if (below(other, k, side < 0)) return false;
    }
    return true;
}

Status RingSensor::constraints(const core::Pose& burInTooth, double reachMm, ConstraintSet& out) noexcept {
    out.clear();
    if (!burInTooth.isValid()) return Status::invalidPose;
    sense(burInTooth, reachMm);
    // Every local minimum of the gap, then the nearest point of each sector of a few rings: walls, slots, rims and
    // edges are all seen, and the whole stays well spread.
    constexpr int kRingsPerBlock = 3;
    std::size_t minima = 0, count = 0;
    std::array<std::uint32_t, kSectors> sector;
    const auto pointOf = [this](std::uint32_t packed) -> std::pair<const Ring&, int> {
        const Ring& ring = rings_[packed >> 16];
        return {ring, static_cast<int>(packed & 0xffffu)};
    };
    const auto gapOf = [&](std::uint32_t packed) {
        const auto [ring, j] = pointOf(packed);
        return distance_[ring.first + static_cast<std::size_t>(j)];
    };
    for (std::size_t i = 0; i < rings_.size(); ++i) {
        if (liveRing_[i] == 0) continue;
        const Ring& ring = rings_[i];
        for (int j = 0; j < ring.count; ++j)
            if (live_[ring.first + static_cast<std::size_t>(j)] != 0 && isLocalMinimum(i, j))
                candidates_[count++] = static_cast<std::uint32_t>(i << 16 | static_cast<std::size_t>(j));
    }
    const auto nearer = [&](std::uint32_t a, std::uint32_t b) {
        const float ga = gapOf(a), gb = gapOf(b);
        return ga != gb ? ga < gb : a < b;
    };
    std::sort(candidates_.begin(), candidates_.begin() + static_cast<std::ptrdiff_t>(count), nearer);
    minima = std::min(count, kMaxConstraints);
    count = minima;
    constexpr std::uint32_t kNone = 0xffffffffu;
    for (std::size_t block = 0; block < rings_.size(); block += kRingsPerBlock) {
        sector.fill(kNone);
        for (std::size_t i = block; i < std::min(rings_.size(), block + kRingsPerBlock); ++i) {
            if (liveRing_[i] == 0) continue;
            const Ring& ring = rings_[i];
            for (int j = 0; j < ring.count; ++j) {
                if (live_[ring.first + static_cast<std::size_t>(j)] == 0) continue;
                const auto packed = static_cast<std::uint32_t>(i << 16 | static_cast<std::size_t>(j));
                std::uint32_t& best = sector[static_cast<std::size_t>(j * kSectors / ring.count)];
                if (best == kNone || nearer(packed, best)) best = packed;
            }
        }
        for (const std::uint32_t packed : sector) {
            if (packed == kNone || count == candidates_.size()) continue;
            if (std::find(candidates_.begin(), candidates_.begin() + static_cast<std::ptrdiff_t>(minima), packed) ==
                candidates_.begin() + static_cast<std::ptrdiff_t>(minima))
                candidates_[count++] = packed;
        }
    }
    std::sort(candidates_.begin() + static_cast<std::ptrdiff_t>(minima),
              candidates_.begin() + static_cast<std::ptrdiff_t>(count), nearer);
    for (std::size_t c = 0; c < std::min(count, kMaxConstraints); ++c) {
        const auto [ring, j] = pointOf(candidates_[c]);
        const std::size_t at = ring.first + static_cast<std::size_t>(j);
        const Vec3 normal = normalAt(at);
        if (normal.isZero()) continue;  // deeper than the field's band: no direction is known there
        const Vec3 p = pointMm(ring, j);
        out.pushBack({normal, static_cast<double>(distance_[at]), p, tissueAt(ring, j)});
    }
    return count > kMaxConstraints ? Status::truncated : Status::ok;
}

}  // namespace handpiece::contact
