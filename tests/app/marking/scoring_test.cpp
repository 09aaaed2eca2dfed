// SPDX-License-Identifier: Apache-2.0
// A folder of returned work: what counts as work, the machine's scores on both cores, kept and cancelled; what cannot
// be scored is there with its reason.
#include "handpiece/app/marking/scoring.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <map>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/marking/desk.h"
#include "handpiece/assess/zones/zones.h"
#include "handpiece/base/config/table.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/starter/block.h"
#include "handpiece/model/tooth/state_file.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::marking::scoring_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

tasks::Task blockTask(double depthMm) {
    tasks::Task task;
    task.id = "channel";
    task.toothCase = starter::makeBlock(starter::BlockLayers::hard);
    task.voxelMm = 0.15;
    task.preparation = preparation::readRecipe(
        *config::Table::parse(
             fmt::format("[preparation]\ntemplate = \"block-channel\"\ndepth_mm = {}\nleeway_side_mm = 0.3\n"
                         "leeway_floor_mm = 0.3\n",
                         depthMm),
             "test")
             .table("preparation"));
    return task;
}

class MarkingFolder : public ::testing::Test {
  protected:
    /// The channel as deep as that, cut into the exercise's block.
    void writeAttempt(const char* name, double depthMm, const char* handedInFor = nullptr) {
        tooth::LoadSettings settings;
        settings.field.voxelMm = task_.voxelMm;
        if (!model_) model_ = tooth::loadModel(task_.toothCase, settings);
        const preparation::Laid laid = preparation::layOn(task_.toothCase, *blockTask(depthMm).preparation);
        const tooth::StateDelta state = zones::idealState(*laid.zones, model_);
        cases::Attempt attempt;
        attempt.caseFile = works() / "case";
        attempt.caseKey = cases::caseKey(task_.toothCase);
        attempt.caseName = task_.toothCase.name;
        attempt.state = tooth::encodeState(state, tooth::identityOf({model_}));
        attempt.voxelMm = task_.voxelMm;
        attempt.removedMm3 = state.removedMm3.own;
        attempt.bur = "330";
        attempt.cuttingParameters = "carbide";
        attempt.drive = "turbine";
        if (handedInFor != nullptr) {
            attempt.handedIn = true;
            attempt.handIn.emplace();
            attempt.handIn->exercise = handedInFor;
            attempt.handIn->exerciseHash = rubric::hashText(tasks::contentHash(task_));
        }
        cases::writeAttempt(attempt, works() / name, &task_.toothCase);
    }
    [[nodiscard]] fs::path works() const { return folder_.path() / "works"; }
    void SetUp() override { fs::create_directory(works()); }

    test::TemporaryFolder folder_;
    tasks::Task task_ = blockTask(1.5);
    rubric::Rubric rubric_ = rubric::shippedRubric("block-channel");
    std::shared_ptr<const tooth::ToothModel> model_;
};

TEST_F(MarkingFolder, WhatWasHandedInForAnotherExerciseOfThisToothIsRefused) {
    writeAttempt("own.handpiece", 1.5, "channel");
    writeAttempt("other.handpiece", 1.5, "ring");
    const std::vector<ReturnedWork> found = findWork(works());
    ASSERT_EQ(found.size(), 2u);
    const Scored other = scoreReturned(found[0], task_, rubric_, {}), own = scoreReturned(found[1], task_, rubric_, {});
    ASSERT_TRUE(other.error());
    EXPECT_EQ(other.error()->id(), "other-exercise");
    EXPECT_THAT(other.problem(), HasSubstr("ring"));
    EXPECT_EQ(own.problem(), "");
}

TEST_F(MarkingFolder, ScoresWhatCanBeScoredAndSaysWhyTheRestCannot) {
    writeAttempt("good.handpiece", 1.5);
    writeAttempt("deep.handpiece", 2.3);
    fs::create_directories(works() / "sub");
    fs::copy_file(works() / "deep.handpiece", works() / "sub" / "copied.handpiece");
    core::writeFile(works() / "broken.handpiece", std::string_view("no zip"));
    core::writeFile(works() / "broken.h5", std::string_view("no session"));
    core::writeFile(works() / "notes.txt", std::string_view("nothing"));
    core::writeFile(works() / "marking-Tanaka.json", std::string_view("{}"));
    tasks::writeTask(task_, works() / "exercise.handpiece");
    const std::vector<ReturnedWork> found = findWork(works());
    std::vector<std::string> names;
    for (const ReturnedWork& work : found)
        names.push_back(work.name);
    EXPECT_THAT(names, ElementsAre("broken.h5", "broken.handpiece", "deep.handpiece", "good.handpiece",
                                   "sub/copied.handpiece"));
    EXPECT_THAT(found[4].error.value().problem(), HasSubstr("byte for byte"));
    EXPECT_EQ(found[4].twin, "deep.handpiece");

    ScoreSettings settings;
    settings.kept = folder_.path() / "kept";
    std::map<std::size_t, Scored> scored;
    double last = 0.0;
    scoreAll(
        found, task_, rubric_, settings,
        [&last](double share) {
            EXPECT_GE(share, last - 1e-12);
            last = share;
            return true;
        },
        [&scored](std::size_t which, Scored one) { EXPECT_TRUE(scored.emplace(which, std::move(one)).second); });
    EXPECT_DOUBLE_EQ(last, 1.0);
    ASSERT_EQ(scored.size(), found.size());
    EXPECT_NE(scored.at(0).problem(), "");
    EXPECT_NE(scored.at(1).problem(), "");
    EXPECT_NE(scored.at(4).problem(), "");
    EXPECT_EQ(scored.at(2).problem(), "");
    EXPECT_EQ(scored.at(3).problem(), "");
    DeskSetup setup{works(), "Sato", task_.id, rubric::hashText(tasks::contentHash(task_)), rubric_, false, 1};
    Desk desk(setup, found);
    for (auto& [which, one] : scored)
        desk.take(which, one);
    EXPECT_EQ(desk.machine(desk.codes()[0]), nullptr);
    EXPECT_NE(desk.problem(desk.codes()[0]), "");
    const assessment::Result &deep = *desk.machine(desk.codes()[2]), &good = *desk.machine(desk.codes()[3]);
    EXPECT_GT(good.assessment.percent(), 95.0);
    EXPECT_LT(deep.assessment.percent(), 80.0);
    // The same as the command line's way, bit for bit, and what was kept is that.
    const assessment::Result alone = assessment::scoreWork(assessment::readWork(found[2].path, task_), task_, rubric_);
    const std::string json = assessment::resultJson(alone.assessment, alone.identity);
    EXPECT_EQ(assessment::resultJson(deep.assessment, deep.identity), json);
    fs::remove(works() / "deep.handpiece");  // it is not looked at again
    const Scored again = scoreReturned(found[2], task_, rubric_, settings);
    EXPECT_EQ(again.problem(), "");
    EXPECT_EQ(again.picture().rgba, desk.picture(desk.codes()[2]).rgba);
    settings.kept.clear();
    EXPECT_NE(scoreReturned(found[2], task_, rubric_, settings).problem(), "");

    // Where only the result came, it counts for this exercise and rubric, and proves nothing.
    fs::create_directories(works() / "lone");
    core::writeFile(works() / "lone" / "result.json", json);
    const std::vector<ReturnedWork> with = findWork(works());
    const auto lone = std::find_if(with.begin(), with.end(), [](const auto& w) { return w.isResultOnly; });
    ASSERT_NE(lone, with.end());
    EXPECT_EQ(scoreReturned(*lone, task_, rubric_, settings).problem(), "");
    std::string forged = json;
    const std::size_t at = forged.find("\"id\": \"width\"");
    ASSERT_NE(at, std::string::npos);
    forged.replace(at, 13, "\"id\": \"depth\"");
    core::writeFile(works() / "lone" / "result.json", forged);
    EXPECT_THAT(scoreReturned(*lone, task_, rubric_, settings).problem(), HasSubstr("other criteria"));
    core::writeFile(works() / "lone" / "result.json", json);
    EXPECT_THAT(scoreReturned(*lone, blockTask(1.8), rubric_, settings).problem(), HasSubstr("another exercise"));
    EXPECT_THAT(scoreReturned(*lone, task_, rubric::shippedRubric("46-class-i"), settings).problem(),
                HasSubstr("another rubric"));
}

TEST_F(MarkingFolder, WhatAnotherProcessJudgedIsHeldToTheExercise) {
    writeAttempt("good.handpiece", 1.5);
    const std::vector<ReturnedWork> found = findWork(works());
    ASSERT_EQ(found.size(), 1u);
    tasks::Task judgedBy = blockTask(1.8);
    rubric::Rubric judgedWith = rubric_;
    int asked = 0;
    ScoreSettings settings;
    settings.kept = folder_.path() / "kept";
    settings.judge = [&](const ReturnedWork& work, const core::Progress& progress) {
        ++asked;
        return judgeReturned(work.path, judgedBy, judgedWith, true, false, {}, progress);
    };
    EXPECT_THAT(scoreReturned(found[0], task_, rubric_, settings).problem(), HasSubstr("another exercise"));
    judgedBy = task_;
    judgedWith.passMark = 99.0;
    EXPECT_THAT(scoreReturned(found[0], task_, rubric_, settings).problem(), HasSubstr("another rubric"));
    judgedWith = rubric_;
    EXPECT_EQ(scoreReturned(found[0], task_, rubric_, settings).problem(), "");
    EXPECT_EQ(asked, 3);
    EXPECT_EQ(scoreReturned(found[0], task_, rubric_, settings).problem(), "") << "kept";
    EXPECT_EQ(asked, 3);
}

TEST_F(MarkingFolder, IsCancelled) {
    writeAttempt("one.handpiece", 1.5);
    writeAttempt("two.handpiece", 1.7);
    const std::vector<ReturnedWork> found = findWork(works());
    ASSERT_EQ(found.size(), 2u);
    std::atomic<int> done{0};
    EXPECT_EQ(test::errorOf([&] {
                  scoreAll(
                      found, task_, rubric_, {}, [](double) { return false; },
                      [&done](std::size_t, Scored) { ++done; });
              }),
              "cancelled");
    EXPECT_EQ(done, 0);
    EXPECT_THAT(test::errorOf([&] { static_cast<void>(findWork(works() / "none")); }), HasSubstr("no such folder"));
}

}  // namespace
}  // namespace handpiece::marking::scoring_test
