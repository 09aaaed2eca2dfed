// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/field_method.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "support/brute_force_depth.h"
#include "support/realtime_trap.h"
#include "tick/contact/contact_fixture.h"
#include "tick/contact/cut_by_hand.h"

namespace handpiece::contact::field_method_test {
namespace {

using core::Vec3;

std::shared_ptr<const instrument::Bur> burOf(std::string_view name) {
    return std::make_shared<const instrument::Bur>(instrument::makeBur(name));
}
std::shared_ptr<const tooth::ToothModel> grooved() {
    static const auto tooth = test::toothOf(test::groovedBall(35));
    return tooth;
}
std::shared_ptr<const tooth::ToothModel> slab() {
    static const auto tooth = test::toothOf(test::boxMesh({-4, -4, -3}, {4, 4, 0}, 24));
    return tooth;
}
core::Pose upright(double x, double y, double z) {
    return {{x, y, z}, core::Quat::Identity()};
}

struct Errors {
    double median, p99, worst;
};
Errors errorsOf(std::vector<double> e) {
    std::sort(e.begin(), e.end());
    return {e[e.size() / 2], e[e.size() * 99 / 100], e.back()};
}

/// Micrometres off the reference over random poses 0.005 to 1.5 mm deep.
Errors errorsUm(std::string_view bur, int poses, double deepestMm = 1.5, DepthSource source = DepthSource::exact) {
    FieldMethodSettings settings;
    settings.depthSource = source;
    const auto method = makeFieldMethod(grooved(), burOf(bur), settings);
    const auto exactMethod = makeFieldMethod(grooved(), burOf(bur));
    const auto shape = burOf(bur);
    std::mt19937_64 generator(test::seed());
    std::vector<double> errors;
    for (int i = 0; i < poses; ++i) {
        const double wanted = std::exp(test::uniform(generator, std::log(0.005), std::log(deepestMm)));
        const core::Pose pose = test::pressedPose(generator, *exactMethod, wanted);
        const double exact = test::bruteForceDepth(grooved()->tree, *shape, pose).depthMm;
        errors.push_back(1e3 * std::abs(method->depth(pose).depthMm - exact));
    }
    return errorsOf(errors);
}

class RoundEnded : public testing::TestWithParam<const char*> {};
TEST_P(RoundEnded, depthAgreesWithBruteForce) {
    const Errors e = errorsUm(GetParam(), 40);
    EXPECT_LE(e.median, 0.01);
    EXPECT_LE(e.worst, 2.0);
}
INSTANTIATE_TEST_SUITE_P(Burs, RoundEnded,
                         testing::Values("cylinder-round:1.0x4.0", "taper-round:1.2x4.0", "pear:1.2x3.0",
                                         "flame:1.2x4.0", "torpedo:1.2x4.0", "round:1.4x1.3"));

class SharpRimmed : public testing::TestWithParam<const char*> {};
TEST_P(SharpRimmed, depthAgreesWithBruteForce) {
    const Errors e = errorsUm(GetParam(), 24);
    EXPECT_LE(e.median, 0.05);
    EXPECT_LE(e.worst, 5.0);
}
INSTANTIATE_TEST_SUITE_P(Burs, SharpRimmed,
                         testing::Values("cylinder-flat:1.0x4.0", "inverted-cone:1.2x1.2", "wheel:2.0x0.8",
                                         "taper-flat:1.2x4.0"));

TEST(FieldMethod, theFieldAloneIsWithinMicrometresBelowTheRadius) {
    const Errors round = errorsUm("cylinder-round:1.0x4.0", 60, 0.45, DepthSource::field);
    EXPECT_LE(round.median, 0.3);
    EXPECT_LE(round.worst, 10.0);  // coarse facets: trilinear cells cut their edges off
}

TEST(FieldMethod, capsuleOnASlabFollowsTheClosedForm) {
    const auto method = makeFieldMethod(slab(), burOf("cylinder-round:1.0x4.0"));
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 50; ++i) {
        const double depth = test::uniform(generator, -0.3, 0.45), tilt = test::uniform(generator, 0.0, 1.2);
        core::Pose pose;
        pose.orientation = core::Quat(Eigen::AngleAxisd(tilt, Vec3(std::cos(i), std::sin(i), 0.0)));
        const Vec3 axis = pose.orientation * Vec3::UnitZ();
        // The centre of the round end stands 0.5 - depth over the plane.
        pose.positionMm =
            Vec3(test::uniform(generator, -1, 1), test::uniform(generator, -1, 1), 0.5 - depth) - 0.5 * axis;
        const Depth d = method->depth(pose);
        ASSERT_EQ(d.status, Status::ok);
        EXPECT_NEAR(d.depthMm, depth, 1e-9);
        EXPECT_NEAR(d.normal.z(), 1.0, 1e-9);
        EXPECT_NEAR(d.toothPointMm.z(), 0.0, 1e-9);
        EXPECT_EQ(d.tissue, cases::Tissue::enamel);
    }
}

TEST(FieldMethod, flatEndOnASlabFollowsTheClosedForm) {
    const auto method = makeFieldMethod(slab(), burOf("cylinder-flat:1.0x4.0"));
    for (const double tilt : {0.0, 0.1, 0.6})
        for (const double depth : {-0.2, 0.003, 0.1, 0.4}) {
            core::Pose pose;
            pose.orientation = core::Quat(Eigen::AngleAxisd(tilt, Vec3(0.6, 0.8, 0.0)));
            // The lowest point of the rim is the radius times sin(tilt) under the middle of the end.
            pose.positionMm = Vec3(0.123, -0.2, 0.5 * std::sin(tilt) - depth);
            EXPECT_NEAR(method->depth(pose).depthMm, depth, 1e-7) << tilt;
        }
}

TEST(FieldMethod, stepsFromTheHundredthOfAMicrometreAreTold) {
    for (const char* name : {"cylinder-round:1.0x4.0", "paper"}) {
        const auto method = makeFieldMethod(slab(), burOf(name));
        for (const double step : {0.1, 0.01, 1e-3, 1e-4, 1e-5}) {
            double before = method->depth(upright(0.3, 0.2, -0.05)).depthMm;
            for (int i = 1; i <= 5; ++i) {
                const double after = method->depth(upright(0.3, 0.2, -0.05 - step * i)).depthMm;
                EXPECT_NEAR(after - before, step, 0.1 * step) << name;
                before = after;
            }
        }
    }
}

TEST(FieldMethod, depthRisesAllTheWayDownAnOpenDrop) {
    const auto method = makeFieldMethod(grooved(), burOf("cylinder-round:1.0x4.0"));
    for (const double x : {-1.2, 0.05, 0.9}) {
        double before = -std::numeric_limits<double>::infinity();
        for (double z = 6.0; z > 3.6; z -= 0.003) {
            const Depth d = method->depth(upright(x, 0.1, z));
            if (d.status != Status::ok) continue;
            EXPECT_GT(d.depthMm, before);
            before = d.depthMm;
        }
        EXPECT_GT(before, 0.1);
    }
}

TEST(FieldMethod, aDepthUpToEnoughPromisesNoMoreThanThereIs) {
    std::mt19937_64 generator(test::seed());
    for (const char* name : {"cylinder-round:1.0x4.0", "cylinder-flat:1.0x4.0"}) {
        const auto method = makeFieldMethod(grooved(), burOf(name));
        int promised = 0;
        for (int i = 0; i < 60; ++i) {
            const double wanted = test::uniform(generator, -0.5, 2.0);
            const core::Pose pose = test::pressedPose(generator, *method, wanted);
            const Depth exact = method->depth(pose), enough = method->depthUpTo(0.3, pose);
            if (enough.depthMm == exact.depthMm) continue;
            ++promised;
            EXPECT_GT(enough.depthMm, 0.3);
            EXPECT_LE(enough.depthMm, exact.depthMm + 0.2 * grooved()->field.settings().voxelMm);  // the field's error
        }
        EXPECT_GT(promised, 10) << name;
    }
}

TEST(FieldMethod, warmStartDoesNotChangeTheAnswer) {
    for (const char* name : {"cylinder-round:1.0x4.0", "pear:1.2x3.0", "cylinder-flat:1.0x4.0"}) {
        const auto warm = makeFieldMethod(grooved(), burOf(name)), cold = makeFieldMethod(grooved(), burOf(name));
        for (int i = 0; i < 200; ++i) {
            core::Pose pose =
                upright(0.9 * std::sin(0.03 * i), 0.7 * std::cos(0.05 * i), 4.3 - 0.4 * std::sin(0.02 * i));
            cold->reset();
            EXPECT_NEAR(warm->depth(pose).depthMm, cold->depth(pose).depthMm, 1e-6) << name << " " << i;
        }
    }
}

TEST(FieldMethod, farAwayIsBeyondReachAndComesBack) {
    FieldMethodSettings settings;
    settings.reachMm = 0.5;
    const auto method = makeFieldMethod(slab(), burOf("cylinder-round:1.0x4.0"), settings);
    for (int round = 0; round < 2; ++round)
        for (double z = 3.0; z > -0.2; z -= 0.01) {
            const Depth d = method->depth(upright(0.0, 0.0, z));
            if (z > 0.5 + 1e-9) {
                EXPECT_EQ(d.status, Status::beyondReach);
                EXPECT_EQ(d.depthMm, -0.5);
                EXPECT_TRUE(d.normal.isZero());
            } else if (z < 0.5 - 1e-9) {
                EXPECT_EQ(d.status, Status::ok);
                EXPECT_NEAR(d.depthMm, -z, 1e-9);
            }
        }
}

TEST(FieldMethod, aPoseThatIsNoNumberIsSaidAndHarmless) {
    const auto method = makeFieldMethod(slab(), burOf("cylinder-round:1.0x4.0"));
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        PatchSet patches;
        ConstraintSet constraints;
        const core::Pose pose = upright(bad, 0.0, 0.0);
        EXPECT_EQ(method->depth(pose).status, Status::invalidPose);
        method->patches(pose, patches);
        EXPECT_EQ(patches.status, Status::invalidPose);
        EXPECT_EQ(patches.patches.size(), 0u);
        EXPECT_EQ(method->constraints(pose, 0.1, constraints), Status::invalidPose);
        EXPECT_TRUE(constraints.empty());
        EXPECT_NEAR(method->depth(upright(0, 0, -0.1)).depthMm, 0.1, 1e-9);
    }
    core::Pose turned = upright(0, 0, 0);
    turned.orientation.coeffs() *= 2.0;
    EXPECT_EQ(method->depth(turned).status, Status::invalidPose);
}

TEST(FieldMethod, refusesASenselessReach) {
    FieldMethodSettings settings;
    settings.reachMm = -1.0;
    EXPECT_THROW((void)makeFieldMethod(slab(), burOf("paper"), settings), core::Error);
    EXPECT_THROW((void)makeFieldMethod(std::shared_ptr<const tooth::ToothModel>(), burOf("paper")), core::Error);
}

TEST(FieldMethod, aRoundEndPressedIntoASlabTouchesACap) {
    const auto method = makeFieldMethod(slab(), burOf("cylinder-round:1.0x4.0"));
    for (const double depth : {0.05, 0.15, 0.3}) {
        PatchSet patches;
        method->patches(upright(0.4, -0.3, -depth), patches);
        ASSERT_EQ(patches.status, Status::ok);
        ASSERT_EQ(patches.patches.size(), 1u);
        const Patch& patch = patches.patches[0];
        // A cap of the margin's height more than the depth; the rings are 0.06 mm apart.
        const double cap = 2.0 * std::numbers::pi * 0.5 * (depth + kContactMarginMm);
        EXPECT_NEAR(patch.areaMm2, cap, 0.06 * 2.0 * std::numbers::pi * 0.5);
        EXPECT_NEAR(patch.maxDepthMm, depth, 0.002);
        EXPECT_NEAR(patch.centreMm.x(), 0.4, 1e-3);
        EXPECT_NEAR(patch.centreMm.y(), -0.3, 1e-3);
        EXPECT_NEAR(patch.normal.z(), 1.0, 1e-3);
        EXPECT_DOUBLE_EQ(patch.pressureShare, 1.0);
        EXPECT_EQ(patch.tissue, cases::Tissue::enamel);
        EXPECT_NEAR(patches.tissueShare[static_cast<std::size_t>(cases::Tissue::enamel)], 1.0, 1e-12);
    }
    PatchSet none;
    method->patches(upright(0.0, 0.0, 0.5), none);
    EXPECT_EQ(none.patches.size(), 0u);
    EXPECT_EQ(none.areaMm2, 0.0);
}

TEST(FieldMethod, aRimIsFreeInTheCornerThatItHasJustCut) {
    // Shallower than the voxels are wide no lookup tells floor, wall and margin apart: where the bur cut last does.
    for (const char* name : {"cylinder-flat:1.0x4.0", "inverted-cone:1.2x1.0", "wheel:2.0x0.8"}) {
        const auto bur = burOf(name);
        double worstKnown = 0.0, worstRead = 0.0;
        for (const double deep : {0.02, 0.035, 0.06, 0.09, 0.2}) {
            const auto cut = test::slabToCut();
            const core::Pose pose = upright(0.013, -0.021, -deep);
            test::carve(*cut, {{-2, -2, -1}, {2, 2, 1}},
                        [&](const Vec3& p) { return bur->signedDistance(p - pose.positionMm); });
            const auto method = makeFieldMethod(std::shared_ptr<const tooth::ToothState>(cut), bur);
            const auto nearest = [&](const core::Pose& at) {
                ConstraintSet set;
                (void)method->constraints(at, 0.04, set);
                double gap = -method->depth(at).depthMm;
                for (const Constraint& c : set)
                    gap = std::min(gap, c.gapMm);
                return gap;
            };
            worstRead = std::min(worstRead, nearest(pose));
            method->noteCut(pose);
            worstKnown = std::min(worstKnown, nearest(pose));
            // Held to the floor and the walls all the same.
            core::Pose lower = pose;
            lower.positionMm.z() -= 0.01;
            EXPECT_NEAR(method->depth(lower).depthMm, 0.01, method->slackMm()) << name << " " << deep;
        }
        std::printf("  %s: own corner seems nearer by %.1f um, where it cut last by %.1f um\n", name, -1e3 * worstRead,
                    -1e3 * worstKnown);
        EXPECT_GE(worstKnown, -0.002) << name;
    }
}

TEST(FieldMethod, whatWasCutLastIsForgottenWithTheTooth) {
    const auto cut = test::slabToCut();
    const auto bur = burOf("cylinder-flat:1.0x4.0");
    const auto method = makeFieldMethod(std::shared_ptr<const tooth::ToothState>(cut), bur);
    const auto dent = [&](double deeper) {
        test::carve(*cut, {{-1, -1, -0.5}, {1, 1, 0.1}},
                    [deeper](const Vec3& p) { return (p - Vec3(0.0, 0.0, 0.3 - deeper)).norm() - 0.31; });
    };
    dent(0.0);
    const core::Pose pose = upright(0.0, 0.0, -0.05);
    const double before = method->depth(pose).depthMm;
    EXPECT_GT(before, 0.03);
    method->noteCut(pose);  // said, but nothing of it is in the field
    EXPECT_LT(method->depth(pose).depthMm, 0.002);
    dent(0.01);  // another field: what was known of the first holds no more
    EXPECT_NEAR(method->depth(pose).depthMm, before, 0.003);
}

TEST(FieldMethod, twoWallsOfASlotAreTwoPatches) {
    // A slot 0.96 mm wide for a bur of 1 mm, as two blocks side by side.
    geometry::TriangleMesh left = test::boxMesh({-3, -3, -3}, {-0.48, 3, 3}, 12),
                           right = test::boxMesh({0.48, -3, -3}, {3, 3, 3}, 12);
    const auto offset = static_cast<std::uint32_t>(left.vertices.size());
    left.vertices.insert(left.vertices.end(), right.vertices.begin(), right.vertices.end());
    for (geometry::Triangle t : right.triangles) {
        for (std::uint32_t& v : t)
            v += offset;
        left.triangles.push_back(t);
    }
    const auto method = makeFieldMethod(test::toothOf(left), burOf("cylinder-round:1.0x4.0"));
    PatchSet patches;
    method->patches(upright(0.0, 0.0, -1.0), patches);
    ASSERT_EQ(patches.patches.size(), 2u);
    EXPECT_NEAR(patches.patches[0].areaMm2, patches.patches[1].areaMm2, 0.1 * patches.patches[0].areaMm2);
    EXPECT_NEAR(patches.patches[0].normal.x() * patches.patches[1].normal.x(), -1.0, 0.01);
    ConstraintSet constraints;
    EXPECT_NE(method->constraints(upright(0.0, 0.0, -1.0), 0.05, constraints), Status::invalidPose);
    const auto facing = [&](double sign) {
        return std::count_if(constraints.begin(), constraints.end(),
                             [&](const Constraint& c) { return sign * c.normal.x() > 0.9; });
    };
    EXPECT_GT(facing(1.0), 4);
    EXPECT_GT(facing(-1.0), 4);
}

TEST(FieldMethod, resolvingTheConstraintsFreesTheWholeBur) {
    const auto bur = burOf("cylinder-round:1.0x4.0");
    const auto method = makeFieldMethod(slab(), bur);
    for (const double tilt : {0.0, 0.5, 1.5}) {
        core::Pose pose;
        pose.orientation = core::Quat(Eigen::AngleAxisd(tilt, Vec3::UnitX()));
        pose.positionMm = Vec3(0.1, 0.5, 0.5 - 0.03) - 0.5 * (pose.orientation * Vec3::UnitZ());
        ConstraintSet constraints;
        ASSERT_NE(method->constraints(pose, 0.08, constraints), Status::invalidPose);
        ASSERT_FALSE(constraints.empty());
        // The smallest move along +z that satisfies every one of them.
        double lift = 0.0;
        for (const Constraint& c : constraints) {
            EXPECT_NEAR(c.gapMm, slab()->tree.signedDistance(c.pointMm), 0.002);
            lift = std::max(lift, -c.gapMm / c.normal.z());
        }
        pose.positionMm.z() += lift;
        double worst = 0.0;
        for (const instrument::SurfaceRing& ring : bur->rings())
            for (std::uint32_t j = 0; j < ring.count; ++j) {
                const double a = 2.0 * std::numbers::pi * (j + 0.5) / ring.count;
                worst = std::max(worst, -slab()->tree.signedDistance(pose.apply(
                                            {ring.rhoMm * std::cos(a), ring.rhoMm * std::sin(a), ring.zMm})));
            }
        EXPECT_LE(worst, 0.002) << tilt;
    }
}

TEST(FieldMethod, theTickNeverAllocatesOrLocks) {
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc: the trap is off";
    for (const char* name : {"cylinder-round:1.0x4.0", "cylinder-flat:1.0x4.0"}) {
        const auto method = makeFieldMethod(grooved(), burOf(name));
        PatchSet patches;
        ConstraintSet constraints;
        const test::RealtimeTrap trap;
        for (int i = 0; i < 100; ++i) {
            const core::Pose pose = upright(0.9 * std::sin(0.1 * i), 0.7 * std::cos(0.1 * i), 6.0 - 0.02 * i);
            (void)method->depth(pose);
            method->patches(pose, patches);
            (void)method->constraints(pose, 0.1, constraints);
        }
        EXPECT_EQ(trap.total(), 0u) << name;
    }
}

/// A slab with the cavity of a round-ended cylinder 2 mm deep in it, and that cylinder.
class OwnCavity : public testing::Test {
  protected:
    static constexpr double kRadius = 0.5;
    const Vec3 tip_{0.013, -0.021, -2.0};
    std::shared_ptr<tooth::ToothState> cut_ = test::slabToCut(true);
    std::shared_ptr<const instrument::Bur> bur_ = burOf("cylinder-round:1.0x4.0");
    std::unique_ptr<Method> method_ = makeFieldMethod(std::shared_ptr<const tooth::ToothState>(cut_), bur_);

    void carve() {
        test::carve(*cut_, {{-3, -3, -3}, {3, 3, 1}},
                    [this](const Vec3& p) { return test::shaftDistance(p, tip_, kRadius); });
    }
    core::Pose pushed(const Vec3& way) const {
        const Vec3 p = tip_ + way;
        return upright(p.x(), p.y(), p.z());
    }
};

TEST_F(OwnCavity, beforeAnyCutTheDepthIsThatOfTheWholeTooth) {
    const auto uncut = makeFieldMethod(cut_->modelShared(), bur_);
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 50; ++i) {
        const core::Pose pose = upright(test::uniform(generator, -2, 2), test::uniform(generator, -2, 2),
                                        test::uniform(generator, -1.0, 2.0));
        EXPECT_EQ(method_->depth(pose).depthMm, uncut->depth(pose).depthMm);
    }
}

TEST_F(OwnCavity, theDepthIsTheWayTheBurIsPushed) {
    carve();
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 200; ++i) {
        Vec3 way = test::randomDirection(generator);
        way.z() = -std::abs(way.z());
        way *= test::uniform(generator, 0.0, 0.6);
        const Depth d = method_->depth(pushed(way));
        ASSERT_EQ(d.status, Status::ok);
        EXPECT_NEAR(d.depthMm, way.norm(), 0.002) << way.transpose();  // trilinear cells round the cavity off
        if (way.norm() < 0.02) continue;
        EXPECT_GT(-d.normal.dot(way.normalized()), 0.97) << way.transpose();
        EXPECT_NEAR(test::shaftDistance(d.toothPointMm, tip_, kRadius), 0.0, 0.003);
        if (std::abs(d.toothPointMm.x()) > 0.1) {
            EXPECT_EQ(d.tissue, d.toothPointMm.x() > 0.0 ? cases::Tissue::dentine : cases::Tissue::enamel);
        }
    }
}

TEST_F(OwnCavity, deeperThanTheFieldFollowsTheDepthIsABound) {
    carve();
    double before = 0.0;
    for (double way = 0.6; way < 1.5; way += 0.05) {
        const Depth d = method_->depth(pushed({0.0, 0.0, -way}));
        ASSERT_EQ(d.status, Status::ok);
        EXPECT_LE(d.depthMm, way + 0.002);
        EXPECT_GE(d.depthMm, 0.599);
        EXPECT_NEAR(d.normal.norm(), 1.0, 1e-6);
        before = d.depthMm;
    }
    EXPECT_GT(before, 0.65);
}

TEST_F(OwnCavity, apartIsTrueInTheCavityOverItAndBesideIt) {
    carve();
    // A thinner bur in the middle of the cavity: 0.3 mm from every wall, nothing in sight.
    const auto thin = makeFieldMethod(std::shared_ptr<const tooth::ToothState>(cut_), burOf("cylinder-round:0.4x4.0"));
    core::Pose pose = pushed({0.0, 0.0, 0.3});
    Depth d = thin->depth(pose);
    EXPECT_EQ(d.status, Status::beyondReach);
    EXPECT_LE(-d.depthMm, 0.3);
    EXPECT_GT(-d.depthMm, 0.05);
    EXPECT_TRUE(d.normal.isZero());
    // 0.05 mm from the wall and from the floor the field sees it.
    pose = pushed({0.25, 0.0, 0.3});
    EXPECT_NEAR(thin->depth(pose).depthMm, -0.05, 0.002);
    pose = pushed({0.0, 0.0, 0.04});
    EXPECT_NEAR(thin->depth(pose).depthMm, -0.04, 0.002);
    // Above the cavity what was nearest is gone: a bound. Beside it the whole surface is as it was.
    d = method_->depth(pushed({0.0, 0.0, 2.7}));
    EXPECT_EQ(d.status, Status::beyondReach);
    EXPECT_GE(-d.depthMm, 0.6);
    d = method_->depth(pushed({2.5, 0.0, 2.3}));
    EXPECT_EQ(d.status, Status::ok);
    EXPECT_NEAR(d.depthMm, -0.3, 1e-9);
    d = method_->depth(pushed({2.5, 0.0, 1.9}));
    EXPECT_NEAR(d.depthMm, 0.1, 1e-9);
}

TEST_F(OwnCavity, whatConstraintsSensedServesTheDepthAndChangesNothing) {
    carve();
    const auto other = makeFieldMethod(std::shared_ptr<const tooth::ToothState>(cut_), bur_);
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 60; ++i) {
        const core::Pose pose = pushed(test::uniform(generator, 0.0, 0.1) * test::randomDirection(generator));
        ConstraintSet set;
        (void)method_->constraints(pose, test::uniform(generator, 0.04, 0.2), set);
        EXPECT_NEAR(method_->depth(pose).depthMm, other->depth(pose).depthMm, 5e-4);
    }
    // A cut in between is seen.
    const core::Pose pose = pushed({0.0, 0.0, -0.1});
    ConstraintSet set;
    (void)method_->constraints(pose, 0.1, set);
    EXPECT_NEAR(method_->depth(pose).depthMm, 0.1, 0.002);
    test::carve(*cut_, {{-3, -3, -3}, {3, 3, 1}},
                [&](const Vec3& p) { return test::shaftDistance(p, tip_ - Vec3(0.0, 0.0, 0.1), kRadius); });
    EXPECT_NEAR(method_->depth(pose).depthMm, 0.0, 0.002);
}

TEST_F(OwnCavity, theTickNeverAllocatesOrLocks) {
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc: the trap is off";
    carve();
    const test::RealtimeTrap trap;
    Bearing bearing;
    for (int i = 0; i < 60; ++i) {
        const core::Pose pose = pushed({0.3 * std::sin(0.3 * i), 0.0, 0.05 * i - 1.0});
        (void)method_->depth(pose);
        method_->bearing(pose, -Vec3::UnitZ(), 0.01, 0.15, bearing);
    }
    EXPECT_EQ(trap.total(), 0u);
}

TEST(FieldMethod, AFlatEndCentredOverAnEdgeIsPushedOut) {
    // The diagonal of a box's top runs through the bur's axis: there the middle of the flat end decides.
    const auto tooth = test::toothOf(test::boxMesh({-3, -2, -3}, {3, 2, 0}, 1));
    for (const char* name : {"cylinder-flat:1.0x3.0", "inverted-cone:1.2x1.2", "wheel:2.0x0.8", "taper-flat:1.2x4.0"}) {
        const auto bur = std::make_shared<const instrument::Bur>(instrument::makeBur(name));
        const auto method = makeFieldMethod(tooth, bur);
        for (const double depthMm : {-0.1, 1e-6, 0.05, 0.1, 0.15, 0.3}) {
            core::Pose pose;
            pose.positionMm = {0, 0, -depthMm};
            const Depth told = method->depth(pose);
            EXPECT_NEAR(told.depthMm, depthMm, 1e-6) << name;
            EXPECT_NEAR(told.normal.z(), 1.0, 1e-9) << name << " " << depthMm;
        }
    }
}

}  // namespace
}  // namespace handpiece::contact::field_method_test
