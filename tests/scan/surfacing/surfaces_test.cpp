// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/surfacing/surfaces.h"

#include <gtest/gtest.h>

#include <cstring>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "scan/surfacing/regions.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::surfacing::surfaces_test {
namespace {

using cases::Tissue;
using core::Vec3;
using geometry::TriangleMesh;
using segmentation::Region;
using test::ball;
using test::ballMm3;
using test::BallTooth;
using test::Shape;
using test::tissueOf;

void expectSolid(const TriangleMesh& mesh, std::size_t shells = 1, std::int64_t genus = 0) {
    const geometry::MeshReport report = geometry::inspect(mesh);
    EXPECT_TRUE(report.closed());
    EXPECT_TRUE(report.oriented());
    EXPECT_GT(report.volumeMm3, 0.0);
    EXPECT_EQ(report.nonManifoldVertices, 0u);
    EXPECT_EQ(report.degenerateFaces, 0u);
    EXPECT_EQ(report.unusedVertices, 0u);
    EXPECT_EQ(report.shells, shells);
    EXPECT_EQ(report.genus, genus);
    EXPECT_TRUE(geometry::selfIntersections(mesh).empty());
}

double worstMm(const TriangleMesh& mesh, const Shape& truth) {
    double worst = 0.0;
    for (const Vec3& p : mesh.vertices)
        worst = std::max(worst, std::abs(truth(p)));
    return worst;
}

Region alone(const volume::Grid& grid, const Shape& shape, bool isBinary = false) {
    Region region;
    region.grid = grid;
    region.outer = test::solidOf(grid, Tissue::none, shape, isBinary);
    return region;
}

TEST(MakeSurfaces, BallKeepsItsVolumeAtAnyVoxel) {
    for (const double voxelMm : {0.05, 0.1, 0.2})
        for (const double radiusMm : {0.8, 1.9}) {
            const Shape truth = ball(Vec3(2.03, 2.01, 2.04), radiusMm);
            const Surfaces made = makeSurfaces(alone(test::cubeGrid(4.1, voxelMm), truth));
            expectSolid(made.outer.mesh);
            EXPECT_NEAR(geometry::enclosedVolumeMm3(made.outer.mesh) / ballMm3(radiusMm), 1.0, 0.001)
                << voxelMm << " " << radiusMm;
            EXPECT_LT(worstMm(made.outer.mesh, truth), 0.15 * voxelMm);
        }
}

TEST(MakeSurfaces, LiesInTheScannersFrame) {
    Region region = alone(test::cubeGrid(4.0, 0.1), ball(Vec3(2.0, 2.1, 1.8), 1.5));
    const core::Quat turn(0.8, 0.1, -0.5, 0.3);
    region.grid.axes = turn.normalized().toRotationMatrix();
    region.grid.originMm = Vec3(-30, 12, 700);
    const TriangleMesh mesh = makeSurfaces(region).outer.mesh;
    expectSolid(mesh);
    const Vec3 centre = region.grid.originMm + region.grid.axes * Vec3(2.0, 2.1, 1.8);
    EXPECT_LT(worstMm(mesh, ball(centre, 1.5)), 0.015);
}

TEST(MakeSurfaces, StaircaseOfVoxelsBecomesSmooth) {
    const double h = 0.1;
    const Shape truth = ball(Vec3(2.03, 2.01, 2.04), 1.6);
    const Region region = alone(test::cubeGrid(4.0, h), truth, true);
    const TriangleMesh rough = makeSurfaces(region, {false}).outer.mesh;
    const TriangleMesh smooth = makeSurfaces(region).outer.mesh;
    expectSolid(smooth);
    EXPECT_NEAR(geometry::enclosedVolumeMm3(smooth) / geometry::enclosedVolumeMm3(rough), 1.0, 0.002);
    EXPECT_LT(worstMm(smooth, truth), 0.75 * h);
    // Angles between the ball's normal and the faces': large all over the staircase.
    const auto meanTurn = [](const TriangleMesh& mesh) {
        double sum = 0.0, area = 0.0;
        for (const geometry::Triangle& t : mesh.triangles) {
            const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
            const Vec3 n = (b - a).cross(c - a);
            const Vec3 out = ((a + b + c) / 3.0 - Vec3(2.03, 2.01, 2.04)).normalized();
            sum += std::acos(std::clamp(n.normalized().dot(out), -1.0, 1.0)) * n.norm();
            area += n.norm();
        }
        return sum / area;
    };
    EXPECT_GT(meanTurn(rough), 0.25);
    EXPECT_LT(meanTurn(smooth), 0.4 * meanTurn(rough));
}

TEST(MakeSurfaces, TissuesOfATooth) {
    const BallTooth truth;
    const double h = 0.08;
    const Surfaces made = makeSurfaces(truth.region(h));
    ASSERT_EQ(made.tissues.size(), 3u);
    EXPECT_EQ(made.tissues[0].tissue, Tissue::dentine);
    EXPECT_EQ(made.tissues[1].tissue, Tissue::pulp);
    EXPECT_EQ(made.tissues[2].tissue, Tissue::caries);
    EXPECT_TRUE(made.notes.empty());
    expectSolid(made.outer.mesh);
    for (const Surface& tissue : made.tissues)
        expectSolid(tissue.mesh);
    EXPECT_NEAR(geometry::enclosedVolumeMm3(made.outer.mesh), ballMm3(truth.radiusMm), 1e-3 * ballMm3(truth.radiusMm));
    EXPECT_NEAR(geometry::enclosedVolumeMm3(made.tissues[1].mesh), ballMm3(truth.pulpMm), 1e-3 * ballMm3(truth.pulpMm));
    // Under the enamel the dentine is where it is; at the root it stands out of the tooth, never along it.
    const Shape outer = truth.outer(), dentine = truth.dentine();
    const double out = made.standOutMm;
    EXPECT_GT(out, 0.0);
    EXPECT_LT(out, 0.05);
    for (const Vec3& p : made.tissues[0].mesh.vertices) {
        const double depth = -outer(p);
        if (depth > 3.0 * out) {
            EXPECT_NEAR(dentine(p), 0.0, 0.2 * h);
        } else if (p.z() < truth.middle.z() - truth.enamelMm) {
            EXPECT_NEAR(depth, -out, 0.4 * out);
        }
    }
}

/// Least distance between two surfaces: every edge of one against every face of the other, and points in faces, apart
/// from any tree.
double leastDistanceMm(const TriangleMesh& a, const TriangleMesh& b, double nearMm) {
    const auto toTriangle = [](const Vec3& p, const Vec3& u, const Vec3& v, const Vec3& w) {
        const Vec3 n = (v - u).cross(w - u).normalized();
        if (n.dot((v - u).cross(p - u)) >= 0 && n.dot((w - v).cross(p - v)) >= 0 && n.dot((u - w).cross(p - w)) >= 0)
            return std::abs(n.dot(p - u));
        const auto toSegment = [&](const Vec3& s, const Vec3& e) {
            const double t = std::clamp((p - s).dot(e - s) / (e - s).squaredNorm(), 0.0, 1.0);
            return (p - s - t * (e - s)).norm();
        };
        return std::min({toSegment(u, v), toSegment(v, w), toSegment(w, u)});
    };
    const auto samples = [](const TriangleMesh& mesh) {
        std::vector<Vec3> points = mesh.vertices;
        for (const geometry::Triangle& t : mesh.triangles) {
            const Vec3 &u = mesh.vertices[t[0]], &v = mesh.vertices[t[1]], &w = mesh.vertices[t[2]];
            for (const Vec3& p : {Vec3((u + v) / 2), Vec3((v + w) / 2), Vec3((w + u) / 2), Vec3((u + v + w) / 3)})
                points.push_back(p);
        }
        return points;
    };
    double least = INFINITY;
    const auto oneWay = [&](const TriangleMesh& from, const TriangleMesh& to) {
        for (const Vec3& p : samples(from))
            for (const geometry::Triangle& t : to.triangles)
                if ((to.vertices[t[0]] - p).squaredNorm() < nearMm * nearMm)
                    least = std::min(least, toTriangle(p, to.vertices[t[0]], to.vertices[t[1]], to.vertices[t[2]]));
    };
    oneWay(a, b);
    oneWay(b, a);
    return least;
}

TEST(MakeSurfaces, PulpThatTouchesTheOutsideIsHeldInside) {
    // The pulp reaches the dentine's outside (an apex) and even beyond.
    Region region;
    region.grid = test::cubeGrid(3.0, 0.1);
    const Shape outer = ball(Vec3(1.5, 1.5, 1.5), 1.2);
    region.outer = test::solidOf(region.grid, Tissue::none, outer);
    region.solids.push_back(test::solidOf(region.grid, Tissue::dentine, outer));
    region.solids.push_back(test::solidOf(region.grid, Tissue::pulp, [](const Vec3& p) {
        return (Vec3(p.x() - 1.5, p.y() - 1.5, std::max(0.0, p.z() - 1.5))).norm() - 0.3;
    }));
    const Surfaces made = makeSurfaces(region);
    const TriangleMesh& pulp = made.tissues.at(1).mesh;
    expectSolid(pulp);
    for (const TriangleMesh* around : {&made.outer.mesh, &made.tissues[0].mesh}) {
        EXPECT_GE(leastDistanceMm(pulp, *around, 0.4), made.leastGapMm);
        TriangleMesh both = *around;
        const auto offset = static_cast<std::uint32_t>(both.vertices.size());
        both.vertices.insert(both.vertices.end(), pulp.vertices.begin(), pulp.vertices.end());
        for (const geometry::Triangle& t : pulp.triangles)
            both.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
        EXPECT_TRUE(geometry::selfIntersections(both).empty());
    }
    for (const Vec3& p : pulp.vertices)
        EXPECT_LT(outer(p), 0.0);
}

TEST(MakeSurfaces, SpecksGoAndLesionsStay) {
    Region region;
    region.grid = test::cubeGrid(5.0, 0.1);
    const auto either = [](const Shape& a, const Shape& b) {
        return [=](const Vec3& p) { return std::min(a(p), b(p)); };
    };
    const Shape tooth = ball(Vec3(2.5, 2.5, 2.2), 2.0);
    region.outer = test::solidOf(region.grid, Tissue::none, either(tooth, ball(Vec3(2.5, 2.5, 4.7), 0.2)));
    region.solids.push_back(test::solidOf(region.grid, Tissue::dentine, ball(Vec3(2.5, 2.5, 2.2), 1.5)));
    region.solids.push_back(test::solidOf(region.grid, Tissue::pulp, ball(Vec3(2.52, 2.51, 2.23), 0.12)));
    region.solids.push_back(test::solidOf(region.grid, Tissue::caries,
                                          either(either(ball(Vec3(2.0, 2.5, 3.4), 0.4), ball(Vec3(3.2, 2.5, 3.4), 0.3)),
                                                 ball(Vec3(2.6, 1.6, 3.4), 0.12))));
    const Surfaces made = makeSurfaces(region);
    expectSolid(made.outer.mesh);
    EXPECT_NEAR(geometry::enclosedVolumeMm3(made.outer.mesh), ballMm3(2.0), 1e-3 * ballMm3(2.0));
    ASSERT_EQ(made.tissues.size(), 2u);
    EXPECT_EQ(made.tissues[1].tissue, Tissue::caries);
    expectSolid(made.tissues[1].mesh, 2);
    ASSERT_EQ(made.notes.size(), 3u);
    EXPECT_EQ(made.notes[0], "the tooth: 1 loose speck left out");
    EXPECT_EQ(made.notes[1], "pulp is left out: nothing of it is as large as 20 voxels");
    EXPECT_EQ(made.notes[2], "caries: 1 loose speck left out");
}

TEST(MakeSurfaces, NoiseIsNoTunnels) {
    // A lesion whose voxels flicker: a sponge of tunnels by the voxels, one body for a bur.
    std::mt19937_64 generator(test::seed());
    Region region;
    const double h = 0.1;
    region.grid = test::cubeGrid(4.0, h);
    region.outer = test::solidOf(region.grid, Tissue::none, ball(Vec3(2, 2, 2), 1.7));
    const Shape lesion = ball(Vec3(2, 2, 2), 1.0);
    std::size_t voxels = 0;
    region.solids.push_back(test::solidOf(
        region.grid, Tissue::caries,
        [&](const Vec3& p) {
            const bool in = lesion(p) < 0.0 && test::uniform(generator, 0.0, 1.0) < 0.85;
            voxels += in;
            return in ? -1.0 : 1.0;
        },
        true));
    const geometry::MeshReport rough = geometry::inspect(makeSurfaces(region, {false}).tissues.at(0).mesh);
    ASSERT_GT(rough.genus.value_or(0), 20);
    const Surfaces made = makeSurfaces(region);
    const geometry::MeshReport report = geometry::inspect(made.tissues.at(0).mesh);
    EXPECT_TRUE(report.closed());
    EXPECT_LE(report.genus.value_or(99), 6);
    // Hollows of a voxel are filled: between what was marked and the whole ball.
    EXPECT_GT(report.volumeMm3, 0.98 * static_cast<double>(voxels) * h * h * h);
    EXPECT_LT(report.volumeMm3, 1.01 * ballMm3(1.0));
    ASSERT_FALSE(made.notes.empty());
    EXPECT_NE(made.notes.back().find("tunnels of about a voxel closed"), std::string::npos);
}

TEST(MakeSurfaces, SameBytesAtAnyThreadCount) {
    const Region region = BallTooth{}.region(0.12);
    const auto bytes = [&](std::size_t threads) {
        core::setThreadCount(threads);
        const Surfaces made = makeSurfaces(region);
        const Surfaces few = decimated(made, 12);
        core::setThreadCount(0);
        std::string all;
        const auto add = [&](const Surface& s) {
            all.append(reinterpret_cast<const char*>(s.mesh.vertices.data()), s.mesh.vertices.size() * sizeof(Vec3));
            all.append(reinterpret_cast<const char*>(s.mesh.triangles.data()),
                       s.mesh.triangles.size() * sizeof(geometry::Triangle));
        };
        for (const Surfaces* s : {&made, &few}) {
            add(s->outer);
            for (const Surface& tissue : s->tissues)
                add(tissue);
        }
        return all;
    };
    const std::string one = bytes(1);
    EXPECT_TRUE(one == bytes(2));
    EXPECT_TRUE(one == bytes(3));
}

TEST(MakeSurfaces, RandomRegionsGiveSolids) {
    std::mt19937_64 generator(test::seed());
    for (int round = 0; round < 12; ++round) {
        SCOPED_TRACE(round);
        // Smooth noise: a sum of waves, whatever shape and genus that has, with noise of a tenth of a voxel.
        const double h = test::uniform(generator, 0.05, 0.2);
        volume::Grid grid = test::cubeGrid(26 * h, h);
        struct Wave {
            Vec3 k;
            double phase;
        };
        std::vector<Wave> waves;
        for (int w = 0; w < 6; ++w)
            waves.push_back({test::randomDirection(generator) * (2.0 * M_PI / (test::uniform(generator, 6, 16) * h)),
                             test::uniform(generator, 0, 6)});
        const Vec3 middle = Vec3::Constant(13 * h);
        const Shape shape = [&](const Vec3& p) {
            double sum = (p - middle).norm() / h - 8.0;
            for (const Wave& w : waves)
                sum += std::sin(w.k.dot(p) + w.phase);
            return h * (sum + test::uniform(generator, -0.1, 0.1));
        };
        Region region = alone(grid, shape);
        // Dentine inside it by a changing thickness that may be nothing; pulp anywhere.
        Region whole = region;
        segmentation::Solid dentine = region.outer;
        dentine.tissue = Tissue::dentine;
        const double lean = test::uniform(generator, -1, 1);
        for (std::size_t i = 0; i < dentine.distanceMm.size(); ++i) {
            const double z = static_cast<double>(i / static_cast<std::size_t>(grid.size[0] * grid.size[1])) - 13.0;
            dentine.distanceMm[i] += static_cast<float>(h * std::clamp(lean + 0.2 * z, 0.0, 2.0));
        }
        region.solids.push_back(dentine);
        const Vec3 at = middle + 3.0 * h * test::randomDirection(generator);
        region.solids.push_back(test::solidOf(grid, Tissue::pulp, ball(at, 4.0 * h)));
        const Surfaces made = makeSurfaces(region);
        const auto check = [](const TriangleMesh& mesh) {
            const geometry::MeshReport report = geometry::inspect(mesh);
            EXPECT_TRUE(report.closed());
            EXPECT_TRUE(report.oriented());
            EXPECT_EQ(report.nonManifoldVertices, 0u);
            EXPECT_TRUE(geometry::selfIntersections(mesh).empty());
        };
        check(made.outer.mesh);
        for (const Surface& tissue : made.tissues)
            check(tissue.mesh);
        const double marched = geometry::enclosedVolumeMm3(makeSurfaces(whole, {false}).outer.mesh);
        EXPECT_NEAR(geometry::enclosedVolumeMm3(made.outer.mesh) / marched, 1.0, 0.02);
    }
}

TEST(MakeSurfaces, SaysWhatIsWrong) {
    Region region = alone(test::cubeGrid(2.0, 0.2), ball(Vec3(1, 1, 1), 0.6));
    Region empty = region;
    std::fill(empty.outer.distanceMm.begin(), empty.outer.distanceMm.end(), 0.5f);
    EXPECT_NE(test::errorOf([&] { (void)makeSurfaces(empty); }).find("there is no tooth"), std::string::npos);
    Region few = region;
    few.outer.distanceMm.pop_back();
    EXPECT_NE(test::errorOf([&] { (void)makeSurfaces(few); }).find("do not fill a grid of 11 x 11 x 11"),
              std::string::npos);
    Region flat = region;
    flat.grid.spacingMm.z() = 0.4;
    EXPECT_NE(test::errorOf([&] { (void)makeSurfaces(flat); }).find("not cubes"), std::string::npos);
    Region broken = region;
    broken.outer.distanceMm[7] = NAN;
    EXPECT_NE(test::errorOf([&] { (void)makeSurfaces(broken); }).find("the 8th"), std::string::npos);
    EXPECT_NE(
        test::errorOf([&] { (void)makeSurfaces(region, {}, [](double f) { return f < 0.3; }); }).find("cancelled"),
        std::string::npos);
}

}  // namespace
}  // namespace handpiece::surfacing::surfaces_test
