// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/exercise/permissions.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace handpiece::exercise::permissions_test {
namespace {

std::set<Operation> locked(const std::vector<std::string>& helps, WorkMode mode = WorkMode::work) {
    cases::Exercise exercise;
    exercise.lockedHelps = helps;
    const Permissions permissions = permissionsOf(&exercise, mode);
    std::set<Operation> found;
    for (std::size_t i = 0; i < kOperationCount; ++i) {
        const auto operation = static_cast<Operation>(i);
        if (!permissions.locks(operation)) continue;
        found.insert(operation);
        EXPECT_FALSE(permissions.allows(operation)) << i;
    }
    return found;
}

TEST(Permissions, EachLockTakesWhatItSaysAndNothingElse) {
    using enum Operation;
    const std::map<std::string, std::set<Operation>> expected{
        {"undo", {undo, redo, reset}},
        {"reset", {reset}},
        {"depth", {depthStop, depthReadout, depthTool, pulpTool, calliper, removedDepth}},
        {"tissue-colours", {tissueColours}},
        {"cross-section", {section}},
        {"transparency", {transparency, compare}},
        {"guide", {guidance, depthStop}},
        {"score", {volumes, report}},
        {"mirror", {mirror, mirrorView}},
        {"scale-bar", {scaleBar}},
        {"chart", {chart}},
        {"calliper", {calliper}},
        {"compare", {compare}},
        {"direct-view", {directView, mirrorView}}};
    ASSERT_EQ(expected.size(), cases::kHelps.size());
    for (const std::string_view help : cases::kHelps)
        EXPECT_EQ(locked({std::string(help)}), expected.at(std::string(help))) << help;
    const std::vector<std::string> all(cases::kHelps.begin(), cases::kHelps.end());
    EXPECT_EQ(locked(all).size(), kOperationCount - 1) << "an operation that no lock takes, but for elsewhere";
    EXPECT_TRUE(locked({}).empty());
}

TEST(Permissions, HoldInAReplayOfTheWorkAndNotForWhoLooksAtWhatWasHandedIn) {
    const std::vector<std::string> all(cases::kHelps.begin(), cases::kHelps.end());
    EXPECT_EQ(locked(all, WorkMode::replay).size(), kOperationCount - 1);
    EXPECT_TRUE(locked(all, WorkMode::review).empty());
    const Permissions review = permissionsOf(nullptr, WorkMode::review);
    for (const Operation operation : {Operation::section, Operation::depthTool, Operation::compare, Operation::report,
                                      Operation::volumes, Operation::depthReadout})
        EXPECT_TRUE(review.allows(operation));
    for (const WorkMode mode : {WorkMode::review, WorkMode::replay, WorkMode::nothing})
        for (const Operation operation : {Operation::undo, Operation::redo, Operation::reset, Operation::depthStop}) {
            EXPECT_FALSE(permissionsOf(nullptr, mode).allows(operation)) << "the tooth is not worked at";
            EXPECT_FALSE(permissionsOf(nullptr, mode).locks(operation)) << "no exercise forbids it";
        }
    EXPECT_TRUE(permissionsOf(nullptr, WorkMode::nothing).allows(Operation::chart)) << "else no tooth could be chosen";
    EXPECT_FALSE(permissionsOf(nullptr, WorkMode::nothing).allows(Operation::section));
}

TEST(Permissions, AnExamShutsOtherWorkWhateverOneIsAt) {
    cases::Exercise exercise;
    exercise.lockedHelps = {"undo"};
    for (const WorkMode mode : {WorkMode::nothing, WorkMode::work, WorkMode::replay, WorkMode::review}) {
        EXPECT_TRUE(permissionsOf(&exercise, mode).allows(Operation::elsewhere));
        const Permissions exam = permissionsOf(&exercise, mode, true);
        EXPECT_TRUE(exam.isExam());
        for (const Operation operation : kShutInExam)
            EXPECT_TRUE(exam.locks(operation) && !exam.allows(operation));
    }
    const Permissions exam = permissionsOf(&exercise, WorkMode::work, true);
    EXPECT_TRUE(exam.locks(Operation::undo));
    EXPECT_TRUE(exam.allows(Operation::section)) << "what is not locked is there";
}

TEST(Permissions, TheBurToBeginWithIsAnAllowedOne) {
    EXPECT_EQ(firstBur(nullptr, "mine.stl"), "mine.stl");
    cases::Exercise exercise;
    EXPECT_EQ(firstBur(&exercise, "245"), "245");
    exercise.allowedBurs = {"330", "round-2"};
    EXPECT_EQ(firstBur(&exercise, "245"), "330");
    EXPECT_EQ(firstBur(&exercise, "round-2"), "round-2");
    exercise.bur = "round-2";
    EXPECT_EQ(firstBur(&exercise, "245"), "round-2");
    EXPECT_TRUE(permissionsOf(&exercise, WorkMode::work).allowsBur("330"));
    EXPECT_FALSE(permissionsOf(&exercise, WorkMode::work).allowsBur("245"));
    EXPECT_TRUE(permissionsOf(&exercise, WorkMode::review).allowsBur("245"));
}

}  // namespace
}  // namespace handpiece::exercise::permissions_test
