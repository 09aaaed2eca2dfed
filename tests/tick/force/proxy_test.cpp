// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/proxy.h"

#include <gtest/gtest.h>

#include "support/random.h"
#include "tick/force/analytic_methods.h"

namespace handpiece::force::proxy_test {
namespace {

using core::Pose;
using core::Vec3;
using test::AnalyticMethod;

constexpr double kRadius = 0.5, kLength = 4.0;
constexpr double kAllowedMm = 0.002;

Pose at(const Vec3& p) {
    return {p, core::Quat::Identity()};
}

/// Follows a path of device positions; the worst depth of the proxy over all of it.
class Follower {
  public:
    explicit Follower(test::Distance distance, double lengthMm = kLength)
        : method_(std::move(distance), kRadius, lengthMm), proxy_(ProxySettings{}) {}
    void start(const Pose& pose) { proxy_.start(method_, pose); }
    void go(const Pose& pose) {
        proxy_.update(method_, pose, method_.depth(pose), 1e-3);
        worstDepthMm = std::max(worstDepthMm, method_.depth(proxy_.pose()).depthMm);
        mostPasses = std::max(mostPasses, proxy_.passes());
    }
    /// In steps of at most `stepMm`.
    void line(const Vec3& from, const Vec3& to, double stepMm) {
        const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / stepMm)));
        for (int i = 1; i <= steps; ++i)
            go(at(from + (to - from) * (static_cast<double>(i) / steps)));
    }
    [[nodiscard]] const Proxy& proxy() const { return proxy_; }
    AnalyticMethod& method() { return method_; }
    double worstDepthMm = -10.0;
    int mostPasses = 0;

  private:
    AnalyticMethod method_;
    Proxy proxy_;
};

TEST(Proxy, isTheDeviceInFreeSpaceAtNoPass) {
    Follower f(test::plane());
    f.start(at({0, 0, 3}));
    f.line({0, 0, 3}, {1, 0, 0.2}, 0.5);
    EXPECT_LT((f.proxy().pose().positionMm - Vec3(1, 0, 0.2)).norm(), 1e-12);
    EXPECT_FALSE(f.proxy().touching());
}

TEST(Proxy, staysOnAPlaneAboveTheDevice) {
    Follower f(test::plane());
    f.start(at({0, 0, 1}));
    f.line({0, 0, 1}, {0, 0, -3}, 0.05);
    f.line({0, 0, -3}, {2, 1, -3}, 0.05);
    EXPECT_TRUE(f.proxy().touching());
    EXPECT_LT((f.proxy().pose().positionMm - Vec3(2, 1, 0)).norm(), 1e-4);
    EXPECT_LE(f.worstDepthMm, kAllowedMm);
    EXPECT_LE(f.mostPasses, ProxySettings{}.iterations + 3);
    EXPECT_EQ(f.proxy().strongestTissue(), cases::Tissue::enamel);
}

TEST(Proxy, leavesTheSurfaceWithTheDevice) {
    Follower f(test::plane());
    f.start(at({0, 0, 1}));
    f.line({0, 0, 1}, {0, 0, -2}, 0.1);
    f.line({0, 0, -2}, {0, 0, 4}, 1.0);  // 1 m/s
    EXPECT_LT((f.proxy().pose().positionMm - Vec3(0, 0, 4)).norm(), 1e-9);
    EXPECT_FALSE(f.proxy().touching());
}

TEST(Proxy, settlesWhereAClosedFormPutsIt) {
    // In a V a ball of radius R rests at height R / sin(half) - R above the root, on a slot at the height the two edges
    // allow.
    Follower v(test::groove(std::numbers::pi / 3));
    v.start(at({0, 0, 2}));
    v.line({0, 0, 2}, {0.1, 0, -1.5}, 0.05);
    v.go(at({0.1, 0, -1.5}));
    EXPECT_LT((v.proxy().pose().positionMm - Vec3(0, 0, kRadius / 0.5 - kRadius)).norm(), 2e-5);
    EXPECT_LE(v.worstDepthMm, kAllowedMm);

    Follower s(test::slot(0.7, 3.0));
    s.start(at({0, 0, 1}));
    s.line({0, 0, 1}, {0.05, 0, -1.5}, 0.05);
    s.go(at({0.05, 0, -1.5}));
    const double height = std::sqrt(kRadius * kRadius - 0.35 * 0.35) - kRadius;
    EXPECT_LT((s.proxy().pose().positionMm - Vec3(0, 0, height)).norm(), 2e-5);
    EXPECT_LE(s.worstDepthMm, kAllowedMm);
}

TEST(Proxy, findsTheNearestPlaceInABowl) {
    constexpr double kBowl = 1.5;
    std::mt19937_64 generator(test::seed());
    for (int round = 0; round < 20; ++round) {
        Follower f(test::bowl(kBowl), 2 * kRadius);  // a ball: its centre keeps within kBowl - kRadius of the bowl's
        const Vec3 centre(0, 0, kRadius);
        f.start(at(-centre));
        const Vec3 device = 5.0 * test::randomDirection(generator);
        f.line(-centre, device - centre, 0.1);
        for (int i = 0; i < 50; ++i)
            f.go(at(device - centre));
        const Vec3 expected = (kBowl - kRadius) * device.normalized();
        EXPECT_LT((f.proxy().pose().positionMm + centre - expected).norm(), 0.01);
        EXPECT_LE(f.worstDepthMm, kAllowedMm);
    }
}

TEST(Proxy, doesNotTunnelThroughAWallAtOneMetreASecond) {
    for (const double step : {1.0, 0.25, 0.125}) {
        Follower f(test::wall(0.3));
        f.start(at({-2, 0, -6}));
        f.line({-2, 0, -6}, {9, 0, -6}, step);
        EXPECT_LT(f.proxy().pose().positionMm.x(), -0.15 - kRadius + kAllowedMm);
        EXPECT_LE(f.worstDepthMm, kAllowedMm) << step;
    }
}

TEST(Proxy, isPushedOutWhereItStartsInside) {
    Follower f(test::plane());
    f.start(at({0, 0, -0.8}));
    EXPECT_LE(f.method().depth(f.proxy().pose()).depthMm, kAllowedMm);
    f.go(at({0, 0, -0.8}));
    EXPECT_NEAR(f.proxy().pose().positionMm.z(), 0.0, 1e-3);
}

TEST(Proxy, isPushedOutByATurn) {
    Follower f(test::plane());
    f.start(at({0, 0, 0.1}));
    f.line({0, 0, 0.1}, {0, 0, -0.5}, 0.05);
    for (int i = 0; i <= 100; ++i) {
        const double angle = 0.02 * i;  // over, until the shank would lie in the solid
        f.go({Vec3(0, 0, -0.5), core::Quat(Eigen::AngleAxisd(angle, Vec3::UnitX()))});
    }
    EXPECT_LE(f.worstDepthMm, kAllowedMm);
    EXPECT_GT(f.proxy().pose().positionMm.z(), 0.4);
}

TEST(Proxy, neverSinksOnRandomWalks) {
    std::mt19937_64 generator(test::seed());
    const std::vector<std::pair<test::Distance, Vec3>> scenes{
        {test::plane(), {0, 0, 1}},     {test::slot(1.2, 3.0), {0, 0, 1}}, {test::slot(0.7, 3.0), {0, 0, 1}},
        {test::groove(1.0), {0, 0, 3}}, {test::wall(0.4), {-1.5, 0, -2}},  {test::ball(1.0), {0, 0, 1.5}}};
    for (std::size_t scene = 0; scene < scenes.size(); ++scene) {
        SCOPED_TRACE(scene);
        Follower f(scenes[scene].first);
        Pose pose = at(scenes[scene].second);
        f.start(pose);
        Vec3 velocity = Vec3::Zero();
        for (int i = 0; i < 1500; ++i) {
            velocity = 0.97 * velocity + 0.01 * test::randomDirection(generator);
            pose.positionMm += velocity;
            pose.positionMm = pose.positionMm.cwiseMax(Vec3::Constant(-3)).cwiseMin(Vec3::Constant(3));
            pose.orientation =
                (core::Quat(Eigen::AngleAxisd(0.003, test::randomDirection(generator))) * pose.orientation)
                    .normalized();
            f.go(pose);
        }
        EXPECT_LE(f.worstDepthMm, kAllowedMm);
    }
}

}  // namespace
}  // namespace handpiece::force::proxy_test
