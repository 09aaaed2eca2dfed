// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Teeth in closed form that can be cut, and what is to be measured of them afterwards.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/tooth/tooth_model.h"
#include "support/random.h"

namespace handpiece::test {

using Distance = std::function<double(const core::Vec3&)>;

/// Signed distance to an axis-aligned box.
inline Distance boxDistance(const core::Box& box) {
    return [=](const core::Vec3& p) {
        const core::Vec3 q = (p - box.centre()).cwiseAbs() - 0.5 * box.size();
        return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
    };
}

/// A tooth without a mesh: the field alone.
inline std::shared_ptr<const tooth::ToothModel> phantom(const core::Box& box, double voxelMm, const Distance& distance,
                                                        double bandInMm = 0.3) {
    const field::FieldSettings settings{voxelMm, 0.1, bandInMm};
    auto field = field::DistanceField::fromFunction(box.grown(0.3), settings, distance);
    // No surface is asked for; a tree wants one.
    geometry::TriangleMesh mesh;
    mesh.vertices = {core::Vec3(0, 0, 0), core::Vec3(1, 0, 0), core::Vec3(0, 1, 0)};
    mesh.triangles = {{0, 1, 2}};
    geometry::TriangleTree tree(mesh);
    return std::make_shared<const tooth::ToothModel>(
        tooth::ToothModel{"phantom", std::move(mesh), std::move(tree), std::move(field)});
}

/// A block of enamel.
inline std::shared_ptr<const tooth::ToothModel> enamelBlock(const core::Vec3& low, const core::Vec3& high,
                                                            double voxelMm) {
    const core::Box box{low, high};
    const auto uncut = phantom(box, voxelMm, boxDistance(box));
    return tooth::withTissues(*uncut, field::TissueMap::uniform(uncut->field, cases::Tissue::enamel));
}

inline core::Pose poseAt(const core::Vec3& p, const core::Quat& q = core::Quat::Identity()) {
    return {p, q};
}

inline double sumOf(const tooth::TissueVolumes& volumes) {
    double sum = 0.0;
    for (const double v : volumes)
        sum += v;
    return sum;
}

/// How far along `normal` (unit, out of the solid) the field's zero lies from `p`, looked for within `reachMm`; NaN
/// when there is none.
inline double zeroAlong(const field::DistanceField& field, const core::Vec3& p, const core::Vec3& normal,
                        double reachMm) {
    double low = -reachMm, high = reachMm;
    if (!(field.distance(p + low * normal) < 0.0 && field.distance(p + high * normal) > 0.0))
        return std::numeric_limits<double>::quiet_NaN();
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + high);
        (field.distance(p + middle * normal) < 0.0 ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

}  // namespace handpiece::test
