// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/turbine.h"

#include <gtest/gtest.h>

#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/instrument/shapes.h"
#include "support/random.h"

namespace handpiece::instrument::turbine_test {
namespace {

TEST(Turbine, HasTheComplexityOfTheTable) {
    const geometry::TriangleMesh mesh = turbineMesh();
    EXPECT_NEAR(static_cast<double>(mesh.vertices.size()), 11458.0, 114.0);
    EXPECT_NEAR(static_cast<double>(mesh.triangles.size()), 20988.0, 209.0);
    std::printf("turbine: %zu vertices, %zu faces\n", mesh.vertices.size(), mesh.triangles.size());
}

TEST(Turbine, IsMadeOfClosedPartsThatFaceOutwards) {
    const geometry::TriangleMesh mesh = turbineMesh();
    const geometry::MeshReport report = geometry::inspect(mesh);
    EXPECT_TRUE(report.closed());
    EXPECT_TRUE(report.oriented());
    EXPECT_EQ(report.duplicateVertices, 0u);
    EXPECT_EQ(report.degenerateFaces, 0u);
    EXPECT_EQ(report.eulerCharacteristic, 2 * static_cast<std::int64_t>(report.shells));
    // Each part on its own encloses a positive volume: vertices of a part are consecutive, so parts are runs of
    // triangles.
    std::size_t parts = 0;
    for (std::size_t first = 0; first < mesh.triangles.size();) {
        std::uint32_t last = 0;
        for (const std::uint32_t v : mesh.triangles[first])
            last = std::max(last, v);
        std::uint32_t lowest = last;
        geometry::TriangleMesh part;
        part.vertices = mesh.vertices;
        std::size_t end = first;
        // A part ends where the next triangle uses only vertices beyond all seen so far.
        while (end < mesh.triangles.size()) {
            const geometry::Triangle& t = mesh.triangles[end];
            if (end > first && std::min({t[0], t[1], t[2]}) > last) break;
            for (const std::uint32_t v : t) {
                last = std::max(last, v);
                lowest = std::min(lowest, v);
            }
            part.triangles.push_back(t);
            ++end;
        }
        EXPECT_GT(geometry::enclosedVolumeMm3(part), 0.0) << "part " << parts;
        ++parts;
        first = end;
    }
    EXPECT_EQ(parts, report.shells);
}

TEST(Turbine, ItsConvexPiecesCoverWhatIsDrawn) {
    const Bur bur = makeBur("330");
    const std::vector<BodyPiece> pieces = bodyPieces(bur);
    const auto distance = [&](const core::Vec3& p) {
        double nearest = 1e9;
        for (const BodyPiece& piece : pieces)
            nearest = std::min(nearest, piece.solid->signedDistance(piece.inBur.applyInverse(p)));
        return nearest;
    };
    const geometry::TriangleMesh mesh = turbineMesh();
    double out = -1e9;
    for (const core::Vec3& v : mesh.vertices) {
        const double along = core::Vec2(v.x(), v.z() - kBurReachMm).norm();
        const bool isLight = core::Vec2(v.x() - 4.6, v.y()).norm() < 0.95 && v.z() < kBurReachMm + 3.7;
        if (along > 40.0 || v.z() < kBurReachMm || isLight)
            continue;  // before the grip's points; without collar, ports
        out = std::max(out, distance(v));
    }
    std::printf("  drawn vertices lie %.3f mm outside the pieces at most\n", out);
    EXPECT_LE(out, kBodyToleranceMm);
    for (const BodyPiece& piece : pieces) {
        EXPECT_TRUE(piece.inBur.isValid());
        // Convex: the middle of any two inside points is inside.
        std::mt19937_64 g(handpiece::test::seed());
        const auto anywhereIn = [&] {
            for (;;) {
                const double r = piece.solid->maxRadiusMm();
                const core::Vec3 p(handpiece::test::uniform(g, -r, r), handpiece::test::uniform(g, -r, r),
                                   handpiece::test::uniform(g, 0.0, piece.solid->lengthMm()));
                if (piece.solid->signedDistance(p) <= 0.0) return p;
            }
        };
        for (int i = 0; i < 300; ++i)
            EXPECT_LE(piece.solid->signedDistance(0.5 * (anywhereIn() + anywhereIn())), 1e-9);
    }
    EXPECT_EQ(pieces.front().part, BodyPart::shank);
    EXPECT_NEAR(pieces.front().inBur.positionMm.z(), bur.lengthMm(), 1e-12);
    // A bur that reaches into the head has no shank to touch with.
    EXPECT_NE(bodyPieces(makeBur("cylinder-round:1.0x12.0")).front().part, BodyPart::shank);
    EXPECT_THROW((void)bodyPieces(bur, std::nan("")), core::Error);
}

TEST(Turbine, KeepsItsCountsThroughAnStl) {
    const handpiece::test::TemporaryFolder folder;
    const geometry::TriangleMesh mesh = turbineMesh();
    geometry::writeStl(folder.path() / "turbine.stl", mesh);
    const geometry::TriangleMesh read = geometry::readMesh(folder.path() / "turbine.stl");
    EXPECT_EQ(read.vertices.size(), mesh.vertices.size());
    EXPECT_EQ(read.triangles.size(), mesh.triangles.size());
}

TEST(Turbine, HoldsTheBur) {
    const geometry::TriangleMesh mesh = turbineMesh();
    const core::Box box = mesh.bounds();
    // Nothing of it below the end of the chuck, the head round the axis, the handle along +x and rising.
    EXPECT_GT(box.min.z(), kBurReachMm - 1.5);
    EXPECT_LT(box.min.x(), -4.0);
    EXPECT_GT(box.max.x(), 80.0);
    EXPECT_GT(box.max.z(), 30.0);
    EXPECT_NEAR(box.min.y(), -box.max.y(), 0.05);
    const core::Box longer = turbineMesh(12.0).bounds();
    EXPECT_NEAR(longer.min.z() - box.min.z(), 12.0 - kBurReachMm, 1e-9);
    EXPECT_THROW((void)turbineMesh(std::nan("")), core::Error);
}

}  // namespace
}  // namespace handpiece::instrument::turbine_test
