// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/exact/exact_kernels.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "handpiece/base/core/simd.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/tick/contact/exact/exact_depth.h"
#include "handpiece/tick/contact/exact/outline_search.h"
#include "handpiece/tick/contact/sampled/field_row.h"
#include "tick/contact/contact_fixture.h"

namespace handpiece::contact {
namespace {

using core::Vec3;

const tooth::Tooth& grooved() {
    static const auto tooth = test::toothOf(test::groovedBall(24));
    return *tooth;
}
TreeView viewOf(const geometry::TriangleTree& tree) {
    return {reinterpret_cast<const KernelNode*>(tree.nodes().data()),
            reinterpret_cast<const KernelTriangle*>(tree.triangles().data()),
            static_cast<std::uint32_t>(tree.triangles().size())};
}
std::vector<ExactKernels> allExact() {
    std::vector<ExactKernels> all{simd_base::exactKernels()};
#if defined(__x86_64__)
    if (core::simdLevel() >= core::SimdLevel::avx2) all.push_back(simd_avx2::exactKernels());
    if (core::simdLevel() >= core::SimdLevel::avx512) all.push_back(simd_avx512::exactKernels());
#endif
    return all;
}
std::vector<core::SimdLevel> levels() {
    std::vector<core::SimdLevel> all;
    for (const core::SimdLevel level : {core::SimdLevel::base, core::SimdLevel::avx2, core::SimdLevel::avx512})
        if (level <= core::simdLevel()) all.push_back(level);
    return all;
}
Vec3 anywhere(std::mt19937_64& g) {
    return Vec3(test::uniform(g, -5, 5), test::uniform(g, -5, 5), test::uniform(g, -5, 5));
}

TEST(ExactKernels, nearestPointIsThatOfTheTree) {
    std::mt19937_64 g(test::seed());
    const TreeView view = viewOf(grooved().tree);
    for (int i = 0; i < 3000; ++i) {
        const Vec3 p = anywhere(g);
        SurfaceHit hit;
        hit.value = std::numeric_limits<double>::infinity();
        hit.triangle = i % 2 == 0 ? SurfaceHit::kNone : static_cast<std::uint32_t>(g() % view.triangleCount);
        simd_base::exactKernels().nearestToPoint(view, p.data(), hit);
        EXPECT_NEAR(hit.value, grooved().tree.nearest(p).distanceMm, 1e-12);
    }
}

TEST(ExactKernels, aRunOfBallsAgreesWithManyPoints) {
    std::mt19937_64 g(test::seed());
    const TreeView view = viewOf(grooved().tree);
    // A radius that is concave along the run: one piece, and several.
    const std::vector<std::vector<double>> zs{{0.3, 2.1}, {0.2, 0.5, 1.1, 1.9, 2.6}},
        rs{{0.3, 0.5}, {0.2, 0.38, 0.55, 0.6, 0.4}};
    for (std::size_t k = 0; k < zs.size(); ++k) {
        std::vector<double> slope;
        for (std::size_t i = 0; i + 1 < zs[k].size(); ++i)
            slope.push_back((rs[k][i + 1] - rs[k][i]) / (zs[k][i + 1] - zs[k][i]));
        AxisRun run;
        run.z = zs[k].data();
        run.radius = rs[k].data();
        run.slope = slope.data();
        run.count = static_cast<std::int32_t>(zs[k].size());
        run.maxRadius = 0.6f;
        for (int i = 0; i < 300; ++i) {
            const Vec3 tip = anywhere(g), axis = test::randomDirection(g);
            SurfaceHit hit;
            hit.value = std::numeric_limits<double>::infinity();
            simd_base::exactKernels().nearestToRun(view, run, tip.data(), axis.data(), hit);
            double sampled = std::numeric_limits<double>::infinity();
            for (std::size_t piece = 0; piece < slope.size(); ++piece)
                for (int s = 0; s <= 400; ++s) {
                    const double dz = (zs[k][piece + 1] - zs[k][piece]) * s / 400.0;
                    const double d = grooved().tree.nearest(tip + (zs[k][piece] + dz) * axis, 3.0).distanceMm;
                    sampled = std::min(sampled, d - rs[k][piece] - slope[piece] * dz);
                }
            if (sampled > 2.0) continue;
            EXPECT_LE(hit.value, sampled + 1e-9);
            EXPECT_GE(hit.value, sampled - 2.0 * 2.0 / 400.0);
            const Vec3 c = tip + hit.z * axis, q(hit.point[0], hit.point[1], hit.point[2]);
            EXPECT_NEAR(grooved().tree.nearest(q).distanceMm, 0.0, 1e-9);
            EXPECT_GE((c - q).norm() + 1e-9, grooved().tree.nearest(c).distanceMm);
        }
    }
}

TEST(ExactKernels, everyInstructionSetGivesTheSameBits) {
    const std::vector<ExactKernels> all = allExact();
    if (all.size() == 1) GTEST_SKIP() << "this processor has one level only";
    std::mt19937_64 g(test::seed());
    const TreeView view = viewOf(grooved().tree);
    const double z[3] = {0.3, 0.8, 2.0}, radius[3] = {0.3, 0.5, 0.5}, slope[2] = {0.4, 0.0};
    AxisRun varying;
    varying.z = z;
    varying.radius = radius;
    varying.slope = slope;
    varying.count = 3;
    varying.maxRadius = 0.5f;
    for (int i = 0; i < 1000; ++i) {
        const Vec3 tip = anywhere(g), axis = test::randomDirection(g);
        for (const int kind : {0, 1, 2}) {  // a point, a run of any radius, a run of one radius
            const bool point = kind == 0;
            AxisRun run = varying;
            if (kind == 2)
                run.count = 2, run.z = z + 1, run.radius = radius + 1, run.slope = slope + 1, run.constant = true;
            SurfaceHit first;
            for (std::size_t level = 0; level < all.size(); ++level) {
                SurfaceHit hit;
                hit.value = std::numeric_limits<double>::infinity();
                if (point)
                    all[level].nearestToPoint(view, tip.data(), hit);
                else
                    all[level].nearestToRun(view, run, tip.data(), axis.data(), hit);
                if (level == 0) first = hit;
                EXPECT_EQ(std::memcmp(&hit.value, &first.value, 8), 0);
                EXPECT_EQ(std::memcmp(hit.point, first.point, 24), 0);
                EXPECT_EQ(hit.triangle, first.triangle);
            }
        }
    }
}

TEST(OutlineKernels, everyInstructionSetGivesTheSameBits) {
    std::vector<OutlineSearch> all;
    const instrument::Bur bur = instrument::makeBur("inverted-cone:1.2x1.2");
    for (const core::SimdLevel level : levels())
        all.emplace_back(bur, level);
    ASSERT_TRUE(all.front().isFit());
    if (all.size() == 1) GTEST_SKIP() << "this processor has one level only";
    const ExactSurface surface(grooved().tree, grooved().field, core::SimdLevel::base);
    std::mt19937_64 g(test::seed());
    int apart = 0;
    for (int i = 0; i < 1000; ++i) {
        const core::Pose pose{anywhere(g), test::randomRotation(g)};
        BallDepth first;
        for (std::size_t level = 0; level < all.size(); ++level) {
            BallDepth found;
            const bool isApart = all[level].search(surface, BurFrame(pose), found);
            if (level == 0) first = found;
            apart += isApart;
            EXPECT_EQ(found.depthMm, first.depthMm);
            EXPECT_EQ(found.surfaceMm, first.surfaceMm);
            EXPECT_EQ(found.centreMm, first.centreMm);
        }
    }
    EXPECT_GT(apart, 300);
}

TEST(OutlineKernels, fitBursWithSharpRimsThatAreConvex) {
    for (const char* name : {"cylinder-flat:1.0x4.0", "wheel:2.0x0.8", "inverted-cone:1.2x1.2", "taper-flat:1.2x4.0"})
        EXPECT_TRUE(OutlineSearch(instrument::makeBur(name), core::simdLevel()).isFit()) << name;
    // Nothing to spare where the medial axis is the bur's own axis.
    EXPECT_FALSE(OutlineSearch(instrument::makeBur("cylinder-round:1.0x4.0"), core::simdLevel()).isFit());
}

TEST(FieldRow, lookupsAreThoseOfTheFieldAtEveryLevel) {
    std::vector<FieldLookup> all{simd_base::fieldLookup()};
#if defined(__x86_64__)
    if (core::simdLevel() >= core::SimdLevel::avx2) all.push_back(simd_avx2::fieldLookup());
    if (core::simdLevel() >= core::SimdLevel::avx512) all.push_back(simd_avx512::fieldLookup());
#endif
    std::mt19937_64 g(test::seed());
    const field::DistanceField& field = grooved().field;
    const field::FieldView view = field.view();
    double cosines[8], sines[8];
    for (int j = 0; j < 8; ++j) {
        cosines[j] = std::cos(0.4 * j);
        sines[j] = std::sin(0.4 * j);
    }
    int fine = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 d = test::randomDirection(g), centre = d * (test::grooveRadius(d) + test::uniform(g, -0.5, 0.5)),
                   x = 0.2 * test::randomDirection(g), y = 0.2 * test::randomDirection(g);
        FieldRow row;
        for (int k = 0; k < 3; ++k) {
            row.centre[k] = centre[k];
            row.x[k] = x[k];
            row.y[k] = y[k];
        }
        row.cosines = cosines;
        row.sines = sines;
        float first[8];
        for (std::size_t level = 0; level < all.size(); ++level) {
            float distances[8];
            all[level](view, row, 0, distances);
            if (level == 0) std::memcpy(first, distances, sizeof first);
            EXPECT_EQ(std::memcmp(distances, first, sizeof distances), 0);
        }
        for (int j = 0; j < 8; ++j) {
            const Vec3 p = centre + cosines[j] * x + sines[j] * y;
            if (field.isFine(p)) {
                ++fine;
                EXPECT_NEAR(first[j], field.distance(p), 1e-6);
            } else {
                EXPECT_GT(std::abs(first[j]), kBoundMm - 1.0f);
                EXPECT_EQ(first[j] < 0.0f, field.distance(p) < 0.0);
            }
        }
    }
    EXPECT_GT(fine, 1000);
}

}  // namespace
}  // namespace handpiece::contact
