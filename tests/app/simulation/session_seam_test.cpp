// SPDX-License-Identifier: Apache-2.0
// A session that goes on after a pause, and after its program was killed: one record, cut again as one.
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <numeric>

#include "app/simulation/live_session_fixture.h"
#include "handpiece/app/report/report_figures.h"
#include "handpiece/app/report/session_report.h"
#include "handpiece/app/simulation/cut_session.h"
#include "handpiece/app/simulation/session_player.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/record/session/recorder.h"

namespace handpiece::simulation::session_seam_test {
namespace {

namespace fs = std::filesystem;
constexpr SessionPlayer::Settings kUnseen{false, false, {}};

double removed(const tooth::TissueVolumes& mm3) {
    return std::accumulate(mm3.begin(), mm3.end(), 0.0);
}

std::uint64_t ticksIn(const fs::path& file) {
    try {
        return session::SessionReader(file).size();
    } catch (const core::Error&) {
        return 0;  // it is not there yet
    }
}

/// A program that cuts, killed in the middle of its second stroke.
void cutUntilKilled(const fs::path& file) {
    const pid_t child = fork();
    if (child == 0) {
        execl(HANDPIECE_SITTING_CHILD, HANDPIECE_SITTING_CHILD, file.c_str(), nullptr);
        _exit(127);
    }
    EXPECT_TRUE(waitUntilTrue([&] { return ticksIn(file) >= 4200; }));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status)) << "it ended by itself";
}

/// Goes on at the tooth as it is, in the same file, with another hole. Returns the state it leaves.
tooth::StateDelta goOn(const fs::path& file, SimulationSetup station, const tooth::StateDelta& state,
                       const history::History& strokes, LiveSessionSettings::Session session, std::size_t undone,
                       history::History* strokesAfter = nullptr) {
    station.field = std::make_shared<tooth::ToothState>(station.tooth);
    station.resume(state);
    station.settings.resumed = true;
    LiveSessionSettings settings;
    settings.sessionFile = file;
    settings.session = session;
    settings.history = keepHistory(strokes, state, station);
    const auto lead = std::make_shared<Lead>();
    LiveSession liveSession(station, blockCase(), handOf(twoHoles(), lead), settings, nullptr);
    const auto feed = liveSession.subscribe();
    EXPECT_TRUE(leadTo(liveSession, *lead, 1.3));
    const std::size_t before = liveSession.status().undoSteps;
    for (std::size_t i = 0; i < undone; ++i)
        liveSession.undo();
    EXPECT_TRUE(waitUntilTaken(*feed, undone));
    EXPECT_TRUE(waitUntilTrue([&] { return liveSession.status().undoSteps == before - undone; }));
    EXPECT_TRUE(leadTo(liveSession, *lead, 3.1));
    liveSession.stop();
    if (strokesAfter) *strokesAfter = liveSession.history();
    return liveSession.state();
}

void expectOneSession(const fs::path& file, std::uint64_t seams, const tooth::StateDelta& end) {
    SessionPlayer player(file, kUnseen);
    const Verdict verdict = player.compareAll();
    EXPECT_TRUE(verdict.matches);
    EXPECT_EQ(verdict.seams, seams);
    EXPECT_EQ(verdict.brokenSeams, 0u);
    EXPECT_EQ(verdict.differingTicks, 0u) << "first " << verdict.firstDifferingTick;
    EXPECT_EQ(verdict.hash, hashText(tooth::stateHash(end)));
    EXPECT_TRUE(player.isExact());
    EXPECT_EQ(player.skippedSteps(), 0u);
}

TEST(SessionSeam, workBeforeAKillIsInTheSessionThatGoesOn) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "session.h5";
    cutUntilKilled(file);
    report::SessionFigures before = report::figuresOf(session::SessionReader(file));
    ASSERT_GT(before.pedalS, 3.0);

    const Recovered recovered = recover(file);
    const SimulationSetup station = makeSimulation(recovered.toothCase, recovered.settings, false);
    ASSERT_GT(removed(recovered.state.removedMm3.own), 0.2);
    // Undone is also what was cut before the kill: the stroke under way then, and this one's first.
    const tooth::StateDelta end =
        goOn(file, station, recovered.state, recovered.history, LiveSessionSettings::Session::recovered, 2);
    expectOneSession(file, 1, end);

    const report::SessionFigures after = report::figuresOf(session::SessionReader(file));
    EXPECT_GT(after.pedalS, before.pedalS + 1.5);
    EXPECT_GT(after.cuttingS, before.cuttingS);
    EXPECT_NEAR(removed(after.removedMm3), removed(end.removedMm3.own), 1e-3);
    // Marks for the time line, from before and after.
    const SessionPlayer player(file, kUnseen);
    const auto begins = [&](double fromS, double toS) {
        return std::count_if(player.events().begin(), player.events().end(), [&](const session::Event& e) {
            const double timeS = static_cast<double>(e.tick) / 1000;
            return e.name == "stroke begin" && timeS >= fromS && timeS < toS;
        });
    };
    EXPECT_EQ(begins(0.0, before.totalS), 2);
    EXPECT_EQ(begins(before.totalS, 1e9), 2);
}

TEST(SessionSeam, aSecondKillAndAPauseLoseNothingEither) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "session.h5";
    cutUntilKilled(file);
    const Recovered recovered = recover(file);
    const SimulationSetup station = makeSimulation(recovered.toothCase, recovered.settings, false);
    history::History strokes;
    const tooth::StateDelta second =
        goOn(file, station, recovered.state, recovered.history, LiveSessionSettings::Session::recovered, 1, &strokes);
    // Handed over, as for a replay in between.
    const tooth::StateDelta third = goOn(file, station, second, strokes, LiveSessionSettings::Session::continued, 2);
    expectOneSession(file, 2, third);
    // Another program finds it, as after a second kill.
    const Recovered again = recover(file);
    EXPECT_EQ(tooth::stateHash(again.state), tooth::stateHash(third));
    const tooth::StateDelta last =
        goOn(file, station, again.state, again.history, LiveSessionSettings::Session::recovered, 3);
    expectOneSession(file, 3, last);

    // Jumps to all parts, back and forth, find the tooth as recorded there.
    SessionPlayer player(file, {false, true, {}});
    const std::vector<std::uint64_t>& frames = player.reader().keyFrameTicks();
    ASSERT_GT(frames.size(), 6u);
    for (const std::size_t f :
         {frames.size() - 1, std::size_t{0}, frames.size() / 2, std::size_t{1}, frames.size() - 2}) {
        player.seek(static_cast<double>(frames[f]) / 1000);
        const session::KeyFrame frame = player.reader().keyFrame(f);
        const tooth::StateDelta there = tooth::decodeState(frame.state, player.station().teeth(), "frame");
        EXPECT_EQ(player.sample().tick, frames[f]);
        EXPECT_NEAR(removed(player.state().removedMm3.own), removed(there.removedMm3.own), 1e-4) << f;
        const auto& told = player.sample().removedMm3;
        EXPECT_NEAR(std::accumulate(told.begin(), told.end(), 0.0), removed(there.removedMm3.own), 1e-4) << f;
    }
}

TEST(SessionSeam, aSeamThatDoesNotFitIsTold) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "session.h5";
    const tooth::StateDelta state = workThreeSeconds(file);
    const Recovered recovered = recover(file);
    const SimulationSetup station = makeSimulation(recovered.toothCase, recovered.settings, false);
    // Another tooth than the one that was left: the first stroke alone.
    history::History strokes = recovered.history;
    const auto undo = strokes.undo();
    ASSERT_TRUE(undo);
    tooth::ToothMirror mirror(station.tooth);
    mirror.apply(state);
    mirror.apply(*undo);
    history::History none;
    none.start(mirror.state(undo->removedMm3.own));
    (void)goOn(file, station, mirror.state(undo->removedMm3.own), none, LiveSessionSettings::Session::recovered, 1);
    SessionPlayer player(file, {false, true, {}});
    const std::string page = report::sessionReport(player, {false, 64, 48});
    EXPECT_NE(page.find("on another tooth than was left"), std::string::npos);
    const Verdict verdict = player.compareAll();
    EXPECT_EQ(verdict.brokenSeams, 1u);
    EXPECT_FALSE(verdict.matches);
}

}  // namespace
}  // namespace handpiece::simulation::session_seam_test
