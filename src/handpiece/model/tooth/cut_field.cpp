// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/tooth/cut_field.h"

#include <cmath>
#include <cstring>

#include "handpiece/base/core/hash.h"
#include "handpiece/model/tooth/cut_volumes.h"

namespace handpiece::tooth {
namespace {

constexpr std::uint8_t kChanged = 1, kWaiting = 2, kShows = 4;
constexpr std::size_t kBrickBytes = sizeof(float) * field::kBrickValues;

}  // namespace

CutField::CutField(std::shared_ptr<const CuttableTooth> base) : base_(std::move(base)), field_(base_->tooth->field) {
    const std::size_t dense = field_.brickIndex_.size();
    storedCount_ = static_cast<std::int32_t>(field_.brickCount());
    storedRoom_ = storedCount_ + static_cast<std::int32_t>(base_->settings.reserveBricks);
    field_.settings_.bandInMm = std::min(field_.settings_.bandInMm, base_->settings.bandMm);
    // Writing all of it brings the pages in now rather than in the tick.
    field_.values_.resize(valueIndex(storedRoom_), static_cast<float>(-base_->settings.bandMm));
    field_.tissue_.resize(valueIndex(storedRoom_), static_cast<std::uint8_t>(cases::Tissue::none));
    for (std::size_t i = 0; i < dense; ++i) {
        const auto brick = static_cast<std::uint32_t>(i);
        field_.coarse_[i] = std::max(field_.coarse_[i], -kCoarseDepthMm);
        const std::int32_t stored = field_.brickIndex_[i];
        if (stored < 0) {
            const std::uint8_t* nodes = base_->tissues.nodes(brick);
            if (field_.coarse_[i] < 0.0f)
                field_.coarseTissue_[i] = nodes != nullptr ? nodes[field::kBrickValues / 2]
                                                           : static_cast<std::uint8_t>(base_->tissues.ofBrick(brick));
            continue;
        }
        base_->wholeBrick(brick, values(stored));
        copyTissues(base_->tissues, brick, &field_.tissue_[valueIndex(stored)]);
    }
    flags_.assign(dense + sizeof(std::uint64_t), 0);
    dirty_.assign(dense, 0);
    std::memset(snapshot_.values, 0, kBrickBytes);
}

bool CutField::isCutNear(const core::Box& box) const noexcept {
    if (changedCount_ == 0) return false;
    const double perMm = 1.0 / (field::kBrickCells * field_.settings_.voxelMm);
    std::int32_t low[3], high[3];
    for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        const double first = std::floor((box.min[k] - field_.originMm_[k]) * perMm),
                     last = std::floor((box.max[k] - field_.originMm_[k]) * perMm);
        if (!(first <= last && first <= changedHigh_[axis] && last >= changedLow_[axis])) return false;
        low[k] = first > changedLow_[axis] ? static_cast<std::int32_t>(first) : changedLow_[axis];
        high[k] = last < changedHigh_[axis] ? static_cast<std::int32_t>(last) : changedHigh_[axis];
    }
    // Eight bricks of a row at once.
    constexpr std::uint64_t kAnyChanged = 0x0101010101010101ull * kChanged;
    for (std::int32_t z = low[2]; z <= high[2]; ++z)
        for (std::int32_t y = low[1]; y <= high[1]; ++y) {
            const std::uint8_t* row =
                &flags_[static_cast<std::size_t>(field_.bricks_[0]) *
                        (static_cast<std::size_t>(y) +
                         static_cast<std::size_t>(field_.bricks_[1]) * static_cast<std::size_t>(z))];
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

std::int32_t CutField::storeBrick(std::uint32_t dense) noexcept {
    const std::int32_t known = field_.brickIndex_[dense];
    if (known >= 0) return known;
    // The whole tooth tells what is inside; the live bound may have been raised.
    if (base_->tooth->field.coarse_[dense] >= 0.0f) return -1;
    if (storedCount_ == storedRoom_) {
        outOfBricks_ = true;
        return -1;
    }
    const std::int32_t stored = storedCount_++;
    base_->wholeBrick(dense, values(stored));
    copyTissues(base_->tissues, dense, &field_.tissue_[valueIndex(stored)]);
    field_.brickIndex_[dense] = stored;
    ++version_;
    return stored;
}

void CutField::noteWaiting(std::uint32_t dense, bool shows) noexcept {
    ++version_;
    std::uint8_t& flags = flags_[dense];
    if (shows) flags |= kShows;
    if ((flags & kWaiting) != 0) return;
    flags |= kWaiting;
    dirty_[nextDirty_++ % dirty_.size()] = dense;
}

void CutField::noteChanged(std::uint32_t dense, bool shows) noexcept {
    noteWaiting(dense, shows);
    std::uint8_t& flags = flags_[dense];
    if ((flags & kChanged) != 0) return;
    flags |= kChanged;
    const std::array<std::int32_t, 3> brick = field::brickAt(field_.bricks_, dense);
    for (std::size_t k = 0; k < 3; ++k) {
        changedLow_[k] = changedCount_ == 0 ? brick[k] : std::min(changedLow_[k], brick[k]);
        changedHigh_[k] = changedCount_ == 0 ? brick[k] : std::max(changedHigh_[k], brick[k]);
    }
    ++changedCount_;
}

void CutField::noteWhole(std::uint32_t dense) noexcept {
    noteWaiting(dense, true);
    std::uint8_t& flags = flags_[dense];
    if ((flags & kChanged) == 0) return;
    flags = static_cast<std::uint8_t>(flags & ~kChanged);
    --changedCount_;
}

void CutField::addRemoved(const TissueVolumes& mm3) noexcept {
    for (std::size_t i = 0; i < cases::kTissueCount; ++i)
        removedMm3_[i] += mm3[i];
}

const BrickSnapshot& CutField::snapshotOfFirstDirty() noexcept {
    const std::uint32_t dense = dirty_[firstDirty_ % dirty_.size()];
    snapshot_.dense = dense;
    snapshot_.shows = (flags_[dense] & kShows) != 0;
    std::memcpy(snapshot_.values, values(field_.brickIndex_[dense]), kBrickBytes);
    return snapshot_;
}

void CutField::dropFirstDirty() noexcept {
    std::uint8_t& flags = flags_[dirty_[firstDirty_++ % dirty_.size()]];
    flags = static_cast<std::uint8_t>(flags & ~(kWaiting | kShows));
}

void CutField::shareFaces(std::uint32_t dense, std::int32_t stored) noexcept {
    const std::array<std::int32_t, 3> brick = field::brickAt(field_.bricks_, dense);
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
            inGrid = inGrid && other[k] >= 0 && other[k] < field_.bricks_[k];
            low[k] = step[k] > 0 ? field::kBrickCells : 0;
            high[k] = step[k] < 0 ? 0 : field::kBrickCells;
            shift -= step[k] * field::kBrickCells * kStride[k];
        }
        if (!inGrid) continue;
        const std::uint32_t there = field::denseOf(field_.bricks_, other);
        const std::int32_t otherStored = field_.brickIndex_[there];
        if (otherStored < 0) continue;
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

std::size_t CutField::restore(const StateDelta& change, std::size_t from, std::size_t most) noexcept {
    const std::size_t count = change.bricks.size();
    for (; from < count && most > 0; ++from, --most) {
        const StateDelta::Brick& brick = change.bricks[from];
        if (brick.whole && field_.brickIndex_[brick.dense] < 0) continue;
        const std::int32_t stored = storeBrick(brick.dense);
        if (stored < 0) continue;
        if (brick.whole) {
            base_->wholeBrick(brick.dense, values(stored));
            noteWhole(brick.dense);
        } else {
            std::memcpy(values(stored), brick.values.data(), kBrickBytes);
            noteChanged(brick.dense, true);
            raiseAround(brick.dense, values(stored));
        }
        // Its neighbours follow at once, also those whose turn is yet to come: the field is never torn.
        shareFaces(brick.dense, stored);
    }
    if (from == count) {
        removedMm3_ = change.removedMm3;
        if (changedCount_ == 0) resetCoarse();
    }
    return from;
}

void CutField::resetCoarse() noexcept {
    const std::vector<float>& whole = base_->tooth->field.coarse_;
    for (std::size_t i = 0; i < whole.size(); ++i)
        field_.coarse_[i] = std::max(whole[i], -kCoarseDepthMm);
}

void CutField::raiseAround(std::uint32_t dense, const float* values) noexcept {
    bool anyInside = false, anyOutside = false;
    for (int i = 0; i < field::kBrickValues; ++i) {
        anyInside |= values[i] < 0.0f;
        anyOutside |= values[i] >= 0.0f;
    }
    if (!anyInside || !anyOutside) return;
    // The surface lies somewhere in this brick: a centre is as far from it as from the brick's box, or farther.
    const auto edge = static_cast<float>(field::kBrickCells * field_.settings_.voxelMm);
    const auto reach = static_cast<std::int32_t>(std::ceil(kCoarseDepthMm / edge + 0.5f));
    const std::array<std::int32_t, 3> brick = field::brickAt(field_.bricks_, dense);
    std::array<std::int32_t, 3> low, high;
    for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::max(brick[k] - reach, 0);
        high[k] = std::min(brick[k] + reach, field_.bricks_[k] - 1);
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
            const std::uint32_t row = field::denseOf(field_.bricks_, {0, y, z});
            for (std::int32_t x = low[0]; x <= high[0]; ++x) {
                const std::size_t at = row + static_cast<std::uint32_t>(x);
                const float along = gap(x - brick[0]), bound = -std::sqrt(across + along * along);
                if (field_.brickIndex_[at] < 0 && field_.coarse_[at] < bound) field_.coarse_[at] = bound;
            }
        }
}

StateDelta CutField::state() const {
    StateDelta state;
    state.removedMm3 = removedMm3_;
    std::array<float, field::kBrickValues> whole;
    for (std::uint32_t dense = 0; dense < dirty_.size(); ++dense) {
        if ((flags_[dense] & kChanged) == 0) continue;
        const float* now = &field_.values_[valueIndex(field_.brickIndex_[dense])];
        base_->wholeBrick(dense, whole.data());
        if (std::memcmp(now, whole.data(), kBrickBytes) == 0) continue;
        StateDelta::Brick& brick = state.bricks.emplace_back(StateDelta::Brick{dense, false, {}});
        std::memcpy(brick.values.data(), now, kBrickBytes);
    }
    return state;
}

std::uint64_t stateHash(const StateDelta& state) {
    core::Hasher hasher;
    for (const StateDelta::Brick& brick : state.bricks) {
        if (brick.whole) continue;
        hasher.add(brick.dense);
        hasher.add(std::as_bytes(std::span(brick.values)));
    }
    return hasher.value();
}

StateDelta changeBetween(const StateDelta& from, const StateDelta& to) {
    StateDelta change;
    change.removedMm3 = to.removedMm3;
    auto before = from.bricks.begin();
    const auto toWhole = [&](std::uint32_t limit) {
        for (; before != from.bricks.end() && before->dense < limit; ++before)
            if (!before->whole) change.bricks.push_back({before->dense, true, {}});
    };
    for (const StateDelta::Brick& after : to.bricks) {
        toWhole(after.dense);
        const bool known = before != from.bricks.end() && before->dense == after.dense;
        const bool wasWhole = !known || before->whole;
        if (after.whole ? !wasWhole
                        : wasWhole || std::memcmp(before->values.data(), after.values.data(), kBrickBytes) != 0)
            change.bricks.push_back(after);
        if (known) ++before;
    }
    toWhole(std::numeric_limits<std::uint32_t>::max());
    return change;
}

std::uint64_t CutField::stateHash() const {
    return tooth::stateHash(state());
}

TissueVolumes CutField::volumesMm3() const {
    return integrateVolumes(*base_, [&](std::uint32_t dense) -> const float* {
        const std::int32_t stored = field_.brickIndex_[dense];
        return stored < 0 ? nullptr : &field_.values_[valueIndex(stored)];
    });
}

}  // namespace handpiece::tooth
