// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/fit_creases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "handpiece/base/core/parallel.h"

namespace handpiece::geometry {
namespace {

using core::Mat3;
using core::Vec3;

constexpr int kRounds = 3;
/// Cosines: between two triangles with an edge, that bend there; between a plane and the mean normal of those around a
/// vertex, that lies on a crease.
constexpr double kBent = 0.955, kCrease = 0.95;
/// Weight that holds a vertex where it is along what the planes leave free.
constexpr double kHold = 0.05;
/// A vertex goes at most so far at once, in cells.
constexpr double kMostStep = 0.5;
/// A triangle's normal before and after: less, and it is about to turn over.
constexpr double kLeastTurn = 0.5;
/// Area over the sum of squared edges (0.144 when equilateral), below which a triangle is a sliver.
constexpr double kLeastShape = 0.02;
constexpr std::uint32_t kNone = 0xffffffffu;

struct Plane {
    Vec3 point = Vec3::Zero(), normal = Vec3::Zero();
};

/// From four samples at the corners of a small tetrahedron.
Plane planeAt(const ScalarFunction& f, const Vec3& p, double e) {
    const double a = f(p + Vec3(e, e, e)), b = f(p + Vec3(e, -e, -e)), c = f(p + Vec3(-e, e, -e)),
                 d = f(p + Vec3(-e, -e, e));
    const Vec3 gradient = Vec3(a + b - c - d, a - b + c - d, a - b - c + d) / (4.0 * e);
    const double squared = gradient.squaredNorm();
    if (!(squared > 1e-6)) return {p, Vec3::Zero()};
    return {p - 0.25 * (a + b + c + d) / squared * gradient, gradient / std::sqrt(squared)};
}

class Fitter {
  public:
    Fitter(TriangleMesh& mesh, const ScalarFunction& f, double spacingMm) : mesh_(mesh), f_(f), h_(spacingMm) {}

    void round() {
        findFans();
        findBent();
        findPlanes();
        moveVertices();
        turnEdges();
    }

  private:
    [[nodiscard]] Vec3 doubledNormal(const Triangle& t) const {
        return (mesh_.vertices[t[1]] - mesh_.vertices[t[0]]).cross(mesh_.vertices[t[2]] - mesh_.vertices[t[0]]);
    }
    [[nodiscard]] double shapeOf(const Triangle& t) const {
        const Vec3 &a = mesh_.vertices[t[0]], &b = mesh_.vertices[t[1]], &c = mesh_.vertices[t[2]];
        const double edges = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
        return edges > 0.0 ? 0.5 * doubledNormal(t).norm() / edges : 0.0;
    }

    void findFans() {
        fans_.assign(mesh_.vertices.size(), {});
        for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
            for (const std::uint32_t v : mesh_.triangles[t])
                fans_[v].push_back(t);
    }
    /// The triangle with an edge that runs from a to b; kNone.
    [[nodiscard]] std::uint32_t withEdge(std::uint32_t a, std::uint32_t b) const {
        for (const std::uint32_t t : fans_[a])
            for (std::size_t k = 0; k < 3; ++k)
                if (mesh_.triangles[t][k] == a && mesh_.triangles[t][(k + 1) % 3] == b) return t;
        return kNone;
    }

    /// Vertices of triangles that bend at an edge.
    void findBent() {
        std::vector<Vec3> normals(mesh_.triangles.size());
        core::parallelFor(normals.size(), 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t)
                normals[t] = doubledNormal(mesh_.triangles[t]).normalized();
        });
        isBent_.assign(mesh_.vertices.size(), 0);
        for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t a = mesh_.triangles[t][k], b = mesh_.triangles[t][(k + 1) % 3];
                if (a > b) continue;
                const std::uint32_t other = withEdge(b, a);
                if (other == kNone || normals[t].dot(normals[other]) >= kBent) continue;
                for (const std::uint32_t v : mesh_.triangles[t])
                    isBent_[v] = 1;
                for (const std::uint32_t v : mesh_.triangles[other])
                    isBent_[v] = 1;
            }
        bent_.clear();
        for (std::uint32_t v = 0; v < isBent_.size(); ++v)
            if (isBent_[v] != 0) bent_.push_back(v);
    }

    /// The surface's planes over the middles of all triangles round those vertices.
    void findPlanes() {
        std::vector<std::uint32_t> asked;
        for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
            const Triangle& c = mesh_.triangles[t];
            if (isBent_[c[0]] != 0 || isBent_[c[1]] != 0 || isBent_[c[2]] != 0) asked.push_back(t);
        }
        planes_.assign(mesh_.triangles.size(), {});
        core::parallelFor(asked.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                planes_[asked[i]] = planeOver(mesh_.triangles[asked[i]]);
        });
    }
    [[nodiscard]] Plane planeOver(const Triangle& t) const {
        return planeAt(f_, (mesh_.vertices[t[0]] + mesh_.vertices[t[1]] + mesh_.vertices[t[2]]) / 3.0, 0.02 * h_);
    }

    void moveVertices() {
        std::vector<Vec3> target(bent_.size());
        isCrease_.assign(mesh_.vertices.size(), 0);
        core::parallelFor(bent_.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const std::uint32_t v = bent_[i];
                const Vec3& p = mesh_.vertices[v];
                target[i] = p;
                Vec3 mean = Vec3::Zero();
                for (const std::uint32_t t : fans_[v])
                    mean += planes_[t].normal;
                if (!(mean.norm() > 1e-6)) continue;
                mean.normalize();
                double least = 1.0;
                Mat3 a = kHold * static_cast<double>(fans_[v].size()) * Mat3::Identity();
                Vec3 b = Vec3::Zero();
                for (const std::uint32_t t : fans_[v]) {
                    const Vec3& n = planes_[t].normal;
                    least = std::min(least, n.dot(mean));
                    a += n * n.transpose();
                    b += n * n.dot(planes_[t].point - p);
                }
                if (least >= kCrease) continue;
                isCrease_[v] = 1;
                Vec3 step = a.ldlt().solve(b);
                if (const double length = step.norm(); length > kMostStep * h_) step *= kMostStep * h_ / length;
                // A crease is a little round: onto its floor.
                const Plane on = planeAt(f_, p + step, 0.02 * h_);
                const Vec3 last = on.point - (p + step);
                target[i] = p + step + last * std::min(1.0, kMostStep * h_ / std::max(1e-12, last.norm()));
            }
        });
        for (std::size_t i = 0; i < bent_.size(); ++i)
            if (isCrease_[bent_[i]] != 0) move(bent_[i], target[i]);
    }

    /// As far as no triangle turns over or becomes a sliver.
    void move(std::uint32_t v, const Vec3& to) {
        const Vec3 from = mesh_.vertices[v];
        std::vector<Vec3> before;
        for (const std::uint32_t t : fans_[v])
            before.push_back(doubledNormal(mesh_.triangles[t]).normalized());
        for (double share = 1.0; share > 0.2; share *= 0.5) {
            mesh_.vertices[v] = from + share * (to - from);
            bool isSound = true;
            for (std::size_t i = 0; i < before.size() && isSound; ++i) {
                const Triangle& t = mesh_.triangles[fans_[v][i]];
                isSound = shapeOf(t) >= kLeastShape && doubledNormal(t).normalized().dot(before[i]) >= kLeastTurn;
            }
            if (isSound) return;
        }
        mesh_.vertices[v] = from;
    }

    /// Edges across a crease, between two vertices on it: turned, where both triangles then lie better on the surface.
    void turnEdges() {
        for (const std::uint32_t v : bent_)
            for (std::size_t i = 0; i < fans_[v].size(); ++i) {
                const std::uint32_t t = fans_[v][i];
                std::size_t k = 0;
                while (mesh_.triangles[t][k] != v)
                    ++k;
                if (turn(t, k)) break;
            }
    }
    /// The edge that begins at corner k of triangle t.
    bool turn(std::uint32_t t, std::size_t k) {
        const std::uint32_t a = mesh_.triangles[t][k], b = mesh_.triangles[t][(k + 1) % 3],
                            c = mesh_.triangles[t][(k + 2) % 3];
        if (a > b || isCrease_[c] == 0 || (isCrease_[a] != 0 && isCrease_[b] != 0)) return false;
        const std::uint32_t other = withEdge(b, a);
        if (other == kNone) return false;
        std::uint32_t d = kNone;
        for (const std::uint32_t v : mesh_.triangles[other])
            if (v != a && v != b) d = v;
        if (d == kNone || d == c || isCrease_[d] == 0) return false;
        if (withEdge(c, d) != kNone || withEdge(d, c) != kNone) return false;
        // A vertex keeps three triangles.
        if (fans_[a].size() < 5 || fans_[b].size() < 5) return false;
        const Triangle one = {c, a, d}, two = {d, b, c};
        const Triangle old[2] = {mesh_.triangles[t], mesh_.triangles[other]};
        if (std::min(shapeOf(one), shapeOf(two)) < kLeastShape) return false;
        const Vec3 about = (doubledNormal(old[0]) + doubledNormal(old[1])).normalized();
        if (doubledNormal(one).dot(about) <= 0.0 || doubledNormal(two).dot(about) <= 0.0) return false;
        const Plane onOne = planeOver(one), onTwo = planeOver(two);
        const auto lies = [&](const Triangle& of, const Plane& on) {
            const Vec3 n = doubledNormal(of);
            return n.norm() - n.dot(on.normal);
        };
        if (lies(one, onOne) + lies(two, onTwo) >= lies(old[0], planes_[t]) + lies(old[1], planes_[other]))
            return false;
        std::erase(fans_[a], other);
        std::erase(fans_[b], t);
        fans_[c].push_back(other);
        fans_[d].push_back(t);
        mesh_.triangles[t] = one;
        mesh_.triangles[other] = two;
        planes_[t] = onOne;
        planes_[other] = onTwo;
        return true;
    }

    TriangleMesh& mesh_;
    const ScalarFunction& f_;
    double h_;
    std::vector<std::vector<std::uint32_t>> fans_;  ///< by vertex: its triangles
    std::vector<std::uint8_t> isBent_, isCrease_;   ///< by vertex
    std::vector<std::uint32_t> bent_;
    std::vector<Plane> planes_;  ///< by triangle
};

}  // namespace

void fitCreases(TriangleMesh& mesh, const ScalarFunction& f, double spacingMm) {
    Fitter fitter(mesh, f, spacingMm);
    for (int i = 0; i < kRounds; ++i)
        fitter.round();
}

}  // namespace handpiece::geometry
