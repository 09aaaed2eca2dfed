// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Many small meshes in one big buffer, drawn together. Private to this room.

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/senses/view/gl.h"
#include "handpiece/senses/view/passes.h"

namespace handpiece::view {

/// As the graphics card has it: 24 bytes.
struct GpuVertex {
    std::array<float, 3> positionMm;
    std::uint32_t normal;  ///< 10 bits each
    std::uint8_t tissue;
    std::uint8_t unused;
    std::uint16_t removedUm;
    std::array<std::uint8_t, 4> scanned{};  ///< surface::ScanColour
};
static_assert(sizeof(GpuVertex) == 24);

[[nodiscard]] std::uint32_t packedNormal(const std::array<float, 3>& unit);

/// A mesh before it is uploaded; at most 65536 vertices.
struct MeshPiece {
    std::vector<GpuVertex> vertices;
    std::vector<std::array<std::uint16_t, 3>> triangles;
};

/// Where a piece lies in the pool, and what decides whether it can be seen.
struct PooledMesh {
    std::uint32_t firstVertex = 0, vertexCount = 0, firstIndex = 0, indexCount = 0;
    gl::Vec3f minMm = gl::Vec3f::Zero(), maxMm = gl::Vec3f::Zero(), centreMm = gl::Vec3f::Zero();
    float radiusMm = 0.0f;
    gl::Vec3f coneAxis = gl::Vec3f::UnitZ();
    float coneCutoff = 1.0f;  ///< sine of the half angle of all its triangles' normals; 1: any direction
};

/// First fit with neighbours joined again. Counts in elements.
class RangeAllocator {
  public:
    /// A range's begin; grows the whole by `grownBy()` when there is no room.
    [[nodiscard]] std::uint32_t take(std::uint32_t count);
    void giveBack(std::uint32_t first, std::uint32_t count);
    [[nodiscard]] std::uint32_t size() const noexcept { return size_; }

  private:
    std::map<std::uint32_t, std::uint32_t> free_;  ///< begin -> count
    std::uint32_t size_ = 0;
};

class MeshPool {
  public:
    MeshPool();
    [[nodiscard]] PooledMesh add(const MeshPiece& piece);
    void remove(const PooledMesh& mesh);
    /// Binds and draws them, in this order; returns the triangles.
    std::size_t draw(std::span<const PooledMesh* const> meshes);

  private:
    void growVertices(std::size_t bytes);

    gl::VertexArray array_;
    gl::Buffer vertices_, indices_;
    std::size_t vertexBytes_ = 0;
    RangeAllocator vertexRoom_, indexRoom_;
    /// Of all pieces, numbered from each piece's first vertex. Those to be drawn go to the card as one list: thousands
    /// of small draws cost more than their triangles.
    std::vector<std::uint16_t> pieceIndices_;
    std::vector<std::uint32_t> drawn_;
};

/// What of the scene an eye may see: within the picture's part `rect`, not turned away.
class Culler {
  public:
    /// `cones`: pieces turned away wholly are left out. Off where their inside can be seen.
    Culler(const Eye& eye, const Viewport& viewport, const PixelRect& rect, bool cones);
    [[nodiscard]] bool mayBeSeen(const PooledMesh& mesh) const;

  private:
    std::array<gl::Vec4f, 5> planes_;
    gl::Vec3f eyeMm_;
    bool cones_;
};

/// The picture's part that a box covers; all of it when the box reaches behind the eye.
[[nodiscard]] PixelRect rectOf(const gl::Vec3f& minMm, const gl::Vec3f& maxMm, const Eye& eye,
                               const Viewport& viewport);

}  // namespace handpiece::view
