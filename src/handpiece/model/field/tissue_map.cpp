// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/field/tissue_map.h"

#include "handpiece/model/field/distance_field.h"

namespace handpiece::field {

using core::Vec3;

TissueMap::TissueMap(const DistanceField& grid) {
    const FieldView view = grid.view();
    for (int k = 0; k < 3; ++k) {
        originMm_[k] = view.originMm[k];
        bricks_[k] = view.bricks[k];
    }
    voxelMm_ = view.voxelMm;
    unitMm_ = voxelMm_ / kUnitsAVoxel;
}

TissueMap TissueMap::uniform(const DistanceField& grid, cases::Tissue tissue) {
    TissueMap map(grid);
    const FieldStorage& s = grid.storage();
    auto nodes = std::make_shared<BrickTissues>(s.coarse.size());
    for (std::size_t i = 0; i < s.coarse.size(); ++i)
        if (s.brickIndex[i] >= 0 || s.coarse[i] < 0.0f) nodes->setUniform(i, static_cast<std::uint8_t>(tissue));
    map.nodes_ = std::move(nodes);
    return map;
}

bool TissueMap::isOn(const DistanceField& grid) const noexcept {
    const FieldView view = grid.view();
    for (int k = 0; k < 3; ++k)
        if (view.bricks[k] != bricks_[k] || view.originMm[k] != originMm_[k]) return false;
    return view.voxelMm == voxelMm_;
}

TissueMap::Layers TissueMap::layers(std::uint32_t dense) const noexcept {
    if (!nodes_->isMixed(dense)) return {{}, ofBrick(dense)};
    const LayerRange& range = ranges_[(nodes_->start[dense] - BrickTissues::kShared) / kBrickValues];
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

}  // namespace handpiece::field
