// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where parallel rays meet a triangle, decided in whole numbers: no ray slips through a closed surface, and none meets
/// it twice at an edge. Rays through one point become parallel when corners are projected along them.

#include <algorithm>
#include <cstdint>
#include <utility>

namespace handpiece::geometry {

/// A corner as the rays see it: along them as it is, across them in whole units.
struct RayCorner {
    double along = 0.0;
    std::int64_t j = 0, k = 0;
};

[[nodiscard]] constexpr std::int64_t floorDivide(std::int64_t a, std::int64_t b) noexcept {
    return a >= 0 ? a / b : -((-a + b - 1) / b);
}
[[nodiscard]] constexpr std::int64_t ceilDivide(std::int64_t a, std::int64_t b) noexcept {
    return -floorDivide(-a, b);
}

/// The rays at (row * units + shift, k), row from 0 to rows - 1, that meet a triangle: visit(row, along, step), step +1
/// where rays of rising `along` enter what lies behind a counter-clockwise face (j, k and `along` right-handed), -1
/// where they leave. Corners may lie up to 2^31 units apart.
template <class Visit>
void crossRays(const RayCorner (&corner)[3], std::int64_t k, std::int64_t shift, std::int64_t units, std::int64_t rows,
               const Visit& visit) {
    const RayCorner* a = &corner[0];
    const RayCorner* b = &corner[1];
    const RayCorner* c = &corner[2];
    const auto [lowK, highK] = std::minmax({a->k, b->k, c->k});
    if (k < lowK || k > highK) return;
    const auto [lowJ, highJ] = std::minmax({a->j, b->j, c->j});
    const std::int64_t first = std::max<std::int64_t>(0, ceilDivide(lowJ - shift, units));
    const std::int64_t last = std::min<std::int64_t>(rows - 1, floorDivide(highJ - shift, units));
    if (first > last) return;
    const auto area = [](const RayCorner& p, const RayCorner& q, std::int64_t j, std::int64_t kk) {
        return (q.j - p.j) * (kk - p.k) - (q.k - p.k) * (j - p.j);
    };
    std::int64_t whole = area(*a, *b, c->j, c->k);
    if (whole == 0) return;
    const int step = whole > 0 ? -1 : 1;
    if (whole < 0) {
        std::swap(b, c);
        whole = -whole;
    }
    // A ray through an edge belongs to one side of it, whichever triangle asks.
    const auto isIn = [](const RayCorner& p, const RayCorner& q, std::int64_t value) {
        return value > 0 || (value == 0 && (q.k > p.k || (q.k == p.k && q.j < p.j)));
    };
    for (std::int64_t row = first; row <= last; ++row) {
        const std::int64_t j = row * units + shift;
        const std::int64_t ofC = area(*a, *b, j, k), ofA = area(*b, *c, j, k), ofB = area(*c, *a, j, k);
        if (!isIn(*a, *b, ofC) || !isIn(*b, *c, ofA) || !isIn(*c, *a, ofB)) continue;
        visit(row,
              (static_cast<double>(ofA) * a->along + static_cast<double>(ofB) * b->along +
               static_cast<double>(ofC) * c->along) /
                  static_cast<double>(whole),
              step);
    }
}

}  // namespace handpiece::geometry
