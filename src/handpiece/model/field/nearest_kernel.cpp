// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/field/nearest_kernel.h"

namespace handpiece::field::HANDPIECE_SIMD_NS {
namespace {

using geometry::TreeNode;
using Floats8 = float __attribute__((vector_size(32)));
using Floats = float __attribute__((vector_size(4 * kPacket)));
using Ints = std::int32_t __attribute__((vector_size(4 * kPacket)));

constexpr int kStackSize = 7 * geometry::kMaxTreeDepth + 8;
// Boxes are kept while they might hold something nearer than the best so far, with room for the rounding of both.
constexpr float kRelativeSlack = 1.0f + 1e-5f, kAbsoluteSlack = 1e-12f;

inline Floats8 load8(const float* v) {
    Floats8 f;
    __builtin_memcpy(&f, v, sizeof f);
    return f;
}

inline Floats load(const float* v) {
    Floats f;
    __builtin_memcpy(&f, v, sizeof f);
    return f;
}

template <class V>
inline V least(V a, V b) {
    return a < b ? a : b;
}
template <class V>
inline V greatest(V a, V b) {
    return a > b ? a : b;
}

inline float largest(Floats v) {
    float lanes[kPacket];
    __builtin_memcpy(lanes, &v, sizeof v);
    float best = lanes[0];
    for (int i = 1; i < kPacket; ++i)
        best = best > lanes[i] ? best : lanes[i];
    return best;
}

inline bool anyTrue(Ints mask) {
    long long words[kPacket / 2], any = 0;
    __builtin_memcpy(words, &mask, sizeof mask);
    for (int i = 0; i < kPacket / 2; ++i)
        any |= words[i];
    return any != 0;
}

struct State {
    Floats px, py, pz;  // from the packet's centre
    Floats best2;
    Ints nearest;
};

/// Squared distance of every point to one triangle, in the triangle's own plane and across it.
inline Floats distance2(const State& s, const FlatTriangle& t, const double* centre) {
    const Floats zero{};
    const float ox = static_cast<float>(t.origin[0] - centre[0]), oy = static_cast<float>(t.origin[1] - centre[1]),
                oz = static_cast<float>(t.origin[2] - centre[2]);
    const Floats dx = s.px - ox, dy = s.py - oy, dz = s.pz - oz;
    const Floats x = dx * t.x[0] + dy * t.x[1] + dz * t.x[2];
    const Floats y = dx * t.y[0] + dy * t.y[1] + dz * t.y[2];
    const Floats z = dx * t.n[0] + dy * t.n[1] + dz * t.n[2];
    // Edge ab, along x.
    const Floats ax = x - greatest(zero, least(zero + t.length, x));
    const Floats ab2 = ax * ax + y * y;
    // Edge bc.
    const float bcx = t.cx - t.length;
    const Floats wx = x - t.length;
    const Floats u = greatest(zero, least(zero + 1.0f, (wx * bcx + y * t.cy) * t.inverseBc2));
    const Floats bx = wx - u * bcx, by = y - u * t.cy;
    const Floats bc2 = bx * bx + by * by;
    // Edge ac.
    const Floats v = greatest(zero, least(zero + 1.0f, (x * t.cx + y * t.cy) * t.inverseCa2));
    const Floats cx = x - v * t.cx, cy = y - v * t.cy;
    const Floats ca2 = cx * cx + cy * cy;
    const Floats edges2 = least(ab2, least(bc2, ca2));
    // Strictly inside all three edges; never so where cy = 0.
    const Floats innermost = least(y, least(y * bcx - wx * t.cy, x * t.cy - y * t.cx));
    return (innermost > zero ? zero : edges2) + z * z;
}

inline void consider(State& s, const FlatTriangle* triangles, std::uint32_t index, const double* centre) {
    const Floats d2 = distance2(s, triangles[index], centre);
    const Ints nearer = d2 < s.best2;
    s.best2 = nearer ? d2 : s.best2;
    s.nearest = nearer ? Ints{} + static_cast<std::int32_t>(index) : s.nearest;
}

struct Entry {
    std::uint32_t slot;  // 8 x node + lane
    float distance2;
};

}  // namespace

void nearestOfPacket(const TreeNode* nodes, const FlatTriangle* triangles, const PointPacket& packet,
                     std::uint32_t seed, std::uint32_t* nearest) {
    State s;
    s.px = load(packet.offset[0]);
    s.py = load(packet.offset[1]);
    s.pz = load(packet.offset[2]);
    s.best2 = Floats{} + __builtin_inff();
    s.nearest = Ints{};
    consider(s, triangles, seed, packet.centre);
    float bound = largest(s.best2) * kRelativeSlack + kAbsoluteSlack;

    float centre[3];
    for (int k = 0; k < 3; ++k)
        centre[k] = static_cast<float>(packet.centre[k]);
    const Floats gx = s.px + centre[0], gy = s.py + centre[1], gz = s.pz + centre[2];

    Entry stack[kStackSize];
    int top = 0;
    const auto open = [&](std::uint32_t index) {
        const TreeNode& node = nodes[index];
        const Floats8 zero{};
        const auto gap = [&](const float* low, const float* high, int k) {
            return greatest(zero, greatest(load8(low) - (centre[k] + packet.halfSize[k]),
                                           (centre[k] - packet.halfSize[k]) - load8(high)));
        };
        const Floats8 x = gap(node.minX, node.maxX, 0), y = gap(node.minY, node.maxY, 1),
                      z = gap(node.minZ, node.maxZ, 2);
        const Floats8 sum = x * x + y * y + z * z;
        float d2[8];
        __builtin_memcpy(d2, &sum, sizeof d2);
        const int base = top;
        for (int lane = 0; lane < node.lanes; ++lane) {
            if (d2[lane] > bound) continue;
            // Farthest first, so that the nearest is popped first.
            int i = top++;
            for (; i > base && stack[i - 1].distance2 < d2[lane]; --i)
                stack[i] = stack[i - 1];
            stack[i] = {8 * index + static_cast<std::uint32_t>(lane), d2[lane]};
        }
    };
    open(0);
    while (top > 0) {
        const Entry entry = stack[--top];
        if (entry.distance2 > bound) continue;
        const TreeNode& node = nodes[entry.slot / 8];
        const std::uint32_t lane = entry.slot % 8;
        // Point by point: the nearest point and the one with the farthest to go are seldom the same.
        const Floats zero{};
        const Floats x = greatest(zero, greatest(node.minX[lane] - gx, gx - node.maxX[lane]));
        const Floats y = greatest(zero, greatest(node.minY[lane] - gy, gy - node.maxY[lane]));
        const Floats z = greatest(zero, greatest(node.minZ[lane] - gz, gz - node.maxZ[lane]));
        if (!anyTrue(x * x + y * y + z * z <= s.best2 * kRelativeSlack + kAbsoluteSlack)) continue;
        const std::int32_t child = node.child[lane];
        if (child >= 0) {
            open(static_cast<std::uint32_t>(child));
            continue;
        }
        const auto first = static_cast<std::uint32_t>(~child);
        for (std::uint32_t i = first; i < first + node.count[lane]; ++i)
            consider(s, triangles, i, packet.centre);
        bound = largest(s.best2) * kRelativeSlack + kAbsoluteSlack;
    }
    __builtin_memcpy(nearest, &s.nearest, sizeof s.nearest);
}

}  // namespace handpiece::field::HANDPIECE_SIMD_NS
