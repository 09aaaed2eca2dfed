// SPDX-License-Identifier: Apache-2.0
#include "handpiece/record/history/history.h"

#include <zlib.h>

#include <array>
#include <cstring>
#include <utility>

#include "handpiece/base/core/error.h"

namespace handpiece::history {
namespace {

constexpr std::size_t kBrickBytes = field::kBrickValues * sizeof(float);
// What a brick costs beside its packed bytes: a node of the map and the vector's own memory, about.
constexpr std::size_t kNodeBytes = 96;

using Planes = std::array<unsigned char, kBrickBytes>;

/// Bytes of equal weight beside one another pack better: neighbours' exponents are alike.
std::vector<std::byte> pack(const float* values) {
    Planes planes;
    const auto* bytes = reinterpret_cast<const unsigned char*>(values);
    for (std::size_t i = 0; i < field::kBrickValues; ++i)
        for (std::size_t b = 0; b < sizeof(float); ++b)
            planes[b * field::kBrickValues + i] = bytes[i * sizeof(float) + b];
    std::array<unsigned char, kBrickBytes + kBrickBytes / 100 + 64> out;
    uLongf size = out.size();
    if (compress2(out.data(), &size, planes.data(), planes.size(), 1) != Z_OK)
        throw core::Error("a step of the history cannot be packed", "history");
    const auto* first = reinterpret_cast<const std::byte*>(out.data());
    return {first, first + size};
}

void unpack(const std::vector<std::byte>& packed, float* values) {
    Planes planes;
    uLongf size = planes.size();
    if (uncompress(planes.data(), &size, reinterpret_cast<const unsigned char*>(packed.data()), packed.size()) !=
            Z_OK ||
        size != planes.size()) {
        throw core::Error("a step of the history cannot be unpacked", "history");
    }
    auto* bytes = reinterpret_cast<unsigned char*>(values);
    for (std::size_t i = 0; i < field::kBrickValues; ++i)
        for (std::size_t b = 0; b < sizeof(float); ++b)
            bytes[i * sizeof(float) + b] = planes[b * field::kBrickValues + i];
}

}  // namespace

std::size_t History::bytesOf(const Step& step) {
    std::size_t bytes = sizeof(Step);
    for (const auto& [id, packed] : step.bricks)
        bytes += packed.capacity() + kNodeBytes;
    return bytes;
}

void History::start(const tooth::StateDelta& state) {
    now_.clear();
    steps_.clear();
    touched_.clear();
    done_ = memoryBytes_ = 0;
    removedMm3_ = state.removedMm3;
    for (const tooth::StateDelta::Brick& brick : state.bricks) {
        if (brick.uncut) continue;
        const auto& packed = now_[brick.id] = pack(brick.values.data());
        memoryBytes_ += packed.capacity() + kNodeBytes;
    }
}

bool History::endStroke(const BrickSource& source, const tooth::RemovedMm3& removedMm3) {
    Step step;
    std::array<float, field::kBrickValues> scratch;
    for (const tooth::BrickId id : touched_) {
        Packed after;
        if (source.isChanged(id)) after = pack(source.values(id, scratch.data()));
        const auto found = now_.find(id);
        if (found == now_.end() ? after.empty() : found->second == after) continue;
        Packed& now = now_[id];
        memoryBytes_ += after.capacity() - now.capacity() + (found == now_.end() ? kNodeBytes : 0);
        step.bricks[id] = std::exchange(now, std::move(after));
    }
    touched_.clear();
    step.removedMm3 = std::exchange(removedMm3_, removedMm3);
    if (step.bricks.empty()) return false;
    add(std::move(step));
    return true;
}

void History::add(Step&& step) {
    while (steps_.size() > done_) {
        memoryBytes_ -= bytesOf(steps_.back());
        steps_.pop_back();
    }
    memoryBytes_ += bytesOf(step);
    steps_.push_back(std::move(step));
    done_ = steps_.size();
    while (steps_.size() > settings_.leastSteps && memoryBytes_ > settings_.memoryBytes) {
        memoryBytes_ -= bytesOf(steps_.front());
        steps_.pop_front();
        --done_;
    }
}

tooth::StateDelta History::unpacked(const Step& step) {
    tooth::StateDelta change;
    change.bricks.resize(step.bricks.size());
    std::size_t i = 0;
    for (const auto& [id, packed] : step.bricks) {
        tooth::StateDelta::Brick& brick = change.bricks[i++];
        brick.id = id;
        brick.uncut = packed.empty();
        if (brick.uncut) {
            brick.values.fill(0.0f);
        } else {
            unpack(packed, brick.values.data());
        }
    }
    change.removedMm3 = step.removedMm3;
    return change;
}

tooth::StateDelta History::step(std::size_t index) const {
    return unpacked(steps_.at(index));
}

void History::append(const tooth::StateDelta& otherSide, bool isDone) {
    Step step;
    for (const tooth::StateDelta::Brick& brick : otherSide.bricks)
        step.bricks[brick.id] = brick.uncut ? Packed{} : pack(brick.values.data());
    step.removedMm3 = otherSide.removedMm3;
    memoryBytes_ += bytesOf(step);
    steps_.push_back(std::move(step));
    if (isDone) done_ = steps_.size();
}

/// Goes to the other side of a step, which then leads back.
tooth::StateDelta History::exchange(Step& step) {
    tooth::StateDelta change = unpacked(step);
    for (auto& [id, packed] : step.bricks)
        std::swap(packed, now_[id]);
    std::swap(step.removedMm3, removedMm3_);
    return change;
}

std::optional<tooth::StateDelta> History::undo() {
    if (done_ == 0) return std::nullopt;
    return exchange(steps_[--done_]);
}

std::optional<tooth::StateDelta> History::redo() {
    if (done_ == steps_.size()) return std::nullopt;
    return exchange(steps_[done_++]);
}

std::optional<tooth::StateDelta> History::reset() {
    Step step;
    for (const auto& [id, packed] : now_)
        if (!packed.empty()) step.bricks[id];  // the other side: uncut
    if (step.bricks.empty()) return std::nullopt;
    tooth::StateDelta change = exchange(step);
    for (const auto& [id, packed] : step.bricks)
        memoryBytes_ -= packed.capacity();  // moved from now_ into the step, where add() counts it
    add(std::move(step));
    return change;
}

}  // namespace handpiece::history
