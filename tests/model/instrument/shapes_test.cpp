// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/inspect.h"
#include "outlines.h"

namespace handpiece::instrument::shapes_test {
namespace {

using handpiece::test::uniform;

TEST(Shapes, HaveTheSizeAskedForOrSayWhatIsPossible) {
    std::mt19937_64 generator(handpiece::test::seed());
    for (const ShapeInfo& info : shapes()) {
        int made = 0, refused = 0;
        for (int i = 0; i < 2000; ++i) {
            const double d = uniform(generator, 0.05, 4.0), length = uniform(generator, 0.05, 14.0);
            try {
                const Profile profile = makeProfile(info.shape, d, length);
                validate(profile);
                ASSERT_NEAR(2.0 * profile.maxRadiusMm(), d, 1e-9) << info.name << " " << d << "x" << length;
                ASSERT_NEAR(profile.lengthMm(), length, 1e-9) << info.name << " " << d << "x" << length;
                ++made;
            } catch (const core::Error& error) {
                ASSERT_FALSE(error.remedy().empty()) << info.name << " " << d << "x" << length << ": " << error.what();
                ++refused;
            }
        }
        EXPECT_GT(made, 10) << info.name;
        EXPECT_GT(refused, 0) << info.name;
        EXPECT_EQ(shapeByName(info.name), info.shape);
    }
    EXPECT_THROW((void)shapeByName("banana"), core::Error);
    EXPECT_THROW((void)makeProfile(Shape::round, std::nan(""), 1.0), core::Error);
    EXPECT_THROW((void)makeProfile(Shape::round, 1.0, std::nan("")), core::Error);
    EXPECT_THROW((void)makeProfile(Shape::round, -1.0, 1.0), core::Error);
    EXPECT_THROW((void)makeProfile(Shape::cylinderRound, 1.0, 1e9), core::Error);
}

TEST(Shapes, ArcsMeetTheirNeighboursSmoothlyWhereTheShapeIsRound) {
    // Only the top edge of these is sharp; on the way to it the outline never turns a corner.
    for (const Shape shape : {Shape::cylinderRound, Shape::taperRound, Shape::pear, Shape::flame, Shape::torpedo}) {
        const Profile profile = makeProfile(shape, 1.0, 4.0);
        for (std::size_t i = 0; i + 2 < profile.pieces.size(); ++i) {
            const core::Vec2 corner = profile.pieces[i].to;
            // Beside a smooth joint the distance to a point off it grows like the square of the step along it.
            const double h = 1e-4;
            const double inward = signedDistanceMm(profile, corner.x() - h, corner.y());
            EXPECT_LT(inward, 0.0);
            double nearest = 1e300;
            for (int k = 0; k < 3600; ++k) {
                const double angle = 2.0 * std::numbers::pi * k / 3600;
                nearest = std::min(nearest, signedDistanceMm(profile, corner.x() + h * std::cos(angle),
                                                             corner.y() + h * std::sin(angle)));
            }
            EXPECT_NEAR(nearest, -h, 1e-3 * h)
                << static_cast<int>(shape) << " piece " << i;  // at a corner: -h sin(angle / 2)
        }
    }
}

TEST(Shapes, TurnedMeshesAreClosedOutwardAndOfPredictableSize) {
    std::mt19937_64 generator(handpiece::test::seed());
    for (const auto& [name, profile] : test::manyOutlines(2, generator)) {
        const int around = 3 + static_cast<int>(generator() % 40);
        const geometry::TriangleMesh mesh = turnedMesh(profile, around, uniform(generator, 0.02, 0.3));
        const geometry::MeshReport report = geometry::inspect(mesh);
        EXPECT_TRUE(report.closed()) << name;
        EXPECT_TRUE(report.oriented()) << name;
        EXPECT_EQ(report.shells, 1u) << name;
        EXPECT_EQ(report.eulerCharacteristic, 2) << name;
        EXPECT_EQ(report.degenerateFaces, 0u) << name;
        EXPECT_EQ((mesh.vertices.size() - 2) % static_cast<std::size_t>(around), 0u) << name;
        EXPECT_EQ(mesh.triangles.size(), 2 * mesh.vertices.size() - 4) << name;
        for (const core::Vec3& v : mesh.vertices)
            ASSERT_NEAR(signedDistanceMm(profile, std::hypot(v.x(), v.y()), v.z()), 0.0, 1e-12) << name;
    }
}

TEST(Shapes, TurnedMeshesApproachTheVolume) {
    for (const ShapeInfo& info : shapes()) {
        const Profile profile =
            makeProfile(info.shape, 1.6, info.shape == Shape::wheel ? 1.0 : 1.6 + (info.shape != Shape::round) * 1.2);
        const double volume = volumeMm3(profile);
        const geometry::TriangleMesh mesh = turnedMesh(profile, 400, 0.005);
        EXPECT_NEAR(geometry::enclosedVolumeMm3(mesh), volume, 2e-4 * volume) << info.name;
    }
    EXPECT_THROW((void)turnedMesh(makeProfile(Shape::round, 1, 1), 2, 0.1), core::Error);
    EXPECT_THROW((void)turnedMesh(makeProfile(Shape::round, 1, 1), 8, 0.0), core::Error);
}

TEST(Shapes, ThePapersBurHas170Vertices) {
    const Bur bur = makeBur("paper");
    EXPECT_EQ(bur.mesh().vertices.size(), 170u);
    EXPECT_EQ(bur.mesh().triangles.size(), 336u);  // the paper's 333 cannot be closed: 2 V - 4
    EXPECT_TRUE(geometry::inspect(bur.mesh()).closed());
    EXPECT_NEAR(bur.maxRadiusMm(), 0.5, 1e-12);
    EXPECT_NEAR(bur.lengthMm(), 4.0, 1e-12);
    EXPECT_NEAR(bur.signedDistance({0, 0, 2}), -0.5, 1e-12);
    EXPECT_NEAR(bur.signedDistance({0, 0, -1}), 1.0, 1e-12);
}

TEST(Shapes, EveryNamedBurIsMade) {
    std::set<std::string> seen;
    for (const std::string& name : burNames()) {
        EXPECT_TRUE(seen.insert(name).second) << name;
        const Bur bur = makeBur(name);
        EXPECT_EQ(bur.name(), name);
        EXPECT_FALSE(bur.medialAxis().empty()) << name;
        EXPECT_FALSE(bur.rings().empty()) << name;
        EXPECT_TRUE(geometry::inspect(bur.mesh()).closed()) << name;
    }
    for (const char* name : {"paper", "round-1/4", "round-8", "245", "330", "331L", "556", "557", "558", "169L", "170",
                             "33.5", "34", "35"})
        EXPECT_EQ(seen.count(name), 1u) << name;
    const Bur sized = makeBur("taper-round:1.6x8.0");
    EXPECT_NEAR(sized.maxRadiusMm(), 0.8, 1e-12);
    EXPECT_NEAR(sized.lengthMm(), 8.0, 1e-12);
}

TEST(Shapes, NamesThatMeanNothingAreRefusedWithAList) {
    for (const char* name : {"", "333", "round", "round:", "round:1", "round:1x", "round:x1", "round:1x1x1",
                             "round:1,0x1", "banana:1x1", "round:nanxnan", "round:1e999x1", "wheel:1x3", ":1x1"}) {
        try {
            (void)makeBur(name);
            ADD_FAILURE() << "'" << name << "' made a bur";
        } catch (const core::Error& error) {
            EXPECT_FALSE(error.remedy().empty()) << name;
        }
    }
}

}  // namespace
}  // namespace handpiece::instrument::shapes_test
