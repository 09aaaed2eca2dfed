// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/epa.h"

namespace handpiece::geometry {
namespace {

// A face sees a point this little below its plane too: coplanar faces are replaced together, which keeps slivers out.
constexpr double kCoplanarMm = 1e-11;
// New corners of the first tetrahedron must stand off the old ones by this.
constexpr double kThinMm = 1e-9;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t index(int i) {
    return static_cast<std::size_t>(i);
}

double offLine(const core::Vec3& p, const core::Vec3& a, const core::Vec3& b) {
    const core::Vec3 edge = b - a;
    const double length = edge.norm();
    return length > 0.0 ? edge.cross(p - a).norm() / length : (p - a).norm();
}

double offPlane(const core::Vec3& p, const core::Vec3& a, const core::Vec3& b, const core::Vec3& c) {
    const core::Vec3 n = (b - a).cross(c - a);
    const double length = n.norm();
    return length > 0.0 ? n.dot(p - a) / length : 0.0;
}

}  // namespace

bool PenetrationSolver::makeFace(int slot, int v0, int v1, int v2) noexcept {
    Face& face = faces_[index(slot)];
    const core::Vec3 &a = at(v0).point, &b = at(v1).point, &c = at(v2).point;
    const core::Vec3 ab = b - a, ac = c - a, n = ab.cross(ac);
    const double length = n.norm();
    if (!(length > 1e-13 * std::sqrt(ab.squaredNorm() * ac.squaredNorm()))) return false;
    face.normal = n / length;
    face.vertex = {static_cast<std::int16_t>(v0), static_cast<std::int16_t>(v1), static_cast<std::int16_t>(v2)};
    face.visible = false;
    face.settled = false;
    distance_[index(slot)] = face.normal.dot(a.squaredNorm() < b.squaredNorm() ? a : b);
    return true;
}

// A tetrahedron of A - B with volume that holds the origin: the simplex, and more corners where GJK stopped at a
// feature that passes through the origin.
bool PenetrationSolver::buildTetrahedron(const HullPair& pair, const Simplex& simplex) noexcept {
    vertexCount_ = faceCount_ = freeCount_ = 0;
    for (int i = 0; i < simplex.count; ++i)
        vertices_[index(vertexCount_++)] = simplex.vertices[index(i)];
    if (vertexCount_ == 4 && std::abs(offPlane(at(3).point, at(0).point, at(1).point, at(2).point)) < kThinMm)
        vertexCount_ = 3;
    if (vertexCount_ == 3 && offLine(at(2).point, at(0).point, at(1).point) < kThinMm) vertexCount_ = 2;
    if (vertexCount_ == 2 && (at(1).point - at(0).point).norm() < kThinMm) vertexCount_ = 1;
    if (vertexCount_ == 1) {
        double best = kThinMm;
        for (int k = 0; k < 6; ++k) {
            const DifferenceVertex w = pair.support(core::Vec3::Unit(k / 2) * (k % 2 == 0 ? 1.0 : -1.0));
            const double off = (w.point - at(0).point).norm();
            if (off <= best) continue;
            best = off;
            vertices_[1] = w;
            vertexCount_ = 2;
        }
    }
    if (vertexCount_ == 2) {
        const core::Vec3 edge = (at(1).point - at(0).point).normalized();
        const core::Vec3 side = edge.unitOrthogonal(), other = edge.cross(side);
        double best = kThinMm;
        for (const core::Vec3& direction : {side, core::Vec3(-side), other, core::Vec3(-other)}) {
            const DifferenceVertex w = pair.support(direction);
            const double off = offLine(w.point, at(0).point, at(1).point);
            if (off <= best) continue;
            best = off;
            vertices_[2] = w;
            vertexCount_ = 3;
        }
    }
    if (vertexCount_ == 3) {
        const core::Vec3 n = (at(1).point - at(0).point).cross(at(2).point - at(0).point).normalized();
        double best = kThinMm;
        for (const core::Vec3& direction : {n, core::Vec3(-n)}) {
            const DifferenceVertex w = pair.support(direction);
            const double off = std::abs(offPlane(w.point, at(0).point, at(1).point, at(2).point));
            if (off <= best) continue;
            best = off;
            vertices_[3] = w;
            vertexCount_ = 4;
        }
    }
    if (vertexCount_ < 4) return false;
    if (offPlane(at(3).point, at(0).point, at(1).point, at(2).point) > 0.0) std::swap(vertices_[0], vertices_[1]);
    faceCount_ = 4;
    if (!makeFace(0, 0, 1, 2) || !makeFace(1, 0, 3, 1) || !makeFace(2, 1, 3, 2) || !makeFace(3, 2, 3, 0)) return false;
    const auto join = [&](int f, int i, int g, int j) {
        faces_[index(f)].across[index(i)] = static_cast<std::int16_t>(g);
        faces_[index(f)].acrossEdge[index(i)] = static_cast<std::int8_t>(j);
        faces_[index(g)].across[index(j)] = static_cast<std::int16_t>(f);
        faces_[index(g)].acrossEdge[index(j)] = static_cast<std::int8_t>(i);
    };
    join(0, 0, 1, 2);  // 0-1
    join(0, 1, 2, 2);  // 1-2
    join(0, 2, 3, 2);  // 2-0
    join(1, 0, 3, 1);  // 0-3
    join(1, 1, 2, 0);  // 3-1
    join(2, 1, 3, 0);  // 3-2
    return true;
}

// Marks the faces that see `w`, from `seenFrom` outwards, and lists the edges around them, counter-clockwise.
int PenetrationSolver::findHorizon(int seenFrom, const core::Vec3& w) noexcept {
    removedCount_ = 0;
    int horizonCount = 0, depth = 0;
    const auto remove = [&](int f) {
        faces_[index(f)].visible = true;
        removed_[index(removedCount_++)] = static_cast<std::int16_t>(f);
    };
    const auto push = [&](int f, int i) {
        stack_[index(depth++)] = {faces_[index(f)].across[index(i)], faces_[index(f)].acrossEdge[index(i)]};
    };
    remove(seenFrom);
    for (int i = 2; i >= 0; --i)
        push(seenFrom, i);
    while (depth > 0) {
        const Edge edge = stack_[index(--depth)];
        const Face& face = faces_[index(edge.face)];
        if (face.visible) continue;
        if (face.normal.dot(w) - distance_[index(edge.face)] < -kCoplanarMm) {
            if (horizonCount == kMaxFaces) return 0;
            horizon_[index(horizonCount++)] = edge;
        } else {
            remove(edge.face);
            push(edge.face, (edge.edge + 2) % 3);
            push(edge.face, (edge.edge + 1) % 3);
        }
    }
    return horizonCount;
}

// Replaces the faces that see `w` by a fan from it to their outline. False, and nothing changed, when rounding has made
// the outline or a new face unsound, or when there is no room.
bool PenetrationSolver::addVertex(int seenFrom, const DifferenceVertex& w) noexcept {
    const int count = findHorizon(seenFrom, w.point);
    const auto start = [&](int k) {
        const Edge& e = horizon_[index(k)];
        return static_cast<int>(faces_[index(e.face)].vertex[index((e.edge + 1) % 3)]);
    };
    const auto end = [&](int k) {
        const Edge& e = horizon_[index(k)];
        return static_cast<int>(faces_[index(e.face)].vertex[index(e.edge)]);
    };
    bool sound = count >= 3 && vertexCount_ < kMaxVertices && faceCount_ - freeCount_ + count <= kMaxFaces;
    for (int k = 0; sound && k < count; ++k)
        sound = end(k) == start((k + 1) % count);

    // New faces go to free slots only, so that everything can be undone.
    std::array<std::int16_t, kMaxFaces>& slots = newSlots_;
    const int faceCountBefore = faceCount_, freeCountBefore = freeCount_;
    int made = 0;
    if (sound) vertices_[index(vertexCount_)] = w;
    for (; sound && made < count; ++made) {
        const int slot = freeCount_ > 0 ? free_[index(--freeCount_)] : faceCount_ < kMaxFaces ? faceCount_++ : -1;
        if (slot < 0) {
            sound = false;
            break;
        }
        slots[index(made)] = static_cast<std::int16_t>(slot);
        sound = makeFace(slot, start(made), end(made), vertexCount_) && distance_[index(slot)] > -10.0 * kTouchMm;
    }
    if (!sound) {
        // Slots were taken from the top of the free list, which still holds their numbers.
        freeCount_ = freeCountBefore;
        for (int i = 0; i < freeCount_; ++i)
            distance_[index(free_[index(i)])] = kInfinity;
        faceCount_ = faceCountBefore;
        for (int i = 0; i < removedCount_; ++i)
            faces_[index(removed_[index(i)])].visible = false;
        return false;
    }
    for (int k = 0; k < count; ++k) {
        Face& face = faces_[index(slots[index(k)])];
        const Edge outer = horizon_[index(k)];
        const std::int16_t next = slots[index((k + 1) % count)], previous = slots[index((k + count - 1) % count)];
        face.across = {outer.face, next, previous};
        face.acrossEdge = {outer.edge, 2, 1};
        faces_[index(outer.face)].across[index(outer.edge)] = slots[index(k)];
        faces_[index(outer.face)].acrossEdge[index(outer.edge)] = 0;
    }
    ++vertexCount_;
    for (int i = 0; i < removedCount_; ++i) {
        distance_[index(removed_[index(i)])] = kInfinity;
        free_[index(freeCount_++)] = removed_[index(i)];
    }
    return true;
}

bool PenetrationSolver::isKnown(const DifferenceVertex& w) const noexcept {
    for (int i = 0; i < vertexCount_; ++i)
        if (at(i).a == w.a && at(i).b == w.b) return true;
    return false;
}

int PenetrationSolver::nearestFace() const noexcept {
    int best = 0;
    double bestDistance = kInfinity;
    for (int i = 0; i < faceCount_; ++i) {
        if (distance_[index(i)] < bestDistance) {
            bestDistance = distance_[index(i)];
            best = i;
        }
    }
    return best;
}

// The corners of the face that decided last time: near the answer now, so the polytope starts with its detail there.
void PenetrationSolver::addSeeds(const HullPair& pair) noexcept {
    for (int s = 0; s < seedCount_; ++s) {
        const DifferenceVertex w = pair.vertex(seeds_[index(s)][0], seeds_[index(s)][1]);
        int seenFrom = -1;
        double most = 1e3 * kCoplanarMm;
        for (int i = 0; i < faceCount_; ++i) {
            if (distance_[index(i)] == kInfinity) continue;
            const double above = faces_[index(i)].normal.dot(w.point) - distance_[index(i)];
            if (above <= most) continue;
            most = above;
            seenFrom = i;
        }
        if (seenFrom >= 0 && !isKnown(w)) addVertex(seenFrom, w);
    }
}

Penetration PenetrationSolver::penetration(const HullPair& pair, const Simplex& simplex) noexcept {
    Penetration result;
    if (!buildTetrahedron(pair, simplex)) {
        result.converged = false;
        return result;
    }
    addSeeds(pair);
    int nearest = 0;
    for (;; ++result.iterations) {
        nearest = nearestFace();
        Face& face = faces_[index(nearest)];
        if (face.settled) break;
        const DifferenceVertex& hint = at(face.vertex[0]);
        const DifferenceVertex w = pair.support(face.normal, hint.a, hint.b);
        const double upper = face.normal.dot(w.point);
        if (upper - distance_[index(nearest)] <= kTouchMm) break;
        if (vertexCount_ == kMaxVertices) {
            result.converged = false;
            break;
        }
        if (isKnown(w) || !addVertex(nearest, w)) {
            // Rounding has bent this face: what its normal supports is still an upper bound of the depth, so count it
            // as that.
            distance_[index(nearest)] = upper;
            face.settled = true;
        }
    }

    const Face& face = faces_[index(nearest)];
    result.depthMm = std::max(0.0, distance_[index(nearest)]);
    result.normal = face.normal;
    // Weights of the foot of the origin on the face, kept inside it.
    std::array<double, 3> weight;
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const core::Vec3 &p = at(face.vertex[(i + 1) % 3]).point, &q = at(face.vertex[(i + 2) % 3]).point;
        weight[i] = std::max(0.0, face.normal.dot(p.cross(q)));
        sum += weight[i];
    }
    seedCount_ = 3;
    for (std::size_t i = 0; i < 3; ++i) {
        const DifferenceVertex& v = at(face.vertex[i]);
        result.pointOnA += (sum > 0.0 ? weight[i] / sum : 1.0 / 3.0) * v.onA;
        seeds_[i] = {v.a, v.b};
    }
    return result;
}

}  // namespace handpiece::geometry
