// SPDX-License-Identifier: Apache-2.0
/// @file
/// The field that is cut: what it holds, hands over, puts back and counts.

#include <gtest/gtest.h>

#include <bit>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "support/cut_support.h"
#include "support/realtime_trap.h"

namespace handpiece::tooth::tooth_state_test {
namespace {

using core::Vec3;
using in_test::ballTooth;
using in_test::cutAway;

double ballMm3(double radius) {
    return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}
double of(const TissueVolumes& v, cases::Tissue tissue) {
    return v[static_cast<std::size_t>(tissue)];
}

TEST(ToothState, VolumesByTissueAreThoseOfTheShapes) {
    const auto base = ballTooth(2.0, 1.2, 0.05);
    // Inner boundaries count by whole nodes, and this ball lies evenly on them.
    EXPECT_NEAR(of(base->volumesMm3, cases::Tissue::dentine), ballMm3(1.2), 4e-3 * ballMm3(1.2));
    EXPECT_NEAR(of(base->volumesMm3, cases::Tissue::dentine) + of(base->volumesMm3, cases::Tissue::enamel),
                ballMm3(2.0), 3e-4 * ballMm3(2.0));
    EXPECT_NEAR(of(base->volumesMm3, cases::Tissue::enamel), ballMm3(2.0) - ballMm3(1.2), 1e-3 * ballMm3(2.0));
    ToothState field(base);
    EXPECT_EQ(field.volumesMm3(), base->volumesMm3);

    // A ball of 0.5 mm out of the dentine, and one out of enamel and dentine along x.
    cutAway(field, [](const Vec3& p) { return in_test::ball(p, 0.5); });
    const TissueVolumes once = field.volumesMm3();
    EXPECT_NEAR(of(base->volumesMm3, cases::Tissue::dentine) - of(once, cases::Tissue::dentine), ballMm3(0.5),
                4e-3 * ballMm3(0.5));
    EXPECT_EQ(of(once, cases::Tissue::enamel), of(base->volumesMm3, cases::Tissue::enamel));
    const Vec3 there(1.2, 0.0, 0.0);
    cutAway(field, [&](const Vec3& p) { return in_test::ball(p - there, 0.3); });
    const TissueVolumes twice = field.volumesMm3();
    const double enamel = of(once, cases::Tissue::enamel) - of(twice, cases::Tissue::enamel),
                 dentine = of(once, cases::Tissue::dentine) - of(twice, cases::Tissue::dentine);
    EXPECT_NEAR(enamel + dentine, ballMm3(0.3), 5e-3 * ballMm3(0.3));
    // The lens of two balls at distance d, R 1.2 and r 0.3.
    const double r = 0.3, big = 1.2, d = 1.2;
    const double lens = std::numbers::pi * (big + r - d) * (big + r - d) *
                        (d * d + 2 * d * r - 3 * r * r + 2 * d * big + 6 * r * big - 3 * big * big) / (12 * d);
    EXPECT_NEAR(dentine, lens, 0.03 * ballMm3(0.3));
}

TEST(ToothState, WholeBricksAgreeOnTheNodesTheyShare) {
    // Also with a band deeper than the field's own, where most of it is only a bound.
    for (const auto& [band, bandIn] : {std::pair{0.2, 0.3}, {0.3, 0.1}, {0.3, 0.3}}) {
        CutSettings settings;
        settings.bandMm = band;
        const auto base = ballTooth(2.0, 1.0, 0.05, settings, bandIn);
        ToothState field(base);
        const field::FieldView view = field.field().view();
        std::size_t fresh = 0;
        for (std::uint32_t dense = 0; dense < in_test::denseCount(field.field()); ++dense) {
            const bool had = view.brickIndex[dense] >= 0;
            const std::int32_t stored = field.storeBrick(dense);
            if (!had && stored >= 0) ++fresh;
            EXPECT_EQ(stored >= 0, had || view.coarse[dense] < 0.0f);
        }
        EXPECT_FALSE(field.outOfBricks());
        EXPECT_EQ(fresh, base->settings.reserveBricks);
        EXPECT_EQ(in_test::tornNodes(field), 0u);
        EXPECT_EQ(field.volumesMm3(), base->volumesMm3);
        EXPECT_TRUE(field.state().bricks.empty());
        // The bounds never claim to be deeper than it is.
        for (std::uint32_t dense = 0; dense < in_test::denseCount(field.field()); ++dense) {
            if (view.brickIndex[dense] < 0) continue;
            const auto brick = field::brickAt(view.bricks, dense);
            for (int i = 0; i < field::kBrickValues; i += 7) {
                const int node[3] = {i % 9, i / 9 % 9, i / 81};
                Vec3 p;
                for (int k = 0; k < 3; ++k)
                    p[k] = view.originMm[k] + view.voxelMm * (8 * brick[static_cast<std::size_t>(k)] + node[k]);
                const double value = field.values(view.brickIndex[dense])[i], wanted = in_test::ball(p, 2.0);
                EXPECT_GE(value, std::clamp(wanted, -band, base->bandOutMm) - 1e-6);
                EXPECT_LE(value, std::max(0.0, wanted) + 1e-6);
            }
        }
    }
}

TEST(ToothState, HashesTheToothAndNotItsHistory) {
    const auto base = ballTooth(1.5, 0.8, 0.05);
    const auto shapeA = [](const Vec3& p) { return in_test::ball(p - Vec3(1.4, 0, 0), 0.4); };
    const auto shapeB = [](const Vec3& p) { return in_test::ball(p - Vec3(0.9, 0.5, 0), 0.4); };
    ToothState one(base), two(base);
    EXPECT_EQ(one.stateHash(), two.stateHash());
    cutAway(one, shapeA);
    EXPECT_NE(one.stateHash(), two.stateHash());
    cutAway(one, shapeB);
    // The other way round, after bricks that stay uncut were stored.
    for (std::uint32_t dense = in_test::denseCount(two.field()); dense-- > 0;)
        if (dense % 3 == 0) (void)two.storeBrick(dense);
    cutAway(two, shapeB);
    cutAway(two, shapeA);
    EXPECT_EQ(one.stateHash(), two.stateHash());
    EXPECT_EQ(in_test::tornNodes(one), 0u);
    EXPECT_EQ(in_test::tornNodes(two), 0u);
    core::setThreadCount(1);
    const TissueVolumes alone = two.volumesMm3();
    core::setThreadCount(0);
    EXPECT_EQ(alone, one.volumesMm3());
}

TEST(ToothState, RestoresInPiecesWithoutATear) {
    const auto base = ballTooth(1.5, 0.8, 0.05);
    std::mt19937_64 generator(handpiece::test::seed());
    ToothState field(base);
    std::vector<StateDelta> states{field.state()};
    for (int step = 0; step < 4; ++step) {
        const Vec3 centre = handpiece::test::randomDirection(generator) * handpiece::test::uniform(generator, 0.0, 1.6);
        const double radius = handpiece::test::uniform(generator, 0.2, 0.6);
        cutAway(field, [&](const Vec3& p) { return in_test::ball(p - centre, radius); });
        TissueVolumes removed{};
        removed[1] = step + 1.0;
        field.addRemoved(removed);
        EXPECT_EQ(in_test::tornNodes(field), 0u);
        states.push_back(field.state());
    }
    for (int step = 0; step < 12; ++step) {
        const StateDelta& target = states[generator() % states.size()];
        const StateDelta change = changeBetween(field.state(), target);
        const std::size_t most = 1 + generator() % 7;
        std::size_t from = 0;
        for (int calls = 0; from < change.bricks.size(); ++calls) {
            from = field.restore(change, from, most);
            ASSERT_LE(calls, 100000);
            if (calls % 16 == 0) {
                ASSERT_EQ(in_test::tornNodes(field), 0u);
            }
        }
        if (change.bricks.empty()) (void)field.restore(change, 0, most);
        EXPECT_EQ(in_test::tornNodes(field), 0u);
        EXPECT_EQ(field.stateHash(), stateHash(target));
        EXPECT_EQ(field.removedMm3(), target.removedMm3.own);
    }
}

TEST(ToothState, IsPutBackToTheBitAlsoWhereBricksAreAnUlpApart) {
    const auto base = ballTooth(2.0, 1.0, 0.05);
    ToothState cut(base);
    cutAway(cut, [](const Vec3& p) { return in_test::ball(p - Vec3(1.9, 0.1, -0.2), 0.5); });
    StateDelta state = cut.state();
    // As a cut leaves it: one brick has risen by an ulp at nodes where its neighbour, which did not change, has not.
    std::size_t apart = 0;
    const field::FieldView view = cut.field().view();
    std::vector<BrickId> changed;
    for (const StateDelta::Brick& brick : state.bricks)
        changed.push_back(brick.id);
    for (StateDelta::Brick& brick : state.bricks) {
        auto other = field::brickAt(view.bricks, denseOf(brick.id));
        --other[1];
        const std::uint32_t there = field::denseOf(view.bricks, other);
        if (view.brickIndex[there] < 0 || std::binary_search(changed.begin(), changed.end(), brickId(0, there)))
            continue;
        for (int x = 1; x < 8; ++x)
            brick.values[static_cast<std::size_t>(x)] = std::nextafter(brick.values[static_cast<std::size_t>(x)], 1.0f);
        ++apart;
    }
    ASSERT_GT(apart, 0u);
    for (const std::size_t most : {std::size_t{1}, std::size_t{7}, state.bricks.size()}) {
        ToothState field(base);
        for (std::size_t from = 0; from < state.bricks.size();)
            from = field.restore(state, from, most);
        EXPECT_EQ(field.stateHash(), stateHash(state)) << most;
        // And back again, and once more.
        const StateDelta undo = changeBetween(state, StateDelta{});
        for (std::size_t from = 0; from < undo.bricks.size();)
            from = field.restore(undo, from, most);
        EXPECT_TRUE(field.state().bricks.empty()) << most;
        for (std::size_t from = 0; from < state.bricks.size();)
            from = field.restore(state, from, most);
        EXPECT_EQ(field.stateHash(), stateHash(state)) << most;
    }
}

TEST(ToothState, BoundsInTheCoreHoldAfterARestore) {
    const auto base = ballTooth(3.0, 2.0, 0.05);
    const Vec3 at(2.6, 0.3, -0.2);
    const auto shape = [&](const Vec3& p) { return in_test::ball(p - at, 0.9); };
    ToothState cut(base), field(base);
    cutAway(cut, shape);
    const StateDelta state = cut.state();
    (void)field.restore(state, 0, state.bricks.size());
    const field::FieldView view = field.field().view(), before = base->field.view();
    std::size_t raised = 0, core = 0;
    for (std::uint32_t dense = 0; dense < in_test::denseCount(field.field()); ++dense) {
        if (view.brickIndex[dense] >= 0 || before.coarse[dense] >= 0.0f) continue;
        const auto brick = field::brickAt(view.bricks, dense);
        Vec3 centre;
        for (int k = 0; k < 3; ++k)
            centre[k] = view.originMm[k] + view.voxelMm * (8 * brick[static_cast<std::size_t>(k)] + 4);
        EXPECT_LT(view.coarse[dense], 0.0f);
        EXPECT_GE(view.coarse[dense], std::max(-2.0, std::max(in_test::ball(centre, 3.0), -shape(centre))) - 1e-5);
        raised += view.coarse[dense] > std::max(before.coarse[dense], -2.0f);
        ++core;
    }
    EXPECT_GT(raised, 50u);
    EXPECT_GT(core, raised);
    // And all is as it was when nothing is cut any more.
    const StateDelta undo = changeBetween(state, StateDelta{});
    (void)field.restore(undo, 0, undo.bricks.size());
    for (std::uint32_t dense = 0; dense < in_test::denseCount(field.field()); ++dense)
        ASSERT_EQ(view.coarse[dense], std::max(before.coarse[dense], -2.0f));
}

TEST(ToothState, SaysWhereItIsCut) {
    const auto base = ballTooth(1.5, 0.8, 0.05);
    ToothState field(base);
    const auto near = [&](const Vec3& centre, double half) {
        return field.isCutNear({centre - Vec3::Constant(half), centre + Vec3::Constant(half)});
    };
    EXPECT_FALSE(near(Vec3::Zero(), 10.0));
    const StateDelta uncut = field.state();
    const Vec3 at(1.5, 0.0, 0.0);
    cutAway(field, [&](const Vec3& p) { return in_test::ball(p - at, 0.3); });
    EXPECT_TRUE(near(at, 0.1));
    EXPECT_TRUE(near(Vec3::Zero(), 10.0));
    EXPECT_FALSE(near(-at, 0.5));
    EXPECT_FALSE(near({40, 0, 0}, 1.0));
    EXPECT_FALSE(field.isCutNear({}));
    EXPECT_FALSE(near(Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), 1.0));
    // Against the plain way, for many boxes.
    std::mt19937_64 generator(handpiece::test::seed());
    const field::FieldView view = field.field().view();
    const StateDelta state = field.state();
    for (int i = 0; i < 2000; ++i) {
        const Vec3 centre = handpiece::test::randomDirection(generator) * handpiece::test::uniform(generator, 0.0, 2.5);
        const double half = handpiece::test::uniform(generator, 0.0, 0.7);
        bool wanted = false;
        for (const StateDelta::Brick& brick : state.bricks) {
            const auto index = field::brickAt(view.bricks, brick.id);
            bool overlaps = true;
            for (int k = 0; k < 3; ++k) {
                const double low = view.originMm[k] + 8 * view.voxelMm * index[static_cast<std::size_t>(k)];
                overlaps = overlaps && centre[k] - half < low + 8 * view.voxelMm && centre[k] + half > low;
            }
            wanted = wanted || overlaps;
        }
        EXPECT_EQ(near(centre, half), wanted);
    }
    // Once put back it is uncut.
    const StateDelta change = changeBetween(field.state(), uncut);
    EXPECT_EQ(field.restore(change, 0, change.bricks.size() + 100000), change.bricks.size());
    EXPECT_FALSE(near(Vec3::Zero(), 10.0));
}

TEST(ToothState, HandsOverEveryChangeOnceInTurn) {
    const auto base = ballTooth(1.5, 0.8, 0.05);
    ToothState field(base);
    EXPECT_EQ(field.handOver(10, [](const BrickSnapshot&) { return true; }), 0u);
    cutAway(field, [](const Vec3& p) { return in_test::ball(p - Vec3(1.5, 0, 0), 0.4); });
    const std::size_t waiting = field.waitingBricks();
    ASSERT_GT(waiting, 20u);
    EXPECT_EQ(field.handOver(10, [](const BrickSnapshot&) { return false; }), 0u);
    EXPECT_EQ(field.waitingBricks(), waiting);
    std::vector<std::uint32_t> seen;
    const auto take = [&](const BrickSnapshot& s) {
        seen.push_back(s.id);
        return true;
    };
    EXPECT_EQ(field.handOver(5, take), 5u);
    // What changes while it waits waits once; what was handed over waits again, at the end.
    field.noteChanged(seen[0], false);
    field.noteChanged(seen[0], false);
    EXPECT_EQ(field.waitingBricks(), waiting - 4);
    EXPECT_EQ(field.handOver(100000, take), waiting - 4);
    EXPECT_EQ(seen.back(), seen[0]);
    EXPECT_EQ(field.waitingBricks(), 0u);
}

TEST(ToothState, RunsOutOfBricksWithoutHarm) {
    CutSettings settings;
    settings.reserveBricks = 3;
    const auto base = ballTooth(2.0, 0.8, 0.05, settings);
    ToothState field(base);
    cutAway(field, [](const Vec3& p) { return in_test::ball(p, 0.8); });
    EXPECT_TRUE(field.outOfBricks());
    EXPECT_EQ(field.state().bricks.size(), 3u);
    EXPECT_EQ(in_test::tornNodes(field), 0u);
}

TEST(ToothState, KeepsTheTicksLaw) {
    if (!handpiece::test::RealtimeTrap::isActive()) GTEST_SKIP() << "sanitizers own malloc";
    const auto base = ballTooth(1.5, 0.8, 0.05);
    ToothState field(base);
    cutAway(field, [](const Vec3& p) { return in_test::ball(p - Vec3(1.5, 0, 0), 0.4); });
    const StateDelta cut = field.state();
    const StateDelta change = changeBetween(cut, StateDelta{});
    std::uint64_t calls = 0;
    {
        const handpiece::test::RealtimeTrap trap;
        for (std::uint32_t dense = 0; dense < in_test::denseCount(field.field()); ++dense)
            if (field.storeBrick(dense) >= 0) field.noteChanged(dense, dense % 2 == 0);
        (void)field.isCutNear({Vec3::Constant(-1), Vec3::Constant(1)});
        (void)field.handOver(50, [](const BrickSnapshot&) { return true; });
        for (std::size_t from = 0; from < change.bricks.size();)
            from = field.restore(change, from, 5);
        field.addRemoved({});
        calls = trap.total();
    }
    EXPECT_EQ(calls, 0u);
}

TEST(WithTissues, RefusesWhatCannotBe) {
    const auto base = ballTooth(1.0, 0.5, 0.05);
    for (const double band : {-1.0, 0.01, 50.0, std::numeric_limits<double>::quiet_NaN()}) {
        CutSettings settings;
        settings.bandMm = band;
        EXPECT_THROW((void)withTissues(*base, field::TissueMap::uniform(base->field, cases::Tissue::enamel), settings),
                     core::Error);
    }
    const auto other = ballTooth(1.5, 0.5, 0.05);
    EXPECT_THROW((void)withTissues(*base, field::TissueMap::uniform(other->field, cases::Tissue::enamel)), core::Error);
    EXPECT_DOUBLE_EQ(base->settings.bandMm, 0.2);
    EXPECT_DOUBLE_EQ(ballTooth(1.0, 0.5, 0.1)->settings.bandMm, 0.3);
}

}  // namespace
}  // namespace handpiece::tooth::tooth_state_test
