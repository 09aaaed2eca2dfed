// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Teeth without files, and poses that press a bur into them by a given depth.

#include <memory>
#include <vector>

#include "handpiece/base/core/rotation.h"
#include "handpiece/base/core/simd.h"
#include "handpiece/model/field/field_builder.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/tooth/tooth_model.h"
#include "handpiece/tick/contact/field_method.h"
#include "support/random.h"
#include "tick/contact/grooved_ball.h"

namespace handpiece::test {

inline std::shared_ptr<const tooth::ToothModel> toothOf(geometry::TriangleMesh mesh) {
    geometry::TriangleTree tree(mesh);
    field::DistanceField field = field::FieldBuilder::fromSurface(mesh, tree, {}, {});
    return std::make_shared<const tooth::ToothModel>(
        tooth::ToothModel{"test", std::move(mesh), std::move(tree), std::move(field)});
}

/// The ball with grooves, made once.
inline const tooth::ToothModel& grooved() {
    static const auto tooth = toothOf(groovedBall(24));
    return *tooth;
}
/// Anywhere in and about it.
inline core::Vec3 anywhere(std::mt19937_64& g) {
    return {uniform(g, -5, 5), uniform(g, -5, 5), uniform(g, -5, 5)};
}
/// The instruction sets of this processor.
inline std::vector<core::SimdLevel> levels() {
    std::vector<core::SimdLevel> all;
    for (const core::SimdLevel level : {core::SimdLevel::base, core::SimdLevel::avx2, core::SimdLevel::avx512})
        if (level <= core::simdLevel()) all.push_back(level);
    return all;
}

/// A closed box; each face a grid of `steps` x `steps` squares.
inline geometry::TriangleMesh boxMesh(const core::Vec3& low, const core::Vec3& high, int steps) {
    geometry::TriangleMesh mesh;
    std::map<std::array<int, 3>, std::uint32_t> known;
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side)
            for (int i = 0; i < steps; ++i)
                for (int j = 0; j < steps; ++j) {
                    const auto at = [&](int a, int b) {
                        std::array<int, 3> key{};
                        key[static_cast<std::size_t>(axis)] = side * steps;
                        key[static_cast<std::size_t>((axis + 1) % 3)] = a;
                        key[static_cast<std::size_t>((axis + 2) % 3)] = b;
                        const auto [it, added] =
                            known.try_emplace(key, static_cast<std::uint32_t>(mesh.vertices.size()));
                        if (added)
                            mesh.vertices.push_back(
                                low + (high - low).cwiseProduct(core::Vec3(key[0], key[1], key[2])) / steps);
                        return it->second;
                    };
                    const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
                    if (side == 1) {
                        mesh.triangles.push_back({a, b, c});
                        mesh.triangles.push_back({a, c, d});
                    } else {
                        mesh.triangles.push_back({a, c, b});
                        mesh.triangles.push_back({a, d, c});
                    }
                }
    return mesh;
}

/// A pose over the crown of groovedBall, pressed along its own axis until `method` reads about `depthMm`.
inline core::Pose pressedPose(std::mt19937_64& generator, contact::Method& method, double depthMm) {
    core::Vec3 d;
    do
        d = randomDirection(generator);
    while (d.z() < 0.6);
    const core::Vec3 up = (d + 0.5 * randomDirection(generator)).normalized();
    core::Pose pose;
    pose.orientation = core::rotationBetween(core::Vec3::UnitZ(), up);
    pose.positionMm = d * grooveRadius(d);
    for (int i = 0; i < 8; ++i)
        pose.positionMm -= up * (depthMm - method.depth(pose).depthMm);
    return pose;
}

}  // namespace handpiece::test
