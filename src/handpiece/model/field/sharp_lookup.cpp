// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/field/sharp_lookup.h"

#include <algorithm>

namespace handpiece::field {

using core::Vec3;

SharpLookup::SharpLookup(const DistanceField& field, core::SimdLevel level)
    : field_(field),
      view_(field.view()),
      kernels_(HANDPIECE_AT_SIMD_LEVEL(level, sharpKernels)()),
      farOutMm_(static_cast<float>(field.reach().outMm)),
      farInMm_(static_cast<float>(field.reach().inMm)) {}

const SharpBlock* SharpLookup::find(const Vec3& p, float (&t)[3]) noexcept {
    std::int32_t first[3];
    for (int k = 0; k < 3; ++k) {
        const double g = (p[k] - view_.originMm[k]) * view_.inverseVoxelMm;
        const std::int32_t last = kBrickCells * view_.bricks[k];
        if (!(g >= 0.0 && g <= last)) return nullptr;
        first[k] = std::min(static_cast<std::int32_t>(g), last - 1);
        t[k] = static_cast<float>(g - first[k]);
    }
    Cell& cell = cells_[static_cast<std::size_t>((first[0] & 1) | (first[1] & 1) << 1 | (first[2] & 1) << 2)];
    const std::uint64_t version = field_.version();
    if (cell.version == version && std::equal(first, first + 3, cell.first)) return &cell.block;
    const std::int64_t brick =
        first[0] / kBrickCells +
        static_cast<std::int64_t>(view_.bricks[0]) *
            (first[1] / kBrickCells + static_cast<std::int64_t>(view_.bricks[1]) * (first[2] / kBrickCells));
    if (view_.brickIndex[brick] < 0) return nullptr;
    cell.version = version;
    std::copy_n(first, 3, cell.first);
    kernels_.gather(view_, first, farOutMm_, farInMm_, cell.block);
    return &cell.block;
}

double SharpLookup::distance(const Vec3& p) noexcept {
    float t[3];
    const SharpBlock* block = find(p, t);
    return block != nullptr ? static_cast<double>(kernels_.at(*block, t)) : field_.distance(p);
}

Vec3 SharpLookup::normal(const Vec3& p) noexcept {
    float t[3];
    const SharpBlock* block = find(p, t);
    if (block == nullptr) return Vec3::Zero();
    constexpr float kStep = 0.1f;
    Vec3 slope;
    for (int k = 0; k < 3; ++k) {
        float before[3] = {t[0], t[1], t[2]}, after[3] = {t[0], t[1], t[2]};
        before[k] = std::max(0.0f, t[k] - kStep);
        after[k] = std::min(1.0f, t[k] + kStep);
        slope[k] =
            static_cast<double>((kernels_.at(*block, after) - kernels_.at(*block, before)) / (after[k] - before[k]));
    }
    const double length = slope.norm();
    return length > 0.0 ? Vec3(slope / length) : Vec3::Zero();
}

}  // namespace handpiece::field
