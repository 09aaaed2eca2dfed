// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a scan's mesh is asked, and how it is made fit to be asked. Private to this room.

#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/base/geometry/triangle_tree.h"

namespace handpiece::scan_work {

using core::Vec3;
using geometry::TriangleMesh;
using geometry::TriangleTree;

inline constexpr double kSmoothMm = 0.2;  ///< reach of the filter against the scanner's noise, and of even normals

/// Faces that name three vertices; vertices that faces name.
[[nodiscard]] TriangleMesh kept(const TriangleMesh& mesh, const std::vector<char>& keepFace);
/// Those whose three vertices are kept.
[[nodiscard]] TriangleMesh keptVertices(const TriangleMesh& mesh, const std::vector<char>& keepVertex);
/// Vertices at the same place are one, faces that stand against their neighbours turned with them, all of it outwards
/// as far as its shape tells, closer points than a field needs gathered, and holes with less than kHoleMm around
/// closed.
[[nodiscard]] TriangleMesh tidied(TriangleMesh mesh);
inline constexpr double kHoleMm = 6.0;
/// Every face the other way round.
[[nodiscard]] TriangleMesh turned(TriangleMesh mesh);

/// A third of the area of the faces about each vertex.
[[nodiscard]] std::vector<double> vertexAreas(const TriangleMesh& mesh);
/// Signed distance of each vertex to a tree's surface, negative in it [mm].
[[nodiscard]] std::vector<double> distancesTo(const TriangleTree& surface, const TriangleMesh& mesh);

/// Root of the mean square, by area, of those asked for.
struct Spread {
    double rmsMm = 0.0, areaMm2 = 0.0;
};
[[nodiscard]] Spread spreadOf(const std::vector<double>& distances, const std::vector<double>& areas,
                              const std::vector<char>& asked);

/// Vertices by cell, for neighbours within a reach.
class Cells {
  public:
    Cells(const std::vector<Vec3>& points, double mm) : points_(points), mm_(mm) {
        for (std::uint32_t i = 0; i < points.size(); ++i)
            cells_[keyOf(cellOf(points[i]))].push_back(i);
    }
    template <class Visit>
    void around(const Vec3& p, const Visit& visit) const {
        const std::array<std::int64_t, 3> c = cellOf(p);
        for (std::int64_t z = c[2] - 1; z <= c[2] + 1; ++z)
            for (std::int64_t y = c[1] - 1; y <= c[1] + 1; ++y)
                for (std::int64_t x = c[0] - 1; x <= c[0] + 1; ++x)
                    if (const auto at = cells_.find(keyOf({x, y, z})); at != cells_.end())
                        for (const std::uint32_t i : at->second)
                            if ((points_[i] - p).squaredNorm() < mm_ * mm_) visit(i);
    }

  private:
    [[nodiscard]] std::array<std::int64_t, 3> cellOf(const Vec3& p) const {
        return {static_cast<std::int64_t>(std::floor(p.x() / mm_)), static_cast<std::int64_t>(std::floor(p.y() / mm_)),
                static_cast<std::int64_t>(std::floor(p.z() / mm_))};
    }
    static std::int64_t keyOf(const std::array<std::int64_t, 3>& c) {
        constexpr std::int64_t kHalf = 1 << 20;
        return ((c[0] + kHalf) << 42) ^ ((c[1] + kHalf) << 21) ^ (c[2] + kHalf);
    }
    const std::vector<Vec3>& points_;
    double mm_;
    std::unordered_map<std::int64_t, std::vector<std::uint32_t>> cells_;
};

[[nodiscard]] inline Vec3 unit(const Vec3& n) {
    return n.norm() > 1e-300 ? Vec3(n.normalized()) : Vec3(Vec3::Zero());
}
/// Twice the area long, of each face.
[[nodiscard]] std::vector<Vec3> faceNormals(const TriangleMesh& mesh);
/// Unit normals of vertices, from all that lies within reach and looks about the same way: across an edge the mean
/// would be of neither side.
[[nodiscard]] std::vector<Vec3> evenNormals(const TriangleMesh& mesh, const std::vector<Vec3>& faces,
                                            const Cells& cells);
/// Faces that noise has turned against what lies around them.
[[nodiscard]] std::vector<char> foldedFaces(const TriangleMesh& mesh, const std::vector<Vec3>& faces,
                                            const std::vector<Vec3>& even);

/// Noise taken off along the normals, edges left: a bilateral filter (Fleishman, Drori & Cohen-Or 2003) whose two
/// weights are biweights instead of Gaussians. What stands off by more than 3.5 times the noise is shape. Vertices of
/// folded faces also go along the surface, between their neighbours.
[[nodiscard]] TriangleMesh smoothed(TriangleMesh mesh, double noiseMm);

}  // namespace handpiece::scan_work
