// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/tooth/tooth_state.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "handpiece/base/core/error.h"

#include "handpiece/model/field/brick_index.h"

namespace handpiece::tooth {
namespace {

constexpr std::uint8_t kChanged = 1, kWaiting = 2, kShows = 4;

/// The field to be cut, held to its band; writing all of it brings the pages in now rather than in the tick.
field::DistanceField withRoom(const ToothModel& model) {
    const field::FieldStorage& uncut = model.field.storage();
    field::FieldStorage s;
    s.settings = uncut.settings;
    s.settings.bandInMm = std::min(s.settings.bandInMm, model.settings.bandMm);
    s.originMm = uncut.originMm;
    std::copy(std::begin(uncut.bricks), std::end(uncut.bricks), s.bricks);
    s.brickIndex = uncut.brickIndex;
    s.coarse = uncut.coarse;
    s.tissues = uncut.tissues;
    s.heldTo = field::FieldReach{model.bandOutMm, model.settings.bandMm};
    s.values.resize((uncut.brickCount() + model.settings.reserveBricks) * field::kBrickValues,
                    static_cast<float>(-model.settings.bandMm));
    for (std::size_t i = 0; i < s.coarse.size(); ++i) {
        s.coarse[i] = std::max(s.coarse[i], -kCoarseDepthMm);
        if (const std::int32_t stored = s.brickIndex[i]; stored >= 0)
            model.uncutBrick(static_cast<std::uint32_t>(i),
                             &s.values[static_cast<std::size_t>(stored) * field::kBrickValues]);
    }
    return field::DistanceField(std::move(s));
}

}  // namespace

ToothState::ToothState(std::shared_ptr<const ToothModel> model, std::uint16_t tooth)
    : model_(std::move(model)), tooth_(tooth), field_(withRoom(*model_)), dirty_(storage().coarse.size(), 0) {
    if (dirty_.size() > kMaxBricks || tooth_ >= kMaxTeeth)
        throw core::Error("a field this large cannot be cut", model_->name, "choose a larger voxel");
    storedCount_ = static_cast<std::int32_t>(model_->field.brickCount());
    storedRoom_ = static_cast<std::int32_t>(field_.brickCount());
    flags_.assign(dirty_.size() + sizeof(std::uint64_t), 0);
    std::memset(snapshot_.values, 0, kBrickBytes);
}

bool ToothState::isCutNear(const core::Box& box) const noexcept {
    if (changedCount_ == 0) return false;
    const double perMm = 1.0 / (field::kBrickCells * field_.storage().settings.voxelMm);
    std::int32_t low[3], high[3];
    for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        const double first = std::floor((box.min[k] - field_.storage().originMm[k]) * perMm),
                     last = std::floor((box.max[k] - field_.storage().originMm[k]) * perMm);
        if (!(first <= last && first <= changedHigh_[axis] && last >= changedLow_[axis])) return false;
        low[k] = first > changedLow_[axis] ? static_cast<std::int32_t>(first) : changedLow_[axis];
        high[k] = last < changedHigh_[axis] ? static_cast<std::int32_t>(last) : changedHigh_[axis];
    }
    // Eight bricks of a row at once.
    constexpr std::uint64_t kAnyChanged = 0x0101010101010101ull * kChanged;
    for (std::int32_t z = low[2]; z <= high[2]; ++z)
        for (std::int32_t y = low[1]; y <= high[1]; ++y) {
            const std::uint8_t* row =
                &flags_[static_cast<std::size_t>(field_.storage().bricks[0]) *
                        (static_cast<std::size_t>(y) +
                         static_cast<std::size_t>(field_.storage().bricks[1]) * static_cast<std::size_t>(z))];
            for (std::int32_t x = low[0]; x <= high[0]; x += 8) {
                std::uint64_t eight;
                std::memcpy(&eight, row + x, sizeof eight);
                std::uint64_t wanted = kAnyChanged;
                if (const std::int32_t left = high[0] + 1 - x; left < 8) {
                    std::uint8_t mask[8];
                    for (int i = 0; i < 8; ++i)
                        mask[i] = i < left ? kChanged : 0;
                    std::memcpy(&wanted, mask, sizeof wanted);
                }
                if ((eight & wanted) != 0) return true;
            }
        }
    return false;
}

std::int32_t ToothState::storeBrick(std::uint32_t dense) noexcept {
    const std::int32_t known = field_.storage().brickIndex[dense];
    if (known >= 0) return known;
    // The uncut tooth tells what is inside; the live bound may have been raised.
    if (model_->field.storage().coarse[dense] >= 0.0f) return -1;
    if (storedCount_ == storedRoom_) {
        outOfBricks_ = true;
        return -1;
    }
    const std::int32_t stored = storedCount_++;
    model_->uncutBrick(dense, values(stored));
    field_.storage().brickIndex[dense] = stored;
    ++storage().version;
    return stored;
}

void ToothState::noteWaiting(std::uint32_t dense, bool shows) noexcept {
    ++storage().version;
    std::uint8_t& flags = flags_[dense];
    if (shows) flags |= kShows;
    if ((flags & kWaiting) != 0) return;
    flags |= kWaiting;
    dirty_[nextDirty_++ % dirty_.size()] = dense;
}

void ToothState::noteChanged(std::uint32_t dense, bool shows) noexcept {
    noteWaiting(dense, shows);
    std::uint8_t& flags = flags_[dense];
    if ((flags & kChanged) != 0) return;
    flags |= kChanged;
    const std::array<std::int32_t, 3> brick = field::brickAt(field_.storage().bricks, dense);
    for (std::size_t k = 0; k < 3; ++k) {
        changedLow_[k] = changedCount_ == 0 ? brick[k] : std::min(changedLow_[k], brick[k]);
        changedHigh_[k] = changedCount_ == 0 ? brick[k] : std::max(changedHigh_[k], brick[k]);
    }
    ++changedCount_;
}

void ToothState::noteUncut(std::uint32_t dense) noexcept {
    noteWaiting(dense, true);
    std::uint8_t& flags = flags_[dense];
    if ((flags & kChanged) == 0) return;
    flags = static_cast<std::uint8_t>(flags & ~kChanged);
    --changedCount_;
}

void ToothState::addRemoved(const TissueVolumes& mm3) noexcept {
    for (std::size_t i = 0; i < cases::kTissueCount; ++i)
        removedMm3_[i] += mm3[i];
}

BrickSnapshot& ToothState::snapshotOfFirstDirty() noexcept {
    const std::uint32_t dense = dirty_[firstDirty_ % dirty_.size()];
    snapshot_.id = brickId(tooth_, dense);
    snapshot_.removedMm3 = removedMm3_;
    snapshot_.shows = (flags_[dense] & kShows) != 0;
    std::memcpy(snapshot_.values, values(field_.storage().brickIndex[dense]), kBrickBytes);
    return snapshot_;
}

void ToothState::dropFirstDirty() noexcept {
    std::uint8_t& flags = flags_[dirty_[firstDirty_++ % dirty_.size()]];
    flags = static_cast<std::uint8_t>(flags & ~(kWaiting | kShows));
}

void ToothState::shareFaces(std::uint32_t dense, std::int32_t stored,
                            std::span<const StateDelta::Brick> yetToCome) noexcept {
    const std::array<std::int32_t, 3> brick = field::brickAt(field_.storage().bricks, dense);
    const float* mine = values(stored);
    for (int neighbour = 0; neighbour < 27; ++neighbour) {
        const int step[3] = {neighbour % 3 - 1, neighbour / 3 % 3 - 1, neighbour / 9 - 1};
        if (neighbour == 13) continue;
        std::array<std::int32_t, 3> other = brick;
        int low[3], high[3], shift = 0;
        bool inGrid = true, differs = false;
        constexpr int kStride[3] = {1, field::kBrickNodes, field::kBrickNodes * field::kBrickNodes};
        for (std::size_t k = 0; k < 3; ++k) {
            other[k] += step[k];
            inGrid = inGrid && other[k] >= 0 && other[k] < field_.storage().bricks[k];
            low[k] = step[k] > 0 ? field::kBrickCells : 0;
            high[k] = step[k] < 0 ? 0 : field::kBrickCells;
            shift -= step[k] * field::kBrickCells * kStride[k];
        }
        if (!inGrid) continue;
        const std::uint32_t there = field::denseOf(field_.storage().bricks, other);
        const std::int32_t otherStored = field_.storage().brickIndex[there];
        if (otherStored < 0) continue;
        const auto turn = std::lower_bound(yetToCome.begin(), yetToCome.end(), brickId(tooth_, there),
                                           [](const StateDelta::Brick& b, BrickId id) { return b.id < id; });
        if (turn == yetToCome.end() || turn->id != brickId(tooth_, there)) continue;
        float* theirs = values(otherStored);
        const std::size_t run = sizeof(float) * static_cast<std::size_t>(high[0] - low[0] + 1);
        for (int z = low[2]; z <= high[2]; ++z)
            for (int y = low[1]; y <= high[1]; ++y) {
                const int at = low[0] + kStride[1] * y + kStride[2] * z;
                if (std::memcmp(&theirs[at + shift], &mine[at], run) == 0) continue;
                std::memcpy(&theirs[at + shift], &mine[at], run);
                differs = true;
            }
        if (differs) noteChanged(there, true);
    }
}

std::size_t ToothState::restore(const StateDelta& change, std::size_t from, std::size_t most) noexcept {
    const std::size_t count = change.bricks.size();
    const auto isMine = [&] { return from < count && toothOf(change.bricks[from].id) == tooth_; };
    for (; isMine() && most > 0; ++from, --most) {
        const StateDelta::Brick& brick = change.bricks[from];
        const std::uint32_t dense = denseOf(brick.id);
        if (dense >= dirty_.size() || (brick.uncut && field_.storage().brickIndex[dense] < 0)) continue;
        const std::int32_t stored = storeBrick(dense);
        if (stored < 0) continue;
        if (brick.uncut) {
            model_->uncutBrick(dense, values(stored));
            noteUncut(dense);
        } else {
            std::memcpy(values(stored), brick.values.data(), kBrickBytes);
            noteChanged(dense, true);
            raiseAround(dense, values(stored));
        }
        // Those whose turn is yet to come follow at once: the field is never torn on the way. All others are as they
        // will be, to the last bit, and stay so: a cut may leave two bricks an ulp apart on the nodes that they share.
        shareFaces(dense, stored, std::span(change.bricks).subspan(from + 1));
    }
    if (!isMine()) {
        removedMm3_ = change.removedMm3.of(tooth_);
        if (changedCount_ == 0) resetCoarse();
    }
    return from;
}

void ToothState::resetCoarse() noexcept {
    const std::vector<float>& uncut = model_->field.storage().coarse;
    for (std::size_t i = 0; i < uncut.size(); ++i)
        field_.storage().coarse[i] = std::max(uncut[i], -kCoarseDepthMm);
}

void ToothState::raiseAround(std::uint32_t dense, const float* values) noexcept {
    bool anyInside = false, anyOutside = false;
    for (int i = 0; i < field::kBrickValues; ++i) {
        anyInside |= values[i] < 0.0f;
        anyOutside |= values[i] >= 0.0f;
    }
    if (!anyInside || !anyOutside) return;
    // The surface lies somewhere in this brick: a centre is as far from it as from the brick's box, or farther.
    const auto edge = static_cast<float>(field::kBrickCells * field_.storage().settings.voxelMm);
    const auto reach = static_cast<std::int32_t>(std::ceil(kCoarseDepthMm / edge + 0.5f));
    const std::array<std::int32_t, 3> brick = field::brickAt(field_.storage().bricks, dense);
    std::array<std::int32_t, 3> low, high;
    for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::max(brick[k] - reach, 0);
        high[k] = std::min(brick[k] + reach, field_.storage().bricks[k] - 1);
    }
    // From a brick's centre to the box of one so many bricks away, along one axis.
    const auto gap = [edge](std::int32_t bricks) {
        const std::int32_t away = bricks < 0 ? -bricks : bricks;
        return away == 0 ? 0.0f : edge * (static_cast<float>(away) - 0.5f);
    };
    for (std::int32_t z = low[2]; z <= high[2]; ++z)
        for (std::int32_t y = low[1]; y <= high[1]; ++y) {
            const float across = gap(z - brick[2]) * gap(z - brick[2]) + gap(y - brick[1]) * gap(y - brick[1]);
            if (across >= kCoarseDepthMm * kCoarseDepthMm) continue;
            const std::uint32_t row = field::denseOf(field_.storage().bricks, {0, y, z});
            for (std::int32_t x = low[0]; x <= high[0]; ++x) {
                const std::size_t at = row + static_cast<std::uint32_t>(x);
                const float along = gap(x - brick[0]), bound = -std::sqrt(across + along * along);
                if (field_.storage().brickIndex[at] < 0 && field_.storage().coarse[at] < bound)
                    field_.storage().coarse[at] = bound;
            }
        }
}

StateDelta ToothState::state() const {
    StateDelta state;
    state.removedMm3.set(tooth_, removedMm3_);
    std::array<float, field::kBrickValues> uncut;
    for (std::uint32_t dense = 0; dense < dirty_.size(); ++dense) {
        if ((flags_[dense] & kChanged) == 0) continue;
        const float* now = &field_.storage().values[valueIndex(field_.storage().brickIndex[dense])];
        model_->uncutBrick(dense, uncut.data());
        if (std::memcmp(now, uncut.data(), kBrickBytes) == 0) continue;
        StateDelta::Brick& brick = state.bricks.emplace_back(StateDelta::Brick{brickId(tooth_, dense), false, {}});
        std::memcpy(brick.values.data(), now, kBrickBytes);
    }
    return state;
}

std::uint64_t ToothState::stateHash() const {
    return tooth::stateHash(state());
}

TissueVolumes ToothState::volumesMm3() const {
    return integrateVolumes(*model_, [&](std::uint32_t dense) -> const float* {
        const std::int32_t stored = field_.storage().brickIndex[dense];
        return stored < 0 ? nullptr : &field_.storage().values[valueIndex(stored)];
    });
}

}  // namespace handpiece::tooth
