// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/occlusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/case/fdi.h"

namespace handpiece::dentition {
namespace {

using core::Pose;
using core::Vec3;
using geometry::TriangleTree;

/// No facet goes deeper than this, however steep the place.
constexpr double kDeepestFacetMm = 0.15;
constexpr double kToleranceMm = 1e-6;
/// Antagonists farther away than this leave a place as it is.
constexpr double kLookMm = 0.4;

struct Antagonist {
    const TriangleTree* tree;
    Pose ownInIts;
};

enum class Grinds { both, thisOne };

/// What of one tooth its antagonists grind away, as a function of space in the tooth's frame.
class Bite {
  public:
    Bite(const TriangleTree& own, std::vector<Antagonist> antagonists, Grinds grinds)
        : own_(own), antagonists_(std::move(antagonists)), grinds_(grinds) {}

    /// Where the place goes: inwards, to where nothing is to be ground.
    [[nodiscard]] Vec3 ground(const Vec3& p) const {
        double above = excess(p), from = 0.0;
        if (!(above > kToleranceMm)) return p;
        // Between the bite and the surface's own normal: flat places keep theirs beside each other, walls give way too.
        geometry::NearestPoint n;
        (void)own_.signedDistance(p, &n);
        const Vec3 inwards = -(own_.pseudonormal(n.triangle, n.feature) + Vec3::UnitZ()).normalized();
        // Opposing walls: it falls by up to 2 a millimetre.
        double to = 0.0, below = above;
        while (below > kToleranceMm) {
            if (to >= kDeepestFacetMm) return p + kDeepestFacetMm * inwards;
            from = to, above = below;
            to = std::min(to + std::max(below, 0.002), kDeepestFacetMm);
            below = excess(p + to * inwards);
        }
        for (int i = 0; i < 12 && to - from > 1e-6; ++i) {
            const double share = std::clamp(above / (above - below), 0.1, 0.9), middle = from + share * (to - from);
            const double value = excess(p + middle * inwards);
            if (value > kToleranceMm)
                from = middle, above = value;
            else
                to = middle, below = value;
        }
        return p + to * inwards;
    }

  private:
    /// Positive where tooth is to go: on the antagonist's side of the middle between both, or nearer to that than half
    /// a gap; where this one alone is ground, nearer to the antagonist than the gap. What stands out of one's own
    /// surface there, as enamel does once that is ground, goes too.
    [[nodiscard]] double excess(const Vec3& p) const {
        double nearest = kLookMm;
        for (const Antagonist& a : antagonists_) {
            const Vec3 its = a.ownInIts.apply(p);
            const core::Box& box = a.tree->bounds();
            if (((its - box.max).array() > nearest).any() || ((box.min - its).array() > nearest).any()) continue;
            const geometry::NearestPoint n = a.tree->nearest(its, kLookMm);
            if (n.triangle != geometry::kNoTriangle) nearest = std::min(nearest, a.tree->side(its, n) * n.distanceMm);
        }
        if (!(nearest < kLookMm)) return -kLookMm;
        const double beyondOwn = own_.signedDistance(p);
        return std::max(kOcclusalGapMm - nearest + (grinds_ == Grinds::both ? beyondOwn : 0.0), beyondOwn);
    }

    const TriangleTree& own_;
    std::vector<Antagonist> antagonists_;
    Grinds grinds_;
};

/// Those that lie on the tooth's surface or in its tissues; axes go past it.
bool isOfTheTooth(cases::LandmarkKind kind) {
    return kind != cases::LandmarkKind::longAxis && kind != cases::LandmarkKind::pathOfInsertion;
}

/// Where each vertex and landmark of a tooth goes.
struct Ground {
    std::vector<Vec3> outer, enamel, marks;
};

enum class Edges { asTheyComeToLie, ground };

/// Between ground vertices edges are straight where the middle of an overlap is not: `edges` says whether what stands
/// out takes its two vertices with it.
Ground groundOf(const cases::Tooth& tooth, const Bite& bite, Edges edges) {
    Ground made;
    const auto add = [&](std::vector<Vec3>& to, const std::vector<Vec3>& points) {
        for (const Vec3& p : points)
            to.push_back(bite.ground(p));
    };
    const std::vector<Vec3>& was = tooth.outer.vertices;
    add(made.outer, was);
    if (edges == Edges::ground)
        for (const geometry::Triangle& t : tooth.outer.triangles)
            for (std::size_t e = 0; e < 3; ++e) {
                const std::uint32_t a = t[e], b = t[(e + 1) % 3];
                if (a > b) continue;
                const Vec3 middle = 0.5 * (was[a] + was[b]), shift = bite.ground(middle) - middle;
                for (const std::uint32_t v : {a, b})
                    if (shift.squaredNorm() > (made.outer[v] - was[v]).squaredNorm()) made.outer[v] = was[v] + shift;
            }
    for (const cases::Part& part : tooth.parts)
        if (part.tissue == cases::Tissue::enamel) add(made.enamel, part.mesh.vertices);
    for (const cases::Landmark& mark : tooth.landmarks)
        if (isOfTheTooth(mark.kind)) add(made.marks, mark.pointsMm);
    return made;
}

/// The faces of a mesh that reach into a box.
geometry::TriangleMesh facesIn(const core::Box& box, const std::vector<geometry::Triangle>& faces,
                               const std::vector<Vec3>& vertices) {
    geometry::TriangleMesh mesh{vertices, {}};
    for (const geometry::Triangle& t : faces) {
        core::Box own;
        for (const std::uint32_t v : t)
            own.extend(vertices[v]);
        if ((own.min.array() <= box.max.array()).all() && (own.max.array() >= box.min.array()).all())
            mesh.triangles.push_back(t);
    }
    return mesh;
}

/// What gives way in different directions side by side may fold over itself: there it goes as its surroundings do, and
/// where that does not help it stays as it was.
void unfold(const std::vector<geometry::Triangle>& faces, const std::vector<Vec3>& was, std::vector<Vec3>& is) {
    constexpr int kSmoothings = 6, kRounds = 16;
    for (int round = 0; round < kRounds; ++round) {
        core::Box moved;
        for (std::size_t v = 0; v < was.size(); ++v)
            if (is[v] != was[v]) moved.extend(was[v]), moved.extend(is[v]);
        if (moved.isEmpty()) return;
        const geometry::TriangleMesh near = facesIn(moved, faces, is);
        const auto crossings = geometry::selfIntersections(near);
        if (crossings.empty()) return;
        std::vector<std::uint8_t> folds(was.size(), 0);
        for (const geometry::CrossingFaces& c : crossings)
            for (const std::uint32_t f : {c.first, c.second})
                for (const std::uint32_t v : near.triangles[f])
                    folds[v] = 1;
        for (int ring = 0; ring < 1 + round / kSmoothings; ++ring) {
            const std::vector<std::uint8_t> before = folds;
            for (const geometry::Triangle& t : near.triangles)
                if (before[t[0]] != 0 || before[t[1]] != 0 || before[t[2]] != 0)
                    folds[t[0]] = folds[t[1]] = folds[t[2]] = 1;
        }
        std::vector<Vec3> sum(was.size(), Vec3::Zero());
        std::vector<int> count(was.size(), 0);
        for (const geometry::Triangle& t : near.triangles)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t v = t[k], next = t[(k + 1) % 3];
                sum[v] += is[next] - was[next];
                ++count[v];
            }
        for (std::size_t v = 0; v < was.size(); ++v)
            if (folds[v] != 0) is[v] = round < kSmoothings && count[v] > 0 ? Vec3(was[v] + sum[v] / count[v]) : was[v];
    }
}

void take(cases::Tooth& tooth, Ground ground) {
    unfold(tooth.outer.triangles, tooth.outer.vertices, ground.outer);
    tooth.outer.vertices = std::move(ground.outer);
    auto enamel = ground.enamel.begin(), mark = ground.marks.begin();
    for (cases::Part& part : tooth.parts) {
        if (part.tissue != cases::Tissue::enamel) continue;
        const auto end = enamel + static_cast<std::ptrdiff_t>(part.mesh.vertices.size());
        std::vector<Vec3> moved(enamel, end);
        unfold(part.mesh.triangles, part.mesh.vertices, moved);
        part.mesh.vertices = std::move(moved);
        enamel = end;
    }
    for (cases::Landmark& landmark : tooth.landmarks)
        if (isOfTheTooth(landmark.kind))
            for (Vec3& p : landmark.pointsMm)
                p = *mark++;
}

double deepestMm(const std::vector<Vec3>& before, const std::vector<Vec3>& after) {
    double deepest = 0.0;
    for (std::size_t i = 0; i < before.size(); ++i)
        deepest = std::max(deepest, (after[i] - before[i]).norm());
    return deepest;
}

/// Vertices first, then what edges leave; the other tooth's edges go in the same pass, so some is left for another.
constexpr int kPasses = 4;

}  // namespace

double grindFacets(std::span<cases::Tooth> teeth, const Arrangement& arrangement) {
    if (teeth.size() != kToothCount)
        throw core::Error(fmt::format("{} teeth cannot bite", teeth.size()), "arches", "give all 32");
    std::array<std::vector<Vec3>, kToothCount> whole;
    for (std::size_t i = 0; i < kToothCount; ++i)
        whole[i] = teeth[i].outer.vertices;
    for (int pass = 0; pass < kPasses; ++pass) {
        std::array<std::optional<TriangleTree>, kToothCount> trees;
        std::array<Ground, kToothCount> ground;
        const auto forEachTooth = [](const auto& body) {
            core::parallelFor(kToothCount, 1, [&](std::size_t from, std::size_t to) {
                for (std::size_t i = from; i < to; ++i)
                    body(i);
            });
        };
        forEachTooth([&](std::size_t i) { trees[i].emplace(teeth[i].outer); });
        forEachTooth([&](std::size_t i) {
            const Pose& own = arrangement.toothInMouth[i];
            std::vector<Antagonist> antagonists;
            for (std::size_t j = 0; j < kToothCount; ++j)
                if (isUpper(j) != isUpper(i))
                    antagonists.push_back({&*trees[j], arrangement.toothInMouth[j].inverse() * own});
            ground[i] = groundOf(teeth[i], Bite(*trees[i], std::move(antagonists), Grinds::both),
                                 pass > 0 ? Edges::ground : Edges::asTheyComeToLie);
        });
        forEachTooth([&](std::size_t i) { take(teeth[i], std::move(ground[i])); });
    }
    double deepest = 0.0;
    for (std::size_t i = 0; i < kToothCount; ++i)
        deepest = std::max(deepest, deepestMm(whole[i], teeth[i].outer.vertices));
    return deepest;
}

double grindOntoAntagonists(cases::Case& mouth) {
    const bool isLower = cases::isLowerTooth(mouth.fdiNumber);
    // The case's frame is that of its tooth where the jaws are open: the antagonists come to it.
    const Pose closing = isLower ? mouth.opening : mouth.opening.inverse();
    std::vector<TriangleTree> trees;
    std::vector<Antagonist> antagonists;
    for (const cases::PlacedTooth& other : mouth.others) {
        if (cases::isLowerTooth(other.fdiNumber) == isLower) continue;
        trees.emplace_back(other.outer);
        antagonists.push_back({nullptr, (closing * other.inCase).inverse()});
    }
    for (std::size_t k = 0; k < trees.size(); ++k)
        antagonists[k].tree = &trees[k];
    const std::vector<Vec3> whole = mouth.outer.vertices;
    for (const Edges edges : {Edges::asTheyComeToLie, Edges::ground}) {
        const TriangleTree own(mouth.outer);
        take(mouth, groundOf(mouth, Bite(own, antagonists, Grinds::thisOne), edges));
    }
    return deepestMm(whole, mouth.outer.vertices);
}

}  // namespace handpiece::dentition
