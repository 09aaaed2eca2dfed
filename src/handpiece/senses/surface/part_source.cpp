// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/surface/part_source.h"

#include <algorithm>

#include "handpiece/base/core/parallel.h"

namespace handpiece::surface {

using cases::Tissue;
using field::kBrickNodes;

PartSource::PartSource(const BrickSource& tooth, const field::TissueMap& tissues, Tissue tissue)
    : tooth_(tooth),
      tissues_(tissues),
      tissue_(tissue),
      farMm_(static_cast<float>(127.0 * tissues.unitMm())),
      kinds_(tooth.grid().count()),
      same_(tooth.grid().count()) {
    for (std::uint32_t dense = 0; dense < kinds_.size(); ++dense)
        kinds_[dense] = kindOf(dense);
    core::parallelFor(kinds_.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto dense = static_cast<std::uint32_t>(i);
            same_[i] = kinds_[i] != Kind::mixed ? 1 : 0;
            for (int n = 0; n < 27 && same_[i] != 0; ++n) {
                const std::int64_t other = grid().neighbour(dense, n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
                if (other >= 0 && kinds_[static_cast<std::size_t>(other)] != kinds_[i]) same_[i] = 0;
            }
        }
    });
}

PartSource::Kind PartSource::kindOf(std::uint32_t dense) const {
    const Tissue whole = tissues_.ofBrick(dense);
    if (whole != Tissue::none) return whole == tissue_ ? Kind::all : Kind::other;
    const field::TissueMap::Layers layers = tissues_.layers(dense);
    const bool occurs = layers.rest == tissue_ || std::any_of(layers.layers.begin(), layers.layers.end(),
                                                              [&](const auto& l) { return l.tissue == tissue_; });
    return occurs ? Kind::mixed : Kind::other;
}

bool PartSource::mayHoldSurface(std::uint32_t dense) const {
    if (same_[dense] == 0) return true;
    return kinds_[dense] == Kind::all && tooth_.mayHoldSurface(dense);
}

/// A node on a face has a distance in several bricks: that of the first with a boundary counts, or of the first.
PartSource::Place PartSource::owner(std::uint32_t dense, const std::array<int, 3>& node) const {
    Place place{dense, node};
    std::uint64_t first = ~std::uint64_t{0};
    for (int corner = 0; corner < 8; ++corner) {
        std::array<int, 3> step{}, there = node;
        bool isThere = true;
        for (std::size_t k = 0; k < 3; ++k) {
            if ((corner >> k & 1) == 0) continue;
            isThere = isThere && (node[k] == 0 || node[k] == kBrickNodes - 1);
            step[k] = node[k] == 0 ? -1 : 1;
            there[k] = node[k] == 0 ? kBrickNodes - 1 : 0;
        }
        const std::int64_t brick = isThere ? grid().neighbour(dense, step[0], step[1], step[2]) : -1;
        if (brick < 0) continue;
        const bool isMixed = kinds_[static_cast<std::size_t>(brick)] == Kind::mixed;
        const std::uint64_t rank = (isMixed ? 0 : std::uint64_t{1} << 32) + static_cast<std::uint64_t>(brick);
        if (rank >= first) continue;
        first = rank;
        place = {static_cast<std::uint32_t>(brick), there};
    }
    return place;
}

float PartSource::tissueDistance(const Place& place) const {
    const std::uint32_t dense = place.dense;
    const auto node =
        static_cast<std::size_t>(place.node[0] + kBrickNodes * (place.node[1] + kBrickNodes * place.node[2]));
    if (kinds_[dense] != Kind::mixed) return kinds_[dense] == Kind::all ? -farMm_ : farMm_;
    const field::TissueMap::Layers layers = tissues_.layers(dense);
    // Inside a layer of this tissue and in none that wins over it; the rest is what lies in none.
    int distance = 127, outside = -127;
    for (const field::TissueMap::Layer& layer : layers.layers) {
        const int d = layer.values[node];
        if (layer.tissue == tissue_) distance = std::min(distance, std::max(d, outside));
        outside = std::max(outside, -d);
    }
    if (layers.rest == tissue_) distance = std::min(distance, outside);
    return static_cast<float>(tissues_.unitMm() * distance);
}

const float* PartSource::values(std::uint32_t dense, float* scratch) const {
    const float* solid = tooth_.values(dense, scratch);
    if (same_[dense] != 0 && kinds_[dense] == Kind::all) return solid;
    for (int z = 0; z < kBrickNodes; ++z)
        for (int y = 0; y < kBrickNodes; ++y)
            for (int x = 0; x < kBrickNodes; ++x) {
                const Place place = same_[dense] == 0 ? owner(dense, {x, y, z}) : Place{dense, {x, y, z}};
                const auto node = static_cast<std::size_t>(x + kBrickNodes * (y + kBrickNodes * z));
                scratch[node] = std::max(solid[node], tissueDistance(place));
            }
    return scratch;
}

}  // namespace handpiece::surface
