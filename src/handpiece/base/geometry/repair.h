// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Makes a closed, oriented, manifold mesh out of what a scanner or a drawing program left.

#include <cstddef>
#include <string>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::geometry {

/// The automatic welding distance as a share of the box's diagonal: 0.25 um on a tooth of 25 mm.
inline constexpr double kAutomaticWeldShare = 1e-5;

struct RepairSettings {
    double weldMm = -1.0;  ///< vertices nearer than this become one; negative: kAutomaticWeldShare of the diagonal
    double debrisAreaShare =
        0.01;           ///< shells with less than this share of the largest shell's area are dropped; 0 keeps all
    bool base = false;  ///< the border of an open scan is stood on a flat base; other holes are closed as usual
    double baseDepthMm = -1.0;  ///< from the border's lowest place to the floor; negative: by the scan's size
};

/// The most that may go of the outermost shells' area, debris and patches that are told apart, and of the volume.
inline constexpr double kMaxLostShare = 0.01;

/// A hole that was closed.
struct ClosedHole {
    std::size_t edges = 0;
    double perimeterMm = 0.0;
    double areaMm2 = 0.0;  ///< of the faces that close it
    core::Vec3 centreMm = core::Vec3::Zero();
};

/// A border that was stood on a flat base: of each shell its longest loop, if that goes round as much as the shell's
/// box measures from corner to corner.
struct MadeBase {
    std::size_t edges = 0;
    double perimeterMm = 0.0;
    double depthMm = 0.0;                    ///< from the border's lowest place to the floor
    double areaMm2 = 0.0;                    ///< of walls and floor
    core::Vec3 downMm = core::Vec3::Zero();  ///< unit: out of the floor
};

/// What repair() did, in the order in which it did it.
struct RepairReport {
    MeshReport before, after;
    double weldMm = 0.0;  ///< the distance that was used
    std::size_t weldedVertices = 0;
    std::size_t removedDegenerateFaces = 0;
    std::size_t removedDuplicateFaces = 0;
    std::size_t removedFinFaces = 0;  ///< small loose sheets that hung on an edge of a better surface
    double removedFinAreaMm2 = 0.0;
    std::size_t splitEdges = 0;            ///< edges of more than two faces, cut apart
    std::size_t splitVertices = 0;         ///< vertices added where sheets were cut apart
    std::size_t droppedShells = 0;         ///< debris
    std::size_t droppedFaces = 0;          ///< their faces
    double droppedAreaMm2 = 0.0;           ///< their area
    double droppedVolumeMm3 = 0.0;         ///< what those of them enclosed that were closed
    std::size_t turnedFaces = 0;           ///< to agree with their neighbours or to face outwards
    std::vector<ClosedHole> holes;         ///< the largest perimeter first
    std::vector<MadeBase> bases;           ///< none unless asked for
    std::size_t addedFaces = 0;            ///< to close them, and in place of faces that crossed
    std::size_t turnedFlatFaces = 0;       ///< faces without height that shared their long side out to a neighbour
    std::size_t removedCrossingFaces = 0;  ///< crossing faces, and what lay around them, that gave way to a patch
    double removedCrossingAreaMm2 = 0.0;
    double lostAreaMm2 = 0.0;       ///< of the outermost shells, without debris and what gave way to patches
    std::size_t crossingFaces = 0;  ///< pairs of faces that still cross in the result: told, not mended
    std::size_t crossingMade = 0;   ///< those of them of which a face was made, to close a hole
    core::Vec3 firstCrossingMm = core::Vec3::Zero();  ///< where the first of them cross
};

/// Mends `mesh` in place: afterwards it is closed, manifold and oriented, outer shells outwards and cavities inwards.
///
/// Welds, removes degenerate and double faces and small fins, cuts non-manifold edges and vertices apart (copies move
/// apart by a few welding distances, so that a file that merges equal vertices keeps them apart), drops debris, closes
/// every hole, and replaces small patches that cross. Solids that overlap are left as they are and told in
/// crossingFaces. All of it again until nothing changes: what was mended once is left as it is.
/// Throws core::Error (and leaves `mesh` as it was) when nothing is left, a surface cannot be oriented, more than
/// kMaxLostShare would be lost, or debris is more than a tenth of all.
RepairReport repair(TriangleMesh& mesh, const RepairSettings& settings = {});

/// Throws core::Error, with the reason and a place, where what came out crosses itself: no case takes that. `settings`
/// as they were given.
void requireUncrossed(const RepairReport& report, const RepairSettings& settings, const std::string& where);

}  // namespace handpiece::geometry
