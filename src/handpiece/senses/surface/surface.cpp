// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/surface/surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/senses/surface/brick_state.h"
#include "handpiece/senses/surface/tissue_split.h"
#include "handpiece/senses/surface/triangle_list.h"

namespace handpiece::surface {
namespace {

/// Marks of update().
constexpr std::uint8_t kContour = 1, kEmit = 2;
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

Surface::Surface(const BrickSource& source, const tooth::TissueMap* tissues)
    : source_(source),
      tissues_(tissues),
      bricks_(source.grid().count()),
      levels_(source.grid().count(), 0),
      marks_(source.grid().count(), 0) {}

Surface::~Surface() = default;

void Surface::label(std::uint32_t dense, std::span<SheetVertex> vertices) const {
    if (tissues_ == nullptr) return;
    const tooth::Tissue whole = tissues_->ofBrick(dense);
    for (SheetVertex& v : vertices)
        v.tissue =
            whole != tooth::Tissue::none ? whole : tissues_->at({v.positionMm[0], v.positionMm[1], v.positionMm[2]});
}

bool Surface::contour(std::uint32_t dense) {
    static thread_local BrickContour fresh;
    std::unique_ptr<BrickState>& brick = bricks_[dense];
    const bool was = brick != nullptr;
    if ((!was && !source_.mayHoldSurface(dense)) || !contourBrick(source_, dense, fresh)) {
        brick.reset();
        return was;
    }
    label(dense, fresh.vertices);
    if (was && brick->level == levels_[dense] && fresh.isSame(brick->contour)) return false;
    if (!was) brick = std::make_unique<BrickState>();
    std::swap(brick->contour, fresh);
    coarsen(*brick, dense);
    return true;
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
                    contour(dense);
                else if (bricks_[dense] != nullptr)
                    bricks_[dense]->mesh = makeMesh(dense);
            }
        });
        core::report(progress, static_cast<double>(step + 1) / static_cast<double>(rounds * kSteps));
    }
}

std::vector<std::uint32_t> Surface::update(std::span<const std::uint32_t> touched) {
    std::vector<std::uint32_t> contours, emits, changed;
    const auto mark = [&](std::uint32_t dense, std::uint8_t bit, std::vector<std::uint32_t>& list) {
        if ((marks_[dense] & bit) != 0) return;
        marks_[dense] |= bit;
        list.push_back(dense);
    };
    for (const std::uint32_t dense : touched) {
        mark(dense, kContour, contours);
        for (int side = 0; side < 6; ++side) {
            int step[3] = {0, 0, 0};
            step[side / 2] = (side & 1) != 0 ? 1 : -1;
            const std::int64_t other = grid().neighbour(dense, step[0], step[1], step[2]);
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
    std::vector<std::uint8_t> isChanged(contours.size());
    forEach(contours.size(), [&](std::size_t i) { isChanged[i] = contour(contours[i]) ? 1 : 0; });
    for (std::size_t i = 0; i < contours.size(); ++i) {
        marks_[contours[i]] &= static_cast<std::uint8_t>(~kContour);
        if (isChanged[i] == 0) continue;
        mark(contours[i], kEmit, emits);
        for (int slot = 1; slot < 8; ++slot) {
            const std::int64_t other = grid().neighbour(contours[i], slot & 1, slot >> 1 & 1, slot >> 2);
            if (other < 0) continue;
            const BrickState* brick = bricks_[static_cast<std::size_t>(other)].get();
            if (brick != nullptr && (brick->uses >> slot & 1) != 0)
                mark(static_cast<std::uint32_t>(other), kEmit, emits);
        }
    }
    std::sort(emits.begin(), emits.end());
    isChanged.assign(emits.size(), 1);
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
