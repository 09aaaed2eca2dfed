// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Takes a bur's envelope away from a field, swept from pose to pose.

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/simd.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/tooth/tooth_state.h"
#include "handpiece/tick/contact/bur_frame.h"
#include "handpiece/tick/cutting/outline_table.h"

namespace handpiece::cutting {

/// Every node rises to minus its distance to the bur, at each pose on the way. The bounds of bricks that are not stored
/// follow once in half a brick of movement.
///
/// Allocates at construction alone. One thread, that of the field.
class Sweeper {
  public:
    Sweeper(tooth::ToothState& field, const instrument::Bur& bur, core::SimdLevel level);

    struct Outcome {
        tooth::TissueVolumes removedMm3{};
        std::uint32_t changedBricks = 0;  ///< a brick counts once a pose
        std::uint32_t poses = 0;
    };
    /// Cuts at `to`, and on the way there from the last pose, if there is one.
    Outcome sweepTo(const core::Pose& to) noexcept HANDPIECE_REALTIME;
    /// Brings up the bounds, and forgets the pose and all that is known of the field: the next sweep starts where it
    /// starts. To be called before anybody else changes the field (undo).
    void settle() noexcept HANDPIECE_REALTIME;
    [[nodiscard]] bool hasPose() const noexcept { return hasPose_; }
    [[nodiscard]] const core::Pose& pose() const noexcept { return pose_; }

  private:
    struct GridInBur;  ///< where the grid lies in the bur's frame
    /// When a brick is to be looked at again. By itself, so that passing by the many that rest reads little.
    struct Visit {
        std::int32_t due = 0;  ///< the way before which nothing in it can rise
        std::uint32_t epoch = 0;
    };
    /// What else is known of it since the last settle().
    struct Memory {
        std::int32_t piecesDue = 0;  ///< the way until which its pieces are these
        std::uint64_t groups = 0, alone = 0;
    };
    struct Dues {
        std::int32_t steps[kSweepDues];
        std::uint32_t epoch;
    };
    void setTravel(double mm) noexcept;
    void forget() noexcept;
    [[nodiscard]] GridInBur gridIn(const contact::BurFrame& bur) const noexcept;
    [[nodiscard]] bool rangeNear(const contact::BurFrame& bur, double reachMm, std::int32_t (&low)[3],
                                 std::int32_t (&high)[3]) const noexcept;
    void cutAt(const core::Pose& pose, Outcome& outcome) noexcept;
    void visit(const GridInBur& grid, std::uint32_t dense, const std::int32_t (&base)[3], Outcome& outcome) noexcept;
    [[nodiscard]] OutlineTable::Region regionOf(const GridInBur& grid, const std::int32_t (&base)[3]) const noexcept;
    [[nodiscard]] std::int32_t wayAfter(double mm) const noexcept;
    void raiseCoarse(const core::Pose& pose, bool all) noexcept;
    [[nodiscard]] double notchOf(const core::Vec3& direction) const noexcept;
    [[nodiscard]] double stepsBetween(const core::Pose& from, const core::Pose& to, double& movedMm) const noexcept;

    tooth::ToothState& field_;
    SweepKernels kernels_;
    double voxelMm_, bandMm_, bandOutMm_, lengthMm_, radiusMm_, unitMm_, sidewaysStepMm_, alongStepMm_;
    /// A convex corner of the outline: the outward normals on both sides, and the sine between them.
    struct Corner {
        core::Vec2 before, after;
        double sine;
        bool atTop;  ///< where the shank follows: what it leaves is let be, up to what any way may leave
    };
    std::vector<Corner> corners_;
    OutlineTable outline_, simple_;
    struct alignas(64) Nodes {
        std::int32_t offset[3][kSweepRoom], owned[kSweepRoom];
    };
    std::unique_ptr<Nodes> nodes_;
    std::vector<std::uint16_t> list_, simpleList_;
    std::vector<Visit> visits_;   ///< by dense brick
    std::vector<Memory> memory_;  ///< by dense brick
    std::vector<Dues> dues_;      ///< by stored brick
    SweepPass pass_{}, simplePass_{};
    std::array<std::int64_t, cases::kTissueCount> quanta_{};
    core::Pose pose_;
    bool hasPose_ = false;
    double travelMm_ = 0.0;
    std::int32_t way_ = 0;  ///< travelMm_, rounded up, in quanta of kSweepWayMm
    std::uint32_t epoch_ = 1;
    // The coarse pass: rows of bricks of a box round the bur, some at a time.
    std::int32_t coarseLow_[3] = {0, 0, 0}, coarseHigh_[3] = {-1, -1, -1};
    std::int64_t coarseRow_ = 0, coarseRows_ = 0;
    double coarseTravelMm_ = 0.0;
};

}  // namespace handpiece::cutting
