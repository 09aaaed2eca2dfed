// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/tooth/tooth_mirror.h"

#include <algorithm>
#include <cstring>

#include "handpiece/base/core/hash.h"

namespace handpiece::tooth {

ToothMirror::ToothMirror(std::shared_ptr<const ToothModel> model, std::uint16_t tooth)
    : model_(std::move(model)), tooth_(tooth) {
    const std::size_t dense = model_->field.storage().coarse.size();
    bricks_.resize(dense);
    isTouched_.assign(dense, false);
    isUnfollowed_.assign(dense, false);
}

/// Each once.
void ToothMirror::note(std::uint32_t dense, std::vector<bool>& isIn, std::vector<std::uint32_t>& list) {
    if (isIn[dense]) return;
    isIn[dense] = true;
    list.push_back(dense);
}

void ToothMirror::put(std::uint32_t dense, const float* values) {
    auto& brick = bricks_[dense];
    if (values == nullptr) {
        brick.reset();
    } else {
        if (!brick) brick = std::make_unique<std::array<float, field::kBrickValues>>();
        std::memcpy(brick->data(), values, kBrickBytes);
    }
    note(dense, isTouched_, touched_);
    note(dense, isUnfollowed_, unfollowed_);
}

void ToothMirror::follow(ToothMirror& other) {
    for (const std::uint32_t dense : other.unfollowed_) {
        put(dense, other.bricks_[dense] ? other.bricks_[dense]->data() : nullptr);
        other.isUnfollowed_[dense] = false;
    }
    other.unfollowed_.clear();
}

void ToothMirror::apply(const BrickSnapshot& snapshot) {
    put(denseOf(snapshot.id), snapshot.values);
}

void ToothMirror::apply(const StateDelta& change) {
    for (const StateDelta::Brick& brick : change.bricks)
        if (toothOf(brick.id) == tooth_) put(denseOf(brick.id), brick.uncut ? nullptr : brick.values.data());
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
    state.removedMm3.set(tooth_, removedMm3);
    std::array<float, field::kBrickValues> uncut;
    for (std::uint32_t dense = 0; dense < bricks_.size(); ++dense) {
        if (!bricks_[dense]) continue;
        // A brick that was restored comes as a snapshot like any other.
        model_->uncutBrick(dense, uncut.data());
        if (std::memcmp(uncut.data(), bricks_[dense]->data(), kBrickBytes) == 0) continue;
        state.bricks.push_back({brickId(tooth_, dense), false, *bricks_[dense]});
    }
    return state;
}

std::uint64_t identityOf(const Teeth& teeth) {
    std::size_t cut = 0;
    for (const auto& tooth : teeth)
        cut += tooth != nullptr;
    if (cut == 1 && teeth.front()) return teeth.front()->identity;
    core::Hasher hasher;
    for (const auto& tooth : teeth)
        hasher.add(tooth ? tooth->identity : 0);
    return hasher.value();
}

MouthMirror::MouthMirror(const Teeth& teeth) {
    for (const auto& tooth : teeth)
        teeth_.push_back(tooth ? std::make_unique<ToothMirror>(tooth, static_cast<std::uint16_t>(teeth_.size()))
                               : nullptr);
}

void MouthMirror::apply(const BrickSnapshot& snapshot) {
    const std::size_t tooth = toothOf(snapshot.id);
    if (tooth < teeth_.size() && teeth_[tooth]) teeth_[tooth]->apply(snapshot);
}

void MouthMirror::apply(const StateDelta& change) {
    for (const auto& tooth : teeth_)
        if (tooth) tooth->apply(change);
}

const float* MouthMirror::values(BrickId id, float* scratch) const {
    return teeth_[toothOf(id)]->values(denseOf(id), scratch);
}

bool MouthMirror::isChanged(BrickId id) const {
    return teeth_[toothOf(id)]->isChanged(denseOf(id));
}

StateDelta MouthMirror::state(const RemovedMm3& removedMm3) const {
    StateDelta state;
    for (const auto& tooth : teeth_)
        if (tooth) state.append(tooth->state({}));
    state.removedMm3 = removedMm3;
    return state;
}

}  // namespace handpiece::tooth
