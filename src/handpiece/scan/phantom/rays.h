// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Parallel rays through the surfaces of a case: which tissue lies along each, exactly. Private to this room.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/case/case.h"
#include "handpiece/scan/volume/volume.h"

namespace handpiece::phantom {

/// A stretch of a ray in one tissue; places are voxel coordinates along i.
struct Stretch {
    double from, to;
    cases::Tissue tissue;  ///< Tissue::none: nothing, left out
    bool isScenery;
};

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
    struct Surface {
        std::string name;
        cases::Tissue tissue;
        int priority;
        enum class Role { outer, part, scenery } role;
        std::unique_ptr<geometry::TriangleTree> tree;  ///< of parts, in voxel coordinates
    };
    /// In voxel coordinates: i as it is, j and k in 1/65536.
    struct Corner {
        double i;
        std::int64_t j, k;
    };
    struct Facet {
        Corner corner[3];
        std::uint32_t surface;
    };
    struct Crossing {
        double at;
        std::uint32_t row;  ///< j * (kRays + 1) + ray
        std::uint16_t surface;
        std::int16_t step;  ///< +1 into the surface, -1 out of it
    };
    void add(const geometry::TriangleMesh& mesh, std::string name, cases::Tissue tissue, int priority,
             Surface::Role role, const core::Pose& toothInScan);
    void cross(const Facet& facet, int k, int ray, std::vector<Crossing>& out) const;
    void follow(int k, std::span<const Crossing> crossings, std::vector<int>& winding, std::vector<Stretch>& out) const;
    void fillGap(int k, std::uint32_t row, double from, double to, const Stretch* before, const Stretch* after,
                 std::vector<Stretch>& out) const;

    volume::Grid grid_;
    std::vector<Surface> surfaces_;
    std::vector<std::uint32_t> byPriority_;  ///< parts, then scenery, the winning ones first
    bool hasOuter_ = false, hasParts_ = false;
    std::vector<Facet> facets_;
    std::vector<std::vector<std::uint32_t>> facetsOfSlice_;
};

}  // namespace handpiece::phantom
