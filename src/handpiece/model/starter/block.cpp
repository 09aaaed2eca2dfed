// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/starter/block.h"

#include <algorithm>
#include <map>

#include "handpiece/base/geometry/isosurface.h"

namespace handpiece::starter {
namespace {

using core::Vec3;
using geometry::TriangleMesh;

const core::Box kBlock{Vec3(-8.0, -6.0, -8.0), Vec3(8.0, 6.0, 0.0)};
constexpr double kEnamelMm = 1.5;

/// A box of squares of about a millimetre, each cut in two.
TriangleMesh boxMesh(const core::Box& box) {
    std::array<int, 3> count;
    for (int k = 0; k < 3; ++k)
        count[static_cast<std::size_t>(k)] = std::max(1, static_cast<int>(std::lround(box.size()[k])));
    TriangleMesh mesh;
    std::map<std::array<int, 3>, std::uint32_t> known;
    const auto vertex = [&](const std::array<int, 3>& at) {
        const auto [place, isNew] = known.emplace(at, static_cast<std::uint32_t>(mesh.vertices.size()));
        if (isNew) {
            Vec3 p;
            for (int k = 0; k < 3; ++k) {
                const auto i = static_cast<std::size_t>(k);
                p[k] = at[i] == count[i] ? box.max[k] : box.min[k] + box.size()[k] * at[i] / count[i];
            }
            mesh.vertices.push_back(p);
        }
        return place->second;
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (const bool isHigh : {false, true})
            for (int i = 0; i < count[u]; ++i)
                for (int j = 0; j < count[v]; ++j) {
                    const auto corner = [&](int du, int dv) {
                        std::array<int, 3> at{};
                        at[axis] = isHigh ? count[axis] : 0, at[u] = i + du, at[v] = j + dv;
                        return vertex(at);
                    };
                    std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
                    if (!isHigh) std::swap(b, d);
                    mesh.triangles.push_back({a, b, c});
                    mesh.triangles.push_back({a, c, d});
                }
    }
    return mesh;
}

/// Half of an ellipsoid under the block's top.
TriangleMesh bowl(const Vec3& half) {
    geometry::IsosurfaceSettings settings;
    settings.spacingMm = 0.15;
    settings.relaxations = 0;
    return geometry::isosurface(
        core::Box{-half, Vec3(half.x(), half.y(), 0.0)}.grown(0.5),
        [half](const Vec3& p) { return std::max((p.cwiseQuotient(half).norm() - 1.0) * half.minCoeff(), p.z()); },
        settings);
}

}  // namespace

cases::Case makeBlock(BlockLayers layers) {
    cases::Case made;
    made.name = layers == BlockLayers::hard      ? "block"
                : layers == BlockLayers::layered ? "layered block"
                                                 : "carious block";
    made.kind = "block";
    made.buccalSign = -1;
    made.outer = boxMesh(kBlock);
    const auto add = [&](std::string_view name, cases::Tissue tissue, TriangleMesh mesh) {
        made.parts.push_back({std::string(name), tissue, cases::properties(tissue).priority, std::move(mesh), false});
    };
    add("enamel", cases::Tissue::enamel, made.outer);
    if (layers == BlockLayers::hard) return made;
    core::Box under = kBlock;
    under.max.z() = -kEnamelMm;
    add("dentine", cases::Tissue::dentine, boxMesh(under));
    if (layers == BlockLayers::layered) return made;
    const Vec3 half(3.0, 2.5, 3.0);
    const Vec3 shell = Vec3::Constant(0.5);
    add("firm", cases::Tissue::cariesFirm, bowl(half));
    add("leathery", cases::Tissue::cariesLeathery, bowl(half - shell));
    add("soft", cases::Tissue::cariesSoft, bowl(half - 2.0 * shell));
    return made;
}

}  // namespace handpiece::starter
