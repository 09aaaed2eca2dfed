// SPDX-License-Identifier: Apache-2.0
#include "tick/force/prism_tooth.h"

#include <numeric>

namespace handpiece::test {
namespace {

using core::Vec2;
using core::Vec3;

double cross(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Cuts off ears until a triangle is left.
std::vector<geometry::Triangle> triangulate(const std::vector<Vec2>& p) {
    std::vector<std::uint32_t> left(p.size());
    std::iota(left.begin(), left.end(), 0u);
    std::vector<geometry::Triangle> result;
    while (left.size() >= 3) {
        for (std::size_t i = 0; i < left.size(); ++i) {
            const std::size_t n = left.size();
            const std::uint32_t a = left[(i + n - 1) % n], b = left[i], c = left[(i + 1) % n];
            if (cross(p[a], p[b], p[c]) <= 0) continue;
            bool empty = true;
            for (const std::uint32_t q : left) {
                if (q == a || q == b || q == c) continue;
                empty = empty &&
                        !(cross(p[a], p[b], p[q]) >= 0 && cross(p[b], p[c], p[q]) >= 0 && cross(p[c], p[a], p[q]) >= 0);
            }
            if (!empty) continue;
            result.push_back({a, b, c});
            left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
            break;
        }
    }
    return result;
}

}  // namespace

std::shared_ptr<const tooth::ToothModel> prismTooth(const std::vector<Vec2>& corners, double halfLengthMm,
                                                    double voxelMm, const core::Quat& turn) {
    geometry::TriangleMesh mesh;
    const auto n = static_cast<std::uint32_t>(corners.size());
    for (const double y : {-halfLengthMm, halfLengthMm}) {
        for (const Vec2& c : corners)
            mesh.vertices.push_back(turn * Vec3(c.x(), y, c.y()));
    }
    // With y into the page, counter-clockwise in (x, z) is seen from -y.
    for (const geometry::Triangle& t : triangulate(corners)) {
        mesh.triangles.push_back(t);
        mesh.triangles.push_back({t[0] + n, t[2] + n, t[1] + n});
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t j = (i + 1) % n;
        mesh.triangles.push_back({i, i + n, j});
        mesh.triangles.push_back({j, i + n, j + n});
    }
    const geometry::TriangleTree tree(mesh);
    field::FieldSettings settings;
    settings.voxelMm = voxelMm;
    field::DistanceField field = field::DistanceField::fromFunction(
        mesh.bounds().grown(0.5), settings, [&](const Vec3& p) { return tree.signedDistance(p); });
    return std::make_shared<const tooth::ToothModel>(
        tooth::ToothModel{"prism", std::move(mesh), tree, std::move(field)});
}

}  // namespace handpiece::test
