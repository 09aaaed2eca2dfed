// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/tooth/state_delta.h"

#include <cstring>
#include <limits>

#include "handpiece/base/core/hash.h"

namespace handpiece::tooth {

std::uint64_t stateHash(const StateDelta& state) {
    core::Hasher hasher;
    for (const StateDelta::Brick& brick : state.bricks) {
        if (brick.uncut) continue;
        hasher.add(brick.dense);
        hasher.add(std::as_bytes(std::span(brick.values)));
    }
    return hasher.value();
}

StateDelta changeBetween(const StateDelta& from, const StateDelta& to) {
    StateDelta change;
    change.removedMm3 = to.removedMm3;
    auto before = from.bricks.begin();
    const auto toUncut = [&](std::uint32_t limit) {
        for (; before != from.bricks.end() && before->dense < limit; ++before)
            if (!before->uncut) change.bricks.push_back({before->dense, true, {}});
    };
    for (const StateDelta::Brick& after : to.bricks) {
        toUncut(after.dense);
        const bool known = before != from.bricks.end() && before->dense == after.dense;
        const bool wasUncut = !known || before->uncut;
        if (after.uncut ? !wasUncut
                        : wasUncut || std::memcmp(before->values.data(), after.values.data(), kBrickBytes) != 0)
            change.bricks.push_back(after);
        if (known) ++before;
    }
    toUncut(std::numeric_limits<std::uint32_t>::max());
    return change;
}

}  // namespace handpiece::tooth
