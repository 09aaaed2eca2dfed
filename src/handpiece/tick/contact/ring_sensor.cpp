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
    std::map<std::uint32_t, std::size_t> angles;
    std::size_t points = 0;
    for (const instrument::SurfaceRing& r : bur.rings()) {
        if (r.count == 0) continue;
        const auto [it, added] = angles.try_emplace(r.count, cosines_.size());
        const int count = static_cast<int>(r.count), eights = (count + 7) / 8;
        if (added)
            for (int j = 0; j < 8 * eights; ++j) {  // the padding repeats the last point
                const double angle = 2.0 * std::numbers::pi * (std::min(j, count - 1) + 0.5) / count;
                cosines_.push_back(std::cos(angle));
                sines_.push_back(std::sin(angle));
            }
        rings_.push_back({r.zMm, r.rhoMm, r.areaMm2, count, eights, points, it->second,
                          std::min(std::numbers::pi, 3.5 * 2.0 * std::numbers::pi / count)});
        points += static_cast<std::size_t>(8 * eights);
    }
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
    const double outMm = field_.settings().bandOutMm, inMm = field_.settings().bandInMm;
    double axisAt = 0.0, axisDistance = -1e30;  // the last lookup on the bur's axis
    FieldRow row;
    row.farOutMm = static_cast<float>(outMm);
    row.farInMm = static_cast<float>(inMm);
    for (std::size_t i = 0; i < rings_.size(); ++i) {
        const Ring& ring = rings_[i];
        if (liveRing_[i] != 0) {
            std::fill_n(live_.begin() + static_cast<std::ptrdiff_t>(ring.first), 8 * ring.eights, std::uint8_t{0});
            liveRing_[i] = 0;
        }
        // No point of the ring is farther than rho from the axis, and the last lookup bounds the axis around it.
        if (axisDistance - std::abs(ring.z - axisAt) - ring.rho > thresholdMm) continue;
        const Vec3 centre = tip_ + ring.z * z_;
        axisAt = ring.z;
        axisDistance = field_.distance(centre);
        if (axisDistance - ring.rho > thresholdMm) continue;
        store(row.centre, centre);
        store(row.x, ring.rho * x_);
        store(row.y, ring.rho * y_);
        row.cosines = &cosines_[ring.angles];
        row.sines = &sines_[ring.angles];
        const double chord = 2.0 * ring.rho * std::sin(0.5 * ring.halfEightRad);
        for (int e = 0; e < ring.eights; ++e) {
            if (ring.eights > 1) {
                const double angle = 2.0 * std::numbers::pi * (8 * e + 4) / ring.count;
                const Vec3 middle = centre + ring.rho * (std::cos(angle) * x_ + std::sin(angle) * y_);
                if (field_.distance(middle) - chord > thresholdMm) continue;
            }
            FieldEight eight;
            kernels_.gradients(view_, row, 8 * e, eight);
            const int lanes = std::min(8, ring.count - 8 * e);
            for (int lane = 0; lane < lanes; ++lane) {
                if (!(eight.distance[lane] <= thresholdMm)) continue;
                const std::size_t at = ring.first + static_cast<std::size_t>(8 * e + lane);
                live_[at] = 1;
                liveRing_[i] = 1;
                distance_[at] = eight.distance[lane];
                gx_[at] = eight.x[lane];
                gy_[at] = eight.y[lane];
                gz_[at] = eight.z[lane];
            }
        }
    }
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
        for (int j = run.from; j < run.to; ++j) {
            const std::size_t at = ring.first + static_cast<std::size_t>(j);
            const double share = ring.area * (kContactMarginMm - static_cast<double>(distance_[at]));
            const Vec3 p = pointMm(ring, j);
            sum.area += ring.area;
            sum.pressure += share;
            sum.centre += share * p;
            sum.normal += share * normalAt(at);
            sum.deepest = std::max(sum.deepest, -static_cast<double>(distance_[at]));
            sum.tissue[static_cast<std::size_t>(field_.tissueAt(p))] += share;
        }
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
        out.pushBack({normal, static_cast<double>(distance_[at]), p, field_.tissueAt(p)});
    }
    return count > kMaxConstraints ? Status::truncated : Status::ok;
}

}  // namespace handpiece::contact
