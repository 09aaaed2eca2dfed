// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A target out of a teacher's own work: the surface that they cut.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "handpiece/assess/zones/zones.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/tooth/tooth_mirror.h"

namespace handpiece::preparation {

struct RecordedWork {
    /// That was cut, and two rows of triangles of the uncut one about it, out of what is left of the tooth; tooth
    /// frame, vertices in steps of 0.1 um, as files keep them.
    geometry::TriangleMesh surface;
    std::uint32_t cutTriangles = 0;         ///< that many of its triangles, from the first, were cut
    double voxelMm = 0.0;                   ///< of the field it was cut in: how fine the surface is
    core::Vec3 draw = core::Vec3::UnitZ();  ///< path of draw, out of the tooth, unit

    /// Over all of it; the same on every machine.
    [[nodiscard]] std::uint64_t hash() const;
};

/// What `cut` has lost. Its path of draw is the first of the occlusal, buccal, lingual, mesial and distal directions
/// from which no more than a twentieth of the cut surface hides behind other, else that from which least does;
/// `buccalSign` as cases have it. In parallel, the same bits at any thread count. Throws core::Error where nothing was
/// cut, or not a voxel of it.
[[nodiscard]] RecordedWork recordWork(const tooth::ToothMirror& cut, int buccalSign);

/// As bytes: docs/formats/exercise.md.
[[nodiscard]] std::vector<std::byte> encodeZones(const RecordedWork& work);
/// Throws core::Error for bytes that are none, cut short, damaged, of a newer version, or no surface.
[[nodiscard]] RecordedWork decodeZones(std::span<const std::byte> data, const std::string& where);

/// How far a place lies from what was taken: the way from there to it, along the path of draw (under the floor) and
/// square to it (past a wall). What lies past it more along than square to the path of draw is under it. Half a voxel
/// on into the air the target goes, square to the uncut surface.
[[nodiscard]] zones::TargetFunction recordedTarget(const RecordedWork& work, const core::Vec3& draw,
                                                   const zones::Leeway& leeway,
                                                   std::shared_ptr<const geometry::TriangleTree> whole);

}  // namespace handpiece::preparation
