// SPDX-License-Identifier: Apache-2.0
// Lesions in teeth, measured on their meshes: how deep they go, that they nest, that they stay in the tooth.
#include "handpiece/model/lesion/lesion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/points_beyond.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/case/case_check.h"
#include "handpiece/model/field/part_tissues.h"
#include "handpiece/model/starter/starter.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::lesion::lesion_test {
namespace {

using cases::Tissue;
using core::Vec3;
using geometry::TriangleTree;
using starter::ToothKind;

/// Seconds to make: each once. Without the lesion that it comes with.
const cases::Case& soundTooth(ToothKind kind) {
    static std::map<ToothKind, cases::Case> made;
    if (!made.contains(kind)) {
        cases::Case& tooth = made[kind] = starter::makeTooth(kind, {12000, 0, false});
        std::erase_if(tooth.parts, [](const cases::Part& p) { return cases::isCarious(p.tissue); });
    }
    return made.at(kind);
}
cases::Case with(ToothKind kind, std::string_view lesions, std::uint64_t seed, double spacingMm = 0.12) {
    cases::Case tooth = soundTooth(kind);
    addLesions(tooth, lesionsByName(lesions), {.seed = seed, .spacingMm = spacingMm});
    return tooth;
}
const geometry::TriangleMesh& meshOf(const cases::Tooth& tooth, Tissue tissue) {
    for (const cases::Part& p : tooth.parts)
        if (p.tissue == tissue) return p.mesh;
    throw core::Error("there is no such part");
}
Vec3 pointIn(const core::Box& box, std::mt19937_64& generator) {
    Vec3 p;
    for (int k = 0; k < 3; ++k)
        p[k] = test::uniform(generator, box.min[k], box.max[k]);
    return p;
}

/// The greatest share of the thickness of enamel (or dentine) between two surfaces that parts reach with their
/// vertices. Where the whole is thinner than a few cells of the grid that lesions are made on, shares say nothing.
double deepestShare(const std::vector<const cases::Part*>& parts, const TriangleTree& from, const TriangleTree& to) {
    constexpr double kThinMm = 0.4;
    double most = 0.0;
    for (const cases::Part* part : parts)
        for (const Vec3& v : part->mesh.vertices) {
            const double in = -from.signedDistance(v), left = to.signedDistance(v);
            if (in > 0.0 && in + left > kThinMm) most = std::max(most, in / (in + std::max(0.0, left)));
        }
    return most;
}

TEST(Lesion, NamesSayWhereAndHowDeep) {
    const std::vector<Lesion> lesions = lesionsByName("occlusal:D2,mesial:E2,root:D1,buccal:calculus");
    ASSERT_EQ(lesions.size(), 4u);
    EXPECT_EQ(lesions[1].surface, Surface::mesial);
    EXPECT_EQ(lesions[1].finding, Finding::e2);
    EXPECT_EQ(lesions[3].finding, Finding::calculus);
    EXPECT_TRUE(lesionsByName("").empty());
    for (const char* wrong : {"occlusal", "top:D2", "occlusal:D4", "occlusal:", ":D2", "root:E1", "mesial:d2"})
        EXPECT_THROW((void)lesionsByName(wrong), core::Error) << wrong;
    EXPECT_NE(test::errorOf([] { (void)lesionsByName("top:D2"); }).find("lingual"), std::string::npos);
}

TEST(Lesion, OfAMouthGoIntoTheTeethThatAreNamed) {
    const MouthLesions lesions = mouthLesionsByName("46:mesial:E1,46:root:D1,45:distal:E2");
    ASSERT_EQ(lesions.size(), 2u);
    EXPECT_EQ(lesions.at(46).size(), 2u);
    EXPECT_EQ(lesions.at(45).front().finding, Finding::e2);
    for (const char* wrong : {"mesial:E1", "46", "46:", ":mesial:E1", "46mesial:E1", "46:mesial", "46:root:E1"})
        EXPECT_THROW((void)mouthLesionsByName(wrong), core::Error) << wrong;
    cases::Case mouth = soundTooth(ToothKind::lowerFirstMolar);
    mouth.fdiNumber = 46;
    cases::PlacedTooth beside;
    static_cast<cases::Tooth&>(beside) = soundTooth(ToothKind::lowerFirstMolar);
    beside.fdiNumber = 45;
    mouth.others.push_back(beside);
    const std::size_t sound = mouth.parts.size();
    addLesions(mouth, mouthLesionsByName("45:mesial:E1"), {.spacingMm = 0.12});
    EXPECT_EQ(mouth.parts.size(), sound);
    EXPECT_EQ(mouth.others.front().parts.size(), sound + 1);
    EXPECT_NE(test::errorOf([&] { addLesions(mouth, mouthLesionsByName("44:mesial:E1")); }).find("44"),
              std::string::npos);
}

TEST(Lesion, EachReachesAsDeepAsItsClassInAnyToothAndStaysInIt) {
    std::mt19937_64 generator(test::seed());
    constexpr std::array kKinds{ToothKind::lowerFirstMolar, ToothKind::upperPremolar, ToothKind::upperIncisor};
    std::array<int, 5> seen{};
    // Three to a tooth, each on a surface of its own: trees of the tooth serve all of them.
    for (int i = 0; i < 17; ++i) {
        const ToothKind kind = kKinds[generator() % kKinds.size()];
        std::vector<Surface> surfaces;
        while (surfaces.size() < 3) {
            const auto surface = static_cast<Surface>(generator() % kSurfaces.size());
            if (kind == ToothKind::upperIncisor && surface == Surface::occlusal) continue;
            if (std::find(surfaces.begin(), surfaces.end(), surface) == surfaces.end()) surfaces.push_back(surface);
        }
        std::vector<std::size_t> numbers;
        std::string names;
        for (const Surface surface : surfaces) {
            const std::size_t least = surface == Surface::root ? 2 : 0;
            numbers.push_back(least + generator() % (5 - least));
            names += (names.empty() ? "" : ",") + std::string(kSurfaces[static_cast<std::size_t>(surface)]) + ":" +
                     std::string(kFindings[numbers.back()]);
        }
        const std::uint64_t seed = generator();
        SCOPED_TRACE(names + " in " + std::string(starter::infoOf(kind).name) + ", seed " + std::to_string(seed));
        const cases::Case tooth = with(kind, names, seed);
        cases::requireCase(tooth);
        const TriangleTree outer(tooth.outer), dentine(meshOf(tooth, Tissue::dentine)),
            pulp(meshOf(tooth, Tissue::pulp));
        for (std::size_t n = 0; n < surfaces.size(); ++n) {
            const Surface surface = surfaces[n];
            const std::size_t number = numbers[n];
            const std::string own =
                std::string(kSurfaces[static_cast<std::size_t>(surface)]) + "-" + std::string(kFindings[number]);
            std::vector<const cases::Part*> enamelParts, levels;
            for (const cases::Part& part : tooth.parts) {
                if (!part.name.starts_with(own)) continue;
                if (part.tissue == Tissue::demineralisedEnamel) enamelParts.push_back(&part);
                if (cases::isCarious(part.tissue)) levels.push_back(&part);
                ASSERT_TRUE(part.tissue == Tissue::demineralisedEnamel || cases::isCarious(part.tissue));
                ASSERT_TRUE(geometry::pointsBeyond(outer, part.mesh.vertices, cases::kCaseToleranceMm).empty())
                    << part.name;
                ASSERT_TRUE(geometry::pointsBeyond(pulp, part.mesh.vertices, 0.0, -1.0).empty()) << part.name;
            }
            const DepthClass depth = depthClassOf(static_cast<Finding>(number));
            ASSERT_EQ(levels.empty(), !depth.inDentine);
            EXPECT_EQ(enamelParts.empty(), surface == Surface::root);
            const double deepest =
                depth.inDentine ? deepestShare(levels, dentine, pulp) : deepestShare(enamelParts, outer, dentine);
            EXPECT_GT(deepest, depth.from) << own;
            EXPECT_LT(deepest, depth.to) << own;
            ++seen[number];
            // Softer within harder, and above it.
            for (std::size_t k = 1; k < levels.size(); ++k) {
                const TriangleTree around(levels[k - 1]->mesh);
                EXPECT_GT(levels[k]->priority, levels[k - 1]->priority);
                ASSERT_TRUE(geometry::pointsBeyond(around, levels[k]->mesh.vertices, 0.0, 1.0).empty())
                    << levels[k]->name;
            }
            // The softest level of a small tooth's D1 may be too small to be there.
            EXPECT_LE(levels.size(), number < 2 ? 0u : number == 2 ? 4u : cases::kCariousLevels.size());
            EXPECT_GE(levels.size(), number < 2 ? 0u : number == 2 ? 3u : cases::kCariousLevels.size());
        }
    }
    for (std::size_t f = 0; f < seen.size(); ++f)
        EXPECT_GT(seen[f], 2) << kFindings[f];
}

TEST(Lesion, SmoothSurfacesHaveTheirBaseOutsideAndFissuresInside) {
    // How much of the enamel's part lies in the outer half of the enamel's thickness, and in the inner half.
    const auto halves = [](std::string_view name) {
        const cases::Case tooth = with(ToothKind::lowerFirstMolar, name, 3);
        const TriangleTree outer(tooth.outer), dentine(meshOf(tooth, Tissue::dentine));
        const TriangleTree part(meshOf(tooth, Tissue::demineralisedEnamel));
        std::mt19937_64 generator(test::seed());
        std::array<double, 2> found{};
        for (int i = 0; i < 8000; ++i) {
            const Vec3 p = pointIn(part.bounds(), generator);
            const double in = -outer.signedDistance(p), left = dentine.signedDistance(p);
            if (in > 0.0 && left > 0.0 && part.signedDistance(p) < 0.0) ++found[in > left];
        }
        return found;
    };
    for (const char* smooth : {"mesial:D1", "distal:E2", "lingual:D2"}) {
        const auto [outside, inside] = halves(smooth);
        EXPECT_GT(outside, 1.3 * inside) << smooth;
    }
    for (const char* fissure : {"occlusal:D1", "occlusal:D2"}) {
        const auto [outside, inside] = halves(fissure);
        EXPECT_GT(inside, 1.15 * outside) << fissure;
    }
}

TEST(Lesion, SpreadsAlongTheDentineAndNarrowsTowardsThePulp) {
    const cases::Case tooth = with(ToothKind::lowerFirstMolar, "mesial:D3", 5);
    const TriangleTree dentine(meshOf(tooth, Tissue::dentine)), pulp(meshOf(tooth, Tissue::pulp));
    const TriangleTree decay(meshOf(tooth, Tissue::cariesFirmToHard));
    std::mt19937_64 generator(test::seed());
    std::array<double, 3> third{};
    for (int i = 0; i < 15000; ++i) {
        const Vec3 p = pointIn(decay.bounds(), generator);
        const double in = -dentine.signedDistance(p), left = pulp.signedDistance(p);
        if (in < 0.0 || left < 0.0 || decay.signedDistance(p) >= 0.0) continue;
        ++third[std::min<std::size_t>(2, static_cast<std::size_t>(3.0 * in / (in + left)))];
    }
    EXPECT_GT(third[0], 1.5 * third[1]);
    EXPECT_GT(third[1], 1.5 * third[2]);
    EXPECT_GT(third[2], 0.0);
}

TEST(Lesion, SeveralAtOnceTakeTheSpaceThatTheirSurfacesEnclose) {
    const cases::Case tooth = with(ToothKind::lowerFirstMolar,
                                   "occlusal:D2,mesial:D3,distal:E2,buccal:E1,cervical:D1,root:D1,lingual:filling", 7);
    cases::requireCase(tooth);
    std::vector<TriangleTree> trees;
    trees.reserve(tooth.parts.size());
    std::vector<field::PartSurface> surfaces;
    for (const cases::Part& part : tooth.parts) {
        trees.emplace_back(part.mesh);
        surfaces.push_back({&trees.back(), part.tissue, part.priority});
    }
    const field::PartTissues tissues(surfaces);
    std::mt19937_64 generator(test::seed());
    // Nothing hides the softest level of a lesion: where its tissue is found is what its surface encloses.
    for (const cases::Part& part : tooth.parts) {
        if (part.tissue != Tissue::cariesSoft) continue;
        const core::Box box = part.mesh.bounds();
        constexpr int kPoints = 10000;
        int found = 0;
        for (int i = 0; i < kPoints; ++i)
            found += tissues.at(pointIn(box, generator)) == Tissue::cariesSoft;
        EXPECT_NEAR(found * box.size().prod() / kPoints / geometry::enclosedVolumeMm3(part.mesh), 1.0, 0.06)
            << part.name;
    }
    std::map<Tissue, int> met;
    for (const cases::Part& part : tooth.parts)
        if (part.tissue == Tissue::cariesFirmToHard || part.tissue == Tissue::restoration)
            for (int i = 0; i < 4000; ++i)
                ++met[tissues.at(pointIn(part.mesh.bounds(), generator))];
    for (const Tissue level : cases::kCariousLevels)
        EXPECT_GT(met[level], 20) << cases::properties(level).name;
    EXPECT_GT(met[Tissue::demineralisedEnamel], 20);
    EXPECT_GT(met[Tissue::restoration], 20);
}

TEST(Lesion, StainAndCracksStayInTheEnamelAndCalculusLiesOnTheTooth) {
    const cases::Case& before = soundTooth(ToothKind::lowerFirstMolar);
    const cases::Case tooth = with(ToothKind::lowerFirstMolar, "occlusal:stain,mesial:crack,lingual:calculus", 11);
    cases::requireCase(tooth);
    const TriangleTree sound(before.outer), now(tooth.outer);
    int parts = 0;
    for (const cases::Part& part : tooth.parts) {
        if (part.tissue == Tissue::stainedEnamel) {
            ++parts;
            for (const Vec3& v : part.mesh.vertices)
                ASSERT_LT(sound.signedDistance(v), 0.06) << part.name;
        }
        if (part.tissue != Tissue::calculus) continue;
        ++parts;
        double highest = 0.0, over = -1.0;
        for (const Vec3& v : part.mesh.vertices) {
            highest = std::max(highest, sound.signedDistance(v));
            over = std::max(over, now.signedDistance(v));
        }
        EXPECT_GT(highest, 0.25);
        EXPECT_LT(highest, 0.55);
        EXPECT_LT(over, 0.06);  // within the tooth's surface as it is felt
    }
    EXPECT_EQ(parts, 3);
    // A cap of 0.3 to 0.5 mm that falls off to its rim at 1.6 to 2.3 mm.
    const double grown = geometry::enclosedVolumeMm3(tooth.outer) - geometry::enclosedVolumeMm3(before.outer);
    EXPECT_GT(grown, 0.5);
    EXPECT_LT(grown, 5.0);
    EXPECT_THROW((void)with(ToothKind::lowerFirstMolar, "occlusal:calculus", 1), core::Error);
}

TEST(Lesion, TheSameSeedGivesTheSamePartsAtAnyNumberOfThreads) {
    const auto volumes = [](std::uint64_t seed) {
        std::vector<double> all;
        for (const cases::Part& p : with(ToothKind::upperPremolar, "occlusal:D2,distal:D1", seed, 0.12).parts)
            all.push_back(geometry::enclosedVolumeMm3(p.mesh));
        return all;
    };
    core::setThreadCount(1);
    const auto one = volumes(4);
    core::setThreadCount(0);
    EXPECT_EQ(volumes(4), one);
    EXPECT_NE(volumes(5), one);
}

TEST(Lesion, ToldWhatAToothLacks) {
    EXPECT_NE(test::errorOf([] { (void)with(ToothKind::upperIncisor, "occlusal:E1", 1); }).find("fissure"),
              std::string::npos);
    cases::Case tooth = soundTooth(ToothKind::upperIncisor);
    std::erase_if(tooth.parts, [](const cases::Part& p) { return p.tissue == Tissue::pulp; });
    EXPECT_NE(test::errorOf([&] { addLesions(tooth, lesionsByName("mesial:D1")); }).find("pulp"), std::string::npos);
    tooth = soundTooth(ToothKind::upperIncisor);
    tooth.buccalSign = 0;
    EXPECT_NE(test::errorOf([&] { addLesions(tooth, lesionsByName("mesial:D1,buccal:D1")); }).find("buccal"),
              std::string::npos);
    EXPECT_EQ(tooth.parts.size(), soundTooth(ToothKind::upperIncisor).parts.size());  // nothing, or all
}

}  // namespace
}  // namespace handpiece::lesion::lesion_test
