// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Small lit bodies of one colour: what arrows and the mirror's metal are made of. Private to this room.

#include <cstdint>
#include <functional>
#include <vector>

#include "handpiece/senses/view/passes.h"

namespace handpiece::view {

/// Triangles with a normal by vertex, tooth frame.
struct Solid {
    struct Vertex {
        gl::Vec3f placeMm, normal;
    };
    std::vector<Vertex> vertices;
    std::vector<std::uint32_t> indices;

    /// A ring of `around` points about a place, for addRings().
    struct Ring {
        core::Vec3 centreMm, along;  ///< unit: the axis there
        double radiusMm;
        core::Vec3 side;  ///< unit, across `along`: where the first point lies
    };
    /// A body turned about, or drawn along, the rings; a ring of radius 0 closes it. Edges sharper than 40 degrees
    /// along it stay edges.
    void addRings(const std::vector<Ring>& rings, int around);
};

/// Pixels on which these points appear, grown by a few; the whole viewport when one is beside the eye or behind it.
[[nodiscard]] PixelRect rectOf(const Eye& eye, const Viewport& viewport, const std::vector<core::Vec3>& pointsMm);
[[nodiscard]] PixelRect rectOf(const Eye& eye, const Viewport& viewport, const Solid& solid);

/// Draws solids. One per pass.
class SolidDrawer {
  public:
    SolidDrawer();
    /// `metal` 0..1: painted to polished. `hiddenAlpha` above 0: what lies behind other things shines through.
    std::size_t draw(const PassContext& context, const Solid& solid, const gl::Vec3f& srgb, float metal,
                     float hiddenAlpha);

  private:
    gl::Program program_;
    gl::Buffer vertices_, indices_;
    gl::VertexArray array_;
};

}  // namespace handpiece::view
