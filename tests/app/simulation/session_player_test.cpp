// SPDX-License-Identifier: Apache-2.0
// A recorded sitting played again: bit for bit from the beginning, near enough after a jump.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "app/simulation/live_session_fixture.h"
#include "handpiece/app/simulation/cut_session.h"
#include "handpiece/app/simulation/session_player.h"
#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/case/case_bytes.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/record/session/recorder.h"

namespace handpiece::simulation::session_player_test {
namespace {

constexpr SessionPlayer::Settings kUnseen{false, false, {}};

double removed(const tooth::TissueVolumes& mm3) {
    double sum = 0.0;
    for (const double v : mm3)
        sum += v;
    return sum;
}

/// Recorded once for all tests.
struct Recorded {
    Recorded() : state(workThreeSeconds(folder.path() / "session.h5", folder.path() / "cut-off.h5")) {}
    test::TemporaryFolder folder;
    tooth::StateDelta state;
    [[nodiscard]] std::filesystem::path file() const { return folder.path() / "session.h5"; }
    [[nodiscard]] std::filesystem::path cutOff() const { return folder.path() / "cut-off.h5"; }
};
const Recorded& recorded() {
    static const Recorded it;
    return it;
}

std::size_t count(const SessionPlayer& player, const char* name) {
    return static_cast<std::size_t>(std::count_if(player.events().begin(), player.events().end(),
                                                  [&](const session::Event& e) { return e.name == name; }));
}

/// Of the last record up to a time: a busy machine leaves periods out.
double recordedTimeS(const SessionPlayer& player, double timeS) {
    const auto tick = static_cast<std::uint64_t>(std::floor(timeS * 1000 + 1e-6));
    const std::uint64_t at = player.reader().indexOfTick(tick + 1);
    return static_cast<double>(player.reader().records(at - 1, 1).front().tick) / 1000;
}

/// When something of this name last happened: on a busy machine the hand takes longer than three seconds for its way.
double lastTimeOf(const SessionPlayer& player, const char* name, std::size_t times) {
    EXPECT_EQ(count(player, name), times) << name;
    const auto last = std::find_if(player.events().rbegin(), player.events().rend(),
                                   [&](const session::Event& e) { return e.name == name; });
    return last == player.events().rend() ? 0.0 : static_cast<double>(last->tick) / 1000;
}

TEST(SessionPlayer, cutsTheSameToothThroughEveryChange) {
    SessionPlayer player(recorded().file(), kUnseen);
    EXPECT_EQ(count(player, "bur change"), 1u);
    EXPECT_EQ(count(player, "parameter change"), 4u);
    EXPECT_EQ(count(player, "undo"), 2u);
    EXPECT_EQ(count(player, "redo"), 2u);
    const Verdict verdict = player.compareAll();
    EXPECT_TRUE(verdict.matches);
    EXPECT_TRUE(verdict.complete);
    EXPECT_EQ(verdict.differingTicks, 0u) << "first " << verdict.firstDifferingTick;
    EXPECT_TRUE(player.isExact());
    EXPECT_EQ(verdict.hash, hashText(tooth::stateHash(recorded().state)));
    EXPECT_EQ(player.station().settings.drive.name, "turbine");
    EXPECT_NEAR(player.station().settings.bur->maxRadiusMm(), 0.6, 1e-9);
    EXPECT_DOUBLE_EQ(player.station().settings.parameters.frictionMultiplier, 0.5);
    EXPECT_DOUBLE_EQ(player.timeS(), player.durationS());
}

/// The recorded session as an engine of this revision may have recorded it: the hand a nanometre beside, so that what
/// is cut again is not quite what the key frames hold.
void copyAs(std::int32_t engineRevision, const std::filesystem::path& to) {
    const session::SessionReader from(recorded().file());
    session::SessionInfo info = from.info();
    info.engineRevision = engineRevision;
    session::Recorder recorder(to, info);
    for (session::Record r : from.records(0, static_cast<std::size_t>(from.size()))) {
        r.position[0] += 1;
        recorder.pushWaiting(r);
    }
    for (const session::Event& event : from.events())
        for (std::size_t i = 0; i < session::kEventNameCount; ++i)
            if (const auto name = static_cast<session::EventName>(i); event.name == session::nameOf(name))
                recorder.event(event.tick, name, event.text);
    for (std::size_t i = 0; i < from.keyFrameTicks().size(); ++i) {
        session::KeyFrame frame = from.keyFrame(i);
        recorder.keyFrame(frame.tick, std::move(frame.state));
    }
    EXPECT_EQ(recorder.close().message, "");
}

TEST(SessionPlayer, ofAnotherEngineItIsPutRightAtKeyFramesAndProvesNothing) {
    const test::TemporaryFolder folder;
    const std::filesystem::path own = folder.path() / "own.h5", other = folder.path() / "other.h5";
    copyAs(core::kEngineRevision, own);
    copyAs(core::kEngineRevision - 1, other);
    SessionPlayer differs(own, kUnseen), player(other, kUnseen);
    const Verdict same = differs.compareAll(), verdict = player.compareAll();
    EXPECT_FALSE(same.isOtherEngine());
    EXPECT_FALSE(same.matches);
    EXPECT_TRUE(differs.isExact());
    EXPECT_EQ(verdict.engineRevision, core::kEngineRevision - 1);
    EXPECT_TRUE(verdict.isOtherEngine());
    EXPECT_FALSE(verdict.matches);
    EXPECT_FALSE(player.isExact());
    EXPECT_NE(tooth::stateHash(differs.state()), tooth::stateHash(recorded().state));
    EXPECT_EQ(tooth::stateHash(player.state()), tooth::stateHash(recorded().state)) << "the last key frame";
}

TEST(SessionPlayer, jumpsAnywhereAndGivesTheSameEachTime) {
    SessionPlayer exact(recorded().file(), kUnseen), player(recorded().file(), {false, true, {}});
    player.seek(player.durationS());
    EXPECT_FALSE(player.isExact());
    EXPECT_EQ(tooth::stateHash(player.state()), tooth::stateHash(recorded().state)) << "the last key frame";
    const double changedS = lastTimeOf(player, "bur change", 1), redoneS = lastTimeOf(player, "redo", 2),
                 begunS = lastTimeOf(player, "stroke begin", 2), endedS = lastTimeOf(player, "stroke end", 2);
    const auto between = [](double from, double to, double share) { return from + share * (to - from); };
    int shown = 0;
    // After the last redo, in the second hole, without the first hole, at the end, in the first hole.
    for (const double timeS : {between(redoneS, begunS, 0.5), between(begunS, endedS, 0.7),
                               between(changedS, redoneS, 0.5), between(endedS, player.durationS(), 0.3), 0.6}) {
        SCOPED_TRACE(timeS);
        exact.advance(0.0);
        player.seek(timeS);
        EXPECT_DOUBLE_EQ(player.timeS(), recordedTimeS(player, timeS));
        EXPECT_EQ(player.sample().tick, static_cast<std::uint64_t>(std::llround(player.timeS() * 1000)));
        const tooth::StateDelta once = player.state();
        // In the midst of a cut some bricks are still on their way to the eye.
        if (player.sample().waitingBricks == 0) {
            EXPECT_EQ(tooth::stateHash(player.tooth()->state({})), tooth::stateHash(once)) << "what is shown";
            ++shown;
        }
        player.seek(0.0);
        player.seek(player.durationS());
        player.seek(timeS);
        EXPECT_EQ(tooth::stateHash(player.state()), tooth::stateHash(once)) << "depends on where it came from";
        SessionPlayer played(recorded().file(), kUnseen);
        played.advance(timeS);
        EXPECT_NEAR(removed(once.removedMm3.own), removed(played.state().removedMm3.own),
                    0.02 * removed(played.state().removedMm3.own) + 1e-3);
        // Its speed goes on from the key frame's own record.
        EXPECT_NEAR(player.sample().speedRpm, played.sample().speedRpm, 0.005 * played.sample().speedRpm + 50);
    }
    EXPECT_GE(shown, 3);  // between strokes none is
    player.seek(0.0);
    EXPECT_TRUE(player.isExact());
    player.advance(player.durationS());
    EXPECT_EQ(player.differingTicks(), 0u);
}

TEST(SessionPlayer, aTimeThatIsARoundingBeforeATickIsThatTick) {
    SessionPlayer player(recorded().file(), kUnseen);
    for (std::uint64_t i = 100; i < 1000; i += 37) {
        const double timeS = static_cast<double>(player.reader().records(i, 1).front().tick) / 1000;
        player.seek(std::nextafter(timeS, 0.0));
        EXPECT_DOUBLE_EQ(player.timeS(), timeS);
    }
}

TEST(SessionPlayer, plotsWhatWasRecorded) {
    const SessionPlayer player(recorded().file(), kUnseen);
    const std::vector<PlotPoint> points = player.plot(0.05);
    float most = 0.0f, expected = 0.0f;
    for (const PlotPoint& p : points)
        most = std::max(most, p.forceN);
    std::set<std::uint64_t> stretches;  // of fifty ticks, in which there is a record
    for (const session::Record& r : player.reader().records(0, static_cast<std::size_t>(player.reader().size()))) {
        expected = std::max(expected, std::hypot(r.forceN[0], r.forceN[1], r.forceN[2]));
        stretches.insert(r.tick / 50);
    }
    EXPECT_FLOAT_EQ(most, expected);
    EXPECT_EQ(points.size(), stretches.size());
    EXPECT_GT(points.size(), 3u);
    EXPECT_NEAR(static_cast<double>(points.back().removedMm3[2]), recorded().state.removedMm3.own[2], 1e-3);
}

TEST(SessionPlayer, aSessionThatWasNeverClosedGivesTheToothBack) {
    const Recovered recovered = recover(recorded().cutOff());
    EXPECT_EQ(recovered.code, "test");
    EXPECT_EQ(recovered.toothCase.name, "block");
    EXPECT_GT(recovered.elapsedS, 1.0);
    EXPECT_NEAR(recovered.settings.bur->maxRadiusMm(), 0.6, 1e-9);
    SessionPlayer played(recorded().cutOff(), kUnseen);
    played.advance(played.durationS());
    EXPECT_EQ(played.differingTicks(), 0u);
    const double expected = removed(played.state().removedMm3.own);
    EXPECT_GT(expected, 0.05);
    EXPECT_NEAR(removed(recovered.state.removedMm3.own), expected, 0.02 * expected);
    EXPECT_FALSE(played.compareAll().complete);

    const Recovered whole = recover(recorded().file());
    EXPECT_EQ(tooth::stateHash(whole.state), tooth::stateHash(recorded().state));
}

TEST(SessionPlayer, theSameHandInAnotherFieldCutsAsMuch) {
    field::FieldSettings field = blockSettings().field;
    field.voxelMm = 0.05;
    const Recut recut = recutAt(recorded().file(), field, false);
    EXPECT_EQ(recut.station.settings.field.voxelMm, 0.05);
    EXPECT_EQ(recut.skippedSteps, 0u);
    EXPECT_EQ(recut.station.field->stateHash(), tooth::stateHash(recut.state));
    EXPECT_NEAR(removed(recut.state.removedMm3.own), removed(recorded().state.removedMm3.own),
                0.1 * removed(recorded().state.removedMm3.own));
    // A state of that station: it can be packed and put in place.
    const auto bytes = tooth::encodeState(recut.state, recut.station.tooth->identity);
    EXPECT_NO_THROW((void)tooth::decodeState(bytes, recut.station.teeth()));
}

/// Undoes all there is at a tooth in this state, in a sitting of its own that is recorded to `file`.
void undoAll(const SimulationSetup& begun, const tooth::StateDelta& state, const history::History& strokes,
             std::size_t steps, const std::filesystem::path& file) {
    SimulationSetup station = begun;
    station.field = std::make_shared<tooth::ToothState>(station.tooth);
    station.resume(state);
    station.settings.resumed = true;
    LiveSessionSettings settings;
    settings.sessionFile = file;
    settings.history = keepHistory(strokes, state, station);
    LiveSession liveSession(station, blockCase(),
                            handOf(device::Motion({{0.0, {core::Vec3(0, 0, 1), core::Quat::Identity()}, 0}})), settings,
                            nullptr);
    const auto feed = liveSession.subscribe();
    EXPECT_TRUE(waitUntilTrue([&] { return liveSession.status().undoSteps == steps; }));
    for (std::size_t i = 0; i < steps; ++i)
        liveSession.undo();
    EXPECT_TRUE(waitUntilTaken(*feed, steps));
    EXPECT_TRUE(waitUntilTrue([&] { return liveSession.state().bricks.empty(); }));
    EXPECT_EQ(removed(liveSession.state().removedMm3.own), 0.0);
    EXPECT_EQ(liveSession.status().redoSteps, steps);
    liveSession.redo();
    EXPECT_TRUE(waitUntilTaken(*feed, steps + 1));
    EXPECT_GT(removed(liveSession.state().removedMm3.own), 0.05);
    EXPECT_TRUE(waitUntilTrue([&] { return liveSession.status().recording.writtenRecords > 0; }));
    liveSession.stop();
    EXPECT_EQ(liveSession.history().undoSteps(), 1u);
}

/// A session that began with strokes is repeated bit for bit, and tells them again.
void playsAgain(const std::filesystem::path& file, std::size_t steps) {
    SessionPlayer player(file, kUnseen);
    const Verdict verdict = player.compareAll();
    EXPECT_TRUE(verdict.matches);
    EXPECT_EQ(verdict.differingTicks, 0u) << verdict.firstDifferingTick;
    EXPECT_EQ(player.skippedSteps(), 0u);
    const Recovered again = recover(file);
    EXPECT_EQ(again.history.undoSteps(), 1u);
    EXPECT_EQ(again.history.redoSteps(), steps - 1);
}

TEST(SessionPlayer, strokesCanBeUndoneAfterARecovery) {
    const test::TemporaryFolder folder;
    const Recovered recovered = recover(recorded().file());
    const SimulationSetup station = makeSimulation(recovered.toothCase, recovered.settings, false);
    EXPECT_EQ(recovered.history.undoSteps(), 2u);
    undoAll(station, recovered.state, recovered.history, 2, folder.path() / "next.h5");
    playsAgain(folder.path() / "next.h5", 2);

    const Recovered cutOff = recover(recorded().cutOff());
    EXPECT_GE(cutOff.history.undoSteps(), 1u);
    undoAll(station, cutOff.state, cutOff.history, cutOff.history.undoSteps(), folder.path() / "other.h5");
}

TEST(SessionPlayer, strokesCanBeUndoneInAnotherField) {
    const test::TemporaryFolder folder;
    field::FieldSettings field = blockSettings().field;
    field.voxelMm = 0.05;
    const Recut recut = recutAt(recorded().file(), field, false);
    EXPECT_EQ(recut.history.undoSteps(), 2u);
    undoAll(recut.station, recut.state, recut.history, 2, folder.path() / "next.h5");
    playsAgain(folder.path() / "next.h5", 2);
}

TEST(SessionPlayer, strokesOfADamagedSessionAreOneError) {
    const Recovered recovered = recover(recorded().file());
    const SimulationSetup station = makeSimulation(recovered.toothCase, recovered.settings, false);
    const KeptHistory kept = keepHistory(recovered.history, recovered.state, station);
    ASSERT_GT(kept.bytes.size(), 600u);
    const auto decode = [&](std::span<const std::byte> bytes) {
        (void)decodeHistory(bytes, recovered.state, station, "here");
    };
    EXPECT_NO_THROW(decode(kept.bytes));
    for (const std::size_t size : {std::size_t{0}, std::size_t{3}, std::size_t{20}, kept.bytes.size() - 1})
        EXPECT_THROW(decode(std::span(kept.bytes).first(size)), core::Error) << size;
    for (const std::size_t at : {0u, 4u, 12u, 20u, 30u, 500u}) {
        std::vector<std::byte> hurt = kept.bytes;
        hurt[at] ^= std::byte{0x55};
        EXPECT_THROW(decode(hurt), core::Error) << at;
    }
}

TEST(SessionPlayer, whatStandsAroundTheToothIsInTheSession) {
    const test::TemporaryFolder folder;
    cases::Case around = blockCase();
    cases::Part gum;
    gum.tissue = cases::Tissue::gum;
    gum.name = "gum";
    gum.mesh = test::boxMesh(core::Vec3(-4, -4, -4), core::Vec3(4, 4, -2));
    around.scenery.push_back(gum);
    LiveSessionSettings settings;
    settings.sessionFile = folder.path() / "session.h5";
    {
        LiveSession liveSession(blockStation(), around, handOf(twoHoles()), settings, nullptr);
        ASSERT_TRUE(waitUntil(liveSession, 0.1));
    }
    const SessionPlayer player(settings.sessionFile, kUnseen);
    ASSERT_EQ(player.toothCase().scenery.size(), 1u);
    EXPECT_EQ(player.toothCase().scenery[0].tissue, cases::Tissue::gum);
    EXPECT_EQ(player.toothCase().scenery[0].mesh.triangles.size(), gum.mesh.triangles.size());
    EXPECT_EQ(player.toothCase().parts.size(), 1u);
}

TEST(SessionPlayer, hullAndFieldInOneSession) {
    const test::TemporaryFolder folder;
    LiveSessionSettings settings;
    settings.sessionFile = folder.path() / "session.h5";
    SimulationSetup station = blockStation();
    // Up at first: the hull is for an uncut tooth at rest.
    std::vector<device::TimedPose> poses = twoHoles().poses();
    for (device::TimedPose& p : poses)
        if (p.timeS < 1.7) p.pedal = 0.0;
    {
        const auto lead = std::make_shared<Lead>();
        LiveSession liveSession(station, blockCase(), handOf(device::Motion(poses), lead), settings, nullptr);
        const auto feed = liveSession.subscribe();
        liveSession.setHullMethod(true);
        EXPECT_TRUE(waitUntilTaken(*feed, 1));
        EXPECT_TRUE(leadTo(liveSession, *lead, 1.3));
        EXPECT_TRUE(liveSession.status().hull);
        liveSession.setBur(burOf("pear:1.0x2.5"), {});
        liveSession.setHullMethod(false);
        EXPECT_TRUE(waitUntilTaken(*feed, 3));
        EXPECT_TRUE(leadTo(liveSession, *lead, 3.0));
        EXPECT_FALSE(liveSession.status().hull);
    }
    SessionPlayer player(settings.sessionFile, kUnseen);
    const Verdict verdict = player.compareAll();
    EXPECT_TRUE(verdict.matches);
    EXPECT_EQ(verdict.differingTicks, 0u) << verdict.firstDifferingTick;
    EXPECT_GT(removed(player.state().removedMm3.own), 0.05);
}

TEST(SessionPlayer, aSessionWithoutTicksOrToothIsOneError) {
    const test::TemporaryFolder folder;
    EXPECT_THROW(SessionPlayer(folder.path() / "none.h5", kUnseen), core::Error);
    session::SessionInfo info;
    info.settings = settingsJson(blockSettings());
    { session::Recorder recorder(folder.path() / "empty.h5", info); }
    EXPECT_THROW(SessionPlayer(folder.path() / "empty.h5", kUnseen), core::Error);
}

}  // namespace
}  // namespace handpiece::simulation::session_player_test
