// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A tooth as it is now: the one thing about it that changes, and changes in the tick.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "handpiece/base/core/realtime.h"
#include "handpiece/model/tooth/state_delta.h"
#include "handpiece/model/tooth/tooth_model.h"

namespace handpiece::tooth {

/// Distances at bricks' centres are held to this depth, so that a cut need not reach farther to keep them right.
inline constexpr float kCoarseDepthMm = 2.0f;

/// What the tick cuts and feels. All memory is taken at construction. One thread: the tick's.
class ToothState {
  public:
    /// `tooth`: its number in the mouth.
    explicit ToothState(std::shared_ptr<const ToothModel> model, std::uint16_t tooth = 0);

    [[nodiscard]] const ToothModel& model() const noexcept { return *model_; }
    [[nodiscard]] const std::shared_ptr<const ToothModel>& modelShared() const noexcept { return model_; }
    [[nodiscard]] std::uint16_t toothNumber() const noexcept { return tooth_; }
    /// As it is now, for lookups and for contact; its arrays never move.
    [[nodiscard]] const field::DistanceField& field() const noexcept { return field_; }
    /// True when a brick that overlaps the box (tooth frame, mm) may differ from the uncut tooth.
    [[nodiscard]] bool isCutNear(const core::Box& box) const noexcept HANDPIECE_REALTIME;
    [[nodiscard]] const TissueVolumes& removedMm3() const noexcept { return removedMm3_; }

    // For cutting, in the tick.

    /// Storage index of a brick, stored from the reserve when it lies in the tooth and has none yet; -1 outside the
    /// tooth, or when the reserve is used up (then outOfBricks()).
    std::int32_t storeBrick(std::uint32_t dense) noexcept HANDPIECE_REALTIME;
    [[nodiscard]] float* values(std::int32_t stored) noexcept { return &storage().values[valueIndex(stored)]; }
    /// Signed distance at a brick's centre, or a bound; raise it where a cut has come nearer.
    [[nodiscard]] float* coarse() noexcept { return storage().coarse.data(); }
    /// Says that values of this stored brick have changed. `shows`: the surface itself may have moved in it.
    void noteChanged(std::uint32_t dense, bool shows) noexcept HANDPIECE_REALTIME;
    void addRemoved(const TissueVolumes& mm3) noexcept HANDPIECE_REALTIME;
    [[nodiscard]] bool outOfBricks() const noexcept { return outOfBricks_; }

    // Handing over, in the tick.

    /// Calls push(const BrickSnapshot&) for at most `most` changed bricks, those that waited longest first; a brick
    /// that push refuses (false) waits on. Nothing is lost: what changes again is handed over again.
    template <class Push>
    std::size_t handOver(std::size_t most, Push&& push) noexcept {
        std::size_t count = 0;
        for (; count < most && firstDirty_ != nextDirty_; ++count) {
            if (!push(snapshotOfFirstDirty())) break;
            dropFirstDirty();
        }
        return count;
    }
    [[nodiscard]] std::size_t waitingBricks() const noexcept { return nextDirty_ - firstDirty_; }

    /// Puts bricks `from` .. of a change in place, at most `most` of them and no other tooth's; returns the next
    /// `from`. With the last one of this tooth its removed volumes become those of the change, and the tooth is the one
    /// that was meant, bit for bit. After every call bricks agree on the nodes they share as far as they do before and
    /// after the change, and the bounds elsewhere hold; they are as tight as at first again only when
    /// nothing is cut any more.
    std::size_t restore(const StateDelta& change, std::size_t from, std::size_t most) noexcept HANDPIECE_REALTIME;

    // Off the tick, while it rests.

    [[nodiscard]] StateDelta state() const;
    [[nodiscard]] std::uint64_t stateHash() const;
    /// What is left by tissue, integrated as the cutting counts.
    [[nodiscard]] TissueVolumes volumesMm3() const;

  private:
    [[nodiscard]] static std::size_t valueIndex(std::int32_t stored) noexcept {
        return static_cast<std::size_t>(stored) * field::kBrickValues;
    }
    [[nodiscard]] field::FieldStorage& storage() noexcept { return field_.storage(); }
    BrickSnapshot& snapshotOfFirstDirty() noexcept;
    void dropFirstDirty() noexcept;
    void noteWaiting(std::uint32_t dense, bool shows) noexcept;
    void noteUncut(std::uint32_t dense) noexcept;
    void shareFaces(std::uint32_t dense, std::int32_t stored, std::span<const StateDelta::Brick> yetToCome) noexcept;
    void raiseAround(std::uint32_t dense, const float* values) noexcept;
    void resetCoarse() noexcept;

    std::shared_ptr<const ToothModel> model_;
    std::uint16_t tooth_;
    field::DistanceField field_;  ///< its values have room for the reserve
    std::int32_t storedCount_ = 0, storedRoom_ = 0;
    TissueVolumes removedMm3_{};
    bool outOfBricks_ = false;
    std::vector<std::uint8_t> flags_;   ///< by dense brick: changed, waiting, shows; some more, to be read in words
    std::vector<std::uint32_t> dirty_;  ///< a ring with room for every brick
    std::size_t firstDirty_ = 0, nextDirty_ = 0;
    std::size_t changedCount_ = 0;
    std::array<std::int32_t, 3> changedLow_{}, changedHigh_{};  ///< bricks between which all changes lie
    BrickSnapshot snapshot_;
};

}  // namespace handpiece::tooth
