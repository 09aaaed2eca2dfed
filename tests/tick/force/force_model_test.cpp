// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/force_model.h"

#include <gtest/gtest.h>

#include "handpiece/base/core/error.h"
#include "tick/force/analytic_methods.h"

namespace handpiece::force::force_model_test {
namespace {

using core::Pose;
using core::Vec3;
using test::AnalyticMethod;

constexpr double kPeriodS = 1e-3, kRadius = 0.5;
constexpr double kStiffness = 0.5;  // of enamel through the default limits [N/mm]

Pose at(const Vec3& p) {
    return {p, core::Quat::Identity()};
}

/// Forces without damper, friction, velocity filter or limits in the way: a position gives a force.
Parameters still() {
    Parameters p = defaultParameters();
    p.dampingMultiplier = 0.0;
    p.frictionMultiplier = 0.0;
    return p;
}
Limits unlimited() {
    Limits limits;
    limits.maxForceN = 100;
    limits.maxForceSlopeNPerS = 1e9;
    return limits;
}

/// A bur in a scene, led by hand.
class Scene {
  public:
    Scene(test::Distance distance, const Limits& limits, const Parameters& parameters, double lengthMm = 4.0)
        : method(std::move(distance), kRadius, lengthMm), model(limits, parameters) {}
    ForceCommand go(const Pose& pose, bool lost = false) {
        touch = model.feel(method, pose, lost, kPeriodS);
        return model.compute(touch, kPeriodS);
    }
    ForceCommand line(const Vec3& from, const Vec3& to, double stepMm) {
        const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / stepMm)));
        ForceCommand last;
        for (int i = 0; i <= steps; ++i)
            last = go(at(from + (to - from) * (static_cast<double>(i) / steps)));
        return last;
    }
    AnalyticMethod method;
    ForceModel model;
    Touch touch;
};

TEST(ForceModel, isASpringOfTheTissueOnAPlane) {
    Scene s(test::plane(), unlimited(), still());
    const ForceCommand f = s.line({0, 0, 1}, {0, 0, -0.8}, 0.05);
    EXPECT_NEAR(f.forceN.z(), 0.5 * 0.8, 1e-5);
    EXPECT_NEAR(f.forceN.head<2>().norm(), 0.0, 1e-9);
    EXPECT_EQ(s.touch.tissue, cases::Tissue::enamel);
    EXPECT_EQ(s.touch.patches.patches.size(), 1u);
}

TEST(ForceModel, takesStiffnessFromTheTissueAndTheMultiplierUpToTheDevicesLimit) {
    for (const double multiplier : {0.5, 1.0, 3.0}) {
        Parameters p = still();
        p.stiffnessMultiplier = multiplier;
        AnalyticMethod dentine(test::plane(), kRadius, 4.0, cases::Tissue::dentine);
        ForceModel model(unlimited(), p);
        ForceCommand f;
        for (double z = 0.5; z > -0.4 - 1e-9; z -= 0.05) {
            f = model.compute(model.feel(dentine, at({0, 0, z}), false, kPeriodS), kPeriodS);
        }
        const double fraction = cases::properties(cases::Tissue::dentine).stiffnessFraction;
        EXPECT_NEAR(f.forceN.z(), 0.4 * std::min(0.5, 0.5 * fraction * multiplier), 1e-5);
    }
}

TEST(ForceModel, dampsTheApproachAndNeverPulls) {
    Parameters p = defaultParameters();
    p.tissues.fill({1.0, 0.005});
    Scene s(test::plane(), unlimited(), p);
    // 50 mm/s for long enough that the filter has settled.
    const ForceCommand in = s.line({0, 0, 3}, {0, 0, -1}, 0.05);
    EXPECT_NEAR(in.forceN.z(), 0.5 * 1.0 + 0.005 * 50, 1e-3);
    // Out at 300 mm/s: b v is 1.5 N, more than the spring has.
    bool reachedZero = false;
    for (double z = -1.0; z < 1.0; z += 0.3) {
        const ForceCommand out = s.go(at({0, 0, z}));
        EXPECT_GE(out.forceN.z(), 0.0);
        reachedZero = reachedZero || out.forceN.z() == 0.0;
    }
    EXPECT_TRUE(reachedZero);
}

TEST(ForceModel, isLimitedInSizeAndSlope) {
    Limits limits;
    Scene s(test::plane(), limits, still());
    const ForceCommand deep = s.line({0, 0, 1}, {0, 0, -20}, 0.1);
    EXPECT_TRUE(deep.forceLimited);
    EXPECT_NEAR(deep.forceN.norm(), limits.maxForceN, 1e-12);

    limits.maxForceSlopeNPerS = 100;  // 0.1 N a tick
    Scene slow(test::plane(), limits, still());
    Vec3 last = Vec3::Zero();
    for (double z = 1.0; z > -4.0; z -= 1.0) {
        const ForceCommand f = slow.go(at({0, 0, z}));
        EXPECT_LE((f.forceN - last).norm(), 0.1 + 1e-12);
        EXPECT_EQ(f.slopeLimited, z < -0.5);
        last = f.forceN;
    }
}

/// Leads the device around a closed path in small steps; work done on the hand and the largest change of force.
struct Loop {
    double workNmm = 0.0, peakN = 0.0, worstChangeN = 0.0;
};
Loop around(Scene& scene, const Vec3& centre, const Vec3& a, const Vec3& b, double radiusMm, double stepMm, int turns) {
    Loop result;
    const int points = static_cast<int>(std::ceil(2 * std::numbers::pi * radiusMm / stepMm));
    const auto point = [&](int i) {
        const double angle = 2 * std::numbers::pi * i / points;
        return Vec3(centre + radiusMm * (std::cos(angle) * a + std::sin(angle) * b));
    };
    scene.line(centre - 4.0 * a, point(0), stepMm);
    for (int i = 0; i < points; ++i)
        scene.go(at(point(i)));  // once to settle
    Vec3 position = point(0), force = scene.go(at(position)).forceN;
    for (int i = 1; i <= turns * points; ++i) {
        const Vec3 next = point(i % points);
        const Vec3 nextForce = scene.go(at(next)).forceN;
        result.workNmm += 0.5 * (force + nextForce).dot(next - position);
        result.worstChangeN = std::max(result.worstChangeN, (nextForce - force).norm());
        result.peakN = std::max(result.peakN, nextForce.norm());
        position = next;
        force = nextForce;
    }
    return result;
}

TEST(ForceModel, isContinuousInASlotAndInAVee) {
    constexpr double kStepMm = 0.001;
    const auto check = [&](test::Distance distance, const Vec3& from, const Vec3& to) {
        Scene s(std::move(distance), unlimited(), still());
        s.line(from + Vec3(0, 0, 2), from, 0.02);
        Vec3 last = s.go(at(from)).forceN;
        const int steps = static_cast<int>((to - from).norm() / kStepMm);
        double worst = 0.0;
        for (int i = 1; i <= steps; ++i) {
            const Vec3 f = s.go(at(from + (to - from) * (static_cast<double>(i) / steps))).forceN;
            worst = std::max(worst, (f - last).norm());
            last = f;
        }
        return worst;
    };
    for (const double depth : {0.3, 1.0}) {
        for (const test::Distance& scene : {test::slot(0.7, 3.0), test::groove(std::numbers::pi / 3)}) {
            const double across = check(scene, {-0.12, 0, -depth}, {0.12, 0, -depth});
            const double along = check(scene, {0.03, -0.2, -depth}, {0.05, 0.2, -depth});
            const double down = check(scene, {0.02, 0, 0.5}, {0.05, 0, -depth});
            for (const double worst : {across, along, down})
                EXPECT_LE(worst, 3 * kStiffness * kStepMm) << depth;
            RecordProperty("worst_change_mN", std::to_string(1e3 * std::max({across, along, down})));
            std::printf("  depth %.1f: |dF| / (k step) across %.2f, along %.2f, down %.2f (allowed 3)\n", depth,
                        across / (kStiffness * kStepMm), along / (kStiffness * kStepMm), down / (kStiffness * kStepMm));
        }
    }
}

TEST(ForceModel, doesNoWorkAroundAClosedLoop) {
    struct Case {
        const char* name;
        test::Distance distance;
        Vec3 centre, a, b;
    };
    const std::vector<Case> cases{{"plane", test::plane(), {0, 0, -0.4}, Vec3::UnitX(), Vec3::UnitZ()},
                                  {"plane, sideways", test::plane(), {0, 0, -0.4}, Vec3::UnitX(), Vec3::UnitY()},
                                  {"V", test::groove(std::numbers::pi / 3), {0, 0, 0.2}, -Vec3::UnitZ(), Vec3::UnitX()},
                                  {"slot", test::slot(0.7, 3.0), {0, 0, -0.6}, -Vec3::UnitZ(), Vec3::UnitX()},
                                  {"ball", test::ball(1.5), {0.1, 0, 1.2}, -Vec3::UnitZ(), Vec3::UnitX()}};
    for (const Case& c : cases) {
        Scene s(c.distance, unlimited(), still());
        const Loop loop = around(s, c.centre, c.a, c.b, 0.15, 0.002, 1);
        ASSERT_GT(loop.peakN, 0.05) << c.name;
        const double share = std::abs(loop.workNmm) / (loop.peakN * 0.3);
        EXPECT_LE(share, 0.01) << c.name;
        std::printf("  %s: work / (F_peak x 0.3 mm) = %.4f %%, peak %.3f N\n", c.name, 100 * share, loop.peakN);
    }
}

TEST(ForceModel, frictionSticksThenSlipsAtCoulombsLimitAndOpposesTheSlide) {
    Parameters p = still();
    p.frictionMultiplier = 1.0;
    const double mu = cases::properties(cases::Tissue::enamel).friction, depth = 0.8, press = kStiffness * depth;
    ASSERT_GT(mu, 0.0);
    Scene s(test::plane(), unlimited(), p);
    EXPECT_NEAR(s.line({0, 0, 1}, {0, 0, -depth}, 0.05).forceN.head<2>().norm(), 0.0, 1e-9);
    // Sticks: the bristle gives way like the contact itself.
    const double stick = 0.5 * mu * depth;
    EXPECT_NEAR(s.line({0, 0, -depth}, {stick, 0, -depth}, 0.001).forceN.x(), -kStiffness * stick, 1e-6);
    // Slips: mu times the press, against the way, whichever it is; the press itself is as without friction.
    for (const Vec3& way : {Vec3(1, 0, 0), Vec3(-0.6, 0.8, 0), Vec3(0, -1, 0)}) {
        const Vec3 from = s.touch.deviceInTooth.positionMm;
        const ForceCommand f = s.line(from, from + 2.0 * way, 0.002);
        const Vec3 sideways(f.forceN.x(), f.forceN.y(), 0.0);
        EXPECT_NEAR(sideways.norm(), mu * press, 1e-6);
        EXPECT_NEAR(sideways.normalized().dot(way), -1.0, 1e-3);
        EXPECT_NEAR(f.forceN.z(), press, 1e-5);
        EXPECT_NEAR((f.loadN + Vec3(0, 0, press)).norm(), 0.0, 1e-5);  // on the tooth, without friction
    }
    // Lifted and put down elsewhere nothing is remembered.
    s.line(s.touch.deviceInTooth.positionMm, {5, 5, 1}, 0.05);
    EXPECT_NEAR(s.line({5, 5, 1}, {5, 5, -depth}, 0.05).forceN.head<2>().norm(), 0.0, 1e-9);
}

TEST(ForceModel, aTurningBurHardlyRubsAgainstTheHandsSlide) {
    Parameters p = still();
    p.frictionMultiplier = 1.0;
    const double press = kStiffness * 0.8;
    const auto slideWith = [&](const Turning& turning) {
        AnalyticMethod plane(test::plane(), kRadius, 4.0);
        ForceModel model(unlimited(), p);
        ForceCommand last;
        for (int i = 0; i <= 2000; ++i) {
            const double z = std::max(-0.8, 1.0 - 0.01 * i), x = 0.005 * std::max(0, i - 300);  // 5 mm/s
            last = model.compute(model.feel(plane, at({x, 0, z}), false, kPeriodS), kPeriodS, turning);
        }
        return last;
    };
    EXPECT_NEAR(slideWith({}).forceN.x(), -0.12 * press, 1e-5);
    EXPECT_LT(std::abs(slideWith({Vec3::Zero(), 14000.0}).forceN.x()), 1e-3 * press);
    // What its rotation does to it comes on top, as far as the device can.
    EXPECT_NEAR(slideWith({Vec3(0, 0.1, 0), 14000.0}).forceN.y(), 0.1, 1e-6);
}

TEST(ForceModel, waitsWithoutForceUntilTheBurIsClearThenFadesIn) {
    Scene s(test::plane(), unlimited(), still());
    s.line({0, 0, 1}, {0, 0, -0.8}, 0.05);
    s.model.waitUntilClear();
    for (int i = 0; i < 50; ++i)
        EXPECT_EQ(s.go(at({0.01 * i, 0, -0.8})).forceN, Vec3::Zero());
    EXPECT_TRUE(s.model.waiting());
    s.line({0.5, 0, -0.8}, {0.5, 0, 0.2}, 0.02);
    EXPECT_FALSE(s.model.waiting());
    const double early = s.line({0.5, 0, 0.2}, {0.5, 0, -0.8}, 0.1).forceN.z();  // 10 of 200 ms
    EXPECT_LT(early, 0.15 * kStiffness * 0.8);
    ForceCommand last;
    for (int i = 0; i < 250; ++i)
        last = s.go(at({0.5, 0, -0.8}));
    EXPECT_NEAR(last.forceN.z(), kStiffness * 0.8, 1e-5);
}

TEST(ForceModel, torqueOfAPushAtTheTipIsLeverTimesForce) {
    Parameters p = still();
    p.gripMm = {0, 0, 80};
    Scene s(test::wall(1.5), unlimited(), p, 4.0);
    // The side of the bur against the wall: the wall pushes along -x somewhere along the bur's 4 mm.
    const ForceCommand f = s.line({-3, 0, -2}, {-0.25, 0, -2}, 0.05);
    ASSERT_LT(f.forceN.x(), -0.1);
    EXPECT_EQ(f.torqueNmm, Vec3::Zero());                     // this device has no torque axes
    const double lever = f.fullTorqueNmm.y() / f.forceN.x();  // (r x F).y = r_z F_x
    EXPECT_LT(lever, -76.0);
    EXPECT_GT(lever, -80.0);
    EXPECT_NEAR(f.fullTorqueNmm.x(), 0.0, 1e-6);

    Limits withTorque = unlimited();
    withTorque.maxTorqueNmm = 5.0;
    Scene limited(test::wall(1.5), withTorque, p, 4.0);
    EXPECT_NEAR(limited.line({-3, 0, -2}, {-0.25, 0, -2}, 0.05).torqueNmm.norm(), 5.0, 1e-9);
}

TEST(ForceModel, penaltyIsDepthAndApproachAlongTheNormal) {
    Parameters p = defaultParameters();
    p.law = LawId::penalty;
    Scene s(test::plane(), Limits{}, p);
    const ForceCommand f = s.line({0, 0, 3}, {0, 0, -1}, 0.05);
    EXPECT_NEAR(f.forceN.z(), 0.5 * 1.0 + 0.002 * 50, 1e-3);
    EXPECT_EQ(s.touch.proxyInTooth.positionMm, s.touch.deviceInTooth.positionMm);
    EXPECT_NEAR(s.line({0, 0, -1}, {0, 0, -12}, 0.05).forceN.z(), 3.3, 1e-12);
    for (double z = -12; z < 2; z += 1.0)
        EXPECT_GE(s.go(at({0, 0, z})).forceN.z(), 0.0);
}

TEST(ForceModel, penaltyPopsThroughAThinWallWhereTheProxyHolds) {
    // What models of a pure penalty do, and why the proxy is the default.
    for (const LawId law : {LawId::penalty, LawId::proxy}) {
        Parameters p = still();
        p.law = law;
        Scene s(test::wall(1.5), Limits{}, p);
        double most = 0.0;
        for (double x = -3; x < 7; x += 0.02)
            most = std::max(most, -s.go(at({x, 0, -2})).forceN.x());
        const Vec3 after = s.go(at({7, 0, -2})).forceN;
        if (law == LawId::penalty) {
            EXPECT_NEAR(most, 0.5 * (0.75 + kRadius), 0.02);  // k (w/2 + r)
            EXPECT_EQ(after, Vec3::Zero());
        } else {
            EXPECT_NEAR(most, 3.3, 1e-9);
            EXPECT_NEAR(after.x(), -3.3, 1e-9);
        }
    }
}

TEST(ForceModel, anyDoubtAboutThePoseEndsInZeroForceRampedAndFadesInAgain) {
    Scene s(test::plane(), Limits{}, still());
    const Vec3 before = s.line({0, 0, 1}, {0, 0, -2}, 0.05).forceN;
    ASSERT_NEAR(before.z(), 1.0, 1e-4);
    Pose bad = at({0, 0, -2});
    bad.positionMm.x() = std::numeric_limits<double>::quiet_NaN();
    double last = before.z();
    for (int i = 0; i < 30; ++i) {
        const double f = s.go(bad).forceN.z();
        EXPECT_TRUE(std::isfinite(f));
        EXPECT_LE(f, last);
        EXPECT_GE(f, last - 0.11);  // ramped: 1 N over 10 ms
        last = f;
    }
    EXPECT_EQ(last, 0.0);
    EXPECT_TRUE(s.model.guard().faulted());
    for (int i = 0; i < 400; ++i) {
        const double f = s.go(at({0, 0, -2})).forceN.z();
        EXPECT_GE(f, last - 1e-9);
        EXPECT_LE(f - last, 0.006);
        last = f;
    }
    EXPECT_NEAR(last, 1.0, 1e-3);
}

TEST(ForceModel, fadesInWhenItStartsInsideATooth) {
    Scene s(test::plane(), Limits{}, still());
    EXPECT_EQ(s.go(at({0, 0, -0.8})).forceN.norm(), 0.0);
    for (int i = 0; i < 250; ++i)
        s.go(at({0, 0, -0.8}));
    EXPECT_NEAR(s.go(at({0, 0, -0.8})).forceN.z(), 0.4, 1e-3);
}

TEST(Parameters, refusesWhatIsNotANumberOrOutOfRange) {
    const auto refused = [](auto change) {
        Parameters p = defaultParameters();
        change(p);
        EXPECT_THROW(validate(p), core::Error);
        EXPECT_THROW(ForceModel(Limits{}, p), core::Error);
    };
    EXPECT_NO_THROW(validate(defaultParameters()));
    refused([](Parameters& p) { p.stiffnessMultiplier = -1; });
    refused([](Parameters& p) { p.stiffnessMultiplier = std::numeric_limits<double>::quiet_NaN(); });
    refused([](Parameters& p) { p.dampingMultiplier = 1e9; });
    refused([](Parameters& p) { p.tissues[1].stiffnessFraction = 1.5; });
    refused([](Parameters& p) { p.velocityTauS = std::numeric_limits<double>::infinity(); });
    refused([](Parameters& p) { p.proxy.iterations = 0; });
    EXPECT_EQ(lawByName("proxy"), LawId::proxy);
    EXPECT_EQ(lawByName("penalty"), LawId::penalty);
    EXPECT_THROW((void)lawByName("magic"), core::Error);
}

}  // namespace
}  // namespace handpiece::force::force_model_test
