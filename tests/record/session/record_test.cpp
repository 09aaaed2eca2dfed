// SPDX-License-Identifier: Apache-2.0
#include "handpiece/record/session/record.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "record/session/made_up_hand.h"
#include "support/random.h"

namespace handpiece::record_test {
namespace {

bool sameBits(double a, double b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST(Record, GivesTheInputsBackBitForBit) {
    test::MadeUpHand hand(test::seed());
    for (int i = 0; i < 20000; ++i) {
        messages::HapticSample s = hand.next();
        s.buttons = static_cast<std::uint32_t>(i);
        s.elapsedPeriods = 1 + i % 7;
        if (i % 2 != 0) {
            for (double& c : s.orientation)
                c = -c;  // the same rotation, other bits
        }
        const session::Record r = session::recordOf(s);
        const session::Inputs in = session::inputsOf(r);
        for (std::size_t k = 0; k < 3; ++k)
            ASSERT_TRUE(sameBits(in.positionMm[k], s.positionMm[k] + 0.0)) << i;
        for (std::size_t k = 0; k < 4; ++k)
            ASSERT_EQ(in.orientation[k], s.orientation[k]) << i;
        ASSERT_EQ(in.pedal, s.pedal);
        ASSERT_EQ(in.buttons, s.buttons);
        ASSERT_EQ(r.elapsedPeriods, s.elapsedPeriods);
        ASSERT_NEAR(r.forceN[2], s.forceN[2], 0x1p-11);
        ASSERT_NEAR(r.removedMm3[1], s.removedMm3[1], 0x1p-17);
    }
}

TEST(Record, EveryUnitQuaternionComesBackThroughItsCode) {
    std::mt19937_64 generator(test::seed());
    std::int64_t largest = 0;
    for (int i = 0; i < 200000; ++i) {
        core::Quat q = test::randomRotation(generator);
        if (i % 10 == 0) q = core::Quat(1e-7 * test::uniform(generator, -1, 1), q.x(), q.y(), q.z()).normalized();
        const auto steps = [](double c) { return static_cast<std::int32_t>(std::nearbyint(c * 0x1p30)); };
        const std::array<std::int32_t, 3> xyz{steps(q.x()), steps(q.y()), steps(q.z())};
        const std::int32_t w = steps(q.w()), code = session::wCodeOf(xyz, w);
        ASSERT_EQ(session::wOf(xyz, code), w);
        if (std::abs(q.w()) > 0.1) largest = std::max<std::int64_t>(largest, std::abs(code));
    }
    EXPECT_LE(largest, 20);  // small numbers, or it would not pack
    // Far from unit length there is no code, and so no number.
    EXPECT_EQ(session::wCodeOf({0, 0, 0}, 0), session::kNoNumber);
    EXPECT_EQ(session::wOf({1, 2, 3}, session::kNoNumber), session::kNoNumber);
}

TEST(Record, WhatIsNoNumberComesBackAsNone) {
    messages::HapticSample s;
    s.positionMm = {std::numeric_limits<double>::quiet_NaN(), 1e30, 1.0};
    s.orientation = {std::numeric_limits<double>::infinity(), 0, 0, 0};
    const session::Inputs in = session::inputsOf(session::recordOf(s));
    EXPECT_TRUE(std::isnan(in.positionMm[0]));
    EXPECT_TRUE(std::isnan(in.positionMm[1]));
    EXPECT_EQ(in.positionMm[2], 1.0);
    EXPECT_TRUE(std::isnan(in.orientation[0]));
}

}  // namespace
}  // namespace handpiece::record_test
