// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/field/tissue_map.h"

#include "handpiece/model/field/distance_field.h"

namespace handpiece::field {

using core::Vec3;

TissueMap::TissueMap(const DistanceField& grid) {
    const FieldView view = grid.view();
    std::size_t dense = 1;
    for (int k = 0; k < 3; ++k) {
        originMm_[k] = view.originMm[k];
        bricks_[k] = view.bricks[k];
        dense *= static_cast<std::size_t>(view.bricks[k]);
    }
    voxelMm_ = view.voxelMm;
    unitMm_ = voxelMm_ / kUnitsAVoxel;
    uniform_.assign(dense, static_cast<std::uint8_t>(cases::Tissue::none));
    mixed_.assign(dense, -1);
}

TissueMap TissueMap::uniform(const DistanceField& grid, cases::Tissue tissue) {
    TissueMap map(grid);
    std::fill(map.uniform_.begin(), map.uniform_.end(), static_cast<std::uint8_t>(tissue));
    return map;
}

bool TissueMap::isOn(const DistanceField& grid) const noexcept {
    const FieldView view = grid.view();
    for (int k = 0; k < 3; ++k)
        if (view.bricks[k] != bricks_[k] || view.originMm[k] != originMm_[k]) return false;
    return view.voxelMm == voxelMm_;
}

const std::uint8_t* TissueMap::nodes(std::uint32_t dense) const noexcept {
    return mixed_[dense] < 0 ? nullptr : &nodes_[static_cast<std::size_t>(mixed_[dense]) * kBrickValues];
}

TissueMap::Layers TissueMap::layers(std::uint32_t dense) const noexcept {
    if (mixed_[dense] < 0) return {{}, static_cast<cases::Tissue>(uniform_[dense])};
    const LayerRange& range = ranges_[static_cast<std::size_t>(mixed_[dense])];
    return {std::span(layers_).subspan(range.first, range.count), range.rest};
}

cases::Tissue TissueMap::at(const Vec3& p) const noexcept {
    std::int32_t brick[3];
    int cell[3];
    double t[3];
    for (int k = 0; k < 3; ++k) {
        const double u = (p[k] - originMm_[k]) / voxelMm_;
        if (!(u >= 0.0 && u <= kBrickCells * bricks_[k])) return cases::Tissue::none;
        const int whole = std::min(static_cast<int>(u), kBrickCells * bricks_[k] - 1);
        brick[k] = whole / kBrickCells;
        cell[k] = whole % kBrickCells;
        t[k] = u - whole;
    }
    const auto dense = static_cast<std::uint32_t>(brick[0] + bricks_[0] * (brick[1] + bricks_[1] * brick[2]));
    const Layers all = layers(dense);
    const int corner = cell[0] + kBrickNodes * (cell[1] + kBrickNodes * cell[2]);
    for (const Layer& layer : all.layers) {
        double value = 0.0;
        for (int i = 0; i < 8; ++i) {
            const int dx = i & 1, dy = i >> 1 & 1, dz = i >> 2;
            const double weight = (dx ? t[0] : 1.0 - t[0]) * (dy ? t[1] : 1.0 - t[1]) * (dz ? t[2] : 1.0 - t[2]);
            value += weight * layer.values[corner + dx + kBrickNodes * (dy + kBrickNodes * dz)];
        }
        if (value < 0.0) return layer.tissue;
    }
    return all.rest;
}

std::vector<cases::Tissue> TissueMap::tissues() const {
    bool seen[256] = {};
    for (std::size_t i = 0; i < uniform_.size(); ++i)
        if (mixed_[i] < 0) seen[uniform_[i]] = true;
    for (const std::uint8_t tissue : nodes_)
        seen[tissue] = true;
    std::vector<cases::Tissue> found;
    for (std::size_t i = 1; i < cases::kTissueCount; ++i)
        if (seen[i]) found.push_back(static_cast<cases::Tissue>(i));
    return found;
}

}  // namespace handpiece::field
