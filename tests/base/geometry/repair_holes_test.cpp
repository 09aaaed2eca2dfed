// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/repair_holes.h"

#include <gtest/gtest.h>
#include <pthread.h>

#include "handpiece/base/geometry/inspect.h"

namespace handpiece::geometry::repair_holes_test {
namespace {

using core::Vec3;

/// A band between two loops in the form of a comb: holes that are cut into pieces tooth by tooth.
TriangleMesh combBand(std::size_t teeth) {
    std::vector<Vec3> comb;
    const double wide = 3.0 * static_cast<double>(teeth);
    for (std::size_t i = 0; i < teeth; ++i)
        for (const auto& [x, y] : {std::pair{0.0, 1.0}, {0.0, 9.0}, {1.0, 9.0}, {1.0, 1.0}})
            comb.emplace_back(3.0 * static_cast<double>(i) + x, y, 0.0);
    comb.emplace_back(wide, 0.0, 0.0);
    comb.emplace_back(0.0, 0.0, 0.0);
    TriangleMesh mesh;
    mesh.vertices = comb;
    for (const Vec3& p : comb)
        mesh.vertices.push_back(p + Vec3(0, 0, 4));
    const auto n = static_cast<std::uint32_t>(comb.size());
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t j = (i + 1) % n;
        mesh.triangles.push_back({i, i + n, j});
        mesh.triangles.push_back({j, i + n, j + n});
    }
    return mesh;
}

void* closeThem(void* mesh) {
    (void)closeHoles(*static_cast<TriangleMesh*>(mesh));
    return nullptr;
}

TEST(CloseHoles, NeedNoStackForManyPieces) {
#ifdef HANDPIECE_SANITIZED
    GTEST_SKIP() << "the sanitizers need a stack of their own";
#endif
    TriangleMesh mesh = combBand(300);
    pthread_attr_t small;
    pthread_attr_init(&small);
    ASSERT_EQ(pthread_attr_setstacksize(&small, 64 << 10), 0);
    pthread_t thread;
    ASSERT_EQ(pthread_create(&thread, &small, closeThem, &mesh), 0);
    pthread_join(thread, nullptr);
    pthread_attr_destroy(&small);
    EXPECT_TRUE(inspect(mesh).closed());
    EXPECT_TRUE(inspect(mesh).oriented());
}

}  // namespace
}  // namespace handpiece::geometry::repair_holes_test
