// SPDX-License-Identifier: Apache-2.0
// What is done to a block in pieces of slices is as if it were done voxel by voxel.
#include "handpiece/scan/segmentation/voxels.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "handpiece/base/core/parallel.h"
#include "handpiece/scan/segmentation/work.h"
#include "support/random.h"

namespace handpiece::segmentation::voxels_test {
namespace {

/// Parts by flooding, named by their first voxels.
Parts flooded(const Shape& shape, const Mask& mask) {
    Parts parts;
    parts.of.assign(mask.size(), 0);
    parts.counts.push_back(0);
    for (std::size_t first = 0; first < mask.size(); ++first) {
        if (!mask[first] || parts.of[first] != 0) continue;
        const auto name = static_cast<std::uint32_t>(parts.counts.size());
        parts.counts.push_back(0);
        std::vector<std::size_t> open{first};
        parts.of[first] = name;
        while (!open.empty()) {
            const std::size_t at = open.back();
            open.pop_back();
            ++parts.counts[name];
            forNeighbours(shape, at, [&](std::size_t o) {
                if (!mask[o] || parts.of[o] != 0) return;
                parts.of[o] = name;
                open.push_back(o);
            });
        }
    }
    parts.counts[0] = static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 0));
    return parts;
}

TEST(Voxels, PartsAreThoseOfAFloodAtAnyThreadCount) {
    std::mt19937_64 random(test::seed());
    // Below the share at which most of a block hangs together, at it, and above.
    for (const double share : {0.05, 0.31, 0.34, 0.6}) {
        const Shape shape{{23, 31, 90}};
        Mask mask(shape.count());
        for (std::uint8_t& v : mask)
            v = test::uniform(random, 0.0, 1.0) < share;
        const Parts wanted = flooded(shape, mask);
        for (const std::size_t threads : {1, 4}) {
            core::setThreadCount(threads);
            const Parts found = connectedParts(shape, mask);
            core::setThreadCount(0);
            EXPECT_EQ(found.of, wanted.of) << share << ", " << threads << " threads";
            EXPECT_EQ(found.counts, wanted.counts);
        }
    }
}

TEST(Voxels, ValuesSpreadLayerByLayerAtAnyThreadCount) {
    std::mt19937_64 random(test::seed());
    const Shape shape{{40, 37, 50}};
    Mask unknown(shape.count());
    Field values(shape.count());
    for (std::size_t n = 0; n < values.size(); ++n) {
        const double r = test::uniform(random, 0.0, 1.0);
        unknown[n] = r < 0.02 ? 0 : r < 0.9 ? 1 : 2;
        values[n] = static_cast<float>(test::uniform(random, -1.0, 1.0));
    }
    // Each round the unknown beside a known one take the mean of those.
    Mask open = unknown;
    Field wanted = values;
    for (bool any = true; any;) {
        any = false;
        const Mask before = open;
        for (std::size_t n = 0; n < open.size(); ++n) {
            if (before[n] != 1) continue;
            float sum = 0, count = 0;
            forNeighbours(shape, n, [&](std::size_t o) {
                if (before[o] == 0) sum += wanted[o], count += 1;
            });
            if (count == 0) continue;
            wanted[n] = sum / count;
            open[n] = 0;
            any = true;
        }
    }
    for (const std::size_t threads : {1, 4}) {
        Field spread = values;
        core::setThreadCount(threads);
        spreadInto(shape, spread, unknown);
        core::setThreadCount(0);
        EXPECT_EQ(spread, wanted) << threads << " threads";
    }
}

}  // namespace
}  // namespace handpiece::segmentation::voxels_test
