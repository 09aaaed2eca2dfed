// SPDX-License-Identifier: Apache-2.0
// The figures of the force with the real contact: a 1 mm bur, real triangles, a real field.
#include <gtest/gtest.h>

#include <map>

#include "handpiece/model/instrument/shapes.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/force/force_model.h"
#include "tick/force/prism_tooth.h"

namespace handpiece::force::field_force_test {
namespace {

using core::Pose;
using core::Quat;
using core::Vec2;
using core::Vec3;

constexpr double kPeriodS = 1e-3, kStiffness = 0.5, kStepMm = 0.001;

Parameters still() {
    Parameters p = defaultParameters();
    p.dampingMultiplier = 0.0;
    return p;
}
Limits unlimited() {
    Limits limits;
    limits.maxForceN = 100;
    limits.maxForceSlopeNPerS = 1e9;
    return limits;
}

/// A bur led by hand in the frame of the outline; the tooth may lie turned in its own grid.
class Scene {
  public:
    explicit Scene(const std::vector<Vec2>& outline, double voxelMm = 0.05, const Quat& turn = Quat::Identity(),
                   const Limits& limits = unlimited())
        : turn_(turn),
          method_(contact::makeFieldMethod(
              test::prismTooth(outline, 1.2, voxelMm, turn),
              std::make_shared<const instrument::Bur>(instrument::makeBur("cylinder-round:1.0x4.0")))),
          model_(limits, still()) {}
    Vec3 force(const Vec3& position) {
        const Touch& touch = model_.feel(*method_, {turn_ * position, turn_}, false, kPeriodS);
        worstSinkMm = std::max(worstSinkMm, method_->depth(touch.proxyInTooth).depthMm);
        mostPasses = std::max(mostPasses, touch.passes);
        return turn_.conjugate() * model_.compute(touch, kPeriodS).forceN;
    }
    /// Largest change of force between two points of a line.
    double line(const Vec3& from, const Vec3& to, double stepMm) {
        const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / stepMm)));
        double worst = 0.0;
        Vec3 last = force(from);
        for (int i = 1; i <= steps; ++i) {
            const Vec3 f = force(from + (to - from) * (static_cast<double>(i) / steps));
            worst = std::max(worst, (f - last).norm());
            last = f;
        }
        return worst;
    }
    double worstSinkMm = -10.0;
    int mostPasses = 0;

  private:
    Quat turn_;
    std::unique_ptr<contact::Method> method_;
    ForceModel model_;
};

TEST(FieldForce, isContinuousInASlotAndInAVee) {
    for (const auto& [name, outline] :
         {std::pair{"slot", test::slotOutline()}, std::pair{"60 degree V", test::veeOutline()}}) {
        Scene s(outline);
        for (const double depth : {0.2, 0.8}) {
            s.line({0.02, 0, 2}, {0.02, 0, 0.6}, 0.05);
            const double down = s.line({0.02, 0, 0.6}, {-0.1, 0, -depth}, kStepMm);
            const double across = s.line({-0.1, 0, -depth}, {0.1, 0, -depth}, kStepMm);
            const double along = s.line({0.1, 0, -depth}, {0.05, 0.3, -depth}, kStepMm);
            const double up = s.line({0.05, 0.3, -depth}, {0.02, 0, 0.6}, kStepMm);
            std::printf(
                "  %s, %.1f mm deep: |dF| / (k step) down %.2f, across %.2f, along %.2f, up %.2f (allowed 3); sinks "
                "%.2f um, "
                "%d passes\n",
                name, depth, down / (kStiffness * kStepMm), across / (kStiffness * kStepMm),
                along / (kStiffness * kStepMm), up / (kStiffness * kStepMm), 1e3 * s.worstSinkMm, s.mostPasses);
            for (const double worst : {down, across, along, up})
                EXPECT_LE(worst, 3 * kStiffness * kStepMm) << name;
        }
        EXPECT_LE(s.worstSinkMm, 0.002) << name;
    }
}

TEST(FieldForce, doesNoWorkAroundAClosedLoop) {
    for (const auto& [name, outline] :
         {std::pair{"slot", test::slotOutline()}, std::pair{"60 degree V", test::veeOutline()}}) {
        Scene s(outline);
        const Vec3 centre(0.02, 0, name == std::string("slot") ? -0.5 : 0.1);
        const auto point = [&](int i) {
            const double a = 2 * 3.14159265358979 * i / 1000;
            return Vec3(centre + 0.15 * Vec3(std::sin(a), 0.3 * std::sin(a), std::cos(a)));
        };
        s.line({0, 0, 2}, point(0), 0.02);
        for (int i = 0; i < 1000; ++i)
            s.force(point(i));
        double work = 0.0, peak = 0.0;
        Vec3 last = s.force(point(0));
        for (int i = 1; i <= 1000; ++i) {
            const Vec3 f = s.force(point(i % 1000));
            work += 0.5 * (f + last).dot(point(i % 1000) - point(i - 1));
            peak = std::max(peak, f.norm());
            last = f;
        }
        std::printf("  %s: |work| / (F_peak x 0.3 mm) = %.3f %%, peak %.3f N\n", name,
                    100 * std::abs(work) / (peak * 0.3), peak);
        ASSERT_GT(peak, 0.05);
        EXPECT_LE(std::abs(work), 0.01 * peak * 0.3) << name;
    }
}

TEST(FieldForce, agreesBetweenVoxelSizesAndTurnedGrids) {
    const Quat turned(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
    struct Grid {
        const char* name;
        double voxelMm;
        Quat turn;
    };
    const std::vector<Grid> grids{{"50 um", 0.05, Quat::Identity()},
                                  {"25 um", 0.025, Quat::Identity()},
                                  {"100 um", 0.1, Quat::Identity()},
                                  {"50 um, turned", 0.05, turned}};
    for (const auto& [name, outline] :
         {std::pair{"slot", test::slotOutline()}, std::pair{"60 degree V", test::veeOutline()}}) {
        std::vector<Vec3> reference;
        for (const Grid& grid : grids) {
            Scene s(outline, grid.voxelMm, grid.turn);
            s.line({0, 0, 2}, {0.02, 0, 0.4}, 0.05);
            std::vector<Vec3> forces;
            for (int i = 0; i <= 40; ++i) {
                const double t = 2 * 3.14159265358979 * i / 40;
                const Vec3 p(0.1 * std::sin(t), 0.2 * std::sin(2 * t), -0.1 - 0.5 * std::sin(0.5 * t));
                forces.push_back(s.force(p));
            }
            if (reference.empty()) {
                reference = forces;
                continue;
            }
            double worst = 0.0;
            for (std::size_t i = 0; i < forces.size(); ++i) {
                worst = std::max(worst, (forces[i] - reference[i]).norm() / reference[i].norm());
            }
            std::printf("  %s, %s against 50 um: worst difference %.2f %%\n", name, grid.name, 100 * worst);
            EXPECT_LE(worst, 0.02) << name << ", " << grid.name;
        }
    }
}

TEST(FieldForce, aThinWallHoldsTheLargestForce) {
    Scene s(test::wallOutline(), 0.05, Quat::Identity(), Limits{});
    Vec3 last = Vec3::Zero();
    for (double x = -2.5; x < 7.0; x += 0.02)
        last = s.force({x, 0, -2});  // 3.3 N is 6.6 mm: the hand is through the wall
    EXPECT_NEAR(last.x(), -3.3, 1e-6);
    for (int i = 0; i < 2000; ++i)
        last = s.force({7.0, 0.2 * std::sin(0.01 * i), -2});
    EXPECT_NEAR(last.norm(), 3.3, 1e-6);
    EXPECT_LT(last.x(), -3.2);
    EXPECT_LE(s.worstSinkMm, 0.002);
}

}  // namespace
}  // namespace handpiece::force::field_force_test
