// SPDX-License-Identifier: Apache-2.0
// Where a sample says that the bur bears on the tooth, against balls, a wall and a plane in closed form.
#include <gtest/gtest.h>

#include "handpiece/model/instrument/shapes.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/loop/loop_run.h"
#include "support/closed_meshes.h"
#include "tick/force/analytic_methods.h"

namespace handpiece::loop::contact_point_test {
namespace {

using core::Pose;
using core::Quat;
using core::Vec3;
using messages::HapticSample;

constexpr double kBallMm = 5.0, kBurMm = 0.5;

std::unique_ptr<contact::Method> methodOf(const geometry::TriangleMesh& mesh, const char* bur) {
    cases::Case made;
    made.name = "made";
    made.outer = mesh;
    made.parts.push_back({"enamel", cases::Tissue::enamel, 0, mesh});
    tooth::LoadSettings settings;
    settings.useCache = false;
    return contact::makeFieldMethod(tooth::loadModel(made, settings),
                                    std::make_shared<const instrument::Bur>(instrument::makeBur(bur)));
}

/// The hand goes there in a straight line; `each` hears of every tick.
template <class Each>
void goTo(std::unique_ptr<contact::Method> method, const Vec3& from, const Vec3& to, Each&& each,
          const force::Parameters& parameters = force::defaultParameters()) {
    device::SimulatedDeviceSettings settings;
    settings.rigidHand = true;
    const Vec3 way = to - from;
    HapticLoop loop({},
                    std::make_unique<device::SimulatedDevice>(
                        settings, device::drop({from, Quat::Identity()}, way.normalized(), way.norm(), 10.0, 0.3)),
                    std::move(method), parameters);
    (void)runSimulated(loop, way.norm() / 10.0 + 0.3, each);
}
Vec3 pointOf(const HapticSample& s) {
    return Vec3(s.contactPointMm.data());
}
Vec3 normalOf(const HapticSample& s) {
    return Vec3(s.contactNormal.data());
}

TEST(ContactPoint, twoBallsMeetOnTheLineOfTheirCentres) {
    const geometry::TriangleMesh ball = test::sphereMesh(5, kBallMm);
    for (const Vec3& side : {Vec3(0, 0, 0), Vec3(1.5, 0, 0), Vec3(-1, 2, 0), Vec3(0.7, -2.5, 0)}) {
        int held = 0, apart = 0;
        goTo(methodOf(ball, "round:1.0x1.0"), side + Vec3(0, 0, 5.6), side + Vec3(0, 0, 3.9),
             [&](const HapticSample& s) {
                 if (!(s.depthMm > 0.0)) {
                     ++apart;
                     EXPECT_EQ(normalOf(s), Vec3::Zero());
                     return;
                 }
                 ++held;
                 const Vec3 centre = Vec3(s.proxyPositionMm.data()) + kBurMm * Vec3::UnitZ();
                 EXPECT_LT((pointOf(s) - kBallMm * centre.normalized()).norm(), 0.03);
                 EXPECT_GT(normalOf(s).dot(centre.normalized()), std::cos(0.05));
             });
        EXPECT_GT(held, 250);
        EXPECT_GT(apart, 5);
    }
}

TEST(ContactPoint, aCylinderBearsOnAWallAtItsSide) {
    // Its straight side begins 0.5 mm over the tip and goes on beyond the box's edge.
    int held = 0;
    goTo(methodOf(test::boxMesh(Vec3(-3, -3, -5), Vec3(3, 3, 0)), "cylinder-round:1.0x4.0"), Vec3(4, 0.4, -3),
         Vec3(2.9, 0.4, -3), [&](const HapticSample& s) {
             if (!(s.depthMm > 0.0)) return;
             ++held;
             EXPECT_NEAR(pointOf(s).x(), 3.0, 0.03);
             EXPECT_NEAR(pointOf(s).y(), 0.4, 0.03);
             EXPECT_NEAR(pointOf(s).z(), 0.5 * (-2.5 + 0.0), 0.15);
             EXPECT_GT(normalOf(s).x(), 0.999);
         });
    EXPECT_GT(held, 250);
}

TEST(ContactPoint, withoutPatchesItIsTheDeepestPoint) {
    force::Parameters penalty = force::defaultParameters();
    penalty.law = force::LawId::penalty;
    int held = 0;
    goTo(
        std::make_unique<test::AnalyticMethod>(test::plane(), kBurMm, 4.0, cases::Tissue::enamel), Vec3(1, 2, 0.5),
        Vec3(1, 2, -0.2),
        [&](const HapticSample& s) {
            EXPECT_EQ(normalOf(s).norm() > 0.5, s.depthMm > 0.0);
            if (!(s.depthMm > 0.0)) return;
            ++held;
            EXPECT_LT((pointOf(s) - Vec3(1, 2, 0)).norm(), 1e-6);
            EXPECT_LT((normalOf(s) - Vec3::UnitZ()).norm(), 1e-6);
        },
        penalty);
    EXPECT_GT(held, 250);
}

}  // namespace
}  // namespace handpiece::loop::contact_point_test
