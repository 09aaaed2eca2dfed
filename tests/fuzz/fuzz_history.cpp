// SPDX-License-Identifier: Apache-2.0
// Any bytes as the strokes before a session must give a history that can be undone and redone to its ends, or one
// core::Error. They are tried as they are and with the checksums of each stroke set right.
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "handpiece/app/simulation/history_bytes.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/field_cache.h"
#include "handpiece/model/tooth/cut_state_file.h"

namespace {

using namespace handpiece;

// A history: magic, three numbers, then each stroke's size and cut state.
constexpr std::size_t kHead = 28, kState = 136, kPayloadBytes = 32, kPayloadHash = 120, kHeaderHash = 128;

simulation::SimulationSetup smallStation() {
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
    simulation::SimulationSetup made;
    made.tooth = tooth::prepareCutting(
        std::make_shared<tooth::Tooth>(tooth::Tooth{"ball", mesh, std::move(tree), std::move(field), false, 0.0}),
        std::move(map));
    made.identity = 0x0123456789abcdefull;
    return made;
}

std::vector<std::byte> sealed(std::span<const std::byte> data) {
    std::vector<std::byte> out(data.begin(), data.end());
    const auto put = [&](std::size_t at, std::uint64_t number) { std::memcpy(&out[at], &number, sizeof number); };
    for (std::size_t at = kHead; at + 8 < out.size();) {
        std::uint64_t size = 0;
        std::memcpy(&size, &out[at], 8);
        at += 8;
        if (size < kState || size > out.size() - at) size = out.size() - at;
        put(at - 8, size);
        if (size < kState) break;
        put(at + kPayloadBytes, size - kState);
        put(at + kPayloadHash, field::hashOf(std::span(out).subspan(at + kState, size - kState)));
        core::Hasher hasher;
        hasher.add(std::span<const std::byte>(out).subspan(at, kHeaderHash));
        put(at + kHeaderHash, hasher.value());
        at += size;
    }
    return out;
}

void tryOut(std::span<const std::byte> data, const simulation::SimulationSetup& station) {
    try {
        history::History history = simulation::decodeHistory(data, tooth::StateDelta{}, station, "fuzz");
        while (history.undo()) {
        }
        while (history.redo()) {
        }
        if (history.redoSteps() != 0) __builtin_trap();
    } catch (const core::Error& e) {
        if (e.problem().empty()) __builtin_trap();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const simulation::SimulationSetup station = smallStation();
    const std::span<const std::byte> bytes = std::as_bytes(std::span(data, size));
    tryOut(bytes, station);
    if (size > kHead) tryOut(sealed(bytes), station);
    return 0;
}
