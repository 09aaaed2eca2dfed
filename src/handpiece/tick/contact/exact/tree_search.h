// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the exact kernels share: plain vectors, and the walk through the tree of boxes. For sources built by
/// handpiece_simd_sources alone.

#include "handpiece/tick/contact/exact/exact_kernels.h"
#include "handpiece/tick/contact/lanes.h"

namespace handpiece::contact {
namespace {

constexpr int kStack = 7 * 32 + 8;        // geometry::kMaxTreeDepth
constexpr float kBoundSlackMm = 1.5e-5f;  // covers the rounding of a bound in float, at a decimetre from the origin

struct Vector {
    double x, y, z;
};
inline Vector operator-(Vector a, Vector b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vector operator+(Vector a, Vector b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vector operator*(double s, Vector a) {
    return {s * a.x, s * a.y, s * a.z};
}
inline double dot(Vector a, Vector b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// A node's eight boxes as seen from a bur's axis: half sizes, and where their middles lie along it (z) and away from
/// it (r).
struct AxisBoxes {
    float ax, ay, az;
    Floats hx, hy, hz, z, rx, ry, rz, rho, inverseRho;

    AxisBoxes(const KernelNode& node, Vector tip, Vector axis)
        : ax(static_cast<float>(axis.x)), ay(static_cast<float>(axis.y)), az(static_cast<float>(axis.z)) {
        const Floats minX = loadFloats(node.minX), maxX = loadFloats(node.maxX), minY = loadFloats(node.minY);
        const Floats maxY = loadFloats(node.maxY), minZ = loadFloats(node.minZ), maxZ = loadFloats(node.maxZ);
        const Floats cx = 0.5f * (minX + maxX) - static_cast<float>(tip.x);
        const Floats cy = 0.5f * (minY + maxY) - static_cast<float>(tip.y);
        const Floats cz = 0.5f * (minZ + maxZ) - static_cast<float>(tip.z);
        hx = 0.5f * (maxX - minX);
        hy = 0.5f * (maxY - minY);
        hz = 0.5f * (maxZ - minZ);
        z = cx * ax + cy * ay + cz * az;
        rx = cx - z * ax;
        ry = cy - z * ay;
        rz = cz - z * az;
        rho = rootF(rx * rx + ry * ry + rz * rz);
        inverseRho = 1.0f / mostF(rho, splatF(1e-12f));
    }
};

/// Depth first, nearest child first; the triangles of a node's near leaves go through in eights.
template <class Query>
void search(const TreeView& tree, std::uint32_t seed, Query& query) {
    std::uint32_t ids[8];
    if (seed < tree.triangleCount) {  // neighbours in the tree's order lie close
        const std::uint32_t first = seed < 4 ? 0 : seed - 3;
        int count = 0;
        for (; count < 8 && first + static_cast<std::uint32_t>(count) < tree.triangleCount; ++count)
            ids[count] = first + static_cast<std::uint32_t>(count);
        query.evaluate(ids, count);
    }
    struct Entry {
        float bound;
        std::int32_t node;
    };
    Entry stack[kStack];
    int top = 0;
    stack[top++] = {-1e30f, 0};
    while (top > 0) {
        const Entry entry = stack[--top];
        if (entry.bound >= query.best()) continue;
        const KernelNode& node = tree.nodes[entry.node];
        const Floats bound = query.bounds(node);
        unsigned open = bitsOf(bound < query.best()) & ((1u << node.lanes) - 1u);
        Entry leaves[8], inner[8];
        int leafCount = 0, innerCount = 0;
        while (open != 0) {
            const int lane = __builtin_ctz(open);
            open &= open - 1;
            const Entry child{bound[lane], node.child[lane] >= 0 ? node.child[lane] : lane};
            Entry* list = node.child[lane] >= 0 ? inner : leaves;
            int& count = node.child[lane] >= 0 ? innerCount : leafCount;
            int at = count++;
            for (; at > 0 && list[at - 1].bound > child.bound; --at)
                list[at] = list[at - 1];
            list[at] = child;
        }
        for (int i = 0; i < leafCount;) {
            int count = 0;
            for (; i < leafCount && leaves[i].bound < query.best() && count + node.count[leaves[i].node] <= 8; ++i) {
                const std::uint32_t first = static_cast<std::uint32_t>(~node.child[leaves[i].node]);
                for (std::uint32_t k = 0; k < node.count[leaves[i].node]; ++k)
                    ids[count++] = first + k;
            }
            if (count == 0) break;
            query.evaluate(ids, count);
        }
        for (int i = innerCount - 1; i >= 0; --i)
            stack[top++] = inner[i];
    }
}

}  // namespace
}  // namespace handpiece::contact
