// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the fuzz targets of the model's readers share: any bytes give a value or one core::Error.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string_view>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/field_cache.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/model/tooth/tooth_state.h"

namespace handpiece::fuzz {

/// Calls work(bytes as text); an Error must name what is wrong on one line.
template <class Work>
int readText(const std::uint8_t* data, std::size_t size, const Work& work) {
    try {
        work(std::string_view(reinterpret_cast<const char*>(data), size));
    } catch (const core::Error& e) {
        if (e.problem().empty()) __builtin_trap();
    }
    return 0;
}

/// What we have written ourselves must be read without an Error.
template <class Work>
auto mustRead(const Work& work) {
    try {
        return work();
    } catch (const core::Error&) {
        __builtin_trap();
    }
}

/// A ball of enamel of 0.7 mm at 0.1 mm voxels.
inline std::shared_ptr<const tooth::ToothModel> smallTooth() {
    core::setThreadCount(1);
    field::FieldSettings settings;
    settings.voxelMm = 0.1;
    geometry::TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    geometry::TriangleTree tree(mesh);
    field::DistanceField field =
        field::DistanceField::fromFunction({core::Vec3::Constant(-0.9), core::Vec3::Constant(0.9)}, settings,
                                           [](const core::Vec3& p) { return p.norm() - 0.7; });
    field::TissueMap map = field::TissueMap::uniform(field, cases::Tissue::enamel);
    return tooth::withTissues(tooth::ToothModel{"ball", mesh, std::move(tree), std::move(field)}, std::move(map));
}

/// Bytes before the payload of a cut state.
inline constexpr std::size_t kStateHeaderBytes = 136;
/// Sets whose it is, size and checksums of a cut state right, or nothing would get past those.
inline void seal(std::span<std::byte> state, std::uint64_t identity) {
    constexpr std::size_t kKey = 16, kPayloadBytes = 32, kPayloadHash = 120, kHeaderHash = 128;
    const auto put = [&](std::size_t at, std::uint64_t number) { std::memcpy(&state[at], &number, sizeof number); };
    put(kKey, identity);
    put(kPayloadBytes, state.size() - kStateHeaderBytes);
    put(kPayloadHash, field::hashOf(state.subspan(kStateHeaderBytes)));
    core::Hasher hasher;
    hasher.add(std::span<const std::byte>(state.first(kHeaderHash)));
    put(kHeaderHash, hasher.value());
}

}  // namespace handpiece::fuzz
