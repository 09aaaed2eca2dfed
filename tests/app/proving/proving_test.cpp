// SPDX-License-Identifier: Apache-2.0
// What a server makes of honest work, and of every way to make a station tell more than was done.
#include "handpiece/app/proving/proving.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <random>

#include "app/simulation/live_session_fixture.h"
#include "handpiece/app/assessment/score_work.h"
#include "handpiece/app/proving/likeness.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/record/session/session_writer.h"
#include "support/error_of.h"

namespace handpiece::proving::proving_test {
namespace {

namespace fs = std::filesystem;
using simulation::SimulationSettings;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

SimulationSettings honest() {
    SimulationSettings settings = simulation::blockSettings();
    const instrument::Instrument known = instrument::makeInstrument("round:1.0x0.9");
    settings.bur = known.bur, settings.cuttingParameters = known.cuttingParameters;
    return settings;
}

tasks::Task blockTask() {
    tasks::Task task;
    task.id = "block";
    task.toothCase = simulation::blockCase();
    task.toothCase.exercise.emplace();
    task.toothCase.exercise->allowedBurs = {"round:1.0x0.9"};
    task.voxelMm = simulation::blockSettings().field.voxelMm;
    return task;
}

rubric::Rubric removedRubric() {
    return rubric::parseRubric(R"(format = 1
id = "block"
version = "1"
title = { en = "Block" }
status = "proposal"
source = "a test"
[[criterion]]
id = "removed"
measure = "removed"
unit = "mm3"
weight = 1
knots = [[0, 0], [0.5, 100], [9, 100]]
title = { en = "removed" }
source = "a test"
)",
                               "rubric.toml");
}

class Proving : public testing::Test {
  protected:
    fs::path recorded(const char* name, const SimulationSettings& settings,
                      const cases::Case& toothCase = simulation::blockCase()) {
        const fs::path file = folder_.path() / name;
        const simulation::SimulationSetup station = simulation::makeSimulation(toothCase, settings, false);
        simulation::LiveSessionSettings live;
        live.sessionFile = file;
        const auto lead = std::make_shared<simulation::Lead>();
        simulation::LiveSession sitting(station, toothCase, simulation::handOf(simulation::twoHoles(), lead), live,
                                        nullptr);
        EXPECT_TRUE(simulation::leadTo(sitting, *lead, 3.1));
        sitting.stop();
        return file;
    }
    /// As the station of who did it tells it.
    school::PushedAttempt told(std::vector<fs::path> files) {
        school::PushedAttempt p;
        p.attempt.id = std::string(32, 'a');
        p.attempt.exercise = task_.id;
        p.attempt.exerciseHash = rubric::hashText(tasks::contentHash(task_));
        p.attempt.rubricHash = rubric::hashText(rubric::hashOf(rubric_));
        for (const fs::path& file : files)
            p.attempt.sessionHashes.push_back(assessment::workHash(file));
        return p;
    }
    school::Score proved(const fs::path& file) {
        const std::vector<fs::path> files{file};
        return prove(told(files), files, task_, rubric_);
    }

    test::TemporaryFolder folder_;
    tasks::Task task_ = blockTask();
    rubric::Rubric rubric_ = removedRubric();
};

TEST_F(Proving, HonestWorkIsWorthWhatItIsWorth) {
    const fs::path file = recorded("one.h5", honest());
    const std::vector<fs::path> files{file};
    school::PushedAttempt said = told(files);
    const school::Score first = prove(said, files, task_, rubric_);
    EXPECT_EQ(first.state, "proven") << first.reason;
    EXPECT_GT(first.score, 0.0);
    EXPECT_EQ(first.stateHash.size(), 16u);
    EXPECT_THAT(first.result, HasSubstr(first.stateHash));
    EXPECT_THAT(first.reason, HasSubstr("its station said 0 of 0"));
    said.attempt.score = first.score, said.attempt.maxScore = first.maxScore, said.attempt.passed = first.passed;
    const school::Score again = prove(said, files, task_, rubric_);
    EXPECT_EQ(again.reason, "");
    EXPECT_EQ(again.result, first.result);
    // A better score than it is worth changes nothing but what is said of it.
    said.attempt.score = first.score + 5.0;
    const school::Score boasted = prove(said, files, task_, rubric_);
    EXPECT_EQ(boasted.state, "proven");
    EXPECT_EQ(boasted.score, first.score);
    EXPECT_THAT(boasted.reason, HasSubstr("its station said"));
    // Nor does another device than the recording's own.
    said.attempt.score = first.score, said.attempt.device = "a hand of steel";
    const school::Score felt = prove(said, files, task_, rubric_);
    EXPECT_EQ(felt.state, "proven");
    EXPECT_THAT(felt.reason, HasSubstr("said that it was felt by a hand of steel, and its recording says"));
}

TEST_F(Proving, AnotherSessionIsNotTheOneThatWasNamed) {
    const fs::path file = recorded("one.h5", honest());
    const std::vector<fs::path> files{file};
    const school::PushedAttempt said = told(files);
    std::vector<std::byte> bytes = core::readFile(file);
    const fs::path changed = folder_.path() / "changed.h5";
    bytes[bytes.size() / 2] ^= std::byte{1};
    core::writeFile(changed, bytes);
    const std::vector<fs::path> others{changed};
    EXPECT_THAT(prove(said, others, task_, rubric_).reason, HasSubstr("session 1 is another"));
    EXPECT_EQ(prove(said, others, task_, rubric_).state, "refused");
    EXPECT_THAT(prove(said, {}, task_, rubric_).reason, HasSubstr("without a session"));
    const std::vector<fs::path> twice{file, file};
    EXPECT_THAT(prove(said, twice, task_, rubric_).reason, HasSubstr("names 1 sessions, and 2 came"));
    // Named as it is: whatever bit it was, it ends in a sentence and never in another score.
    for (std::size_t at = 100; at < bytes.size(); at += bytes.size() / 23) {
        std::vector<std::byte> bent = core::readFile(file);
        bent[at] ^= std::byte{16};
        core::writeFile(changed, bent);
        const school::Score s = proved(changed);
        if (s.state == "refused") {
            EXPECT_NE(s.reason, "");
        } else {
            EXPECT_EQ(s.score, proved(file).score);
        }
    }
}

TEST_F(Proving, AnotherExerciseIsToldWhateverTheStationSays) {
    cases::Case wider = simulation::blockCase();
    wider.parts.front().mesh = test::boxMesh(core::Vec3(-1.8, -1.4, -1.9), core::Vec3(1.8, 1.4, -0.3));
    const fs::path file = recorded("other.h5", honest(), wider);
    EXPECT_EQ(proved(file).state, "refused");
    EXPECT_THAT(proved(file).reason, HasSubstr("tooth"));
    const std::vector<fs::path> files{file};
    school::PushedAttempt said = told(files);
    said.attempt.exerciseHash = "0000000000000001";
    EXPECT_THAT(prove(said, files, task_, rubric_).reason, HasSubstr("it was done on exercise 0000000000000001"));
}

TEST_F(Proving, EasierConditionsAreTold) {
    EXPECT_THAT(otherConditions(recorded("honest.h5", honest()), task_), IsEmpty());
    const auto refused = [&](const char* name, const SimulationSettings& settings) {
        const school::Score s = proved(recorded(name, settings));
        EXPECT_EQ(s.state, "refused");
        return s.reason;
    };
    SimulationSettings s = honest();
    s.tissues.rows[static_cast<std::size_t>(cases::Tissue::enamel)].cuttingMm2PerN *= 3.0;
    EXPECT_THAT(refused("soft.h5", s), HasSubstr("enamel was another than the exercise's"));
    s = honest();
    s.fullRemoval = true;
    EXPECT_THAT(refused("full.h5", s), HasSubstr("gone at once"));
    s = honest();
    s.bur = simulation::burOf("round:1.2x1.1");
    EXPECT_THAT(refused("other-bur.h5", s), HasSubstr("none of the exercise's"));
    s = honest();
    s.bur = std::make_shared<const instrument::Bur>("round:1.0x0.9", simulation::burOf("round:1.2x1.1")->profile());
    EXPECT_THAT(refused("false-bur.h5", s), HasSubstr("had another shape"));
    // One whose name is a file that lies where the server runs: it is not opened.
    const test::TemporaryFolder folder;
    const fs::path before = fs::current_path();
    fs::current_path(folder.path());
    geometry::writeStl("bur.stl", simulation::burOf("round:1.2x1.1")->mesh());
    ASSERT_NO_THROW((void)instrument::makeInstrument("bur.stl"));
    s.bur = std::make_shared<const instrument::Bur>("bur.stl", simulation::burOf("round:1.2x1.1")->profile());
    EXPECT_THAT(refused("file-bur.h5", s), HasSubstr("bur.stl is not in the catalogue"));
    fs::current_path(before);
    s = honest();
    s.cuttingParameters.cutting *= 2.0;
    EXPECT_THAT(refused("sharp.h5", s), HasSubstr("cut otherwise"));
    s = honest();
    s.drive.stallTorqueNmm *= 4.0;
    EXPECT_THAT(refused("strong.h5", s), HasSubstr("stronger than it is"));
    s = honest();
    s.drive.name = "rocket";
    EXPECT_THAT(refused("rocket.h5", s), HasSubstr("not in the catalogue"));
    s = honest();
    s.drive.freeSpeedRpm *= 0.5;
    EXPECT_EQ(proved(recorded("slow.h5", s)).state, "proven");
}

TEST_F(Proving, GingivaThatWasTakenAwayIsMissed) {
    cases::Part gingiva;
    gingiva.name = "gingiva", gingiva.tissue = cases::Tissue::gum, gingiva.isFelt = true;
    gingiva.mesh = test::boxMesh(core::Vec3(-6, -8, -6), core::Vec3(6, -3, -1));
    task_.toothCase.scenery = {gingiva};
    EXPECT_THAT(proved(recorded("bare.h5", honest())).reason,
                HasSubstr("gingiva or bone beside the tooth was another"));
    EXPECT_EQ(proved(recorded("whole.h5", honest(), task_.toothCase)).state, "proven");
}

/// A hand on its way by chance, as long as that.
std::vector<session::Record> wander(std::uint64_t seed, std::size_t samples) {
    std::mt19937_64 random(seed);
    std::vector<session::Record> all(samples);
    std::array<std::int32_t, 3> at{};
    for (std::size_t i = 0; i < samples; ++i) {
        for (std::int32_t& one : at)
            one += static_cast<std::int32_t>(random() % 2001) - 1000;
        all[i].tick = i, all[i].position = at;
    }
    return all;
}
std::vector<std::string> sketched(const fs::path& file, const std::vector<session::Record>& records) {
    {
        session::SessionWriter writer(file, {1000, "a", "1", "{}", std::vector<std::byte>(10)});
        for (const session::Record& one : records)
            writer.append(one);
    }
    return motionSketch(file);
}
std::size_t shared(const std::vector<std::string>& a, const std::vector<std::string>& b) {
    std::vector<std::string> both;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
    return both.size();
}

TEST(Likeness, FindsAMotionThatIsNearlyTheSameAndNoOther) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "s.h5";
    const std::vector<session::Record> whole = wander(1, 60'000);
    const std::vector<std::string> own = sketched(file, whole);
    ASSERT_EQ(own.size(), kSketch);
    EXPECT_TRUE(std::is_sorted(own.begin(), own.end()));
    // One sample changed, which made it another work by its inputs.
    std::vector<session::Record> changed = whole;
    changed[30'000].position[0] += 1;
    EXPECT_GE(shared(own, sketched(file, changed)), kSketch - 2);
    // A quarter cut off at the front, all ticks others; and something put before it.
    std::vector<session::Record> later(whole.begin() + 15'000, whole.end());
    for (std::size_t i = 0; i < later.size(); ++i)
        later[i].tick = i;
    EXPECT_GE(shared(own, sketched(file, later)), kSketch / 2);
    std::vector<session::Record> longer = wander(2, 20'000);
    longer.insert(longer.end(), whole.begin(), whole.end());
    for (std::size_t i = 0; i < longer.size(); ++i)
        longer[i].tick = i;
    EXPECT_GE(shared(own, sketched(file, longer)), kSketch / 2);
    // It rests now and then: only what moves counts.
    std::vector<session::Record> slower;
    for (const session::Record& one : whole)
        for (int k = 0; k < (one.tick % 7 == 0 ? 3 : 1); ++k)
            slower.push_back(one), slower.back().tick = slower.size() - 1;
    EXPECT_EQ(sketched(file, slower), own);
    EXPECT_EQ(shared(own, sketched(file, wander(3, 60'000))), 0u) << "another hand";
    EXPECT_THAT(sketched(file, std::vector<session::Record>(1, whole[0])), IsEmpty());
}

}  // namespace
}  // namespace handpiece::proving::proving_test
