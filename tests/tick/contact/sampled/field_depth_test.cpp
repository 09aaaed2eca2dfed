// SPDX-License-Identifier: Apache-2.0
// Depth in the field: the same bits at every instruction set, and the pass over the rings that begins it.
#include "handpiece/tick/contact/sampled/field_depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

#include "handpiece/model/instrument/shapes.h"
#include "support/random.h"

namespace handpiece::contact::field_depth_test {
namespace {

using core::Vec3;

/// A block with a groove along y and a round hole across its wall: walls, edges and corners.
const field::DistanceField& cutBlock() {
    static const field::DistanceField field =
        field::DistanceField::fromFunction({{-3, -3, -2}, {3, 3, 0.5}}, {}, [](const Vec3& p) {
            const double groove = std::hypot(p.x(), p.z() + 0.2) - 0.5, hole = (p - Vec3(0.4, 0.1, -0.4)).norm() - 0.4;
            return std::max({p.z(), -groove, -hole});
        });
    return field;
}

core::Pose poseInTheCut(std::mt19937_64& random) {
    core::Pose pose;
    pose.positionMm = {test::uniform(random, -0.4, 0.6), test::uniform(random, -0.6, 0.6),
                       test::uniform(random, -0.8, -0.3)};
    pose.orientation = core::Quat(Eigen::AngleAxisd(test::uniform(random, 0.0, 0.6), test::randomDirection(random)));
    return pose;
}

std::vector<core::SimdLevel> levels() {
    std::vector<core::SimdLevel> all;
    for (const core::SimdLevel level : {core::SimdLevel::base, core::SimdLevel::avx2, core::SimdLevel::avx512})
        if (level <= core::simdLevel()) all.push_back(level);
    return all;
}

TEST(FieldDepth, isTheSameToTheBitAtEveryInstructionSet) {
    struct Told {
        KnownSurface surface;
        SurfaceSampler rings;
        FieldDepth depth;
        Told(const instrument::Bur& bur, core::SimdLevel level)
            : surface(cutBlock(), bur, level), rings(surface, bur, level), depth(surface, bur, level) {}
    };
    std::mt19937_64 random(test::seed());
    for (const char* name : {"cylinder-round:0.9x4.0", "cylinder-flat:0.9x4.0", "pear:1.2x3.0"}) {
        const instrument::Bur bur = instrument::makeBur(name);
        std::vector<std::unique_ptr<Told>> told;
        for (const core::SimdLevel level : levels())
            told.push_back(std::make_unique<Told>(bur, level));
        int touching = 0;
        for (int n = 0; n < 150; ++n) {
            const core::Pose pose = poseInTheCut(random);
            const FieldTouch first = told.front()->depth.search(pose, told.front()->rings);
            touching += first.depthMm > 0.0 ? 1 : 0;
            for (const auto& other : told) {
                const FieldTouch touch = other->depth.search(pose, other->rings);
                ASSERT_EQ(std::memcmp(&touch.depthMm, &first.depthMm, sizeof(double)), 0) << name << " pose " << n;
                ASSERT_EQ(touch.normal, first.normal) << name << " pose " << n;
                ASSERT_EQ(touch.surfaceMm, first.surfaceMm) << name << " pose " << n;
            }
        }
        EXPECT_GT(touching, 50) << name;
    }
}

TEST(RingKernels, aPassWithAWindowTellsAllThatLiesInIt) {
    std::mt19937_64 random(test::seed());
    const instrument::Bur bur = instrument::makeBur("cylinder-round:0.9x4.0");
    const RingArrays all(bur.rings()), some(bur.rings());
    const RingKernels kernels = ringKernelsFor(core::simdLevel());
    const field::FieldView view = cutBlock().view();
    std::size_t inWindow = 0, leftOut = 0;
    for (int n = 0; n < 100; ++n) {
        const core::Pose pose = poseInTheCut(random);
        const BurFrame frame(pose);
        RingQuery query{};
        query.tip = frame.tip.data();
        query.x = frame.x.data();
        query.y = frame.y.data();
        query.z = frame.z.data();
        query.thresholdMm = 0.14f;
        query.farOutMm = static_cast<float>(cutBlock().reach().outMm);
        query.farInMm = static_cast<float>(cutBlock().reach().inMm);
        kernels.sense(view, all.bur, query, all.touch);
        query.onlyDistances = true;
        query.windowMm = 0.05f;
        kernels.sense(view, some.bur, query, some.touch);
        const double least = leastOf(all);
        ASSERT_EQ(leastOf(some), least);
        if (!(least < 0.1)) continue;
        for (std::size_t i = 0; i < all.rings.size(); ++i) {
            for (std::int32_t j = 0; j < all.rings[i].count; ++j) {
                const auto at = static_cast<std::size_t>(all.rings[i].first + j);
                if (all.liveRing[i] == 0) continue;
                const float told = some.liveRing[i] != 0 ? some.distance[at] : kNotLiveMm;
                if (static_cast<double>(all.distance[at]) <= least + 0.05) {
                    ++inWindow;
                    ASSERT_EQ(told, all.distance[at]) << "ring " << i << " point " << j;
                } else {
                    leftOut += told == kNotLiveMm && all.distance[at] < kNotLiveMm ? 1 : 0;
                }
            }
        }
    }
    EXPECT_GT(inWindow, 1000u);
    EXPECT_GT(leftOut, 1000u);
}

}  // namespace
}  // namespace handpiece::contact::field_depth_test
