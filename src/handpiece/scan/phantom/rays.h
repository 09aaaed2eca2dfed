// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Parallel rays through the surfaces of a case: which tissue lies along each, exactly. Private to this room.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "handpiece/base/geometry/ray_raster.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/case/ray_tissues.h"
#include "handpiece/scan/volume/volume.h"

namespace handpiece::phantom {

/// Places are voxel coordinates along i.
using Stretch = cases::RayStretch;

/// Where in a voxel's face the rays of a row pass: one through its middle (ray 0), then kRays that share the face
/// evenly, a Fibonacci lattice, so that a wall along an axis meets them one after the other.
inline constexpr int kRays = 34;

/// The surfaces of a case laid on a grid. Const, any thread. Corners are rounded to 1/65536 of a voxel across the rays,
/// so that whether a ray meets a triangle is decided in whole numbers and no ray slips through a closed surface.
class Rays {
  public:
    /// `poseInGrid` maps the case's frame to the scanner's. Throws core::Error when there is nothing, or too much.
    Rays(const cases::Case& toothCase, const core::Pose& toothInScan, const volume::Grid& grid, bool scenery);

    /// Calls visit for every ray of slice k that meets anything: row j, ray 0..kRays, stretches at rising places that
    /// do not overlap. Throws core::Error when a surface proves open.
    using Visit = std::function<void(int row, int ray, std::span<const Stretch>)>;
    void slice(int k, bool middles, bool lattice, const Visit& visit) const;

  private:
    struct Facet {
        geometry::RayCorner corner[3];  ///< in voxel coordinates: i as it is, j and k in 1/65536
        std::uint32_t surface;
    };
    struct Crossing {
        std::uint32_t row;  ///< j * (kRays + 1) + ray
        cases::RayCrossing crossing;
    };
    void add(const geometry::TriangleMesh& mesh, cases::RaySurface surface, const core::Pose& toothInScan);
    void cross(const Facet& facet, int k, int ray, std::vector<Crossing>& out) const;
    void fillGap(int k, std::uint32_t row, double from, double to, const Stretch* before, const Stretch* after,
                 std::vector<Stretch>& out) const;

    volume::Grid grid_;
    std::vector<cases::RaySurface> surfaces_;
    std::vector<std::unique_ptr<geometry::TriangleTree>> trees_;  ///< of parts, in voxel coordinates; else null
    std::unique_ptr<cases::RayTissues> tissues_;
    std::vector<Facet> facets_;
    std::vector<std::vector<std::uint32_t>> facetsOfSlice_;
};

}  // namespace handpiece::phantom
