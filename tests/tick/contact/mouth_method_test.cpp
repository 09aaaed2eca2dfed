// SPDX-License-Identifier: Apache-2.0
// Several teeth and a whole handpiece, against brute force tooth by tooth and piece by piece.
#include "handpiece/tick/contact/mouth_method.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/turbine.h"
#include "support/brute_force_depth.h"
#include "support/realtime_trap.h"
#include "tick/contact/contact_fixture.h"

namespace handpiece::contact::mouth_method_test {
namespace {

using core::Pose;
using core::Vec3;
using instrument::Bur;

std::shared_ptr<const Bur> burOf(const char* name) {
    return std::make_shared<const Bur>(instrument::makeBur(name));
}
std::shared_ptr<const tooth::ToothModel> ball() {
    static const auto tooth = test::toothOf(test::groovedBall(24));
    return tooth;
}
Pose turned(const Vec3& at, double rad, const Vec3& axis) {
    return {at, core::Quat(Eigen::AngleAxisd(rad, axis.normalized()))};
}
Pose inverse(const Pose& p) {
    return {p.orientation.conjugate() * -p.positionMm, p.orientation.conjugate()};
}
Pose product(const Pose& a, const Pose& b) {
    return {a.apply(b.positionMm), a.orientation * b.orientation};
}

/// Three teeth of the same shape: the case's own, one beside it that it nearly touches, one upside down above both.
struct Mouth {
    std::vector<Pose> teeth{Pose{}, turned({9.0, 0.4, 0.2}, 0.3, {1, 2, 3}), turned({4.0, 0.5, 9.5}, 3.0, {1, 0.1, 0})};

    [[nodiscard]] std::unique_ptr<Method> of(const std::shared_ptr<const Bur>& bur, bool hasBody) const {
        std::vector<PlacedMethod> placed;
        for (std::size_t i = 0; i < teeth.size(); ++i) {
            const auto add = [&](const std::shared_ptr<const Bur>& solid, const Pose& inBur, Piece piece) {
                placed.push_back({makeFieldMethod(ball(), solid), solid, inBur, teeth[i], ball()->outer.bounds(),
                                  static_cast<std::uint16_t>(i), piece});
            };
            add(bur, {}, Piece::bur);
            if (!hasBody) continue;
            for (const instrument::BodyPiece& piece : instrument::bodyPieces(*bur))
                add(piece.solid, piece.inBur, piece.part);
        }
        return makeMouthMethod(std::move(placed));
    }
};

Pose somewhere(std::mt19937_64& g) {
    const Vec3 at(test::uniform(g, -5, 14), test::uniform(g, -5, 5), test::uniform(g, -4, 12));
    return turned(at, test::uniform(g, 0, 3.1), {test::uniform(g, -1, 1), test::uniform(g, -1, 1), 0.2});
}

TEST(MouthMethod, OneToothGivesItsOwnAnswersBitForBit) {
    const auto bur = burOf("cylinder-round:1.0x4.0");
    std::vector<PlacedMethod> placed;
    placed.push_back({makeFieldMethod(ball(), bur), bur, {}, {}, ball()->outer.bounds(), 0, Piece::bur});
    const auto mouth = makeMouthMethod(std::move(placed));
    const auto alone = makeFieldMethod(ball(), bur);
    std::mt19937_64 g(test::seed());
    int touching = 0;
    for (int i = 0; i < 500; ++i) {
        Pose pose = somewhere(g);
        if (i % 2 == 0) pose.positionMm = pose.positionMm.normalized() * test::uniform(g, 3.4, 4.6);
        const Depth a = mouth->depth(pose), b = alone->depth(pose);
        ASSERT_EQ(a.depthMm, b.depthMm) << i;
        ASSERT_EQ(a.normal, b.normal);
        ASSERT_EQ(a.toothPointMm, b.toothPointMm);
        ASSERT_EQ(a.status, b.status);
        ConstraintSet ca, cb;
        mouth->constraints(pose, 0.2, ca);
        alone->constraints(pose, 0.2, cb);
        ASSERT_EQ(ca.size(), cb.size());
        for (std::size_t k = 0; k < ca.size(); ++k) {
            ASSERT_EQ(ca[k].gapMm, cb[k].gapMm);
            ASSERT_EQ(ca[k].normal, cb[k].normal);
            ASSERT_EQ(ca[k].pointMm, cb[k].pointMm);
        }
        PatchSet pa, pb;
        mouth->patches(pose, pa);
        alone->patches(pose, pb);
        ASSERT_EQ(pa.areaMm2, pb.areaMm2);
        ASSERT_EQ(pa.tissueShare, pb.tissueShare);
        ASSERT_EQ(pa.patches.size(), pb.patches.size());
        for (std::size_t k = 0; k < pa.patches.size(); ++k)
            ASSERT_EQ(pa.patches[k].centreMm, pb.patches[k].centreMm);
        touching += a.depthMm > 0.0;
    }
    EXPECT_GT(touching, 50);
}

TEST(MouthMethod, TellsTheDeepestOfBurShankHeadAndHandleAsBruteForceDoes) {
    const auto bur = burOf("330");
    const Mouth mouth;
    const auto method = mouth.of(bur, true);
    const auto pieces = instrument::bodyPieces(*bur);
    std::mt19937_64 g(test::seed());
    double worstMm = 0.0;
    int decided[instrument::kBodyPartCount] = {}, teeth[3] = {};
    for (int i = 0; i < 45; ++i) {
        Pose pose = somewhere(g);
        // Each third with another piece near a surface: the bur, the head, the handle; drawn out until it is shallow.
        const Vec3 lever = i % 3 == 0 ? Vec3(0, 0, 1) : i % 3 == 1 ? Vec3(4, 0, 12) : Vec3(25, 0, 18);
        const Pose& tooth = mouth.teeth[static_cast<std::size_t>(i / 3 % 3)];
        pose.positionMm += tooth.apply(test::randomDirection(g) * test::uniform(g, 3.9, 9.0)) - pose.apply(lever);
        const double wantedMm = test::uniform(g, -1.0, 0.5);
        for (int k = 0; k < 40; ++k) {
            const Depth d = method->depth(pose);
            if (d.status != Status::ok || d.depthMm <= wantedMm) break;
            pose.positionMm += (d.depthMm - wantedMm + 1e-3) * d.normal;
        }
        if (method->depth(pose).depthMm > 0.55) continue;  // wedged
        double deepest = -5.0;
        std::size_t which = 3;
        Piece piece = Piece::bur;
        for (std::size_t t = 0; t < 3; ++t) {
            const auto take = [&](const Bur& solid, const Pose& inScene, Piece part) {
                const Pose local = product(inverse(mouth.teeth[t]), inScene);
                // A ball about the solid that is farther off than what was found settles it.
                const double half = 0.5 * solid.lengthMm();
                if (std::hypot(half, solid.maxRadiusMm()) - ball()->tree.signedDistance(local.apply({0, 0, half})) <
                    deepest)
                    return;
                const double d =
                    test::bruteForceDepth(ball()->tree, solid, local, part == Piece::bur ? 0.02 : 0.1).depthMm;
                if (d <= deepest) return;
                deepest = d;
                which = t;
                piece = part;
            };
            take(*bur, pose, Piece::bur);
            for (const instrument::BodyPiece& p : pieces)
                take(*p.solid, product(pose, p.inBur), p.part);
        }
        const Depth told = method->depth(pose);
        // Deeper than its own radius a piece is only promised to be so deep.
        if (deepest > 0.6) {
            EXPECT_GT(told.depthMm, 0.0);
            continue;
        }
        worstMm = std::max(worstMm, std::abs(told.depthMm - deepest));
        ASSERT_NEAR(told.depthMm, deepest, 1e-3) << i;  // blunt corners of an outline of lines: 0.5 um, docs/contact.md
        if (told.status != Status::ok) continue;
        ASSERT_EQ(told.tooth, which) << i;
        ++decided[static_cast<std::size_t>(told.piece)];
        ++teeth[told.tooth];
        // The point lies on that tooth, and the normal is that of one who leaves it.
        const Vec3 local = inverse(mouth.teeth[which]).apply(told.toothPointMm);
        EXPECT_NEAR(ball()->tree.signedDistance(local), 0.0, 1e-6);
        Pose out = pose;
        out.positionMm += (std::max(told.depthMm, 0.0) + 0.01) * told.normal;
        if (told.depthMm > 0.0 && told.depthMm < 0.2) {
            EXPECT_LT(method->depth(out).depthMm, told.depthMm);
        }
        (void)piece;
    }
    std::printf("  worst %.3f um; decided by bur %d, shank %d, head %d, handle %d; teeth %d %d %d\n", 1e3 * worstMm,
                decided[0], decided[1], decided[2], decided[3], teeth[0], teeth[1], teeth[2]);
    for (const int n : decided)
        EXPECT_GT(n, 0);
    for (const int n : teeth)
        EXPECT_GT(n, 1);
}

TEST(MouthMethod, AskedWhetherItIsDeeperAPieceTellsItsDepthOrThatItIsNot) {
    const auto bur = burOf("330");
    std::vector<std::shared_ptr<const Bur>> solids{bur, burOf("cylinder-flat:1.0x4.0"), burOf("inverted-cone:1.2x1.4")};
    for (const instrument::BodyPiece& piece : instrument::bodyPieces(*bur))
        solids.push_back(piece.solid);
    std::mt19937_64 g(test::seed());
    int told = 0, left = 0;
    double worstMm = 0.0;
    for (const std::shared_ptr<const Bur>& solid : solids) {
        const auto asked = makeFieldMethod(ball(), solid), plain = makeFieldMethod(ball(), solid);
        for (int i = 0; i < 150; ++i) {
            // Some place of it near the surface, in or out.
            Pose pose = turned({}, test::uniform(g, 0, 3.1), test::randomDirection(g));
            const Vec3 on(0, 0, test::uniform(g, 0, solid->lengthMm()));
            pose.positionMm = test::randomDirection(g) * test::uniform(g, 3.2, 6.0) - pose.orientation * on;
            const Depth d = plain->depth(pose);
            if (d.status != Status::ok) continue;
            for (const double aboveMm : {-0.5, -0.02, -1e-4, 1e-4, 0.02, 0.5}) {
                const double floorMm = d.depthMm + aboveMm;
                const Depth found = asked->depthBeyond(floorMm, pose);
                if (aboveMm < 0.0) {
                    ASSERT_EQ(found.status, Status::ok) << solid->name() << " " << i << ": " << d.depthMm << " above "
                                                        << floorMm << ", told " << found.depthMm;
                    worstMm = std::max(worstMm, std::abs(found.depthMm - d.depthMm));
                    ASSERT_NEAR(found.depthMm, d.depthMm, 1e-3 * kDepthToleranceMm + d.unseenMm) << solid->name() << i;
                    ++told;
                } else if (found.status == Status::ok) {
                    ASSERT_NEAR(found.depthMm, d.depthMm, kDepthToleranceMm + d.unseenMm) << solid->name() << i;
                } else {
                    ASSERT_LE(found.depthMm, std::max(floorMm, -5.0)) << solid->name() << i;
                    ASSERT_GE(found.depthMm, d.depthMm - kDepthToleranceMm) << solid->name() << i;
                    ++left;
                }
            }
        }
    }
    std::printf("  told %d times, left out %d; worst difference %.2e um\n", told, left, 1e3 * worstMm);
    EXPECT_GT(told, 500);
    EXPECT_GT(left, 200);
}

TEST(MouthMethod, WhatWasAskedBeforeMakesNoDifference) {
    const auto bur = burOf("330");
    const Mouth mouth;
    const auto going = mouth.of(bur, true), fresh = mouth.of(bur, true);
    std::mt19937_64 g(test::seed());
    double worstMm = 0.0;
    int touching = 0;
    for (int walk = 0; walk < 30; ++walk) {
        Pose pose = somewhere(g);
        for (int step = 0; step < 30; ++step) {
            pose.positionMm += test::uniform(g, 0.0, 0.1) * test::randomDirection(g);
            const Pose turn = turned(Vec3::Zero(), 0.01, test::randomDirection(g));
            pose.orientation = (turn.orientation * pose.orientation).normalized();
            fresh->reset();
            // Onto the teeth, and out of them where it is deep.
            const Depth there = fresh->depth(pose);
            pose.positionMm += (there.depthMm - test::uniform(g, -0.05, 0.1)) * there.normal;
            ConstraintSet set, again;
            going->constraints(pose, 0.1, set);
            const Depth d = going->depth(pose);
            fresh->reset();
            const Depth told = fresh->depth(pose);
            fresh->constraints(pose, 0.1, again);
            if (told.unseenMm > kDepthToleranceMm || told.depthMm > 0.3) continue;
            worstMm = std::max(worstMm, std::abs(d.depthMm - told.depthMm));
            ASSERT_NEAR(d.depthMm, told.depthMm, 2.0 * kDepthToleranceMm) << walk << " " << step;
            ASSERT_EQ(set.size(), again.size()) << walk << " " << step;
            touching += told.depthMm > -0.1;
        }
    }
    std::printf("  worst %.2e um; %d poses within 0.1 mm\n", 1e3 * worstMm, touching);
    EXPECT_GT(touching, 30);
}

TEST(MouthMethod, AddsUpWhatEachToothFeels) {
    const auto bur = burOf("cylinder-round:1.0x4.0");
    // Two slabs with the bur wedged between them, the second turned about the bur's own axis.
    const auto slab = test::toothOf(test::boxMesh({-3, -3, -2}, {-0.495, 3, 3}, 8));
    const Pose other = turned({0, 0, 0}, 2.6, {0, 0, 1});
    std::vector<PlacedMethod> placed;
    for (const Pose& at : {Pose{}, other})
        placed.push_back({makeFieldMethod(slab, bur),
                          bur,
                          {},
                          at,
                          slab->outer.bounds(),
                          static_cast<std::uint16_t>(placed.size()),
                          Piece::bur});
    const auto mouth = makeMouthMethod(std::move(placed));
    const auto one = makeFieldMethod(slab, bur), two = makeFieldMethod(slab, bur);
    const Pose pose = turned({0.002, 0.001, -0.5}, 0.7, {0, 0, 1});
    const Pose local = product(inverse(other), pose);
    PatchSet both, a, b;
    mouth->patches(pose, both);
    one->patches(pose, a);
    two->patches(local, b);
    ASSERT_FALSE(a.patches.empty());
    ASSERT_FALSE(b.patches.empty());
    EXPECT_DOUBLE_EQ(both.areaMm2, a.areaMm2 + b.areaMm2);
    EXPECT_DOUBLE_EQ(both.pressureMm3, a.pressureMm3 + b.pressureMm3);
    double shares = 0.0;
    bool seen[2] = {};
    for (const Patch& p : both.patches) {
        shares += p.pressureShare;
        seen[p.tooth] = true;
    }
    EXPECT_NEAR(shares, 1.0, 1e-12);
    EXPECT_TRUE(seen[0] && seen[1]);
    ConstraintSet held;
    mouth->constraints(pose, 0.1, held);
    bool from[2] = {};
    for (const Constraint& c : held)
        from[c.tooth] = true;
    EXPECT_TRUE(from[0] && from[1]);
    const Vec3 direction = Vec3(-0.9, 0.3, -0.1).normalized();
    Bearing sum, ba, bb;
    mouth->bearing(pose, direction, 0.002, 0.1, sum);
    one->bearing(pose, direction, 0.002, 0.1, ba);
    two->bearing(local, inverse(other).orientation * direction, 0.002, 0.1, bb);
    for (std::size_t t = 0; t < cases::kTissueCount; ++t) {
        EXPECT_NEAR(sum.areaMm2[t], ba.areaMm2[t] + bb.areaMm2[t], 1e-9);
        EXPECT_NEAR((sum.tangentMm[t] - ba.tangentMm[t] - other.orientation * bb.tangentMm[t]).norm(), 0.0, 1e-9);
    }
}

TEST(MouthMethod, TheTickNeverAllocates) {
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc: the trap is off";
    const auto method = Mouth{}.of(burOf("330"), true);
    std::mt19937_64 g(test::seed());
    const test::RealtimeTrap trap;
    PatchSet patches;
    ConstraintSet constraints;
    Bearing bearing;
    for (int i = 0; i < 200; ++i) {
        const Pose pose = somewhere(g);
        (void)method->depth(pose);
        (void)method->depthUpTo(0.1, pose);
        method->patches(pose, patches);
        method->constraints(pose, 0.2, constraints);
        method->bearing(pose, Vec3::UnitX(), 0.01, 0.1, bearing);
        (void)method->isCutNear(pose);
    }
    Pose bad;
    bad.positionMm.x() = std::nan("");
    EXPECT_EQ(method->depth(bad).status, Status::invalidPose);
    EXPECT_EQ(trap.total(), 0u);
}

TEST(MouthMethod, RefusesWhatIsNoMouth) {
    EXPECT_THROW((void)makeMouthMethod({}), core::Error);
    const auto bur = burOf("330");
    std::vector<PlacedMethod> nowhere;
    nowhere.push_back({makeFieldMethod(ball(), bur),
                       bur,
                       {},
                       {Vec3(std::nan(""), 0, 0), core::Quat::Identity()},
                       ball()->outer.bounds(),
                       0,
                       Piece::bur});
    EXPECT_THROW((void)makeMouthMethod(std::move(nowhere)), core::Error);
}

}  // namespace
}  // namespace handpiece::contact::mouth_method_test
