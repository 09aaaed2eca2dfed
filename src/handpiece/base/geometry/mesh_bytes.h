// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A mesh as bytes and back, bit for bit: for records that must hold all they need.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::geometry {

/// Appends the mesh, arranged so that it packs well: indices as differences, numbers byte by byte in planes.
void appendMesh(std::vector<std::byte>& bytes, const TriangleMesh& mesh);

/// Takes one mesh from the front of `bytes`, which is shortened by it. Throws core::Error naming `where` when the bytes
/// end early, an index points nowhere or a number is not finite.
[[nodiscard]] TriangleMesh takeMesh(std::span<const std::byte>& bytes, const std::string& where);

}  // namespace handpiece::geometry
