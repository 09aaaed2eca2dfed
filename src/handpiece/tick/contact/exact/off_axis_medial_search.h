// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The deepest place of a bur's medial sheets in a tooth. Private to this room.

#include <array>
#include <memory>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/tick/contact/bur_frame.h"
#include "handpiece/tick/contact/exact/exact_depth.h"
#include "handpiece/tick/contact/exact/medial_sheets.h"
#include "handpiece/tick/contact/exact/sheet_kernels.h"
#include "handpiece/tick/contact/sampled/field_row.h"

namespace handpiece::contact {

/// Finds the deepest ball of the sheets: looked for on a grid of balls in the field, eight at a time, then climbed
/// against the triangles. Where the field holds no distance, balls are measured exactly until the Lipschitz bound drops
/// the rest. Keeps nothing between queries: the answer does not depend on the last one.
class OffAxisMedialSearch {
  public:
    OffAxisMedialSearch(std::shared_ptr<const MedialSheets> sheets, const field::DistanceField& field,
                        core::SimdLevel level);

    /// False where the axis says all, to within kCoveredMm.
    [[nodiscard]] bool isAny() const noexcept { return !sheets_->searched.empty(); }
    /// Whether a ball of a sheet is that deep for sure: a lookup each.
    [[nodiscard]] bool isDeep(const ExactSurface& surface, const BurFrame& frame, double depthMm) const noexcept;
    /// Raises `best` to the deepest ball of all sheets; with `outsideKnown` at least to the deepest of those with their
    /// centres in the tooth, none of which is larger than `largestMm`. A sheet that cannot beat `best` costs one or two
    /// lookups.
    void search(const ExactSurface& surface, const BurFrame& frame, bool outsideKnown, double largestMm,
                BallDepth& best, double& mostMm) noexcept;

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
    static constexpr std::size_t kMaxCandidates = 48;
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
    double mostRadiusMm_ = 0.0;   ///< of balls that this search looks at
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
