// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/decimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/point_triangle.h"
#include "handpiece/base/geometry/self_intersection.h"

namespace handpiece::geometry {
namespace {
using core::Vec3;

constexpr std::uint32_t kNone = 0xffffffffu;
/// Pulls the best point of a collapse towards the edge's middle where the planes leave it free, relative to their
/// weight.
constexpr double kMiddlePull = 1e-3;
/// Cost of an edge's squared length, relative to the weight of its planes: keeps flat places evenly meshed.
constexpr double kLengthCost = 1e-5;
/// A new triangle may turn by at most acos of this against the one it replaces.
constexpr double kMinTurn = 0.25;
/// Shape of a triangle, 4 sqrt(3) area / sum of squared edges (1 equilateral): below this only if it was worse before.
constexpr double kMinShape = 0.12;

/// Sum of weighted squared distances to planes: x'Ax + 2 b'x + c.
struct Quadric {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, bx = 0, by = 0, bz = 0, c = 0;

    void addPlane(const Vec3& n, double d, double weight) {
        xx += weight * n.x() * n.x(), xy += weight * n.x() * n.y(), xz += weight * n.x() * n.z();
        yy += weight * n.y() * n.y(), yz += weight * n.y() * n.z(), zz += weight * n.z() * n.z();
        bx += weight * d * n.x(), by += weight * d * n.y(), bz += weight * d * n.z(), c += weight * d * d;
    }
    Quadric& operator+=(const Quadric& o) {
        xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
        bx += o.bx, by += o.by, bz += o.bz, c += o.c;
        return *this;
    }
    [[nodiscard]] double trace() const { return xx + yy + zz; }
    [[nodiscard]] double at(const Vec3& p) const {
        const double x = p.x(), y = p.y(), z = p.z();
        return x * (xx * x + 2.0 * (xy * y + xz * z + bx)) + y * (yy * y + 2.0 * (yz * z + by)) +
               z * (zz * z + 2.0 * bz) + c;
    }
    /// Where the sum is least, drawn to `middle` in the directions that the planes do not fix.
    [[nodiscard]] Vec3 best(const Vec3& middle) const {
        const double pull = kMiddlePull * trace() + 1e-300;
        const double a = xx + pull, d = yy + pull, f = zz + pull, b = xy, e = yz, g = xz;
        const double rx = -(xx * middle.x() + xy * middle.y() + xz * middle.z() + bx);
        const double ry = -(xy * middle.x() + yy * middle.y() + yz * middle.z() + by);
        const double rz = -(xz * middle.x() + yz * middle.y() + zz * middle.z() + bz);
        const double c00 = d * f - e * e, c01 = e * g - b * f, c02 = b * e - d * g;
        const double determinant = a * c00 + b * c01 + g * c02;
        if (!(determinant > 0.0)) return middle;
        const double c11 = a * f - g * g, c12 = b * g - a * e, c22 = a * d - b * b;
        return middle +
               Vec3(c00 * rx + c01 * ry + c02 * rz, c01 * rx + c11 * ry + c12 * rz, c02 * rx + c12 * ry + c22 * rz) /
                   determinant;
    }
};

struct Candidate {
    float cost;
    std::uint32_t a, b;      ///< a < b
    std::uint32_t versions;  ///< of both ends together: one change makes the candidate stale

    // std::push_heap keeps the largest in front: the cheapest is the largest here, ties by index.
    friend bool operator<(const Candidate& l, const Candidate& r) {
        if (l.cost != r.cost) return l.cost > r.cost;
        if (l.a != r.a) return l.a > r.a;
        return l.b > r.b;
    }
};

constexpr std::uint32_t nextOf(std::uint32_t h) {
    return h % 3 == 2 ? h - 2 : h + 1;
}
constexpr std::uint32_t previousOf(std::uint32_t h) {
    return h % 3 == 0 ? h + 2 : h - 1;
}

/// The cheapest first, as one heap of all would give them. Only the cheapest part is kept as a heap, small enough for a
/// processor's cache; the dearer rest waits unsorted until its turn comes.
class CandidateQueue {
  public:
    void assign(std::vector<Candidate> all) {
        rest_ = std::move(all);
        near_.clear();
        limit_ = -1.0f;
    }
    void push(const Candidate& candidate) {
        if (candidate.cost > limit_) {
            rest_.push_back(candidate);
            return;
        }
        near_.push_back(candidate);
        std::push_heap(near_.begin(), near_.end());
    }
    /// False when there is none left. `isStale` tells which need not be kept.
    template <class IsStale>
    bool pop(Candidate& cheapest, const IsStale& isStale) {
        if (near_.empty()) refill(isStale);
        if (near_.empty()) return false;
        std::pop_heap(near_.begin(), near_.end());
        cheapest = near_.back();
        near_.pop_back();
        return true;
    }

  private:
    template <class IsStale>
    void refill(const IsStale& isStale) {
        constexpr std::size_t kLeast = 8192, kShare = 24;
        std::erase_if(rest_, isStale);
        if (rest_.empty()) return;
        const std::size_t count = std::min(rest_.size() - 1, std::max(kLeast, rest_.size() / kShare));
        // The larger of two candidates is the cheaper.
        const auto split = rest_.begin() + static_cast<std::ptrdiff_t>(count);
        std::nth_element(rest_.begin(), split, rest_.end(),
                         [](const Candidate& l, const Candidate& r) { return r < l; });
        limit_ = split->cost;
        const auto dearer = std::partition(split, rest_.end(), [&](const Candidate& c) { return !(c.cost > limit_); });
        near_.assign(rest_.begin(), dearer);
        rest_.erase(rest_.begin(), dearer);
        std::make_heap(near_.begin(), near_.end());
    }

    std::vector<Candidate> near_, rest_;
    float limit_ = -1.0f;  ///< all that costs no more is in near_
};

class Collapser {
  public:
    /// `isHeld`, by vertex: stays where it is; empty: none does.
    explicit Collapser(const TriangleMesh& mesh, std::vector<std::uint8_t> isHeld = {})
        : given_(mesh),
          isHeld_(std::move(isHeld)),
          origin_(mesh.vertices.empty() ? Vec3::Zero() : mesh.bounds().centre()) {
        const std::size_t vertices = mesh.vertices.size(), triangles = mesh.triangles.size();
        // About the middle: quadrics hold products of coordinates, and a tooth may lie far from the origin.
        position_.reserve(vertices);
        for (const Vec3& v : mesh.vertices)
            position_.push_back(v - origin_);
        corner_.resize(3 * triangles);
        for (std::size_t t = 0; t < triangles; ++t)
            for (std::size_t c = 0; c < 3; ++c)
                corner_[3 * t + c] = mesh.triangles[t][c];
        faces_ = triangles;
        isHeld_.resize(vertices, 0);
        pairEdges();
        quadric_.resize(vertices);
        for (std::size_t t = 0; t < triangles; ++t) {
            const Vec3 &a = position_[corner_[3 * t]], &b = position_[corner_[3 * t + 1]],
                       &c = position_[corner_[3 * t + 2]];
            Vec3 n = (b - a).cross(c - a);
            const double length = n.norm();
            if (!(length > 0.0)) continue;
            n /= length;
            Quadric q;
            q.addPlane(n, -n.dot(a), length);
            for (std::size_t k = 0; k < 3; ++k)
                quadric_[corner_[3 * t + k]] += q;
        }
        version_.assign(vertices, 0);
        mark_.assign(vertices, 0);
        parent_.resize(vertices);
        for (std::uint32_t v = 0; v < vertices; ++v)
            parent_[v] = v;
    }

    /// May be called again with a lower target: it goes on as if that had been asked for at once.
    void run(std::size_t target, const core::Progress& progress) {
        const std::size_t start = faces_;
        while (faces_ > target) {
            if (!isInRound_) {
                roundStart_ = faces_;
                fillQueue();
                isInRound_ = true;
            }
            std::size_t sinceReport = 0;
            Candidate candidate{};
            const auto isStale = [this](const Candidate& c) {
                return version_[c.a] + version_[c.b] != c.versions || parent_[c.a] != c.a || parent_[c.b] != c.b;
            };
            while (faces_ > target && queue_.pop(candidate, isStale)) {
                if (isStale(candidate)) continue;
                tryCollapse(candidate);
                if (++sinceReport % 16384 == 0)
                    core::report(progress, static_cast<double>(start - faces_) / static_cast<double>(start - target));
            }
            if (faces_ <= target) return;
            // Edges that were refused may have become possible since; a round that gained nothing is the end.
            isInRound_ = false;
            if (faces_ == roundStart_) return;
        }
    }

    [[nodiscard]] TriangleMesh mesh() const {
        TriangleMesh out;
        std::vector<std::uint32_t> newIndex(position_.size(), kNone);
        for (std::size_t v = 0; v < position_.size(); ++v)
            if (parent_[v] == v && outgoing_[v] != kNone) {
                newIndex[v] = static_cast<std::uint32_t>(out.vertices.size());
                out.vertices.push_back(position_[v] + origin_);
            }
        out.triangles.reserve(faces_);
        for (std::size_t h = 0; h < corner_.size(); h += 3)
            if (corner_[h] != kNone)
                out.triangles.push_back({newIndex[corner_[h]], newIndex[corner_[h + 1]], newIndex[corner_[h + 2]]});
        return out;
    }
    [[nodiscard]] Decimated result() { return {mesh(), measureError()}; }

  private:
    [[noreturn]] static void notClosed(std::size_t edges) {
        throw core::Error(
            fmt::format("the surface is not closed and consistently oriented: {} edges have no partner", edges),
            "decimate", "repair the mesh first");
    }

    // Twins by sorting half-edges by their lower vertex, then matching within each small bucket.
    void pairEdges() {
        const std::size_t vertices = position_.size(), count = corner_.size();
        twin_.assign(count, kNone);
        outgoing_.assign(vertices, kNone);
        std::vector<std::uint32_t> first(vertices + 1, 0);
        for (std::uint32_t h = 0; h < count; ++h) {
            if (corner_[h] >= vertices)
                throw core::Error(fmt::format("triangle {} names a vertex that is not there", h / 3), "decimate");
            ++first[std::min(corner_[h], corner_[nextOf(h)]) + 1];
        }
        for (std::size_t v = 0; v < vertices; ++v)
            first[v + 1] += first[v];
        std::vector<std::uint32_t> bucket(count), fill(first.begin(), first.end() - 1);
        for (std::uint32_t h = 0; h < count; ++h)
            bucket[fill[std::min(corner_[h], corner_[nextOf(h)])]++] = h;
        std::size_t alone = 0;
        for (std::size_t v = 0; v < vertices; ++v)
            for (std::uint32_t i = first[v]; i < first[v + 1]; ++i) {
                const std::uint32_t h = bucket[i];
                if (twin_[h] != kNone) continue;
                for (std::uint32_t j = i + 1; j < first[v + 1]; ++j) {
                    const std::uint32_t g = bucket[j];
                    if (twin_[g] == kNone && corner_[g] == corner_[nextOf(h)] && corner_[nextOf(g)] == corner_[h]) {
                        twin_[h] = g;
                        twin_[g] = h;
                        break;
                    }
                }
                if (twin_[h] == kNone) ++alone;
            }
        if (alone > 0) notClosed(alone);
        for (std::uint32_t h = 0; h < count; ++h)
            outgoing_[corner_[h]] = h;
        // One fan a vertex: two cones that meet in a point would lose one of them.
        std::vector<std::uint32_t> degree(vertices, 0);
        for (const std::uint32_t v : corner_)
            ++degree[v];
        for (std::uint32_t v = 0; v < vertices; ++v) {
            std::uint32_t around = 0;
            if (outgoing_[v] != kNone) forRing(v, [&](std::uint32_t) { ++around; });
            if (around != degree[v])
                throw core::Error(fmt::format("vertex {} joins two separate fans of triangles", v), "decimate",
                                  "repair the mesh first");
        }
    }

    /// Calls visit(h) for every half-edge that leaves v, in turn.
    template <class Visit>
    void forRing(std::uint32_t v, const Visit& visit) const {
        const std::uint32_t start = outgoing_[v];
        std::uint32_t h = start;
        do {
            visit(h);
            h = twin_[previousOf(h)];
        } while (h != start);
    }

    [[nodiscard]] Candidate candidateOf(std::uint32_t a, std::uint32_t b) const {
        if (a > b) std::swap(a, b);
        Quadric q = quadric_[a];
        q += quadric_[b];
        const Vec3 p = q.best(0.5 * (position_[a] + position_[b]));
        const double cost =
            std::max(0.0, q.at(p)) + kLengthCost * q.trace() * (position_[a] - position_[b]).squaredNorm();
        return {static_cast<float>(cost), a, b, version_[a] + version_[b]};
    }

    void fillQueue() {
        std::vector<std::uint32_t> edges;
        edges.reserve(faces_ * 3 / 2);
        for (std::uint32_t h = 0; h < corner_.size(); ++h)
            if (corner_[h] != kNone && h < twin_[h] && isHeld_[corner_[h]] + isHeld_[corner_[nextOf(h)]] == 0)
                edges.push_back(h);
        std::vector<Candidate> all(edges.size());
        core::parallelFor(edges.size(), 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                all[i] = candidateOf(corner_[edges[i]], corner_[nextOf(edges[i])]);
        });
        queue_.assign(std::move(all));
    }

    void tryCollapse(const Candidate& candidate) {
        if (faces_ <= 4) return;
        const std::uint32_t a = candidate.a, b = candidate.b;
        std::uint32_t h = kNone;
        forRing(a, [&](std::uint32_t g) {
            if (corner_[nextOf(g)] == b) h = g;
        });
        if (h == kNone || !linkHolds(a, b)) return;
        Quadric q = quadric_[a];
        q += quadric_[b];
        const Vec3 p = q.best(0.5 * (position_[a] + position_[b]));
        if (!keepsShape(a, b, p) || !keepsShape(b, a, p)) return;

        const std::uint32_t g = twin_[h];
        const std::uint32_t hNext = nextOf(h), hPrevious = previousOf(h), gNext = nextOf(g), gPrevious = previousOf(g);
        const std::uint32_t left = corner_[hPrevious], right = corner_[gPrevious];
        ring_.clear();
        forRing(b, [&](std::uint32_t e) { ring_.push_back(e); });
        for (const std::uint32_t e : ring_)
            corner_[e] = a;
        const std::uint32_t t0 = twin_[hNext], t1 = twin_[hPrevious], t2 = twin_[gNext], t3 = twin_[gPrevious];
        twin_[t0] = t1, twin_[t1] = t0, twin_[t2] = t3, twin_[t3] = t2;
        for (const std::uint32_t e : {h, hNext, hPrevious, g, gNext, gPrevious})
            corner_[e] = kNone;
        outgoing_[a] = t1;
        outgoing_[left] = t0;
        outgoing_[right] = t2;
        position_[a] = p;
        quadric_[a] = q;
        parent_[b] = a;
        faces_ -= 2;
        ++version_[a];
        forRing(a, [&](std::uint32_t e) {
            if (const std::uint32_t v = corner_[nextOf(e)]; isHeld_[v] == 0) queue_.push(candidateOf(a, v));
        });
    }

    // The two ends share exactly the two corners opposite their edge: the collapse keeps the surface two-manifold.
    [[nodiscard]] bool linkHolds(std::uint32_t a, std::uint32_t b) {
        ++markNow_;
        forRing(a, [&](std::uint32_t e) { mark_[corner_[nextOf(e)]] = markNow_; });
        int shared = 0, valence = 0;
        forRing(b, [&](std::uint32_t e) {
            shared += mark_[corner_[nextOf(e)]] == markNow_;
            ++valence;
        });
        int valenceA = 0;
        forRing(a, [&](std::uint32_t) { ++valenceA; });
        // A corner of three triangles would be left with two.
        return shared == 2 && valence + valenceA - 4 >= 3 && !hasThree(a, b);
    }
    [[nodiscard]] bool hasThree(std::uint32_t a, std::uint32_t b) const {
        bool three = false;
        forRing(a, [&](std::uint32_t e) {
            if (corner_[nextOf(e)] != b) return;
            for (const std::uint32_t v : {corner_[previousOf(e)], corner_[previousOf(twin_[e])]}) {
                int count = 0;
                forRing(v, [&](std::uint32_t) { ++count; });
                three |= count <= 3;
            }
        });
        return three;
    }

    /// Whether the triangles of `a` without `b` stay the right way round and well shaped with a at p.
    [[nodiscard]] bool keepsShape(std::uint32_t a, std::uint32_t b, const Vec3& p) const {
        bool good = true;
        forRing(a, [&](std::uint32_t e) {
            const std::uint32_t v = corner_[nextOf(e)], w = corner_[previousOf(e)];
            if (!good || v == b || w == b) return;
            const Vec3 &pv = position_[v], &pw = position_[w], &pa = position_[a];
            const Vec3 edge = pw - pv, was = (pv - pa).cross(edge), is = (pv - p).cross(edge);
            const double wasLength = was.norm(), isLength = is.norm();
            if (!(is.dot(was) > kMinTurn * isLength * wasLength)) {
                good = false;
                return;
            }
            const double sides = edge.squaredNorm();
            const double isShape =
                2.0 * std::sqrt(3.0) * isLength / (sides + (pv - p).squaredNorm() + (pw - p).squaredNorm());
            if (isShape >= kMinShape) return;
            const double wasShape =
                2.0 * std::sqrt(3.0) * wasLength / (sides + (pv - pa).squaredNorm() + (pw - pa).squaredNorm());
            good = isShape > wasShape;
        });
        return good;
    }

    // Every given vertex against the triangles about the vertex that swallowed it, and about that one's neighbours.
    [[nodiscard]] double measureError() {
        for (std::uint32_t v = 0; v < parent_.size(); ++v) {
            std::uint32_t root = v;
            while (parent_[root] != root)
                root = parent_[root];
            for (std::uint32_t u = v; parent_[u] != root;)
                u = std::exchange(parent_[u], root);
        }
        std::vector<double> squared(position_.size(), 0.0);
        core::parallelFor(position_.size(), 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t v = begin; v < end; ++v) {
                const std::uint32_t root = parent_[v];
                if (outgoing_[root] == kNone) continue;
                const Vec3 p = given_.vertices[v] - origin_;
                double best = std::numeric_limits<double>::infinity();
                const auto look = [&](std::uint32_t e) {
                    best = std::min(best, squaredDistance(p, position_[corner_[e]], position_[corner_[nextOf(e)]],
                                                          position_[corner_[previousOf(e)]]));
                };
                forRing(root, look);
                if (best > 1e-10) forRing(root, [&](std::uint32_t e) { forRing(corner_[nextOf(e)], look); });
                squared[v] = best;
            }
        });
        double largest = 0.0;
        for (const double s : squared)
            largest = std::max(largest, s);
        return std::sqrt(largest);
    }

    const TriangleMesh& given_;
    std::vector<std::uint8_t> isHeld_;
    Vec3 origin_;
    std::vector<Vec3> position_;
    std::vector<Quadric> quadric_;
    std::vector<std::uint32_t> corner_;  ///< origin of half-edge h of triangle h / 3; kNone when the triangle is gone
    std::vector<std::uint32_t> twin_;
    std::vector<std::uint32_t> outgoing_;  ///< one half-edge of each vertex
    std::vector<std::uint32_t> version_, parent_;
    std::vector<std::uint32_t> mark_;
    std::uint32_t markNow_ = 0;
    std::vector<std::uint32_t> ring_;
    CandidateQueue queue_;
    std::size_t faces_ = 0, roundStart_ = 0;
    bool isInRound_ = false;
};

}  // namespace

std::vector<Decimated> decimateSteps(const TriangleMesh& mesh, std::span<const std::size_t> targets,
                                     const core::Progress& progress) {
    for (const std::size_t target : targets)
        if (target < 4)
            throw core::Error(fmt::format("a closed surface has at least 4 faces, {} were asked for", target),
                              "decimate");
    std::vector<std::size_t> order(targets.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return targets[a] > targets[b]; });
    std::vector<Decimated> steps(targets.size());
    if (targets.empty()) return steps;
    Collapser collapser(mesh);
    // The share of the collapses done says how far it is.
    const auto left = [&](std::size_t faces) {
        const std::size_t least = targets[order.back()], all = std::max(mesh.triangles.size(), least + 1);
        return 1.0 - static_cast<double>(std::min(faces, all) - least) / static_cast<double>(all - least);
    };
    std::size_t faces = mesh.triangles.size();
    for (const std::size_t i : order) {
        const std::size_t target = targets[i] + targets[i] % 2;
        collapser.run(target, core::part(progress, left(faces), left(target)));
        steps[i] = collapser.result();
        faces = std::min(faces, target);
    }
    core::report(progress, 1.0);
    return steps;
}

Decimated decimate(const TriangleMesh& mesh, std::size_t targetFaces, const core::Progress& progress) {
    return std::move(decimateSteps(mesh, std::span(&targetFaces, 1), progress).front());
}

std::optional<TriangleMesh> decimateUncrossed(const TriangleMesh& mesh, std::size_t targetFaces, double holdMm,
                                              const core::Progress& progress) {
    constexpr int kTries = 6;
    std::vector<std::uint8_t> isHeld(mesh.vertices.size(), 0);
    for (int i = 0; i < kTries; ++i) {
        Collapser collapser(mesh, isHeld);
        collapser.run(targetFaces + targetFaces % 2,
                      core::part(progress, static_cast<double>(i) / kTries, static_cast<double>(i + 1) / kTries));
        TriangleMesh made = collapser.mesh();
        const std::vector<CrossingFaces> crossings = selfIntersections(made);
        if (crossings.empty()) return made;
        for (const CrossingFaces& crossing : crossings)
            for (std::size_t v = 0; v < isHeld.size(); ++v)
                if ((mesh.vertices[v] - crossing.pointMm).squaredNorm() < holdMm * holdMm) isHeld[v] = 1;
    }
    return std::nullopt;
}

}  // namespace handpiece::geometry
