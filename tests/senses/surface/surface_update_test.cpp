// SPDX-License-Identifier: Apache-2.0
/// @file
/// The surface of a tooth while it is cut: kept up as made anew, closed, at every level of detail, each tissue its own.

#include <gtest/gtest.h>

#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/rotation.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/senses/surface/closed_surface.h"
#include "handpiece/senses/surface/surface.h"
#include "handpiece/tick/cutting/sweeper.h"
#include "senses/surface/solids.h"
#include "support/cut_support.h"

namespace handpiece::surface::surface_update_test {
namespace {

using cases::Tissue;
using core::Quat;
using core::Vec3;

/// A ball of dentine in one of enamel, its cutting, and its mirror.
struct Cutting {
    std::shared_ptr<const tooth::ToothModel> base;
    tooth::ToothState field;
    tooth::ToothMirror mirror;

    explicit Cutting(std::shared_ptr<const tooth::ToothModel> tooth) : base(tooth), field(tooth), mirror(tooth) {}
    explicit Cutting(double voxelMm = 0.05) : Cutting(tooth::in_test::ballTooth(1.2, 0.8, voxelMm)) {}

    void cut(const test::Distance& bur) {
        tooth::in_test::cutAway(field, bur);
        field.handOver(field.waitingBricks(), [&](const tooth::BrickSnapshot& snapshot) {
            mirror.apply(snapshot);
            return true;
        });
    }
    void cutAtRandom(std::mt19937_64& random) {
        const Vec3 out = test::randomDirection(random);
        const Quat turn = core::rotationBetween(Vec3::UnitZ(), out);
        const double radius = test::uniform(random, 0.15, 0.4);
        if (test::uniform(random, 0.0, 1.0) < 0.5)
            cut(test::cylinderBur(test::uniform(random, 0.5, 1.1) * out, radius, turn));
        else
            cut(test::sphere(test::uniform(random, 0.9, 1.2) * out, radius));
    }
};

/// All meshes as one, vertices at the same place joined.
geometry::TriangleMesh joined(const Surface& surface) {
    geometry::TriangleMesh mesh;
    std::map<std::array<float, 3>, std::uint32_t> numberOf;
    for (const auto& part : surface.meshes())
        for (const auto& t : part->triangles) {
            geometry::Triangle made;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto& p = part->vertices[t[k]].positionMm;
                const auto [at, isNew] = numberOf.try_emplace(p, static_cast<std::uint32_t>(mesh.vertices.size()));
                if (isNew) mesh.vertices.emplace_back(p[0], p[1], p[2]);
                made[k] = at->second;
            }
            mesh.triangles.push_back(made);
        }
    return mesh;
}

bool isSame(const Surface& a, const Surface& b) {
    const auto left = a.meshes(), right = b.meshes();
    return std::equal(left.begin(), left.end(), right.begin(), right.end(),
                      [](const auto& x, const auto& y) { return *x == *y; });
}

void expectClosed(const geometry::TriangleMesh& mesh) {
    const geometry::MeshReport report = geometry::inspect(mesh);
    EXPECT_TRUE(report.closed()) << report.openEdges << " open, " << report.nonManifoldEdges << " non-manifold";
    EXPECT_TRUE(report.oriented()) << report.flippedFaces << " flipped";
    EXPECT_EQ(report.nonManifoldVertices, 0u);
    EXPECT_EQ(report.unusedVertices, 0u);
}

/// What files are asked for: closed, and no face through another.
void expectSolid(const geometry::TriangleMesh& mesh) {
    expectClosed(mesh);
    const auto crossings = geometry::selfIntersections(mesh);
    EXPECT_TRUE(crossings.empty()) << crossings.size() << " pairs of faces cross";
}

TEST(SurfaceUpdate, GivesTheSameMeshesAsMakingThemAnew) {
    std::mt19937_64 random(test::seed());
    Cutting cutting;
    const MirrorSource source(cutting.mirror);
    Surface kept(source, &cutting.base->tissues);
    kept.build();
    for (int i = 0; i < 12; ++i) {
        cutting.cutAtRandom(random);
        std::map<std::uint32_t, std::shared_ptr<const BrickMesh>> before;
        for (std::uint32_t dense = 0; dense < source.grid().count(); ++dense)
            before[dense] = kept.mesh(dense);
        const std::vector<std::uint32_t> changed = kept.update(cutting.mirror.takeTouched());
        EXPECT_TRUE(std::is_sorted(changed.begin(), changed.end()));
        for (const auto& [dense, mesh] : before) {
            const auto now = kept.mesh(dense);
            const bool same = mesh == nullptr ? now == nullptr : now != nullptr && *now == *mesh;
            EXPECT_NE(same, std::binary_search(changed.begin(), changed.end(), dense)) << dense;
        }
        Surface fresh(source, &cutting.base->tissues);
        fresh.build();
        EXPECT_TRUE(isSame(kept, fresh)) << "cut " << i;
        expectClosed(kept.closedMesh());
        EXPECT_EQ(test::openEdges(joined(kept)), 0u);
        EXPECT_TRUE(kept.update({}).empty());
    }
}

TEST(SurfaceUpdate, GivesTheSameMeshesAfterEveryTickOfARealCut) {
    std::mt19937_64 random(test::seed());
    for (const char* name : {"330", "cylinder-flat:1.0x4.0", "inverted-cone:1.2x1.0"}) {
        Cutting cutting;
        const instrument::Bur bur = instrument::makeBur(name);
        cutting::Sweeper sweeper(cutting.field, bur, core::simdLevel());
        const MirrorSource source(cutting.mirror);
        Surface kept(source, &cutting.base->tissues);
        kept.build();
        core::Pose pose;
        pose.orientation = test::randomRotation(random);
        const Vec3 shank = pose.orientation * Vec3::UnitZ(), aside = shank.unitOrthogonal();
        std::size_t touched = 0, changed = 0;
        for (int tick = 0; tick < 120; ++tick) {
            const double along = 0.007 * tick;
            pose.positionMm = (1.1 - 0.2 * std::sin(3.0 * along)) * shank + (along - 0.4) * aside;
            sweeper.sweepTo(pose);
            cutting.field.handOver(cutting.field.waitingBricks(), [&](const tooth::BrickSnapshot& snapshot) {
                cutting.mirror.apply(snapshot);
                return true;
            });
            const auto bricks = cutting.mirror.takeTouched();
            touched += bricks.size();
            changed += kept.update(bricks).size();
            if (tick % 5 != 0) continue;
            Surface fresh(source, &cutting.base->tissues);
            fresh.build();
            ASSERT_TRUE(isSame(kept, fresh)) << name << " in tick " << tick;
        }
        EXPECT_GT(changed, 100u);
        EXPECT_LT(changed, touched);
    }
}

/// What a ball takes away of what `mirror` holds.
tooth::StateDelta ballCut(const tooth::ToothMirror& mirror, const BrickGrid& grid, const Vec3& at, double radiusMm) {
    tooth::StateDelta cut;
    std::array<float, field::kBrickValues> scratch;
    for (std::uint32_t dense = 0; dense < grid.count(); ++dense) {
        const float* values = mirror.values(dense, scratch.data());
        tooth::StateDelta::Brick brick{dense, false, {}};
        for (int node = 0; node < field::kBrickValues; ++node) {
            const int step[3] = {node % 9, node / 9 % 9, node / 81};
            Vec3 p;
            for (int k = 0; k < 3; ++k)
                p[k] = grid.originMm[k] + grid.voxelMm * (8 * grid.at(dense)[static_cast<std::size_t>(k)] + step[k]);
            const auto i = static_cast<std::size_t>(node);
            brick.values[i] = std::max(values[i], static_cast<float>(radiusMm - (p - at).norm()));
        }
        if (!std::equal(brick.values.begin(), brick.values.end(), values)) cut.bricks.push_back(brick);
    }
    return cut;
}

TEST(SurfaceUpdate, GivesTheSameMeshesThroughUndo) {
    std::mt19937_64 random(test::seed());
    const Cutting cutting(tooth::in_test::ballTooth(0.4, 0.25, 0.05));
    tooth::ToothMirror mirror(cutting.base);
    const MirrorSource source(mirror);
    Surface kept(source, &cutting.base->tissues);
    kept.build();
    std::vector<tooth::StateDelta> states = {mirror.state({})};  // one of every stroke
    Vec3 at = Vec3::UnitZ();
    double radius = 0.2;
    std::size_t changed = 0;
    for (int i = 0; i < 2000; ++i) {
        if (i % 8 == 0) {  // another stroke: from any state before it
            const std::size_t back = random() % states.size();
            mirror.apply(tooth::changeBetween(states.back(), states[back]));
            states.resize(back + 1);
            at = test::uniform(random, 0.3, 0.6) * test::randomDirection(random);
            radius = test::uniform(random, 0.05, 0.25);
        } else {
            at += test::uniform(random, 0.0, 0.02) * test::randomDirection(random);
            mirror.apply(ballCut(mirror, source.grid(), at, radius));
            if (i % 8 == 7) states.push_back(mirror.state({}));
        }
        changed += kept.update(mirror.takeTouched()).size();
        Surface fresh(source, &cutting.base->tissues);
        fresh.build();
        ASSERT_TRUE(isSame(kept, fresh)) << "step " << i;
    }
    EXPECT_GT(changed, 2000u);
}

TEST(SurfaceUpdate, SnapshotsThatArriveOneByOneEndInTheSameSurface) {
    std::mt19937_64 random(test::seed());
    Cutting cutting;
    const MirrorSource source(cutting.mirror);
    Surface kept(source);
    kept.build();
    for (int i = 0; i < 3; ++i) {
        const Vec3 at = 1.1 * test::randomDirection(random);
        tooth::in_test::cutAway(cutting.field, test::sphere(at, 0.35));
        // One brick a picture: neighbours do not agree in between.
        while (cutting.field.waitingBricks() > 0) {
            cutting.field.handOver(1, [&](const tooth::BrickSnapshot& snapshot) {
                cutting.mirror.apply(snapshot);
                return true;
            });
            kept.update(cutting.mirror.takeTouched());
        }
    }
    Surface fresh(source);
    fresh.build();
    EXPECT_TRUE(isSame(kept, fresh));
    expectClosed(kept.closedMesh());
}

TEST(SurfaceUpdate, NoCrackOpensBetweenLevels) {
    std::mt19937_64 random(test::seed());
    Cutting cutting;
    for (int i = 0; i < 6; ++i)
        cutting.cutAtRandom(random);
    const MirrorSource source(cutting.mirror);
    Surface surface(source, &cutting.base->tissues), fine(source, &cutting.base->tissues);
    surface.build();
    fine.build();
    const auto triangles = [](const Surface& s) {
        std::size_t count = 0;
        for (const auto& mesh : s.meshes())
            count += mesh->triangles.size();
        return count;
    };
    const std::size_t full = triangles(surface);
    for (const int level : {1, 2}) {
        for (std::uint32_t dense = 0; dense < source.grid().count(); ++dense)
            surface.setLevel(dense, level);
        surface.update({});
        EXPECT_EQ(test::openEdges(joined(surface)), 0u);
        EXPECT_LT(triangles(surface), full / (level == 1 ? 3 : 10));
        EXPECT_NEAR(geometry::enclosedVolumeMm3(joined(surface)) / geometry::enclosedVolumeMm3(fine.closedMesh()), 1.0,
                    level == 1 ? 0.01 : 0.04);
    }
    for (int i = 0; i < 4; ++i) {
        for (std::uint32_t dense = 0; dense < source.grid().count(); ++dense)
            surface.setLevel(dense, static_cast<int>(random() % 3));
        surface.update({});
        EXPECT_EQ(test::openEdges(joined(surface)), 0u);
        // Cutting goes on among levels, and the whole at full detail does not depend on them.
        cutting.cutAtRandom(random);
        const auto touched = cutting.mirror.takeTouched();
        surface.update(touched);
        fine.update(touched);
        EXPECT_EQ(test::openEdges(joined(surface)), 0u);
        EXPECT_EQ(surface.closedMesh().triangles, fine.closedMesh().triangles);
    }
    for (std::uint32_t dense = 0; dense < source.grid().count(); ++dense)
        surface.setLevel(dense, 0);
    surface.update({});
    EXPECT_TRUE(isSame(surface, fine));
    EXPECT_THROW(surface.setLevel(0, 3), core::Error);
}

TEST(SurfaceUpdate, SameBitsAtAnyThreadCount) {
    std::mt19937_64 random(test::seed());
    Cutting cutting;
    const MirrorSource source(cutting.mirror);
    Surface one(source, &cutting.base->tissues), many(source, &cutting.base->tissues);
    core::setThreadCount(1);
    one.build();
    core::setThreadCount(4);
    many.build();
    EXPECT_TRUE(isSame(one, many));
    for (int i = 0; i < 5; ++i) {
        cutting.cutAtRandom(random);
        const auto touched = cutting.mirror.takeTouched();
        core::setThreadCount(1);
        one.update(touched);
        const auto mesh = one.closedMesh();
        core::setThreadCount(4);
        many.update(touched);
        EXPECT_TRUE(isSame(one, many));
        EXPECT_EQ(many.closedMesh().vertices, mesh.vertices);
        EXPECT_EQ(many.closedMesh().triangles, mesh.triangles);
    }
    core::setThreadCount(0);
}

TEST(SurfaceTissues, MeetInALineOnTheirBoundary) {
    std::mt19937_64 random(test::seed());
    for (int i = 0; i < 4; ++i) {
        // A plane between dentine and enamel, askew to the grid, and a bur that cuts across it.
        const Vec3 normal = test::randomDirection(random);
        const double offset = test::uniform(random, -0.3, 0.3);
        auto tooth = tooth::in_test::toothOf(
            test::sampled(test::sphere(Vec3::Zero(), 1.0), {Vec3::Constant(-1.1), Vec3::Constant(1.1)}));
        const auto plane = [=](const Vec3& p) { return normal.dot(p) - offset; };
        const field::TissueMap::PartFunction dentine{plane, Tissue::dentine, 1};
        auto map = field::TissueMap::fromFunctions(tooth->field, std::span(&dentine, 1), Tissue::enamel);
        Cutting cutting(tooth::withTissues(*tooth, std::move(map)));
        cutting.cut(test::sphere(normal.unitOrthogonal(), 0.5));
        const MirrorSource source(cutting.mirror);
        Surface surface(source, &cutting.base->tissues);
        surface.build();
        EXPECT_EQ(test::openEdges(joined(surface)), 0u);
        std::map<std::array<float, 3>, unsigned> tissuesAt;
        for (const auto& mesh : surface.meshes())
            for (const auto& t : mesh->triangles) {
                const Tissue tissue = mesh->vertices[t[0]].tissue;
                for (const auto corner : t) {
                    const SurfaceVertex& v = mesh->vertices[corner];
                    EXPECT_EQ(v.tissue, tissue);
                    const double side = plane({v.positionMm[0], v.positionMm[1], v.positionMm[2]});
                    EXPECT_LT(tissue == Tissue::dentine ? side : -side, 0.005);
                    tissuesAt[v.positionMm] |= 1u << static_cast<unsigned>(tissue);
                }
            }
        std::size_t onBoundary = 0;
        for (const auto& [p, tissues] : tissuesAt) {
            if ((tissues & (tissues - 1)) == 0) continue;
            ++onBoundary;
            EXPECT_LT(std::abs(plane({p[0], p[1], p[2]})), 0.005);
        }
        EXPECT_GT(onBoundary, 100u);
        // Each tissue's own triangles end there and nowhere else.
        const double whole = geometry::surfaceAreaMm2(surface.closedMesh());
        EXPECT_NEAR(geometry::surfaceAreaMm2(surface.tissueMesh(Tissue::dentine)) +
                        geometry::surfaceAreaMm2(surface.tissueMesh(Tissue::enamel)),
                    whole, 1e-4 * whole);
    }
}

TEST(ClosedSurface, WholeAndPartsHoldWhatTheFieldHolds) {
    std::mt19937_64 random(test::seed());
    Cutting cutting(tooth::in_test::ballTooth(1.2, 0.83, 0.05));
    const MirrorSource source(cutting.mirror);
    const auto ball = [](double r) { return 4.0 / 3.0 * std::numbers::pi * r * r * r; };
    const geometry::TriangleMesh dentine = closedPart(source, cutting.base->tissues, Tissue::dentine),
                                 enamel = closedPart(source, cutting.base->tissues, Tissue::enamel);
    expectSolid(dentine);
    expectSolid(enamel);
    EXPECT_NEAR(geometry::enclosedVolumeMm3(dentine) / ball(0.83), 1.0, 3e-3);
    EXPECT_NEAR(geometry::enclosedVolumeMm3(enamel) / (ball(1.2) - ball(0.83)), 1.0, 3e-3);
    EXPECT_TRUE(closedPart(source, cutting.base->tissues, Tissue::pulp).triangles.empty());
    std::size_t mended = 0;
    for (int i = 0; i < 6; ++i) {
        cutting.cutAtRandom(random);
        const geometry::TriangleMesh whole = closedSurface(source);
        Surface shown(source);
        shown.build();
        mended += geometry::selfIntersections(shown.closedMesh()).size();
        expectSolid(whole);
        const tooth::TissueVolumes left = cutting.field.volumesMm3();
        const auto fieldMm3 = [&](Tissue tissue) { return left[static_cast<std::size_t>(tissue)]; };
        const double all = fieldMm3(Tissue::dentine) + fieldMm3(Tissue::enamel);
        EXPECT_NEAR(geometry::enclosedVolumeMm3(whole) / all, 1.0, 3e-3);
        double sum = 0.0;
        for (const Tissue tissue : {Tissue::dentine, Tissue::enamel}) {
            const geometry::TriangleMesh part = closedPart(source, cutting.base->tissues, tissue);
            expectSolid(part);
            sum += geometry::enclosedVolumeMm3(part);
        }
        EXPECT_NEAR(sum / geometry::enclosedVolumeMm3(whole), 1.0, 3e-3);
    }
    EXPECT_GT(mended, 0u);  // else nothing was asked
    EXPECT_THROW((void)closedSurface(source, [](double share) { return share < 0.5; }), core::Error);
}

}  // namespace
}  // namespace handpiece::surface::surface_update_test
