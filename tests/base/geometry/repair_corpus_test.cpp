// SPDX-License-Identifier: Apache-2.0
// Generated teeth, broken at random in every way that files are broken, and mended.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/geometry/meshes.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/repair.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/model/starter/starter.h"
#include "support/random.h"

namespace handpiece::geometry::repair_corpus_test {
namespace {

using core::Vec3;

/// Small damage, so that the tooth is still the tooth: each kind touches well under a hundredth of it.
class Breaker {
  public:
    Breaker(TriangleMesh whole, std::mt19937_64& generator) : mesh_(std::move(whole)), generator_(generator) {}

    TriangleMesh breakAtRandom(std::string& what) {
        const std::pair<const char*, void (Breaker::*)()> kinds[] = {
            {"hole", &Breaker::hole},         {"fin", &Breaker::fin},
            {"tetrahedron", &Breaker::glue},  {"flipped", &Breaker::flip},
            {"duplicated", &Breaker::repeat}, {"crossing", &Breaker::cross},
            {"shell", &Breaker::shell},       {"T-junction", &Breaker::tJunction},
            {"two fans", &Breaker::pinch},    {"loose face", &Breaker::looseFace}};
        for (const auto& [name, damage] : kinds)
            for (int times = below(3); times > 0; --times) {
                (this->*damage)();
                what += fmt::format(" {}", name);
            }
        if (below(3) == 0) {
            mesh_ = test::soup(mesh_);
            what += " soup";
        }
        return take();
    }
    TriangleMesh take() { return std::move(mesh_); }

    void hole() { mesh_.triangles.erase(mesh_.triangles.begin() + static_cast<std::ptrdiff_t>(face())); }
    void glue() {
        const Triangle t = mesh_.triangles[face()];
        const std::uint32_t c = add(outOf(t, 0.5)), d = add(outOf(t, 0.5) + 0.3 * side(t));
        const std::uint32_t a = t[0], b = t[1];
        for (const Triangle& side : {Triangle{a, b, c}, {b, a, d}, {a, c, d}, {c, b, d}})
            mesh_.triangles.push_back(side);
    }

  private:
    int below(int n) { return static_cast<int>(test::uniform(generator_, 0, 1) * n); }
    std::size_t face() { return static_cast<std::size_t>(below(static_cast<int>(mesh_.triangles.size()))); }
    std::uint32_t add(const Vec3& p) {
        mesh_.vertices.push_back(p);
        return static_cast<std::uint32_t>(mesh_.vertices.size() - 1);
    }
    [[nodiscard]] Vec3 centre(const Triangle& t) const {
        return (mesh_.vertices[t[0]] + mesh_.vertices[t[1]] + mesh_.vertices[t[2]]) / 3.0;
    }
    [[nodiscard]] Vec3 side(const Triangle& t) const { return mesh_.vertices[t[1]] - mesh_.vertices[t[0]]; }
    // A place over the face, by a share of its first side.
    [[nodiscard]] Vec3 outOf(const Triangle& t, double share) const {
        return centre(t) +
               share * side(t).norm() * side(t).cross(mesh_.vertices[t[2]] - mesh_.vertices[t[0]]).normalized();
    }

    void fin() {
        const Triangle t = mesh_.triangles[face()];
        mesh_.triangles.push_back({t[0], t[1], add(outOf(t, 0.7))});
    }
    void flip() {
        Triangle& t = mesh_.triangles[face()];
        std::swap(t[0], t[1]);
    }
    void repeat() { mesh_.triangles.push_back(mesh_.triangles[face()]); }
    void cross() {
        // A corner pulled across its neighbours, a little under the surface.
        const Triangle t = mesh_.triangles[face()];
        mesh_.vertices[t[0]] += 1.6 * side(t) - 0.2 * (outOf(t, 1.0) - centre(t));
    }
    void shell() {
        const TriangleMesh speck = test::sphereMesh(outOf(mesh_.triangles[face()], 20.0), 0.05, 3);
        mesh_ = test::joined(mesh_, speck);
    }
    void tJunction() {
        const std::size_t f = face();
        const Triangle t = mesh_.triangles[f];
        const std::uint32_t middle = add(0.5 * (mesh_.vertices[t[0]] + mesh_.vertices[t[1]]));
        mesh_.triangles[f] = {t[0], middle, t[2]};
        mesh_.triangles.push_back({middle, t[1], t[2]});
    }
    void pinch() {
        // A tetrahedron that stands on a corner.
        const Triangle t = mesh_.triangles[face()];
        const std::uint32_t a = t[0], b = add(outOf(t, 0.4)), c = add(outOf(t, 0.6)),
                            d = add(outOf(t, 0.6) + 0.2 * side(t));
        for (const Triangle& side : {Triangle{a, c, b}, {a, b, d}, {a, d, c}, {b, c, d}})
            mesh_.triangles.push_back(side);
    }
    void looseFace() {
        const Triangle t = mesh_.triangles[face()];
        mesh_.triangles.push_back({add(outOf(t, 3.0)), add(outOf(t, 3.5)), add(outOf(t, 3.0) + side(t))});
    }

    TriangleMesh mesh_;
    std::mt19937_64& generator_;
};

TriangleMesh toothOf(std::size_t faces, std::size_t kind) {
    return starter::makeOuter(starter::toothKinds()[kind % starter::toothKinds().size()].kind, faces);
}

// Closed, the same tooth, and left alone by a second repair.
void expectMended(const TriangleMesh& whole, TriangleMesh broken) {
    const RepairReport r = repair(broken);
    EXPECT_TRUE(r.after.closed());
    EXPECT_TRUE(r.after.oriented());
    EXPECT_EQ(r.after.nonManifoldVertices, 0u);
    EXPECT_EQ(r.after.duplicateFaces, 0u);
    EXPECT_EQ(r.after.shells, 1u);
    EXPECT_NEAR(r.after.volumeMm3, enclosedVolumeMm3(whole), 0.01 * enclosedVolumeMm3(whole));
    EXPECT_NEAR(r.after.areaMm2, surfaceAreaMm2(whole), 0.01 * surfaceAreaMm2(whole));
    TriangleMesh again = broken;
    const RepairReport second = repair(again);
    EXPECT_EQ(again.triangles, broken.triangles);
    EXPECT_EQ(again.vertices, broken.vertices);
    EXPECT_EQ(second.crossingFaces, r.crossingFaces);
}

TEST(RepairCorpus, TeethBrokenAtRandomAreMendedInOnePass) {
    std::mt19937_64 generator(test::seed());
    const std::vector<TriangleMesh> teeth{toothOf(2000, 0), toothOf(5000, 1), toothOf(12000, 2)};
    for (int round = 0; round < 30; ++round) {
        const TriangleMesh& whole = teeth[static_cast<std::size_t>(round) % teeth.size()];
        std::string what;
        const TriangleMesh broken = Breaker(whole, generator).breakAtRandom(what);
        SCOPED_TRACE(fmt::format("round {}:{}", round, what));
        expectMended(whole, broken);
    }
}

TEST(RepairCorpus, AToothWithAHoleAndSomethingStuckToItStaysATooth) {
    for (const std::size_t faces : {2000u, 30000u}) {
        SCOPED_TRACE(faces);
        std::mt19937_64 generator(test::seed());
        const TriangleMesh whole = toothOf(faces, 1);
        Breaker breaker(whole, generator);
        breaker.hole();
        breaker.glue();
        const TriangleMesh broken = breaker.take();
        ASSERT_EQ(inspect(broken).nonManifoldEdges, 1u);
        ASSERT_EQ(inspect(broken).openEdges, 3u);
        expectMended(whole, broken);
    }
}

}  // namespace
}  // namespace handpiece::geometry::repair_corpus_test
