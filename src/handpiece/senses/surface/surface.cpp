// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/surface/surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/senses/surface/brick_state.h"
#include "handpiece/senses/surface/tissue_split.h"
#include "handpiece/senses/surface/triangle_list.h"

namespace handpiece::surface {
namespace {

/// Marks of update().
constexpr std::uint8_t kContour = 1, kEmit = 2;
constexpr std::uint32_t kNoChange = 0xffffffffu;
/// Fewer bricks than this are done before other threads would have woken.
constexpr std::size_t kWorthThreads = 48;

/// Calls body(i) for every i below `count`.
template <class Body>
void forEach(std::size_t count, const Body& body) {
    if (count < kWorthThreads) {
        for (std::size_t i = 0; i < count; ++i)
            body(i);
        return;
    }
    core::parallelFor(count, 8, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            body(i);
    });
}

}  // namespace

Surface::Surface(const BrickSource& source, const field::TissueMap* tissues)
    : source_(source),
      tissues_(tissues),
      bricks_(source.grid().count()),
      levels_(source.grid().count(), 0),
      marks_(source.grid().count(), 0),
      changeAt_(source.grid().count(), kNoChange),
      seen_(source.grid().count()) {}

Surface::~Surface() = default;

void Surface::label(std::uint32_t dense, std::span<SheetVertex> vertices) const {
    if (tissues_ == nullptr) return;
    const cases::Tissue whole = tissues_->ofBrick(dense);
    for (SheetVertex& v : vertices)
        if (v.tissue == cases::Tissue::none)
            v.tissue = whole != cases::Tissue::none ? whole
                                                    : tissues_->at({v.positionMm[0], v.positionMm[1], v.positionMm[2]});
}

/// Which nodes of a brick are others than when it was touched before.
struct Surface::Change {
    NodeMask nodes{};
    bool isAny = false, hasTurned = false;  ///< hasTurned: a node has come in or gone out
};

Surface::Change Surface::changeOf(std::uint32_t dense) {
    Change change;
    std::array<float, field::kBrickValues> scratch;
    const float* now = source_.values(dense, scratch.data());
    auto& seen = seen_[dense];
    if (seen == nullptr) {
        seen = std::make_unique<std::array<float, field::kBrickValues>>();
        change.nodes.fill(0x1ff);
        change.isAny = change.hasTurned = true;
    } else {
        if (std::memcmp(seen->data(), now, sizeof(*seen)) == 0) return change;
        std::array<bool, field::kBrickValues> differs;
        std::uint32_t flipped = 0;
        for (std::size_t node = 0; node < differs.size(); ++node) {
            const auto from = std::bit_cast<std::uint32_t>((*seen)[node]), to = std::bit_cast<std::uint32_t>(now[node]);
            differs[node] = from != to;
            flipped |= from ^ to;
        }
        change.nodes = maskOf(differs);
        change.isAny = true;
        change.hasTurned = flipped >> 31 != 0;
    }
    std::copy(now, now + field::kBrickValues, seen->begin());
    return change;
}

std::uint8_t Surface::contour(std::uint32_t dense, const CellMask* dirty) {
    static thread_local BrickContour fresh;
    std::unique_ptr<BrickState>& brick = bricks_[dense];
    const bool was = brick != nullptr;
    constexpr std::uint8_t kAll = 0xff;
    if ((!was && !source_.mayHoldSurface(dense)) ||
        !contourBrick(source_, dense, fresh, was && dirty != nullptr ? &brick->contour : nullptr, dirty)) {
        brick.reset();
        return was ? kAll : 0;
    }
    label(dense, fresh.vertices);
    const bool isCoarse = was && (brick->level != 0 || levels_[dense] != 0);
    std::uint8_t seen = was && brick->level == levels_[dense] ? whoSees(brick->contour, fresh) : kAll;
    if (seen != 0 && isCoarse) seen = kAll;
    if (!was) brick = std::make_unique<BrickState>();
    std::swap(brick->contour, fresh);
    if (seen != 0) coarsen(*brick, dense);
    return seen;
}

/// One vertex for all in a block of cells: the mean of those on an edge of the solid, or of all when none is.
void Surface::coarsen(BrickState& brick, std::uint32_t dense) const {
    brick.level = levels_[dense];
    brick.coarse.clear();
    brick.coarseOf.clear();
    if (brick.level == 0) return;
    struct Block {
        std::array<double, 3> sum[2], normal;
        int count[2];
    };
    std::array<Block, 64> blocks{};
    std::array<std::uint16_t, 64> place;
    const int shift = brick.level, side = 8 >> shift;
    const auto blockOf = [&](const SheetVertex& v) {
        const int x = (v.cell & 7) >> shift, y = (v.cell >> 3 & 7) >> shift, z = (v.cell >> 6) >> shift;
        return static_cast<std::size_t>(x + side * (y + side * z));
    };
    for (const SheetVertex& v : brick.contour.vertices) {
        Block& block = blocks[blockOf(v)];
        for (std::size_t k = 0; k < 3; ++k) {
            block.sum[v.isSharp ? 1 : 0][k] += v.positionMm[k];
            block.normal[k] += v.normal[k];
        }
        ++block.count[v.isSharp ? 1 : 0];
    }
    for (std::size_t i = 0; i < 64; ++i) {
        const Block& block = blocks[i];
        if (block.count[0] + block.count[1] == 0) continue;
        const int which = block.count[1] > 0 ? 1 : 0;
        SheetVertex v;
        const auto& n = block.normal;
        const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (std::size_t k = 0; k < 3; ++k) {
            v.positionMm[k] = static_cast<float>(block.sum[which][k] / block.count[which]);
            v.normal[k] = length > 0.0 ? static_cast<float>(n[k] / length) : 0.0f;
        }
        v.isSharp = which == 1 || length == 0.0;
        place[i] = static_cast<std::uint16_t>(brick.coarse.size());
        brick.coarse.push_back(v);
    }
    for (const SheetVertex& v : brick.contour.vertices)
        brick.coarseOf.push_back(place[blockOf(v)]);
    label(dense, brick.coarse);
}

std::shared_ptr<const BrickMesh> Surface::makeMesh(std::uint32_t dense) {
    static thread_local TriangleList list;
    static thread_local TissueSplitter splitter;
    const LowNeighbours low = lowNeighbours(grid(), bricks_, dense);
    list.fill(grid(), dense, low, false);
    bricks_[dense]->uses = list.uses();
    return splitter.mesh(list, low, tissues_);
}

void Surface::build(const core::Progress& progress) {
    buildUpTo(2, progress);
}

/// One round finds the vertices, a second makes the meshes: triangles need the vertices of neighbours.
void Surface::buildUpTo(std::size_t rounds, const core::Progress& progress) {
    std::vector<std::uint32_t> bricks;
    for (std::uint32_t dense = 0; dense < bricks_.size(); ++dense) {
        bricks_[dense].reset();
        seen_[dense].reset();
        if (source_.mayHoldSurface(dense)) bricks.push_back(dense);
    }
    levelsSet_.clear();
    core::report(progress, 0.0);
    constexpr std::size_t kSteps = 16;
    for (std::size_t step = 0; step < rounds * kSteps; ++step) {
        const std::size_t part = step % kSteps, begin = bricks.size() * part / kSteps,
                          end = bricks.size() * (part + 1) / kSteps;
        core::parallelFor(end - begin, 8, [&](std::size_t from, std::size_t to) {
            for (std::size_t i = begin + from; i < begin + to; ++i) {
                const std::uint32_t dense = bricks[i];
                if (step < kSteps)
                    contour(dense, nullptr);
                else if (bricks_[dense] != nullptr)
                    bricks_[dense]->mesh = makeMesh(dense);
            }
        });
        core::report(progress, static_cast<double>(step + 1) / static_cast<double>(rounds * kSteps));
    }
}

std::vector<std::uint32_t> Surface::update(std::span<const std::uint32_t> touched) {
    std::vector<std::uint32_t> contours, emits, changed;
    const auto beside = [&](std::uint32_t dense, std::size_t side) {
        int step[3] = {0, 0, 0};
        step[side / 2] = (side & 1) != 0 ? 1 : -1;
        return grid().neighbour(dense, step[0], step[1], step[2]);
    };
    const auto mark = [&](std::uint32_t dense, std::uint8_t bit, std::vector<std::uint32_t>& list) {
        if ((marks_[dense] & bit) != 0) return;
        marks_[dense] |= bit;
        list.push_back(dense);
    };
    std::vector<Change> changes;
    for (const std::uint32_t dense : touched) {
        if (changeAt_[dense] != kNoChange) continue;
        const Change change = changeOf(dense);
        if (!change.isAny) continue;
        changeAt_[dense] = static_cast<std::uint32_t>(changes.size());
        changes.push_back(change);
        mark(dense, kContour, contours);
        for (std::size_t side = 0; side < 6; ++side) {
            const std::int64_t other = beside(dense, side);
            if (other < 0) continue;
            const BrickState* brick = bricks_[static_cast<std::size_t>(other)].get();
            // From there this brick lies on the opposite side.
            if (brick != nullptr && (brick->contour.reach >> (side ^ 1) & 1) != 0)
                mark(static_cast<std::uint32_t>(other), kContour, contours);
        }
    }
    for (const std::uint32_t dense : levelsSet_)
        if (bricks_[dense] != nullptr && bricks_[dense]->level != levels_[dense]) mark(dense, kContour, contours);
    levelsSet_.clear();
    std::sort(contours.begin(), contours.end());
    std::vector<std::uint8_t> seen(contours.size());
    const auto changeIn = [&](std::int64_t dense) -> const Change* {
        const std::uint32_t at = dense < 0 ? kNoChange : changeAt_[static_cast<std::size_t>(dense)];
        return at == kNoChange ? nullptr : &changes[at];
    };
    forEach(contours.size(), [&](std::size_t i) {
        const std::uint32_t dense = contours[i];
        const BrickState* brick = bricks_[dense].get();
        const Change* own = changeIn(dense);
        std::array<const NodeMask*, 6> around{};
        for (std::size_t side = 0; side < 6; ++side)
            if (const Change* change = changeIn(beside(dense, side))) around[side] = &change->nodes;
        const CellMask dirty = cellsThatAsk(own != nullptr ? &own->nodes : nullptr, around,
                                            brick != nullptr ? &brick->contour.kinked : nullptr);
        const bool mayMove = brick == nullptr || brick->level != levels_[dense] || (own != nullptr && own->hasTurned) ||
                             hasActive(dirty, brick->contour);
        seen[i] = mayMove ? contour(dense, &dirty) : 0;
    });
    for (const std::uint32_t dense : touched)
        changeAt_[dense] = kNoChange;
    for (std::size_t i = 0; i < contours.size(); ++i) {
        marks_[contours[i]] &= static_cast<std::uint8_t>(~kContour);
        if (seen[i] == 0) continue;
        mark(contours[i], kEmit, emits);
        for (int slot = 1; slot < 8; ++slot) {
            if ((seen[i] >> slot & 1) == 0) continue;
            const std::int64_t other = grid().neighbour(contours[i], slot & 1, slot >> 1 & 1, slot >> 2);
            if (other < 0) continue;
            const BrickState* brick = bricks_[static_cast<std::size_t>(other)].get();
            if (brick != nullptr && (brick->uses >> slot & 1) != 0)
                mark(static_cast<std::uint32_t>(other), kEmit, emits);
        }
    }
    std::sort(emits.begin(), emits.end());
    std::vector<std::uint8_t> isChanged(emits.size(), 1);
    forEach(emits.size(), [&](std::size_t i) {
        BrickState* brick = bricks_[emits[i]].get();
        if (brick == nullptr) return;
        std::shared_ptr<const BrickMesh> fresh = makeMesh(emits[i]);
        isChanged[i] = (fresh == nullptr) != (brick->mesh == nullptr) || (fresh != nullptr && *fresh != *brick->mesh);
        brick->mesh = std::move(fresh);
    });
    for (std::size_t i = 0; i < emits.size(); ++i) {
        marks_[emits[i]] = 0;
        if (isChanged[i] != 0) changed.push_back(emits[i]);
    }
    return changed;
}

void Surface::setLevel(std::uint32_t dense, int level) {
    if (level < 0 || level > kMaxLevel)
        throw core::Error("a brick of the surface has no such level of detail", fmt::format("level {}", level),
                          fmt::format("take 0 to {}", kMaxLevel));
    if (levels_[dense] == level) return;
    levels_[dense] = static_cast<std::uint8_t>(level);
    levelsSet_.push_back(dense);
}

std::shared_ptr<const BrickMesh> Surface::mesh(std::uint32_t dense) const {
    return bricks_[dense] != nullptr ? bricks_[dense]->mesh : nullptr;
}

std::vector<std::shared_ptr<const BrickMesh>> Surface::meshes() const {
    std::vector<std::shared_ptr<const BrickMesh>> all;
    for (const auto& brick : bricks_)
        if (brick != nullptr && brick->mesh != nullptr) all.push_back(brick->mesh);
    return all;
}

}  // namespace handpiece::surface
