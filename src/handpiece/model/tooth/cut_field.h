// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The field of a tooth that is being cut: the one thing about a tooth that changes, and changes in the tick.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/core/realtime.h"
#include "handpiece/model/field/tissue_map.h"
#include "handpiece/model/tooth/tooth.h"

namespace handpiece::tooth {

/// Volume by tissue [mm3].
using TissueVolumes = std::array<double, cases::kTissueCount>;

/// Half width of the slope over which a node's voxel counts from full to empty, in voxels.
inline constexpr float kOccupancyHalfWidth = 0.5f;
/// Share of a node's voxel that is tissue, 0..1, from its value: what volumes are sums of, and what a cut counts.
[[nodiscard]] inline float occupancy(float valueMm, float inverseVoxelMm) noexcept {
    return std::clamp(0.5f - valueMm * inverseVoxelMm * (0.5f / kOccupancyHalfWidth), 0.0f, 1.0f);
}

/// Distances at bricks' centres are held to this depth, so that a cut need not reach farther to keep them right.
inline constexpr float kCoarseDepthMm = 2.0f;

struct CutSettings {
    double bandMm = 0.0;  ///< how deep under the surface the field follows a cut; 0: 0.2 mm, at least 3 voxels
    std::size_t reserveBricks = 0;  ///< bricks kept ready for the tooth's interior; 0: all of it, at most 256 MB
};

/// A tooth prepared for cutting: whole, immutable, shared by the tick, its mirrors and every bur.
///
/// Values are the field's, held to [-bandMm, bandOutMm]: nearer than that to the surface they are distances, beyond it
/// they only say "at least".
struct CuttableTooth {
    std::shared_ptr<const Tooth> tooth;
    field::TissueMap tissues;
    CutSettings settings;    ///< with what 0 stands for filled in
    double bandOutMm = 0.0;  ///< the field's, at least two voxels: nearer the clamp would bend the surface
    TissueVolumes volumesMm3{};

    /// kBrickValues values of a brick before any cut. The same bits whoever asks.
    void wholeBrick(std::uint32_t dense, float* out) const noexcept HANDPIECE_REALTIME;
};
/// In parallel; the same bits at any thread count. Throws core::Error for settings out of range.
[[nodiscard]] std::shared_ptr<const CuttableTooth> prepareCutting(std::shared_ptr<const Tooth> tooth,
                                                                  field::TissueMap tissues,
                                                                  const CutSettings& settings = {});

/// The same from a case, the tissues from its parts; kept in a cache file beside the field's, as `cache` says, and
/// reopened from there. `tooth` is that case's. Throws core::Error as prepareTooth does.
[[nodiscard]] std::shared_ptr<const CuttableTooth> prepareCutting(const cases::Case& toothCase,
                                                                  std::shared_ptr<const Tooth> tooth,
                                                                  const PrepareSettings& cache,
                                                                  const CutSettings& settings = {},
                                                                  const core::Progress& progress = {});

/// One brick as it is now, by value: how listeners learn of a cut.
struct BrickSnapshot {
    std::uint32_t dense = 0;  ///< which brick: index x + bricks_x (y + bricks_y z)
    bool shows = true;        ///< the surface may have moved in it since it was handed over last
    float values[field::kBrickValues];
};

/// Bricks that differ from the whole tooth (a state), or that differ between two states (a change).
struct StateDelta {
    struct Brick {
        std::uint32_t dense;
        bool whole;  ///< as before any cut; then `values` counts for nothing
        std::array<float, field::kBrickValues> values;
    };
    std::vector<Brick> bricks;   ///< at rising `dense`
    TissueVolumes removedMm3{};  ///< since the tooth was whole
};
/// The same number for the same tooth, bit for bit; whole bricks count for nothing.
[[nodiscard]] std::uint64_t stateHash(const StateDelta& state);
/// What turns a tooth in state `from` into one in state `to`: bricks that differ, whole where `to` leaves them so.
[[nodiscard]] StateDelta changeBetween(const StateDelta& from, const StateDelta& to);

/// The field that the tick cuts and feels. All memory is taken at construction. One thread: the tick's.
class CutField {
  public:
    explicit CutField(std::shared_ptr<const CuttableTooth> base);

    [[nodiscard]] const CuttableTooth& base() const noexcept { return *base_; }
    /// As it is now, for lookups and for contact; its arrays never move.
    [[nodiscard]] const field::DistanceField& field() const noexcept { return field_; }
    /// True when a brick that overlaps the box (tooth frame, mm) may differ from the whole tooth.
    [[nodiscard]] bool isCutNear(const core::Box& box) const noexcept HANDPIECE_REALTIME;
    [[nodiscard]] const TissueVolumes& removedMm3() const noexcept { return removedMm3_; }
    /// Another number after every change: what was looked up at the same one still holds.
    [[nodiscard]] std::uint64_t version() const noexcept { return version_; }

    // For cutting, in the tick.

    /// Storage index of a brick, stored from the reserve when it lies in the tooth and has none yet; -1 outside the
    /// tooth, or when the reserve is used up (then outOfBricks()).
    std::int32_t storeBrick(std::uint32_t dense) noexcept HANDPIECE_REALTIME;
    [[nodiscard]] float* values(std::int32_t stored) noexcept { return &field_.values_[valueIndex(stored)]; }
    [[nodiscard]] const std::uint8_t* tissues(std::int32_t stored) const noexcept {
        return &field_.tissue_[valueIndex(stored)];
    }
    /// Signed distance at a brick's centre, or a bound; raise it where a cut has come nearer.
    [[nodiscard]] float* coarse() noexcept { return field_.coarse_.data(); }
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

    /// Puts bricks `from` .. of a change in place, at most `most` of them; returns the next `from`. With the last one
    /// the removed volumes become those of the change. After every call bricks agree on the nodes they share, and the
    /// bounds elsewhere hold; they are as tight as at first again only when nothing is cut any more.
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
    const BrickSnapshot& snapshotOfFirstDirty() noexcept;
    void dropFirstDirty() noexcept;
    void noteWaiting(std::uint32_t dense, bool shows) noexcept;
    void noteWhole(std::uint32_t dense) noexcept;
    void shareFaces(std::uint32_t dense, std::int32_t stored) noexcept;
    void raiseAround(std::uint32_t dense, const float* values) noexcept;
    void resetCoarse() noexcept;

    std::shared_ptr<const CuttableTooth> base_;
    field::DistanceField field_;  ///< index, values and tissues have room for the reserve
    std::int32_t storedCount_ = 0, storedRoom_ = 0;
    TissueVolumes removedMm3_{};
    bool outOfBricks_ = false;
    std::vector<std::uint8_t> flags_;   ///< by dense brick: changed, waiting, shows; some more, to be read in words
    std::vector<std::uint32_t> dirty_;  ///< a ring with room for every brick
    std::size_t firstDirty_ = 0, nextDirty_ = 0;
    std::size_t changedCount_ = 0;
    std::uint64_t version_ = 1;
    std::array<std::int32_t, 3> changedLow_{}, changedHigh_{};  ///< bricks between which all changes lie
    BrickSnapshot snapshot_;
};

/// An off-tick copy of what has been cut, kept up by snapshots: for the surface, for undo, for files. One thread.
class CutMirror {
  public:
    explicit CutMirror(std::shared_ptr<const CuttableTooth> base);

    [[nodiscard]] const CuttableTooth& base() const noexcept { return *base_; }
    void apply(const BrickSnapshot& snapshot);
    void apply(const StateDelta& change);
    /// Values of a brick now; `scratch` (kBrickValues) is used when it is still whole.
    [[nodiscard]] const float* values(std::uint32_t dense, float* scratch) const;
    [[nodiscard]] bool isChanged(std::uint32_t dense) const;
    /// Bricks given to apply() since the last call, each once, rising.
    [[nodiscard]] std::vector<std::uint32_t> takeTouched();
    [[nodiscard]] StateDelta state(const TissueVolumes& removedMm3) const;

  private:
    void put(std::uint32_t dense, const float* values);

    std::shared_ptr<const CuttableTooth> base_;
    std::vector<std::unique_ptr<std::array<float, field::kBrickValues>>> bricks_;  ///< by dense brick; null: whole
    std::vector<std::uint32_t> touched_;
    std::vector<bool> isTouched_;
};

}  // namespace handpiece::tooth
