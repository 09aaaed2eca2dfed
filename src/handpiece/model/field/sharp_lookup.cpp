// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/field/sharp_lookup.h"

#include <algorithm>
#include <bit>

namespace handpiece::field {

using core::Vec3;

namespace {

std::size_t slotOf(const std::int32_t (&cell)[3]) noexcept {
    return static_cast<std::size_t>((cell[0] & 1) | (cell[1] & 1) << 1 | (cell[2] & 1) << 2);
}

}  // namespace

SharpLookup::SharpLookup(const DistanceField& field, core::SimdLevel level)
    : field_(field),
      view_(field.view()),
      kernels_(HANDPIECE_AT_SIMD_LEVEL(level, sharpKernels)()),
      farOutMm_(static_cast<float>(field.reach().outMm)),
      farInMm_(static_cast<float>(field.reach().inMm)) {}

void SharpLookup::locate(std::span<const Vec3> places) noexcept {
    if (version_ != field_.version()) {
        version_ = field_.version();
        for (Cell& cell : cells_)
            std::fill(cell.at, cell.at + 3, -1);
    }
    for (std::size_t i = 0; i < places.size(); ++i)
        for (int k = 0; k < 3; ++k)
            places_.mm[k][i] = places[i][k];
    kernels_.locate(view_, places_);
}

const SharpBlock* SharpLookup::blockAt(const std::int32_t (&cell)[3]) noexcept {
    Cell& kept = cells_[slotOf(cell)];
    if (std::equal(cell, cell + 3, kept.at)) return &kept.block;
    if (view_.brickIndex[brickOf(cell)] < 0) return nullptr;
    std::copy_n(cell, 3, kept.at);
    kernels_.gather(view_, cell, farOutMm_, farInMm_, kept.block);
    return &kept.block;
}

void SharpLookup::distances(std::span<const Vec3> places, std::span<double> out) noexcept {
    locate(places);
    // Places far from one another may want the same slot: they take turns.
    for (unsigned left = (1u << places.size()) - 1; left != 0;) {
        std::fill(std::begin(places_.block), std::end(places_.block), nullptr);
        unsigned now = 0, taken = 0;
        for (std::size_t i = 0; i < places.size(); ++i) {
            if ((left >> i & 1u) == 0) continue;
            const std::int32_t cell[3] = {places_.cell[0][i], places_.cell[1][i], places_.cell[2][i]};
            const std::size_t slot = slotOf(cell);
            if ((taken >> slot & 1u) != 0 && !std::equal(cell, cell + 3, cells_[slot].at)) continue;
            left &= ~(1u << i);
            places_.block[i] = places_.isInGrid[i] != 0 ? blockAt(cell) : nullptr;
            if (places_.block[i] != nullptr) {
                taken |= 1u << slot;
                now |= 1u << i;
            } else {
                out[i] = field_.distance(places[i]);
            }
        }
        float found[kSharpPlaces];
        if (now != 0) kernels_.at(places_, found);
        for (; now != 0; now &= now - 1) {
            const int i = std::countr_zero(now);
            out[static_cast<std::size_t>(i)] = static_cast<double>(found[i]);
        }
    }
}

double SharpLookup::distance(const Vec3& p) noexcept {
    double d = 0.0;
    distances({&p, 1}, {&d, 1});
    return d;
}

double SharpLookup::distanceOnce(const Vec3& p) const noexcept {
    std::int32_t cell[3];
    float t[3];
    for (int k = 0; k < 3; ++k) {
        const double g = (p[k] - view_.originMm[k]) * view_.inverseVoxelMm;
        const std::int32_t last = kBrickCells * view_.bricks[k];
        if (!(g >= 0.0 && g <= last)) return field_.distance(p);
        cell[k] = std::min(static_cast<std::int32_t>(g), last - 1);
        t[k] = static_cast<float>(g - cell[k]);
    }
    return view_.brickIndex[brickOf(cell)] < 0
               ? field_.distance(p)
               : static_cast<double>(kernels_.once(view_, cell, t, farOutMm_, farInMm_));
}

std::int64_t SharpLookup::brickOf(const std::int32_t (&cell)[3]) const noexcept {
    return cell[0] / kBrickCells +
           static_cast<std::int64_t>(view_.bricks[0]) *
               (cell[1] / kBrickCells + static_cast<std::int64_t>(view_.bricks[1]) * (cell[2] / kBrickCells));
}

const SharpBlock* SharpLookup::firstBlock(const Vec3& p) noexcept {
    locate({&p, 1});
    return places_.isInGrid[0] != 0 ? blockAt({places_.cell[0][0], places_.cell[1][0], places_.cell[2][0]}) : nullptr;
}

bool SharpLookup::wallAt(const Vec3& p, Wall& wall) noexcept {
    const SharpBlock* block = firstBlock(p);
    if (block == nullptr || !block->isSmooth) return false;
    SharpJet jet;
    kernels_.jet(*block, {places_.t[0][0], places_.t[1][0], places_.t[2][0]}, jet);
    wall.distanceMm = static_cast<double>(jet.value);
    const double perMm = view_.inverseVoxelMm;
    for (int k = 0; k < 3; ++k)
        wall.slope[k] = perMm * static_cast<double>(jet.slope[k]);
    const float bend[3][3] = {{jet.xx, jet.xy, jet.xz}, {jet.xy, jet.yy, jet.yz}, {jet.xz, jet.yz, jet.zz}};
    for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l)
            wall.bendPerMm(k, l) = perMm * perMm * static_cast<double>(bend[k][l]);
    return true;
}

Vec3 SharpLookup::normal(const Vec3& p) noexcept {
    const SharpBlock* block = firstBlock(p);
    if (block == nullptr) return Vec3::Zero();
    Vec3 slope;
    if (block->isSmooth) {
        SharpJet jet;
        kernels_.jet(*block, {places_.t[0][0], places_.t[1][0], places_.t[2][0]}, jet);
        for (int k = 0; k < 3; ++k)
            slope[k] = static_cast<double>(jet.slope[k]);
    } else {
        // By differences in the cell: two places along each axis.
        constexpr float kStep = 0.1f;
        const float t[3] = {places_.t[0][0], places_.t[1][0], places_.t[2][0]};
        std::fill(std::begin(places_.block), std::end(places_.block), nullptr);
        for (int i = 0; i < 6; ++i) {
            places_.block[i] = block;
            for (int k = 0; k < 3; ++k)
                places_.t[k][i] = t[k];
            const float to = i % 2 == 0 ? std::max(0.0f, t[i / 2] - kStep) : std::min(1.0f, t[i / 2] + kStep);
            places_.t[i / 2][i] = to;
        }
        float d[kSharpPlaces];
        kernels_.at(places_, d);
        for (int k = 0; k < 3; ++k)
            slope[k] = static_cast<double>((d[2 * k + 1] - d[2 * k]) / (places_.t[k][2 * k + 1] - places_.t[k][2 * k]));
    }
    const double length = slope.norm();
    return length > 0.0 ? Vec3(slope / length) : Vec3::Zero();
}

}  // namespace handpiece::field
