// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/tooth/tooth_mirror.h"

#include <algorithm>
#include <cstring>

namespace handpiece::tooth {

ToothMirror::ToothMirror(std::shared_ptr<const ToothModel> model) : model_(std::move(model)) {
    const std::size_t dense = model_->field.storage().coarse.size();
    bricks_.resize(dense);
    isTouched_.assign(dense, false);
}

void ToothMirror::put(std::uint32_t dense, const float* values) {
    auto& brick = bricks_[dense];
    if (values == nullptr) {
        brick.reset();
    } else {
        if (!brick) brick = std::make_unique<std::array<float, field::kBrickValues>>();
        std::memcpy(brick->data(), values, kBrickBytes);
    }
    if (isTouched_[dense]) return;
    isTouched_[dense] = true;
    touched_.push_back(dense);
}

void ToothMirror::apply(const BrickSnapshot& snapshot) {
    put(snapshot.dense, snapshot.values);
}

void ToothMirror::apply(const StateDelta& change) {
    for (const StateDelta::Brick& brick : change.bricks)
        put(brick.dense, brick.uncut ? nullptr : brick.values.data());
}

const float* ToothMirror::values(std::uint32_t dense, float* scratch) const {
    if (bricks_[dense]) return bricks_[dense]->data();
    model_->uncutBrick(dense, scratch);
    return scratch;
}

bool ToothMirror::isChanged(std::uint32_t dense) const {
    return bricks_[dense] != nullptr;
}

std::vector<std::uint32_t> ToothMirror::takeTouched() {
    std::vector<std::uint32_t> taken;
    taken.swap(touched_);
    std::sort(taken.begin(), taken.end());
    for (const std::uint32_t dense : taken)
        isTouched_[dense] = false;
    return taken;
}

StateDelta ToothMirror::state(const TissueVolumes& removedMm3) const {
    StateDelta state;
    state.removedMm3 = removedMm3;
    std::array<float, field::kBrickValues> uncut;
    for (std::uint32_t dense = 0; dense < bricks_.size(); ++dense) {
        if (!bricks_[dense]) continue;
        // A brick that was restored comes as a snapshot like any other.
        model_->uncutBrick(dense, uncut.data());
        if (std::memcmp(uncut.data(), bricks_[dense]->data(), kBrickBytes) == 0) continue;
        state.bricks.push_back({dense, false, *bricks_[dense]});
    }
    return state;
}

}  // namespace handpiece::tooth
