// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Meshes from files and into files: STL, PLY and OBJ in, STL and PLY out. What a file says of itself is never
/// believed.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/base/geometry/vertex_colours.h"

namespace handpiece::geometry {

/// Bytes of the largest file that is read: some twenty million faces as text.
inline constexpr std::uint64_t kMaxMeshBytes = 4ull << 30;

enum class MeshFormat { unknown, stl, ply, obj };

/// What a reader had to put up with, one plain sentence each ("the header says 12 facets, the file holds 3120").
using ReadNotes = std::vector<std::string>;

/// The format that a file's extension promises (any case); unknown for any other.
[[nodiscard]] MeshFormat meshFormatOf(const std::filesystem::path& path);

/// The mesh in a file [the file's own unit, meant as mm]; its format is told by its content, not by its name.
///
/// STL (binary, also with "solid" in its header or a wrong count; ASCII) has its equal vertices merged (same bits, -0 =
/// +0), numbered by first appearance. PLY (ASCII, binary of both ends) and OBJ keep their vertices; polygons become
/// triangles. What was left out of a file goes to `notes`, or without them to whoever listens (read_notes.h). Throws
/// core::Error on empty, truncated or senseless files, coordinates that are not finite, more than 2^31
/// corners, more bytes than kMaxMeshBytes.
[[nodiscard]] TriangleMesh readMesh(const std::filesystem::path& path, ReadNotes* notes = nullptr);
/// The same from memory. `hint` decides only where the content is silent; `where` names the source in errors.
[[nodiscard]] TriangleMesh readMesh(std::span<const std::byte> data, MeshFormat hint, const std::string& where,
                                    ReadNotes* notes = nullptr);

/// The same with the colours of its vertices: PLY's red, green and blue, 8 or 16 bits or float, and OBJ's behind the
/// coordinates or in the pictures of its materials (texture.h; files beside the mesh). Empty where the file has none.
/// What cannot be believed (no numbers, beyond their range, not at all vertices, one colour for all) is left out and
/// told; the surface is read all the same.
[[nodiscard]] ColouredMesh readColouredMesh(const std::filesystem::path& path, ReadNotes* notes = nullptr);
[[nodiscard]] ColouredMesh readColouredMesh(std::span<const std::byte> data, MeshFormat hint, const std::string& where,
                                            ReadNotes* notes = nullptr);

/// Binary STL (float32), written whole or not at all. Throws core::Error, also for indices out of range.
void writeStl(const std::filesystem::path& path, const TriangleMesh& mesh);
/// The same in memory; `where` names it in errors.
[[nodiscard]] std::vector<std::byte> stlBytes(const TriangleMesh& mesh, const std::string& where);
/// Binary little-endian PLY with double coordinates and, where there are any, colours: nothing is lost. Written whole
/// or not at all.
void writePly(const std::filesystem::path& path, const TriangleMesh& mesh, const VertexColours& colours = {});
/// The same in memory; `where` names it in errors.
[[nodiscard]] std::vector<std::byte> plyBytes(const TriangleMesh& mesh, const VertexColours& colours,
                                              const std::string& where);
/// writeStl (which holds no colours) or writePly by the extension; throws core::Error for any other.
void writeMesh(const std::filesystem::path& path, const TriangleMesh& mesh, const VertexColours& colours = {});

/// Throws core::Error when a triangle names a vertex that is not there or a vertex is not finite.
void requireValidIndices(const TriangleMesh& mesh, const std::string& where);

}  // namespace handpiece::geometry
