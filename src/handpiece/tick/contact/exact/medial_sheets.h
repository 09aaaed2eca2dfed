// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The part of a bur's medial region off its axis: sheets, turned about the axis, under sharp rims and corners. Private
/// to this room.

#include <array>
#include <cstdint>
#include <vector>

#include "handpiece/model/instrument/bur.h"

namespace handpiece::contact {

/// What is known of a bur's off-axis medial sheets before any tooth: megabytes for a handpiece's head, so the methods
/// of all teeth share it.
class MedialSheets {
  public:
    explicit MedialSheets(const instrument::Bur& bur);

    /// A circle of the grid's balls.
    struct Row {
        double u, rho, z, radius;
        std::uint32_t first, count;  ///< count is a multiple of 8
        std::uint32_t firstMiddle;   ///< of the middles of its eights
    };
    struct Sheet {
        std::vector<double> u, rho, z, radius;  ///< by ball; u is the length along the curve
        double maxRho = 0.0, maxRadius = 0.0, minRadius = 0.0;
        double centreZ = 0.0, reachMm = 0.0;  ///< its balls lie in the ball of reach about the axis at centreZ
        double centresMm = 0.0;               ///< their centres in the ball of this radius
        double promiseMm = 0.0;               ///< one of them is at least so much deeper than the tooth is at centreZ
        double spacingMm = 0.0;               ///< of the grid's balls, at most
        std::vector<Row> rows;
        std::vector<double> cosine, sine;              ///< by ball of the grid
        std::vector<double> middleCosine, middleSine;  ///< by eight of them; each row's padded to eight middles
        /// Of its cells: as SheetCells has them, and the middle of each on the curve and around.
        std::array<std::vector<float>, 4> cellX, cellY, cellZ;
        std::vector<float> cellLowRadius, cellHighRadius;
        std::vector<double> cellU, cellAngle;
    };
    std::vector<Sheet> searched;
    std::vector<instrument::MedialBall> covered;  ///< balls of sheets that are not searched

    static constexpr std::size_t kMaxGrid = 2048;
    static constexpr double kSpacingMm = 0.09;  ///< of the grid's balls
    /// A sheet that stands out of a ball kept elsewhere by less than this is not searched: depth is then too small by
    /// at most so much. The many blunt corners of a bur from a file are such sheets; rims are not.
    static constexpr double kCoveredMm = 4e-4;

  private:
    static void addGrid(Sheet& sheet);
    static void addCells(Sheet& sheet, double spacing);
};

}  // namespace handpiece::contact
