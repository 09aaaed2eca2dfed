// SPDX-License-Identifier: Apache-2.0
// The exercises that come along are whole ones, and what is shown of an ideal is what its zones ask for.
#include <gtest/gtest.h>

#include "handpiece/app/course/finished_work.h"
#include "handpiece/app/course/retest.h"
#include "handpiece/app/course/shipped_exercises.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/instrument/catalogue.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::course::course_test {
namespace {

namespace fs = std::filesystem;

double volumeMm3(const geometry::TriangleMesh& mesh) {
    double six = 0.0;
    for (const auto& t : mesh.triangles)
        six += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]]));
    return six / 6.0;
}

TEST(Course, TheTenAreThereInTheirOrder) {
    const std::vector<Shipped>& all = shippedExercises();
    ASSERT_GE(all.size(), 10u);
    int level = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Shipped& s = all[i];
        EXPECT_EQ(s.number, i < 10 ? static_cast<int>(i) + 1 : 0) << s.id;
        const auto* at = std::find(tasks::kLevels.begin(), tasks::kLevels.end(), s.level);
        ASSERT_NE(at, tasks::kLevels.end()) << s.id;
        if (i < 10) {
            EXPECT_GE(at - tasks::kLevels.begin(), level) << s.id;
        }
        level = i < 10 ? static_cast<int>(at - tasks::kLevels.begin()) : level;
        EXPECT_GE(s.minutes, 10.0);
        EXPECT_NE(preparation::findTemplate(s.preparation), nullptr) << s.id;
        for (const std::string& bur : s.exercise.allowedBurs)
            EXPECT_NE(instrument::findBur(bur), nullptr) << s.id << ": " << bur;
        EXPECT_EQ(s.exercise.bur, s.exercise.allowedBurs.front());
        EXPECT_EQ(s.exercise.lockedHelps,
                  s.number == 2 ? std::vector<std::string>{"direct-view"} : std::vector<std::string>{});
        for (const char* language : {"en", "ja"}) {
            EXPECT_EQ(s.exercise.title.count(language), 1u) << s.id;
            EXPECT_EQ(s.exercise.instructions.count(language), 1u) << s.id;
        }
    }
    EXPECT_EQ(shippedExercise("46-crown").number, 9);
    EXPECT_NE(test::errorOf([] { static_cast<void>(shippedExercise("none-such")); }), "");
}

/// Without those that stand in an arch: to make it takes two minutes of a core. `handpiece exercise check ID` does.
TEST(Course, EachShippedExerciseCanBeDoneAndJudged) {
    const test::TemporaryFolder folder;
    constexpr std::size_t kFaces = 10000;
    for (const Shipped& shipped : shippedExercises()) {
        if (shipped.hasNeighbours) continue;
        const Made made = makeShipped(shipped.id, folder.path(), {}, kFaces);
        EXPECT_EQ(made.task.id, shipped.id);
        EXPECT_EQ(made.task.level, shipped.level);
        EXPECT_TRUE(tasks::problems(made.task).empty()) << shipped.id << ": " << tasks::problems(made.task).front();
        EXPECT_FALSE(rubricOf(made.task).criteria.empty());
        EXPECT_EQ(tasks::contentHash(tasks::readTask(made.path)), tasks::contentHash(made.task));
    }
    // Kept: the same task, not made again; damaged, or of other words: made anew.
    const Made line = makeShipped("dexterity-line", folder.path(), {}, kFaces);
    const fs::path file = line.path / tasks::kTaskFile;
    const auto when = fs::last_write_time(file);
    EXPECT_EQ(makeShipped("dexterity-line", folder.path(), {}, kFaces).path, line.path);
    EXPECT_EQ(fs::last_write_time(file), when);
    for (const char* text : {"format = ", "format = 1\nid = \"dexterity-line\"\nminutes = 3\n"}) {
        core::writeFile(file, std::string(text));
        const Made again = makeShipped("dexterity-line", folder.path(), {}, kFaces);
        EXPECT_EQ(tasks::contentHash(again.task), tasks::contentHash(line.task));
        EXPECT_EQ(again.task.minutes, line.task.minutes);
    }
}

TEST(Course, WhatIsCancelledLeavesNoExercise) {
    const test::TemporaryFolder folder;
    int asked = 0;
    for (int last = 1; last < 60; last = 3 * last + 1) {
        asked = 0;
        const auto stop = [&](double) { return ++asked < last; };
        try {
            (void)makeShipped("46-deep-lesion", folder.path(), stop, 2000);
            break;  // it was done before
        } catch (const core::Error& error) {
            EXPECT_STREQ(error.what(), "cancelled");
        }
        for (const auto& entry : fs::recursive_directory_iterator(folder.path()))
            EXPECT_NE(entry.path().filename(), tasks::kTaskFile);
    }
    EXPECT_TRUE(tasks::problems(makeShipped("46-deep-lesion", folder.path(), {}, 2000).task).empty());
}

TEST(Course, TheIdealThatIsShownHasLostTheTarget) {
    tasks::Task task = blockTask("cross", 2, "layered");
    task.voxelMm = 0.1;
    const Parts ideal = idealOf(task);
    ASSERT_EQ(ideal->size(), 2u) << "enamel and dentine";
    double left = 0.0;
    for (const cases::Part& part : *ideal)
        left += volumeMm3(part.mesh);
    tooth::LoadSettings settings;
    settings.field = simulation::fieldSettingsAt(task.voxelMm);
    settings.useCache = false;
    const auto model = tooth::loadModel(task.toothCase, settings);
    const tooth::ToothMirror whole(model);
    const preparation::Laid laid = preparation::layOn(task.toothCase, *task.preparation);
    const double targetMm3 = zones::zoneVolumes(*laid.zones, whole).targetMm3();
    ASSERT_GT(targetMm3, 5.0);
    EXPECT_NEAR(left, 16.0 * 12.0 * 8.0 - targetMm3, 0.01 * targetMm3 + 1e-3 * 16.0 * 12.0 * 8.0);
    task.preparation.reset();
    EXPECT_EQ(idealOf(task), nullptr);
}

TEST(Course, OneBadFileInAFolderHidesNoOther) {
    const test::TemporaryFolder folder;
    tasks::writeTask(blockTask("line", 1), folder.path() / "a");
    tasks::writeTask(blockTask("steps", 3), folder.path() / "c.handpiece");
    fs::create_directories(folder.path() / "b");
    core::writeFile(folder.path() / "b" / tasks::kTaskFile, std::string("format = 1\nid = \"NO\"\n"));
    fs::create_directories(folder.path() / "no exercise");
    const std::vector<Found> found = exercisesIn(folder.path());
    ASSERT_EQ(found.size(), 3u);
    EXPECT_EQ(found[0].task->id, "block-line-1");
    EXPECT_TRUE(found[1].error);
    EXPECT_EQ(found[2].task->id, "block-steps-3");
    EXPECT_LT(found[2].task->preparation->leeway.sideMm, found[0].task->preparation->leeway.sideMm);
    EXPECT_NE(test::errorOf([&] { static_cast<void>(exercisesIn(folder.path() / "gone")); }), "");
    EXPECT_NE(test::errorOf([] { static_cast<void>(blockTask("line", 4)); }), "");
}

score::Assessment resultOf(const std::vector<std::pair<std::string, double>>& pointsOfTen) {
    score::Assessment result;
    for (const auto& [id, points] : pointsOfTen) {
        score::CriterionScore c;
        c.id = id;
        c.measure = "removed";
        c.maxPoints = 10.0;
        if (points >= 0.0)
            c.points = c.ownPoints = points;
        else
            c.standing = score::Standing::notMeasured;
        result.criteria.push_back(c);
    }
    return result;
}

TEST(Retest, OfWhatWasLostIsDueInAWeekAndThenLaterAndLater) {
    constexpr std::int64_t kDay = 24LL * 3600 * 1000;
    // The three dearest of what was lost; a tenth of a point is no loss.
    const auto at = [](const char* id, std::int64_t when) {
        school::Attempt attempt;
        attempt.id = id;
        attempt.exercise = "one-exercise";
        attempt.finished = when;
        return attempt;
    };
    std::vector<school::Retest> open =
        nextRetests({}, at("one", 0), resultOf({{"a", 9.95}, {"b", 5}, {"c", 2}, {"d", 0}, {"e", 9}}), false);
    ASSERT_EQ(open.size(), 3u);
    EXPECT_EQ(open[0].criterion, "d");
    EXPECT_EQ(open[2].criterion, "b");
    EXPECT_EQ(open[0].due, 7 * kDay);
    EXPECT_EQ(open[0].exercise, "one-exercise");
    // The next day all is well: it stays due, for that is no retest. Nor is one with helps, later.
    const score::Assessment good = resultOf({{"a", 10}, {"b", 10}, {"c", 10}, {"d", 10}, {"e", 10}});
    open = nextRetests(open, at("two", kDay), good, true);
    EXPECT_EQ(open[0].due, 7 * kDay);
    open = nextRetests(open, at("three", 8 * kDay), good, false);
    EXPECT_EQ(open[0].due, 7 * kDay);
    EXPECT_EQ(open[0].attempt, "one");
    // Shown when due, but for what could not be measured and what was lost again.
    open = nextRetests(open, at("four", 8 * kDay), resultOf({{"b", 10}, {"c", -1}, {"d", 3}}), true);
    ASSERT_EQ(open.size(), 3u);
    EXPECT_EQ(open[0].due, 15 * kDay) << "lost again";
    EXPECT_EQ(open[0].step, 0);
    EXPECT_EQ(open[1].due, 7 * kDay) << "not measured";
    EXPECT_EQ(open[2].due, 29 * kDay);
    EXPECT_EQ(open[2].step, 1);
    EXPECT_EQ(open[2].attempt, "four");
    open = nextRetests(open, at("five", 29 * kDay), good, true);
    EXPECT_EQ(open[2].due, 89 * kDay);
    open = nextRetests(open, at("six", 89 * kDay), good, true);
    ASSERT_EQ(open.size(), 2u) << "the third time it is done with";
    EXPECT_TRUE(nextRetests({}, at("x", 0), good, false).empty());
}

TEST(Course, WhatCannotBeJudgedSaysSo) {
    tasks::Task task = blockTask("line", 1);
    EXPECT_NE(test::errorOf([&] { static_cast<void>(rubricOf(task)); }).find("no rubric"), std::string::npos);
    task.rubric = "format = 1\n";
    EXPECT_NE(test::errorOf([&] { static_cast<void>(rubricOf(task)); }), "");
}

}  // namespace
}  // namespace handpiece::course::course_test
