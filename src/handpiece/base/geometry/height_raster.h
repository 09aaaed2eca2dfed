// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Heights of a surface over a square grid, as it is seen from above.

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/vec.h"

namespace handpiece::geometry {

/// The nodes (x, y), 0 to columns - 1 and 0 to rows - 1, that lie under a triangle which looks up, its corners counted
/// in nodes across: visit(x, y, height). Nodes on an edge are under both triangles beside it.
template <class Visit>
void heightsUnder(const core::Vec3& a, const core::Vec3& b, const core::Vec3& c, int columns, int rows,
                  const Visit& visit) {
    constexpr double kEdge = 1e-9;
    const double area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    if (area < 1e-9) return;
    const int x0 = std::max(0, static_cast<int>(std::ceil(std::min({a.x(), b.x(), c.x()})))),
              x1 = std::min(columns - 1, static_cast<int>(std::floor(std::max({a.x(), b.x(), c.x()})))),
              y0 = std::max(0, static_cast<int>(std::ceil(std::min({a.y(), b.y(), c.y()})))),
              y1 = std::min(rows - 1, static_cast<int>(std::floor(std::max({a.y(), b.y(), c.y()}))));
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const double u = ((b.x() - x) * (c.y() - y) - (b.y() - y) * (c.x() - x)) / area,
                         v = ((c.x() - x) * (a.y() - y) - (c.y() - y) * (a.x() - x)) / area;
            if (u < -kEdge || v < -kEdge || u + v > 1.0 + kEdge) continue;
            visit(x, y, u * a.z() + v * b.z() + (1.0 - u - v) * c.z());
        }
}

}  // namespace handpiece::geometry
