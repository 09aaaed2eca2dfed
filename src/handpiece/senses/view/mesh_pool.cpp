// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/mesh_pool.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace handpiece::view {
namespace {

using gl::Vec3f;
using gl::Vec4f;

Vec3f at(const GpuVertex& vertex) {
    return {vertex.positionMm[0], vertex.positionMm[1], vertex.positionMm[2]};
}

void measure(const MeshPiece& piece, PooledMesh& mesh) {
    mesh.minMm.setConstant(std::numeric_limits<float>::infinity());
    mesh.maxMm = -mesh.minMm;
    for (const GpuVertex& vertex : piece.vertices) {
        mesh.minMm = mesh.minMm.cwiseMin(at(vertex));
        mesh.maxMm = mesh.maxMm.cwiseMax(at(vertex));
    }
    mesh.centreMm = 0.5f * (mesh.minMm + mesh.maxMm);
    mesh.radiusMm = 0.5f * (mesh.maxMm - mesh.minMm).norm();
    // The triangles' own normals decide which way they face, not the vertices'.
    std::vector<Vec3f> normals;
    normals.reserve(piece.triangles.size());
    Vec3f sum = Vec3f::Zero();
    for (const auto& t : piece.triangles) {
        const Vec3f a = at(piece.vertices[t[0]]), b = at(piece.vertices[t[1]]), c = at(piece.vertices[t[2]]);
        const Vec3f normal = (b - a).cross(c - a);
        const float length = normal.norm();
        if (length <= 0.0f) continue;
        normals.push_back(normal / length);
        sum += normals.back();
    }
    const float length = sum.norm();
    if (length < 1e-6f) return;
    mesh.coneAxis = sum / length;
    float least = 1.0f;
    for (const Vec3f& normal : normals)
        least = std::min(least, normal.dot(mesh.coneAxis));
    // Some room for rounding: a triangle seen edge on is a pixel at most.
    mesh.coneCutoff = least <= 0.05f ? 1.0f : std::min(1.0f, std::sqrt(1.0f - least * least) + 1e-3f);
}

}  // namespace

std::uint32_t packedNormal(const std::array<float, 3>& unit) {
    const auto part = [](float v) {
        const auto i = static_cast<std::int32_t>(std::lround(std::clamp(v, -1.0f, 1.0f) * 511.0f));
        return static_cast<std::uint32_t>(i) & 0x3ffu;
    };
    return part(unit[0]) | part(unit[1]) << 10 | part(unit[2]) << 20;
}

std::uint32_t RangeAllocator::take(std::uint32_t count) {
    for (auto it = free_.begin(); it != free_.end(); ++it) {
        if (it->second < count) continue;
        const std::uint32_t first = it->first, rest = it->second - count;
        free_.erase(it);
        if (rest > 0) free_[first + count] = rest;
        return first;
    }
    const std::uint32_t first = size_;
    size_ += count;
    return first;
}

void RangeAllocator::giveBack(std::uint32_t first, std::uint32_t count) {
    if (count == 0) return;
    auto next = free_.lower_bound(first);
    if (next != free_.begin()) {
        const auto before = std::prev(next);
        if (before->first + before->second == first) {
            first = before->first;
            count += before->second;
            free_.erase(before);
        }
    }
    if (next != free_.end() && first + count == next->first) {
        count += next->second;
        free_.erase(next);
    }
    free_[first] = count;
}

MeshPool::MeshPool() {
    // Made with its attributes; what grows keeps its name, and they hold.
    vertexBytes_ = 1u << 20;
    vertices_.fill(GL_ARRAY_BUFFER, nullptr, vertexBytes_, GL_DYNAMIC_DRAW);
    array_.attach(vertices_, sizeof(GpuVertex),
                  {{0, 3, GL_FLOAT, false, offsetof(GpuVertex, positionMm)},
                   {1, 4, GL_INT_2_10_10_10_REV, true, offsetof(GpuVertex, normal)},
                   {2, 1, GL_UNSIGNED_BYTE, false, offsetof(GpuVertex, tissue), true},
                   {3, 1, GL_UNSIGNED_SHORT, true, offsetof(GpuVertex, removedUm)},
                   {4, 4, GL_UNSIGNED_BYTE, true, offsetof(GpuVertex, scanned)}});
    array_.attachIndices(indices_);
}

void MeshPool::growVertices(std::size_t bytes) {
    if (bytes <= vertexBytes_) return;
    const std::size_t larger = std::max(bytes, 2 * vertexBytes_);
    gl::Buffer kept;
    const auto copy = [&](const gl::Buffer& from, const gl::Buffer& to) {
        glBindBuffer(GL_COPY_READ_BUFFER, from.name());
        glBindBuffer(GL_COPY_WRITE_BUFFER, to.name());
        glCopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, 0, 0, static_cast<GLsizeiptr>(vertexBytes_));
    };
    kept.fill(GL_COPY_WRITE_BUFFER, nullptr, vertexBytes_, GL_STREAM_COPY);
    copy(vertices_, kept);
    vertices_.fill(GL_COPY_WRITE_BUFFER, nullptr, larger, GL_DYNAMIC_DRAW);
    copy(kept, vertices_);
    vertexBytes_ = larger;
}

PooledMesh MeshPool::add(const MeshPiece& piece) {
    PooledMesh mesh;
    mesh.vertexCount = static_cast<std::uint32_t>(piece.vertices.size());
    mesh.indexCount = static_cast<std::uint32_t>(3 * piece.triangles.size());
    if (mesh.indexCount == 0) return {};
    mesh.firstVertex = vertexRoom_.take(mesh.vertexCount);
    mesh.firstIndex = indexRoom_.take(mesh.indexCount);
    growVertices(std::size_t{vertexRoom_.size()} * sizeof(GpuVertex));
    pieceIndices_.resize(indexRoom_.size());
    glBindBuffer(GL_COPY_WRITE_BUFFER, vertices_.name());
    glBufferSubData(GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(std::size_t{mesh.firstVertex} * sizeof(GpuVertex)),
                    static_cast<GLsizeiptr>(piece.vertices.size() * sizeof(GpuVertex)), piece.vertices.data());
    auto index = pieceIndices_.begin() + mesh.firstIndex;
    for (const auto& triangle : piece.triangles)
        index = std::copy(triangle.begin(), triangle.end(), index);
    measure(piece, mesh);
    return mesh;
}

void MeshPool::remove(const PooledMesh& mesh) {
    vertexRoom_.giveBack(mesh.firstVertex, mesh.vertexCount);
    indexRoom_.giveBack(mesh.firstIndex, mesh.indexCount);
}

std::size_t MeshPool::draw(std::span<const PooledMesh* const> meshes) {
    std::size_t count = 0;
    for (const PooledMesh* mesh : meshes)
        count += mesh->indexCount;
    if (count == 0) return 0;
    drawn_.resize(count);
    std::uint32_t* to = drawn_.data();
    for (const PooledMesh* mesh : meshes) {
        const std::uint16_t* from = pieceIndices_.data() + mesh->firstIndex;
        for (std::uint32_t i = 0; i < mesh->indexCount; ++i)
            *to++ = mesh->firstVertex + from[i];
    }
    array_.bind();
    indices_.fill(GL_ELEMENT_ARRAY_BUFFER, drawn_.data(), count * sizeof(std::uint32_t), GL_STREAM_DRAW);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(count), GL_UNSIGNED_INT, nullptr);
    return count / 3;
}

Culler::Culler(const Eye& eye, const Viewport& viewport, const PixelRect& rect, bool cones)
    : eyeMm_(eye.positionMm), cones_(cones) {
    const gl::Mat4f m = eye.viewProjection();
    const auto w = static_cast<float>(viewport.width), h = static_cast<float>(viewport.height);
    const float left = 2.0f * static_cast<float>(rect.x0) / w - 1.0f,
                right = 2.0f * static_cast<float>(rect.x1) / w - 1.0f,
                low = 2.0f * static_cast<float>(rect.y0) / h - 1.0f,
                high = 2.0f * static_cast<float>(rect.y1) / h - 1.0f;
    const Vec4f x = m.row(0), y = m.row(1), z = m.row(2), s = m.row(3);
    planes_ = {x - left * s, right * s - x, y - low * s, high * s - y, z + s};
    for (Vec4f& plane : planes_)
        plane /= std::max(1e-12f, plane.head<3>().norm());
}

bool Culler::mayBeSeen(const PooledMesh& mesh) const {
    for (const Vec4f& plane : planes_)
        if (plane.head<3>().dot(mesh.centreMm) + plane.w() < -mesh.radiusMm) return false;
    if (!cones_) return true;
    const Vec3f to = mesh.centreMm - eyeMm_;
    return to.dot(mesh.coneAxis) < mesh.coneCutoff * to.norm() + mesh.radiusMm;
}

PixelRect rectOf(const Vec3f& minMm, const Vec3f& maxMm, const Eye& eye, const Viewport& viewport) {
    const PixelRect all{0, 0, viewport.width, viewport.height};
    const gl::Mat4f m = eye.viewProjection();
    float x0 = 2, y0 = 2, x1 = -2, y1 = -2;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec4f p(corner & 1 ? maxMm.x() : minMm.x(), corner & 2 ? maxMm.y() : minMm.y(),
                      corner & 4 ? maxMm.z() : minMm.z(), 1.0f);
        const Vec4f c = m * p;
        if (c.w() < 1e-3f) return all;
        const float x = c.x() / c.w(), y = c.y() / c.w();
        x0 = std::min(x0, x);
        x1 = std::max(x1, x);
        y0 = std::min(y0, y);
        y1 = std::max(y1, y);
    }
    const auto pixel = [](float ndc, int size) {
        return static_cast<int>(std::floor((0.5f * std::clamp(ndc, -2.0f, 2.0f) + 0.5f) * static_cast<float>(size)));
    };
    const PixelRect rect{pixel(x0, viewport.width) - 1, pixel(y0, viewport.height) - 1, pixel(x1, viewport.width) + 2,
                         pixel(y1, viewport.height) + 2};
    return rect.common(all);
}

}  // namespace handpiece::view
