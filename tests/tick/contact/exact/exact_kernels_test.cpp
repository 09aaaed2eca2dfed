// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/exact/exact_kernels.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "handpiece/base/core/simd.h"
#include "tick/contact/contact_fixture.h"

namespace handpiece::contact::exact_kernels_test {
namespace {

using core::Vec3;

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

TEST(ExactKernels, nearestPointIsThatOfTheTree) {
    std::mt19937_64 g(test::seed());
    const TreeView view = viewOf(test::grooved().tree);
    for (int i = 0; i < 3000; ++i) {
        const Vec3 p = test::anywhere(g);
        SurfaceHit hit;
        hit.value = std::numeric_limits<double>::infinity();
        hit.triangle = i % 2 == 0 ? SurfaceHit::kNone : static_cast<std::uint32_t>(g() % view.triangleCount);
        simd_base::exactKernels().nearestToPoint(view, p.data(), hit);
        EXPECT_NEAR(hit.value, test::grooved().tree.nearest(p).distanceMm, 1e-12);
    }
}

TEST(ExactKernels, aRunOfBallsAgreesWithManyPoints) {
    std::mt19937_64 g(test::seed());
    const TreeView view = viewOf(test::grooved().tree);
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
            const Vec3 tip = test::anywhere(g), axis = test::randomDirection(g);
            SurfaceHit hit;
            hit.value = std::numeric_limits<double>::infinity();
            simd_base::exactKernels().nearestToRun(view, run, tip.data(), axis.data(), hit);
            double sampled = std::numeric_limits<double>::infinity();
            for (std::size_t piece = 0; piece < slope.size(); ++piece)
                for (int s = 0; s <= 400; ++s) {
                    const double dz = (zs[k][piece + 1] - zs[k][piece]) * s / 400.0;
                    const double d = test::grooved().tree.nearest(tip + (zs[k][piece] + dz) * axis, 3.0).distanceMm;
                    sampled = std::min(sampled, d - rs[k][piece] - slope[piece] * dz);
                }
            if (sampled > 2.0) continue;
            EXPECT_LE(hit.value, sampled + 1e-9);
            EXPECT_GE(hit.value, sampled - 2.0 * 2.0 / 400.0);
            const Vec3 c = tip + hit.z * axis, q(hit.point[0], hit.point[1], hit.point[2]);
            EXPECT_NEAR(test::grooved().tree.nearest(q).distanceMm, 0.0, 1e-9);
            EXPECT_GE((c - q).norm() + 1e-9, test::grooved().tree.nearest(c).distanceMm);
        }
    }
}

TEST(ExactKernels, everyInstructionSetGivesTheSameBits) {
    const std::vector<ExactKernels> all = allExact();
    if (all.size() == 1) GTEST_SKIP() << "this processor has one level only";
    std::mt19937_64 g(test::seed());
    const TreeView view = viewOf(test::grooved().tree);
    const double z[3] = {0.3, 0.8, 2.0}, radius[3] = {0.3, 0.5, 0.5}, slope[2] = {0.4, 0.0};
    AxisRun varying;
    varying.z = z;
    varying.radius = radius;
    varying.slope = slope;
    varying.count = 3;
    varying.maxRadius = 0.5f;
    for (int i = 0; i < 1000; ++i) {
        const Vec3 tip = test::anywhere(g), axis = test::randomDirection(g);
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

}  // namespace
}  // namespace handpiece::contact::exact_kernels_test
