// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/packed_case.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/base/prepared/packed_bytes.h"
#include "handpiece/model/case/case_files.h"
#include "handpiece/model/case/package.h"

namespace handpiece::cases {
namespace {

constexpr std::uint64_t kMostBytes = 1ull << 30;
constexpr std::size_t kHeader = 84, kFacet = 50, kNormal = 12;

using Corner = std::array<std::uint32_t, 3>;  // the bits of three floats
using Numbers = std::vector<std::uint32_t>;

/// A binary STL as its vertices, each once and from the one before, and where its corners met them: 0 a new one, else
/// how many ago.
struct Surface {
    Numbers vertices, corners;
};

std::uint32_t folded(std::uint32_t difference) {
    return difference << 1 ^ (0u - (difference >> 31));
}
std::uint32_t unfolded(std::uint32_t told) {
    return told >> 1 ^ (0u - (told & 1));
}

Surface surfaceOf(std::span<const std::byte> stl) {
    Surface s;
    std::map<Corner, std::uint32_t> known;
    Corner before{};
    for (std::size_t at = kHeader; at + kFacet <= stl.size(); at += kFacet)
        for (std::size_t k = 0; k < 3; ++k) {
            Corner corner;
            std::memcpy(corner.data(), &stl[at + kNormal + 12 * k], sizeof corner);
            const auto [place, isNew] = known.try_emplace(corner, static_cast<std::uint32_t>(known.size()));
            s.corners.push_back(isNew ? 0 : static_cast<std::uint32_t>(known.size()) - place->second);
            if (!isNew) continue;
            for (std::size_t axis = 0; axis < 3; ++axis)
                s.vertices.push_back(folded(corner[axis] - before[axis]));
            before = corner;
        }
    return s;
}

/// Empty for what cannot be meant.
std::vector<std::byte> stlOf(const Surface& s, const std::string& name) {
    if (s.vertices.size() % 3 != 0 || s.corners.size() % 3 != 0) return {};
    geometry::TriangleMesh mesh;
    Corner bits{};
    std::size_t used = 0;
    const std::size_t count = s.vertices.size() / 3;
    for (std::size_t i = 0; i < s.corners.size(); i += 3) {
        geometry::Triangle& triangle = mesh.triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t ago = s.corners[i + k];
            if (ago == 0) {
                if (used == count) return {};
                std::array<float, 3> place;
                for (std::size_t axis = 0; axis < 3; ++axis)
                    bits[axis] += unfolded(s.vertices[3 * used + axis]);
                std::memcpy(place.data(), bits.data(), sizeof place);
                mesh.vertices.emplace_back(place[0], place[1], place[2]);
                triangle[k] = static_cast<std::uint32_t>(used++);
            } else if (ago <= used) {
                triangle[k] = static_cast<std::uint32_t>(used) - ago;
            } else {
                return {};
            }
        }
    }
    if (used != count ||
        !std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const core::Vec3& v) { return v.allFinite(); }))
        return {};
    return geometry::stlBytes(mesh, name);
}

/// But for the normals, which nobody reads.
bool isSameSurface(std::span<const std::byte> a, std::span<const std::byte> b) {
    if (a.size() != b.size()) return false;
    for (std::size_t at = kHeader; at + kFacet <= a.size(); at += kFacet)
        if (std::memcmp(&a[at + kNormal], &b[at + kNormal], kFacet - kNormal) != 0) return false;
    return true;
}

void packNumbers(const Numbers& numbers, std::vector<std::byte>& out) {
    prepared::pack(prepared::inPlanes(std::as_bytes(std::span(numbers)), sizeof numbers[0]), out);
}

bool takeNumbers(std::span<const std::byte>& packed, Numbers& numbers) {
    const auto planes = prepared::unpack(packed, kMostBytes);
    if (!planes || planes->size() % sizeof numbers[0] != 0) return false;
    const std::vector<std::byte> bytes = prepared::fromPlanes(*planes, sizeof numbers[0]);
    numbers.resize(bytes.size() / sizeof numbers[0]);
    if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size());
    return true;
}

bool isStl(const std::string& name) {
    return name.ends_with(".stl");
}

/// All surfaces in one, one after the other; how long each is.
void append(Numbers& to, const Numbers& from, Numbers& lengths) {
    lengths.push_back(static_cast<std::uint32_t>(from.size()));
    to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

std::vector<std::byte> packCase(const Case& toothCase) {
    const PackageFiles files = caseFiles(toothCase);
    std::string names;
    std::vector<std::byte> texts, out;
    Numbers vertices, corners, lengths;
    for (const auto& [name, bytes] : files) {
        names += name + '\n';
        if (isStl(name)) {
            const Surface surface = surfaceOf(bytes);
            if (!isSameSurface(stlOf(surface, name), bytes))
                throw core::Error("this surface cannot be packed as it is", name, "export it as binary STL");
            append(vertices, surface.vertices, lengths);
            append(corners, surface.corners, lengths);
        } else {
            lengths.push_back(static_cast<std::uint32_t>(bytes.size()));
            texts.insert(texts.end(), bytes.begin(), bytes.end());
        }
    }
    prepared::pack(std::as_bytes(std::span(names)), out);
    packNumbers(lengths, out);
    prepared::pack(texts, out);
    packNumbers(vertices, out);
    packNumbers(corners, out);
    return out;
}

std::optional<Case> unpackCase(std::span<const std::byte> packed, const std::filesystem::path& place) {
    const auto names = prepared::unpack(packed, kMostBytes);
    Numbers lengths, vertices, corners;
    if (!names || !takeNumbers(packed, lengths)) return std::nullopt;
    const auto texts = prepared::unpack(packed, kMostBytes);
    if (!texts || !takeNumbers(packed, vertices) || !takeNumbers(packed, corners) || !packed.empty())
        return std::nullopt;

    PackageFiles files;
    std::vector<std::pair<std::string, Surface>> surfaces;
    std::size_t length = 0, text = 0, vertex = 0, corner = 0;
    bool fits = true;
    const auto take = [&](auto& from, std::size_t& at, auto& into) {
        const std::size_t count = length < lengths.size() ? lengths[length] : 0;
        fits = fits && length < lengths.size() && count <= from.size() - at;
        ++length;
        if (fits)
            into.assign(from.begin() + static_cast<std::ptrdiff_t>(at),
                        from.begin() + static_cast<std::ptrdiff_t>(at + count));
        at += fits ? count : 0;
    };
    const std::string all(reinterpret_cast<const char*>(names->data()), names->size());
    for (std::size_t from = 0, to; fits && (to = all.find('\n', from)) != std::string::npos; from = to + 1) {
        const std::string name = all.substr(from, to - from);
        std::vector<std::byte>& bytes = files[name];
        if (isStl(name)) {
            Surface& surface = surfaces.emplace_back(name, Surface{}).second;
            take(vertices, vertex, surface.vertices);
            take(corners, corner, surface.corners);
        } else {
            take(*texts, text, bytes);
        }
    }
    if (!fits) return std::nullopt;
    std::vector<std::vector<std::byte>> stl(surfaces.size());
    core::parallelFor(surfaces.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            stl[i] = stlOf(surfaces[i].second, surfaces[i].first);
    });
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        if (stl[i].empty()) return std::nullopt;
        files[surfaces[i].first] = std::move(stl[i]);
    }
    try {
        return readCaseFiles(filesInPackage(place, files));
    } catch (const core::Error&) {
        return std::nullopt;
    }
}

}  // namespace handpiece::cases
