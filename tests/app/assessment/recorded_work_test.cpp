// SPDX-License-Identifier: Apache-2.0
// What sessions tell of the hand and of when something was cut; sessions and attempts as work.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "app/simulation/live_session_fixture.h"
#include "handpiece/app/assessment/found_work.h"
#include "handpiece/app/assessment/rescore.h"
#include "handpiece/app/assessment/score_work.h"
#include "handpiece/app/simulation/working_way.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/record/session/recorder.h"
#include "handpiece/record/session/session_reader.h"
#include "support/error_of.h"

namespace handpiece::assessment::recorded_work_test {
namespace {

namespace fs = std::filesystem;
using core::Vec3;
using measures::Measured;
using measures::Request;
using testing::HasSubstr;

/// A session of a hand that nobody had: `at` makes each tick's sample.
Recording recorded(const fs::path& path, double lastsS, const std::function<void(double, messages::HapticSample&)>& at,
                   const std::vector<session::Event>& events = {}) {
    session::SessionInfo info;
    info.settings = simulation::settingsJson(simulation::blockSettings());
    session::Recorder recorder(path, info);
    for (const session::Event& event : events)
        for (std::size_t n = 0; n < session::kEventNameCount; ++n)
            if (event.name == nameOf(static_cast<session::EventName>(n)))
                recorder.event(event.tick, static_cast<session::EventName>(n), event.text);
    for (std::uint64_t tick = 0; tick < static_cast<std::uint64_t>(lastsS * 1000); ++tick) {
        messages::HapticSample s;
        s.tick = tick;
        s.pedal = 1.0;
        s.speedRpm = 200000;
        at(static_cast<double>(tick) * 1e-3, s);
        recorder.pushWaiting(session::recordOf(s));
    }
    (void)recorder.close();
    return {path, path.filename().string(), "h", {}};
}

TEST(Recording, TellsWhenAndWithWhatLoadAPlaceWasCut) {
    const test::TemporaryFolder folder;
    // A ball of 1 mm goes along x at 1 mm/s, comes back 0.6 mm beside, and once more over the first half. It is pushed
    // 0.3 mm deeper than it is let.
    const auto slide = [](double t, messages::HapticSample& s) {
        const double x = t < 3 ? t : t < 6 ? 6 - t : t - 6;
        s.positionMm = {x, t < 3 ? 0.0 : t < 6 ? 0.6 : 0.0, -0.3};
        s.depthMm = 0.3;
        s.forceN = {0, 0, t < 3 ? 1.0 : 2.0};
        s.flags = messages::kCutting;
        if (t > 7.5) s.flags = 0;  // it turns there, and takes nothing
    };
    const Recording session = recorded(folder.path() / "a.h5", 8.0, slide);
    std::vector<Measured> measured(1);
    const auto at = [](double x, double y, double z) {
        measures::Evidence evidence;
        evidence.placeMm = Vec3(x, y, z);
        return evidence;
    };
    measured[0].evidence = {
        at(2.5, 0, 0), at(0.5, 0, 0), at(2.0, 0.6, 0), at(1.0, -0.45, 0.28), at(1, 3, 0), at(1, 0, -0.2), {}};
    EXPECT_TRUE(readRecord(std::span(&session, 1), measured, 0.05, {}, {}).empty());
    const std::vector<measures::Evidence>& told = measured[0].evidence;
    const auto is = [&](std::size_t i, double timeS, double forceN) {
        ASSERT_TRUE(told[i].timeS) << i;
        EXPECT_NEAR(*told[i].timeS, timeS, 0.0015) << i;
        EXPECT_NEAR(*told[i].forceN, forceN, 0.001) << i;
    };
    is(0, 2.5, 1.0);
    is(1, 6.5, 2.0);  // the last time
    is(2, 4.0, 2.0);
    is(3, 7.0, 2.0);
    EXPECT_FALSE(told[4].timeS) << "no bur was there";
    EXPECT_FALSE(told[5].timeS) << "under what was cut";
    EXPECT_FALSE(told[6].timeS);
    // As the second of two the session says which it is.
    const std::vector<Recording> chain{recorded(folder.path() / "b.h5", 0.2, [](double, auto& s) { s.depthMm = -1; }),
                                       session};
    for (measures::Evidence& e : measured[0].evidence)
        e.timeS.reset();
    EXPECT_TRUE(readRecord(chain, measured, 0.05, {}, {}).empty());
    is(0, 2.5, 1.0);
    EXPECT_EQ(told[0].session, 1u);
}

TEST(Recording, TellsOfTheHand) {
    const test::TemporaryFolder folder;
    simulation::SimulationSettings other = simulation::blockSettings();
    other.bur = simulation::burOf("pear:1.0x3");
    const std::vector<session::Event> events{
        {0, "working way", simulation::workingWayJson({9, false, true, true})},
        {1000, "bur change", simulation::burChangeJson(simulation::blockSettings())},  // another ability, the same bur
        {1999, "working way", simulation::workingWayJson({11, true, true, false})},
        {2000, "bur change", simulation::burChangeJson(other)},
        {3000, "undo", ""}};
    const auto work = [](double t, messages::HapticSample& s) {
        s.positionMm = {2 * std::cos(3 * t), 2 * std::sin(3 * t), 0};
        s.forceN = {0, t < 2 ? 0.6 : 1.2, t < 2 ? 0.8 : 1.6};
        s.depthMm = 0.1;
        s.tissue = static_cast<std::uint8_t>(t < 3 ? cases::Tissue::enamel : cases::Tissue::pulp);
        s.flags = messages::kCutting | (t > 1 && t < 1.5 ? messages::kStalled : 0u);
    };
    const std::vector<Recording> chain{recorded(folder.path() / "a.h5", 4.0, work, events),
                                       recorded(folder.path() / "b.h5", 4.0, work, {})};
    measures::Selection overOne;
    overOne.limit = 1.5;
    const std::vector<Request> asked{{"time"},        {"force"},        {"load-over-limit", overOne}, {"path-length"},
                                     {"bur-changes"}, {"mirror-share"}, {"depth-stop-share"},         {"undos"},
                                     {"views"},       {"stalls"},       {"impulse-on-protected"},     {"strokes"}};
    const std::vector<Measured> told = readRecord(chain, {}, 0.05, asked, {}),
                                again = readRecord(chain, {}, 0.05, asked, {});
    const double truth[] = {8.0, 1.5, 4.0, 48.0, 2.0, 0, 0, 1.0, 2.0, 2.0, 4.0, 2.0};
    for (std::size_t i = 0; i < asked.size(); ++i) {
        ASSERT_TRUE(told[i].value) << asked[i].kind << ": " << told[i].reason;
        EXPECT_EQ(told[i].value, again[i].value) << asked[i].kind;
        if (asked[i].kind == "force" || asked[i].kind == "mirror-share" || asked[i].kind == "depth-stop-share")
            continue;
        EXPECT_NEAR(*told[i].value, truth[i], told[i].uncertainty + 1e-9) << asked[i].kind;
    }
    // 1 N and 2 N for as long: the median lies between.
    EXPECT_GE(*told[1].value, 1.0 - 0.002);
    EXPECT_LE(*told[1].value, 2.0 + 0.002);
    // The way holds in the next session until that tells another.
    EXPECT_NEAR(*told[5].value, 75.0, 0.2);
    EXPECT_NEAR(*told[6].value, 25.0, 0.2);
    EXPECT_EQ(told[4].evidence.at(0).timeS, 2.0);
    EXPECT_EQ(told[4].evidence.at(1).session, 1u) << "the next begins with the first bur again";
    EXPECT_THAT(
        readRecord(std::span(chain).last(1), {}, 0.05, std::vector<Request>{{"mirror-share"}}, {}).front().reason,
        HasSubstr("does not tell"));
}

/// Three strokes of a second, each with a load on the gingiva: the second cuts tooth as well, and is taken back.
TEST(Recording, WhatAStrokeDidToTheGingivaGoesWithItWhenItIsTakenBack) {
    const test::TemporaryFolder folder;
    const auto strokes = [](double t, messages::HapticSample& s) {
        s.pedal = std::fmod(t, 1.0) < 0.8 ? 1.0 : 0.0;
        s.depthMm = -1;
        s.forceN = {0, 0, 0};
        // One, two and four newtons for half a second each.
        if (std::fmod(t, 1.0) < 0.5) {
            s.flags = messages::kPressesGingiva;
            s.forceN = {0, 0, t < 1 ? 1.0 : t < 2 ? 2.0 : 4.0};
        }
        // 1 mm3 in the first stroke, another in the second, which comes back at 1.95 s.
        const double enamel = t < 1 ? t : t < 1.8 ? 1.0 + (t - 1) : t < 1.95 ? 1.8 : 1.0;
        s.removedMm3[static_cast<std::size_t>(cases::Tissue::enamel)] = enamel;
        if (t >= 1.95 && t < 1.96) s.flags |= messages::kRestoring;
    };
    const std::vector<session::Event> events{
        {800, "stroke end", "{}"}, {1800, "stroke end", "{}"}, {1950, "undo", ""}, {2800, "stroke end", "{}"}};
    const Recording session = recorded(folder.path() / "a.h5", 2.9, strokes, events);
    measures::Selection gum;
    gum.tissue = "gum";
    const std::vector<Request> asked{{"impulse-not-undone", gum}, {"impulse-on-protected", gum}, {"undos"}};
    const std::vector<Measured> told = readRecord(std::span(&session, 1), {}, 0.05, asked, {});
    EXPECT_NEAR(*told[0].value, 0.5 + 2.0, 0.01) << "the first, and the third, which took no tooth";
    EXPECT_NEAR(*told[1].value, 0.5 + 1.0 + 2.0, 0.01) << "what rubrics of before ask for is as it was";
    EXPECT_EQ(*told[2].value, 1.0);
    EXPECT_NEAR(*told[0].evidence.at(0).timeS, 0.0, 0.002);
}

tasks::Task blockTask() {
    tasks::Task task;
    task.id = "block";
    task.toothCase = simulation::blockCase();
    task.voxelMm = simulation::blockSettings().field.voxelMm;
    return task;
}

TEST(ReadWork, OfAnAttemptAndItsSessionsIsTheSame) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "one.h5";
    cases::Attempt attempt;
    {
        const simulation::SimulationSetup station = simulation::blockStation();
        simulation::LiveSessionSettings settings;
        settings.sessionFile = file;
        const auto lead = std::make_shared<simulation::Lead>();
        simulation::LiveSession sitting(station, simulation::blockCase(),
                                        simulation::handOf(simulation::twoHoles(), lead), settings, nullptr);
        ASSERT_TRUE(simulation::leadTo(sitting, *lead, 3.1));
        sitting.stop();
        attempt = sitting.attempt(folder.path() / "case");
    }
    const cases::Case block = simulation::blockCase();
    attempt.recordings = {{"one.h5", true}};
    const auto saved = [&](const char* name, const cases::Attempt& what, cases::PackageFiles with) {
        const fs::path path = folder.path() / name;
        cases::writeAttempt(what, path, &block, std::move(with));
        return path;
    };
    const tasks::Task task = blockTask();
    const Work session = readWork(file, task);
    EXPECT_TRUE(session.isProven) << session.proof;
    const fs::path whole = saved("whole.handpiece", attempt, {{"one.h5", core::readFile(file)}});
    const Work of = readWork(whole, task);
    EXPECT_TRUE(of.isProven) << of.proof;
    EXPECT_EQ(of.sessionHashes, session.sessionHashes);

    measures::Selection greatest;
    greatest.statistic = "greatest";
    const std::vector<Request> asked{{"floor-depth", greatest}, {"removed"}, {"time"},
                                     {"path-length"},           {"force"},   {"strokes"}};
    const MeasuredWork one = measureWork(session, task, asked), two = measureWork(of, task, asked);
    EXPECT_EQ(one.identity.stateHash, two.identity.stateHash);
    for (std::size_t i = 0; i < asked.size(); ++i) {
        EXPECT_TRUE(one.measured[i].value) << asked[i].kind << ": " << one.measured[i].reason;
        EXPECT_EQ(one.measured[i].value, two.measured[i].value) << asked[i].kind;
    }
    // The deepest place lies in one of the holes, and was cut while the bur was in that.
    const measures::Evidence& deepest = one.measured[0].evidence.at(0);
    ASSERT_TRUE(deepest.placeMm && deepest.timeS);
    const session::SessionReader reader(file);
    const std::uint64_t index = reader.indexOfTick(static_cast<std::uint64_t>(std::lround(*deepest.timeS * 1000)));
    const session::Record there = reader.records(index, 1).front();
    EXPECT_NEAR(session::inputsOf(there).positionMm[0], deepest.placeMm->x(), 0.6);
    EXPECT_NE(there.flags & messages::kCutting, 0u);
    EXPECT_GT(*deepest.forceN, 0.0);
    EXPECT_EQ(*one.measured[5].value, 2.0);

    // Without its session, and without any account of sessions.
    const Work bare = readWork(saved("bare.handpiece", attempt, {}), task);
    EXPECT_FALSE(bare.isProven);
    EXPECT_THAT(bare.proof, HasSubstr("one.h5 did not come along"));
    cases::Attempt alone = attempt;
    alone.recordings.clear();
    const Work tooth = readWork(saved("alone.handpiece", alone, {}), task);
    EXPECT_FALSE(tooth.isProven);
    const MeasuredWork silent = measureWork(tooth, task, asked);
    EXPECT_EQ(silent.measured[1].value, one.measured[1].value);
    for (std::size_t i = 2; i < asked.size(); ++i) {
        EXPECT_FALSE(silent.measured[i].value) << asked[i].kind;
        EXPECT_THAT(silent.measured[i].reason, HasSubstr("no samples")) << asked[i].kind;
    }
    // Another tooth than its session leaves.
    cases::Attempt other = attempt;
    other.state = tooth::encodeState({}, tooth::identityOf(session.teeth));
    const Work forged = readWork(saved("forged.handpiece", other, {{"one.h5", core::readFile(file)}}), task);
    EXPECT_FALSE(forged.isProven);
    EXPECT_THAT(forged.proof, HasSubstr("another tooth"));
    EXPECT_TRUE(forged.recordings.empty());
}

/// Four sittings at one block, each of which goes on from what the one before it left, as files of their own.
class Chain : public testing::Test {
  protected:
    void SetUp() override {
        tooth::StateDelta state;
        for (std::size_t i = 0; i < kCount; ++i) {
            simulation::SimulationSetup station = simulation::blockStation();
            simulation::LiveSessionSettings settings;
            settings.sessionFile = folder_.path() / names_[i];
            if (i > 0) station.resume(state);
            station.settings.resumed = i > 0;
            const auto lead = std::make_shared<simulation::Lead>();
            // Each by a hand that comes from a little more to the side.
            const double aside = 0.25 * static_cast<double>(i);
            simulation::LiveSession sitting(station, simulation::blockCase(),
                                            simulation::handOf(simulation::hole(aside), lead), settings, nullptr);
            ASSERT_TRUE(simulation::leadTo(sitting, *lead, 1.3));
            sitting.stop();
            state = sitting.state();
            links_.push_back({names_[i], settings.sessionFile, false});
            attempt_ = sitting.attempt(folder_.path() / "case");
        }
        end_ = rubric::hashText(tooth::stateHash(state));
    }
    [[nodiscard]] std::string hashOf(const Work& work) const { return rubric::hashText(tooth::stateHash(work.state)); }
    /// A folder with those of them.
    [[nodiscard]] fs::path folderOf(const char* name, const std::vector<std::size_t>& which) const {
        const fs::path place = folder_.path() / "works" / name;
        fs::create_directories(place);
        for (const std::size_t i : which)
            fs::copy_file(folder_.path() / names_[i], place / names_[i]);
        return place;
    }

    static constexpr std::size_t kCount = 4;
    /// Not in the order of the work: that is told by the teeth.
    const std::array<std::string, kCount> names_{"b.h5", "a.h5", "d.h5", "c.h5"};
    core::PrivateFolder folder_;
    std::vector<ChainLink> links_;
    cases::Attempt attempt_;
    std::string end_;
    tasks::Task task_ = blockTask();
};

TEST_F(Chain, OfFourSessionsIsProvenHoweverItIsHandedIn) {
    const std::vector<Request> asked{{"removed"}, {"time"}, {"strokes"}};
    const Work told = readChain(links_, task_);
    EXPECT_TRUE(told.isProven) << told.proof;
    EXPECT_THAT(told.proof, HasSubstr("4 sessions"));
    EXPECT_EQ(told.sessionHashes.size(), kCount);
    EXPECT_EQ(hashOf(told), end_);
    const MeasuredWork measured = measureWork(told, task_, asked);
    ASSERT_TRUE(measured.measured[2].value);
    EXPECT_EQ(*measured.measured[2].value, static_cast<double>(kCount)) << "a stroke a sitting";
    EXPECT_NEAR(*measured.measured[1].value, 4 * 1.3, 0.5) << "pauses are not counted";
    const Work inFolder = readWork(folderOf("all", {0, 1, 2, 3}), task_);
    EXPECT_TRUE(inFolder.isProven) << inFolder.proof;
    EXPECT_EQ(inFolder.sessionHashes, told.sessionHashes);
    EXPECT_EQ(hashOf(inFolder), end_);
    // The first two came with an attempt, as with one that was handed in and gone on with.
    const cases::Case block = simulation::blockCase();
    attempt_.recordings = {{names_[0], true}, {names_[1], true}, {names_[2], false}, {names_[3], false}};
    const fs::path attempt = folder_.path() / "attempt.handpiece";
    cases::writeAttempt(attempt_, attempt, &block,
                        {{names_[0], core::readFile(links_[0].in)}, {names_[1], core::readFile(links_[1].in)}});
    std::vector<ChainLink> mixed = links_;
    mixed[0] = {names_[0], attempt, true};
    mixed[1] = {names_[1], attempt, true};
    const Work packed = readChain(mixed, task_);
    EXPECT_TRUE(packed.isProven) << packed.proof;
    EXPECT_EQ(packed.sessionHashes, told.sessionHashes);
}

TEST_F(Chain, WithOneMissingIsScoredAndSaysSo) {
    fs::remove(links_[1].in);
    const Work told = readChain(links_, task_);
    EXPECT_FALSE(told.isProven);
    EXPECT_THAT(told.proof, HasSubstr("a.h5 is no longer there"));
    EXPECT_EQ(hashOf(told), end_) << "the tooth is that of the last";
    const std::vector<Request> asked{{"removed"}, {"time"}};
    const MeasuredWork measured = measureWork(told, task_, asked);
    EXPECT_TRUE(measured.measured[0].value);
    EXPECT_FALSE(measured.measured[1].value) << "a time without a part of it is none";
    EXPECT_THAT(measured.measured[1].reason, HasSubstr("no longer there"));
    const Work inFolder = readWork(folderOf("some", {0, 2, 3}), task_);
    EXPECT_FALSE(inFolder.isProven);
    EXPECT_THAT(inFolder.proof, HasSubstr("d.h5 goes on from a tooth that no other session here leaves"));
    EXPECT_EQ(hashOf(inFolder), end_);
    EXPECT_TRUE(inFolder.recordings.empty());
    // In another order than it was worked in.
    std::vector<ChainLink> turned{links_[0], links_[3], links_[2]};
    EXPECT_THAT(readChain(turned, task_).proof, HasSubstr("c.h5 goes on from another tooth"));
    fs::remove(links_[3].in);
    EXPECT_NE(test::errorOf([&] { static_cast<void>(readChain(links_, task_)); }), "") << "no tooth to judge";
    EXPECT_NE(test::errorOf([&] { static_cast<void>(readChain({}, task_)); }), "");
}

TEST(SavedAndGivenUp, WhatFollowedTheSavedToothCountsForNothingAndTheRestIsProven) {
    const test::TemporaryFolder folder;
    tooth::StateDelta saved, end;
    const auto sit = [&](const char* name, const auto& motion, double midS, double lastS, bool resumed) {
        simulation::SimulationSetup station = simulation::blockStation();
        simulation::LiveSessionSettings settings;
        settings.sessionFile = folder.path() / name;
        if (resumed) station.resume(saved);
        station.settings.resumed = resumed;
        const auto lead = std::make_shared<simulation::Lead>();
        simulation::LiveSession sitting(station, simulation::blockCase(), simulation::handOf(motion, lead), settings,
                                        nullptr);
        if (midS > 0.0) {
            ASSERT_TRUE(simulation::leadTo(sitting, *lead, midS));
            saved = sitting.state();
        }
        ASSERT_TRUE(simulation::leadTo(sitting, *lead, lastS));
        sitting.stop();
        end = sitting.state();
    };
    sit("a.h5", simulation::twoHoles(), 1.5, 3.1, false);
    const tooth::StateDelta wholeFirst = end;
    ASSERT_NE(tooth::stateHash(saved), tooth::stateHash(wholeFirst));
    sit("b.h5", simulation::hole(0.5), 0.0, 1.3, true);
    const tasks::Task task = blockTask();
    const std::vector<ChainLink> links{{"a.h5", folder.path() / "a.h5", false},
                                       {"b.h5", folder.path() / "b.h5", false}};
    const std::vector<Request> asked{{"removed"}, {"time"}, {"strokes"}};
    for (const bool prove : {true, false}) {
        const Work work = readChain(links, task, prove);
        EXPECT_EQ(work.isProven, prove) << work.proof;
        EXPECT_THAT(work.proof, HasSubstr("a.h5 after it was saved was given up"));
        EXPECT_EQ(tooth::stateHash(work.state), tooth::stateHash(end));
        const MeasuredWork measured = measureWork(work, task, asked);
        ASSERT_TRUE(measured.measured[1].value && measured.measured[2].value) << measured.measured[1].reason;
        EXPECT_EQ(*measured.measured[2].value, 2.0) << "one stroke of each: the second of the first was given up";
        EXPECT_LT(*measured.measured[1].value, 1.5 + 1.3 + 0.2);
    }
    // As a folder of sessions too; and a session from any other tooth still breaks it.
    EXPECT_TRUE(readWork(folder.path(), task).isProven);
    sit("c.h5", simulation::hole(0.9), 0.6, 1.3, false);
    sit("d.h5", simulation::hole(0.2), 0.0, 1.3, true);
    const std::vector<ChainLink> broken{links[0], {"d.h5", folder.path() / "d.h5", false}};
    const Work none = readChain(broken, task);
    EXPECT_FALSE(none.isProven);
    EXPECT_THAT(none.proof, HasSubstr("d.h5 goes on from another tooth"));
}

TEST_F(Chain, OfTwoWorksIsNone) {
    const fs::path two = folderOf("two", {0, 1});
    fs::copy_file(links_[0].in, two / "again.h5");
    EXPECT_THAT(test::errorOf([&] { static_cast<void>(readWork(two, task_)); }), HasSubstr("several works"));
}

TEST_F(Chain, IsOneWorkForAllWhoLook) {
    (void)folderOf("student-1", {0, 1, 2, 3});
    (void)folderOf("student-2", {0, 2, 3});
    const fs::path works = folder_.path() / "works";
    fs::copy_file(links_[0].in, works / "alone.h5");
    fs::create_directories(works / "student-3");
    core::writeFile(works / "student-3" / "result.json", std::string_view("{}"));
    fs::create_directories(works / ".hidden");
    core::writeFile(works / ".hidden" / "x.h5", std::string_view(""));
    std::vector<std::string> found;
    for (const FoundWork& one : findWork(works))
        found.push_back(one.path.lexically_relative(works).generic_string() + (one.isResultOnly ? "!" : ""));
    EXPECT_THAT(found, testing::ElementsAre("alone.h5", "student-1", "student-2", "student-3/result.json!"));
    EXPECT_EQ(worksIn(works).size(), 3u);
}

}  // namespace
}  // namespace handpiece::assessment::recorded_work_test
