// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/tooth/state_delta.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>

#include "handpiece/base/core/hash.h"

namespace handpiece::tooth {

const TissueVolumes& RemovedMm3::of(std::uint16_t tooth) const noexcept {
    static constexpr TissueVolumes kNothing{};
    if (tooth == 0) return own;
    return tooth <= others.size() ? others[tooth - 1u] : kNothing;
}

void RemovedMm3::set(std::uint16_t tooth, const TissueVolumes& mm3) {
    if (tooth == 0) {
        own = mm3;
    } else if (tooth <= others.size() || sumOf(mm3) != 0.0) {
        others.resize(std::max<std::size_t>(others.size(), tooth));
        others[tooth - 1u] = mm3;
    }
}

double RemovedMm3::sumOfOthers() const noexcept {
    double sum = 0.0;
    for (const TissueVolumes& mm3 : others)
        sum += sumOf(mm3);
    return sum;
}

bool RemovedMm3::operator==(const RemovedMm3& other) const noexcept {
    const auto teeth = static_cast<std::uint16_t>(std::max(others.size(), other.others.size()));
    for (std::uint16_t tooth = 0; tooth <= teeth; ++tooth)
        if (of(tooth) != other.of(tooth)) return false;
    return true;
}

double sumOf(const TissueVolumes& mm3) noexcept {
    return std::accumulate(mm3.begin(), mm3.end(), 0.0);
}

void StateDelta::append(StateDelta&& ofTooth) {
    bricks.insert(bricks.end(), ofTooth.bricks.begin(), ofTooth.bricks.end());
    for (std::uint16_t tooth = 1; tooth <= ofTooth.removedMm3.others.size(); ++tooth)
        removedMm3.set(tooth, ofTooth.removedMm3.of(tooth));
}

std::uint64_t stateHash(const StateDelta& state) {
    core::Hasher hasher;
    for (const StateDelta::Brick& brick : state.bricks) {
        if (brick.uncut) continue;
        hasher.add(brick.id);
        hasher.add(std::as_bytes(std::span(brick.values)));
    }
    return hasher.value();
}

StateDelta changeBetween(const StateDelta& from, const StateDelta& to) {
    StateDelta change;
    change.removedMm3 = to.removedMm3;
    auto before = from.bricks.begin();
    const auto toUncut = [&](BrickId limit) {
        for (; before != from.bricks.end() && before->id < limit; ++before)
            if (!before->uncut) change.bricks.push_back({before->id, true, {}});
    };
    for (const StateDelta::Brick& after : to.bricks) {
        toUncut(after.id);
        const bool known = before != from.bricks.end() && before->id == after.id;
        const bool wasUncut = !known || before->uncut;
        if (after.uncut ? !wasUncut
                        : wasUncut || std::memcmp(before->values.data(), after.values.data(), kBrickBytes) != 0)
            change.bricks.push_back(after);
        if (known) ++before;
    }
    toUncut(std::numeric_limits<BrickId>::max());
    return change;
}

}  // namespace handpiece::tooth
