// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Smoothing of closed surfaces that keeps volumes, and their shells. Private to this room.

#include <cstdint>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::surfacing {

/// The vertices around each vertex of a closed surface.
class Rings {
  public:
    explicit Rings(const geometry::TriangleMesh& mesh);
    [[nodiscard]] const std::uint32_t* begin(std::size_t v) const { return &around_[first_[v]]; }
    [[nodiscard]] const std::uint32_t* end(std::size_t v) const { return around_.data() + first_[v + 1]; }
    [[nodiscard]] std::size_t count(std::size_t v) const { return first_[v + 1] - first_[v]; }

  private:
    std::vector<std::uint32_t> first_, around_;
};

/// Faces joined through vertices.
struct Shells {
    std::vector<std::uint32_t> ofFace;
    std::vector<double> volumeMm3, areaMm2;
};
[[nodiscard]] Shells shellsOf(const geometry::TriangleMesh& mesh);
/// The faces of the shells that `keep` names, with the vertices they use, in their order.
[[nodiscard]] geometry::TriangleMesh keptShells(const geometry::TriangleMesh& mesh, const Shells& shells,
                                                const std::vector<bool>& keep);

/// Unit normals at the vertices, by area.
[[nodiscard]] std::vector<core::Vec3> vertexNormals(const geometry::TriangleMesh& mesh);

/// Sets each shell to its volume by going along the normals, each step by `mostMm` at most. Gives back the longest way.
double setVolumes(geometry::TriangleMesh& mesh, const Shells& shells, const std::vector<double>& wantedMm3,
                  double mostMm);

struct Smoothing {
    int rounds = 0;      ///< of Taubin's shrinking and swelling step
    double reachMm = 0;  ///< how far a vertex may go
};
/// Smooths, sets each shell to the volume of its solid, takes back what made the surface cross itself. The solid's
/// volume is the given mesh's and what bulges between its vertices, by the solid's `normals` there; empty: not known.
void smoothKeepingVolume(geometry::TriangleMesh& mesh, const std::vector<core::Vec3>& normals,
                         const Smoothing& smoothing, const core::Progress& progress);

/// Draws vertices where faces cross each other to the middle of their neighbours until none do. Gives back the farthest
/// way; `left`: pairs of faces that still cross.
double uncross(geometry::TriangleMesh& mesh, std::size_t& left);

}  // namespace handpiece::surfacing
