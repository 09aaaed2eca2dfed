// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/exact/outline_search.h"

#include <gtest/gtest.h>

#include <vector>

#include "handpiece/base/core/simd.h"
#include "handpiece/model/instrument/shapes.h"
#include "tick/contact/contact_fixture.h"

namespace handpiece::contact::outline_search_test {
namespace {

TEST(OutlineSearch, everyInstructionSetGivesTheSameBits) {
    std::vector<OutlineSearch> all;
    const instrument::Bur bur = instrument::makeBur("inverted-cone:1.2x1.2");
    for (const core::SimdLevel level : test::levels())
        all.emplace_back(bur, level);
    ASSERT_TRUE(all.front().isFit());
    if (all.size() == 1) GTEST_SKIP() << "this processor has one level only";
    const ExactSurface surface(test::grooved().tree, test::grooved().field, core::SimdLevel::base);
    std::mt19937_64 g(test::seed());
    int apart = 0;
    for (int i = 0; i < 1000; ++i) {
        const core::Pose pose{test::anywhere(g), test::randomRotation(g)};
        BallDepth first;
        for (std::size_t level = 0; level < all.size(); ++level) {
            BallDepth found;
            const bool isApart = all[level].search(surface, BurFrame(pose), found);
            if (level == 0) first = found;
            apart += isApart;
            EXPECT_EQ(found.depthMm, first.depthMm);
            EXPECT_EQ(found.surfaceMm, first.surfaceMm);
            EXPECT_EQ(found.centreMm, first.centreMm);
        }
    }
    EXPECT_GT(apart, 300);
}

TEST(OutlineSearch, fitBursWithSharpRimsThatAreConvex) {
    for (const char* name : {"cylinder-flat:1.0x4.0", "wheel:2.0x0.8", "inverted-cone:1.2x1.2", "taper-flat:1.2x4.0"})
        EXPECT_TRUE(OutlineSearch(instrument::makeBur(name), core::simdLevel()).isFit()) << name;
    // Nothing to spare where the medial axis is the bur's own axis.
    EXPECT_FALSE(OutlineSearch(instrument::makeBur("cylinder-round:1.0x4.0"), core::simdLevel()).isFit());
}

}  // namespace
}  // namespace handpiece::contact::outline_search_test
