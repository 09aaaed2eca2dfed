// SPDX-License-Identifier: Apache-2.0
// Patches with fewer triangles, against the whole ones: distances either way by looking at every triangle.
#include "handpiece/senses/view/simplify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "support/random.h"

namespace handpiece::view::simplify_test {
namespace {

using gl::Vec3f;
using Place = std::array<float, 3>;
using Faces = std::vector<std::array<Vec3f, 3>>;

Vec3f vec(const Place& p) {
    return {p[0], p[1], p[2]};
}

/// Hills over 1.2 mm x 1.2 mm in steps of a voxel; two tissues meet along y = 0.9 mm.
struct Hills {
    float high, wide, turn;

    [[nodiscard]] float at(float x, float y) const { return high * std::sin(x / wide + turn) * std::cos(y / wide); }
    [[nodiscard]] Vec3f normal(float x, float y) const {
        const float dx = high / wide * std::cos(x / wide + turn) * std::cos(y / wide);
        const float dy = -high / wide * std::sin(x / wide + turn) * std::sin(y / wide);
        return Vec3f(-dx, -dy, 1.0f).normalized();
    }
    /// Columns `from` to `to` of 24.
    [[nodiscard]] std::shared_ptr<const surface::BrickMesh> piece(int from, int to) const {
        auto mesh = std::make_shared<surface::BrickMesh>();
        std::map<std::array<int, 3>, std::uint16_t> known;
        const auto corner = [&](int i, int j, cases::Tissue tissue) {
            const auto [it, isNew] =
                known.try_emplace({i, j, static_cast<int>(tissue)}, static_cast<std::uint16_t>(mesh->vertices.size()));
            if (isNew) {
                const float x = 0.05f * static_cast<float>(i), y = 0.05f * static_cast<float>(j);
                const Vec3f n = normal(x, y);
                mesh->vertices.push_back({{x, y, at(x, y)}, {n.x(), n.y(), n.z()}, tissue});
            }
            return it->second;
        };
        for (int i = from; i < to; ++i)
            for (int j = 0; j < 24; ++j) {
                const auto tissue = j < 18 ? cases::Tissue::enamel : cases::Tissue::dentine;
                const std::uint16_t a = corner(i, j, tissue), b = corner(i + 1, j, tissue),
                                    c = corner(i + 1, j + 1, tissue), d = corner(i, j + 1, tissue);
                mesh->triangles.push_back({a, b, c});
                mesh->triangles.push_back({a, c, d});
            }
        return mesh;
    }
};

Faces facesOf(const MeshPiece& piece) {
    Faces faces;
    for (const auto& t : piece.triangles)
        faces.push_back({vec(piece.vertices[t[0]].positionMm), vec(piece.vertices[t[1]].positionMm),
                         vec(piece.vertices[t[2]].positionMm)});
    return faces;
}
Faces facesOf(const surface::BrickMesh& mesh) {
    Faces faces;
    for (const auto& t : mesh.triangles)
        faces.push_back({vec(mesh.vertices[t[0]].positionMm), vec(mesh.vertices[t[1]].positionMm),
                         vec(mesh.vertices[t[2]].positionMm)});
    return faces;
}

/// By projection on the plane and, outside of the triangle, on its edges.
float distanceTo(const Vec3f& p, const std::array<Vec3f, 3>& t) {
    const Vec3f n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    bool inside = true;
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3f &a = t[k], &b = t[(k + 1) % 3], ab = b - a;
        inside = inside && n.dot(ab.cross(p - a)) >= 0.0f;
        least = std::min(least, (p - a - ab * std::clamp(ab.dot(p - a) / ab.squaredNorm(), 0.0f, 1.0f)).norm());
    }
    return inside ? std::abs(n.dot(p - t[0])) : least;
}
/// The farthest that places of `from` lie from `to`.
float farthest(const Faces& from, const Faces& to, int steps) {
    float worst = 0.0f;
    for (const auto& t : from)
        for (int i = 0; i <= steps; ++i)
            for (int j = 0; i + j <= steps; ++j) {
                const float u = static_cast<float>(i) / static_cast<float>(steps),
                            v = static_cast<float>(j) / static_cast<float>(steps);
                const Vec3f p = t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
                float least = std::numeric_limits<float>::infinity();
                for (const auto& other : to)
                    least = std::min(least, distanceTo(p, other));
                worst = std::max(worst, least);
            }
    return worst;
}

using Edge = std::pair<Place, Place>;
/// Edges that have a triangle of this tissue on one side only.
template <class Mesh>
std::vector<Edge> rimOf(const Mesh& mesh, cases::Tissue tissue) {
    std::map<Edge, int> count;
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto &a = mesh.vertices[t[k]], &b = mesh.vertices[t[(k + 1) % 3]];
            if (static_cast<cases::Tissue>(a.tissue) != tissue) continue;
            ++count[{a.positionMm, b.positionMm}];
            --count[{b.positionMm, a.positionMm}];
        }
    std::vector<Edge> rim;
    for (const auto& [edge, times] : count)
        if (times > 0) rim.push_back(edge);
    return rim;
}

TEST(Simplify, StaysNearKeepsItsRimAndTheBordersOfTissues) {
    std::mt19937_64 random(test::seed());
    for (int round = 0; round < 3; ++round) {
        const Hills hills{static_cast<float>(test::uniform(random, 0.02, 0.3)),
                          static_cast<float>(test::uniform(random, 0.4, 1.5)),
                          static_cast<float>(test::uniform(random, 0.0, 6.0))};
        constexpr float kMostMm = 0.004f;
        // As two bricks that meet in the middle.
        const std::vector<std::shared_ptr<const surface::BrickMesh>> bricks = {hills.piece(0, 11), hills.piece(11, 24)};
        const auto whole = hills.piece(0, 24);
        const Simplified made = simplified(bricks, kMostMm);
        EXPECT_LT(made.piece.triangles.size(), whole->triangles.size() / 3);
        EXPECT_GT(made.errorMm, 0.0f);
        EXPECT_LE(made.errorMm, kMostMm);
        const Faces few = facesOf(made.piece), all = facesOf(*whole);
        // Edges that cross may lie a little farther apart than the corners do.
        EXPECT_LE(farthest(all, few, 2), 1.1f * kMostMm);
        EXPECT_LE(farthest(few, all, 6), 1.1f * kMostMm);
        for (const auto tissue : {cases::Tissue::enamel, cases::Tissue::dentine})
            EXPECT_EQ(rimOf(made.piece, tissue), rimOf(*whole, tissue));
        for (const auto& t : few) {
            const Vec3f n = (t[1] - t[0]).cross(t[2] - t[0]).normalized(), middle = (t[0] + t[1] + t[2]) / 3.0f;
            EXPECT_GT(n.dot(hills.normal(middle.x(), middle.y())), 0.9f);
        }
    }
}

TEST(Simplify, TakesNothingFromAnEdgeOfTheSolid) {
    // A roof: each side has its own normals along the ridge.
    surface::BrickMesh roof;
    constexpr int kSteps = 10;
    for (const float side : {-1.0f, 1.0f})
        for (int i = 0; i <= kSteps; ++i)
            for (int j = 0; j <= kSteps; ++j) {
                const float x = 0.05f * static_cast<float>(i), y = 0.05f * static_cast<float>(j);
                const Vec3f n = Vec3f(0.0f, side, 1.0f).normalized();
                roof.vertices.push_back({{x, side * y, -y}, {n.x(), n.y(), n.z()}, cases::Tissue::enamel});
            }
    constexpr int kRow = kSteps + 1;
    for (int side = 0; side < 2; ++side)
        for (int i = 0; i < kSteps; ++i)
            for (int j = 0; j < kSteps; ++j) {
                const auto at = [&](int a, int b) {
                    return static_cast<std::uint16_t>(side * kRow * kRow + a * kRow + b);
                };
                std::array<std::uint16_t, 3> one{at(i, j), at(i + 1, j), at(i + 1, j + 1)},
                    two{at(i, j), at(i + 1, j + 1), at(i, j + 1)};
                if (side == 0) {
                    std::swap(one[1], one[2]);
                    std::swap(two[1], two[2]);
                }
                roof.triangles.push_back(one);
                roof.triangles.push_back(two);
            }
    const std::vector<std::shared_ptr<const surface::BrickMesh>> bricks = {
        std::make_shared<const surface::BrickMesh>(roof)};
    const Simplified made = simplified(bricks, 0.004f);
    EXPECT_LT(made.piece.triangles.size(), roof.triangles.size() / 2);
    EXPECT_LE(made.errorMm, 1e-6f) << "flat sides lose nothing";
    int onRidge = 0;
    for (int i = 0; i <= kSteps; ++i)
        onRidge += std::any_of(made.piece.vertices.begin(), made.piece.vertices.end(), [&](const GpuVertex& v) {
            return v.positionMm == Place{0.05f * static_cast<float>(i), 0.0f, 0.0f};
        });
    EXPECT_EQ(onRidge, kRow);
}

}  // namespace
}  // namespace handpiece::view::simplify_test
