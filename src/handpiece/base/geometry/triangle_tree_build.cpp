// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cfloat>
#include <cmath>
#include <numeric>
#include <span>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/triangle_tree.h"

namespace handpiece::geometry {
namespace {

using core::Vec3;

constexpr int kBins = 16;
constexpr int kSahDepth = 16;                      // below it halves by count, so that kMaxTreeDepth holds
constexpr std::uint32_t kTaskTriangles = 1 << 15;  // subtrees of this size are built side by side
constexpr double kThin = 1e-3;                     // height over longest edge of a sliver

/// x, y, z and one more that is never asked: so that a processor takes all at once.
using Lanes __attribute__((vector_size(16))) = float;
constexpr Lanes lanes(float all) {
    return Lanes{all, all, all, all};
}
Lanes least(Lanes a, Lanes b) {
    return b < a ? b : a;
}
Lanes most(Lanes a, Lanes b) {
    return a < b ? b : a;
}

struct FloatBox {
    Lanes min = lanes(INFINITY), max = lanes(-INFINITY);

    void extend(const FloatBox& b) {
        min = least(min, b.min);
        max = most(max, b.max);
    }
    [[nodiscard]] float halfArea() const {
        const float x = max[0] - min[0], y = max[1] - min[1], z = max[2] - min[2];
        return x < 0.0f ? 0.0f : x * y + y * z + z * x;
    }
    [[nodiscard]] Lanes centre() const { return lanes(0.5f) * (min + max); }
};

struct Item {
    FloatBox box;
    std::uint32_t triangle;
};

struct Range {
    std::uint32_t begin = 0, end = 0;
    FloatBox box;
    [[nodiscard]] std::uint32_t size() const { return end - begin; }
};

class Builder {
  public:
    explicit Builder(std::vector<Item>& items) : items_(items) {}

    std::vector<TreeNode> build() {
        Range all{0, static_cast<std::uint32_t>(items_.size()), {}};
        for (const Item& item : items_)
            all.box.extend(item.box);
        std::vector<TreeNode> nodes;
        std::vector<Task> tasks;
        makeNode(nodes, all, 1, &tasks);
        std::vector<std::vector<TreeNode>> subtrees(tasks.size());
        core::parallelFor(tasks.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                makeNode(subtrees[i], tasks[i].range, tasks[i].depth, nullptr);
        });
        for (std::size_t i = 0; i < tasks.size(); ++i) {
            const auto offset = static_cast<std::int32_t>(nodes.size());
            nodes[tasks[i].parent].child[tasks[i].lane] = offset;
            for (TreeNode& node : subtrees[i]) {
                for (int lane = 0; lane < node.lanes; ++lane)
                    if (node.child[lane] >= 0) node.child[lane] += offset;
                nodes.push_back(node);
            }
        }
        return nodes;
    }

  private:
    struct Task {
        Range range;
        std::size_t parent;
        int lane, depth;
    };

    [[nodiscard]] Range rangeOf(std::uint32_t begin, std::uint32_t end) const {
        Range r{begin, end, {}};
        for (std::uint32_t i = begin; i < end; ++i)
            r.box.extend(items_[i].box);
        return r;
    }

    /// Halves by count along the axis the centres spread over most; ties by triangle, so that order never depends on
    /// chance.
    std::array<Range, 2> halve(const Range& r, int axis) {
        const std::uint32_t middle = r.begin + r.size() / 2;
        std::nth_element(items_.begin() + r.begin, items_.begin() + middle, items_.begin() + r.end,
                         [axis](const Item& a, const Item& b) {
                             const float ca = a.box.centre()[axis], cb = b.box.centre()[axis];
                             return ca != cb ? ca < cb : a.triangle < b.triangle;
                         });
        return {rangeOf(r.begin, middle), rangeOf(middle, r.end)};
    }

    std::array<Range, 2> split(const Range& r, bool byCount) {
        Lanes low = lanes(INFINITY), high = lanes(-INFINITY);
        for (std::uint32_t i = r.begin; i < r.end; ++i) {
            const Lanes c = items_[i].box.centre();
            low = least(low, c);
            high = most(high, c);
        }
        int widest = 0;
        for (int k = 1; k < 3; ++k)
            if (high[k] - low[k] > high[widest] - low[widest]) widest = k;
        if (byCount || !(high[widest] > low[widest])) return halve(r, widest);

        struct Bin {
            FloatBox box;
            std::uint32_t count = 0;
        };
        Bin bins[3][kBins];
        Lanes scale = lanes(0.0f);
        for (int k = 0; k < 3; ++k)
            scale[k] = high[k] > low[k] ? kBins * (1.0f - 1e-5f) / (high[k] - low[k]) : 0.0f;
        const auto placeOf = [&](const Item& item) { return (item.box.centre() - low) * scale; };
        const auto binAt = [](float place) { return std::clamp(static_cast<int>(place), 0, kBins - 1); };
        for (std::uint32_t i = r.begin; i < r.end; ++i) {
            const Lanes place = placeOf(items_[i]);
            for (int k = 0; k < 3; ++k) {
                Bin& bin = bins[k][binAt(place[k])];
                bin.box.extend(items_[i].box);
                ++bin.count;
            }
        }
        float bestCost = INFINITY;
        int bestAxis = -1, bestCut = 0;
        for (int k = 0; k < 3; ++k) {
            if (!(scale[k] > 0.0f)) continue;
            float rightCost[kBins];
            FloatBox box;
            std::uint32_t count = 0;
            for (int b = kBins - 1; b > 0; --b) {
                box.extend(bins[k][b].box);
                count += bins[k][b].count;
                rightCost[b] = count == 0 ? INFINITY : box.halfArea() * static_cast<float>(count);
            }
            box = {};
            count = 0;
            for (int b = 1; b < kBins; ++b) {
                box.extend(bins[k][b - 1].box);
                count += bins[k][b - 1].count;
                const float cost = count == 0 ? INFINITY : box.halfArea() * static_cast<float>(count) + rightCost[b];
                if (cost < bestCost) {
                    bestCost = cost;
                    bestAxis = k;
                    bestCut = b;
                }
            }
        }
        if (bestAxis < 0) return halve(r, widest);
        const auto middle = std::partition(items_.begin() + r.begin, items_.begin() + r.end,
                                           [&](const Item& item) { return binAt(placeOf(item)[bestAxis]) < bestCut; });
        const auto at = static_cast<std::uint32_t>(middle - items_.begin());
        if (at == r.begin || at == r.end) return halve(r, widest);
        Range left{r.begin, at, {}}, right{at, r.end, {}};
        for (int b = 0; b < kBins; ++b)
            (b < bestCut ? left : right).box.extend(bins[bestAxis][b].box);
        return {left, right};
    }

    void makeNode(std::vector<TreeNode>& nodes, const Range& range, int depth, std::vector<Task>* tasks) {
        const bool byCount = depth > kSahDepth;
        Range children[8] = {range};
        int count = 1;
        while (count < 8) {
            int pick = -1;
            float best = -1.0f;
            for (int i = 0; i < count; ++i) {
                if (children[i].size() <= kMaxLeafTriangles) continue;
                const float weight = byCount ? static_cast<float>(children[i].size()) : children[i].box.halfArea();
                if (weight > best) {
                    best = weight;
                    pick = i;
                }
            }
            if (pick < 0) break;
            const auto [left, right] = split(children[pick], byCount);
            children[pick] = left;
            children[count++] = right;
        }
        const std::size_t index = nodes.size();
        nodes.emplace_back();
        TreeNode node{};
        node.lanes = static_cast<std::uint8_t>(count);
        for (int lane = 0; lane < 8; ++lane) {
            const FloatBox box = lane < count ? children[lane].box : FloatBox{};
            node.minX[lane] = box.min[0], node.minY[lane] = box.min[1], node.minZ[lane] = box.min[2];
            node.maxX[lane] = box.max[0], node.maxY[lane] = box.max[1], node.maxZ[lane] = box.max[2];
            if (lane >= count || children[lane].size() > kMaxLeafTriangles) continue;
            node.child[lane] = ~static_cast<std::int32_t>(children[lane].begin);
            node.count[lane] = static_cast<std::uint8_t>(children[lane].size());
        }
        for (int lane = 0; lane < count; ++lane) {
            if (children[lane].size() <= kMaxLeafTriangles) continue;
            if (tasks != nullptr && children[lane].size() <= kTaskTriangles) {
                tasks->push_back({children[lane], index, lane, depth + 1});
                continue;
            }
            node.child[lane] = static_cast<std::int32_t>(nodes.size());
            makeNode(nodes, children[lane], depth + 1, tasks);
        }
        nodes[index] = node;
    }

    std::vector<Item>& items_;
};

/// The angle whose sine and cosine are in the proportion s : c, s >= 0, within 1e-5 rad: a weight needs no more.
double angleOf(double s, double c) {
    const double a = std::abs(c), low = std::min(s, a), high = std::max(s, a);
    if (!(high > 0.0)) return 0.0;
    // Abramowitz & Stegun 4.4.49.
    const double t = low / high, q = t * t;
    double angle = t * (0.9998660 + q * (-0.3302995 + q * (0.1801410 + q * (-0.0851330 + q * 0.0208351))));
    if (s > a) angle = 0.5 * std::numbers::pi - angle;
    return c < 0.0 ? std::numbers::pi - angle : angle;
}

void storeUnit(const Vec3& n, float* out) {
    const double length2 = n.squaredNorm(), scale = length2 > 0.0 ? 1.0 / std::sqrt(length2) : 0.0;
    for (int k = 0; k < 3; ++k)
        out[k] = static_cast<float>(n[k] * scale);
}

/// Face, edge and vertex normals, written for every triangle where it lies in tree order: 21 floats each.
class PseudonormalWriter {
  public:
    PseudonormalWriter(const TriangleMesh& mesh, std::span<const std::uint32_t> order, std::vector<float>& out)
        : mesh_(mesh), order_(order), faces_(mesh.triangles.size()), out_(out), face_(faces_), place_(faces_) {
        out_.resize(21 * faces_);
    }

    void run() {
        core::parallelFor(faces_, kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                place_[order_[i]] = static_cast<std::uint32_t>(i);
        });
        gatherCorners();
        core::parallelFor(faces_, kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t f = begin; f < end; ++f) {
                const Triangle& t = mesh_.triangles[f];
                const Vec3& a = mesh_.vertices[t[0]];
                const Vec3 n = (mesh_.vertices[t[1]] - a).cross(mesh_.vertices[t[2]] - a);
                const double length = n.norm();
                face_[f] = length > 0.0 ? Vec3(n / length) : Vec3::Zero();
                storeUnit(face_[f], at(f, 0));
            }
        });
        core::parallelFor(mesh_.vertices.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t v = begin; v < end; ++v)
                sumVertex(v);
        });
        sumEdges();
        giveFlatFacesANormal();
    }

  private:
    static constexpr std::size_t kGrain = 4096;

    /// Slots: 0 the face, 1..3 edges, 4..6 corners.
    [[nodiscard]] float* at(std::size_t face, std::size_t slot) {
        return &out_[21 * std::size_t{place_[face]} + 3 * slot];
    }

    /// Corners (3 x face + corner) around every vertex.
    void gatherCorners() {
        start_.assign(mesh_.vertices.size() + 1, 0);
        for (const Triangle& t : mesh_.triangles)
            for (const std::uint32_t v : t)
                ++start_[v + 1];
        std::partial_sum(start_.begin(), start_.end(), start_.begin());
        std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
        corner_.resize(3 * faces_);
        for (std::uint32_t f = 0; f < faces_; ++f)
            for (std::uint32_t k = 0; k < 3; ++k)
                corner_[next[mesh_.triangles[f][k]]++] = 3 * f + k;
    }

    void sumVertex(std::size_t v) {
        Vec3 sum = Vec3::Zero();
        const Vec3& p = mesh_.vertices[v];
        for (std::uint32_t i = start_[v]; i < start_[v + 1]; ++i) {
            const std::size_t f = corner_[i] / 3, k = corner_[i] % 3;
            const Triangle& t = mesh_.triangles[f];
            const Vec3 u = mesh_.vertices[t[(k + 1) % 3]] - p, w = mesh_.vertices[t[(k + 2) % 3]] - p;
            sum += face_[f] * angleOf(u.cross(w).norm(), u.dot(w));
        }
        for (std::uint32_t i = start_[v]; i < start_[v + 1]; ++i)
            storeUnit(sum, at(corner_[i] / 3, 4 + corner_[i] % 3));
    }

    /// Every edge is summed at its lower vertex, over all faces around it.
    void sumEdges() {
        struct HalfEdge {
            std::uint32_t upper, slot;  // slot: 3 x face + edge
        };
        core::parallelFor(mesh_.vertices.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            std::vector<HalfEdge> around;
            for (std::size_t v = begin; v < end; ++v) {
                around.clear();
                for (std::uint32_t i = start_[v]; i < start_[v + 1]; ++i) {
                    const std::uint32_t f = corner_[i] / 3, k = corner_[i] % 3, before = (k + 2) % 3;
                    const Triangle& t = mesh_.triangles[f];
                    if (t[(k + 1) % 3] >= v) around.push_back({t[(k + 1) % 3], 3 * f + k});
                    if (t[before] > v) around.push_back({t[before], 3 * f + before});
                }
                std::sort(around.begin(), around.end(), [](const HalfEdge& a, const HalfEdge& b) {
                    return a.upper != b.upper ? a.upper < b.upper : a.slot < b.slot;
                });
                for (std::size_t i = 0; i < around.size();) {
                    std::size_t j = i;
                    Vec3 sum = Vec3::Zero();
                    for (; j < around.size() && around[j].upper == around[i].upper; ++j)
                        sum += face_[around[j].slot / 3];
                    for (const std::size_t last = j; i < last; ++i)
                        storeUnit(sum, at(around[i].slot / 3, 1 + around[i].slot % 3));
                }
            }
        });
    }

    /// A face without area takes the mean of its neighbours, so that its edges know both sides.
    void giveFlatFacesANormal() {
        std::vector<std::size_t> flat;
        for (std::size_t f = 0; f < faces_; ++f)
            if (face_[f].isZero(0.0)) flat.push_back(f);
        if (flat.empty()) return;
        for (const std::size_t f : flat) {
            const float* e = at(f, 1);
            face_[f] = Vec3(e[0], e[1], e[2]) + Vec3(e[3], e[4], e[5]) + Vec3(e[6], e[7], e[8]);
            face_[f] = face_[f].stableNormalized();
        }
        for (const std::size_t f : flat)
            storeUnit(face_[f], at(f, 0));
        sumEdges();
    }

    const TriangleMesh& mesh_;
    std::span<const std::uint32_t> order_;
    std::size_t faces_;
    std::vector<float>& out_;
    std::vector<Vec3> face_;
    std::vector<std::uint32_t> place_, start_, corner_;
};

/// The box of all vertices. Throws for what is no mesh.
core::Box checkedBounds(const TriangleMesh& mesh) {
    if (mesh.triangles.empty()) throw core::Error("the mesh has no triangles", "triangle tree");
    if (mesh.triangles.size() > 1'000'000'000u)
        throw core::Error("the mesh has more than a thousand million triangles", "triangle tree");
    core::Box bounds;
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t) {
            if (v >= mesh.vertices.size())
                throw core::Error("a triangle names a vertex that does not exist", "triangle tree");
            bounds.extend(mesh.vertices[v]);
        }
    for (const Vec3& v : mesh.vertices)
        if (!v.allFinite()) throw core::Error("a vertex is not a finite number", "triangle tree");
    return bounds;
}

}  // namespace

TriangleTree::TriangleTree(const TriangleMesh& mesh) : bounds_(checkedBounds(mesh)) {
    const std::size_t faces = mesh.triangles.size();
    const double reach = std::max(bounds_.min.cwiseAbs().maxCoeff(), bounds_.max.cwiseAbs().maxCoeff());
    const double margin = reach * 0x1p-22 + FLT_MIN;
    std::vector<Item> items(faces);
    core::parallelFor(faces, 8192, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
            core::Box box;
            for (const std::uint32_t v : mesh.triangles[f])
                box.extend(mesh.vertices[v]);
            for (int k = 0; k < 3; ++k) {
                items[f].box.min[k] = std::nextafterf(static_cast<float>(box.min[k] - margin), -INFINITY);
                items[f].box.max[k] = std::nextafterf(static_cast<float>(box.max[k] + margin), INFINITY);
            }
            items[f].box.min[3] = items[f].box.max[3] = 0.0f;
            items[f].triangle = static_cast<std::uint32_t>(f);
        }
    });
    nodes_ = Builder(items).build();
    std::vector<std::uint32_t> order(faces);
    for (std::size_t i = 0; i < faces; ++i)
        order[i] = items[i].triangle;
    fillTriangles(mesh, order);
}

void TriangleTree::fillTriangles(const TriangleMesh& mesh, std::span<const std::uint32_t> order) {
    PseudonormalWriter(mesh, order, pseudonormals_).run();
    triangles_.resize(order.size());
    core::parallelFor(order.size(), 8192, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint32_t f = order[i];
            const Triangle& t = mesh.triangles[f];
            const Vec3 a = mesh.vertices[t[0]], ab = mesh.vertices[t[1]] - a, ac = mesh.vertices[t[2]] - a;
            TreeTriangle& out = triangles_[i];
            for (int k = 0; k < 3; ++k) {
                out.a[k] = a[k];
                out.ab[k] = ab[k];
                out.ac[k] = ac[k];
            }
            out.index = f;
            const double longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
            out.thin = ab.cross(ac).norm() > kThin * longest2 ? 0u : 1u;
        }
    });
}

}  // namespace handpiece::geometry
