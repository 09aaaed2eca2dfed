// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Lines, planes and waviness of measured points, with plain sums in their order: the same bits everywhere. Private to
/// this room.

#include <span>
#include <vector>

#include "handpiece/assess/measures/measure.h"
#include "handpiece/base/core/vec.h"

namespace handpiece::measures {

/// Least squares of a polynomial: solves the normal equations of `count` unknowns in place (Cholesky); false where the
/// points do not settle them.
[[nodiscard]] bool solveNormal(double* matrix, double* rightSide, int count);

/// y = at + slope (x - middle).
struct Line {
    double middle = 0.0, at = 0.0, slope = 0.0, rms = 0.0;
    bool isFound = false;
    [[nodiscard]] double of(double x) const { return at + slope * (x - middle); }
};
/// Through points (x, y), outliers weighed down (Tukey's biweight, 4.685 standard deviations from the median absolute
/// one, ten rounds: Beaton & Tukey 1974 [recalled]).
[[nodiscard]] Line robustLine(std::span<const core::Vec2> points);

/// z = at + slope . (xy - middle); least squares.
struct Plane {
    core::Vec2 middle = core::Vec2::Zero(), slope = core::Vec2::Zero();
    double at = 0.0, rms = 0.0;
    bool isFound = false;
    [[nodiscard]] double of(double x, double y) const {
        return at + slope.x() * (x - middle.x()) + slope.y() * (y - middle.y());
    }
};
[[nodiscard]] Plane planeThrough(std::span<const core::Vec3> points);

/// Heights z over (x, y), less their waves longer than the cut-off, square to the surface: a Gaussian regression filter
/// of second order (ISO 16610-28, ISO/TS 16610-31 [recalled]), whose constant .7309 passes half of a wave at the
/// cut-off. In parallel. Points whose surroundings settle no surface are left out.
[[nodiscard]] std::vector<double> rough(std::span<const core::Vec3> points, double cutOffMm);

/// Standard deviation of values one after the other, by their differences over `lag` of them: a slow change, which is
/// form, does not count.
[[nodiscard]] double localScatter(std::span<const double> values, std::size_t lag);
/// Root mean square of heights z over (x, y) about their surface of second order; about 0 where they settle none.
[[nodiscard]] double rmsAboutCurve(std::span<const core::Vec3> points);

[[nodiscard]] double medianOf(std::vector<double> values);
/// Share 0..1 of the sorted values lies below, between neighbours linearly. Of none: 0.
[[nodiscard]] double percentile(std::span<const double> sorted, double share);
/// A statistic of kStatistics; sorts. `where`: the index, before sorting, of the value nearest to it.
[[nodiscard]] double statisticOf(std::span<const double> values, std::string_view statistic, std::size_t* where);

}  // namespace handpiece::measures
