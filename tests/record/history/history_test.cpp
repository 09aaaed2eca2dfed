// SPDX-License-Identifier: Apache-2.0
#include "handpiece/record/history/history.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>

#include "support/random.h"

namespace handpiece::history_test {
namespace {

using Values = std::array<float, field::kBrickValues>;

/// A mirror that is a map: what is not in it is uncut.
class FakeMirror final : public history::BrickSource {
  public:
    bool isChanged(std::uint32_t dense) const override { return bricks.contains(dense); }
    const float* values(std::uint32_t dense, float*) const override { return bricks.at(dense).data(); }
    void apply(const tooth::StateDelta& change) {
        for (const auto& brick : change.bricks) {
            if (brick.uncut) {
                bricks.erase(brick.id);
            } else {
                bricks[brick.id] = brick.values;
            }
        }
        removed = change.removedMm3;
    }
    bool operator==(const FakeMirror& other) const { return bricks == other.bricks && removed == other.removed; }

    std::map<std::uint32_t, Values> bricks;
    tooth::RemovedMm3 removed{};
};

/// Random cuts of three teeth: what the tick would do to bricks that it then hands over.
class HistoryTest : public testing::Test {
  protected:
    void cut(history::History& history, std::size_t bricks) {
        for (std::size_t i = 0; i < bricks; ++i) {
            const auto tooth = static_cast<std::uint16_t>(generator() % 3);
            const tooth::BrickId dense = tooth::brickId(tooth, static_cast<std::uint32_t>(generator() % 70));
            Values& v = mirror.bricks.try_emplace(dense, uncut(dense)).first->second;
            for (int k = 0; k < 50; ++k)
                v[generator() % v.size()] += static_cast<float>(test::uniform(generator, 0, 0.01));
            tooth::TissueVolumes mm3 = mirror.removed.of(tooth);
            mm3[1 + dense % 3] += 0.001;
            mirror.removed.set(tooth, mm3);
            history.noteTouched(dense);
        }
    }
    static Values uncut(tooth::BrickId id) {
        const double dense = 100.0 * tooth::toothOf(id) + tooth::denseOf(id);
        Values v;
        for (std::size_t i = 0; i < v.size(); ++i)
            v[i] = static_cast<float>(static_cast<double>(i) * 1e-3 - dense * 1e-2);
        return v;
    }
    bool stroke(history::History& history, std::size_t bricks) {
        cut(history, bricks);
        return history.endStroke(mirror, mirror.removed);
    }

    std::mt19937_64 generator{test::seed()};
    FakeMirror mirror;
};

TEST_F(HistoryTest, SixtyStrokesBackAndForthAreTheSameBits) {
    history::History history;
    std::vector<FakeMirror> states{mirror};
    for (int i = 0; i < 60; ++i) {
        ASSERT_TRUE(stroke(history, 1 + generator() % 30));
        states.push_back(mirror);
    }
    EXPECT_EQ(history.undoSteps(), 60u);
    for (std::size_t at = 60; at-- > 0;) {
        const auto change = history.undo();
        ASSERT_TRUE(change);
        ASSERT_TRUE(std::is_sorted(change->bricks.begin(), change->bricks.end(),
                                   [](const auto& a, const auto& b) { return a.id < b.id; }));
        mirror.apply(*change);
        ASSERT_TRUE(mirror == states[at]) << at;
    }
    EXPECT_FALSE(history.undo());
    for (std::size_t at = 1; at <= 60; ++at) {
        mirror.apply(*history.redo());
        ASSERT_TRUE(mirror == states[at]) << at;
    }
    EXPECT_FALSE(history.redo());
}

TEST_F(HistoryTest, ManyStepsAtOnceNeedNoMirrorInBetween) {
    history::History history;
    const FakeMirror first = mirror;
    for (int i = 0; i < 50; ++i)
        ASSERT_TRUE(stroke(history, 10));
    const FakeMirror last = mirror;
    // The mirror hears of nothing until all is asked for.
    std::vector<tooth::StateDelta> changes;
    while (auto change = history.undo())
        changes.push_back(std::move(*change));
    for (const auto& change : changes)
        mirror.apply(change);
    EXPECT_TRUE(mirror == first);
    while (auto change = history.redo())
        mirror.apply(*change);
    EXPECT_TRUE(mirror == last);
}

TEST_F(HistoryTest, AStrokeThatRemovedNothingTakesNoStep) {
    history::History history;
    EXPECT_FALSE(stroke(history, 0));
    ASSERT_TRUE(stroke(history, 5));
    // Bricks handed over again, as they are.
    for (const auto& [dense, values] : mirror.bricks)
        history.noteTouched(dense);
    history.noteTouched(199999);
    EXPECT_FALSE(history.endStroke(mirror, mirror.removed));
    EXPECT_EQ(history.undoSteps(), 1u);
}

TEST_F(HistoryTest, EchoesOfAnUndoTakeNoStepAndKeepTheRedo) {
    history::History history;
    stroke(history, 5);
    const auto change = history.undo();
    mirror.apply(*change);
    for (const auto& brick : change->bricks)
        history.noteTouched(brick.id);  // the tick hands over what it has put back
    EXPECT_FALSE(history.endStroke(mirror, mirror.removed));
    EXPECT_EQ(history.redoSteps(), 1u);
}

TEST_F(HistoryTest, ANewStrokeForgetsTheRedo) {
    history::History history;
    stroke(history, 5);
    stroke(history, 5);
    mirror.apply(*history.undo());
    EXPECT_EQ(history.redoSteps(), 1u);
    ASSERT_TRUE(stroke(history, 3));
    EXPECT_EQ(history.redoSteps(), 0u);
    EXPECT_EQ(history.undoSteps(), 2u);
}

TEST_F(HistoryTest, ResetMakesItWholeAndCanBeUndone) {
    history::History history;
    EXPECT_FALSE(history.reset());
    for (int i = 0; i < 7; ++i)
        stroke(history, 5);
    const FakeMirror cutTooth = mirror;
    mirror.apply(*history.reset());
    EXPECT_TRUE(mirror.bricks.empty());
    EXPECT_EQ(mirror.removed, tooth::RemovedMm3{});
    EXPECT_FALSE(history.reset());
    mirror.apply(*history.undo());
    EXPECT_TRUE(mirror == cutTooth);
    mirror.apply(*history.redo());
    EXPECT_TRUE(mirror.bricks.empty());
}

TEST_F(HistoryTest, AResumedToothCannotBeUndoneButResetIsWhole) {
    history::History history;
    tooth::StateDelta resumed;
    resumed.removedMm3.own[1] = 2;
    resumed.bricks.push_back({17, false, uncut(3)});
    mirror.apply(resumed);
    history.start(resumed);
    EXPECT_EQ(history.undoSteps(), 0u);
    stroke(history, 20);
    mirror.apply(*history.undo());
    EXPECT_EQ(mirror.bricks.at(17), uncut(3));
    EXPECT_EQ(mirror.removed, resumed.removedMm3);
    mirror.apply(*history.reset());
    EXPECT_TRUE(mirror.bricks.empty());
}

TEST_F(HistoryTest, MemoryIsBoundedAndTheLeastStepsAreKept) {
    const std::size_t bound = 2u << 20;
    history::History history({50, bound});
    std::size_t most = 0;
    for (int i = 0; i < 400; ++i) {
        stroke(history, 3);
        EXPECT_GE(history.undoSteps(), std::min<std::size_t>(50, static_cast<std::size_t>(i) + 1));
        most = std::max(most, history.memoryBytes());
    }
    EXPECT_LE(most, bound);
    EXPECT_LT(history.undoSteps(), 400u);
    for (int i = 0; i < 50; ++i)
        ASSERT_TRUE(history.undo()) << i;
    // What it says of its memory is what it holds: all undone and a new stroke leave one step and the tooth.
    while (history.undo()) {
    }
    const std::size_t full = history.memoryBytes();
    mirror.bricks.clear();
    stroke(history, 1);
    EXPECT_LT(history.memoryBytes(), full);
}

TEST_F(HistoryTest, PutTogetherAgainItTakesTheSameSteps) {
    history::History history;
    history.start({});
    for (int i = 0; i < 6; ++i)
        ASSERT_TRUE(stroke(history, 5));
    for (int i = 0; i < 2; ++i)
        mirror.apply(*history.undo());
    tooth::StateDelta now;
    now.removedMm3 = mirror.removed;
    for (const auto& [dense, values] : mirror.bricks)
        now.bricks.push_back({dense, false, values});
    history::History again;
    again.start(now);
    for (std::size_t i = 0; i < history.undoSteps() + history.redoSteps(); ++i)
        again.append(history.step(i), i < history.undoSteps());
    EXPECT_EQ(again.undoSteps(), 4u);
    EXPECT_EQ(again.redoSteps(), 2u);
    FakeMirror other = mirror;
    const auto both = [&](std::optional<tooth::StateDelta> a, std::optional<tooth::StateDelta> b) {
        ASSERT_EQ(a.has_value(), b.has_value());
        if (!a) return;
        mirror.apply(*a);
        other.apply(*b);
        ASSERT_TRUE(mirror == other);
    };
    both(history.redo(), again.redo());
    for (int i = 0; i < 6; ++i)
        both(history.undo(), again.undo());
    EXPECT_TRUE(other.bricks.empty());
    EXPECT_EQ(other.removed, tooth::RemovedMm3{});
}

}  // namespace
}  // namespace handpiece::history_test
