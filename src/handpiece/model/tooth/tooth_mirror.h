// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Teeth that are being cut, as they are known off the tick.

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "handpiece/model/tooth/state_delta.h"
#include "handpiece/model/tooth/tooth_model.h"

namespace handpiece::tooth {

/// An off-tick copy of what has been cut, kept up by snapshots: for the surface, for undo, for files. One thread.
class ToothMirror {
  public:
    explicit ToothMirror(std::shared_ptr<const ToothModel> model, std::uint16_t tooth = 0);

    [[nodiscard]] const ToothModel& model() const noexcept { return *model_; }
    [[nodiscard]] std::uint16_t toothNumber() const noexcept { return tooth_; }
    void apply(const BrickSnapshot& snapshot);
    /// What it says of other teeth is left alone.
    void apply(const StateDelta& change);
    /// Becomes as another mirror of the same tooth is; costs what has changed in that since the last call.
    void follow(ToothMirror& other);
    /// Values of a brick now; `scratch` (kBrickValues) is used when it is still uncut.
    [[nodiscard]] const float* values(std::uint32_t dense, float* scratch) const;
    [[nodiscard]] bool isChanged(std::uint32_t dense) const;
    /// Bricks given to apply() since the last call, each once, rising.
    [[nodiscard]] std::vector<std::uint32_t> takeTouched();
    [[nodiscard]] StateDelta state(const TissueVolumes& removedMm3) const;

  private:
    void put(std::uint32_t dense, const float* values);
    void note(std::uint32_t dense, std::vector<bool>& isIn, std::vector<std::uint32_t>& list);

    std::shared_ptr<const ToothModel> model_;
    std::uint16_t tooth_;
    std::vector<std::unique_ptr<std::array<float, field::kBrickValues>>> bricks_;  ///< by dense brick; null: uncut
    std::vector<std::uint32_t> touched_, unfollowed_;                              ///< by takeTouched(), by follow()
    std::vector<bool> isTouched_, isUnfollowed_;
};

/// The teeth of a mouth that can be cut, by their numbers: null where one cannot. The first is the one worked on.
using Teeth = std::vector<std::shared_ptr<const ToothModel>>;
/// Two mouths share it only when a state of one is a state of the other; of a lone tooth it is the tooth's.
[[nodiscard]] std::uint64_t identityOf(const Teeth& teeth);

/// The mirrors of a mouth's teeth.
class MouthMirror {
  public:
    explicit MouthMirror(const Teeth& teeth);

    /// Of teeth that it does not have nothing is taken.
    void apply(const BrickSnapshot& snapshot);
    void apply(const StateDelta& change);
    [[nodiscard]] const float* values(BrickId id, float* scratch) const;
    [[nodiscard]] bool isChanged(BrickId id) const;
    [[nodiscard]] StateDelta state(const RemovedMm3& removedMm3) const;
    [[nodiscard]] StateDelta state() const { return state({}); }

  private:
    std::vector<std::unique_ptr<ToothMirror>> teeth_;  ///< null where one cannot be cut
};

}  // namespace handpiece::tooth
