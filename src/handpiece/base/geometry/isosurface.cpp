// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/isosurface.h"

#include <fmt/format.h>

#include <algorithm>
#include <bitset>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"

namespace handpiece::geometry {
namespace {
using core::Vec3;

// A cell's corner c lies at (c & 1, c >> 1 & 1, c >> 2). Its twelve edges are numbered 4 axis + k.
struct CellEdge {
    int corner, axis;  ///< from `corner` one step along `axis`
};
constexpr CellEdge kEdges[12] = {{0, 0}, {2, 0}, {4, 0}, {6, 0}, {0, 1}, {1, 1},
                                 {4, 1}, {5, 1}, {0, 2}, {1, 2}, {2, 2}, {3, 2}};
// Corners of the six faces, counter-clockwise from outside the cell.
constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

int edgeBetween(int a, int b) {
    for (int e = 0; e < 12; ++e) {
        const int from = kEdges[e].corner, to = from | (1 << kEdges[e].axis);
        if ((from == a && to == b) || (from == b && to == a)) return e;
    }
    return -1;
}

bool shareFace(int e, int f) {
    for (const auto& face : kFaces) {
        bool hasE = false, hasF = false;
        for (int i = 0; i < 4; ++i) {
            const int g = edgeBetween(face[i], face[(i + 1) % 4]);
            hasE |= g == e;
            hasF |= g == f;
        }
        if (hasE && hasF) return true;
    }
    return false;
}

// Triangles of one cell. A corner below 12 is the vertex on that edge, 12 + k the cell's own k-th centre.
struct CellTriangles {
    std::vector<std::array<std::int8_t, 3>> triangles;
    std::vector<std::vector<std::int8_t>> centres;  ///< the edges whose vertices each centre is the mean of
};

CellTriangles trianglesOf(int inside) {
    // Each run of inside corners around a face gives one piece from the edge where it begins to that where it ends:
    // inside corners of an ambiguous face stay apart, and the cell beyond the face decides the same.
    int next[12];
    std::fill(std::begin(next), std::end(next), -1);
    for (const auto& face : kFaces)
        for (int i = 0; i < 4; ++i) {
            if (!(inside >> face[i] & 1) || inside >> face[(i + 3) % 4] & 1) continue;
            int last = i;
            while (inside >> face[(last + 1) % 4] & 1)
                last = (last + 1) % 4;
            next[edgeBetween(face[(i + 3) % 4], face[i])] = edgeBetween(face[last], face[(last + 1) % 4]);
        }
    CellTriangles result;
    for (int start = 0; start < 12; ++start) {
        if (next[start] < 0) continue;
        std::vector<std::int8_t> loop;
        for (int e = start; next[e] >= 0;) {
            loop.push_back(static_cast<std::int8_t>(e));
            const int following = next[e];
            next[e] = -1;
            e = following;
        }
        const std::size_t n = loop.size();
        // A chord within a face of the cell could meet the same chord from the cell beyond: an edge of four triangles.
        std::size_t apex = n;
        for (std::size_t i = 0; i < n && apex == n; ++i) {
            bool good = true;
            for (std::size_t j = 2; j + 1 < n; ++j)
                good &= !shareFace(loop[i], loop[(i + j) % n]);
            if (good) apex = i;
        }
        if (apex < n) {
            for (std::size_t j = 1; j + 1 < n; ++j)
                result.triangles.push_back({loop[apex], loop[(apex + j) % n], loop[(apex + j + 1) % n]});
        } else {
            const auto centre = static_cast<std::int8_t>(12 + result.centres.size());
            result.centres.push_back(loop);
            for (std::size_t j = 0; j < n; ++j)
                result.triangles.push_back({centre, loop[j], loop[(j + 1) % n]});
        }
    }
    return result;
}

const std::vector<CellTriangles>& cellTable() {
    static const std::vector<CellTriangles> table = [] {
        std::vector<CellTriangles> t;
        for (int inside = 0; inside < 256; ++inside)
            t.push_back(trianglesOf(inside));
        return t;
    }();
    return table;
}

constexpr int kCells = 8, kNodes = kCells + 1;
constexpr int nodeIndex(int x, int y, int z) {
    return x + kNodes * (y + kNodes * z);
}

struct Block {
    std::array<std::int32_t, 3> at{};
    bool isByBound = false;  ///< looked at by the bound, not by the usual slope
    std::bitset<kNodes * kNodes * kNodes> inside;
    std::vector<Vec3> vertices;
    std::vector<std::int16_t> edgeVertex;  ///< 3 per own node; -1 none. Empty when the block has no vertex on an edge
    std::uint32_t edgeVertices = 0;        ///< the centres come after them
    std::uint32_t firstVertex = 0, firstTriangle = 0, triangleCount = 0;

    [[nodiscard]] int configuration(int x, int y, int z) const {
        int bits = 0;
        for (int c = 0; c < 8; ++c)
            bits |= static_cast<int>(inside[nodeIndex(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2))]) << c;
        return bits;
    }
};

class Marcher {
  public:
    Marcher(const core::Box& box, const ScalarFunction& f, const IsosurfaceSettings& settings,
            const core::Progress& progress)
        : f_(f),
          h_(settings.spacingMm),
          lipschitz_(settings.lipschitz),
          usualSlope_(settings.usualSlope > 0.0 ? std::min(settings.usualSlope, lipschitz_) : lipschitz_),
          progress_(progress),
          origin_(box.min) {
        layOut(box);
    }

    /// Over the grid's own nodes and a layer of outside around them: nothing is known of it in between, so every node
    /// is read, but only blocks of both signs are looked into.
    Marcher(const ScalarGrid& grid, const core::Progress& progress)
        : f_(noFunction()),
          h_(grid.spacingMm),
          lipschitz_(0.0),
          usualSlope_(0.0),
          progress_(progress),
          origin_(grid.originMm - Vec3::Constant(grid.spacingMm)),
          grid_(&grid) {
        const Vec3 nodes(grid.nodes[0], grid.nodes[1], grid.nodes[2]);
        layOut({origin_, grid.originMm + h_ * nodes});
        for (const float v : grid.values)
            gridOutside_ = std::max(gridOutside_, std::abs(v));
        if (!(gridOutside_ > 0.0f)) gridOutside_ = 1.0f;
    }

    TriangleMesh run() {
        if (grid_)
            findGridBlocks();
        else
            findBlocks();
        core::report(progress_, 0.1);
        core::parallelFor(active_.size(), 8, [&](std::size_t b, std::size_t e) {
            for (std::size_t i = b; i < e; ++i)
                sample(active_[i]);
        });
        core::report(progress_, 0.5);
        repair();
        TriangleMesh mesh = assemble();
        core::report(progress_, 0.6);
        return mesh;
    }

  private:
    static const ScalarFunction& noFunction() {
        static const ScalarFunction none;
        return none;
    }
    void layOut(const core::Box& box) {
        for (int a = 0; a < 3; ++a) {
            cells_[a] = std::max<std::int64_t>(2, static_cast<std::int64_t>(std::ceil(box.size()[a] / h_ - 1e-9)));
            blocks_[a] = (cells_[a] + kCells - 1) / kCells;
        }
        if (static_cast<double>(blocks_[0]) * static_cast<double>(blocks_[1]) * static_cast<double>(blocks_[2]) > 1e9)
            throw core::Error(fmt::format("a spacing of {} mm is too fine for a box of {:.1f} x {:.1f} x {:.1f} mm", h_,
                                          box.size().x(), box.size().y(), box.size().z()),
                              "isosurface", "choose a coarser spacing");
    }

    [[nodiscard]] Vec3 nodeMm(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return origin_ + h_ * Vec3(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
    }

    // Blocks that the surface may pass: first in groups of 4^3, then one by one.
    void findBlocks() {
        constexpr std::int64_t kGroup = 4;
        std::array<std::int64_t, 3> groups;
        for (int a = 0; a < 3; ++a)
            groups[a] = (blocks_[a] + kGroup - 1) / kGroup;
        const auto total = static_cast<std::size_t>(groups[0] * groups[1] * groups[2]);
        std::vector<std::vector<std::array<std::int32_t, 3>>> found(total);
        const double margin = 1.0 + 1e-9, diagonal = std::sqrt(3.0) * 0.5 * kCells * h_;
        core::parallelFor(total, 4, [&](std::size_t begin, std::size_t end) {
            for (std::size_t g = begin; g < end; ++g) {
                const auto index = static_cast<std::int64_t>(g);
                const std::int64_t first[3] = {index % groups[0] * kGroup, index / groups[0] % groups[1] * kGroup,
                                               index / (groups[0] * groups[1]) * kGroup};
                const double reach = usualSlope_ * kGroup * diagonal * margin;
                const std::int64_t half = kGroup * kCells / 2;
                if (!(std::abs(f_(nodeMm(first[0] * kCells + half, first[1] * kCells + half,
                                         first[2] * kCells + half))) <= reach) &&
                    !touchesBorder(first, kGroup))
                    continue;
                for (std::int64_t z = first[2]; z < std::min(first[2] + kGroup, blocks_[2]); ++z)
                    for (std::int64_t y = first[1]; y < std::min(first[1] + kGroup, blocks_[1]); ++y)
                        for (std::int64_t x = first[0]; x < std::min(first[0] + kGroup, blocks_[0]); ++x) {
                            const std::int64_t at[3] = {x, y, z};
                            const double value =
                                f_(nodeMm(x * kCells + kCells / 2, y * kCells + kCells / 2, z * kCells + kCells / 2));
                            // At the border the solid may be cut off: nodes are outside there by decree.
                            const bool cut = touchesBorder(at, 1) && !(value > usualSlope_ * diagonal * margin);
                            if (cut || !(std::abs(value) > usualSlope_ * diagonal * margin))
                                found[g].push_back({static_cast<std::int32_t>(x), static_cast<std::int32_t>(y),
                                                    static_cast<std::int32_t>(z)});
                        }
            }
        });
        takeBlocks(found);
    }

    // The same order of blocks as findBlocks: groups of 4^3.
    void findGridBlocks() {
        constexpr std::int64_t kGroup = 4;
        std::array<std::int64_t, 3> groups;
        for (int a = 0; a < 3; ++a)
            groups[a] = (blocks_[a] + kGroup - 1) / kGroup;
        const auto total = static_cast<std::size_t>(groups[0] * groups[1] * groups[2]);
        std::vector<std::vector<std::array<std::int32_t, 3>>> found(total);
        core::parallelFor(total, 4, [&](std::size_t begin, std::size_t end) {
            for (std::size_t g = begin; g < end; ++g) {
                const auto index = static_cast<std::int64_t>(g);
                const std::int64_t first[3] = {index % groups[0] * kGroup, index / groups[0] % groups[1] * kGroup,
                                               index / (groups[0] * groups[1]) * kGroup};
                for (std::int64_t z = first[2]; z < std::min(first[2] + kGroup, blocks_[2]); ++z)
                    for (std::int64_t y = first[1]; y < std::min(first[1] + kGroup, blocks_[1]); ++y)
                        for (std::int64_t x = first[0]; x < std::min(first[0] + kGroup, blocks_[0]); ++x)
                            if (hasBothSigns(x * kCells, y * kCells, z * kCells))
                                found[g].push_back({static_cast<std::int32_t>(x), static_cast<std::int32_t>(y),
                                                    static_cast<std::int32_t>(z)});
            }
        });
        takeBlocks(found);
    }

    /// Of the block whose first node this is; what lies around the grid is outside.
    [[nodiscard]] bool hasBothSigns(std::int64_t x0, std::int64_t y0, std::int64_t z0) const {
        const std::int64_t nx = grid_->nodes[0], ny = grid_->nodes[1], nz = grid_->nodes[2];
        bool outside = x0 == 0 || y0 == 0 || z0 == 0 || x0 + kCells > nx || y0 + kCells > ny || z0 + kCells > nz;
        bool inside = false;
        for (std::int64_t z = std::max<std::int64_t>(z0, 1); z <= std::min(z0 + kCells, nz); ++z)
            for (std::int64_t y = std::max<std::int64_t>(y0, 1); y <= std::min(y0 + kCells, ny); ++y) {
                const float* row = &grid_->values[static_cast<std::size_t>(nx * (y - 1 + ny * (z - 1)))];
                for (std::int64_t x = std::max<std::int64_t>(x0, 1); x <= std::min(x0 + kCells, nx); ++x) {
                    const bool in = row[x - 1] < 0.0f;
                    inside |= in;
                    outside |= !in;
                }
                if (inside && outside) return true;
            }
        return false;
    }

    void takeBlocks(const std::vector<std::vector<std::array<std::int32_t, 3>>>& found) {
        blockAt_.assign(static_cast<std::size_t>(blocks_[0] * blocks_[1] * blocks_[2]), -1);
        for (const auto& list : found)
            for (const auto& at : list) {
                blockAt_[denseIndex(at[0], at[1], at[2])] = static_cast<std::int32_t>(active_.size());
                active_.emplace_back().at = at;
            }
    }

    bool touchesBorder(const std::int64_t* first, std::int64_t count) const {
        for (int a = 0; a < 3; ++a)
            if (first[a] == 0 || first[a] + count >= blocks_[a]) return true;
        return false;
    }
    [[nodiscard]] std::size_t denseIndex(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return static_cast<std::size_t>(x + blocks_[0] * (y + blocks_[1] * z));
    }

    // Values on the nodes, coarse to fine: where a coarser value proves that no edge of a node can cross, its sign is
    // enough and f is not asked.
    void evaluate(const Block& block, double* values) const {
        std::bitset<kNodes * kNodes * kNodes> isGuess;
        if (grid_) {
            for (int z = 0; z < kNodes; ++z)
                for (int y = 0; y < kNodes; ++y)
                    for (int x = 0; x < kNodes; ++x)
                        *values++ = gridValue(block.at[0] * kCells + x - 1, block.at[1] * kCells + y - 1,
                                              block.at[2] * kCells + z - 1);
            return;
        }
        const double slope = block.isByBound ? lipschitz_ : usualSlope_;
        for (int stride = kCells; stride >= 1; stride /= 2)
            for (int z = 0; z < kNodes; z += stride)
                for (int y = 0; y < kNodes; y += stride)
                    for (int x = 0; x < kNodes; x += stride) {
                        const int coarse = 2 * stride - 1;
                        if (stride < kCells && !((x | y | z) & coarse)) continue;
                        double& value = values[nodeIndex(x, y, z)];
                        if (stride < kCells && stride <= 2) {
                            const int below = nodeIndex(x & ~coarse, y & ~coarse, z & ~coarse);
                            const int above =
                                nodeIndex((x + coarse) & ~coarse, (y + coarse) & ~coarse, (z + coarse) & ~coarse);
                            const double v =
                                std::abs(values[below]) > std::abs(values[above]) ? values[below] : values[above];
                            const double odd = ((x & coarse) != 0) + ((y & coarse) != 0) + ((z & coarse) != 0);
                            const double left = std::abs(v) - slope * h_ * stride * std::sqrt(odd);
                            if (left > 1.01 * slope * h_) {
                                value = v > 0.0 ? left : -left;
                                isGuess[static_cast<std::size_t>(nodeIndex(x, y, z))] = true;
                                continue;
                            }
                        }
                        value = valueAt(block, x, y, z);
                    }
        if (isGuess.any()) followSurface(block, values, isGuess);
    }

    [[nodiscard]] double valueAt(const Block& block, int x, int y, int z) const {
        return f_(nodeMm(block.at[0] * kCells + x, block.at[1] * kCells + y, block.at[2] * kCells + z));
    }

    /// Asks wherever the sign changes next to a guess, until it does so nowhere.
    void followSurface(const Block& block, double* values, std::bitset<kNodes * kNodes * kNodes>& isGuess) const {
        const int step[3] = {1, kNodes, kNodes * kNodes};
        for (bool changed = true; changed;) {
            changed = false;
            for (int z = 0; z < kNodes; ++z)
                for (int y = 0; y < kNodes; ++y)
                    for (int x = 0; x < kNodes; ++x) {
                        const int at[3] = {x, y, z}, n = nodeIndex(x, y, z);
                        for (int axis = 0; axis < 3; ++axis) {
                            if (at[axis] == kCells) continue;
                            const int m = n + step[axis];
                            if ((values[n] < 0.0) == (values[m] < 0.0)) continue;
                            for (const int node : {n, m})
                                if (isGuess[static_cast<std::size_t>(node)]) {
                                    isGuess[static_cast<std::size_t>(node)] = false;
                                    values[node] =
                                        valueAt(block, node % kNodes, node / kNodes % kNodes, node / (kNodes * kNodes));
                                    changed = true;
                                }
                        }
                    }
        }
    }

    /// Where blocks disagree on nodes they share they are asked again by the bound, and where the surface passes into a
    /// block that was not looked at, that one is.
    void repair() {
        for (;;) {
            std::vector<std::size_t> again;
            std::vector<std::array<std::int32_t, 3>> missed;
            for (std::size_t i = 0; i < active_.size(); ++i)
                for (int axis = 0; axis < 3; ++axis)
                    for (const int side : {0, 1}) {
                        std::array<std::int32_t, 3> at = active_[i].at;
                        at[axis] += side == 1 ? 1 : -1;
                        if (at[axis] < 0 || at[axis] >= blocks_[axis]) continue;
                        const std::int32_t beyond = blockAt_[denseIndex(at[0], at[1], at[2])];
                        if (beyond < 0 && !isFaceAlike(active_[i], axis, side))
                            missed.push_back(at);
                        else if (beyond >= 0 && side == 1 &&
                                 !agree(active_[i], active_[static_cast<std::size_t>(beyond)], axis))
                            again.insert(again.end(), {i, static_cast<std::size_t>(beyond)});
                    }
            if (again.empty() && missed.empty()) return;
            if (usualSlope_ >= lipschitz_) throw tooSteep();
            std::sort(again.begin(), again.end());
            again.erase(std::unique(again.begin(), again.end()), again.end());
            again.erase(std::remove_if(again.begin(), again.end(), [&](std::size_t i) { return active_[i].isByBound; }),
                        again.end());
            for (const auto& at : missed)
                if (std::int32_t& index = blockAt_[denseIndex(at[0], at[1], at[2])]; index < 0) {
                    index = static_cast<std::int32_t>(active_.size());
                    again.push_back(active_.size());
                    active_.emplace_back().at = at;
                }
            if (again.empty()) throw tooSteep();
            // Marked first: the work below is left out where the tasks around it were cancelled.
            for (const std::size_t i : again) {
                Block asked;
                asked.at = active_[i].at, asked.isByBound = true;
                active_[i] = std::move(asked);
            }
            core::parallelFor(again.size(), 8, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i)
                    sample(active_[again[i]]);
            });
        }
    }

    static int faceNode(int axis, int side, int u, int v) {
        int node[3];
        node[axis] = side * kCells, node[(axis + 1) % 3] = u, node[(axis + 2) % 3] = v;
        return nodeIndex(node[0], node[1], node[2]);
    }
    static bool isFaceAlike(const Block& block, int axis, int side) {
        for (int u = 0; u < kNodes; ++u)
            for (int v = 0; v < kNodes; ++v)
                if (block.inside[faceNode(axis, side, u, v)] != block.inside[faceNode(axis, side, 0, 0)]) return false;
        return true;
    }
    static bool agree(const Block& block, const Block& next, int axis) {
        for (int u = 0; u < kNodes; ++u)
            for (int v = 0; v < kNodes; ++v)
                if (block.inside[faceNode(axis, 1, u, v)] != next.inside[faceNode(axis, 0, u, v)]) return false;
        return true;
    }

    static core::Error tooSteep() {
        return core::Error("the function changes faster than its Lipschitz bound allows", "isosurface",
                           "give a larger bound");
    }

    [[nodiscard]] double gridValue(std::int64_t x, std::int64_t y, std::int64_t z) const {
        const auto& n = grid_->nodes;
        if (x < 0 || y < 0 || z < 0 || x >= n[0] || y >= n[1] || z >= n[2]) return gridOutside_;
        return grid_->values[static_cast<std::size_t>(x + n[0] * (y + std::int64_t{n[1]} * z))];
    }

    void sample(Block& block) const {
        double values[kNodes * kNodes * kNodes];
        evaluate(block, values);
        for (int z = 0; z < kNodes; ++z)
            for (int y = 0; y < kNodes; ++y)
                for (int x = 0; x < kNodes; ++x) {
                    const std::int64_t at[3] = {block.at[0] * kCells + x, block.at[1] * kCells + y,
                                                block.at[2] * kCells + z};
                    double& value = values[nodeIndex(x, y, z)];
                    for (int a = 0; a < 3; ++a)
                        if ((at[a] <= 0 || at[a] >= cells_[a]) && !(value > 0.0))
                            value = std::max(1e-3 * h_, std::abs(value));
                    block.inside[static_cast<std::size_t>(nodeIndex(x, y, z))] = value < 0.0;
                }
        if (block.inside.none() || block.inside.all()) return;
        block.edgeVertex.assign(3 * kCells * kCells * kCells, -1);
        const int step[3] = {1, kNodes, kNodes * kNodes};
        for (int z = 0; z < kCells; ++z)
            for (int y = 0; y < kCells; ++y)
                for (int x = 0; x < kCells; ++x)
                    for (int axis = 0; axis < 3; ++axis) {
                        const int n = nodeIndex(x, y, z), m = n + step[axis];
                        if (block.inside[n] == block.inside[m]) continue;
                        block.edgeVertex[ownEdge(x, y, z, axis)] = static_cast<std::int16_t>(block.vertices.size());
                        const double t = std::clamp(values[n] / (values[n] - values[m]), 0.05, 0.95);
                        Vec3 p = nodeMm(block.at[0] * kCells + x, block.at[1] * kCells + y, block.at[2] * kCells + z);
                        p[axis] += t * h_;
                        block.vertices.push_back(p);
                    }
        block.edgeVertices = static_cast<std::uint32_t>(block.vertices.size());
        const auto& table = cellTable();
        std::uint32_t centres = 0;
        forEachCell(block, [&](int, int, int, int configuration) {
            block.triangleCount += static_cast<std::uint32_t>(table[configuration].triangles.size());
            centres += static_cast<std::uint32_t>(table[configuration].centres.size());
        });
        block.vertices.resize(block.vertices.size() + centres, Vec3::Zero());
    }

    static std::size_t ownEdge(int x, int y, int z, int axis) {
        return static_cast<std::size_t>(3 * (x + kCells * (y + kCells * z)) + axis);
    }
    template <class Visit>
    void forEachCell(const Block& block, const Visit& visit) const {
        for (int z = 0; z < kCells; ++z)
            for (int y = 0; y < kCells; ++y)
                for (int x = 0; x < kCells; ++x) {
                    const int configuration = block.configuration(x, y, z);
                    if (configuration == 0 || configuration == 255) continue;
                    visit(x, y, z, configuration);
                }
    }

    TriangleMesh assemble() {
        std::uint64_t vertices = 0, triangles = 0;
        for (Block& block : active_) {
            block.firstVertex = static_cast<std::uint32_t>(vertices);
            block.firstTriangle = static_cast<std::uint32_t>(triangles);
            vertices += block.vertices.size();
            triangles += block.triangleCount;
        }
        if (triangles > 0x7fffffffu)
            throw core::Error("the surface has more than 2^31 triangles", "isosurface", "choose a coarser spacing");
        TriangleMesh mesh;
        mesh.vertices.resize(vertices);
        mesh.triangles.resize(triangles);
        core::parallelFor(active_.size(), 16, [&](std::size_t b, std::size_t e) {
            for (std::size_t i = b; i < e; ++i)
                std::copy(active_[i].vertices.begin(), active_[i].vertices.end(),
                          mesh.vertices.begin() + active_[i].firstVertex);
        });
        core::parallelFor(active_.size(), 16, [&](std::size_t b, std::size_t e) {
            for (std::size_t i = b; i < e; ++i)
                emit(active_[i], mesh);
        });
        return mesh;
    }

    void emit(const Block& block, TriangleMesh& mesh) const {
        if (block.triangleCount == 0) return;
        const auto& table = cellTable();
        std::uint32_t centre = block.firstVertex + block.edgeVertices, triangle = block.firstTriangle;
        forEachCell(block, [&](int x, int y, int z, int configuration) {
            std::uint32_t id[12 + 4];
            for (int e = 0; e < 12; ++e) {
                const int c = kEdges[e].corner, far = c | (1 << kEdges[e].axis);
                if ((configuration >> c & 1) == (configuration >> far & 1)) continue;
                id[e] = vertexOn(block, x + (c & 1), y + (c >> 1 & 1), z + (c >> 2), kEdges[e].axis);
            }
            const CellTriangles& cell = table[configuration];
            for (std::size_t k = 0; k < cell.centres.size(); ++k) {
                Vec3 sum = Vec3::Zero();
                for (const int e : cell.centres[k])
                    sum += mesh.vertices[id[e]];
                mesh.vertices[centre] = sum / static_cast<double>(cell.centres[k].size());
                id[12 + k] = centre++;
            }
            for (const auto& t : cell.triangles)
                mesh.triangles[triangle++] = {id[t[0]], id[t[1]], id[t[2]]};
        });
    }

    [[nodiscard]] std::uint32_t vertexOn(const Block& block, int x, int y, int z, int axis) const {
        const Block* owner = &block;
        if (x >= kCells || y >= kCells || z >= kCells) {
            const std::int32_t bx = block.at[0] + x / kCells, by = block.at[1] + y / kCells,
                               bz = block.at[2] + z / kCells;
            const std::int32_t index =
                bx < blocks_[0] && by < blocks_[1] && bz < blocks_[2] ? blockAt_[denseIndex(bx, by, bz)] : -1;
            owner = index < 0 ? nullptr : &active_[static_cast<std::size_t>(index)];
        }
        const std::int16_t local = owner && !owner->edgeVertex.empty()
                                       ? owner->edgeVertex[ownEdge(x % kCells, y % kCells, z % kCells, axis)]
                                       : std::int16_t{-1};
        if (local < 0) throw tooSteep();
        return owner->firstVertex + static_cast<std::uint32_t>(local);
    }

    const ScalarFunction& f_;
    double h_, lipschitz_, usualSlope_;
    const core::Progress& progress_;
    Vec3 origin_;
    std::array<std::int64_t, 3> cells_{}, blocks_{};
    const ScalarGrid* grid_ = nullptr;
    float gridOutside_ = 0.0f;
    std::vector<std::int32_t> blockAt_;
    std::vector<Block> active_;
};

// Value and gradient from four samples at the corners of a small tetrahedron.
std::pair<double, Vec3> valueAndGradient(const ScalarFunction& f, const Vec3& p, double e) {
    const double a = f(p + Vec3(e, e, e)), b = f(p + Vec3(e, -e, -e)), c = f(p + Vec3(-e, e, -e)),
                 d = f(p + Vec3(-e, -e, e));
    return {0.25 * (a + b + c + d), Vec3(a + b - c - d, a - b + c - d, a - b - c + d) / (4.0 * e)};
}

class Polisher {
  public:
    Polisher(TriangleMesh& mesh, const ScalarFunction& f, const IsosurfaceSettings& settings)
        : mesh_(mesh), f_(f), h_(settings.spacingMm), gradients_(mesh.vertices.size(), Vec3::Zero()) {
        if (settings.relaxations > 0) findNeighbours();
        project(false);
        for (int i = 0; i < settings.relaxations; ++i) {
            relax();
            project(settings.keepGradients);
        }
    }

  private:
    void findNeighbours() {
        first_.assign(mesh_.vertices.size() + 1, 0);
        for (const Triangle& t : mesh_.triangles)
            for (const std::uint32_t v : t)
                ++first_[v + 1];
        for (std::size_t v = 1; v < first_.size(); ++v)
            first_[v] += first_[v - 1];
        following_.resize(3 * mesh_.triangles.size());
        std::vector<std::uint32_t> fill(first_.begin(), first_.end() - 1);
        for (const Triangle& t : mesh_.triangles)
            for (int c = 0; c < 3; ++c)
                following_[fill[t[c]]++] = t[(c + 1) % 3];
    }

    void project(bool keepGradients) {
        core::parallelFor(mesh_.vertices.size(), 512, [&](std::size_t begin, std::size_t end) {
            for (std::size_t v = begin; v < end; ++v) {
                Vec3& p = mesh_.vertices[v];
                const auto [value, gradient] =
                    keepGradients ? std::pair(f_(p), gradients_[v]) : valueAndGradient(f_, p, 0.02 * h_);
                gradients_[v] = gradient;
                const double squared = gradient.squaredNorm();
                if (!(squared > 1e-6)) continue;
                Vec3 step = -value / squared * gradient;
                const double length = step.norm();
                if (length > 0.5 * h_) step *= 0.5 * h_ / length;
                p += step;
            }
        });
    }

    // Towards the mean of the neighbours, but only along the surface: the shape stays.
    void relax() {
        std::vector<Vec3> moved(mesh_.vertices.size());
        core::parallelFor(mesh_.vertices.size(), 512, [&](std::size_t begin, std::size_t end) {
            for (std::size_t v = begin; v < end; ++v) {
                const Vec3& p = mesh_.vertices[v];
                Vec3 sum = Vec3::Zero();
                for (std::uint32_t i = first_[v]; i < first_[v + 1]; ++i)
                    sum += mesh_.vertices[following_[i]];
                Vec3 step = sum / static_cast<double>(first_[v + 1] - first_[v]) - p;
                const double squared = gradients_[v].squaredNorm();
                if (squared > 1e-6) step -= step.dot(gradients_[v]) / squared * gradients_[v];
                moved[v] = p + 0.5 * step;
            }
        });
        mesh_.vertices.swap(moved);
    }

    TriangleMesh& mesh_;
    const ScalarFunction& f_;
    double h_;
    std::vector<Vec3> gradients_;
    std::vector<std::uint32_t> first_, following_;
};

}  // namespace

TriangleMesh isosurface(const core::Box& box, const ScalarFunction& f, const IsosurfaceSettings& settings,
                        const core::Progress& progress) {
    if (box.isEmpty() || !box.min.allFinite() || !box.max.allFinite())
        throw core::Error("the box is empty or not finite", "isosurface");
    if (!(settings.spacingMm > 0.0) || !std::isfinite(settings.spacingMm))
        throw core::Error(fmt::format("a spacing of {} mm is not positive", settings.spacingMm), "isosurface");
    if (!(settings.lipschitz > 0.0) || !std::isfinite(settings.lipschitz))
        throw core::Error(fmt::format("a Lipschitz bound of {} is not positive", settings.lipschitz), "isosurface");
    TriangleMesh mesh = Marcher(box, f, settings, progress).run();
    if (settings.project && !mesh.vertices.empty()) Polisher(mesh, f, settings);
    core::report(progress, 1.0);
    return mesh;
}

TriangleMesh isosurface(const ScalarGrid& grid, const core::Progress& progress) {
    const auto& n = grid.nodes;
    if (grid.values.size() != std::size_t{n[0]} * n[1] * n[2] || grid.values.empty())
        throw core::Error(
            fmt::format("{} values do not fill a grid of {} x {} x {}", grid.values.size(), n[0], n[1], n[2]),
            "isosurface");
    if (!(grid.spacingMm > 0.0)) throw core::Error("the grid's spacing is not positive", "isosurface");
    TriangleMesh mesh = Marcher(grid, progress).run();
    core::report(progress, 1.0);
    return mesh;
}

}  // namespace handpiece::geometry
