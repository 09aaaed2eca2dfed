// SPDX-License-Identifier: Apache-2.0
// Dual contouring (Ju, Losasso, Schaefer & Warren 2002): where the surface crosses an edge of a cell, point and normal
// give a plane; the cell's vertex is the point that lies best on all of its planes, so that edges of the solid stay
// sharp. Cells through which several sheets pass have a vertex for each (Nielson 2004, "Dual marching cubes"), told
// apart by which edges belong together: cell_cases.h. All in voxels, from the brick's node 0.
//
// What is not in those papers: the field of a cut tooth is max(phi, -bur), with a kink where the two meet, so a
// difference across a kink is neither one's slope. Differences are taken away from kinks (Sampler), and where a kink
// lies on an edge itself both sides are carried on to where each is zero.
#include "handpiece/senses/surface/brick_contour.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "handpiece/senses/surface/cell_cases.h"
#include "handpiece/senses/surface/float3.h"

namespace handpiece::surface {
namespace {

using field::kBrickNodes;

constexpr int kApron = 2;  ///< layers of nodes taken from the six neighbours
constexpr int kSide = kBrickNodes + 2 * kApron;
constexpr int kStride[3] = {1, kSide, kSide* kSide};

/// Slopes that differ by more than this share of a voxel across a node show an edge of the solid; less is curvature.
constexpr float kKink = 0.15f;
/// Weight that holds a vertex near the mean of its crossings where the planes leave it free.
constexpr float kHold = 0.01f;
/// Cosine between a plane and the mean normal below which the vertex lies on an edge of the solid.
constexpr float kSharpCosine = 0.92f;
/// Vertices keep this far from the faces of their cell [voxels], so that no two coincide.
constexpr float kMargin = 1.0f / 512.0f;
/// Nodes farther from the surface than this [voxels], or with a gradient whose length differs from one by more, are not
/// asked for the plane that they see.
constexpr float kNearNode = 1.25f, kUnitSlack = 0.1f;
constexpr float kNodeHold = 0.003f;
/// What a plane whose edge has a kink on it counts for where a surface's own normal is asked for.
constexpr float kUncleanWeight = 0.2f;
/// A vertex may go this share of the way from its own crossings to those of a cell beside it.
constexpr float kReach = 0.75f;
/// How far a vertex may stand out through a face behind which nothing is [voxels].
constexpr float kStandOut = 0.5f;

/// Values of a brick and two layers round it, in voxels, and what is derived from them a node and an edge at a time.
class Sampler {
  public:
    static int index(int x, int y, int z) { return x + kApron + kSide * (y + kApron + kSide * (z + kApron)); }

    /// `sides`: bit 2 k: the layers below along axis k are wanted; 2 k + 1: those above.
    void gather(const BrickSource& source, std::uint32_t dense, const float* own, unsigned sides) {
        const BrickGrid& grid = source.grid();
        const auto scale = static_cast<float>(1.0 / grid.voxelMm);
        for (int z = 0; z < kBrickNodes; ++z)
            for (int y = 0; y < kBrickNodes; ++y) {
                float* to = &value_[index(0, y, z)];
                const float* from = own + kBrickNodes * (y + kBrickNodes * z);
                for (int x = 0; x < kBrickNodes; ++x)
                    to[x] = scale * from[x];
            }
        alignas(32) float scratch[field::kBrickValues];
        for (int side = 0; side < 6; ++side) {
            if ((sides >> side & 1) == 0) continue;
            const int axis = side / 2, up = side & 1;
            int step[3] = {0, 0, 0};
            step[axis] = up != 0 ? 1 : -1;
            const std::int64_t other = grid.neighbour(dense, step[0], step[1], step[2]);
            const float* from = other < 0 ? nullptr : source.values(static_cast<std::uint32_t>(other), scratch);
            takeLayers(axis, up != 0, from, scale);
        }
        gradientReady_.fill(0);
        kinked_.fill(0);
    }

    [[nodiscard]] float at(int i) const { return value_[static_cast<std::size_t>(i)]; }

    /// Gradient at a node, of the function that is in force there: differences are taken away from kinks. See slope().
    const Float3& gradient(int i, int node) {
        Float3& g = gradient_[static_cast<std::size_t>(node)];
        std::uint64_t& word = gradientReady_[static_cast<std::size_t>(node / 64)];
        if ((word >> (node % 64) & 1) == 0) {
            const std::uint64_t bit = std::uint64_t{1} << (node % 64);
            word |= bit;
            for (int k = 0; k < 3; ++k)
                g[static_cast<std::size_t>(k)] = slope(i, kStride[k]);
            if (isKink(i, kStride[0]) || isKink(i, kStride[1]) || isKink(i, kStride[2]))
                kinked_[static_cast<std::size_t>(node / 64)] |= bit;
        }
        return g;
    }

    /// The gradient there was asked for, and it looked two nodes on.
    [[nodiscard]] bool isKinked(int node) const {
        return (kinked_[static_cast<std::size_t>(node / 64)] >> (node % 64) & 1) != 0;
    }

    /// Where the surface crosses the edge that begins at node `i` along `axis`: a share of it, and the gradient there.
    /// Without a kink t = -vIn / (vOut - vIn), and the gradient between those of both nodes. `isClean`: no kink is
    /// near.
    struct Crossing {
        float t;
        Float3 gradient;
        bool isClean;
    };
    Crossing crossing(int i, int node, int axis) {
        const int s = kStride[axis];
        constexpr int kNodeStride[3] = {1, kBrickNodes, kBrickNodes * kBrickNodes};
        const bool rising = at(i) < 0.0f;
        // From the inside outwards.
        const int in = rising ? i : i + s, out = rising ? i + s : i, step = rising ? s : -s;
        const int inNode = rising ? node : node + kNodeStride[axis], outNode = rising ? node + kNodeStride[axis] : node;
        const float vIn = at(in), vOut = at(out), mid = vOut - vIn;
        const float before = vIn - at(in - step), after = at(out + step) - vOut;
        float t = -vIn / mid;
        const Float3& gIn = gradient(in, inNode);
        const Float3& gOut = gradient(out, outNode);
        int side = 0;  // -1: the function in force inside crosses, +1: the one outside
        const float bendIn = mid - before, bendOut = after - mid;
        if (bendIn * bendOut > 0.0f && std::min(std::abs(bendIn), std::abs(bendOut)) > kKink) {
            // An edge of the solid lies between the nodes: each side is carried on to where it is zero. The solid is
            // what both leave of it where they bend outwards, and what either leaves where they bend inwards.
            constexpr float kFar = 2.0f;
            const float tIn = before > 1e-3f ? -vIn / before : kFar;
            const float tOut = after > 1e-3f ? 1.0f - vOut / after : -kFar;
            const bool inFirst = bendIn > 0.0f ? tIn <= tOut : tIn >= tOut;
            t = std::clamp(inFirst ? tIn : tOut, 0.0f, 1.0f);
            side = inFirst ? -1 : 1;
        } else if (dot(gIn, gOut) < 0.9f * std::sqrt(dot(gIn, gIn) * dot(gOut, gOut))) {
            side = t < 0.5f ? -1 : 1;
        }
        Crossing c{rising ? t : 1.0f - t, {}, side == 0};
        for (std::size_t k = 0; k < 3; ++k)
            c.gradient[k] = side < 0 ? gIn[k] : side > 0 ? gOut[k] : gIn[k] + t * (gOut[k] - gIn[k]);
        return c;
    }

  private:
    void takeLayers(int axis, bool up, const float* from, float scale) {
        const int a = axis, u = axis == 0 ? 1 : 0, w = axis == 2 ? 1 : 2;
        constexpr int kNodeStride[3] = {1, kBrickNodes, kBrickNodes * kBrickNodes};
        const int origin = index(0, 0, 0);
        for (int layer = 1; layer <= kApron; ++layer) {
            const int here = up ? kBrickNodes - 1 + layer : -layer;
            const int there = up ? layer : kBrickNodes - 1 - layer;
            for (int q = 0; q < kBrickNodes; ++q)
                for (int p = 0; p < kBrickNodes; ++p) {
                    const int i = origin + here * kStride[a] + p * kStride[u] + q * kStride[w];
                    const int back = up ? -kStride[a] : kStride[a];
                    // Beyond the grid the field goes on as it comes.
                    value_[static_cast<std::size_t>(i)] =
                        from != nullptr ? scale * from[there * kNodeStride[a] + p * kNodeStride[u] + q * kNodeStride[w]]
                                        : 2.0f * at(i + back) - at(i + 2 * back);
                }
        }
    }

    /// Of the differences below and above the node, their mean where they agree, which is the slope to second order.
    /// Else there is a kink: that on one side of it is taken, the side where the next difference bends less, and
    /// carried to the node by half of that bend (a one-sided difference of second order).
    [[nodiscard]] float slope(int i, int s) const {
        const float below = at(i) - at(i - s), above = at(i + s) - at(i);
        if (!isKink(i, s)) return 0.5f * (below + above);
        const float below2 = at(i - s) - at(i - 2 * s), above2 = at(i + 2 * s) - at(i + s);
        const float bendBelow = below - below2, bendAbove = above2 - above;
        return std::abs(bendBelow) < std::abs(bendAbove) ? below + 0.5f * bendBelow : above - 0.5f * bendAbove;
    }

    [[nodiscard]] bool isKink(int i, int s) const {
        const float below = at(i) - at(i - s), above = at(i + s) - at(i);
        return std::abs(above - below) > kKink;
    }

    std::array<float, kSide * kSide * kSide> value_;
    std::array<Float3, field::kBrickValues> gradient_;
    std::array<std::uint64_t, (field::kBrickValues + 63) / 64> gradientReady_, kinked_;
};

/// A plane through a crossing, in voxels from the brick's node 0.
struct Plane {
    Float3 point, normal;
    bool isClean;  ///< both ends of the edge see the same plane
};

/// The point x that lies on all planes (n_i, p_i) as well as may be: the least sum of (n_i . (x - p_i))^2 and
/// count kHold |x - mean|^2, which holds it near the mean of the p_i where the planes leave it free. With o = x - mean
/// that is A o = b, A = sum n n^T + count kHold I, b = sum n (n . (p - mean)).
struct PlaneSum {
    Float3 mean{}, normal{};
    float a[6]{};  ///< xx, xy, xz, yy, yz, zz
    Float3 b{};
    float leastCosine = 1.0f;
    bool isClean = true;

    PlaneSum(const Plane* const* planes, int count) {
        for (int i = 0; i < count; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                mean[k] += planes[i]->point[k];
                normal[k] += planes[i]->normal[k];
            }
            isClean = isClean && planes[i]->isClean;
        }
        const float share = 1.0f / static_cast<float>(count);
        const float length = std::sqrt(dot(normal, normal));
        for (std::size_t k = 0; k < 3; ++k) {
            mean[k] *= share;
            normal[k] = length > 1e-6f ? normal[k] / length : planes[0]->normal[k];
        }
        for (int i = 0; i < count; ++i) {
            add(planes[i]->normal, planes[i]->point);
            leastCosine = std::min(leastCosine, dot(planes[i]->normal, normal));
        }
        hold(kHold * static_cast<float>(count));
    }
    void add(const Float3& n, const Float3& p) {
        const float off = n[0] * (p[0] - mean[0]) + n[1] * (p[1] - mean[1]) + n[2] * (p[2] - mean[2]);
        a[0] += n[0] * n[0];
        a[1] += n[0] * n[1];
        a[2] += n[0] * n[2];
        a[3] += n[1] * n[1];
        a[4] += n[1] * n[2];
        a[5] += n[2] * n[2];
        for (std::size_t k = 0; k < 3; ++k)
            b[k] += n[k] * off;
    }
    void hold(float weight) {
        a[0] += weight;
        a[3] += weight;
        a[5] += weight;
    }
    void clear() {
        std::fill(a, a + 6, 0.0f);
        b = {};
    }

    /// Offset from the mean, free.
    [[nodiscard]] Float3 solve() const {
        // Symmetric and positive definite: by cofactors.
        const float c00 = a[3] * a[5] - a[4] * a[4], c01 = a[2] * a[4] - a[1] * a[5], c02 = a[1] * a[4] - a[2] * a[3];
        const float c11 = a[0] * a[5] - a[2] * a[2], c12 = a[1] * a[2] - a[0] * a[4], c22 = a[0] * a[3] - a[1] * a[1];
        const float inverse = 1.0f / (a[0] * c00 + a[1] * c01 + a[2] * c02);
        return {inverse * (c00 * b[0] + c01 * b[1] + c02 * b[2]), inverse * (c01 * b[0] + c11 * b[1] + c12 * b[2]),
                inverse * (c02 * b[0] + c12 * b[1] + c22 * b[2])};
    }
    /// o^T A o - 2 b^T o: the sum that is to be least, less a constant.
    [[nodiscard]] float cost(const Float3& x) const {
        return x[0] * (a[0] * x[0] + 2.0f * (a[1] * x[1] + a[2] * x[2] - b[0])) +
               x[1] * (a[3] * x[1] + 2.0f * (a[4] * x[2] - b[1])) + x[2] * (a[5] * x[2] - 2.0f * b[2]);
    }
    /// The best offset in a box when the free one is not in it: the sum is convex, so the best lies on a face. On each
    /// face it is solved for in the two coordinates left; where that leads out of the face, along its edges, clamped.
    [[nodiscard]] Float3 solveWithin(const Float3& low, const Float3& high) const {
        const auto at = [&](std::size_t i, std::size_t j) { return a[i == 0 ? j : i + j + 1]; };
        Float3 best{};
        float least = std::numeric_limits<float>::infinity();
        const auto offer = [&](const Float3& x) {
            const float c = cost(x);
            if (c < least) {
                least = c;
                best = x;
            }
        };
        const auto isIn = [&](float v, std::size_t k) { return v >= low[k] && v <= high[k]; };
        for (std::size_t k = 0; k < 3; ++k)
            for (const float held : {low[k], high[k]}) {
                const std::size_t u = k == 0 ? 1 : 0, w = k == 2 ? 1 : 2;
                const float bu = b[u] - at(std::min(k, u), std::max(k, u)) * held;
                const float bw = b[w] - at(std::min(k, w), std::max(k, w)) * held;
                const float uu = at(u, u), uw = at(u, w), ww = at(w, w), inverse = 1.0f / (uu * ww - uw * uw);
                Float3 x;
                x[k] = held;
                x[u] = inverse * (ww * bu - uw * bw);
                x[w] = inverse * (uu * bw - uw * bu);
                if (isIn(x[u], u) && isIn(x[w], w)) {
                    offer(x);
                    continue;
                }
                for (const float other : {low[u], high[u]}) {
                    x[u] = other;
                    x[w] = std::clamp((bw - uw * other) / ww, low[w], high[w]);
                    offer(x);
                }
                for (const float other : {low[w], high[w]}) {
                    x[w] = other;
                    x[u] = std::clamp((bu - uw * other) / uu, low[u], high[u]);
                    offer(x);
                }
            }
        return best;
    }
};

/// The work of one brick; kept by each thread, because it is large.
class Contourer {
  public:
    bool contour(const BrickSource& source, std::uint32_t dense, BrickContour& out, const BrickContour* before,
                 const CellMask* dirty) {
        alignas(32) float scratch[field::kBrickValues];
        const float* own = source.values(dense, scratch);
        // Below zero, asked of the bits: what compares floats is not made eight at a time.
        std::array<bool, field::kBrickValues> isInside;
        for (std::size_t node = 0; node < isInside.size(); ++node)
            isInside[node] = std::bit_cast<std::uint32_t>(own[node]) > 0x80000000u;
        out.rows = maskOf(isInside);
        // Cells that the surface passes through, and the sides that they and those to be made anew are near.
        unsigned some = 0, fresh = 0, reach = 0, sides = 0;
        std::array<std::uint8_t, 64> active;
        for (int z = 0; z < 8; ++z)
            for (int y = 0; y < 8; ++y) {
                const unsigned r0 = row(out, y, z), r1 = row(out, y + 1, z), r2 = row(out, y, z + 1),
                               r3 = row(out, y + 1, z + 1);
                const unsigned any = r0 | r1 | r2 | r3, every = r0 & r1 & r2 & r3;
                const unsigned bits = (any | any >> 1) & ~(every & every >> 1) & 0xff;
                const auto at = static_cast<std::size_t>(y + 8 * z);
                active[at] = static_cast<std::uint8_t>(bits);
                if (bits == 0) continue;
                const unsigned near = (y < kApron ? 4u : 0u) | (y >= 8 - kApron ? 8u : 0u) | (z < kApron ? 16u : 0u) |
                                      (z >= 8 - kApron ? 32u : 0u);
                some |= bits;
                reach |= near;
                const unsigned made = before == nullptr ? bits : bits & (*dirty)[at];
                if (made == 0) continue;
                fresh |= made;
                sides |= near;
            }
        if (some == 0) return false;
        const auto alongX = [](unsigned bits) {
            return ((bits & 0x03) != 0 ? 1u : 0u) | ((bits & 0xc0) != 0 ? 2u : 0u);
        };
        out.reach = static_cast<std::uint8_t>(reach | alongX(some));
        sampler_.gather(source, dense, own, sides | alongX(fresh));
        out.cases.fill(0);
        out.kinked.fill(0);
        out.vertices.clear();
        planeCount_ = 0;
        for (auto& axis : planeOf_)
            axis.fill(kNone);
        const BrickGrid& grid = source.grid();
        const std::array<std::int32_t, 3> brick = grid.at(dense);
        for (std::size_t k = 0; k < 3; ++k)
            cornerMm_[k] = grid.originMm[static_cast<int>(k)] + grid.voxelMm * (field::kBrickCells * brick[k]);
        voxelMm_ = grid.voxelMm;
        for (int z = 0; z < 8; ++z)
            for (int y = 0; y < 8; ++y) {
                unsigned left = active[static_cast<std::size_t>(y + 8 * z)];
                if (left == 0) continue;
                const unsigned r0 = row(out, y, z), r1 = row(out, y + 1, z), r2 = row(out, y, z + 1),
                               r3 = row(out, y + 1, z + 1);
                const unsigned keeps =
                    before == nullptr ? 0u : ~unsigned{(*dirty)[static_cast<std::size_t>(y + 8 * z)]};
                for (; left != 0; left &= left - 1) {
                    const int x = std::countr_zero(left);
                    if ((keeps >> x & 1) != 0) {
                        keepCell(out, *before, x, y, z);
                        continue;
                    }
                    const unsigned bits = (r0 >> x & 3) | (r1 >> x & 3) << 2 | (r2 >> x & 3) << 4 | (r3 >> x & 3) << 6;
                    addCell(out, x, y, z, bits);
                }
            }
        return true;
    }

  private:
    static constexpr std::uint16_t kNone = 0xffff;

    static unsigned row(const BrickContour& out, int y, int z) { return out.rows[static_cast<std::size_t>(y + 9 * z)]; }

    const Plane& planeOn(int x, int y, int z, int edge) {
        const int axis = edge / 4, corner = edgeCorner(edge);
        const int nx = x + (corner & 1), ny = y + (corner >> 1 & 1), nz = z + (corner >> 2 & 1);
        const int node = nx + kBrickNodes * (ny + kBrickNodes * nz);
        std::uint16_t& slot = planeOf_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(node)];
        if (slot == kNone) {
            slot = planeCount_++;
            const Sampler::Crossing c = sampler_.crossing(Sampler::index(nx, ny, nz), node, axis);
            Plane& plane = planes_[slot];
            plane.point = {static_cast<float>(nx), static_cast<float>(ny), static_cast<float>(nz)};
            plane.point[static_cast<std::size_t>(axis)] += c.t;
            plane.isClean = c.isClean;
            const float length = std::sqrt(dot(c.gradient, c.gradient));
            for (std::size_t k = 0; k < 3; ++k)
                plane.normal[k] = length > 1e-6f ? c.gradient[k] / length : 0.0f;
        }
        return planes_[slot];
    }

    /// Of faces whose inside corners are diagonal to each other, those with the saddle between them inside: the same
    /// for the cells on both sides. The bilinear saddle is (v0 v2 - v1 v3) / (v0 + v2 - v1 - v3), so its sign is that
    /// of the products of the diagonals (the asymptotic decider, Nielson & Hamann 1991).
    unsigned joinedFaces(const int (&at)[3], unsigned faces) const {
        unsigned joined = 0;
        const int origin = Sampler::index(at[0], at[1], at[2]);
        for (; faces != 0; faces &= faces - 1) {
            const int face = std::countr_zero(faces);
            float v[4];
            const std::array<int, 4> corners = faceCorners(face);
            for (std::size_t i = 0; i < 4; ++i)
                v[i] = sampler_.at(origin + (corners[i] & 1) + (corners[i] >> 1 & 1) * kStride[1] +
                                   (corners[i] >> 2) * kStride[2]);
            const float inside = v[0] < 0.0f ? v[0] * v[2] : v[1] * v[3];
            const float outside = v[0] < 0.0f ? v[1] * v[3] : v[0] * v[2];
            if (inside > outside) joined |= 1u << face;
        }
        return joined;
    }

    void keepCell(BrickContour& out, const BrickContour& before, int x, int y, int z) const {
        const auto number = static_cast<std::size_t>(x + 8 * (y + 8 * z));
        out.cases[number] = before.cases[number];
        out.kinked[number >> 3] =
            static_cast<std::uint8_t>(out.kinked[number >> 3] | (before.kinked[number >> 3] & 1 << x));
        out.first[number] = static_cast<std::uint16_t>(out.vertices.size());
        const auto first = before.vertices.begin() + before.first[number];
        out.vertices.insert(out.vertices.end(), first, first + cases_[before.cases[number]].sheets);
    }

    void addCell(BrickContour& out, int x, int y, int z, unsigned bits) {
        const int at[3] = {x, y, z};
        if (ambiguous_[bits] != 0) bits |= joinedFaces(at, ambiguous_[bits]) << 8;
        const CellCase& cell = cases_[bits];
        const auto number = static_cast<std::uint16_t>(x + 8 * (y + 8 * z));
        out.cases[number] = static_cast<std::uint16_t>(bits);
        out.first[number] = static_cast<std::uint16_t>(out.vertices.size());
        for (std::uint8_t sheet = 0; sheet < cell.sheets; ++sheet) {
            const Plane* planes[12];
            int count = 0;
            for (std::size_t i = 0; i < cell.edgeCount; ++i)
                if (cell.sheetOf[cell.edges[i]] == sheet) planes[count++] = &planeOn(x, y, z, cell.edges[i]);
            addVertex(out, number, at, planes, count, cell.sheets == 1);
        }
        for (int c = 0; c < 8; ++c)
            if (sampler_.isKinked(x + (c & 1) + kBrickNodes * (y + (c >> 1 & 1) + kBrickNodes * (z + (c >> 2)))))
                out.kinked[number >> 3] = static_cast<std::uint8_t>(out.kinked[number >> 3] | 1 << x);
    }

    void addVertex(BrickContour& out, std::uint16_t number, const int (&at)[3], const Plane* const* planes, int count,
                   bool isAlone) {
        PlaneSum sum(planes, count);
        SheetVertex vertex;
        vertex.cell = number;
        vertex.isSharp = sum.leastCosine < kSharpCosine;
        vertex.normal = sum.normal;
        if (vertex.isSharp) vertex.sides = sidesOf(planes, count);
        const PlaneSum crossings = sum;
        if (vertex.isSharp || !sum.isClean) takeNodePlanes(sum, at, planes, count);
        Float3 x = sum.solve();
        Float3 low, high;
        bool within = true;
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = static_cast<float>(at[k]) + kMargin - sum.mean[k];
            high[k] = static_cast<float>(at[k] + 1) - kMargin - sum.mean[k];
            within = within && x[k] >= low[k] && x[k] <= high[k];
        }
        if (!within && !vertex.isSharp) sum = crossings;  // the edge of the solid passes by
        if (!within) {
            if (!(vertex.isSharp && isAlone && mayStandOut(at, sum.mean, x, low, high))) x = sum.solveWithin(low, high);
        }
        for (std::size_t k = 0; k < 3; ++k)
            vertex.positionMm[k] =
                static_cast<float>(cornerMm_[k] + voxelMm_ * (static_cast<double>(sum.mean[k]) + x[k]));
        out.vertices.push_back(vertex);
    }

    /// The planes of two surfaces that meet in an edge of the solid, told apart by the two that differ most.
    static std::array<Float3, 2> sidesOf(const Plane* const* planes, int count) {
        int seeds[2] = {0, 0};
        float least = 1.0f;
        for (int i = 0; i < count; ++i)
            for (int j = 0; j < i; ++j)
                if (const float cosine = dot(planes[i]->normal, planes[j]->normal); cosine < least) {
                    least = cosine;
                    seeds[0] = j;
                    seeds[1] = i;
                }
        std::array<Float3, 2> sides{};
        for (int i = 0; i < count; ++i) {
            const Float3& n = planes[i]->normal;
            const bool isSecond = dot(n, planes[seeds[1]]->normal) > dot(n, planes[seeds[0]]->normal);
            const float weight = planes[i]->isClean ? 1.0f : kUncleanWeight;
            for (std::size_t k = 0; k < 3; ++k)
                sides[isSecond ? 1 : 0][k] += weight * n[k];
        }
        for (Float3& side : sides) {
            const float length = std::sqrt(dot(side, side));
            for (float& k : side)
                k = length > 1e-6f ? k / length : 0.0f;
        }
        return sides;
    }

    /// Near an edge of the solid: planes at the distance that each node of the cell tells, along its own gradient, so
    /// that none is of two minds. A node at p with value v and unit gradient g sees the plane through p - v g.
    void takeNodePlanes(PlaneSum& sum, const int (&at)[3], const Plane* const* planes, int count) {
        Float3 normals[8], feet[8];
        int taken = 0;
        for (int c = 0; c < 8; ++c) {
            const int n[3] = {at[0] + (c & 1), at[1] + (c >> 1 & 1), at[2] + (c >> 2)};
            const int i = Sampler::index(n[0], n[1], n[2]);
            const float v = sampler_.at(i);
            if (std::abs(v) > kNearNode) continue;
            const Float3& g = sampler_.gradient(i, n[0] + kBrickNodes * (n[1] + kBrickNodes * n[2]));
            const float length = std::sqrt(dot(g, g));
            if (std::abs(length - 1.0f) > kUnitSlack) continue;
            bool isNear = true;
            for (std::size_t k = 0; k < 3; ++k) {
                normals[taken][k] = g[k] / length;
                feet[taken][k] = static_cast<float>(n[k]) - v * normals[taken][k];
                const float inCell = feet[taken][k] - static_cast<float>(at[k]);
                isNear = isNear && inCell > -kStandOut && inCell < 1.0f + kStandOut;
            }
            if (isNear) ++taken;
        }
        if (taken < 3) return;
        sum.clear();
        for (int i = 0; i < taken; ++i)
            sum.add(normals[i], feet[i]);
        for (int i = 0; i < count; ++i)
            if (planes[i]->isClean) sum.add(planes[i]->normal, planes[i]->point);
        sum.hold(kNodeHold * static_cast<float>(taken));
    }

    /// An edge of the solid may stand out of a cell between its nodes. The vertex may follow it as long as it stays
    /// away from the crossings of the cells beside it, so that the surface does not fold.
    bool mayStandOut(const int (&at)[3], const Float3& mean, const Float3& x, const Float3& low,
                     const Float3& high) const {
        for (std::size_t k = 0; k < 3; ++k)
            if (x[k] < low[k] - kStandOut || x[k] > high[k] + kStandOut) return false;
        for (int face = 0; face < 6; ++face) {
            int beside[3] = {at[0], at[1], at[2]};
            beside[face / 2] += (face & 1) != 0 ? 1 : -1;
            Float3 other;
            if (!meanCrossing(beside, other)) continue;
            float along = 0.0f, length2 = 0.0f;
            for (std::size_t k = 0; k < 3; ++k) {
                const float d = other[k] - mean[k];
                along += d * x[k];
                length2 += d * d;
            }
            if (along > kReach * length2) return false;
        }
        return true;
    }

    /// False when the surface does not pass through the cell.
    bool meanCrossing(const int (&at)[3], Float3& mean) const {
        const int origin = Sampler::index(at[0], at[1], at[2]);
        float v[8];
        unsigned bits = 0;
        for (int c = 0; c < 8; ++c) {
            v[c] = sampler_.at(origin + (c & 1) + (c >> 1 & 1) * kStride[1] + (c >> 2) * kStride[2]);
            bits |= static_cast<unsigned>(v[c] < 0.0f) << c;
        }
        const CellCase& cell = cases_[bits];
        if (cell.edgeCount == 0) return false;
        mean = {};
        for (std::size_t i = 0; i < cell.edgeCount; ++i) {
            const int edge = cell.edges[i], from = edgeCorner(edge), to = from | 1 << (edge / 4);
            const float t = v[from] / (v[from] - v[to]);
            for (int k = 0; k < 3; ++k)
                mean[static_cast<std::size_t>(k)] +=
                    static_cast<float>(at[k] + (from >> k & 1)) + (k == edge / 4 ? t : 0.0f);
        }
        for (float& m : mean)
            m /= static_cast<float>(cell.edgeCount);
        return true;
    }

    const std::array<CellCase, kCellCases>& cases_ = cellCases();
    const std::array<std::uint8_t, 256>& ambiguous_ = ambiguousFaces();
    Sampler sampler_;
    std::array<std::array<std::uint16_t, field::kBrickValues>, 3> planeOf_;
    std::array<Plane, 3 * field::kBrickValues> planes_;
    std::uint16_t planeCount_ = 0;
    std::array<double, 3> cornerMm_{};
    double voxelMm_ = 0.0;
};

}  // namespace

NodeMask maskOf(const std::array<bool, field::kBrickValues>& nodes) {
    NodeMask mask;
    for (std::size_t row = 0; row < mask.size(); ++row) {
        const bool* node = nodes.data() + kBrickNodes * row;
        std::uint64_t eight;
        std::memcpy(&eight, node, sizeof(eight));
        // Bit 8 k goes to bit 56 + k, and no two products fall on one bit.
        mask[row] = static_cast<std::uint16_t>(eight * 0x0102040810204080u >> 56 | unsigned{node[8]} << 8);
    }
    return mask;
}

CellMask cellsThatAsk(const NodeMask* own, const std::array<const NodeMask*, 6>& beside, const CellMask* kinked) {
    // The nodes a cell looks at: its own, and from each of them one on along every axis, or two where a kink is. Bit
    // x + kApron of a row.
    constexpr int kNodes = kBrickNodes, kCells = kNodes - 1;
    constexpr auto rowAt = [](int y, int z) { return static_cast<std::size_t>(y + kApron + kSide * (z + kApron)); };
    std::array<std::uint16_t, kSide * kSide> changed{};
    struct Rows {
        int y, z, countY, countZ;
    };
    const auto take = [&](const NodeMask* mask, const Rows& rows, int toY, int toZ, const auto& bitsOf) {
        if (mask == nullptr) return;
        for (int z = 0; z < rows.countZ; ++z)
            for (int y = 0; y < rows.countY; ++y) {
                const unsigned row = (*mask)[static_cast<std::size_t>(rows.y + y + kNodes * (rows.z + z))];
                std::uint16_t& to = changed[rowAt(toY + y, toZ + z)];
                to = static_cast<std::uint16_t>(to | bitsOf(row));
            }
    };
    const auto whole = [](unsigned row) { return row << kApron; };
    // Two layers beside: nodes kCells - 2 and kCells - 1 of the brick below, 1 and 2 of the one above.
    constexpr int kLow = kCells - kApron;
    take(own, {0, 0, kNodes, kNodes}, 0, 0, whole);
    take(beside[0], {0, 0, kNodes, kNodes}, 0, 0, [](unsigned row) { return row >> kLow & 3; });
    take(beside[1], {0, 0, kNodes, kNodes}, 0, 0, [](unsigned row) { return (row >> 1 & 3) << (kNodes + kApron); });
    take(beside[2], {kLow, 0, kApron, kNodes}, -kApron, 0, whole);
    take(beside[3], {1, 0, kApron, kNodes}, kNodes, 0, whole);
    take(beside[4], {0, kLow, kNodes, kApron}, 0, -kApron, whole);
    take(beside[5], {0, 1, kNodes, kApron}, 0, kNodes, whole);
    // By a cell that has this node; `far`: if it has a kink. In one run over the rows, with those between that nobody
    // asks for, so that the compiler takes eight at a time.
    constexpr std::size_t kBegin = rowAt(0, 0), kEnd = rowAt(kCells, kCells) + 1;
    std::array<std::uint16_t, kSide * kSide> near, far;
    for (std::size_t i = kBegin; i < kEnd; ++i) {
        const unsigned here = changed[i];
        const unsigned one =
            here | here << 1 | here >> 1 | changed[i - 1] | changed[i + 1] | changed[i - kSide] | changed[i + kSide];
        const unsigned two =
            here << 2 | here >> 2 | changed[i - 2] | changed[i + 2] | changed[i - 2 * kSide] | changed[i + 2 * kSide];
        near[i] = static_cast<std::uint16_t>(one);
        far[i] = static_cast<std::uint16_t>(one | two);
    }
    CellMask cells;
    for (int z = 0; z < kCells; ++z)
        for (int y = 0; y < kCells; ++y) {
            const auto cellsOf = [&, at = rowAt(y, z)](const auto& rows) {
                const unsigned bits = rows[at] | rows[at + 1] | rows[at + kSide] | rows[at + kSide + 1];
                return (bits | bits >> 1) >> kApron;
            };
            const auto cell = static_cast<std::size_t>(y + kCells * z);
            const unsigned hasKink = kinked != nullptr ? (*kinked)[cell] : 0u;
            cells[cell] = static_cast<std::uint8_t>(cellsOf(near) | (cellsOf(far) & hasKink));
        }
    return cells;
}

bool hasActive(const CellMask& mask, const BrickContour& contour) {
    return std::any_of(contour.vertices.begin(), contour.vertices.end(),
                       [&](const SheetVertex& v) { return (mask[v.cell >> 3] >> (v.cell & 7) & 1) != 0; });
}

std::uint8_t whoSees(const BrickContour& before, const BrickContour& now) {
    if (before.cases == now.cases && before.rows == now.rows && before.vertices == now.vertices) return 0;
    std::uint8_t seen = 1;
    for (std::size_t row = 0; row < 64; ++row)
        // Cells on the sides above alone: of most rows the last.
        for (std::size_t cell = 8 * row + ((row & 7) == 7 || row >= 56 ? 0 : 7); cell < 8 * row + 8; ++cell) {
            const std::uint16_t bits = now.cases[cell];
            if ((bits | before.cases[cell]) == 0) continue;
            const bool isSame = bits == before.cases[cell] &&
                                std::equal(now.vertices.begin() + now.first[cell],
                                           now.vertices.begin() + now.first[cell] + cellCases()[bits].sheets,
                                           before.vertices.begin() + before.first[cell]);
            if (isSame) continue;
            const auto sides =
                static_cast<std::uint8_t>(((cell & 7) == 7 ? 1 : 0) | ((row & 7) == 7 ? 2 : 0) | (row >= 56 ? 4 : 0));
            for (unsigned slot = 1; slot < 8; ++slot)
                if ((slot & sides) == slot) seen = static_cast<std::uint8_t>(seen | 1u << slot);
        }
    return seen;
}

bool contourBrick(const BrickSource& source, std::uint32_t dense, BrickContour& out, const BrickContour* before,
                  const CellMask* dirty) {
    static thread_local Contourer contourer;
    return contourer.contour(source, dense, out, before, dirty);
}

}  // namespace handpiece::surface
