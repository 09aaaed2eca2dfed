// SPDX-License-Identifier: Apache-2.0
/// How teeth meet in intercuspation: contacts, facets, enamel under them.
#include "handpiece/model/dentition/occlusion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "model/dentition/mouths.h"

namespace handpiece::dentition::occlusion_test {
namespace {

/// A contact: where antagonists are within 20 um; places nearer to each other than 0.7 mm are one.
constexpr double kContactMm = 0.020, kApartMm = 0.7;

/// How far from its nearest antagonist each place of a tooth is, where that is less than `boundMm`; vertices and
/// edges' middles.
std::vector<std::pair<Vec3, double>> nearAntagonists(const Mouth& m, std::size_t tooth, double boundMm) {
    std::vector<std::pair<Vec3, double>> places;
    const auto ask = [&](const Vec3& p) {
        double nearest = boundMm;
        for (std::size_t other = 0; other < kToothCount; ++other) {
            if (isUpper(other) == isUpper(tooth)) continue;
            const core::Box box = m.trees[other].bounds().grown(boundMm);
            if (((p - box.max).array() > 0.0).any() || ((box.min - p).array() > 0.0).any()) continue;
            if (m.trees[other].nearest(p, 0.5).triangle == geometry::kNoTriangle) continue;
            nearest = std::min(nearest, m.trees[other].signedDistance(p));
        }
        if (nearest < boundMm) places.emplace_back(p, nearest);
    };
    const TriangleMesh& mesh = m.placed[tooth];
    for (const Vec3& p : mesh.vertices)
        ask(p);
    for (const geometry::Triangle& t : mesh.triangles)
        for (std::size_t e = 0; e < 3; ++e)
            if (t[e] < t[(e + 1) % 3]) ask(0.5 * (mesh.vertices[t[e]] + mesh.vertices[t[(e + 1) % 3]]));
    return places;
}

int contactsOf(const std::vector<std::pair<Vec3, double>>& places) {
    std::vector<bool> isCounted(places.size(), false);
    int contacts = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (isCounted[i]) continue;
        ++contacts;
        isCounted[i] = true;
        for (std::vector<std::size_t> open{i}; !open.empty();) {
            const std::size_t from = open.back();
            open.pop_back();
            for (std::size_t j = 0; j < places.size(); ++j)
                if (!isCounted[j] && (places[from].first - places[j].first).norm() < kApartMm)
                    isCounted[j] = true, open.push_back(j);
        }
    }
    return contacts;
}

double medianOf(std::vector<int> v) {
    std::sort(v.begin(), v.end());
    return 0.5 * (v[(v.size() - 1) / 2] + v[v.size() / 2]);
}

/// Of 709 people, medians: premolars 2, molars 4 to 5, first lower molars 6 (SHIP-1, docs/anatomy.md). The left is the
/// right in the mirror, so one side is counted, without third molars.
TEST(Occlusion, TeethMeetInNearlyAsManyContactsAsPeoples) {
    std::map<int, std::vector<int>> contacts;
    std::vector<int> premolars, molars;
    double least = 1.0, deepest = 0.0;
    // HANDPIECE_MOUTHS=8: those of docs/anatomy.md.
    const char* const asked = std::getenv("HANDPIECE_MOUTHS");
    const std::uint64_t seeds = asked ? std::strtoull(asked, nullptr, 10) : 4;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        const Mouth m = seed <= 3 ? mouth(seed) : madeMouth(seed);
        deepest = std::max(deepest, m.deepestFacetMm);
        for (std::size_t i = 0; i < kToothCount; ++i) {
            if (fdiOf(i) / 10 != 1 && fdiOf(i) / 10 != 4) continue;
            const auto places = nearAntagonists(m, i, kContactMm);
            for (const auto& [at, gapMm] : places)
                least = std::min(least, gapMm);
            if (i % 8 < 3) continue;
            contacts[fdiOf(i)].push_back(contactsOf(places));
            EXPECT_GE(contacts[fdiOf(i)].back(), i % 8 == 7 ? 0 : 1) << fdiOf(i) << ", seed " << seed;
            if (i % 8 < 7) (i % 8 < 5 ? premolars : molars).push_back(contacts[fdiOf(i)].back());
        }
    }
    for (const auto& [fdi, counts] : contacts)
        fmt::print("{}: median {:.1f} of {}\n", fdi, medianOf(counts), fmt::join(counts, " "));
    fmt::print("premolars {:.1f}, molars {:.1f}; least gap {:.1f} um, deepest facet {:.0f} um\n", medianOf(premolars),
               medianOf(molars), 1e3 * least, 1e3 * deepest);
    EXPECT_GE(medianOf(premolars), 2.0);
    EXPECT_GE(medianOf(molars), 4.0);
    EXPECT_GE(medianOf(contacts[46]), 5.0);
    EXPECT_GE(least, -0.002) << "antagonists overlap";
    EXPECT_LE(deepest, 0.15);
}

TEST(Occlusion, GroundTeethAreSolids) {
    const Mouth& m = mouth(1);
    EXPECT_GT(m.deepestFacetMm, 0.02) << "nothing was ground";
    const std::vector<cases::Tooth> whole = coarseTeeth({1, 25.0});
    for (std::size_t i = 0; i < kToothCount; ++i) {
        SCOPED_TRACE(fdiOf(i));
        const geometry::MeshReport report = geometry::inspect(m.teeth[i].outer);
        EXPECT_TRUE(report.closed() && report.oriented());
        // Coarse unthinned surfaces may cross where they do not as makeTooth() makes them: no more than before.
        EXPECT_LE(geometry::selfIntersections(m.teeth[i].outer).size(),
                  geometry::selfIntersections(whole[i].outer).size());
    }
}

/// Teeth with their tissues, before and after facets are ground; made once.
struct Ground {
    std::vector<cases::Tooth> whole, teeth;
    Arrangement arches;

    Ground() : whole(kToothCount) {
        core::parallelFor(kToothCount, 1, [&](std::size_t from, std::size_t to) {
            for (std::size_t i = from; i < to; ++i)
                if (isRightTooth(i)) whole[i] = makeTooth(fdiOf(i), {1, 25.0}, {8000, 0});
        });
        addLeftTeeth(whole);
        teeth = whole;
        arches = arrange(teeth);
        grindFacets(teeth, arches);
    }
};
const Ground& ground() {
    static const Ground made;
    return made;
}

/// Enamel and the whole tooth stay one surface, the dentine stays covered, landmarks go with the surface.
TEST(Occlusion, FacetsStayInTheEnamel) {
    int moved = 0;
    for (std::size_t i = 0; i < kToothCount; ++i) {
        const cases::Tooth &was = ground().whole[i], &tooth = ground().teeth[i];
        SCOPED_TRACE(tooth.fdiNumber);
        const TriangleMesh &enamel = tooth.parts[0].mesh, &wasEnamel = was.parts[0].mesh;
        ASSERT_EQ(tooth.parts[0].tissue, cases::Tissue::enamel);
        ASSERT_EQ(tooth.parts[1].tissue, cases::Tissue::dentine);
        for (const TriangleMesh* mesh : {&tooth.outer, &enamel}) {
            EXPECT_TRUE(geometry::inspect(*mesh).closed());
            EXPECT_TRUE(geometry::selfIntersections(*mesh, 1).empty());
        }
        const TriangleTree outer(tooth.outer), dentine(tooth.parts[1].mesh);
        double out = 0.0, thinnest = 1e9;
        for (std::size_t v = 0; v < enamel.vertices.size(); ++v)
            if (enamel.vertices[v] != wasEnamel.vertices[v])
                out = std::max(out, std::abs(outer.signedDistance(enamel.vertices[v])));
        for (std::size_t v = 0; v < tooth.outer.vertices.size(); ++v)
            if (tooth.outer.vertices[v] != was.outer.vertices[v])
                ++moved, thinnest = std::min(thinnest, dentine.signedDistance(tooth.outer.vertices[v]));
        EXPECT_LT(out, 0.03) << "enamel beside the surface";
        EXPECT_GT(thinnest, 0.3) << "facets down to the dentine";
        for (std::size_t k = 0; k < was.landmarks.size(); ++k)
            for (std::size_t n = 0; n < was.landmarks[k].pointsMm.size(); ++n)
                if (const Vec3& at = tooth.landmarks[k].pointsMm[n]; at != was.landmarks[k].pointsMm[n]) {
                    EXPECT_NEAR(outer.signedDistance(at), 0.0, 0.03) << was.landmarks[k].name;
                }
    }
    EXPECT_GT(moved, 200);
}

/// A finer tooth in the place of one that was ground does not stand in its antagonists.
TEST(Occlusion, AFinerToothIsGroundOntoItsAntagonists) {
    const std::size_t own = indexOf(46);
    const Pose mandible = opened(ground().arches, 30.0), inMouth = mandible * ground().arches.toothInMouth[own];
    cases::Case made;
    static_cast<cases::Tooth&>(made) = makeTooth(46, {1, 25.0}, {30000, 0});
    for (std::size_t i = 0; i < kToothCount / 2; ++i) {
        cases::PlacedTooth other;
        static_cast<cases::Tooth&>(other) = ground().teeth[i];
        other.inCase = inMouth.inverse() * ground().arches.toothInMouth[i];
        made.others.push_back(std::move(other));
    }
    made.opening = inMouth.inverse() * mandible * inMouth;
    const auto leastMm = [&] {
        double least = 1.0;
        for (const cases::PlacedTooth& other : made.others) {
            const TriangleTree tree(geometry::transformed(other.outer, made.opening * other.inCase));
            for (const Vec3& v : made.outer.vertices)
                if (tree.nearest(v, 0.5).triangle != geometry::kNoTriangle)
                    least = std::min(least, tree.signedDistance(v));
        }
        return least;
    };
    EXPECT_LT(leastMm(), -0.01);
    EXPECT_GT(grindOntoAntagonists(made), 0.01);
    EXPECT_GE(leastMm(), 0.0);
    EXPECT_TRUE(geometry::inspect(made.outer).closed());
    EXPECT_TRUE(geometry::selfIntersections(made.outer, 1).empty());
}

TEST(Occlusion, RefusesLessThanAMouth) {
    std::vector<cases::Tooth> three(3);
    EXPECT_THROW((void)grindFacets(three, {}), core::Error);
}

}  // namespace
}  // namespace handpiece::dentition::occlusion_test
