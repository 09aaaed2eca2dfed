// SPDX-License-Identifier: Apache-2.0
/// @file
/// A cut tooth as bytes: bit for bit back, and one clear error for anything else.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/field_cache.h"
#include "handpiece/model/tooth/state_file.h"
#include "support/cut_support.h"

namespace handpiece::tooth::state_file_test {
namespace {

using core::Vec3;
using in_test::ballTooth;
using in_test::cutAway;

class CutStateFile : public ::testing::Test {
  protected:
    CutStateFile() : base(ballTooth(1.5, 0.8, 0.05)), key(base->identity) {
        ToothState field(base);
        cutAway(field, [](const Vec3& p) { return in_test::ball(p - Vec3(1.4, 0.2, 0.1), 0.5); });
        TissueVolumes removed{};
        removed[1] = 0.1234567890123;
        removed[2] = 3.0;
        field.addRemoved(removed);
        state = field.state();
    }
    static void expectSame(const StateDelta& a, const StateDelta& b) {
        ASSERT_EQ(a.bricks.size(), b.bricks.size());
        EXPECT_EQ(a.removedMm3, b.removedMm3);
        for (std::size_t i = 0; i < a.bricks.size(); ++i) {
            EXPECT_EQ(a.bricks[i].id, b.bricks[i].id);
            ASSERT_EQ(a.bricks[i].uncut, b.bricks[i].uncut);
            if (!a.bricks[i].uncut) {
                EXPECT_EQ(std::memcmp(&a.bricks[i].values, &b.bricks[i].values, sizeof a.bricks[i].values), 0);
            }
        }
    }
    std::string refusal(std::span<const std::byte> data) const {
        try {
            (void)decodeState(data, {base}, "here");
        } catch (const core::Error& error) {
            EXPECT_EQ(error.where(), "here");
            return error.problem();
        }
        return "taken";
    }

    std::shared_ptr<const ToothModel> base;
    std::uint64_t key;
    StateDelta state;
};

TEST_F(CutStateFile, ComesBackBitForBit) {
    ASSERT_GT(state.bricks.size(), 30u);
    const std::vector<std::byte> data = encodeState(state, key);
    expectSame(decodeState(data, {base}), state);
    core::setThreadCount(1);
    EXPECT_EQ(encodeState(state, key), data);
    core::setThreadCount(0);
    // Well below the plain floats.
    EXPECT_LT(data.size(), state.bricks.size() * sizeof(float) * field::kBrickValues / 2);
    expectSame(decodeState(encodeState(StateDelta{}, key), {base}), StateDelta{});
}

TEST_F(CutStateFile, OneOfVersionOneIsReadAsItWas) {
    // As docs/formats/cut-state.md has it: of one tooth, and ten tissues in the header.
    constexpr std::size_t kRemoved = 40, kDouble = sizeof(double), kHashes = 16;
    std::vector<std::byte> old = encodeState(state, key);
    const auto at = [](std::size_t offset) { return static_cast<std::ptrdiff_t>(offset); };
    const auto put = [&old](std::size_t offset, std::uint64_t value) {
        std::memcpy(&old[offset], &value, sizeof value);
    };
    std::size_t end = kRemoved + cases::kTissueCount * kDouble + kHashes;
    const auto seal = [&] {
        put(32, old.size() - end);
        put(end - kHashes, field::hashOf(std::span<const std::byte>(old).subspan(end)));
        core::Hasher hasher;
        hasher.add(std::span<const std::byte>(old).first(end - sizeof(std::uint64_t)));
        put(end - sizeof(std::uint64_t), hasher.value());
    };
    old.erase(old.begin() + at(end), old.begin() + at(end + sizeof(std::uint32_t)));  // no other teeth
    old[8] = std::byte{2};
    seal();
    expectSame(decodeState(old, {base}), state);
    old.erase(old.begin() + at(kRemoved + cases::kFirstTissueCount * kDouble),
              old.begin() + at(kRemoved + cases::kTissueCount * kDouble));
    old[8] = std::byte{1};
    end = kRemoved + cases::kFirstTissueCount * kDouble + kHashes;
    EXPECT_THAT(refusal(old), ::testing::HasSubstr("damaged"));
    seal();
    expectSame(decodeState(old, {base}), state);
    EXPECT_THAT(refusal(std::span(old).first(end - 1)), ::testing::HasSubstr("cut short"));
    std::mt19937_64 generator(handpiece::test::seed());
    for (int i = 0; i < 100; ++i) {
        std::vector<std::byte> bad = old;
        bad[generator() % (i % 2 == 0 ? bad.size() : end)] ^= std::byte{1} << (generator() % 8);
        EXPECT_NE(refusal(bad), "taken");
    }
}

TEST_F(CutStateFile, ChangesToo) {
    ToothState field(base);
    cutAway(field, [](const Vec3& p) { return in_test::ball(p - Vec3(0.0, 1.4, 0.1), 0.5); });
    const StateDelta change = changeBetween(state, field.state());
    expectSame(decodeState(encodeState(change, key), {base}), change);
}

TEST_F(CutStateFile, AnyValuesComeBack) {
    std::mt19937_64 generator(handpiece::test::seed());
    for (StateDelta::Brick& brick : state.bricks)
        for (float& value : brick.values)
            value = generator() % 8 == 0 ? -0.0f
                                         : static_cast<float>(handpiece::test::uniform(generator, -0.2, 0.1)) *
                                               (generator() % 4 == 0 ? 1e-30f : 1.0f);
    expectSame(decodeState(encodeState(state, key), {base}), state);
}

TEST_F(CutStateFile, ResumesInAFieldOfItsOwn) {
    const StateDelta back = decodeState(encodeState(state, key), {base});
    ToothState field(base);
    (void)field.restore(back, 0, back.bricks.size());
    EXPECT_EQ(field.stateHash(), stateHash(state));
    EXPECT_EQ(field.removedMm3(), state.removedMm3.own);
}

TEST_F(CutStateFile, RefusesEverythingElse) {
    using ::testing::HasSubstr;
    const std::vector<std::byte> good = encodeState(state, key);
    EXPECT_THAT(refusal({}), HasSubstr("no cut state"));
    EXPECT_THAT(refusal(std::span(good).first(7)), HasSubstr("no cut state"));
    EXPECT_THAT(refusal(std::span(good).first(50)), HasSubstr("cut short"));
    EXPECT_THAT(refusal(std::span(good).first(good.size() - 1)), HasSubstr("cut short"));
    std::vector<std::byte> longer = good;
    longer.push_back(std::byte{0});
    EXPECT_THAT(refusal(longer), HasSubstr("damaged"));
    EXPECT_THAT(refusal(encodeState(state, key + 1)), HasSubstr("another tooth"));
    std::vector<std::byte> newer = good;
    newer[8] = std::byte{9};
    EXPECT_THAT(refusal(newer), HasSubstr("version 9"));
    std::mt19937_64 generator(handpiece::test::seed());
    for (int i = 0; i < 300; ++i) {
        std::vector<std::byte> bad = good;
        bad[generator() % (i % 2 == 0 ? bad.size() : std::size_t{136})] ^= std::byte{1} << (generator() % 8);
        EXPECT_NE(refusal(bad), "taken");
    }
    // Rightly sealed, and yet nothing that this tooth could hold.
    StateDelta wrong = state;
    std::swap(wrong.bricks[3].id, wrong.bricks[4].id);
    EXPECT_THAT(refusal(encodeState(wrong, key)), HasSubstr("damaged"));
    for (const float value : {-5.0f, 5.0f, std::numeric_limits<float>::quiet_NaN()}) {
        wrong = state;
        wrong.bricks[5].values[77] = value;
        EXPECT_THAT(refusal(encodeState(wrong, key)), HasSubstr("damaged"));
    }
    wrong = state;
    wrong.bricks.back().id = in_test::denseCount(base->field);
    EXPECT_THAT(refusal(encodeState(wrong, key)), HasSubstr("damaged"));
    wrong = state;
    wrong.bricks.insert(wrong.bricks.begin(), {0, true, {}});  // a corner of the grid, outside the tooth
    EXPECT_THAT(refusal(encodeState(wrong, key)), HasSubstr("damaged"));
}

TEST_F(CutStateFile, TeethAreToldApart) {
    EXPECT_EQ(ballTooth(1.5, 0.8, 0.05)->identity, key);
    EXPECT_NE(ballTooth(1.5, 0.7, 0.05)->identity, key);
    CutSettings settings;
    settings.bandMm = 0.25;
    EXPECT_NE(ballTooth(1.5, 0.8, 0.05, settings)->identity, key);
}

}  // namespace
}  // namespace handpiece::tooth::state_file_test
