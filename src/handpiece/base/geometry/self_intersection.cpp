// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/self_intersection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/base/geometry/mesh_io_formats.h"

namespace handpiece::geometry {
namespace {

using core::Vec3;

struct FloatBox {
    float min[3] = {HUGE_VALF, HUGE_VALF, HUGE_VALF}, max[3] = {-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};

    void extend(const Vec3& p) {
        for (int k = 0; k < 3; ++k) {
            // Rounded outwards, so that a box in float holds its points in double.
            const float near = static_cast<float>(p[k]);
            min[k] = std::min(min[k], near <= p[k] ? near : std::nextafter(near, -HUGE_VALF));
            max[k] = std::max(max[k], near >= p[k] ? near : std::nextafter(near, HUGE_VALF));
        }
    }
    void extend(const FloatBox& b) {
        for (int k = 0; k < 3; ++k) {
            min[k] = std::min(min[k], b.min[k]);
            max[k] = std::max(max[k], b.max[k]);
        }
    }
    [[nodiscard]] bool meets(const FloatBox& b) const {
        return (min[0] <= b.max[0]) & (b.min[0] <= max[0]) & (min[1] <= b.max[1]) & (b.min[1] <= max[1]) &
               (min[2] <= b.max[2]) & (b.min[2] <= max[2]);
    }
};

// 21 bits spread to every third place.
std::uint64_t spread(std::uint64_t x) {
    x = (x | x << 32) & 0x1f00000000ffffull;
    x = (x | x << 16) & 0x1f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

}  // namespace

class CrossingFinder {
  public:
    explicit CrossingFinder(const TriangleMesh& mesh) : place_(mesh.vertices.size()) {
        core::Box box;
        formats::VertexMerger<double> places(mesh.vertices.size());
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
            const Vec3& p = mesh.vertices[v];
            place_[v] = places.add(p.x(), p.y(), p.z());
        }
        for (const Triangle& t : mesh.triangles)
            for (const std::uint32_t v : t)
                box.extend(mesh.vertices[v]);
        vertices_ = places.vertices();
        tolerance_ = box.isEmpty() ? 0.0 : kTouchingShare * box.size().norm();

        // Faces along a Morton curve; the tree is the implicit one over pieces of kLeaf of them.
        const Vec3 scale = box.isEmpty() ? Vec3::Zero().eval()
                                         : (box.size().array().max(1e-300).inverse() * 2097151.0).matrix().eval();
        std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
        order.reserve(mesh.triangles.size());
        for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
            const Triangle& t = mesh.triangles[f];
            const Vec3 cell =
                (((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0 - box.min).array() *
                 scale.array())
                    .max(0.0)
                    .min(2097151.0)
                    .matrix();
            const auto at = [&](int k) { return spread(static_cast<std::uint64_t>(cell[k])) << k; };
            order.emplace_back(at(0) | at(1) | at(2), f);
        }
        std::sort(order.begin(), order.end());
        faces_.reserve(order.size());
        for (const auto& [code, f] : order)
            faces_.push_back(faceOf(mesh.triangles[f], f));
        leaves_ = (faces_.size() + kLeaf - 1) / kLeaf;
        levelStart_.push_back(0);
        for (std::size_t n = leaves_;; n = (n + kArity - 1) / kArity) {
            levelSize_.push_back(n);
            levelStart_.push_back(levelStart_.back() + n);
            if (n <= 1) break;
        }
        boxes_.resize(levelStart_.back());
        for (std::size_t i = 0; i < faces_.size(); ++i)
            boxes_[i / kLeaf].extend(faces_[i].box);
        for (std::size_t level = 1; level < levelSize_.size(); ++level)
            for (std::size_t i = 0; i < levelSize_[level - 1]; ++i)
                boxes_[levelStart_[level] + i / kArity].extend(boxes_[levelStart_[level - 1] + i]);
    }

    [[nodiscard]] std::vector<CrossingFaces> find() const {
        std::vector<std::vector<CrossingFaces>> found((leaves_ + kPiece - 1) / kPiece);
        core::parallelFor(found.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t piece = begin; piece < end; ++piece)
                for (std::size_t leaf = piece * kPiece; leaf < std::min(leaves_, (piece + 1) * kPiece); ++leaf)
                    visit(levelSize_.size() - 1, 0, leaf, found[piece]);
        });
        std::vector<CrossingFaces> all;
        for (const std::vector<CrossingFaces>& f : found)
            all.insert(all.end(), f.begin(), f.end());
        std::sort(all.begin(), all.end(), [](const CrossingFaces& a, const CrossingFaces& b) {
            return a.first != b.first ? a.first < b.first : a.second < b.second;
        });
        return all;
    }

    [[nodiscard]] bool isCrossed(const Triangle& t) const {
        const Face face = faceOf(t, 0);
        // Large faces are rare in a box that holds them: what lies on one side of their plane is passed over.
        const auto mayMeet = [&](const FloatBox& box) {
            if (!box.meets(face.box)) return false;
            double middle = -face.normal.dot(vertices_[face.corner[0]]), reach = tolerance_;
            for (int k = 0; k < 3; ++k) {
                middle += face.normal[k] * 0.5 * (double{box.min[k]} + double{box.max[k]});
                reach += std::abs(face.normal[k]) * 0.5 * (double{box.max[k]} - double{box.min[k]});
            }
            return std::abs(middle) <= reach;
        };
        return anyFace(mayMeet,
                       [&](const Face& other) { return crossing(face, other).has_value() || isSame(face, other); });
    }

    [[nodiscard]] bool isPierced(std::uint32_t from, std::uint32_t to) const {
        const std::uint32_t a = place_[from], b = place_[to];
        const Vec3 &p = vertices_[a], &q = vertices_[b], way = q - p;
        const auto mayMeet = [&](const FloatBox& box) {
            double first = 0.0, last = 1.0;
            for (int k = 0; k < 3; ++k) {
                if (way[k] == 0.0) {
                    if (p[k] < box.min[k] || p[k] > box.max[k]) return false;
                    continue;
                }
                const double x = (box.min[k] - p[k]) / way[k], y = (box.max[k] - p[k]) / way[k];
                first = std::max(first, std::min(x, y));
                last = std::min(last, std::max(x, y));
            }
            return first <= last + 1e-9;
        };
        return anyFace(mayMeet, [&](const Face& f) {
            for (const std::uint32_t corner : f.corner)
                if (corner == a || corner == b) return false;
            const double hp = f.normal.dot(p - vertices_[f.corner[0]]), hq = f.normal.dot(q - vertices_[f.corner[0]]);
            if (!(std::max(hp, hq) > tolerance_ && std::min(hp, hq) < -tolerance_)) return false;
            return holds(f, p + way * (hp / (hp - hq)));
        });
    }

  private:
    static constexpr std::size_t kLeaf = 4, kArity = 4, kPiece = 256;

    // Whether a face that may lie there is such a one.
    template <class MayMeet, class Is>
    [[nodiscard]] bool anyFace(MayMeet mayMeet, Is is) const {
        std::vector<std::pair<std::size_t, std::size_t>> waiting;
        if (!faces_.empty()) waiting.emplace_back(levelSize_.size() - 1, 0);
        while (!waiting.empty()) {
            const auto [level, node] = waiting.back();
            waiting.pop_back();
            if (!mayMeet(boxes_[levelStart_[level] + node])) continue;
            if (level > 0) {
                const std::size_t end = std::min(levelSize_[level - 1], (node + 1) * kArity);
                for (std::size_t child = node * kArity; child < end; ++child)
                    waiting.emplace_back(level - 1, child);
                continue;
            }
            const std::size_t end = std::min(faces_.size(), (node + 1) * kLeaf);
            for (std::size_t i = node * kLeaf; i < end; ++i)
                if (mayMeet(faces_[i].box) && is(faces_[i])) return true;
        }
        return false;
    }

    struct Face {
        std::uint32_t index;
        std::array<std::uint32_t, 3> corner;
        Vec3 normal;  ///< unit, or zero where the face has no area
        FloatBox box;
    };

    [[nodiscard]] Face faceOf(const Triangle& t, std::uint32_t index) const {
        Face face{index, {place_[t[0]], place_[t[1]], place_[t[2]]}, {}, {}};
        const Vec3 &a = vertices_[face.corner[0]], &b = vertices_[face.corner[1]], &c = vertices_[face.corner[2]];
        for (const Vec3* p : {&a, &b, &c})
            face.box.extend(*p);
        const Vec3 normal = (b - a).cross(c - a);
        const double length = normal.norm();
        face.normal = length > 0.0 ? (normal / length).eval() : Vec3::Zero().eval();
        return face;
    }

    static bool isSame(const Face& a, const Face& b) {
        return std::all_of(a.corner.begin(), a.corner.end(), [&](std::uint32_t corner) {
            return std::find(b.corner.begin(), b.corner.end(), corner) != b.corner.end();
        });
    }

    // Every pair of leaves once: the query leaf looks only at leaves from itself onwards.
    void visit(std::size_t level, std::size_t node, std::size_t leaf, std::vector<CrossingFaces>& found) const {
        std::size_t span = 1;
        for (std::size_t l = 0; l < level; ++l)
            span *= kArity;
        if ((node + 1) * span <= leaf || !boxes_[levelStart_[level] + node].meets(boxes_[leaf])) return;
        if (level > 0) {
            const std::size_t end = std::min(levelSize_[level - 1], (node + 1) * kArity);
            for (std::size_t child = node * kArity; child < end; ++child)
                visit(level - 1, child, leaf, found);
            return;
        }
        const std::size_t endA = std::min(faces_.size(), (leaf + 1) * kLeaf),
                          endB = std::min(faces_.size(), (node + 1) * kLeaf);
        for (std::size_t i = leaf * kLeaf; i < endA; ++i)
            for (std::size_t j = node == leaf ? i + 1 : node * kLeaf; j < endB; ++j) {
                if (!faces_[i].box.meets(faces_[j].box)) continue;
                if (const std::optional<Vec3> p = crossing(faces_[i], faces_[j]))
                    found.push_back(
                        {std::min(faces_[i].index, faces_[j].index), std::max(faces_[i].index, faces_[j].index), *p});
            }
    }

    [[nodiscard]] std::optional<Vec3> crossing(const Face& a, const Face& b) const {
        int shared = 0;
        std::array<bool, 3> aShared{}, bShared{};
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j)
                if (a.corner[i] == b.corner[j]) {
                    aShared[i] = bShared[j] = true;
                    ++shared;
                }
        if (shared >= 3) return std::nullopt;  // the same face twice: inspect() counts those
        if (shared == 2) return fold(a, aShared, b, bShared);
        const Heights aOverB = heightsOver(a, aShared, b), bOverA = heightsOver(b, bShared, a);
        if (!straddles(aOverB) || !straddles(bOverA)) return std::nullopt;
        // The ends of the segment that both have in common; a point alone is a touch.
        core::Box common;
        for (std::size_t i = 0; i < 3; ++i)
            if (aShared[i]) common.extend(vertices_[a.corner[i]]);
        piercings(a, aOverB, b, common);
        piercings(b, bOverA, a, common);
        if (common.isEmpty() || common.size().norm() <= tolerance_) return std::nullopt;
        return common.centre();
    }

    // Neighbours across an edge can only lie folded onto each other.
    [[nodiscard]] std::optional<Vec3> fold(const Face& a, const std::array<bool, 3>& aShared, const Face& b,
                                           const std::array<bool, 3>& bShared) const {
        const auto apex = [](const Face& f, const std::array<bool, 3>& isShared) {
            return f.corner[static_cast<std::size_t>(std::find(isShared.begin(), isShared.end(), false) -
                                                     isShared.begin())];
        };
        const std::size_t alone =
            static_cast<std::size_t>(std::find(aShared.begin(), aShared.end(), false) - aShared.begin());
        if (alone == 3) return std::nullopt;
        const Vec3 &e0 = vertices_[a.corner[(alone + 1) % 3]], &e1 = vertices_[a.corner[(alone + 2) % 3]];
        const Vec3 &p = vertices_[apex(a, aShared)], &q = vertices_[apex(b, bShared)];
        if (std::abs(b.normal.dot(p - e0)) > tolerance_ || std::abs(a.normal.dot(q - e0)) > tolerance_)
            return std::nullopt;
        const Vec3 along = (e1 - e0).normalized();
        const Vec3 up = (p - e0) - along * along.dot(p - e0), uq = (q - e0) - along * along.dot(q - e0);
        // Both must rise well above the edge, on its same side, and not by chance of a sliver.
        const double hp = up.norm(), hq = uq.norm();
        constexpr double kSliver = 1e3;
        if (std::min(hp, hq) < kSliver * tolerance_ || up.dot(uq) <= 0.0) return std::nullopt;
        return ((e0 + e1 + (hp < hq ? p : q)) / 3.0).eval();
    }

    using Heights = std::array<double, 3>;

    // Of a's corners over b's plane.
    [[nodiscard]] Heights heightsOver(const Face& a, const std::array<bool, 3>& aShared, const Face& b) const {
        Heights height;
        for (std::size_t i = 0; i < 3; ++i)
            height[i] = aShared[i] ? 0.0 : b.normal.dot(vertices_[a.corner[i]] - vertices_[b.corner[0]]);
        return height;
    }
    [[nodiscard]] bool straddles(const Heights& h) const {
        return std::max({h[0], h[1], h[2]}) > tolerance_ && std::min({h[0], h[1], h[2]}) < -tolerance_;
    }

    // Where edges of `a` pierce `b`. A point on b's rim belongs to b: two edges that meet exactly must not both miss.
    void piercings(const Face& a, const Heights& height, const Face& b, core::Box& common) const {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t j = i == 2 ? 0 : i + 1;
            if (!((height[i] > 0.0 && height[j] < 0.0) || (height[i] < 0.0 && height[j] > 0.0))) continue;
            const Vec3 &p = vertices_[a.corner[i]], &q = vertices_[a.corner[j]];
            const Vec3 x = p + (q - p) * (height[i] / (height[i] - height[j]));
            if (holds(b, x)) common.extend(x);
        }
    }

    // Of a point in the face's plane.
    [[nodiscard]] bool holds(const Face& face, const Vec3& x) const {
        bool inside = true;
        for (std::size_t k = 0; k < 3 && inside; ++k) {
            const Vec3 &from = vertices_[face.corner[k]], &to = vertices_[face.corner[k == 2 ? 0 : k + 1]];
            const Vec3 side = to - from, out = x - from;
            const double rounding = 1e-14 * side.norm() * (out.norm() + from.cwiseAbs().maxCoeff());
            inside = face.normal.dot(side.cross(out)) >= -rounding;
        }
        return inside;
    }

    std::vector<std::uint32_t> place_;  ///< by vertex
    std::vector<Vec3> vertices_;        ///< one for each place
    std::vector<Face> faces_;
    std::vector<FloatBox> boxes_;
    std::vector<std::size_t> levelStart_, levelSize_;
    std::size_t leaves_ = 0;
    double tolerance_ = 0.0;
};

CrossingTree::CrossingTree(const TriangleMesh& mesh) {
    requireValidIndices(mesh, "mesh");
    finder_ = std::make_unique<const CrossingFinder>(mesh);
}
CrossingTree::CrossingTree(CrossingTree&&) noexcept = default;
CrossingTree& CrossingTree::operator=(CrossingTree&&) noexcept = default;
CrossingTree::~CrossingTree() = default;

bool CrossingTree::isCrossed(const Triangle& face) const {
    return finder_->isCrossed(face);
}
bool CrossingTree::isPierced(std::uint32_t from, std::uint32_t to) const {
    return finder_->isPierced(from, to);
}

std::vector<CrossingFaces> selfIntersections(const TriangleMesh& mesh, std::size_t limit) {
    requireValidIndices(mesh, "mesh");
    if (mesh.triangles.empty()) return {};
    std::vector<CrossingFaces> all = CrossingFinder(mesh).find();
    if (all.size() > limit) all.resize(limit);
    return all;
}

}  // namespace handpiece::geometry
