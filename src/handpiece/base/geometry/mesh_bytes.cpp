// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/mesh_bytes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "handpiece/base/core/difference_bytes.h"
#include "handpiece/base/core/error.h"

namespace handpiece::geometry {
namespace {

constexpr std::uint32_t kMaxCount = 1u << 26;

void appendNumber(std::vector<std::byte>& bytes, std::uint64_t value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i)
        bytes.push_back(static_cast<std::byte>(value >> (8 * i)));
}

class Taker {
  public:
    Taker(std::span<const std::byte>& bytes, const std::string& where) : bytes_(bytes), where_(where) {}
    [[noreturn]] void refuse(const char* what) const {
        throw core::Error(std::string("the mesh inside ") + what, where_, "the file is damaged: take another copy");
    }
    std::span<const std::byte> take(std::uint64_t size) {
        if (size > bytes_.size()) refuse("ends early");
        const auto taken = bytes_.first(size);
        bytes_ = bytes_.subspan(size);
        return taken;
    }
    std::uint64_t number(std::size_t size) {
        std::uint64_t value = 0;
        const auto taken = take(size);
        for (std::size_t i = 0; i < size; ++i)
            value |= static_cast<std::uint64_t>(taken[i]) << (8 * i);
        return value;
    }
    std::int64_t difference() {
        if (const auto taken = core::takeDifference(bytes_)) return *taken;
        refuse(bytes_.size() < core::kMaxDifferenceBytes ? "ends early" : "has a number without end");
    }

  private:
    std::span<const std::byte>& bytes_;
    const std::string& where_;
};

}  // namespace

void appendMesh(std::vector<std::byte>& bytes, const TriangleMesh& mesh) {
    const std::size_t vertices = mesh.vertices.size();
    // What came out of an STL file fits into floats.
    const bool isFloat = std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const core::Vec3& v) {
        return (v.array() == v.cast<float>().cast<double>().array()).all();
    });
    const std::size_t width = isFloat ? 4 : 8;
    appendNumber(bytes, vertices, 4);
    appendNumber(bytes, mesh.triangles.size(), 4);
    appendNumber(bytes, width, 1);
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t begin = bytes.size();
        bytes.resize(begin + width * vertices);
        for (std::size_t i = 0; i < vertices; ++i) {
            const double value = mesh.vertices[i][axis];
            const std::uint64_t bits =
                isFloat ? std::bit_cast<std::uint32_t>(static_cast<float>(value)) : std::bit_cast<std::uint64_t>(value);
            for (std::size_t plane = 0; plane < width; ++plane)
                bytes[begin + plane * vertices + i] = static_cast<std::byte>(bits >> (8 * plane));
        }
    }
    // Vertices mostly come in the order of their first use: differences from the newest are small.
    std::int64_t newest = 0;
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t) {
            core::appendDifference(bytes, newest - std::int64_t{v});
            newest = std::max(newest, std::int64_t{v} + 1);
        }
}

TriangleMesh takeMesh(std::span<const std::byte>& bytes, const std::string& where) {
    Taker taker(bytes, where);
    const std::uint64_t vertices = taker.number(4), triangles = taker.number(4), width = taker.number(1);
    // At least a byte an index: sizes are believed only as far as there are bytes.
    if ((width != 4 && width != 8) || vertices > kMaxCount || triangles > kMaxCount ||
        3 * width * vertices + 3 * triangles > bytes.size())
        taker.refuse("claims more than there is");
    TriangleMesh mesh;
    mesh.vertices.resize(vertices);
    for (int axis = 0; axis < 3; ++axis) {
        const auto planes = taker.take(width * vertices);
        for (std::size_t i = 0; i < vertices; ++i) {
            std::uint64_t bits = 0;
            for (std::size_t plane = 0; plane < width; ++plane)
                bits |= static_cast<std::uint64_t>(planes[plane * vertices + i]) << (8 * plane);
            const double value = width == 4
                                     ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)))
                                     : std::bit_cast<double>(bits);
            if (!std::isfinite(value)) taker.refuse("has a vertex that is nowhere");
            mesh.vertices[i][axis] = value;
        }
    }
    mesh.triangles.resize(triangles);
    std::int64_t newest = 0;
    for (Triangle& t : mesh.triangles)
        for (std::uint32_t& v : t) {
            const std::int64_t difference = taker.difference();
            if (difference > newest || newest - difference >= static_cast<std::int64_t>(vertices) ||
                difference < -static_cast<std::int64_t>(kMaxCount))
                taker.refuse("has a triangle without a vertex");
            v = static_cast<std::uint32_t>(newest - difference);
            newest = std::max(newest, std::int64_t{v} + 1);
        }
    return mesh;
}

}  // namespace handpiece::geometry
