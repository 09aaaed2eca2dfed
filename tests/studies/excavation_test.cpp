// SPDX-License-Identifier: Apache-2.0
// What a hand that follows the plan takes of a ball with decay and a pulp, counted on a grid of its own.
#include "studies/excavation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/geometry/meshes.h"
#include "handpiece/base/core/error.h"

namespace handpiece::studies::excavation_test {
namespace {

using core::Vec3;

constexpr double kTooth = 5.0, kPulp = 1.5, kRadius = 0.5, kLength = 5.0;

struct Ball {
    Vec3 centre;
    double radius;
    [[nodiscard]] double distance(const Vec3& p) const { return (p - centre).norm() - radius; }
};

CuttingScene sceneOf(const std::vector<Ball>& lesions) {
    CuttingScene scene;
    scene.toothBounds = {Vec3::Constant(-kTooth), Vec3::Constant(kTooth)};
    scene.outerMm = [](const Vec3& p) { return p.norm() - kTooth; };
    scene.pulpMm = [](const Vec3& p) { return p.norm() - kPulp; };
    scene.burRadiusMm = kRadius;
    scene.burLengthMm = kLength;
    geometry::TriangleMesh decay;  // one part, as a case has it
    for (const Ball& b : lesions)
        decay = test::joined(decay, test::sphereMesh(b.centre, b.radius, 16));
    scene.decay = {decay};
    return scene;
}

struct Outcome {
    std::vector<double> share;  ///< of each lesion's decay that was taken
    double soundMm3 = 0.0, decayMm3 = 0.0, nearestPulpMm = 1e9;
};

// A round-ended bur along the motion, through voxels of 0.1 mm.
Outcome cut(const std::vector<Ball>& lesions, const device::Motion& motion) {
    constexpr double kCell = 0.1;
    constexpr int kSide = static_cast<int>(2.0 * kTooth / kCell) + 2;
    std::vector<std::uint8_t> gone(static_cast<std::size_t>(kSide) * kSide * kSide, 0);
    const auto centre = [](int i, int j, int k) {
        return Vec3((i + 0.5) * kCell - kTooth - kCell, (j + 0.5) * kCell - kTooth - kCell,
                    (k + 0.5) * kCell - kTooth - kCell);
    };
    const auto at = [](int i, int j, int k) { return (static_cast<std::size_t>(k) * kSide + j) * kSide + i; };
    Outcome outcome;
    for (double t = 0.0; t <= motion.durationS(); t += 0.03) {
        const device::TimedPose pose = motion.at(t);
        const Vec3 axis = pose.burInTooth.orientation * Vec3::UnitZ();
        const Vec3 low = pose.burInTooth.positionMm + kRadius * axis, high = low + (kLength - kRadius) * axis;
        const auto toBur = [&](const Vec3& p) {
            const double along = std::clamp((p - low).dot(axis), 0.0, (high - low).norm());
            return (p - low - along * axis).norm() - kRadius;
        };
        const double nearest = std::clamp(-low.dot(axis), 0.0, (high - low).norm());
        const double toMiddle = (low + nearest * axis).norm() - kRadius;
        if (toMiddle >= kTooth) continue;
        EXPECT_EQ(pose.pedal, 1.0) << t;
        outcome.nearestPulpMm = std::min(outcome.nearestPulpMm, toMiddle - kPulp);
        core::Box box;
        for (const Vec3& end : {low, high})
            for (const double r : {-kRadius, kRadius})
                box.extend(end + Vec3::Constant(r));
        int from[3], to[3];
        for (int a = 0; a < 3; ++a) {
            from[a] = std::max(0, static_cast<int>((box.min[a] + kTooth + kCell) / kCell));
            to[a] = std::min(kSide - 1, static_cast<int>((box.max[a] + kTooth + kCell) / kCell));
        }
        for (int k = from[2]; k <= to[2]; ++k)
            for (int j = from[1]; j <= to[1]; ++j)
                for (int i = from[0]; i <= to[0]; ++i)
                    if (toBur(centre(i, j, k)) < 0.0) gone[at(i, j, k)] = 1;
    }
    std::vector<double> all(lesions.size(), 0.0), taken(lesions.size(), 0.0);
    for (int k = 0; k < kSide; ++k)
        for (int j = 0; j < kSide; ++j)
            for (int i = 0; i < kSide; ++i) {
                const Vec3 p = centre(i, j, k);
                if (p.norm() > kTooth) continue;
                bool sound = true;
                for (std::size_t l = 0; l < lesions.size(); ++l) {
                    if (lesions[l].distance(p) > 0.0) continue;
                    sound = false;
                    all[l] += 1.0;
                    taken[l] += gone[at(i, j, k)];
                }
                if (gone[at(i, j, k)]) (sound ? outcome.soundMm3 : outcome.decayMm3) += kCell * kCell * kCell;
            }
    for (std::size_t l = 0; l < lesions.size(); ++l)
        outcome.share.push_back(taken[l] / all[l]);
    return outcome;
}

TEST(Excavation, oneLesionAtTheSurface) {
    const std::vector<Ball> lesions{{{0, 0, 4.6}, 1.2}};
    const Excavation plan = planExcavation(sceneOf(lesions));
    ASSERT_EQ(plan.lesions.size(), 1u);
    EXPECT_GT(plan.lesions[0].axis.z(), 0.95);
    const Outcome done = cut(lesions, plan.motion);
    RecordProperty("share", std::to_string(done.share[0]));
    EXPECT_GT(done.share[0], 0.93);
    EXPECT_LT(done.soundMm3, 0.5 * done.decayMm3);
    EXPECT_GT(done.nearestPulpMm, kPulpGuardMm);
    EXPECT_EQ(plan.lesions[0].guardedMm3, 0.0);
    // What the plan says is what the hand does.
    EXPECT_NEAR(plan.lesions[0].reachedMm3, done.decayMm3, 0.1 * done.decayMm3);
    EXPECT_NEAR(plan.lesions[0].soundMm3, done.soundMm3, 0.15 * done.decayMm3);
}

TEST(Excavation, threeScatteredLesionsEachFromItsOwnSide) {
    const std::vector<Ball> lesions{{{0, 0, 4.7}, 1.0}, {{4.7, 0, 0}, 0.9}, {{-2.2, 3.6, 2.2}, 0.9}};
    const Excavation plan = planExcavation(sceneOf(lesions));
    ASSERT_EQ(plan.lesions.size(), 3u);
    EXPECT_GT(plan.lesions[1].axis.x(), 0.9);
    const Outcome done = cut(lesions, plan.motion);
    for (const double share : done.share)
        EXPECT_GT(share, 0.9);
    // The box round all three holds some 200 mm3 of sound tooth.
    EXPECT_LT(done.soundMm3, 0.6 * done.decayMm3);
    EXPECT_GT(done.nearestPulpMm, kPulpGuardMm);
}

TEST(Excavation, beneathTheSurfaceThroughAnOpeningNoWiderThanNeeded) {
    const std::vector<Ball> lesions{{{0, 0, 3.4}, 0.7}};
    const Excavation plan = planExcavation(sceneOf(lesions));
    const Outcome done = cut(lesions, plan.motion);
    EXPECT_GT(done.share[0], 0.9);
    const double way = M_PI * 0.8 * 0.8 * (kTooth - 3.4);  // from the surface to the lesion's middle, a little wider
    EXPECT_LT(done.soundMm3, way);
    EXPECT_GT(done.nearestPulpMm, kPulpGuardMm);
}

TEST(Excavation, stopsShortOfThePulpUnlessToldOtherwise) {
    const std::vector<Ball> lesions{{{0, 0, 3.0}, 1.5}};  // touches the pulp
    const CuttingScene scene = sceneOf(lesions);
    const Excavation plan = planExcavation(scene);
    const Outcome done = cut(lesions, plan.motion);
    EXPECT_GE(done.nearestPulpMm, kPulpGuardMm - 0.01);
    EXPECT_LT(done.nearestPulpMm, kPulpGuardMm + 0.4);
    EXPECT_NEAR(plan.lesions[0].nearestPulpMm, done.nearestPulpMm, 0.25);
    EXPECT_GT(plan.lesions[0].guardedMm3, 0.05);
    EXPECT_GT(done.share[0], 0.7);
    CuttingOptions bold;
    bold.pulpGuardMm = 0.0;
    const Outcome through = cut(lesions, planExcavation(scene, bold).motion);
    EXPECT_GT(through.share[0], done.share[0]);
    EXPECT_LT(through.nearestPulpMm, 0.2);
    CuttingOptions careful;
    careful.pulpGuardMm = 1.0;
    EXPECT_GE(cut(lesions, planExcavation(scene, careful).motion).nearestPulpMm, 0.99);
}

// Where the bur needs time the hand gives it, in the order of what is hard, and goes no nearer to the pulp for that.
TEST(Excavation, waitsForTheBur) {
    const std::vector<Ball> lesions{{{0, 0, 3.0}, 1.5}};  // touches the pulp
    CuttingScene scene = sceneOf(lesions);
    const double unheeding = planExcavation(scene).motion.durationS();
    CuttingRates rates;
    rates.stiffnessNPerMm.fill(0.3);
    rates.cuttingMm2PerN.fill(8e-5);
    rates.cuttingMm2PerN[static_cast<std::size_t>(cases::Tissue::caries)] = 4e-4;
    rates.speedRadS = 4000.0;
    scene.rates = rates;
    const Excavation plan = planExcavation(scene);
    EXPECT_GT(plan.motion.durationS(), 1.2 * unheeding);
    const Outcome done = cut(lesions, plan.motion);
    EXPECT_GE(done.nearestPulpMm, kPulpGuardMm - 0.03);
    scene.rates->speedRadS = 1000.0;
    EXPECT_GT(planExcavation(scene).motion.durationS(), 1.5 * plan.motion.durationS());
    // What is gone is counted by lesion, sound tooth with the lesion that is nearest.
    const auto outcomes =
        lesionOutcomes(plan.lesions, scene.toothBounds, scene.outerMm, [](const Vec3& p) { return p.z() - 2.0; });
    ASSERT_EQ(outcomes.size(), 1u);
    EXPECT_NEAR(outcomes[0].decayMm3, 4.0 / 3.0 * M_PI * 1.5 * 1.5 * 1.5, 0.3);
    EXPECT_NEAR(outcomes[0].takenMm3 / outcomes[0].decayMm3, 0.926, 0.02);  // above z = 2
    const double cap = M_PI * 3.0 * 3.0 * (kTooth - 1.0);
    EXPECT_NEAR(outcomes[0].takenMm3 + outcomes[0].soundMm3, cap, 0.02 * cap);
}

TEST(Excavation, refusesWhereThereIsNothingToReach) {
    CuttingScene scene = sceneOf({{{0, 0, 4.6}, 1.0}});
    CuttingOptions aside;
    aside.offsetMm = {1.0, 0.0};
    EXPECT_THROW((void)planExcavation(scene, aside), core::Error);
    scene.decay.clear();
    EXPECT_THROW((void)planExcavation(scene), core::Error);
    EXPECT_THROW((void)planExcavation(sceneOf({{{0, 0, 1.0}, 0.4}})), core::Error) << "all of it lies in the pulp";
}

}  // namespace
}  // namespace handpiece::studies::excavation_test
