// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/gjk.h"

namespace handpiece::geometry {
namespace {

constexpr int kMaxIterations = 128;
// A tetrahedron flatter than this (volume over the product of its edges) is searched face by face instead of being
// trusted.
constexpr double kFlat = 1e-13;

/// The point of a simplex nearest to the origin and the corners that carry it.
struct Nearest {
    int count = 0;
    std::array<int, 4> corner{};
    std::array<double, 4> weight{};        ///< sums to 1
    core::Vec3 unit = core::Vec3::Zero();  ///< from the origin towards the point
    double distance = std::numeric_limits<double>::infinity();
    bool inside = false;
};
using Corners = std::array<DifferenceVertex, 4>;

Nearest nearestOfPoint(const Corners& s, int i) {
    Nearest r;
    r.count = 1;
    r.corner[0] = i;
    r.weight[0] = 1.0;
    r.distance = s[static_cast<std::size_t>(i)].point.norm();
    if (r.distance > 0.0) r.unit = s[static_cast<std::size_t>(i)].point / r.distance;
    return r;
}

Nearest nearestOfSegment(const Corners& s, int i, int j) {
    const core::Vec3 &a = s[static_cast<std::size_t>(i)].point, &b = s[static_cast<std::size_t>(j)].point;
    const core::Vec3 edge = b - a;
    const double length2 = edge.squaredNorm(), along = -a.dot(edge);
    if (!(along > 0.0) || length2 == 0.0) return nearestOfPoint(s, i);
    if (along >= length2) return nearestOfPoint(s, j);
    const double t = along / length2;
    Nearest r;
    r.count = 2;
    r.corner = {i, j};
    r.weight = {1.0 - t, t};
    const core::Vec3 v = t < 0.5 ? core::Vec3(a + t * edge) : core::Vec3(b - (1.0 - t) * edge);
    r.distance = v.norm();
    if (r.distance > 0.0) r.unit = v / r.distance;
    return r;
}

void keepNearer(Nearest& best, const Nearest& other) {
    if (other.distance < best.distance) best = other;
}

Nearest nearestOfTriangle(const Corners& s, int i, int j, int k) {
    const core::Vec3 &a = s[static_cast<std::size_t>(i)].point, &b = s[static_cast<std::size_t>(j)].point,
                     &c = s[static_cast<std::size_t>(k)].point;
    const core::Vec3 ab = b - a, ac = c - a, n = ab.cross(ac);
    const double n2 = n.squaredNorm();
    const bool degenerate = n2 <= 1e-28 * ab.squaredNorm() * ac.squaredNorm();
    // Signed areas of the triangles that the origin's projection forms with each edge, over the whole.
    const double wa = n.dot(b.cross(c)), wb = n.dot(c.cross(a)), wc = n.dot(a.cross(b));
    if (!degenerate && wa > 0.0 && wb > 0.0 && wc > 0.0) {
        Nearest r;
        r.count = 3;
        r.corner = {i, j, k};
        const double sum = wa + wb + wc;
        r.weight = {wa / sum, wb / sum, wc / sum};
        // The plane's own normal: near a touch the point itself is too short to tell a direction.
        const double length = std::sqrt(n2);
        const double height = n.dot(a.squaredNorm() < b.squaredNorm() ? a : b) / length;
        r.unit = n / (height < 0.0 ? -length : length);
        r.distance = std::abs(height);
        return r;
    }
    Nearest r;
    if (degenerate || wc <= 0.0) keepNearer(r, nearestOfSegment(s, i, j));
    if (degenerate || wb <= 0.0) keepNearer(r, nearestOfSegment(s, k, i));
    if (degenerate || wa <= 0.0) keepNearer(r, nearestOfSegment(s, j, k));
    return r;
}

Nearest nearestOfTetrahedron(const Corners& s) {
    const core::Vec3 &a = s[0].point, &b = s[1].point, &c = s[2].point, &d = s[3].point;
    const core::Vec3 ab = b - a, ac = c - a, ad = d - a;
    const double volume = ab.cross(ac).dot(ad);
    const bool flat = std::abs(volume) <= kFlat * ab.norm() * ac.norm() * ad.norm();
    // Signed volume of the origin with each face, as seen with the sign of the whole.
    const double sign = volume < 0.0 ? -1.0 : 1.0;
    const double va = sign * b.dot((c - b).cross(d - b)), vb = -sign * a.dot(ac.cross(ad)),
                 vc = sign * a.dot(ab.cross(ad)), vd = -sign * a.dot(ab.cross(ac));
    if (!flat && va > 0.0 && vb > 0.0 && vc > 0.0 && vd > 0.0) {
        Nearest r;
        r.count = 4;
        r.corner = {0, 1, 2, 3};
        r.distance = 0.0;
        r.inside = true;
        return r;
    }
    Nearest r;
    if (flat || vd <= 0.0) keepNearer(r, nearestOfTriangle(s, 0, 1, 2));
    if (flat || vc <= 0.0) keepNearer(r, nearestOfTriangle(s, 0, 1, 3));
    if (flat || vb <= 0.0) keepNearer(r, nearestOfTriangle(s, 0, 2, 3));
    if (flat || va <= 0.0) keepNearer(r, nearestOfTriangle(s, 1, 2, 3));
    return r;
}

Nearest nearestOf(const Simplex& simplex) {
    switch (simplex.count) {
        case 1:
            return nearestOfPoint(simplex.vertices, 0);
        case 2:
            return nearestOfSegment(simplex.vertices, 0, 1);
        case 3:
            return nearestOfTriangle(simplex.vertices, 0, 1, 2);
        default:
            return nearestOfTetrahedron(simplex.vertices);
    }
}

bool contains(const Simplex& simplex, const DifferenceVertex& w) {
    for (int i = 0; i < simplex.count; ++i) {
        const DifferenceVertex& v = simplex.vertices[static_cast<std::size_t>(i)];
        if (v.a == w.a && v.b == w.b) return true;
    }
    return false;
}

// Keeps the corners that carry the nearest point, in the order of their weights.
void reduce(Simplex& simplex, const Nearest& nearest) {
    Simplex reduced;
    reduced.count = nearest.count;
    for (std::size_t i = 0; i < static_cast<std::size_t>(nearest.count); ++i)
        reduced.vertices[i] = simplex.vertices[static_cast<std::size_t>(nearest.corner[i])];
    simplex = reduced;
}

}  // namespace

Separation separation(const HullPair& pair, SimplexSeed& seed) noexcept {
    Separation result;
    Simplex& simplex = result.simplex;
    for (int i = 0; i < seed.count; ++i) {
        const auto& [a, b] = seed.pairs[static_cast<std::size_t>(i)];
        const DifferenceVertex w = pair.vertex(a, b);
        if (!contains(simplex, w)) simplex.vertices[static_cast<std::size_t>(simplex.count++)] = w;
    }
    if (simplex.count == 0) {
        core::Vec3 first = -pair.centreDifferenceMm();
        if (first.squaredNorm() == 0.0) first = core::Vec3::UnitX();
        simplex.vertices[0] = pair.support(first);
        simplex.count = 1;
    }

    result.converged = false;
    Nearest nearest;
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
        const Nearest next = nearestOf(simplex);
        // Rounding can stall the descent: then the last simplex was the answer.
        if (iteration > 0 && !next.inside && next.distance >= nearest.distance) {
            simplex.count = nearest.count;
            result.converged = true;
            break;
        }
        nearest = next;
        reduce(simplex, nearest);
        if (nearest.inside || nearest.distance <= kTouchMm) {
            result.overlapping = true;
            result.converged = true;
            break;
        }
        const DifferenceVertex w = pair.support(-nearest.unit, simplex.vertices[0].a, simplex.vertices[0].b);
        const double lower = nearest.unit.dot(w.point);
        if (nearest.distance - lower <= kTouchMm || contains(simplex, w)) {
            result.converged = true;
            break;
        }
        simplex.vertices[static_cast<std::size_t>(simplex.count++)] = w;
    }

    seed.count = simplex.count;
    for (std::size_t i = 0; i < static_cast<std::size_t>(simplex.count); ++i)
        seed.pairs[i] = {simplex.vertices[i].a, simplex.vertices[i].b};
    result.distanceMm = nearest.distance;
    if (result.overlapping) {
        result.distanceMm = 0.0;
        return result;
    }
    result.direction = -nearest.unit;
    for (std::size_t i = 0; i < static_cast<std::size_t>(simplex.count); ++i)
        result.pointOnA += nearest.weight[i] * simplex.vertices[i].onA;
    result.pointOnB = result.pointOnA - nearest.distance * nearest.unit;
    return result;
}

}  // namespace handpiece::geometry
