// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What is wrong with a mesh, in numbers.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::geometry {

enum class LengthUnit { unknown, micrometre, millimetre, centimetre, metre, inch };

/// "mm", "um", ...; "unknown".
[[nodiscard]] std::string_view unitName(LengthUnit unit);

/// Of "mm", "cm", "m", "inch", "um"; unknown for any other.
[[nodiscard]] LengthUnit unitByName(std::string_view name);
/// 0 when unknown.
[[nodiscard]] double millimetresPer(LengthUnit unit);

/// A guess with its reason, never a conversion.
struct UnitGuess {
    LengthUnit unit = LengthUnit::unknown;
    double millimetresPerUnit = 0.0;  ///< 0 when unknown
    std::string reason;
};

/// The unit a dental object with this box diagonal [file units] was probably drawn in: millimetres wherever they make
/// sense.
[[nodiscard]] UnitGuess probableUnit(double boxDiagonal);

/// Counts and sizes of a mesh. Two faces are neighbours when they share an edge, that is both its vertices by number.
struct MeshReport {
    std::size_t vertices = 0;
    std::size_t faces = 0;
    std::size_t edges = 0;
    core::Box boxMm;
    double areaMm2 = 0.0;
    double volumeMm3 = 0.0;               ///< signed; means something only when closed and oriented
    std::size_t shells = 0;               ///< sets of faces joined through edges
    std::size_t openEdges = 0;            ///< edges of one face
    std::size_t boundaryLoops = 0;        ///< connected sets of open edges
    std::size_t nonManifoldEdges = 0;     ///< edges of three or more faces
    std::size_t nonManifoldVertices = 0;  ///< vertices where fans of faces touch without sharing an edge
    std::size_t flippedFaces = 0;         ///< faces to turn until all neighbours agree: the smaller side of each shell
    std::size_t insideOutShells = 0;      ///< closed shells that face inwards (or, inside another shell, outwards)
    std::size_t duplicateVertices = 0;    ///< used vertices at the exact place of an earlier one
    std::size_t unusedVertices = 0;
    std::size_t degenerateFaces = 0;       ///< a corner repeated, or no area
    std::size_t duplicateFaces = 0;        ///< the same three vertices as an earlier face, either way round
    bool orientable = true;                ///< false when no turning of faces makes neighbours agree (a Moebius strip)
    std::int64_t eulerCharacteristic = 0;  ///< used vertices - edges + faces, repeated-corner faces left out
    std::optional<std::int64_t> genus;     ///< sum over the shells; only of closed manifold meshes
    UnitGuess unit;

    // The first of each kind of flaw, for messages.
    std::optional<core::Vec3> firstOpenEdgeMm, firstNonManifoldEdgeMm, firstNonManifoldVertexMm, firstFlippedFaceMm;

    /// Every edge has two faces.
    [[nodiscard]] bool closed() const { return faces > 0 && openEdges == 0 && nonManifoldEdges == 0; }
    /// All neighbours agree and every shell faces the right way.
    [[nodiscard]] bool oriented() const { return orientable && flippedFaces == 0 && insideOutShells == 0; }
};

/// The report of a mesh: deterministic, below 0.1 s for 325,000 faces on one core. Does not look for self-crossings
/// (self_intersection.h). Throws core::Error when a triangle names a vertex that is not there.
[[nodiscard]] MeshReport inspect(const TriangleMesh& mesh);

}  // namespace handpiece::geometry
