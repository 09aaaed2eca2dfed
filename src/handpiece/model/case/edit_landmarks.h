// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Landmarks moved by a person, and put back into a case's file.

#include <cstddef>
#include <filesystem>
#include <vector>

#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/case/landmark.h"

namespace handpiece::cases {

/// Whether landmarks of this kind lie on the tooth's surface, and stay there.
[[nodiscard]] bool liesOnSurface(LandmarkKind kind) noexcept;

/// How far along a line or ring its other points go with the one that is moved [mm].
inline constexpr double kLandmarkReachMm = 1.5;

/// `mark` with its point `which` at `toMm`, of a kind that lies on the surface at the surface's place nearest to that.
/// Of a line or ring the points near it go with it, the less the farther along it they are. Its source is `set`.
[[nodiscard]] Landmark moved(const Landmark& mark, std::size_t which, const core::Vec3& toMm,
                             const geometry::TriangleTree& surface);

/// Between the places that a person gave for a line or ring [mm].
inline constexpr double kLandmarkStepMm = 0.4;

/// One set by hand at these places, in their order: where its kind lies on the surface, at the nearest ones there,
/// those of a line or ring with points of the surface between them. Two points are an axis and go upwards. Of fewer
/// places than its kind needs it is what it is so far.
[[nodiscard]] Landmark drawn(LandmarkKind kind, const std::string& name, const std::vector<core::Vec3>& placesMm,
                             const geometry::TriangleTree& surface);

/// Puts `marks` in place of the landmarks of the case's own tooth, in its case.toml or .handpiece file; all else in it
/// stays byte for byte. Whole or not at all. Throws core::Error, also for what is no case: a mesh, an attempt.
void writeLandmarks(const std::filesystem::path& casePath, const std::vector<Landmark>& marks);

}  // namespace handpiece::cases
