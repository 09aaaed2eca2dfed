// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/triangle_tree.h"

#include <cmath>

namespace handpiece::geometry {
namespace {

using core::Vec3;
using Floats = float __attribute__((vector_size(32)));

/// The float box distance of a node times this is below the true one (see TreeNode).
constexpr float kLowerBound = 1.0f - 1e-6f;
constexpr int kStackSize = 7 * kMaxTreeDepth + 8;

struct Closest {
    Vec3 point;
    double distance2;
    std::uint8_t feature;
};

inline Vec3 load(const double (&v)[3]) {
    return {v[0], v[1], v[2]};
}

/// Ericson, Real-Time Collision Detection, 5.1.5: the point, relative to corner a, and the feature it lies on.
Vec3 closestOnSolid(const Vec3& ap, const Vec3& ab, const Vec3& ac, std::uint8_t& feature) noexcept {
    const double d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0.0 && d2 <= 0.0) return feature = 4, Vec3::Zero();
    const Vec3 bp = ap - ab;
    const double d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0.0 && d4 <= d3) return feature = 5, ab;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return feature = 1, ab * (d1 / (d1 - d3));
    const Vec3 cp = ap - ac;
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0.0 && d5 <= d6) return feature = 6, ac;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return feature = 3, ac * (d2 / (d2 - d6));
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
        const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return feature = 2, ab + (ac - ab) * w;
    }
    const double scale = 1.0 / (va + vb + vc);
    feature = 0;
    return ab * (vb * scale) + ac * (vc * scale);
}

/// For slivers, segments and points: the nearest of the three edges, or of the inside where that is well defined.
Vec3 closestOnThin(const Vec3& ap, const Vec3& ab, const Vec3& ac, std::uint8_t& feature) noexcept {
    Vec3 best = Vec3::Zero();
    double best2 = std::numeric_limits<double>::infinity();
    const Vec3 from[3] = {Vec3::Zero(), ab, ac}, along[3] = {ab, ac - ab, -ac};
    for (int e = 0; e < 3; ++e) {
        const double length2 = along[e].squaredNorm();
        const double t = length2 > 0.0 ? std::clamp((ap - from[e]).dot(along[e]) / length2, 0.0, 1.0) : 0.0;
        const Vec3 point = from[e] + along[e] * t;
        const double d2 = (ap - point).squaredNorm();
        if (d2 < best2) {
            best2 = d2;
            best = point;
            feature = static_cast<std::uint8_t>(t <= 0.0 ? 4 + e : t >= 1.0 ? 4 + (e + 1) % 3 : 1 + e);
        }
    }
    std::uint8_t inside = 7;
    const Vec3 point = closestOnSolid(ap, ab, ac, inside);
    if (inside == 0 && point.allFinite()) {
        // Rounding may have put it outside the sliver: only a convex combination of the corners counts.
        const double abab = ab.squaredNorm(), abac = ab.dot(ac), acac = ac.squaredNorm();
        const double det = abab * acac - abac * abac;
        const double v = (acac * ab.dot(point) - abac * ac.dot(point)) / det;
        const double w = (abab * ac.dot(point) - abac * ab.dot(point)) / det;
        if (v >= 0.0 && w >= 0.0 && v + w <= 1.0 && (ap - point).squaredNorm() < best2) {
            feature = 0;
            return point;
        }
    }
    return best;
}

inline Closest closestOnTriangle(const Vec3& p, const TreeTriangle& t) noexcept {
    Closest c;
    const Vec3 a = load(t.a), ab = load(t.ab), ac = load(t.ac), ap = p - a;
    const Vec3 onTriangle = t.thin != 0 ? closestOnThin(ap, ab, ac, c.feature) : closestOnSolid(ap, ab, ac, c.feature);
    c.point = a + onTriangle;
    c.distance2 = (ap - onTriangle).squaredNorm();
    return c;
}

inline Floats loadLanes(const float (&v)[8]) noexcept {
    Floats f;
    __builtin_memcpy(&f, v, sizeof f);
    return f;
}

/// Squared distances from a point to the eight boxes; infinite for empty lanes.
inline void boxDistances2(const TreeNode& node, const float (&p)[3], float (&out)[8]) noexcept {
    const Floats zero{};
    const auto gap = [&](const float(&low)[8], const float(&high)[8], float at) {
        const Floats below = loadLanes(low) - at, above = at - loadLanes(high);
        const Floats outside = below > above ? below : above;
        return outside > zero ? outside : zero;
    };
    const Floats x = gap(node.minX, node.maxX, p[0]), y = gap(node.minY, node.maxY, p[1]),
                 z = gap(node.minZ, node.maxZ, p[2]);
    const Floats d2 = x * x + y * y + z * z;
    __builtin_memcpy(out, &d2, sizeof d2);
}

}  // namespace

NearestPoint TriangleTree::nearestOn(std::uint32_t triangle, const Vec3& p) const noexcept {
    const Closest c = closestOnTriangle(p, triangles_[triangle]);
    return {std::sqrt(c.distance2), c.point, triangle, c.feature};
}

NearestPoint TriangleTree::nearest(const Vec3& p, double boundMm, std::uint32_t seed) const noexcept {
    NearestPoint best;
    double best2 = boundMm * boundMm;
    const auto consider = [&](std::uint32_t i) {
        const Closest c = closestOnTriangle(p, triangles_[i]);
        if (c.distance2 < best2 || (best.triangle == kNoTriangle && c.distance2 <= best2)) {
            best2 = c.distance2;
            best.pointMm = c.point;
            best.triangle = i;
            best.feature = c.feature;
        }
    };
    if (seed < triangles_.size()) consider(seed);

    struct Entry {
        std::int32_t child;
        float distance2;
        std::uint32_t count;
    };
    Entry stack[kStackSize];
    int top = 0;
    stack[top++] = {0, 0.0f, 0};
    const float at[3] = {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
    while (top > 0) {
        const Entry entry = stack[--top];
        if (static_cast<double>(entry.distance2 * kLowerBound) > best2) continue;
        if (entry.child < 0) {
            const auto first = static_cast<std::uint32_t>(~entry.child);
            for (std::uint32_t i = first; i < first + entry.count; ++i)
                consider(i);
            continue;
        }
        const TreeNode& node = nodes_[static_cast<std::size_t>(entry.child)];
        float d2[8];
        boxDistances2(node, at, d2);
        const int base = top;
        for (int lane = 0; lane < node.lanes; ++lane) {
            if (static_cast<double>(d2[lane] * kLowerBound) > best2) continue;
            // Farthest first, so that the nearest is popped first.
            int i = top++;
            for (; i > base && stack[i - 1].distance2 < d2[lane]; --i)
                stack[i] = stack[i - 1];
            stack[i] = {node.child[lane], d2[lane], node.count[lane]};
        }
    }
    best.distanceMm = best.triangle == kNoTriangle ? boundMm : std::sqrt(best2);
    return best;
}

double TriangleTree::side(const Vec3& p, const NearestPoint& n) const noexcept {
    if (n.triangle == kNoTriangle) return 1.0;
    const float* normal = &pseudonormals_[21 * static_cast<std::size_t>(n.triangle) + 3 * std::size_t{n.feature}];
    const Vec3 away = p - n.pointMm;
    return away.x() * normal[0] + away.y() * normal[1] + away.z() * normal[2] < 0.0 ? -1.0 : 1.0;
}

double TriangleTree::signedDistance(const Vec3& p, NearestPoint* nearestPoint, std::uint32_t seed) const noexcept {
    const NearestPoint n = nearest(p, std::numeric_limits<double>::infinity(), seed);
    if (nearestPoint != nullptr) *nearestPoint = n;
    return side(p, n) * n.distanceMm;
}

RayMeeting TriangleTree::firstMeeting(const Vec3& origin, const Vec3& direction, double farMm) const noexcept {
    RayMeeting first{farMm, kNoTriangle};
    const auto consider = [&](std::uint32_t i) {
        // Moeller & Trumbore 1997; corners' weights may be negative by rounding.
        constexpr double kEdge = -1e-10;
        const TreeTriangle& t = triangles_[i];
        const Vec3 ab = load(t.ab), ac = load(t.ac), p = direction.cross(ac);
        const double det = ab.dot(p);
        if (!(std::abs(det) > 1e-14 * ab.norm() * ac.norm())) return;
        const Vec3 s = origin - load(t.a), q = s.cross(ab);
        const double u = s.dot(p) / det, v = direction.dot(q) / det, at = ac.dot(q) / det;
        if (u < kEdge || v < kEdge || u + v > 1.0 - kEdge || at < 0.0 || !(at <= first.distanceMm)) return;
        first = {at, i};
    };
    struct Entry {
        std::int32_t child;
        float near;
        std::uint32_t count;
    };
    Entry stack[kStackSize];
    int top = 0;
    stack[top++] = {0, 0.0f, 0};
    // A direction along an axis: a slab's bounds then lie infinitely far to either side, as they should. Boxes are
    // looked at from the origin in float, so they are taken a hair larger by what that loses.
    const float from[3] = {static_cast<float>(origin.x()), static_cast<float>(origin.y()),
                           static_cast<float>(origin.z())};
    float slowness[3], slack = 1e-5f;
    for (int k = 0; k < 3; ++k) {
        const double d = std::abs(direction[k]) > 1e-12 ? direction[k] : std::copysign(1e-12, direction[k]);
        slowness[k] = static_cast<float>(1.0 / d);
        slack += 2e-7f * std::abs(from[k]);
    }
    while (top > 0) {
        const Entry entry = stack[--top];
        if (static_cast<double>(entry.near) > first.distanceMm) continue;
        if (entry.child < 0) {
            const auto begin = static_cast<std::uint32_t>(~entry.child);
            for (std::uint32_t i = begin; i < begin + entry.count; ++i)
                consider(i);
            continue;
        }
        const TreeNode& node = nodes_[static_cast<std::size_t>(entry.child)];
        const float(*low[3])[8] = {&node.minX, &node.minY, &node.minZ};
        const float(*high[3])[8] = {&node.maxX, &node.maxY, &node.maxZ};
        Floats enter{}, leave = Floats{} + std::numeric_limits<float>::max();
        for (int k = 0; k < 3; ++k) {
            const Floats a = (loadLanes(*low[k]) - slack - from[k]) * slowness[k];
            const Floats b = (loadLanes(*high[k]) + slack - from[k]) * slowness[k];
            const Floats in = a < b ? a : b, out = a < b ? b : a;
            enter = in > enter ? in : enter;
            leave = out < leave ? out : leave;
        }
        float near[8], gone[8];
        __builtin_memcpy(near, &enter, sizeof near);
        __builtin_memcpy(gone, &leave, sizeof gone);
        const int base = top;
        for (int lane = 0; lane < node.lanes; ++lane) {
            const float begins = near[lane] * (1.0f - 1e-5f);
            if (!(begins <= gone[lane] * (1.0f + 1e-5f)) || static_cast<double>(begins) > first.distanceMm) continue;
            int i = top++;
            for (; i > base && stack[i - 1].near < begins; --i)
                stack[i] = stack[i - 1];
            stack[i] = {node.child[lane], begins, node.count[lane]};
        }
    }
    return first;
}

}  // namespace handpiece::geometry
