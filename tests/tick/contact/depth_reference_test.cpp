// SPDX-License-Identifier: Apache-2.0
// Depth against brute force on the product's own molar, and against the minimal translation of convex pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "handpiece/model/starter/starter.h"
#include "handpiece/tick/contact/hull/hull_method.h"
#include "support/brute_force_depth.h"
#include "tick/contact/contact_fixture.h"

namespace handpiece::contact::depth_reference_test {
namespace {

using core::Vec3;
constexpr double kPi = std::numbers::pi;

std::shared_ptr<const tooth::ToothModel> molar() {
    static const auto tooth = test::toothOf(starter::makeOuter(starter::ToothKind::lowerFirstMolar, 9760));
    return tooth;
}

std::shared_ptr<const instrument::Bur> burOf(std::string_view name) {
    if (name == "mesh")  // the paper's polyhedral bur, as its STL would be read
        return std::make_shared<const instrument::Bur>(
            instrument::burFromMesh("mesh", instrument::makeBur("paper").mesh()));
    return std::make_shared<const instrument::Bur>(instrument::makeBur(name));
}

/// Over cusps and fissures, tilted by up to 15 degrees, lowered to the depth wanted.
core::Pose lowered(std::mt19937_64& generator, Method& method, double depthMm) {
    const core::Box box = molar()->outer.bounds();
    for (;;) {
        const double turn = test::uniform(generator, 0.0, 2.0 * kPi), tilt = test::uniform(generator, 0.0, kPi / 12.0);
        core::Pose pose;
        pose.orientation = core::Quat(Eigen::AngleAxisd(tilt, Vec3(std::cos(turn), std::sin(turn), 0.0)));
        const double x = box.centre().x() + 0.27 * box.size().x() * test::uniform(generator, -1.0, 1.0);
        const double y = box.centre().y() + 0.27 * box.size().y() * test::uniform(generator, -1.0, 1.0);
        double high = box.max.z() + 1.0, low = box.max.z() - 4.0;
        const auto depthAt = [&](double z) {
            pose.positionMm = {x, y, z};
            return method.depth(pose).depthMm;
        };
        if (depthAt(low) < depthMm) continue;
        for (int i = 0; i < 30; ++i)
            (depthAt(0.5 * (low + high)) < depthMm ? high : low) = 0.5 * (low + high);
        pose.positionMm.z() = low;
        return pose;
    }
}

struct Bound {
    const char* bur;
    double medianUm, p99Um, worstUm;
};
class OnTheMolar : public testing::TestWithParam<Bound> {};

TEST_P(OnTheMolar, exactDepthAgreesWithBruteForce) {
    constexpr int kPoses = 60;
    const auto bur = burOf(GetParam().bur);
    const auto method = makeFieldMethod(molar(), bur);
    std::mt19937_64 generator(test::seed());
    std::vector<double> errors;
    for (int i = 0; i < kPoses; ++i) {
        const double wanted = std::exp(test::uniform(generator, std::log(0.005), std::log(1.5)));
        const core::Pose pose = lowered(generator, *method, wanted);
        const double exact = test::bruteForceDepth(molar()->tree, *bur, pose).depthMm;
        errors.push_back(1e3 * std::abs(method->depth(pose).depthMm - exact));
    }
    std::sort(errors.begin(), errors.end());
    EXPECT_LE(errors[kPoses / 2], GetParam().medianUm);
    EXPECT_LE(errors[kPoses * 95 / 100], GetParam().p99Um);
    EXPECT_LE(errors.back(), GetParam().worstUm);
}
INSTANTIATE_TEST_SUITE_P(Burs, OnTheMolar,
                         testing::Values(Bound{"cylinder-round:1.0x4.0", 0.01, 0.2, 2.0},
                                         Bound{"pear:1.2x3.0", 0.01, 0.2, 2.0},
                                         Bound{"cylinder-flat:1.0x4.0", 0.05, 2.0, 5.0},
                                         Bound{"wheel:2.0x0.8", 0.05, 2.0, 5.0},
                                         Bound{"inverted-cone:1.2x1.2", 0.05, 2.0, 5.0},
                                         Bound{"taper-flat:1.2x4.0", 0.05, 2.0, 5.0}, Bound{"mesh", 0.05, 2.0, 5.0}));

class ApartFromTheMolar : public testing::TestWithParam<const char*> {};

TEST_P(ApartFromTheMolar, theDistanceAgreesWithBruteForce) {
    constexpr int kPoses = 60;
    const auto bur = burOf(GetParam());
    const auto method = makeFieldMethod(molar(), bur);
    // A bur from a mesh is asked along its medial axis, which is true to that.
    const bool fromMesh = std::string_view(GetParam()) == "mesh";
    const double toleranceMm = fromMesh ? 1.5 * instrument::kMedialToleranceMm : 1e-6;
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < kPoses; ++i) {
        const double wanted = -std::exp(test::uniform(generator, std::log(1e-4), std::log(2.0)));
        const core::Pose pose = lowered(generator, *method, wanted);
        const double exact = test::bruteForceDepth(molar()->tree, *bur, pose).depthMm;
        const Depth found = method->depth(pose);
        EXPECT_NEAR(found.depthMm, exact, toleranceMm) << "pose " << i;
        if (found.depthMm > -1e-9) continue;
        // What is told of the place fits the distance.
        const auto awayMm = [&](const Vec3& p) { return bur->signedDistance(pose.applyInverse(p)); };
        EXPECT_NEAR(awayMm(found.toothPointMm), -found.depthMm, toleranceMm);
        EXPECT_NEAR(awayMm(found.toothPointMm - found.depthMm * found.normal), 0.0, toleranceMm);
        EXPECT_NEAR(molar()->tree.nearest(found.toothPointMm).distanceMm, 0.0, 1e-9);
    }
}
INSTANTIATE_TEST_SUITE_P(Burs, ApartFromTheMolar,
                         testing::Values("cylinder-round:1.0x4.0", "cylinder-flat:1.0x4.0", "wheel:2.0x0.8",
                                         "inverted-cone:1.2x1.2", "taper-flat:1.2x4.0", "6847-016", "34", "mesh"));

TEST(DepthReference, isNeverMoreThanTheMinimalTranslationOfAConvexPair) {
    const geometry::TriangleMesh block = test::boxMesh({-3, -2.5, -3}, {3, 2.5, 0}, 12);
    const auto tooth = test::toothOf(block);
    std::mt19937_64 generator(test::seed());
    struct Size {
        instrument::Shape shape;
        double lengthMm;
    };
    using instrument::Shape;
    for (const auto& [shape, lengthMm] :
         {Size{Shape::round, 1.1}, Size{Shape::invertedCone, 1.2}, Size{Shape::cylinderFlat, 4.0},
          Size{Shape::cylinderRound, 4.0}, Size{Shape::taperFlat, 4.0}, Size{Shape::taperRound, 4.0},
          Size{Shape::pear, 3.0}, Size{Shape::flame, 4.0}, Size{Shape::torpedo, 4.0}, Size{Shape::wheel, 0.8}}) {
        const instrument::Profile profile = instrument::makeProfile(shape, 1.2, lengthMm);
        const auto bur = std::make_shared<const instrument::Bur>("test", profile);
        // The turned mesh lies in the bur: its translation is short by its sagitta.
        constexpr int kAround = 128;
        constexpr double kSagittaMm = 0.0005;
        const auto hull = makeHullMethod(block, instrument::turnedMesh(profile, kAround, 0.02));
        const auto method = makeFieldMethod(tooth, bur);
        for (int i = 0; i < 12; ++i) {
            const Vec3 up = (Vec3::UnitZ() + 0.6 * test::randomDirection(generator)).normalized();
            core::Pose pose;
            pose.orientation = core::rotationBetween(Vec3::UnitZ(), up);
            pose.positionMm = {test::uniform(generator, -3, 3), test::uniform(generator, -2.5, 2.5),
                               test::uniform(generator, -0.6, 0.1)};
            const Depth epa = hull->depth(pose);
            if (epa.status != Status::ok) continue;
            EXPECT_LE(method->depth(pose).depthMm, epa.depthMm + 1e-3 + kSagittaMm)
                << static_cast<int>(shape) << " " << i;
        }
    }
}

}  // namespace
}  // namespace handpiece::contact::depth_reference_test
