// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/surface/tissue_split.h"

#include <cmath>

namespace handpiece::surface {
namespace {

using Float3 = std::array<float, 3>;
using cases::Tissue;

constexpr std::uint16_t kNotPlaced = 0xffff;
/// Halvings that find where an edge leaves a tissue: a voxel's edge to below half a hundredth of its length.
constexpr int kHalvings = 8;

Float3 mixed(const Float3& a, const Float3& b, float t) {
    return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

Float3 unit(const Float3& v) {
    const float length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return length > 0.0f ? Float3{v[0] / length, v[1] / length, v[2] / length} : Float3{0.0f, 0.0f, 1.0f};
}

Float3 faceNormal(const Float3& a, const Float3& b, const Float3& c) {
    const Float3 u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    return unit({u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]});
}

core::Vec3 asVec3(const Float3& v) {
    return {v[0], v[1], v[2]};
}

}  // namespace

std::shared_ptr<const BrickMesh> TissueSplitter::mesh(const TriangleList& list, const LowNeighbours& bricks,
                                                      const field::TissueMap* tissues) {
    if (list.triangles().empty()) return nullptr;
    for (std::size_t slot = 0; slot < 8; ++slot)
        first_[slot + 1] = first_[slot] + (bricks[slot] != nullptr ? bricks[slot]->shown(false).size() : 0);
    placed_.assign(first_[8], kNotPlaced);
    mesh_.vertices.clear();
    mesh_.triangles.clear();
    for (const auto& t : list.triangles()) {
        const SheetVertex &a = list.vertex(t[0]), &b = list.vertex(t[1]), &c = list.vertex(t[2]);
        if (a.tissue == b.tissue && b.tissue == c.tissue) {
            const bool needsFlat = a.isSharp || b.isSharp || c.isSharp;
            const Float3 flat = needsFlat ? faceNormal(a.positionMm, b.positionMm, c.positionMm) : Float3{};
            const std::uint16_t i = corner(list, t[0], flat), j = corner(list, t[1], flat),
                                k = corner(list, t[2], flat);
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

/// A vertex in the mesh, with the triangle's own normal where it has none itself.
std::uint16_t TissueSplitter::corner(const TriangleList& list, Ref ref, const Float3& flat) {
    const SheetVertex& v = list.vertex(ref);
    if (v.isSharp) return add({v.positionMm, flat}, v.tissue);
    std::uint16_t& place = placed_[first_[ref >> 16] + (ref & 0xffff)];
    if (place == kNotPlaced) place = add({v.positionMm, v.normal}, v.tissue);
    return place;
}

TissueSplitter::Point TissueSplitter::cut(const SheetVertex& a, const SheetVertex& b,
                                          const field::TissueMap& tissues) const {
    const bool inOrder = a.positionMm < b.positionMm;
    const SheetVertex &from = inOrder ? a : b, &to = inOrder ? b : a;
    const core::Vec3 p = asVec3(from.positionMm), q = asVec3(to.positionMm);
    double low = 0.0, high = 1.0;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        (tissues.at(p + middle * (q - p)) == from.tissue ? low : high) = middle;
    }
    const auto t = static_cast<float>(0.5 * (low + high));
    return {mixed(from.positionMm, to.positionMm, t), unit(mixed(from.normal, to.normal, t))};
}

/// One corner differs from the other two: a triangle and a quad.
void TissueSplitter::splitInTwo(const TriangleList& list, const std::array<Ref, 3>& t,
                                const field::TissueMap& tissues) {
    std::size_t odd = 0;
    while (list.vertex(t[(odd + 1) % 3]).tissue != list.vertex(t[(odd + 2) % 3]).tissue)
        ++odd;
    const Ref refs[3] = {t[odd], t[(odd + 1) % 3], t[(odd + 2) % 3]};
    const SheetVertex &a = list.vertex(refs[0]), &b = list.vertex(refs[1]), &c = list.vertex(refs[2]);
    const Float3 flat = faceNormal(a.positionMm, b.positionMm, c.positionMm);
    Point ab = cut(a, b, tissues), ac = cut(a, c, tissues);
    if (a.isSharp || b.isSharp || c.isSharp) ab.normal = ac.normal = flat;
    const std::uint16_t i = corner(list, refs[0], flat), j = corner(list, refs[1], flat),
                        k = corner(list, refs[2], flat);
    const std::uint16_t abA = add(ab, a.tissue), acA = add(ac, a.tissue), abB = add(ab, b.tissue),
                        acB = add(ac, b.tissue);
    mesh_.triangles.push_back({i, abA, acA});
    mesh_.triangles.push_back({abB, j, k});
    mesh_.triangles.push_back({abB, k, acB});
}

/// All corners differ: three quads about the middle of the points where the edges are cut.
void TissueSplitter::splitInThree(const TriangleList& list, const std::array<Ref, 3>& t,
                                  const field::TissueMap& tissues) {
    const SheetVertex* v[3] = {&list.vertex(t[0]), &list.vertex(t[1]), &list.vertex(t[2])};
    const Float3 flat = faceNormal(v[0]->positionMm, v[1]->positionMm, v[2]->positionMm);
    Point cuts[3];  // of the edge that begins at each corner
    Point middle{{}, flat};
    for (std::size_t i = 0; i < 3; ++i) {
        cuts[i] = cut(*v[i], *v[(i + 1) % 3], tissues);
        cuts[i].normal = flat;
        for (std::size_t k = 0; k < 3; ++k)
            middle.positionMm[k] += cuts[i].positionMm[k] / 3.0f;
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const Tissue tissue = v[i]->tissue;
        const std::uint16_t at = corner(list, t[i], flat), after = add(cuts[i], tissue),
                            before = add(cuts[(i + 2) % 3], tissue), centre = add(middle, tissue);
        mesh_.triangles.push_back({at, after, centre});
        mesh_.triangles.push_back({at, centre, before});
    }
}

}  // namespace handpiece::surface
