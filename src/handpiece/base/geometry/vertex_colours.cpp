// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/vertex_colours.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/triangle_tree.h"

namespace handpiece::geometry {
namespace {

using core::Vec3;

/// How much each corner counts for, the first of them by what the others leave.
std::array<double, 3> weightsAt(const TreeTriangle& t, const Vec3& p) noexcept {
    const Vec3 ab(t.ab[0], t.ab[1], t.ab[2]), ac(t.ac[0], t.ac[1], t.ac[2]), ap = p - Vec3(t.a[0], t.a[1], t.a[2]);
    const double bb = ab.dot(ab), bc = ab.dot(ac), cc = ac.dot(ac), pb = ap.dot(ab), pc = ap.dot(ac);
    const double determinant = bb * cc - bc * bc;
    if (!(determinant > 0.0)) return {1.0, 0.0, 0.0};  // no area: any corner is as good
    const double b = std::clamp((cc * pb - bc * pc) / determinant, 0.0, 1.0);
    const double c = std::clamp((bb * pc - bc * pb) / determinant, 0.0, 1.0 - b);
    return {1.0 - b - c, b, c};
}

}  // namespace

Colour colourAt(const TriangleMesh& mesh, const TriangleTree& tree, const VertexColours& colours,
                const NearestPoint& nearest) noexcept {
    const TreeTriangle& triangle = tree.triangles()[nearest.triangle];
    const Triangle& corners = mesh.triangles[triangle.index];
    constexpr std::uint8_t kFirstVertex = 4;
    if (nearest.feature >= kFirstVertex) return colours[corners[nearest.feature - kFirstVertex]];
    const std::array<double, 3> weights = weightsAt(triangle, nearest.pointMm);
    Colour mixed{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        double sum = 0.5;
        for (std::size_t k = 0; k < 3; ++k)
            sum += weights[k] * colours[corners[k]][channel];
        mixed[channel] = static_cast<std::uint8_t>(std::clamp(std::floor(sum), 0.0, 255.0));
    }
    return mixed;
}

VertexColours coloursFrom(const TriangleMesh& from, const VertexColours& colours, const TriangleMesh& to) {
    if (colours.empty()) return {};
    const TriangleTree tree(from);
    VertexColours taken(to.vertices.size());
    core::parallelFor(taken.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v)
            taken[v] = colourAt(from, tree, colours, tree.nearest(to.vertices[v]));
    });
    return taken;
}

void requireOneAVertex(const TriangleMesh& mesh, const VertexColours& colours, const std::string& where) {
    if (!colours.empty() && colours.size() != mesh.vertices.size())
        throw core::Error(fmt::format("{} colours for {} vertices", colours.size(), mesh.vertices.size()), where,
                          "give each vertex its colour, or none");
}

}  // namespace handpiece::geometry
