// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Colours that a scanner saw, beside the mesh whose vertices have them: most meshes have none.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::geometry {

class TriangleTree;
struct NearestPoint;

/// sRGB.
using Colour = std::array<std::uint8_t, 3>;
/// By vertex of the mesh that they stand beside; empty: it has none.
using VertexColours = std::vector<Colour>;

struct ColouredMesh {
    TriangleMesh mesh;
    VertexColours colours{};
};

/// Between the colours of its corners, at the place `nearest` of a triangle of `mesh`, whose tree `tree` is; at a
/// vertex that vertex's own. `colours` has one for each vertex, and `nearest` names a triangle.
[[nodiscard]] Colour colourAt(const TriangleMesh& mesh, const TriangleTree& tree, const VertexColours& colours,
                              const NearestPoint& nearest) noexcept;

/// For each vertex of `to` the colour of the nearest place of `from`: a vertex that both have keeps its own, one that
/// closes a hole gets that of the border. Empty where `colours` is.
[[nodiscard]] VertexColours coloursFrom(const TriangleMesh& from, const VertexColours& colours, const TriangleMesh& to);

/// Throws core::Error unless there is one for each vertex, or none at all.
void requireOneAVertex(const TriangleMesh& mesh, const VertexColours& colours, const std::string& where);

}  // namespace handpiece::geometry
