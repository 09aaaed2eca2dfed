// SPDX-License-Identifier: Apache-2.0
// What is seen while one works: the glass only where something is left to cut, stripes where too much is gone, and the
// numbers that the score will take.
#include "handpiece/app/course/live_glass.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "handpiece/app/course/live_card.h"
#include "handpiece/app/course/shipped_exercises.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/model/tooth/tooth_model.h"

namespace handpiece::course::live_glass_test {
namespace {

using core::Vec3;

class LiveGlassTest : public ::testing::Test {
  protected:
    LiveGlassTest() {
        task_ = blockTask("channel", 1);
        task_.voxelMm = 0.1;
        tooth::LoadSettings settings;
        settings.field = simulation::fieldSettingsAt(task_.voxelMm);
        settings.useCache = false;
        model_ = tooth::loadModel(task_.toothCase, settings, {});
        laid_ = preparation::layOn(task_.toothCase, *task_.preparation);
    }
    /// With so much more gone on every side than the task asks for.
    [[nodiscard]] std::unique_ptr<simulation::LiveTooth> cut(double moreMm) const {
        const zones::TargetFunction grown = [this, moreMm](const Vec3& p) {
            const double distance = laid_.zones->targetMm(p) - moreMm;
            return zones::PastTarget{distance, distance};
        };
        const zones::Zones wide(grown, laid_.zones->box().grown(std::max(0.0, moreMm) + 0.1), {});
        return std::make_unique<simulation::LiveTooth>(model_, zones::idealState(wide, model_));
    }
    tasks::Task task_;
    std::shared_ptr<const tooth::ToothModel> model_;
    preparation::Laid laid_;
};

double areaMm2(const geometry::TriangleMesh& mesh) {
    double area = 0.0;
    for (const auto& t : mesh.triangles)
        area +=
            0.5 * (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]).norm();
    return area;
}

TEST_F(LiveGlassTest, IsThereWhereSomethingIsLeftAndStripedWhereTooMuchIsGone) {
    const simulation::LiveTooth whole(model_, {});
    const LiveGlass before = liveGlass(laid_, whole);
    const core::Box target = laid_.zones->box();
    ASSERT_FALSE(before.left.triangles.empty());
    EXPECT_TRUE(before.over.triangles.empty()) << "nothing is gone";
    EXPECT_NEAR(before.left.bounds().size().x(), target.size().x(), 0.6);

    const LiveGlass done = liveGlass(laid_, *cut(0.0));
    EXPECT_LT(areaMm2(done.left), 0.25 * areaMm2(before.left)) << "all is cut but a voxel's skin";
    EXPECT_TRUE(done.over.triangles.empty()) << "nothing is gone beyond the leeway";

    // Half a millimetre more on every side than may go.
    const LiveGlass over = liveGlass(laid_, *cut(laid_.zones->leeway().sideMm + 0.5));
    EXPECT_LT(areaMm2(over.left), 0.05 * areaMm2(before.left));
    ASSERT_FALSE(over.over.triangles.empty());
    for (const Vec3& p : over.over.vertices)
        EXPECT_GT(laid_.zones->allowedMm(p), -0.15) << p.transpose() << ": what may go is not striped";
}

TEST(Hatched, CoversHalfOfASurfaceInStripes) {
    geometry::TriangleMesh square;
    square.vertices = {Vec3(0, 0, 0), Vec3(10, 0, 0), Vec3(10, 10, 0), Vec3(0, 10, 0)};
    square.triangles = {{0, 1, 2}, {0, 2, 3}};
    const geometry::TriangleMesh stripes = hatched(square, 0.25);
    EXPECT_NEAR(areaMm2(stripes), 50.0, 1.0);
    const Vec3 slant = Vec3(1.0, 1.0, 0.7).normalized();
    for (const auto& t : stripes.triangles) {
        const Vec3 middle = (stripes.vertices[t[0]] + stripes.vertices[t[1]] + stripes.vertices[t[2]]) / 3.0;
        const double at = slant.dot(middle) / 0.5;
        EXPECT_LT(at - std::floor(at), 0.5 + 1e-9);
    }
}

TEST_F(LiveGlassTest, TheCardTellsTheNumbersOfTheScoreAndTheirSide) {
    const rubric::Rubric rubric = rubric::shippedRubric("block-channel");
    const simulation::LiveTooth whole(model_, {});
    const auto valueOf = [](const std::vector<LiveValue>& all, const std::string& id) {
        for (const LiveValue& one : all)
            if (one.criterion == id) return one;
        ADD_FAILURE() << "no " << id;
        return LiveValue{};
    };
    EXPECT_FALSE(valueOf(liveValues(task_, rubric, laid_, whole), "depth").value) << "nothing is cut yet";
    const std::vector<LiveValue> right = liveValues(task_, rubric, laid_, *cut(0.0));
    ASSERT_TRUE(valueOf(right, "depth").value);
    EXPECT_EQ(valueOf(right, "depth").off, report::Off::no) << *valueOf(right, "depth").value;
    EXPECT_EQ(valueOf(right, "width").off, report::Off::no);
    const std::vector<LiveValue> wide = liveValues(task_, rubric, laid_, *cut(0.5));
    EXPECT_EQ(valueOf(wide, "depth").off, report::Off::tooHigh);
    EXPECT_EQ(valueOf(wide, "width").off, report::Off::tooHigh);
    EXPECT_NEAR(*valueOf(wide, "depth").value, *valueOf(right, "depth").value + 0.5, 0.1);
    const std::vector<LiveValue> narrow = liveValues(task_, rubric, laid_, *cut(-0.35));
    EXPECT_EQ(valueOf(narrow, "width").off, report::Off::tooLow);
}

}  // namespace
}  // namespace handpiece::course::live_glass_test
