// SPDX-License-Identifier: Apache-2.0
// Preparations laid onto generated teeth and blocks: where they lie, what they leave, what is refused.
#include "handpiece/assess/preparation/preparation.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "handpiece/assess/preparation/zone_surfaces.h"
#include "handpiece/model/dentition/tooth_form.h"
#include "handpiece/model/lesion/lesion.h"
#include "handpiece/model/starter/block.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::preparation::preparation_test {
namespace {

using core::Vec3;

const cases::Tooth& toothOf(int fdi) {
    static std::map<int, cases::Tooth> made;
    const auto [at, isNew] = made.try_emplace(fdi);
    if (isNew) at->second = dentition::makeTooth(fdi, {1, 25.0}, {6000, 3000});
    return at->second;
}

Recipe recipeOf(const std::string& preparation, const std::string& side = {}) {
    Recipe recipe;
    recipe.preparation = preparation;
    recipe.side = side;
    return recipe;
}

/// The target's share of the tooth, by sampling at `step`.
struct Sampled {
    double targetMm3 = 0.0;
    core::Box box;                ///< of the places in the target
    double leastOutsideMm = 1e9;  ///< least distance, across, from a place of the lower half of it to the outside
};
Sampled sampled(const Laid& laid, double step) {
    Sampled s;
    const core::Box box = laid.zones->box();
    std::vector<Vec3> places;
    for (double z = box.min.z() + 0.5 * step; z < box.max.z(); z += step)
        for (double y = box.min.y() + 0.5 * step; y < box.max.y(); y += step)
            for (double x = box.min.x() + 0.5 * step; x < box.max.x(); x += step) {
                const Vec3 p(x, y, z);
                if (laid.zones->targetMm(p) >= 0.0 || laid.whole->signedDistance(p) >= 0.0) continue;
                s.targetMm3 += step * step * step;
                s.box.extend(p);
                places.push_back(p);
            }
    for (const Vec3& p : places)
        if (p.z() < s.box.min.z() + 0.2)
            for (int i = 0; i < 16; ++i) {
                const double rad = 2.0 * std::numbers::pi * i / 16;
                const geometry::RayMeeting out = laid.whole->firstMeeting(p, Vec3(std::cos(rad), std::sin(rad), 0.0));
                s.leastOutsideMm = std::min(s.leastOutsideMm, out.distanceMm);
            }
    return s;
}

TEST(Preparation, ClassOneFollowsTheFissuresAndLeavesTheRidges) {
    for (const int fdi : {16, 46, 45}) {
        Recipe recipe = recipeOf("class-one");
        if (fdi == 45) recipe.numbers = {{"ridge_mm", 1.6}, {"width_mm", 1.0}};
        const cases::Tooth& tooth = toothOf(fdi);
        const Laid laid = layOn(tooth, recipe);
        const Sampled s = sampled(laid, 0.15);
        EXPECT_GT(s.targetMm3, 5.0) << fdi;
        EXPECT_GE(s.leastOutsideMm, recipe.number("ridge_mm") - 0.1) << fdi;
        // The floor lies as deep as asked under the fissures, on average.
        const double floor = laid.cavities.front().floor.heightMm;
        double sum = 0.0;
        int count = 0;
        for (const cases::Landmark& mark : tooth.landmarks)
            if (mark.kind == cases::LandmarkKind::fissure)
                for (const Vec3& p : mark.pointsMm)
                    if (laid.zones->targetMm(Vec3(p.x(), p.y(), floor + 0.01)) < 0.0) sum += p.z() - floor, ++count;
        ASSERT_GT(count, 3) << fdi;
        EXPECT_NEAR(sum / count, recipe.number("depth_mm"), 0.35) << fdi;
        fmt::print("class I of {}: {:.1f} mm3, ridge {:.2f} mm, {} strokes\n", fdi, s.targetMm3, s.leastOutsideMm,
                   laid.cavities.front().outline.strokes.size());
    }
}

TEST(Preparation, LeftIsRightInTheMirror) {
    const Laid right = layOn(toothOf(46), recipeOf("class-two", "mesial")),
               left = layOn(toothOf(36), recipeOf("class-two", "mesial"));
    std::mt19937_64 random(test::seed(3));
    const core::Box box = right.zones->box();
    int off = 0;
    for (int i = 0; i < 5000; ++i) {
        const Vec3 p(test::uniform(random, box.min.x(), box.max.x()), test::uniform(random, box.min.y(), box.max.y()),
                     test::uniform(random, box.min.z(), box.max.z()));
        const double apart = std::abs(right.zones->targetMm(p) - left.zones->targetMm(Vec3(p.x(), -p.y(), p.z())));
        off += apart > 0.08;
        EXPECT_LT(apart, 0.25);
    }
    // Meshes are not each other's mirror, and a stroke ends within its pieces of 0.05 mm: a few places in a thousand.
    EXPECT_LE(off, 10);
}

TEST(Preparation, ClassTwoBreaksTheContactAndReachesUnderIt) {
    for (const char* side : {"mesial", "distal"}) {
        const cases::Tooth& tooth = toothOf(46);
        const Recipe recipe = recipeOf("class-two", side);
        const double underMm = recipe.number("under_contact_mm");
        const Laid laid = layOn(tooth, recipe);
        for (const cases::Landmark& mark : tooth.landmarks)
            if (mark.kind == cases::LandmarkKind::contact) {
                const Vec3 inside = mark.pointsMm.front() + Vec3(mark.name == "mesial" ? -0.3 : 0.3, 0, 0);
                EXPECT_EQ(laid.zones->at(inside) == zones::Zone::target, mark.name == side) << mark.name;
                EXPECT_EQ(laid.zones->at(inside - Vec3(0, 0, underMm - 0.1)) == zones::Zone::target, mark.name == side);
                EXPECT_NE(laid.zones->at(inside - Vec3(0, 0, underMm + 0.1)), zones::Zone::target);
            }
        // All of one piece: what the box holds and what the fissures hold touch.
        const Sampled s = sampled(laid, 0.2);
        EXPECT_GT(s.targetMm3, sampled(layOn(tooth, recipeOf("class-one")), 0.2).targetMm3 + 4.0);
    }
}

TEST(Preparation, ClassThreeAndFiveAndAccessAndCrownLieWhereTheyShould) {
    {
        const cases::Tooth& tooth = toothOf(11);
        const Laid laid = layOn(tooth, recipeOf("class-three", "mesial"));
        const Sampled s = sampled(laid, 0.08);
        EXPECT_GT(s.targetMm3, 1.0);
        EXPECT_LT(s.targetMm3, 12.0);
        EXPECT_GT(s.box.min.x(), 0.0) << "on the mesial side";
        // Labial enamel is left.
        const double labial = tooth.buccalSign * (tooth.buccalSign > 0 ? s.box.max.y() : s.box.min.y());
        EXPECT_LT(labial, tooth.buccalSign *
                                  (tooth.buccalSign > 0 ? laid.whole->bounds().max.y() : laid.whole->bounds().min.y()) -
                              0.8);
        EXPECT_NEAR(s.box.size().z(), 2.5, 0.2);
        // The labial surface must stay, half a millimetre of it; what the window goes in by is free.
        const Vec3 way(0.0, tooth.buccalSign, 0.0), middle = s.box.centre();
        const auto under = [&](double mm, double side) {
            const Vec3 off = 20.0 * side * way;
            return Vec3(middle + off -
                        (laid.whole->firstMeeting(middle + off, -side * way).distanceMm + mm) * side * way);
        };
        EXPECT_EQ(laid.zones->at(under(0.3, 1.0)), zones::Zone::protectedZone);
        EXPECT_NE(laid.zones->at(under(0.7, 1.0)), zones::Zone::protectedZone);
        EXPECT_EQ(laid.zones->at(under(0.2, -1.0)), zones::Zone::target);
    }
    {
        const cases::Tooth& tooth = toothOf(33);
        const Laid laid = layOn(tooth, recipeOf("class-five"));
        const Sampled s = sampled(laid, 0.08);
        EXPECT_NEAR(s.targetMm3, 4.5 * 2.5 * 1.0, 2.5);
        EXPECT_GT(tooth.buccalSign * s.box.centre().y(), 1.0) << "labial only";
        std::mt19937_64 random(test::seed(4));
        for (int i = 0; i < 2000; ++i) {
            const Vec3 p(test::uniform(random, s.box.min.x(), s.box.max.x()),
                         test::uniform(random, s.box.min.y(), s.box.max.y()),
                         test::uniform(random, s.box.min.z(), s.box.max.z()));
            EXPECT_TRUE(laid.zones->targetMm(p) >= 0.0 || -laid.whole->signedDistance(p) <= 1.0 + 1e-9);
        }
    }
    // The gingival wall follows the junction, as the gingiva's margin does, and is nowhere nearer than asked.
    for (const int fdi : {13, 33, 44, 36}) {
        const cases::Tooth& tooth = toothOf(fdi);
        const Laid laid = layOn(tooth, recipeOf("class-five"));
        const zones::Cavity& cavity = laid.cavities.front();
        const auto [low, high] = cavity.outline.bounds();
        EXPECT_NEAR(high.x() - low.x(), 4.5, 1e-6) << fdi;
        EXPECT_GE(high.y() - low.y(), 2.5 - 1e-6) << fdi;
        const cases::Landmark* junction = nullptr;
        for (const cases::Landmark& mark : tooth.landmarks)
            if (mark.kind == cases::LandmarkKind::cementoEnamelJunction) junction = &mark;
        double nearest = 1e9, farthest = 0.0;
        for (const Vec3& p : junction->pointsMm) {
            const Vec3 at = cavity.inTooth.applyInverse(p);
            // Between the rounded corners.
            if (tooth.buccalSign * p.y() < 0.0 || std::abs(at.x()) > 2.25 - 0.6) continue;
            double up = 0.0;
            while (cavity.outline.distanceMm({at.x(), at.y() + up}) > 0.0 && up < 5.0)
                up += 0.005;
            nearest = std::min(nearest, up), farthest = std::max(farthest, up);
        }
        EXPECT_GE(nearest, 0.75 - 0.006) << fdi;
        EXPECT_LE(farthest, 0.75 + 0.35) << fdi;
    }
    {
        const cases::Tooth& tooth = toothOf(46);
        const Laid laid = layOn(tooth, recipeOf("access"));
        for (const cases::Landmark& mark : tooth.landmarks) {
            if (mark.kind != cases::LandmarkKind::orifice && mark.kind != cases::LandmarkKind::pulpHorn) continue;
            EXPECT_LT(laid.zones->targetMm(mark.pointsMm.front() + Vec3(0, 0, 0.6)), 0.0) << mark.name;
        }
        // Root and furcation must stay whole.
        for (const cases::Landmark& mark : tooth.landmarks)
            if (mark.kind == cases::LandmarkKind::furcation) {
                EXPECT_EQ(laid.zones->at(mark.pointsMm.front() + Vec3(0, 0, 0.2)), zones::Zone::protectedZone);
                EXPECT_NE(laid.zones->at(mark.pointsMm.front() + Vec3(0, 0, 1.0)), zones::Zone::protectedZone);
            }
    }
    {
        const cases::Tooth& tooth = toothOf(46);
        const Laid laid = layOn(tooth, recipeOf("crown"));
        const double step = 0.15;
        const Sampled s = sampled(laid, step);
        EXPECT_GT(s.targetMm3, 80.0);
        EXPECT_LT(s.targetMm3, 400.0);
        // What is left over the margin can be drawn off: it never grows wider towards occlusal.
        const core::Box& box = laid.whole->bounds();
        int pairs = 0;
        for (double x = box.min.x(); x < box.max.x(); x += step)
            for (double y = box.min.y(); y < box.max.y(); y += step) {
                bool wasAir = false;
                for (double z = s.box.min.z() + 1.3; z < box.max.z(); z += step) {
                    const Vec3 p(x, y, z);
                    const bool isLeft = laid.whole->signedDistance(p) < 0.0 && laid.zones->targetMm(p) >= 0.0;
                    EXPECT_FALSE(isLeft && wasAir) << p.transpose();
                    wasAir = wasAir || !isLeft;
                    pairs += isLeft;
                }
            }
        EXPECT_GT(pairs, 1000);
        // On top as much is gone as asked.
        for (const cases::Landmark& mark : tooth.landmarks)
            if (mark.kind == cases::LandmarkKind::pit && mark.name == "central") {
                EXPECT_EQ(laid.zones->at(mark.pointsMm.front() - Vec3(0, 0, 1.3)), zones::Zone::target);
                EXPECT_NE(laid.zones->at(mark.pointsMm.front() - Vec3(0, 0, 1.9)), zones::Zone::target);
            }
    }
}

TEST(Preparation, AnOnlayKeepsItsMarginOverTheCervix) {
    cases::Tooth tooth = toothOf(46);
    Recipe recipe = recipeOf("onlay", "mesial");
    recipe.numbers = {{"cap_mesiobuccal_mm", 2.5}, {"shoulder_mm", 2.5}};
    EXPECT_NO_THROW((void)layOn(tooth, recipe));
    for (cases::Landmark& mark : tooth.landmarks)
        if (mark.kind == cases::LandmarkKind::cementoEnamelJunction)
            for (Vec3& p : mark.pointsMm)
                p.z() += 2.0;
    EXPECT_NE(test::errorOf([&] { (void)layOn(tooth, recipe); }).find("cemento-enamel junction"), std::string::npos);
    recipe.numbers["shoulder_mm"] = 0.5;
    EXPECT_NO_THROW((void)layOn(tooth, recipe));
}

struct OnlayOn {
    int fdi;
    const char *side, *capped, *left;
    std::map<std::string, double, std::less<>> numbers{};
};
void PrintTo(const OnlayOn& one, std::ostream* out) {
    *out << one.fdi << ' ' << one.side;
}
class Onlay : public ::testing::TestWithParam<OnlayOn> {};

TEST_P(Onlay, CapsTheCuspsThatAreAskedForAndCanBeDrawnOff) {
    const OnlayOn& one = GetParam();
    const cases::Tooth& tooth = toothOf(one.fdi);
    Recipe recipe = recipeOf("onlay", one.side);
    recipe.numbers = one.numbers;
    const Laid laid = layOn(tooth, recipe);
    // Everywhere about a capped tip as deep as asked, the shortest way, and no deeper; another stays.
    const bool isBuccal = std::string_view(one.capped).ends_with("buccal");
    const double cap = recipe.number(isBuccal ? "cap_mesiobuccal_mm" : "cap_mesiolingual_mm");
    int seen = 0;
    for (const cases::Landmark& mark : tooth.landmarks) {
        if (mark.kind == cases::LandmarkKind::cuspTip && mark.name == one.capped) {
            ++seen;
            for (const double way : {0.0, 0.4, -0.4}) {
                const Vec3 over = mark.pointsMm.front() + Vec3(way, 0.0, 20.0);
                const Vec3 top = over - laid.whole->firstMeeting(over, -Vec3::UnitZ()).distanceMm * Vec3::UnitZ();
                Vec3 p = top;
                while (-laid.whole->signedDistance(p) < cap - 0.05)
                    p.z() -= 0.01;
                EXPECT_EQ(laid.zones->at(p), zones::Zone::target);
                while (-laid.whole->signedDistance(p) < cap + 0.05)
                    p.z() -= 0.01;
                EXPECT_NE(laid.zones->at(p), zones::Zone::target);
            }
        }
        if (mark.kind == cases::LandmarkKind::cuspTip && mark.name == one.left) {
            ++seen;
            EXPECT_NE(laid.zones->at(mark.pointsMm.front() - Vec3(0.0, 0.0, 0.2)), zones::Zone::target);
        }
        if (mark.kind == cases::LandmarkKind::contact) {
            const Vec3 in = mark.pointsMm.front() + Vec3(mark.name == "mesial" ? -0.3 : 0.3, 0, 0);
            // Under what goes with a cusp: a box reaches farther down than that.
            const Vec3 under = in - Vec3(0.0, 0.0, recipe.number("under_contact_mm") - 0.2);
            const bool isAsked = recipe.number(mark.name == one.side ? "axial_mm" : "other_axial_mm") > 0.0;
            EXPECT_EQ(laid.zones->at(under) == zones::Zone::target, isAsked) << mark.name;
        }
    }
    EXPECT_EQ(seen, *one.left == '\0' ? 1 : 2);
    // It can be drawn off: nothing that is left hangs over what is gone.
    const Sampled s = sampled(laid, 0.3);
    EXPECT_GT(s.targetMm3, one.fdi % 10 < 6 ? 15.0 : 40.0);
    int over = 0, columns = 0;
    const core::Box& box = laid.whole->bounds();
    for (double x = box.min.x(); x < box.max.x(); x += 0.3)
        for (double y = box.min.y(); y < box.max.y(); y += 0.3) {
            bool wasGone = false;
            ++columns;
            for (double z = s.box.min.z() - 0.2; z < box.max.z(); z += 0.1) {
                const Vec3 p(x, y, z);
                const double outMm = laid.whole->signedDistance(p);
                if (outMm >= 0.0) continue;
                const bool isGone = laid.zones->targetMm(p) < 0.0;
                if (!isGone && wasGone) {
                    ++over;
                    fmt::print("overhangs at {:.2f} {:.2f} {:.2f}, {:.3f} under the surface, {:.3f} off the target\n",
                               x, y, z, -outMm, laid.zones->targetMm(p));
                }
                wasGone = wasGone || isGone;
            }
        }
    EXPECT_LE(over, columns / 500);
    fmt::print("onlay of {}: {:.1f} mm3, {} of {} columns overhang\n", one.fdi, s.targetMm3, over, columns);
}

INSTANTIATE_TEST_SUITE_P(
    Teeth, Onlay,
    ::testing::Values(
        OnlayOn{46, "mesial", "mesiobuccal", "mesiolingual"}, OnlayOn{36, "distal", "distobuccal", "distolingual"},
        OnlayOn{45, "mesial", "buccal", "mesiolingual", {{"ridge_mm", 1.2}, {"width_mm", 1.2}, {"box_width_mm", 3.0}}},
        // Functional cusps of upper teeth: palatal; both boxes; all cusps; no box.
        OnlayOn{26,
                "mesial",
                "mesiopalatal",
                "mesiobuccal",
                {{"cap_mesiobuccal_mm", 0.0},
                 {"cap_distobuccal_mm", 0.0},
                 {"cap_mesiolingual_mm", 2.0},
                 {"cap_distolingual_mm", 2.0}}},
        OnlayOn{15,
                "distal",
                "palatal",
                "buccal",
                {{"ridge_mm", 1.2},
                 {"width_mm", 1.2},
                 {"box_width_mm", 3.0},
                 {"other_axial_mm", 1.2},
                 {"axial_mm", 1.2},
                 {"cap_mesiobuccal_mm", 0.0},
                 {"cap_distobuccal_mm", 0.0},
                 {"cap_mesiolingual_mm", 1.5},
                 {"cap_distolingual_mm", 1.5}}},
        OnlayOn{46,
                "mesial",
                "distobuccal",
                "",
                {{"axial_mm", 0.0},
                 {"cap_mesiobuccal_mm", 2.0},
                 {"cap_distobuccal_mm", 2.0},
                 {"cap_mesiolingual_mm", 1.5},
                 {"cap_distolingual_mm", 1.5}}}));

TEST(Preparation, LesionIsTheCariousTissueShortOfThePulp) {
    cases::Case toothCase = starter::makeBlock(starter::BlockLayers::carious);
    const Laid laid = layOn(toothCase, recipeOf("lesion"));
    const double half = 2.0 / 3.0 * std::numbers::pi * 3.0 * 2.5 * 3.0;
    EXPECT_NEAR(sampled(laid, 0.1).targetMm3, half, 0.02 * half);
    EXPECT_NE(test::errorOf([] { (void)layOn(toothOf(46), recipeOf("lesion")); }), "");
}

TEST(Preparation, BlocksAreTheirClosedForms) {
    const cases::Case block = starter::makeBlock(starter::BlockLayers::hard);
    const double pi = std::numbers::pi;
    const std::map<std::string, double> areas = {{"block-line", 6.8 * 1.2 + pi * 0.36},
                                                 {"block-channel", 6.8 * 1.2 + pi * 0.36},
                                                 {"block-cross", 2.0 * (6.8 * 1.2 + pi * 0.36) - 1.44},
                                                 {"block-circle", pi * 6.25},
                                                 {"block-hollow-circle", pi * (9.0 - 2.25)},
                                                 {"block-d-circle", 0.5 * pi * 6.25}};
    for (const auto& [id, area] : areas) {
        const Laid laid = layOn(block, recipeOf(id));
        EXPECT_NEAR(sampled(laid, 0.1).targetMm3, 1.5 * area, 0.02 * 1.5 * area) << id;
    }
    EXPECT_NEAR(sampled(layOn(block, recipeOf("block-steps")), 0.05).targetMm3, 3.0 * 3.0 * (1 + 2 + 3), 0.9);
    EXPECT_NEAR(geometry::enclosedVolumeMm3(block.outer), 16.0 * 12.0 * 8.0, 1e-6);
    for (const auto layers : {starter::BlockLayers::hard, starter::BlockLayers::layered, starter::BlockLayers::carious})
        for (const cases::Part& part : starter::makeBlock(layers).parts)
            EXPECT_NO_THROW(cases::requireSolid(part.mesh, part.name));
}

TEST(Preparation, RecipesComeBackFromText) {
    for (const Template& t : templates()) {
        Recipe recipe = recipeOf(std::string(t.id), t.hasSide ? "distal" : "");
        for (const Parameter& p : t.parameters) {
            EXPECT_LE(p.least, p.usual) << p.name;
            EXPECT_GE(p.most, p.usual) << p.name;
            recipe.numbers.emplace(p.name, p.usual + 0.25 * (p.most - p.usual));
        }
        recipe.leeway = {0.15, 0.35};
        recipe.pulpMm = 0.5;
        if (t.id == kPaintedTemplate) recipe.strokes = {{{Vec3(0.0, 0.5, 6.0)}, 0.7, false}};
        if (t.isOwn) recipe.draw = Vec3::UnitY(), recipe.like = "class-five";
        const config::Table root = config::Table::parse(recipeToml(recipe), "recipe");
        EXPECT_EQ(readRecipe(*root.table("preparation")), recipe) << t.id;
    }
}

TEST(Preparation, APathOfDrawComesBackToTheBit) {
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 2000; ++i) {
        const std::string text = fmt::format(
            "[preparation]\ntemplate = \"painted\"\ndraw = [{}, {}, {}]\n[[preparation.stroke]]\n"
            "radius_mm = 1\npoints_mm = [[0, 0, 7]]\n",
            test::uniform(generator, -1.0, 1.0), test::uniform(generator, -1.0, 1.0),
            test::uniform(generator, 0.6, 1.0));
        const auto read = [](const std::string& toml) {
            return readRecipe(*config::Table::parse(toml, "recipe").table("preparation"));
        };
        const Recipe once = read(text), twice = read(recipeToml(once));
        ASSERT_NEAR(once.draw->norm(), 1.0, 1e-12);
        ASSERT_EQ(*twice.draw, *once.draw) << text;
    }
}

TEST(Preparation, BadRecipesAreToldWithTheirLine) {
    const auto errorOf = [](const std::string& text) {
        return test::errorOf(
            [&] { (void)readRecipe(*config::Table::parse("[preparation]\n" + text, "x.toml").table("preparation")); });
    };
    EXPECT_NE(errorOf("").find("no template"), std::string::npos);
    EXPECT_NE(errorOf("template = \"class-nine\"").find("class-nine"), std::string::npos);
    EXPECT_NE(errorOf("template = \"class-two\"").find("side"), std::string::npos);
    EXPECT_NE(errorOf("template = \"class-one\"\nside = \"mesial\"").find("side"), std::string::npos);
    EXPECT_NE(errorOf("template = \"class-one\"\ndepth_mm = 40").find("0.5 to 4"), std::string::npos);
    EXPECT_NE(errorOf("template = \"class-one\"\ndepht_mm = 1").find("depht_mm"), std::string::npos);
    EXPECT_NE(errorOf("template = \"class-one\"\nleeway_side_mm = -1"), "");
    EXPECT_NE(errorOf("template = \"class-one\"\ndepth_mm = \"deep\""), "");
}

TEST(Preparation, WhatATeethLacksIsToldWithTheRemedy) {
    cases::Tooth bare = toothOf(46);
    bare.landmarks.clear();
    for (const char* id : {"class-one", "class-five", "access", "crown"}) {
        const std::string error = test::errorOf([&] { (void)layOn(bare, recipeOf(id)); });
        EXPECT_NE(error.find("landmark"), std::string::npos) << error;
    }
    Recipe wide = recipeOf("class-one");
    wide.numbers = {{"width_mm", 5.0}, {"ridge_mm", 4.0}};
    EXPECT_NE(test::errorOf([&] { (void)layOn(toothOf(46), wide); }).find("no room"), std::string::npos);
    cases::Tooth unknown = toothOf(11);
    unknown.buccalSign = 0;
    EXPECT_NE(test::errorOf([&] { (void)layOn(unknown, recipeOf("class-three", "mesial")); }).find("buccal"),
              std::string::npos);
    EXPECT_NE(test::errorOf([] { (void)layOn(cases::Tooth{}, recipeOf("class-one")); }), "");
}

TEST(ZoneSurfaces, HoldWhatTheZonesSay) {
    const cases::Tooth block = starter::makeBlock(starter::BlockLayers::hard);
    for (const auto& [id, tooth] : {std::pair<std::string, const cases::Tooth*>("block-hollow-circle", &block),
                                    {"class-one", &toothOf(46)},
                                    {"class-five", &toothOf(33)}}) {
        Recipe recipe = recipeOf(id);
        const Laid laid = layOn(*tooth, recipe);
        const geometry::TriangleMesh target = zoneSurface(SeenZone::target, *tooth, recipe, laid);
        // Edges are bevelled by a cell: less is in the mesh, by a few per cent of so small a volume.
        const double sampledMm3 = sampled(laid, 0.1).targetMm3;
        EXPECT_NEAR(geometry::enclosedVolumeMm3(target), sampledMm3, 0.06 * sampledMm3) << id;
        const double leewayMm3 = geometry::enclosedVolumeMm3(zoneSurface(SeenZone::leeway, *tooth, recipe, laid));
        EXPECT_GT(leewayMm3, geometry::enclosedVolumeMm3(target)) << id;
        const double containerMm3 = geometry::enclosedVolumeMm3(zoneSurface(SeenZone::container, *tooth, recipe, laid));
        double pulpMm3 = 0.0;
        for (const cases::Part& part : tooth->parts)
            if (part.tissue == cases::Tissue::pulp) pulpMm3 += geometry::enclosedVolumeMm3(part.mesh);
        const double wholeMm3 = geometry::enclosedVolumeMm3(tooth->surface());
        EXPECT_NEAR(containerMm3 + leewayMm3 + pulpMm3, wholeMm3, 0.03 * wholeMm3) << id;
    }
    // What is kept about the pulp is more than the pulp.
    Recipe recipe = recipeOf("class-one");
    recipe.pulpMm = 0.5;
    const cases::Tooth& tooth = toothOf(46);
    const Laid laid = layOn(tooth, recipe);
    const geometry::TriangleMesh kept = zoneSurface(SeenZone::protectedZone, tooth, recipe, laid);
    double worstMm = 0.0;
    for (const Vec3& v : kept.vertices)
        worstMm = std::max(worstMm, std::abs(std::max(laid.zones->protectedMm(v), laid.whole->signedDistance(v))));
    EXPECT_LT(worstMm, 0.15);
    EXPECT_GT(geometry::enclosedVolumeMm3(kept), 0.0);
    // Given up when it is no longer wanted.
    EXPECT_NE(test::errorOf(
                  [&] { (void)zoneSurface(SeenZone::container, tooth, recipe, laid, [](double) { return false; }); }),
              "");
}

}  // namespace
}  // namespace handpiece::preparation::preparation_test
