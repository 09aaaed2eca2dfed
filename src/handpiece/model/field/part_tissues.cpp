// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/field/part_tissues.h"

#include <numeric>

namespace handpiece::field {

using core::Vec3;

struct PartTissues::Block {
    const std::function<Vec3(int, int, int)>& nodeMm;
    int low[3], high[3];  // nodes, both included
};

PartTissues::PartTissues(std::span<const PartSurface> parts) : parts_(parts.rbegin(), parts.rend()) {
    std::stable_sort(parts_.begin(), parts_.end(),
                     [](const PartSurface& a, const PartSurface& b) { return a.priority > b.priority; });
}

int PartTissues::decide(const Vec3& p, double radiusMm, std::span<const std::size_t> candidates,
                        std::vector<std::size_t>* remaining) const {
    // Distances at p hold within the radius give or take that much; a hair more covers their rounding.
    const double slack = radiusMm > 0.0 ? radiusMm + 1e-9 : 0.0;
    std::vector<double> distance(candidates.size());
    double nearest = std::numeric_limits<double>::infinity();
    std::size_t nearestAt = 0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        distance[i] = parts_[candidates[i]].tree->signedDistance(p);
        if (distance[i] < -slack) {
            // Wholly inside this one: whatever has a lower priority is hidden.
            distance.resize(i + 1);
            candidates = candidates.first(i + 1);
            if (i == 0) return static_cast<int>(candidates[0]);
        } else if (distance[i] < nearest) {
            nearest = distance[i];
            nearestAt = i;
        }
    }
    const bool covered = distance.back() < -slack;
    if (slack == 0.0) {
        for (std::size_t i = 0; i < candidates.size(); ++i)
            if (distance[i] < 0.0) return static_cast<int>(candidates[i]);
        return static_cast<int>(candidates[nearestAt]);
    }
    // Outside all by any account, and one of them nearer than the rest can be: or containing, which comes to the same.
    if (!covered) {
        bool alone = true;
        for (std::size_t i = 0; i < candidates.size() && alone; ++i)
            if (i != nearestAt) alone = distance[i] > slack && distance[i] - slack > nearest + slack;
        if (alone) return static_cast<int>(candidates[nearestAt]);
    }
    if (remaining != nullptr) {
        remaining->clear();
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            const bool mayContain = distance[i] <= slack,
                       mayBeNearest = !covered && distance[i] - slack <= nearest + slack;
            if (mayContain || mayBeNearest) remaining->push_back(candidates[i]);
        }
        if (remaining->size() == 1) return static_cast<int>(remaining->front());
    }
    return -1;
}

cases::Tissue PartTissues::at(const Vec3& p) const {
    if (parts_.empty()) return cases::Tissue::enamel;
    if (parts_.size() == 1) return parts_[0].tissue;
    std::vector<std::size_t> all(parts_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return parts_[static_cast<std::size_t>(decide(p, 0.0, all, nullptr))].tissue;
}

void PartTissues::fillBlock(const Block& block, std::span<const std::size_t> candidates, std::uint8_t* tissue) const {
    const Vec3 low = block.nodeMm(block.low[0], block.low[1], block.low[2]);
    const Vec3 high = block.nodeMm(block.high[0], block.high[1], block.high[2]);
    const bool single = block.low[0] == block.high[0] && block.low[1] == block.high[1] && block.low[2] == block.high[2];
    std::vector<std::size_t> remaining;
    const int part = single ? decide(low, 0.0, candidates, nullptr)
                            : decide(0.5 * (low + high), 0.5 * (high - low).norm(), candidates, &remaining);
    if (part >= 0) {
        const auto kind = static_cast<std::uint8_t>(parts_[static_cast<std::size_t>(part)].tissue);
        for (int z = block.low[2]; z <= block.high[2]; ++z)
            for (int y = block.low[1]; y <= block.high[1]; ++y)
                for (int x = block.low[0]; x <= block.high[0]; ++x)
                    tissue[x + kBrickNodes * (y + kBrickNodes * z)] = kind;
        return;
    }
    int middle[3];
    for (int k = 0; k < 3; ++k)
        middle[k] = (block.low[k] + block.high[k]) / 2;
    for (int octant = 0; octant < 8; ++octant) {
        Block part8 = block;
        bool empty = false;
        for (int k = 0; k < 3; ++k) {
            if ((octant >> k & 1) == 0) {
                part8.high[k] = middle[k];
            } else {
                part8.low[k] = middle[k] + 1;
                empty = empty || part8.low[k] > part8.high[k];
            }
        }
        if (!empty) fillBlock(part8, remaining, tissue);
    }
}

void PartTissues::fill(const std::function<Vec3(int, int, int)>& nodeMm, std::uint8_t* tissue) const {
    if (isUniform()) {
        std::fill_n(tissue, kBrickValues,
                    static_cast<std::uint8_t>(parts_.empty() ? cases::Tissue::enamel : parts_[0].tissue));
        return;
    }
    std::vector<std::size_t> all(parts_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    fillBlock({nodeMm, {0, 0, 0}, {kBrickNodes - 1, kBrickNodes - 1, kBrickNodes - 1}}, all, tissue);
}

}  // namespace handpiece::field
