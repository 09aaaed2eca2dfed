// SPDX-License-Identifier: Apache-2.0
// Any bytes at all must give a state that the tooth can hold and that comes back the same, or one core::Error. The
// bytes are tried as they are and with the checksums set right, or nothing would get past those.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/field_cache.h"
#include "handpiece/model/tooth/cut_state_file.h"

namespace {

using namespace handpiece;

constexpr std::uint64_t kKey = 0x0123456789abcdefull;
constexpr std::size_t kHeader = 136, kPayloadBytes = 32, kPayloadHash = 120, kHeaderHash = 128;

/// A ball of enamel of 0.7 mm at 0.1 mm voxels.
std::shared_ptr<const tooth::CuttableTooth> smallTooth() {
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
    return tooth::prepareCutting(
        std::make_shared<tooth::Tooth>(tooth::Tooth{"ball", mesh, std::move(tree), std::move(field), false, 0.0}),
        std::move(map));
}

std::vector<std::byte> sealed(std::span<const std::byte> data) {
    std::vector<std::byte> out(data.begin(), data.end());
    const auto put = [&](std::size_t at, std::uint64_t number) { std::memcpy(&out[at], &number, sizeof number); };
    put(kPayloadBytes, out.size() - kHeader);
    put(kPayloadHash, field::hashOf(std::span(out).subspan(kHeader)));
    core::Hasher hasher;
    hasher.add(std::span(out).first(kHeaderHash));
    put(kHeaderHash, hasher.value());
    return out;
}

void tryOut(std::span<const std::byte> data, const std::shared_ptr<const tooth::CuttableTooth>& base) {
    tooth::StateDelta state;
    try {
        state = tooth::decodeState(data, kKey, *base);
    } catch (const core::Error&) {
        return;
    }
    const tooth::StateDelta again = tooth::decodeState(tooth::encodeState(state, kKey), kKey, *base);
    if (tooth::stateHash(again) != tooth::stateHash(state)) std::abort();
    tooth::CutField field(base);
    if (field.restore(state, 0, state.bricks.size()) != state.bricks.size()) std::abort();
    (void)field.volumesMm3();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const std::shared_ptr<const tooth::CuttableTooth> base = smallTooth();
    const std::span<const std::byte> bytes = std::as_bytes(std::span(data, size));
    tryOut(bytes, base);
    if (size >= kHeader) tryOut(sealed(bytes), base);
    return 0;
}
