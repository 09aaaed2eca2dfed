// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/simplify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "handpiece/base/geometry/point_triangle.h"

namespace handpiece::view {
namespace {

using gl::Vec3f;
using Index = std::uint16_t;

constexpr int kRounds = 24;
/// A new triangle's normal may lie off those of its corners by acos of this: what it shows is lit as before.
constexpr float kLeastCosine = 0.95f;
/// Shape of a triangle, area over the sum of its squared edges (0.144 when equilateral), below which it is a sliver.
constexpr float kLeastShape = 0.012f;
constexpr Index kNone = 0xffff;

Vec3f vec(const std::array<float, 3>& v) {
    return {v[0], v[1], v[2]};
}

/// Corners are vertices (place, normal, tissue); what stands in one place is one point.
class Patch {
  public:
    explicit Patch(std::span<const std::shared_ptr<const surface::BrickMesh>> meshes) {
        for (const auto& mesh : meshes) {
            const std::size_t first = vertices_.size();
            vertices_.insert(vertices_.end(), mesh->vertices.begin(), mesh->vertices.end());
            for (const auto& t : mesh->triangles)
                triangles_.push_back({static_cast<std::uint32_t>(first + t[0]),
                                      static_cast<std::uint32_t>(first + t[1]),
                                      static_cast<std::uint32_t>(first + t[2])});
        }
        mergeVertices();
    }
    /// More corners than a piece can number.
    [[nodiscard]] bool isTooLarge() const { return vertices_.size() >= kNone || triangles_.size() >= kNone; }

    void simplify(float mostMm) {
        most2_ = mostMm * mostMm;
        fans_.assign(points_.size(), {});
        held_.assign(triangles_.size(), {});
        for (std::size_t t = 0; t < triangles_.size(); ++t)
            for (const std::uint32_t v : triangles_[t])
                fans_[pointOf_[v]].push_back(static_cast<Index>(t));
        std::vector<bool> touched(points_.size());
        for (int round = 0; round < kRounds; ++round) {
            // Neighbours of what has gone wait for the next round: points go evenly.
            std::fill(touched.begin(), touched.end(), false);
            bool any = false;
            for (std::size_t p = 0; p < points_.size(); ++p) {
                if (touched[p] || !ringOf(static_cast<Index>(p))) continue;
                if (!takeOut(static_cast<Index>(p))) continue;
                any = true;
                for (const Corner& corner : ring_)
                    touched[corner.point] = true;
            }
            if (!any) break;
        }
    }

    [[nodiscard]] Simplified result() const {
        Simplified made;
        std::vector<Index> number(vertices_.size(), kNone);
        float worst2 = 0.0f;
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            if (isGone(t)) continue;
            std::array<Index, 3> corners{};
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t v = triangles_[t][k];
                if (number[v] == kNone) {
                    number[v] = static_cast<Index>(made.piece.vertices.size());
                    made.piece.vertices.push_back({vertices_[v].positionMm, packedNormal(vertices_[v].normal),
                                                   static_cast<std::uint8_t>(vertices_[v].tissue), 0, 0});
                }
                corners[k] = number[v];
            }
            made.piece.triangles.push_back(corners);
            for (const Index p : held_[t])
                worst2 = std::max(worst2, geometry::squaredDistance(points_[p], at(t, 0), at(t, 1), at(t, 2)));
        }
        made.errorMm = std::sqrt(worst2);
        return made;
    }

  private:
    struct Corner {
        Index point;
        std::uint32_t before, after;  ///< its vertex in the triangle that it ends, and in the one that it begins
    };

    void mergeVertices() {
        std::vector<std::uint32_t> order(vertices_.size());
        for (std::uint32_t i = 0; i < order.size(); ++i)
            order[i] = i;
        const auto key = [&](std::uint32_t i) {
            const surface::SurfaceVertex& v = vertices_[i];
            return std::tie(v.positionMm, v.normal, v.tissue);
        };
        std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
        std::vector<std::uint32_t> vertexOf(order.size());
        std::vector<surface::SurfaceVertex> merged;
        for (std::size_t i = 0; i < order.size(); ++i) {
            const surface::SurfaceVertex& v = vertices_[order[i]];
            if (merged.empty() || !(merged.back() == v)) {
                if (merged.empty() || merged.back().positionMm != v.positionMm) {
                    points_.push_back(vec(v.positionMm));
                    vertexCount_.push_back(0);
                }
                ++vertexCount_.back();
                merged.push_back(v);
                pointOf_.push_back(static_cast<Index>(points_.size() - 1));
            }
            vertexOf[order[i]] = static_cast<std::uint32_t>(merged.size() - 1);
        }
        vertices_ = std::move(merged);
        for (auto& t : triangles_)
            for (std::uint32_t& v : t)
                v = vertexOf[v];
        // Without area: both of its sides are one edge.
        std::erase_if(triangles_, [&](const auto& t) {
            return pointOf_[t[0]] == pointOf_[t[1]] || pointOf_[t[1]] == pointOf_[t[2]] ||
                   pointOf_[t[2]] == pointOf_[t[0]];
        });
    }

    [[nodiscard]] bool isGone(std::size_t t) const { return triangles_[t][0] == triangles_[t][1]; }
    [[nodiscard]] const Vec3f& at(std::size_t t, std::size_t k) const { return points_[pointOf_[triangles_[t][k]]]; }

    /// The points round one that may go, counter-clockwise; false for one that must stay.
    bool ringOf(Index p) {
        const std::vector<Index>& fan = fans_[p];
        if (vertexCount_[p] != 1 || fan.size() < 3) return false;
        ring_.clear();
        fan_.clear();
        std::size_t t = fan[0];
        for (std::size_t i = 0; i < fan.size(); ++i) {
            const auto& corners = triangles_[t];
            std::size_t k = 0;
            while (pointOf_[corners[k]] != p)
                ++k;
            const std::uint32_t begin = corners[(k + 1) % 3], end = corners[(k + 2) % 3];
            if (i > 0) ring_.back().after = begin;
            if (i == 0) ring_.push_back({pointOf_[begin], 0, begin});
            fan_.push_back(static_cast<Index>(t));
            if (pointOf_[end] == ring_[0].point) {
                ring_[0].before = end;
                return i + 1 == fan.size();
            }
            ring_.push_back({pointOf_[end], end, 0});
            const auto next = std::find_if(fan.begin(), fan.end(), [&](Index other) {
                const auto& c = triangles_[other];
                for (std::size_t m = 0; m < 3; ++m)
                    if (pointOf_[c[m]] == p) return pointOf_[c[(m + 1) % 3]] == ring_.back().point;
                return false;
            });
            if (next == fan.end()) return false;
            t = *next;
        }
        return false;
    }

    [[nodiscard]] bool areJoined(Index a, Index b) const {
        return std::any_of(fans_[a].begin(), fans_[a].end(), [&](Index t) {
            const auto& c = triangles_[t];
            return pointOf_[c[0]] == b || pointOf_[c[1]] == b || pointOf_[c[2]] == b;
        });
    }

    /// Takes the point out whose ring was found, and joins one of the ring to all the others.
    bool takeOut(Index p) {
        const std::size_t count = ring_.size();
        std::vector<std::pair<float, std::size_t>> towards;
        for (std::size_t u = 0; u < count; ++u)
            if (const float shape = shapeTowards(u); shape >= kLeastShape) towards.emplace_back(-shape, u);
        std::sort(towards.begin(), towards.end());
        if (towards.size() > 3) towards.resize(3);
        gathered_.assign(1, p);
        for (const Index t : fan_)
            gathered_.insert(gathered_.end(), held_[t].begin(), held_[t].end());
        for (const auto& [shape, u] : towards) {
            bool isNear = true;
            nearest_.clear();
            for (const Index g : gathered_) {
                float least = std::numeric_limits<float>::infinity();
                std::size_t which = 0;
                for (std::size_t i = 1; i + 1 < count; ++i) {
                    const float d = geometry::squaredDistance(points_[g], points_[ring_[u].point],
                                                              points_[ring_[(u + i) % count].point],
                                                              points_[ring_[(u + i + 1) % count].point]);
                    if (d >= least) continue;
                    least = d;
                    which = i;
                }
                isNear = least <= most2_;
                if (!isNear) break;
                nearest_.push_back(which);
            }
            if (!isNear) continue;
            join(u);
            return true;
        }
        return false;
    }

    /// Of the worst triangle when ring_[u] is joined to the others; 0 when that must not be.
    [[nodiscard]] float shapeTowards(std::size_t u) const {
        const std::size_t count = ring_.size();
        if (ring_[u].before != ring_[u].after) return 0.0f;
        const Vec3f& a = points_[ring_[u].point];
        const Vec3f normal = vec(vertices_[ring_[u].after].normal);
        float worst = std::numeric_limits<float>::infinity();
        for (std::size_t i = 1; i + 1 < count; ++i) {
            const Corner &one = ring_[(u + i) % count], &two = ring_[(u + i + 1) % count];
            if (i > 1 && areJoined(ring_[u].point, one.point)) return 0.0f;
            const Vec3f ab = points_[one.point] - a, ac = points_[two.point] - a, n = ab.cross(ac);
            const float length = n.norm();
            worst = std::min(worst, 0.5f * length / (ab.squaredNorm() + ac.squaredNorm() + (ac - ab).squaredNorm()));
            if (worst < kLeastShape) return 0.0f;
            const float least = kLeastCosine * length;
            if (n.dot(normal) < least || n.dot(vec(vertices_[one.after].normal)) < least ||
                n.dot(vec(vertices_[two.before].normal)) < least)
                return 0.0f;
        }
        return worst;
    }

    void join(std::size_t u) {
        const std::size_t count = ring_.size();
        for (std::size_t i = 0; i < count; ++i) {
            const Index t = fan_[i];
            for (const std::uint32_t v : triangles_[t])
                std::erase(fans_[pointOf_[v]], t);
            held_[t].clear();
            triangles_[t] = {0, 0, 0};
        }
        for (std::size_t i = 1; i + 1 < count; ++i) {
            const std::size_t from = (u + i) % count;
            const Index t = fan_[from];
            triangles_[t] = {ring_[u].after, ring_[from].after, ring_[(from + 1) % count].before};
            for (const std::uint32_t v : triangles_[t])
                fans_[pointOf_[v]].push_back(t);
            for (std::size_t g = 0; g < gathered_.size(); ++g)
                if (nearest_[g] == i) held_[t].push_back(gathered_[g]);
        }
    }

    std::vector<surface::SurfaceVertex> vertices_;
    std::vector<std::array<std::uint32_t, 3>> triangles_;  ///< of vertices; three times the same: gone
    std::vector<Index> pointOf_;                           ///< by vertex
    std::vector<Vec3f> points_;
    std::vector<std::uint8_t> vertexCount_;  ///< by point
    std::vector<std::vector<Index>> fans_;   ///< by point: its triangles
    std::vector<std::vector<Index>> held_;   ///< by triangle: points that were taken out and lie nearest to it
    float most2_ = 0.0f;
    // Of the point at hand.
    std::vector<Corner> ring_;
    std::vector<Index> fan_, gathered_;
    std::vector<std::size_t> nearest_;
};

}  // namespace

Simplified simplified(std::span<const std::shared_ptr<const surface::BrickMesh>> meshes, float mostMm) {
    Patch patch(meshes);
    if (patch.isTooLarge()) return {};
    patch.simplify(mostMm);
    return patch.result();
}

}  // namespace handpiece::view
