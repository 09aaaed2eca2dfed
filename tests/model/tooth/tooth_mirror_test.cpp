// SPDX-License-Identifier: Apache-2.0
/// @file
/// The mirror follows the field by what it is handed, whatever the order and however late.

#include <gtest/gtest.h>

#include <bit>

#include "support/cut_support.h"

namespace handpiece::tooth::tooth_mirror_test {
namespace {

using core::Vec3;
using in_test::ballTooth;
using in_test::cutAway;

TEST(ToothMirror, FollowsTheField) {
    const auto base = ballTooth(1.5, 0.8, 0.05);
    ToothState field(base);
    ToothMirror mirror(base);
    std::mt19937_64 generator(handpiece::test::seed());
    const StateDelta uncut = field.state();
    std::vector<std::uint32_t> touched;
    for (int step = 0; step < 5; ++step) {
        const Vec3 centre = handpiece::test::randomDirection(generator) * 1.4;
        cutAway(field, [&](const Vec3& p) { return in_test::ball(p - centre, 0.3); });
        (void)field.handOver(7, [&](const BrickSnapshot& s) {
            mirror.apply(s);
            touched.push_back(s.id);
            return true;
        });
    }
    while (field.waitingBricks() > 0)
        (void)field.handOver(1000, [&](const BrickSnapshot& s) {
            mirror.apply(s);
            touched.push_back(s.id);
            return true;
        });
    EXPECT_EQ(stateHash(mirror.state({})), field.stateHash());
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    EXPECT_EQ(mirror.takeTouched(), touched);
    EXPECT_TRUE(mirror.takeTouched().empty());

    // An undo comes through snapshots like any cut, or at once as a change.
    const StateDelta cut = field.state();
    const StateDelta undo = changeBetween(cut, uncut);
    (void)field.restore(undo, 0, undo.bricks.size());
    (void)field.handOver(100000, [&](const BrickSnapshot& s) {
        mirror.apply(s);
        return true;
    });
    EXPECT_TRUE(mirror.state({}).bricks.empty());
    mirror.apply(changeBetween(uncut, cut));
    EXPECT_EQ(stateHash(mirror.state({})), stateHash(cut));
    mirror.apply(undo);
    EXPECT_TRUE(mirror.state({}).bricks.empty());
    EXPECT_FALSE(mirror.isChanged(cut.bricks[0].id));
    std::array<float, field::kBrickValues> scratch, wanted;
    base->uncutBrick(cut.bricks[0].id, wanted.data());
    const float* values = mirror.values(cut.bricks[0].id, scratch.data());
    EXPECT_TRUE(std::equal(wanted.begin(), wanted.end(), values));
}

TEST(StateDelta, ChangesLeadFromAnyStateToAnyOther) {
    const auto base = ballTooth(1.2, 0.6, 0.05);
    ToothState one(base), two(base);
    cutAway(one, [](const Vec3& p) { return in_test::ball(p - Vec3(1.2, 0, 0), 0.4); });
    cutAway(two, [](const Vec3& p) { return in_test::ball(p - Vec3(0.9, 0.6, 0), 0.4); });
    const StateDelta a = one.state(), b = two.state();
    const StateDelta change = changeBetween(a, b);
    std::size_t uncut = 0;
    for (std::size_t i = 0; i < change.bricks.size(); ++i) {
        uncut += change.bricks[i].uncut;
        EXPECT_TRUE(i == 0 || change.bricks[i - 1].id < change.bricks[i].id);
    }
    EXPECT_GT(uncut, 0u);
    EXPECT_LT(uncut, change.bricks.size());
    ToothMirror mirror(base);
    mirror.apply(a);
    mirror.apply(change);
    EXPECT_EQ(stateHash(mirror.state({})), stateHash(b));
    EXPECT_TRUE(changeBetween(a, a).bricks.empty());
    EXPECT_TRUE(changeBetween(StateDelta{}, StateDelta{}).bricks.empty());
}

}  // namespace
}  // namespace handpiece::tooth::tooth_mirror_test
