// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>

#include "handpiece/model/tooth/cut_field.h"

namespace handpiece::tooth {
namespace {
constexpr std::size_t kBrickBytes = sizeof(float) * field::kBrickValues;
}  // namespace

CutMirror::CutMirror(std::shared_ptr<const CuttableTooth> base) : base_(std::move(base)) {
    const field::FieldView view = base_->tooth->field.view();
    const std::size_t dense = static_cast<std::size_t>(view.bricks[0]) * static_cast<std::size_t>(view.bricks[1]) *
                              static_cast<std::size_t>(view.bricks[2]);
    bricks_.resize(dense);
    isTouched_.assign(dense, false);
}

void CutMirror::put(std::uint32_t dense, const float* values) {
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

void CutMirror::apply(const BrickSnapshot& snapshot) {
    put(snapshot.dense, snapshot.values);
}

void CutMirror::apply(const StateDelta& change) {
    for (const StateDelta::Brick& brick : change.bricks)
        put(brick.dense, brick.whole ? nullptr : brick.values.data());
}

const float* CutMirror::values(std::uint32_t dense, float* scratch) const {
    if (bricks_[dense]) return bricks_[dense]->data();
    base_->wholeBrick(dense, scratch);
    return scratch;
}

bool CutMirror::isChanged(std::uint32_t dense) const {
    return bricks_[dense] != nullptr;
}

std::vector<std::uint32_t> CutMirror::takeTouched() {
    std::vector<std::uint32_t> taken;
    taken.swap(touched_);
    std::sort(taken.begin(), taken.end());
    for (const std::uint32_t dense : taken)
        isTouched_[dense] = false;
    return taken;
}

StateDelta CutMirror::state(const TissueVolumes& removedMm3) const {
    StateDelta state;
    state.removedMm3 = removedMm3;
    std::array<float, field::kBrickValues> whole;
    for (std::uint32_t dense = 0; dense < bricks_.size(); ++dense) {
        if (!bricks_[dense]) continue;
        // A brick that was restored comes as a snapshot like any other.
        base_->wholeBrick(dense, whole.data());
        if (std::memcmp(whole.data(), bricks_[dense]->data(), kBrickBytes) == 0) continue;
        state.bricks.push_back({dense, false, *bricks_[dense]});
    }
    return state;
}

}  // namespace handpiece::tooth
