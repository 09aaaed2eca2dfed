// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A tooth that is being cut, as it is known off the tick.

#include <array>
#include <memory>
#include <vector>

#include "handpiece/model/tooth/state_delta.h"
#include "handpiece/model/tooth/tooth_model.h"

namespace handpiece::tooth {

/// An off-tick copy of what has been cut, kept up by snapshots: for the surface, for undo, for files. One thread.
class ToothMirror {
  public:
    explicit ToothMirror(std::shared_ptr<const ToothModel> model);

    [[nodiscard]] const ToothModel& model() const noexcept { return *model_; }
    void apply(const BrickSnapshot& snapshot);
    void apply(const StateDelta& change);
    /// Values of a brick now; `scratch` (kBrickValues) is used when it is still uncut.
    [[nodiscard]] const float* values(std::uint32_t dense, float* scratch) const;
    [[nodiscard]] bool isChanged(std::uint32_t dense) const;
    /// Bricks given to apply() since the last call, each once, rising.
    [[nodiscard]] std::vector<std::uint32_t> takeTouched();
    [[nodiscard]] StateDelta state(const TissueVolumes& removedMm3) const;

  private:
    void put(std::uint32_t dense, const float* values);

    std::shared_ptr<const ToothModel> model_;
    std::vector<std::unique_ptr<std::array<float, field::kBrickValues>>> bricks_;  ///< by dense brick; null: uncut
    std::vector<std::uint32_t> touched_;
    std::vector<bool> isTouched_;
};

}  // namespace handpiece::tooth
