// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/fixed_vector.h"

#include <gtest/gtest.h>

namespace handpiece::core::fixed_vector_test {
namespace {

TEST(FixedVector, countsWhatDoesNotFit) {
    FixedVector<int, 3> v;
    EXPECT_TRUE(v.empty());
    for (int i = 0; i < 5; ++i)
        EXPECT_EQ(v.pushBack(i), i < 3);
    EXPECT_EQ(v.size(), 3u);
    EXPECT_EQ(v.dropped(), 2u);
    EXPECT_EQ(v[2], 2);
    int sum = 0;
    for (const int x : v)
        sum += x;
    EXPECT_EQ(sum, 3);
    v.clear();
    EXPECT_TRUE(v.empty());
    EXPECT_EQ(v.dropped(), 0u);
}

}  // namespace
}  // namespace handpiece::core::fixed_vector_test
