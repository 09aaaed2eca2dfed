// SPDX-License-Identifier: Apache-2.0
// The axial walls and the finish line of a crown preparation, in planes through its axis.
#include <algorithm>
#include <cmath>

#include "handpiece/assess/measures/cut_tooth.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::measures {
namespace {
using core::Vec3;

constexpr double kAxialLevelMm = 0.05;
constexpr double kAxialFarMm = 30.0;
constexpr double kAxialEndMm = 0.002;

}  // namespace

AxialStation CutTooth::axialAt(Look& look, double azimuthRad, const Vec3& axis, double lowW, double highW) const {
    AxialStation station;
    station.azimuthRad = azimuthRad;
    Vec3 h = core::cos(azimuthRad) * frame_.u + core::sin(azimuthRad) * frame_.v;
    Vec3 through = axis;   // of the rays, at w = 0
    double inwards = 0.0;  // so much farther they go: to the axis
    struct Met {
        double r;
        bool isCut;
        Vec3 p, n;
    };
    const auto meets = [&](double w, double cutMm) -> std::optional<Met> {
        const Vec3 from = through + w * frame_.w + kAxialFarMm * h;
        const geometry::RayMeeting met = whole().tree.firstMeeting(from, -h, kAxialFarMm + inwards);
        if (met.triangle == geometry::kNoTriangle) return {};
        double way = met.distanceMm;
        Vec3 p = from - way * h;
        if (look.now(p) >= cutMm) {
            const auto on = look.cast(p, -h, kAxialFarMm + inwards - way);
            if (!on) return {};
            way += *on;
            p = from - way * h;
        }
        const bool isCut = look.before(p) < -kAxialEndMm && way > met.distanceMm;
        return Met{h.dot(p - axis), isCut, p, isCut ? look.normalNow(p) : look.normalBefore(p)};
    };
    for (int pass = 0; pass < 2; ++pass) {
        station.samples.clear();
        station.hasMargin = false;
        double above = highW;
        for (double w = highW - 0.01; w > lowW - 0.5; w -= kAxialLevelMm) {
            const auto met = meets(w, cutMm());
            if (met && met->isCut) {
                station.samples.push_back({w, met->r, met->n});
                above = w;
                continue;
            }
            if (!met || station.samples.empty()) continue;
            // Below it is as it was: the margin lies between. Air counts from a tenth of a voxel on: where it is twice
            // as much says where it begins.
            const auto beginAt = [&](double cut, double high, double low) {
                for (int i = 0; i < 14; ++i) {
                    const double middle = 0.5 * (low + high);
                    const auto there = meets(middle, cut);
                    (there && there->isCut ? high : low) = middle;
                }
                return high;
            };
            const double once = beginAt(cutMm(), above, w), twice = beginAt(2.0 * cutMm(), above + kAxialLevelMm, once);
            station.hasMargin = true;
            station.marginW = once - std::min(twice - once, kAxialLevelMm);
            const double low = station.marginW - 1e-4;
            if (const auto under = meets(low, cutMm())) station.marginMm = under->p;
            break;
        }
        std::reverse(station.samples.begin(), station.samples.end());
        // The axial wall: the longest stretch that is steep.
        std::size_t from = 0, to = 0;
        for (std::size_t i = 0; i < station.samples.size();) {
            std::size_t j = i;
            while (j < station.samples.size() && std::abs(station.samples[j].n.dot(frame_.w)) < 0.5)
                ++j;
            if (j - i > to - from) {
                from = i;
                to = j;
            }
            i = j + 1;
        }
        if (to - from < 6) return station;
        const double wLow = station.samples[from].w, wHigh = station.samples[to - 1].w;
        std::vector<core::Vec2> points;
        Vec3 normal = Vec3::Zero();
        double middleR = 0.0;
        for (std::size_t i = from; i < to; ++i) {
            const WallStation::Sample& s = station.samples[i];
            if (s.w < wLow + 0.25 * (wHigh - wLow) || s.w > wLow + 0.75 * (wHigh - wLow)) continue;
            points.emplace_back(s.w, s.r);
            normal += s.n;
            middleR += s.r;
        }
        if (pass == 0) {
            normal -= normal.dot(frame_.w) * frame_.w;
            if (points.empty() || !(normal.norm() > 1e-9)) return station;
            const Vec3 square = normal.normalized();
            if (square.dot(h) < kSin45) return station;
            inwards = middleR / static_cast<double>(points.size());
            through = axis + inwards * h;
            h = square;
            continue;
        }
        station.h = h;
        station.side = sideOf(p_.axes, h);
        station.middle = robustLine(points);
        if (!station.middle.isFound || !station.hasMargin) continue;
        const double slope = station.middle.slope;
        station.widthMm =
            (h.dot(station.marginMm - axis) - station.middle.of(station.marginW)) / std::sqrt(1.0 + slope * slope);
        // Up to where the wall turns into the occlusal surface.
        double low = wHigh, high = highW;
        for (double w = wHigh; w < highW; w += kAxialLevelMm) {
            const auto met = meets(w, cutMm());
            if (!met || !met->isCut || std::abs(met->n.dot(frame_.w)) > kSin45) {
                high = w;
                break;
            }
            low = w;
        }
        for (int i = 0; i < 12; ++i) {
            const double middle = 0.5 * (low + high);
            const auto met = meets(middle, cutMm());
            (met && met->isCut && std::abs(met->n.dot(frame_.w)) <= kSin45 ? low : high) = middle;
        }
        station.topW = low;
    }
    return station;
}

const std::vector<AxialStation>& CutTooth::axialWalls() {
    if (axial_) return *axial_;
    std::vector<AxialStation> stations(kAzimuths);
    Vec3 axis = Vec3::Zero();
    double area = 0.0, lowW = 1e300, highW = -1e300;
    for (const SurfacePoint& point : cutPoints()) {
        axis += point.areaMm2 * point.p;
        area += point.areaMm2;
        lowW = std::min(lowW, frame_.w.dot(point.p));
        highW = std::max(highW, frame_.w.dot(point.p));
    }
    if (area > 0.0) {
        axis /= area;
        axis -= axis.dot(frame_.w) * frame_.w;
        core::parallelFor(stations.size(), 2, [&](std::size_t begin, std::size_t end) {
            Look look(*this);
            for (std::size_t i = begin; i < end; ++i)
                stations[i] = axialAt(look, 6.283185307179586 * static_cast<double>(i) / kAzimuths, axis, lowW, highW);
        });
    }
    axial_ = std::move(stations);
    return *axial_;
}

}  // namespace handpiece::measures
