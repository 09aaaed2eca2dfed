// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Rays of one point of the focal spot through all surfaces of a case. Private to this room.

#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "handpiece/base/geometry/ray_raster.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/case/ray_tissues.h"
#include "handpiece/senses/radiograph/radiograph.h"

namespace handpiece::radiograph {

/// The surfaces of a case that take part, once for all points of the spot.
class Scene {
  public:
    explicit Scene(const cases::Case& toothCase);

    struct Body {
        const geometry::TriangleMesh* mesh;
        core::Pose inCase;
    };
    [[nodiscard]] std::span<const Body> bodies() const { return bodies_; }
    [[nodiscard]] const cases::RayTissues& tissues() const { return *tissues_; }

    /// Tissue of the nearest part of a tooth.
    [[nodiscard]] cases::Tissue nearestPart(std::uint32_t tooth, const core::Vec3& p) const;

  private:
    void addTooth(const cases::Tooth& tooth, const core::Pose& inCase, std::vector<cases::RaySurface>& surfaces);

    /// Made when it is first asked for: most parts have no gap beside them, or lie outside of the picture.
    struct Tree {
        std::once_flag made;
        std::unique_ptr<geometry::TriangleTree> tree;
    };
    std::vector<Body> bodies_;
    std::vector<std::unique_ptr<Tree>> trees_;  ///< of bodies, in their tooth's frame
    std::vector<std::vector<std::uint32_t>> partsOfTooth_;
    std::unique_ptr<cases::RayTissues> tissues_;
};

class Bone;

/// One point of the spot. Where a corner is seen on the detector, and how near to the spot: a triangle's plane is flat
/// in (1 / depth) there, so that rays through the spot are parallel ones.
class Shadow {
  public:
    /// `spotMm`: the point, right and up from the spot's middle; `offset`: of the rays in their pixels, -0.5..0.5.
    Shadow(const Scene& scene, const Bone& bone, const Projection& projection, const core::Vec2& spotMm,
           const core::Vec2& offset);

    /// Path lengths [mm] of row y from the top; visit(column, paths) for each ray that meets anything.
    struct Work {
        std::vector<std::uint32_t> columns, begin;
        std::vector<cases::RayCrossing> found, sorted;
        cases::RayTissues::Work tissues;
        std::vector<cases::RayStretch> stretches;
    };
    using Visit = std::function<void(int column, const Paths& pathsMm)>;
    void row(int y, Work& work, const Visit& visit) const;

  private:
    struct Facet {
        geometry::RayCorner corner[3];
        std::uint32_t surface;
    };
    void fillGap(std::uint32_t tooth, const core::Vec3& along, double from, double to, const cases::RayStretch* before,
                 const cases::RayStretch* after, std::vector<cases::RayStretch>& out) const;

    const Scene& scene_;
    const Bone& bone_;
    const Projection& projection_;
    core::Vec3 spotMm_;  ///< case frame
    std::int64_t shift_[2];
    std::vector<Facet> facets_;
    std::vector<std::uint32_t> rowBegin_, rowFacets_;
};

}  // namespace handpiece::radiograph
