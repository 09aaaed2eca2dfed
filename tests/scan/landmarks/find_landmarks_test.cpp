// SPDX-License-Identifier: Apache-2.0
// Generated teeth know where their landmarks are: how far from there they are found, how many of them, and how many
// lie elsewhere.
#include "handpiece/scan/landmarks/find_landmarks.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/model/dentition/tooth_form.h"
#include "support/random.h"

namespace handpiece::landmarks::find_landmarks_test {
namespace {
using cases::Landmark;
using cases::LandmarkKind;
using core::Vec3;

constexpr double kElsewhereMm = 1.0;  ///< farther from its landmark than this it is another place
constexpr double kElsewhereDegrees = 10.0;

/// As rough as marching cubes leave them: finer ones cost, and find no better.
cases::Tooth roughTooth(int fdi, std::uint64_t seed) {
    const dentition::ToothForm form(fdi, {seed, 30.0});
    const auto surface = [&](double (dentition::ToothForm::*of)(const Vec3&) const, double spacingMm) {
        geometry::IsosurfaceSettings settings;
        settings.lipschitz = dentition::ToothForm::kLipschitz;
        settings.usualSlope = 1.0;
        settings.spacingMm = spacingMm;
        return geometry::isosurface(
            form.bounds(), [&](const Vec3& p) { return (form.*of)(p); }, settings);
    };
    cases::Tooth tooth;
    tooth.fdiNumber = fdi;
    tooth.buccalSign = form.buccalSign();
    tooth.outer = surface(&dentition::ToothForm::outer, 0.17);
    tooth.parts.push_back({"dentine", cases::Tissue::dentine, 50, surface(&dentition::ToothForm::dentine, 0.2)});
    tooth.parts.push_back({"pulp", cases::Tissue::pulp, 60, surface(&dentition::ToothForm::pulp, 0.13)});
    tooth.landmarks = form.landmarks();
    return tooth;
}

/// Of all kinds of the right, each of another patient than the next.
const std::vector<cases::Tooth>& teeth() {
    static const std::vector<cases::Tooth> made = [] {
        std::vector<cases::Tooth> all;
        for (const int quadrant : {10, 40})
            for (int unit = 1; unit <= 8; ++unit)
                all.push_back(roughTooth(quadrant + unit, static_cast<std::uint64_t>(unit % 3 + 1)));
        return all;
    }();
    return made;
}

struct Tally {
    int known = 0, found = 0, elsewhere = 0;
    std::vector<double> errorsMm;  ///< of axes degrees
    double covered = 0.0;          ///< of a line's length, what was found of it, summed
    [[nodiscard]] double at(double share) {
        std::sort(errorsMm.begin(), errorsMm.end());
        return errorsMm.empty()
                   ? 0.0
                   : errorsMm[static_cast<std::size_t>(share * (static_cast<double>(errorsMm.size()) - 1))];
    }
    [[nodiscard]] double recall() const { return static_cast<double>(found - elsewhere) / known; }
};

/// From a point to a line through points, or to the only one.
double distanceMm(const Vec3& p, const Landmark& truth) {
    const auto& line = truth.pointsMm;
    double least = (p - line.front()).norm();
    const std::size_t legs = cases::shapeOf(truth.kind).isRing ? line.size() : line.size() - 1;
    for (std::size_t i = 0; i < legs; ++i) {
        const Vec3 from = line[i], way = line[(i + 1) % line.size()] - from;
        const double share = std::clamp((p - from).dot(way) / std::max(way.squaredNorm(), 1e-12), 0.0, 1.0);
        least = std::min(least, (p - from - share * way).norm());
    }
    return least;
}

bool isAxis(LandmarkKind kind) {
    return cases::shapeOf(kind).least == 2 && cases::shapeOf(kind).most == 2;
}

/// A line's error is that of nine tenths of its points, an axis's the angle between the two [degrees].
double errorMm(const Landmark& found, const Landmark& truth) {
    if (isAxis(found.kind)) {
        const Vec3 one = (found.pointsMm[1] - found.pointsMm[0]).normalized(),
                   other = (truth.pointsMm[1] - truth.pointsMm[0]).normalized();
        return std::acos(std::clamp(one.dot(other), -1.0, 1.0)) * 180.0 / std::numbers::pi;
    }
    std::vector<double> all;
    for (const Vec3& p : found.pointsMm)
        all.push_back(distanceMm(p, truth));
    std::sort(all.begin(), all.end());
    return all[static_cast<std::size_t>(0.9 * (static_cast<double>(all.size()) - 1))];
}

/// The share of a line that what was found runs along.
double coveredShare(const Landmark& found, const Landmark& truth) {
    constexpr double kNearMm = 0.6;
    int near = 0, all = 0;
    for (std::size_t i = 0; i + 1 < truth.pointsMm.size(); ++i)
        for (int k = 0; k < 4; ++k, ++all)
            near += distanceMm(truth.pointsMm[i] + (truth.pointsMm[i + 1] - truth.pointsMm[i]) * (k / 4.0), found) <
                    kNearMm;
    return all > 0 ? static_cast<double>(near) / all : 1.0;
}

/// Of each tooth, done to as `change` says; its truth is changed with it.
template <class Change>
std::map<LandmarkKind, Tally> tallied(const char* what, const Change& change) {
    std::map<LandmarkKind, Tally> tallies;
    for (const cases::Tooth& tooth : teeth()) {
        cases::Tooth changed = tooth;
        change(changed);
        const std::vector<Landmark> truth = std::move(changed.landmarks);
        const std::vector<Landmark> found = findLandmarks(changed);
        for (const Landmark& mark : truth) {
            ++tallies[mark.kind].known;
            if (mark.kind == LandmarkKind::cuspTip && std::none_of(found.begin(), found.end(), [&](const Landmark& f) {
                    return f.kind == mark.kind && f.name == mark.name;
                }))
                fmt::print("  {} cusp-tip {}: not found\n", tooth.fdiNumber, mark.name);
        }
        for (const Landmark& mark : found) {
            Tally& tally = tallies[mark.kind];
            ++tally.found;
            EXPECT_EQ(mark.source, cases::LandmarkSource::found);
            const auto known = std::find_if(truth.begin(), truth.end(), [&](const Landmark& t) {
                return t.kind == mark.kind && t.name == mark.name;
            });
            const double error = known == truth.end() ? 99.0 : errorMm(mark, *known);
            tally.errorsMm.push_back(error);
            if (known != truth.end() && !isAxis(mark.kind)) tally.covered += coveredShare(mark, *known);
            if (error > (isAxis(mark.kind) ? kElsewhereDegrees : kElsewhereMm)) {
                ++tally.elsewhere;
                fmt::print("  {} {} {}: {:.2f} mm off\n", tooth.fdiNumber,
                           cases::kLandmarkKinds[static_cast<std::size_t>(mark.kind)], mark.name, error);
            }
        }
    }
    fmt::print("{}\n  {:<24} {:>6} {:>6} {:>7} {:>6} {:>6} {:>10} {:>8}\n", what, "kind", "known", "found", "recall",
               "p50", "p90", "elsewhere", "covered");
    for (auto& [kind, tally] : tallies)
        if (tally.found > 0)
            fmt::print("  {:<24} {:>6} {:>6} {:>7.2f} {:>6.2f} {:>6.2f} {:>10} {:>8.2f}\n",
                       cases::kLandmarkKinds[static_cast<std::size_t>(kind)], tally.known, tally.found, tally.recall(),
                       tally.at(0.5), tally.at(0.9), tally.elsewhere, tally.covered / tally.found);
    return tallies;
}

struct Bound {
    LandmarkKind kind;
    double recall, p50Mm, p90Mm;
    int elsewhere;
};

void expectWithin(std::map<LandmarkKind, Tally>& tallies, const std::vector<Bound>& bounds) {
    for (const Bound& bound : bounds) {
        SCOPED_TRACE(cases::kLandmarkKinds[static_cast<std::size_t>(bound.kind)]);
        Tally& tally = tallies[bound.kind];
        EXPECT_GT(tally.known, 0);
        EXPECT_GE(tally.recall(), bound.recall);
        EXPECT_LE(tally.at(0.5), bound.p50Mm);
        EXPECT_LE(tally.at(0.9), bound.p90Mm);
        EXPECT_LE(tally.elsewhere, bound.elsewhere);
    }
}

TEST(FindLandmarks, AreWhereTheGeneratorPutThem) {
    auto tallies = tallied("as generated", [](cases::Tooth&) {});
    // Above what was measured (docs/anatomy.md).
    expectWithin(tallies, {{LandmarkKind::cuspTip, 0.95, 0.05, 0.08, 0},
                           {LandmarkKind::fissure, 0.95, 0.17, 0.5, 0},
                           {LandmarkKind::marginalRidge, 0.9, 0.35, 0.7, 1},
                           {LandmarkKind::ridge, 0.65, 0.4, 0.8, 1},
                           {LandmarkKind::pit, 0.55, 0.4, 1.1, 3},
                           {LandmarkKind::apex, 0.95, 0.05, 0.1, 0},
                           {LandmarkKind::longAxis, 0.95, 0.5, 0.8, 0},
                           {LandmarkKind::contact, 0.95, 0.13, 0.3, 0},
                           {LandmarkKind::pulpHorn, 0.9, 0.1, 0.3, 0},
                           {LandmarkKind::heightOfContour, 0.6, 0.1, 0.18, 0},
                           {LandmarkKind::cementoEnamelJunction, 1.0, 0.2, 0.25, 0}});
}

TEST(FindLandmarks, NoiseOfAScanMovesThemLittle) {
    std::mt19937_64 generator(test::seed());
    std::normal_distribution<double> noise(0.0, 0.03);
    auto tallies = tallied("0.03 mm of noise", [&](cases::Tooth& tooth) {
        for (Vec3& v : tooth.outer.vertices)
            v += noise(generator) * test::randomDirection(generator);
    });
    // Above what was measured (docs/anatomy.md).
    expectWithin(tallies, {{LandmarkKind::cuspTip, 0.9, 0.06, 0.12, 0},
                           {LandmarkKind::contact, 0.9, 0.16, 0.3, 1},
                           {LandmarkKind::pulpHorn, 0.9, 0.1, 0.3, 0},
                           {LandmarkKind::heightOfContour, 0.5, 0.18, 0.26, 0},
                           {LandmarkKind::cementoEnamelJunction, 1.0, 0.22, 0.28, 0}});
}

TEST(FindLandmarks, AFrameFiveDegreesOffMovesThemLittle) {
    std::mt19937_64 generator(test::seed());
    auto tallies = tallied("turned by 5 degrees", [&](cases::Tooth& tooth) {
        const core::Quat turn(Eigen::AngleAxisd(5.0 * std::numbers::pi / 180.0, test::randomDirection(generator)));
        const auto turned = [&](std::vector<Vec3>& points) {
            for (Vec3& p : points)
                p = turn * p;
        };
        turned(tooth.outer.vertices);
        for (cases::Part& part : tooth.parts)
            turned(part.mesh.vertices);
        for (Landmark& mark : tooth.landmarks)
            turned(mark.pointsMm);
    });
    // Above what was measured (docs/anatomy.md).
    expectWithin(tallies, {{LandmarkKind::cuspTip, 0.9, 0.1, 0.18, 1},
                           {LandmarkKind::contact, 0.9, 0.5, 0.95, 3},
                           {LandmarkKind::pulpHorn, 0.9, 0.1, 0.3, 0},
                           {LandmarkKind::heightOfContour, 0.5, 0.35, 0.55, 0},
                           {LandmarkKind::cementoEnamelJunction, 0.95, 0.2, 0.25, 0}});
}

// As a scan of one tooth leaves it: which way it looks is a guess.
TEST(FindLandmarks, ACrownThatIsTurnedIsSeen) {
    std::mt19937_64 generator(test::seed());
    int molars = 0, molarsSeen = 0, others = 0, othersSeen = 0;
    for (const cases::Tooth& tooth : teeth()) {
        EXPECT_EQ(turnOfCrown(tooth), 0.0) << tooth.fdiNumber << " stands as it should";
        const double degrees = test::uniform(generator, 40.0, 320.0), rad = degrees * std::numbers::pi / 180.0;
        cases::Tooth turned = tooth;
        const core::Quat turn(Eigen::AngleAxisd(rad, Vec3::UnitZ()));
        for (Vec3& v : turned.outer.vertices)
            v = turn * v;
        const double off =
            std::abs(std::remainder(turnOfCrown(turned) - rad, 2.0 * std::numbers::pi)) * 180.0 / std::numbers::pi;
        const bool isSeen = off < 15.0;
        const bool isMolar = tooth.fdiNumber % 10 >= 6;
        ++(isMolar ? molars : others);
        (isMolar ? molarsSeen : othersSeen) += isSeen;
        fmt::print("  {} turned by {:.0f} degrees: {:.0f} off\n", tooth.fdiNumber, degrees, off);
    }
    fmt::print("  seen: {} of {} molars, {} of {} others\n", molarsSeen, molars, othersSeen, others);
    EXPECT_EQ(molarsSeen, molars);
}

TEST(FindLandmarks, WhatAPersonSetStays) {
    const Landmark set{LandmarkKind::cuspTip, "mesiobuccal", {Vec3(1, 2, 3)}, cases::LandmarkSource::set};
    Landmark before = set, now = set, other = set;
    before.source = now.source = other.source = cases::LandmarkSource::found;
    before.name = "distobuccal";
    now.pointsMm = {Vec3(9, 9, 9)};
    other.name = "distolingual";
    const std::vector<Landmark> all = withFound({set, before}, {now, other});
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all[0].pointsMm, set.pointsMm);
    EXPECT_EQ(all[0].source, cases::LandmarkSource::set);
    EXPECT_EQ(all[1].name, "distolingual");
}

}  // namespace
}  // namespace handpiece::landmarks::find_landmarks_test
