// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/instrument/piece.h"
#include "handpiece/model/instrument/shapes.h"

namespace handpiece::instrument {

geometry::TriangleMesh turnedMesh(const Profile& profile, int around, double spacingMm) {
    if (around < 3) throw core::Error("a turned mesh needs at least 3 points around", std::to_string(around));
    if (!(spacingMm > 0.0))
        throw core::Error("the spacing of a turned mesh must be positive", std::to_string(spacingMm));
    validate(profile);
    std::vector<core::Vec2> places;  // of the rings
    for (const ProfilePiece& piece : profile.pieces) {
        const int steps =
            piece.isArc ? std::max(1, static_cast<int>(std::ceil(lengthMm(piece) / spacingMm - 1e-9))) : 1;
        for (int i = 1; i <= steps; ++i)
            places.push_back(pointAt(piece, static_cast<double>(i) / steps));
    }
    places.pop_back();  // the last place is the top, on the axis

    geometry::TriangleMesh mesh;
    const auto n = static_cast<std::uint32_t>(around);
    mesh.vertices.emplace_back(0.0, 0.0, profile.pieces.front().from.y());
    for (const core::Vec2& place : places)
        for (std::uint32_t j = 0; j < n; ++j) {
            const double angle = 2.0 * std::numbers::pi * j / n;
            mesh.vertices.emplace_back(place.x() * core::cos(angle), place.x() * core::sin(angle), place.y());
        }
    const auto top = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.emplace_back(0.0, 0.0, profile.pieces.back().to.y());

    const auto at = [&](std::uint32_t ring, std::uint32_t j) { return 1 + ring * n + j % n; };
    const auto rings = static_cast<std::uint32_t>(places.size());
    for (std::uint32_t j = 0; j < n; ++j)
        mesh.triangles.push_back({0, at(0, j + 1), at(0, j)});
    for (std::uint32_t ring = 0; ring + 1 < rings; ++ring)
        for (std::uint32_t j = 0; j < n; ++j) {
            mesh.triangles.push_back({at(ring, j), at(ring, j + 1), at(ring + 1, j + 1)});
            mesh.triangles.push_back({at(ring, j), at(ring + 1, j + 1), at(ring + 1, j)});
        }
    for (std::uint32_t j = 0; j < n; ++j)
        mesh.triangles.push_back({at(rings - 1, j), at(rings - 1, j + 1), top});
    return mesh;
}

}  // namespace handpiece::instrument
