// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The part of the medial region off the bur's axis: sheets, turned about the axis, under sharp rims and corners.
/// Private to this room.

#include <array>
#include <memory>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/tick/contact/bur_frame.h"
#include "handpiece/tick/contact/exact/exact_depth.h"
#include "handpiece/tick/contact/exact/sheet_kernels.h"
#include "handpiece/tick/contact/sampled/field_row.h"

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
        double maxRho = 0.0, maxRadius = 0.0;
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

  private:
    static void addGrid(Sheet& sheet);
    static void addCells(Sheet& sheet, double spacing);
};

/// Finds the deepest ball of the sheets: looked for on a grid of balls in the field, eight at a time, then climbed
/// against the triangles. Where the field holds no distance, balls are measured exactly until the Lipschitz bound drops
/// the rest. Keeps nothing between queries: the answer does not depend on the last one.
class OffAxisMedialSearch {
  public:
    OffAxisMedialSearch(std::shared_ptr<const MedialSheets> sheets, const field::DistanceField& field,
                        core::SimdLevel level);

    /// Whether a ball of a sheet is that deep for sure: a lookup each.
    [[nodiscard]] bool isDeep(const ExactSurface& surface, const BurFrame& frame, double depthMm) const noexcept;
    /// Raises `best` to the deepest ball of all sheets; with `outsideKnown` at least to the deepest of those with their
    /// centres in the tooth. A sheet that cannot beat `best` costs one or two lookups.
    void search(const ExactSurface& surface, const BurFrame& frame, bool outsideKnown, BallDepth& best,
                double& mostMm) noexcept;

  private:
    using Row = MedialSheets::Row;
    using Sheet = MedialSheets::Sheet;
    /// A ball of a sheet and how its centre and radius change along u and along the arc.
    struct Spot {
        core::Vec3 centre, alongU, alongArc;
        double radius, radiusAlongU, arcPerRad;
        double lowU, highU;  ///< of the straight piece of the curve
    };
    /// A top found in the field, or a ball to be measured exactly.
    struct Candidate {
        double value, u, angle;
    };
    struct Unknown {
        core::Vec3 centre;
        double radius, upper, u, angle;
        bool outside;
    };
    static constexpr std::size_t kMaxGrid = MedialSheets::kMaxGrid, kMaxCandidates = 48;
    static constexpr int kMaxClimbs = 6, kMaxMeasured = 24, kMaxKnown = 16;
    /// A triangle near the ball being climbed: what it says of the depth there and how that changes.
    struct Support {
        double value, alongU, alongArc;
    };
    /// Those of them that allow least, the least first.
    struct Model {
        std::array<Support, kMaxKnown> supports;
        int count = 0;
        double arcPerRad = 1.0, lowU = 0.0, highU = 0.0;
    };
    /// Where a climb began and ended.
    struct Top {
        double u, angle, endU, endAngle;
    };

    void scan(const Sheet& sheet, const BurFrame& frame, double atLeast) noexcept;
    [[nodiscard]] Candidate highestOfGrid(const Sheet& sheet) const noexcept;
    void collect(const Sheet& sheet, const BurFrame& frame, double atLeast) noexcept;
    void refine(const Sheet& sheet, const BurFrame& frame, Candidate& candidate) const noexcept;
    void measure(const ExactSurface& surface, const Sheet& sheet, const BurFrame& frame, std::uint32_t& seed,
                 BallDepth& best) noexcept;
    void climbOnce(const ExactSurface& surface, const Sheet& sheet, const BurFrame& frame, const Candidate& from,
                   const BallDepth& here, std::uint32_t& seed, double reach, BallDepth& best) noexcept;
    void askEnds(const ExactSurface& surface, const Sheet& sheet, const BurFrame& frame, double angle,
                 std::uint32_t& seed, BallDepth& best) noexcept;
    [[nodiscard]] Spot spotAt(const Sheet& sheet, const BurFrame& frame, double u, double angle,
                              bool isBelow = false) const noexcept;
    void searchSheet(const ExactSurface& surface, const Sheet& sheet, const BurFrame& frame, std::uint32_t seed,
                     BallDepth& best, double& mostMm) noexcept;
    void climb(const ExactSurface& surface, const Sheet& sheet, const BurFrame& frame, Top& top, BallDepth here,
               double reach, BallDepth& best) noexcept;
    [[nodiscard]] Model modelAt(const ExactSurface& surface, const Sheet& sheet, const BurFrame& frame,
                                const BallDepth& here, double u, double angle, bool isBelow = false) const noexcept;
    /// False when it was known.
    bool remember(std::uint32_t triangle) noexcept;
    void searchDeep(const ExactSurface& surface, const Sheet& sheet, const BurFrame& frame, std::uint32_t seed,
                    BallDepth& best, double& mostMm) noexcept;
    [[nodiscard]] HighestCell lower(const Sheet& sheet, const BurFrame& frame, const core::Vec3& place, double freeMm,
                                    double floorMm) noexcept;
    [[nodiscard]] HighestCell highest(const Sheet& sheet) const noexcept;

    /// True when one of the balls not searched is deeper there.
    bool askCovered(const ExactSurface& surface, const BurFrame& frame, BallDepth& best) const noexcept;

    std::shared_ptr<const MedialSheets> sheets_;
    field::FieldView field_;
    FieldLookup lookup_;
    LowerCells lowerCells_;
    float bandOutMm_, bandInMm_;
    double errorMm_, brickDiagonalMm_;
    double mostOutsideMm_ = 0.0;  ///< balls with their centres farther outside are no concern of this search
    std::vector<float> grid_;     ///< signed distance by ball of the grid; of fixed size, filled anew by each search
    std::array<std::vector<float>, 4> corner_;  ///< how deep a ball could be, by cell: at its corners and anywhere
    std::vector<float> upper_;
    std::array<int, kMaxMeasured> settled_;  ///< cells that were measured
    std::vector<Unknown> unknown_;
    std::size_t unknownCount_ = 0;
    std::array<Candidate, kMaxCandidates> candidates_;
    std::size_t candidateCount_ = 0;
    std::array<Top, kMaxClimbs> tops_;
    int climbs_ = 0;
    std::array<std::uint32_t, kMaxKnown> known_;  ///< triangles that were nearest, of one sheet's search
    int knownCount_ = 0, oldest_ = 0;
};

}  // namespace handpiece::contact
