// SPDX-License-Identifier: Apache-2.0
// A groove in a block, whose depths and widths are known, beside what its section tells.
#include "handpiece/app/report/place_section.h"

#include <gtest/gtest.h>

#include "handpiece/app/course/shipped_exercises.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/model/tooth/tooth_model.h"
#include "handpiece/senses/measure/tooth_probe.h"

namespace handpiece::report::place_section_test {
namespace {

using core::Vec3;

struct Groove {
    Groove() : task(course::blockTask("line", 1)) {
        task.voxelMm = 0.1;
        tooth::LoadSettings settings;
        settings.field = simulation::fieldSettingsAt(task.voxelMm);
        settings.useCache = false;
        model = tooth::loadModel(task.toothCase, settings);
        laid = preparation::layOn(task.toothCase, *task.preparation);
        bearings = bearingsOf(task);
        bearings.fdi = 46;
        bearings.buccalSign = 1;
        top = {laid.zones->box().centre().x(), laid.zones->box().centre().y(), model->outer.bounds().max.z()};
        while (laid.zones->targetMm(top - Vec3(0, 0, deepMm + 0.01)) < 0.0)
            deepMm += 0.01;
    }
    tasks::Task task;
    std::shared_ptr<const tooth::ToothModel> model;
    preparation::Laid laid;
    Bearings bearings;
    Vec3 top;             ///< on the block, over the middle of what is asked
    double deepMm = 0.0;  ///< of the floor that is asked
};

/// How far up the own line's points reach at the place, and how far down.
double lowestOf(const std::vector<SectionLine>& lines, double withinMm) {
    double low = 1e9;
    for (const SectionLine& line : lines)
        if (std::abs(line.from.x()) < withinMm) low = std::min(low, line.from.y());
    return low;
}

TEST(PlaceSection, whatIsLeftIsTheWholeDepthWhereNothingWasCut) {
    const Groove g;
    ASSERT_GT(g.deepMm, 0.5);
    const tooth::ToothMirror uncut(g.model);
    const std::optional<PlaceSection> section = placeSection(g.task, uncut, g.bearings, g.top);
    ASSERT_TRUE(section);
    EXPECT_NEAR(*section->ownDeepMm, 0.0, 0.01);
    EXPECT_NEAR(*section->idealDeepMm, g.deepMm, 0.03);
    EXPECT_NEAR(lowestOf(section->ideal, 0.2), -g.deepMm, 0.05);
    EXPECT_NEAR(lowestOf(section->own, 0.2), 0.0, 0.03);
    EXPECT_EQ(section->up, Vec3::UnitZ());
    EXPECT_EQ(section->rightSide, "mesial");
}

TEST(PlaceSection, theIdealItselfIsAsItShouldBe) {
    const Groove g;
    tooth::ToothMirror own(g.model);
    own.apply(zones::idealState(*g.laid.zones, g.model));
    const Vec3 floor = g.top - g.deepMm * Vec3::UnitZ();
    const std::optional<PlaceSection> section = placeSection(g.task, own, g.bearings, floor);
    ASSERT_TRUE(section);
    EXPECT_NEAR(*section->ownDeepMm, *section->idealDeepMm, 0.05);
    EXPECT_NEAR(lowestOf(section->own, 0.2), 0.0, 0.05);
    EXPECT_NEAR(lowestOf(section->before, 3.0), g.deepMm, 0.05);
}

TEST(PlaceSection, aPlaceThatIsNotOnTheToothHasNone) {
    const Groove g;
    const tooth::ToothMirror uncut(g.model);
    EXPECT_FALSE(placeSection(g.task, uncut, g.bearings, g.top + Vec3(0, 0, 2.0)));
    EXPECT_FALSE(placeSection(g.task, uncut, g.bearings, g.top - Vec3(0, 0, 2.0)));
}

// Of a class V the way in is from the cheek: its section shows the axial wall from there, mesiodistally or along the
// tooth.
TEST(PlaceSection, upIsFromWhereOneWorks) {
    const Groove g;
    Bearings buccal = g.bearings;
    buccal.draw = Vec3::UnitY();
    const tooth::ToothMirror uncut(g.model);
    const core::Box box = g.model->outer.bounds();
    const std::optional<PlaceSection> section =
        placeSection(g.task, uncut, buccal, Vec3(box.centre().x(), box.max.y(), box.centre().z()));
    ASSERT_TRUE(section);
    EXPECT_EQ(section->up, Vec3::UnitY());
    EXPECT_NEAR(std::abs(section->right.dot(section->up)), 0.0, 1e-9);
    EXPECT_NEAR(*section->ownDeepMm, 0.0, 0.01);
}

}  // namespace
}  // namespace handpiece::report::place_section_test
