// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Polygons of files that hold more than triangles. Only mesh_io*.cpp and repair_base.cpp include it.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::geometry::formats {

/// Cuts polygons into triangles, those that are concave without leaving them. Vertices may come after the polygons that
/// name them: all are cut as fans at first, and looked at when the vertices are there.
class Polygons {
  public:
    /// Concave ones that stay fans, which leave their outline.
    struct Left {
        std::size_t crossing = 0;  ///< they cross themselves
        std::size_t tangled = 0;   ///< what it would take to cut them is out of proportion to the file
        [[nodiscard]] std::size_t count() const { return crossing + tangled; }
    };

    /// Appends corners - 2 triangles; fewer than three corners give none.
    void add(std::vector<Triangle>& triangles, std::span<const std::uint32_t> corners);

    /// Once, when all is read. A convex polygon stays the fan that it was; an edge of a polygon is one of its
    /// triangles' in every case. By ears (Meisters, The American Mathematical Monthly 82, 1975), in the plane of the
    /// two largest axes of the polygon's area (Newell's normal). Work grows with the corners, hardly faster, but for
    /// outlines made to be slow: those are left, by a count of steps and not by a clock.
    [[nodiscard]] Left settle(TriangleMesh& mesh) const;

  private:
    struct Polygon {
        std::size_t triangle, corner, count;
    };
    std::vector<Polygon> polygons_;
    std::vector<std::uint32_t> corners_;
};

}  // namespace handpiece::geometry::formats
