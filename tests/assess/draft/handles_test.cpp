// SPDX-License-Identifier: Apache-2.0
// Handles of a preparation's numbers: each lies on the border of what it decides, and goes where its number takes it.
#include "handpiece/assess/draft/handles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "handpiece/assess/preparation/zone_surfaces.h"
#include "handpiece/model/dentition/tooth_form.h"
#include "handpiece/model/lesion/lesion.h"
#include "handpiece/model/starter/block.h"

namespace handpiece::draft::handles_test {
namespace {

using preparation::Laid;
using preparation::Recipe;

const cases::Tooth& toothOf(int fdi) {
    static std::map<int, cases::Tooth> made;
    const auto [at, isNew] = made.try_emplace(fdi);
    if (isNew) at->second = dentition::makeTooth(fdi, {1, 25.0}, {4000, 2000});
    return at->second;
}
Recipe recipeOf(std::string_view preparation, const std::string& side = {}) {
    Recipe recipe;
    recipe.preparation = preparation;
    recipe.side = side;
    return recipe;
}

struct Site {
    const char* preparation;
    int fdi;
    const char* side;
};
class Handles : public ::testing::TestWithParam<Site> {};

const Handle* find(const std::vector<Handle>& all, std::string_view number) {
    for (const Handle& one : all)
        if (one.number == number) return &one;
    return nullptr;
}

TEST_P(Handles, LieOnTheBorderAndGoWithTheirNumber) {
    const auto [preparation, fdi, side] = GetParam();
    static const cases::Case block = starter::makeBlock(starter::BlockLayers::hard);
    const cases::Tooth& tooth = fdi == 0 ? static_cast<const cases::Tooth&>(block) : toothOf(fdi);
    const Recipe recipe = recipeOf(preparation, side);
    const Laid laid = preparation::layOn(tooth, recipe);
    const std::vector<Handle> handles = handlesOf(tooth, recipe, laid);
    const preparation::Template& of = *preparation::findTemplate(preparation);
    for (const preparation::Parameter& p : of.parameters) {
        SCOPED_TRACE(std::string(p.name));
        const Handle* handle = find(handles, p.name);
        ASSERT_TRUE(handle);
        EXPECT_NEAR(handle->way.norm(), 1.0, 1e-9);
        const bool isKept = p.name == "labial_mm" || p.name == "shell_mm";
        // Walls through two landmarks of an outline are chords between them.
        const double toleranceMm = std::string_view(preparation) == "crown" ? 0.12 : 0.03;
        EXPECT_NEAR(isKept ? laid.zones->protectedMm(handle->placeMm) : laid.zones->targetMm(handle->placeMm), 0.0,
                    toleranceMm);
        // Both ways, anew on the same tooth with the surface that is there.
        for (const double movedMm : {0.2, -0.2}) {
            const double value = valueOf(*handle, recipe, movedMm), was = recipe.number(p.name);
            EXPECT_GE(value, p.least);
            EXPECT_LE(value, p.most);
            Recipe next = recipe;
            next.numbers[std::string(p.name)] = value;
            const Laid again = preparation::layOn(tooth, next, laid.whole);
            constexpr double kRad = std::numbers::pi / 180.0;
            const double meantMm =
                handle->armMm > 0.0
                    ? handle->armMm * (std::tan(value / handle->perMm * kRad) - std::tan(was / handle->perMm * kRad))
                    : (value - was) / handle->perMm;
            // The border has come along. How far fissures are followed is looked for in steps, and asks for more than
            // the ridge.
            const double offMm = p.name == "ridge_mm" ? 0.35 : 2.0 * toleranceMm;
            const core::Vec3 there = handle->placeMm + meantMm * handle->way;
            EXPECT_NEAR(isKept ? again.zones->protectedMm(there) : again.zones->targetMm(there), 0.0, offMm)
                << was << " to " << value;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(
    All, Handles,
    ::testing::Values(Site{"class-one", 46, ""}, Site{"class-one", 16, ""}, Site{"class-two", 46, "mesial"},
                      Site{"class-two", 36, "distal"}, Site{"class-three", 11, "mesial"},
                      Site{"class-three", 21, "distal"}, Site{"class-five", 33, ""}, Site{"class-five", 44, ""},
                      Site{"crown", 16, ""}, Site{"crown", 46, ""}, Site{"access", 46, ""}, Site{"access", 36, ""},
                      Site{"block-line", 0, ""}, Site{"block-channel", 0, ""}, Site{"block-cross", 0, ""},
                      Site{"block-circle", 0, ""}, Site{"block-hollow-circle", 0, ""}, Site{"block-d-circle", 0, ""},
                      Site{"block-steps", 0, ""}),
    [](const auto& of) {
        std::string name = std::string(of.param.preparation) + "_" + std::to_string(of.param.fdi) + of.param.side;
        std::replace(name.begin(), name.end(), '-', '_');
        return name;
    });

TEST(HandlesOfAnOnlay, LieWhereACuspIsTakenDownTo) {
    for (const int fdi : {46, 45, 26}) {
        SCOPED_TRACE(fdi);
        const cases::Tooth& tooth = toothOf(fdi);
        Recipe recipe = recipeOf("onlay", "mesial");
        recipe.numbers = {{"ridge_mm", 1.2}, {"width_mm", 1.2}, {"box_width_mm", 3.0}, {"other_axial_mm", 1.2}};
        for (const char* cap :
             {"cap_mesiobuccal_mm", "cap_distobuccal_mm", "cap_mesiolingual_mm", "cap_distolingual_mm"})
            recipe.numbers[cap] = 1.5;
        const Laid laid = preparation::layOn(tooth, recipe);
        const std::vector<Handle> handles = handlesOf(tooth, recipe, laid);
        for (const preparation::Parameter& p : preparation::findTemplate("onlay")->parameters)
            EXPECT_TRUE(find(handles, p.name)) << p.name;
        for (const Handle& handle : handles) {
            const std::string name(handle.number);
            if (!name.starts_with("cap_") && name != "shoulder_mm") continue;
            SCOPED_TRACE(name);
            EXPECT_NEAR(laid.zones->targetMm(handle.placeMm), 0.0, 0.03);
            for (const double movedMm : {0.2, -0.2}) {
                Recipe next = recipe;
                next.numbers[name] = valueOf(handle, recipe, movedMm);
                const Laid again = preparation::layOn(tooth, next, laid.whole);
                const double meantMm = (next.number(name) - recipe.number(name)) / handle.perMm;
                // The isthmus runs close under a premolar's lingual cusp, and under the low distolingual one of an
                // upper molar, and the handle hardly beside it.
                EXPECT_NEAR(again.zones->targetMm(handle.placeMm + meantMm * handle.way), 0.0, fdi == 46 ? 0.06 : 0.12);
            }
        }
        // Nothing is capped, no box: numbers can be drawn out of the tooth.
        for (auto& [name, value] : recipe.numbers)
            if (name.starts_with("cap_") || name == "other_axial_mm") value = 0.0;
        recipe.numbers["axial_mm"] = 0.0;
        const Laid plain = preparation::layOn(tooth, recipe);
        const std::vector<Handle> all = handlesOf(tooth, recipe, plain);
        for (const char* name : {"cap_mesiobuccal_mm", "cap_distolingual_mm", "axial_mm", "other_axial_mm"}) {
            const Handle* handle = find(all, name);
            ASSERT_TRUE(handle) << name;
            EXPECT_NEAR(plain.whole->signedDistance(handle->placeMm), 0.0, 0.1) << name;
            EXPECT_GT(valueOf(*handle, recipe, 1.0), 0.2) << name;
        }
    }
}

/// Fissures run over onto the sides of a tooth. There no target follows them, and no handle may hang on them.
TEST(HandlesOfAnOnlay, LieWhereTheyLieHoweverFarAFissureRunsDownTheSide) {
    for (const char* preparation : {"onlay", "class-one"}) {
        SCOPED_TRACE(preparation);
        const Recipe recipe = recipeOf(preparation, std::string_view(preparation) == "onlay" ? "mesial" : "");
        cases::Tooth tooth = toothOf(46);
        const Laid laid = preparation::layOn(tooth, recipe);
        const std::vector<Handle> before = handlesOf(tooth, recipe, laid);
        // On the distal side, steep: between the crown's height of contour and its cervix.
        cases::Landmark side{cases::LandmarkKind::fissure, "side", {}};
        const core::Box& box = laid.whole->bounds();
        for (int i = 0; i < 40; ++i) {
            const double z = box.max.z() - 4.0 - 0.05 * i;
            const auto hit = laid.whole->firstMeeting({box.min.x() - 1.0, 0.0, z}, core::Vec3::UnitX());
            ASSERT_TRUE(std::isfinite(hit.distanceMm));
            side.pointsMm.emplace_back(box.min.x() - 1.0 + hit.distanceMm, 0.0, z);
        }
        tooth.landmarks.push_back(std::move(side));
        const std::vector<Handle> after = handlesOf(tooth, recipe, preparation::layOn(tooth, recipe, laid.whole));
        ASSERT_EQ(after.size(), before.size());
        for (std::size_t i = 0; i < after.size(); ++i)
            EXPECT_EQ(after[i].placeMm, before[i].placeMm) << after[i].number;
    }
}

TEST(HandlesOfALesion, StandOverThePulp) {
    cases::Tooth carious = toothOf(46);
    lesion::addLesions(carious, lesion::lesionsByName("occlusal:D3"));
    const Recipe recipe = recipeOf("lesion");
    const Laid laid = preparation::layOn(carious, recipe);
    const auto handles = handlesOf(carious, recipe, laid);
    ASSERT_EQ(handles.size(), 1u);
    EXPECT_EQ(handles.front().number, "over_pulp_mm");
    EXPECT_DOUBLE_EQ(valueOf(handles.front(), recipe, 0.52), 1.0);
    EXPECT_DOUBLE_EQ(valueOf(handles.front(), recipe, -9.0), 0.0);
}

TEST(HandleValues, LieOnStepsAndWithinTheTemplate) {
    const Recipe recipe = recipeOf("class-one");
    const Handle depth{"depth_mm", core::Vec3::Zero(), -core::Vec3::UnitZ(), 1.0, 0.0};
    EXPECT_EQ(valueOf(depth, recipe, 0.03), 1.8);
    EXPECT_EQ(valueOf(depth, recipe, 0.02), 1.75);
    EXPECT_EQ(valueOf(depth, recipe, 99.0), 4.0);
    EXPECT_EQ(valueOf(depth, recipe, -99.0), 0.5);
    const Handle wall{"wall_deg", core::Vec3::Zero(), core::Vec3::UnitX(), 1.0, 2.0};
    EXPECT_EQ(valueOf(wall, recipe, 2.0 * (std::tan(3.0 * std::numbers::pi / 180.0))), 0.0);
}

}  // namespace
}  // namespace handpiece::draft::handles_test
