// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/surface/tissue_split.h"

#include <algorithm>
#include <cmath>

#include "handpiece/senses/surface/float3.h"

namespace handpiece::surface {
namespace {

using cases::Tissue;

constexpr std::uint16_t kNotPlaced = 0xffff;
/// Halvings that find where an edge leaves a tissue: a voxel's edge to below half a hundredth of its length.
constexpr int kHalvings = 8;
/// Which of a vertex's normals: its only one, either of two, the triangle's own.
constexpr std::uint8_t kPlain = 0, kFlat = 2;
/// Cosine between a surface at a sharp vertex and a triangle of it: less, and it is neither of the two that are known.
constexpr float kLeastLikeness = 0.6f;
/// Height over longest side of a triangle: less, and how it lies says nothing.
constexpr double kSliver = 0.2;

Float3 mixed(const Float3& a, const Float3& b, float t) {
    return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

Float3 unit(const Float3& v) {
    const float length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return length > 0.0f ? Float3{v[0] / length, v[1] / length, v[2] / length} : Float3{0.0f, 0.0f, 1.0f};
}

Float3 faceNormal(const Float3& a, const Float3& b, const Float3& c) {
    return unit(cross(minus(b, a), minus(c, a)));
}

core::Vec3 asVec3(const Float3& v) {
    return {v[0], v[1], v[2]};
}

bool isSliver(const Float3& a, const Float3& b, const Float3& c) {
    const core::Vec3 u = asVec3(b) - asVec3(a), v = asVec3(c) - asVec3(a);
    return u.cross(v).norm() < kSliver * std::max({u.squaredNorm(), v.squaredNorm(), (v - u).squaredNorm()});
}

}  // namespace

std::shared_ptr<const BrickMesh> TissueSplitter::mesh(const TriangleList& list, const LowNeighbours& bricks,
                                                      const field::TissueMap* tissues) {
    if (list.triangles().empty()) return nullptr;
    for (std::size_t slot = 0; slot < 8; ++slot)
        first_[slot + 1] = first_[slot] + (bricks[slot] != nullptr ? bricks[slot]->shown(false).size() : 0);
    placed_.assign(2 * first_[8], kNotPlaced);
    mesh_.vertices.clear();
    mesh_.triangles.clear();
    for (const auto& t : list.triangles()) {
        const SheetVertex &a = list.vertex(t[0]), &b = list.vertex(t[1]), &c = list.vertex(t[2]);
        if (a.tissue == b.tissue && b.tissue == c.tissue) {
            const Lit by = lit({&a, &b, &c});
            const std::uint16_t i = corner(a, t[0], by.normal[0], by.side[0]),
                                j = corner(b, t[1], by.normal[1], by.side[1]),
                                k = corner(c, t[2], by.normal[2], by.side[2]);
            mesh_.triangles.push_back({i, j, k});
        } else if (a.tissue == b.tissue || b.tissue == c.tissue || c.tissue == a.tissue) {
            splitInTwo(list, t, *tissues);
        } else {
            splitInThree(list, t, *tissues);
        }
    }
    auto made = std::make_shared<BrickMesh>();
    made->vertices.assign(mesh_.vertices.begin(), mesh_.vertices.end());
    made->triangles.assign(mesh_.triangles.begin(), mesh_.triangles.end());
    return made;
}

std::uint16_t TissueSplitter::add(const Point& point, Tissue tissue) {
    mesh_.vertices.push_back({point.positionMm, point.normal, tissue});
    return static_cast<std::uint16_t>(mesh_.vertices.size() - 1);
}

/// Of a sharp vertex the surface that the triangle's other corners are on counts: a triangle at an edge of the solid is
/// small and lies as it happens to, and its own normal would make the edge a row of dots.
TissueSplitter::Lit TissueSplitter::lit(const std::array<const SheetVertex*, 3>& v) {
    Lit made{{v[0]->normal, v[1]->normal, v[2]->normal}, {kPlain, kPlain, kPlain}};
    if (!v[0]->isSharp && !v[1]->isSharp && !v[2]->isSharp) return made;
    const Float3 flat = faceNormal(v[0]->positionMm, v[1]->positionMm, v[2]->positionMm);
    Float3 on{};
    for (const SheetVertex* each : v)
        for (std::size_t k = 0; k < 3 && !each->isSharp; ++k)
            on[k] += each->normal[k];
    if (v[0]->isSharp && v[1]->isSharp && v[2]->isSharp) on = flat;
    on = unit(on);
    // One along an edge may be lit by either side of it.
    const float least = isSliver(v[0]->positionMm, v[1]->positionMm, v[2]->positionMm) ? -1.0f : kLeastLikeness;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!v[i]->isSharp) continue;
        const float first = dot(v[i]->sides[0], on), second = dot(v[i]->sides[1], on);
        const bool isKnown = v[i]->sides[0] != Float3{} && v[i]->sides[1] != Float3{};
        made.side[i] = !isKnown || std::max(first, second) < least ? kFlat : first >= second ? 0 : 1;
        made.normal[i] = made.side[i] == kFlat ? flat : v[i]->sides[made.side[i]];
    }
    return made;
}

/// A vertex in the mesh, once for each surface that it is on.
std::uint16_t TissueSplitter::corner(const SheetVertex& v, Ref ref, const Float3& normal, std::uint8_t side) {
    if (side == kFlat) return add({v.positionMm, normal}, v.tissue);
    std::uint16_t& place = placed_[2 * (first_[ref >> 16] + (ref & 0xffff)) + (side == 1 ? 1 : 0)];
    if (place == kNotPlaced) place = add({v.positionMm, normal}, v.tissue);
    return place;
}

TissueSplitter::Point TissueSplitter::cut(const SheetVertex& a, const Float3& normalA, const SheetVertex& b,
                                          const Float3& normalB, const field::TissueMap& tissues) const {
    const bool inOrder = a.positionMm < b.positionMm;
    const SheetVertex &from = inOrder ? a : b, &to = inOrder ? b : a;
    const core::Vec3 p = asVec3(from.positionMm), q = asVec3(to.positionMm);
    double low = 0.0, high = 1.0;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        (tissues.at(p + middle * (q - p)) == from.tissue ? low : high) = middle;
    }
    const auto t = static_cast<float>(0.5 * (low + high));
    return {mixed(from.positionMm, to.positionMm, t),
            unit(mixed(inOrder ? normalA : normalB, inOrder ? normalB : normalA, t))};
}

/// One corner differs from the other two: a triangle and a quad.
void TissueSplitter::splitInTwo(const TriangleList& list, const std::array<Ref, 3>& t,
                                const field::TissueMap& tissues) {
    std::size_t odd = 0;
    while (list.vertex(t[(odd + 1) % 3]).tissue != list.vertex(t[(odd + 2) % 3]).tissue)
        ++odd;
    const std::size_t at[3] = {odd, (odd + 1) % 3, (odd + 2) % 3};
    const SheetVertex &a = list.vertex(t[at[0]]), &b = list.vertex(t[at[1]]), &c = list.vertex(t[at[2]]);
    const Lit by = lit({&a, &b, &c});
    const Point ab = cut(a, by.normal[0], b, by.normal[1], tissues),
                ac = cut(a, by.normal[0], c, by.normal[2], tissues);
    const std::uint16_t i = corner(a, t[at[0]], by.normal[0], by.side[0]),
                        j = corner(b, t[at[1]], by.normal[1], by.side[1]),
                        k = corner(c, t[at[2]], by.normal[2], by.side[2]);
    const std::uint16_t abA = add(ab, a.tissue), acA = add(ac, a.tissue), abB = add(ab, b.tissue),
                        acB = add(ac, b.tissue);
    mesh_.triangles.push_back({i, abA, acA});
    mesh_.triangles.push_back({abB, j, k});
    mesh_.triangles.push_back({abB, k, acB});
}

/// All corners differ: three quads about the middle of the points where the edges are cut.
void TissueSplitter::splitInThree(const TriangleList& list, const std::array<Ref, 3>& t,
                                  const field::TissueMap& tissues) {
    const std::array<const SheetVertex*, 3> v = {&list.vertex(t[0]), &list.vertex(t[1]), &list.vertex(t[2])};
    const Lit by = lit(v);
    Point cuts[3];  // of the edge that begins at each corner
    Point middle{};
    for (std::size_t i = 0; i < 3; ++i) {
        cuts[i] = cut(*v[i], by.normal[i], *v[(i + 1) % 3], by.normal[(i + 1) % 3], tissues);
        for (std::size_t k = 0; k < 3; ++k) {
            middle.positionMm[k] += cuts[i].positionMm[k] / 3.0f;
            middle.normal[k] += cuts[i].normal[k];
        }
    }
    middle.normal = unit(middle.normal);
    for (std::size_t i = 0; i < 3; ++i) {
        const Tissue tissue = v[i]->tissue;
        const std::uint16_t at = corner(*v[i], t[i], by.normal[i], by.side[i]), after = add(cuts[i], tissue),
                            before = add(cuts[(i + 2) % 3], tissue), centre = add(middle, tissue);
        mesh_.triangles.push_back({at, after, centre});
        mesh_.triangles.push_back({at, centre, before});
    }
}

}  // namespace handpiece::surface
