// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The part of the medial region off the bur's axis: sheets, turned about the axis, under sharp rims and corners.
/// Private to this room.

#include <array>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/tick/contact/exact_depth.h"

namespace handpiece::contact {

/// Finds the deepest ball of the sheets: cells that cannot hold it are dropped by exact distances, what is left is
/// climbed.
class SheetSearch {
  public:
    explicit SheetSearch(const instrument::Bur& bur);

    /// Raises `best` to the deepest ball of all sheets. A sheet that cannot beat `best` costs one or two lookups.
    void search(const ExactSurface& surface, const core::Pose& burInTooth, BallDepth& best) noexcept;

  private:
    struct Sheet {
        std::vector<double> u, rho, z, radius;  ///< by ball; u is the length along the curve
        double maxRho = 0.0, steepest = 0.0;    ///< of rho, and of the radius over u
        double centreZ = 0.0, reachMm = 0.0;    ///< its balls lie in the ball of reach about the axis at centreZ
    };
    struct Cell {
        double u, halfU, angle, halfAngle, value, upper;
        std::uint32_t triangle;
    };
    struct Frame {
        core::Vec3 tip, x, y, z;
    };
    /// A ball of a sheet and how its centre and radius change along u and along the arc.
    struct Spot {
        core::Vec3 centre, alongU, alongArc;
        double radius, radiusAlongU, arcPerRad;
    };
    static constexpr std::size_t kMaxCells = 1024;

    [[nodiscard]] Spot spotAt(const Sheet& sheet, const Frame& frame, double u, double angle) const noexcept;
    void searchSheet(const ExactSurface& surface, const Sheet& sheet, const Frame& frame, std::uint32_t seed,
                     BallDepth& best) noexcept;
    void climb(const ExactSurface& surface, const Sheet& sheet, const Frame& frame, double u, double angle,
               std::uint32_t seed, double window, BallDepth& best, double& endU, double& endAngle) const noexcept;

    std::vector<Sheet> sheets_;
    std::vector<Cell> cells_, next_;  ///< of fixed size; filled anew by each search
};

}  // namespace handpiece::contact
