// SPDX-License-Identifier: Apache-2.0
// A tooth among others: what stands around is felt by bur and body, and cut where it can be.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "app/simulation/live_session_fixture.h"
#include "handpiece/app/simulation/live_session.h"
#include "handpiece/app/simulation/recorded_gingiva.h"
#include "handpiece/app/simulation/session_player.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/app/simulation/tissue_export.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/model/case/case_bytes.h"
#include "handpiece/model/field/brick_index.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/instrument/turbine.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/senses/radiograph/radiograph.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/loop/loop_run.h"
#include "support/closed_meshes.h"
#include "support/random.h"
#include "support/realtime_trap.h"

namespace handpiece::simulation::mouth_test {
namespace {

using core::Pose;
using core::Vec3;
using messages::HapticSample;

constexpr double kBurRadiusMm = 0.5;

/// A block to be cut, with its top at z = 0, and beside it at x = 2.2 a wider one of the same height that stands
/// turned.
cases::Case mouth() {
    cases::Case made;
    made.name = "block";
    made.outer = test::boxMesh(Vec3(-2, -1.5, -4), Vec3(2, 2, 0));
    made.parts = {{"enamel", cases::Tissue::enamel, 0, made.outer}};
    cases::PlacedTooth other;
    other.name = "beside";
    other.fdiNumber = 45;
    other.outer = test::boxMesh(Vec3(-2, -2, 0), Vec3(2, 2, 4));
    other.inCase = {{4.2, 0, 0}, core::Quat(0, 1, 0, 0)};  // half a turn about x
    made.others.push_back(other);
    return made;
}

/// Of the blocks a closed form is known however they stand: these are turned by an angle that no voxel follows.
cases::Case turnedMouth() {
    cases::Case made = mouth();
    cases::PlacedTooth& other = made.others.front();
    other.inCase = {{4.3, 0.4, -1.7}, core::Quat(0.8, 0.3, -0.2, 0.48).normalized()};
    other.outer = geometry::transformed(test::boxMesh(Vec3(2.2, -2, -4), Vec3(6.2, 2, 0)), other.inCase.inverse());
    return made;
}

SimulationSetup setupOf(const cases::Case& c, bool fullRemoval = false) {
    SimulationSettings settings;
    settings.fullRemoval = fullRemoval;
    settings.bur = std::make_shared<const instrument::Bur>(instrument::makeBur("cylinder-flat:1.0x3.0"));
    return makeSimulation(c, settings, false);
}

device::TimedPose at(double timeS, double x, double y, double z, double pedal) {
    device::TimedPose pose;
    pose.timeS = timeS;
    pose.burInTooth.positionMm = Vec3(x, y, z);
    pose.pedal = pedal;
    return pose;
}

template <class Listen>
void run(const SimulationSetup& setup, std::vector<device::TimedPose> path, const Listen& listen) {
    device::SimulatedDeviceSettings device;
    device.rigidHand = true;
    const double durationS = path.back().timeS;
    loop::HapticLoop loop(loop::LoopSettings{},
                          std::make_unique<device::SimulatedDevice>(device, device::Motion(std::move(path))),
                          setup.work(), force::defaultParameters());
    (void)loop::runSimulated(loop, durationS, listen);
}

double removedOf(const HapticSample& s) {
    double sum = 0.0;
    for (const double mm3 : s.removedMm3)
        sum += mm3;
    return sum;
}

/// What is left of a tooth of which a box was taken away, as a state that somebody else might have cut.
tooth::StateDelta without(const tooth::ToothModel& model, std::uint16_t number, const core::Box& gone) {
    const field::FieldView view = model.field.view();
    tooth::StateDelta state;
    const auto count = static_cast<std::uint32_t>(view.bricks[0] * view.bricks[1] * view.bricks[2]);
    for (std::uint32_t dense = 0; dense < count; ++dense) {
        tooth::StateDelta::Brick brick{tooth::brickId(number, dense), false, {}};
        model.uncutBrick(dense, brick.values.data());
        const std::array<std::int32_t, 3> at = field::brickAt(view.bricks, dense);
        bool isCut = false;
        for (int i = 0; i < field::kBrickValues; ++i) {
            const int node[3] = {i % field::kBrickNodes, i / field::kBrickNodes % field::kBrickNodes,
                                 i / field::kBrickNodes / field::kBrickNodes};
            double outsideMm = -1e9;
            for (int k = 0; k < 3; ++k) {
                const double x = view.originMm[k] + view.voxelMm * (field::kBrickCells * at[k] + node[k]);
                outsideMm = std::max({outsideMm, gone.min[k] - x, x - gone.max[k]});
            }
            float& value = brick.values[i];
            const auto left = static_cast<float>(std::min(-outsideMm, model.bandOutMm));
            isCut = isCut || left > value;
            value = std::max(value, left);
        }
        if (isCut) state.bricks.push_back(brick);
    }
    return state;
}

TEST(Mouth, ARadiographShowsWhatIsLeft) {
    const cases::Case whole = mouth();
    const SimulationSetup setup = setupOf(whole);
    // The beam goes along y, through 3.5 mm of the block, of which 1.25 are taken away in the middle.
    const tooth::StateDelta state = without(*setup.tooth, 0, {Vec3(-1, 0.75, -3), Vec3(1, 3, -1)});
    ASSERT_FALSE(state.bricks.empty());
    const cases::Case cut = asCut(whole, setup.teeth(), state);
    EXPECT_EQ(cut.others.front().outer.triangles.size(), whole.others.front().outer.triangles.size());
    radiograph::Projection from;
    from.centreMm = Vec3(0, 10, -2);
    from.width = from.height = 101;
    from.pixelMm = 0.1;
    const auto attenuationAt = [&](const cases::Case& c, int x, int y) {
        return -std::log(radiograph::expose(c, from, {}).at(x, y));
    };
    cases::Case thin = whole, thick = whole;
    thin.outer = thin.parts.front().mesh = test::boxMesh(Vec3(-2, -1.5, -4), Vec3(2, 0.75, 0));
    // The middle of the cavity, and beside it.
    EXPECT_NEAR(attenuationAt(cut, 50, 50) / attenuationAt(thin, 50, 50), 1.0, 0.02);
    EXPECT_NEAR(attenuationAt(cut, 65, 50) / attenuationAt(thick, 65, 50), 1.0, 0.02);
    EXPECT_LT(attenuationAt(cut, 50, 50), 0.8 * attenuationAt(thick, 50, 50));
}

TEST(Mouth, TheToothBesideHoldsTheBurAndIsNotCut) {
    cases::Case made = mouth();
    made.others.front().isCuttable = false;
    const SimulationSetup setup = setupOf(made);
    ASSERT_EQ(setup.others.size(), 1u);
    const double wall = 2.2 - kBurRadiusMm;
    HapticSample last;
    bool cut = false;
    // Into the gap between them, turning, and 0.2 mm into the other's wall; the first ends before it.
    run(setup,
        {at(0.0, 1.2, -2.6, 1.0, 0), at(0.3, 1.2, -2.6, -1.0, 1), at(0.6, wall + 0.2, -2.2, -1.0, 1),
         at(1.2, wall + 0.2, -2.2, -1.0, 1)},
        [&](const HapticSample& s) {
            last = s;
            cut = cut || (s.flags & messages::kCutting) != 0;
        });
    EXPECT_EQ(last.tooth, 1);
    EXPECT_EQ(last.tissue, static_cast<std::uint8_t>(cases::Tissue::neighbour));
    EXPECT_LT(last.forceN[0], -0.02) << "it pushes back";
    EXPECT_FALSE(cut);
    EXPECT_EQ(removedOf(last), 0.0);
}

/// Along the gap, the tip 1 mm deep, with so much room between the bur and the other's wall.
std::vector<device::TimedPose> alongTheGap(double clearanceMm) {
    const double x = 2.2 - clearanceMm - kBurRadiusMm;
    return {at(0.0, x, -4, 1.0, 0), at(0.2, x, -4, -1.0, 0), at(0.3, x, -4, -1.0, 1),
            at(1.5, x, 4, -1.0, 1), at(1.6, x, 4, -1.0, 0),  at(2.0, x, 4, 1.0, 0)};
}

TEST(Mouth, AToothBesideIsNickedWhereTheBurReachesItAndCounted) {
    for (const cases::Case& c : {mouth(), turnedMouth()}) {
        const SimulationSetup apart = setupOf(c, true);
        HapticSample last;
        run(apart, alongTheGap(0.2), [&](const HapticSample& s) { last = s; });
        EXPECT_GT(removedOf(last), 0.5) << "the box is cut";
        EXPECT_EQ(last.removedOthersMm3, 0.0);
        EXPECT_TRUE(nickedTeeth(apart).empty());

        const SimulationSetup nicked = setupOf(c, true);
        run(nicked, alongTheGap(-0.1), [&](const HapticSample& s) { last = s; });
        const std::vector<NickedTooth> teeth = nickedTeeth(nicked);
        ASSERT_EQ(teeth.size(), 1u);
        EXPECT_EQ(teeth[0].fdiNumber, 45);
        EXPECT_EQ(last.cutNeighbour, 1);
        EXPECT_DOUBLE_EQ(tooth::sumOf(teeth[0].removedMm3), last.removedOthersMm3);
        const double slot = 0.1 * 4.0 * 1.0;  // deep, long, high
        EXPECT_NEAR(last.removedOthersMm3, slot, 0.01 * slot);
        // What is left of it says the same.
        const StandingTooth& other = nicked.others.front();
        EXPECT_NEAR(tooth::sumOf(other.model->volumesMm3) - tooth::sumOf(other.field->volumesMm3()), slot, 0.01 * slot);
    }
}

TEST(Mouth, BothTeethAreUndoneDoneAgainSavedAndReplayed) {
    const test::TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "session.h5";
    const cases::Case made = turnedMouth();
    const SimulationSetup station = setupOf(made, true);
    const std::uint64_t whole = station.stateHash();
    LiveSessionSettings settings;
    settings.sessionFile = file;
    const auto lead = std::make_shared<Lead>();
    const auto live = std::make_shared<LiveTooth>(station, tooth::StateDelta{});
    LiveSession session(station, made, handOf(device::Motion(alongTheGap(-0.1)), lead), settings, live);
    const auto feed = session.subscribe();
    ASSERT_TRUE(leadTo(session, *lead, 2.0));
    ASSERT_TRUE(waitUntilTrue([&] { return session.status().undoSteps == 1; }));
    const tooth::StateDelta cut = session.state();
    EXPECT_GT(tooth::sumOf(cut.removedMm3.own), 1.0);
    EXPECT_NEAR(tooth::sumOf(cut.removedMm3.of(1)), 0.4, 0.004);
    session.undo();
    ASSERT_TRUE(waitUntilTaken(*feed, 1));
    ASSERT_TRUE(waitUntilTrue([&] { return feed->read().waitingBricks == 0; }));
    EXPECT_EQ(feed->read().removedOthersMm3, 0.0);
    EXPECT_EQ(tooth::stateHash(session.state()), whole);
    session.redo();
    ASSERT_TRUE(waitUntilTaken(*feed, 2));
    const cases::Attempt attempt = session.attempt("case");
    session.stop();
    EXPECT_EQ(tooth::stateHash(session.state()), tooth::stateHash(cut));
    EXPECT_TRUE(session.state().removedMm3 == cut.removedMm3);
    EXPECT_EQ(station.stateHash(), tooth::stateHash(cut));

    // The picture shows both, each in the frame of the tooth worked on.
    live->settle();
    (void)live->uncutSurface();
    core::Box nick;
    for (const surface::BrickUpdate& update : live->takeNews()) {
        if (tooth::toothOf(update.id) != 1 || !update.mesh) continue;
        for (const surface::SurfaceVertex& v : update.mesh->vertices)
            nick.extend(Vec3(static_cast<double>(v.positionMm[0]), static_cast<double>(v.positionMm[1]),
                             static_cast<double>(v.positionMm[2])));
    }
    EXPECT_NEAR(nick.min.x(), 2.2, 0.02);
    EXPECT_NEAR(nick.max.z(), 0.0, 0.02);

    const tooth::StateDelta saved = tooth::decodeState(attempt.state, station.teeth());
    EXPECT_EQ(tooth::stateHash(saved), tooth::stateHash(cut));
    EXPECT_TRUE(saved.removedMm3 == cut.removedMm3);
    const SimulationSetup again = setupOf(made, true);
    again.resume(saved);
    EXPECT_EQ(again.stateHash(), tooth::stateHash(cut));
    EXPECT_TRUE(again.state().removedMm3 == cut.removedMm3);

    SessionPlayer player(file, false);
    const Verdict verdict = player.compareAll();
    EXPECT_TRUE(verdict.matches);
    EXPECT_EQ(verdict.differingTicks, 0u);
    EXPECT_TRUE(player.state().removedMm3 == cut.removedMm3);
    const auto told = [&](session::EventName name) {
        return std::find_if(player.events().begin(), player.events().end(),
                            [&](const session::Event& e) { return e.name == session::nameOf(name); });
    };
    ASSERT_NE(told(session::EventName::neighbourCut), player.events().end());
    EXPECT_EQ(told(session::EventName::neighbourCut)->text, R"({"tooth": 1, "fdi": 45})");
    // To the middle by a key frame, and on: the same tooth.
    player.seek(0.1);
    EXPECT_EQ(tooth::stateHash(player.state()), whole);
    player.seek(player.durationS());
    EXPECT_EQ(tooth::stateHash(player.state()), tooth::stateHash(cut));
}

TEST(Mouth, TheHeadMeetsWhatStandsOverAndTakesThePressOffTheBur) {
    const std::vector<device::TimedPose> path{at(0.0, 0, 0, 1.5, 0), at(0.5, 0, 0, -0.5, 1), at(2.0, 0, 0, -0.5, 1)};
    double free = 0.0, held = 0.0, deepest = 1.0;
    std::uint32_t flags = 0;
    run(setupOf(mouth()), path, [&](const HapticSample& s) { free = removedOf(s); });
    // A block beside the bur that stands 9.2 mm high: the head's lower face is 9 mm over the tip.
    cases::Case low = mouth();
    cases::PlacedTooth& high = low.others.front();
    high.outer = test::boxMesh(Vec3(2, -3, 6), Vec3(6, 3, instrument::kBurReachMm + 0.2));
    high.inCase = {};
    run(setupOf(low), path, [&](const HapticSample& s) {
        held = removedOf(s);
        flags |= s.flags;
        deepest = std::min(deepest, s.proxyPositionMm[2]);
    });
    EXPECT_GT(free, 0.05);
    EXPECT_EQ(held, 0.0);
    EXPECT_TRUE((flags & messages::kHeadTouches) != 0) << "which says so";
    EXPECT_GT(deepest, 0.1) << "the bur never reached the tooth";
}

TEST(Mouth, GingivaYieldsPushesBackAndIsTornByTheBur) {
    cases::Case made = mouth();
    made.scenery = {{"gingiva", cases::Tissue::gum, 0, test::boxMesh(Vec3(-6, -8, -6), Vec3(6, -3, -1)), true},
                    {"only seen", cases::Tissue::gum, 0, test::boxMesh(Vec3(-6, -8, 2), Vec3(6, -3, 3)), false}};
    const SimulationSetup setup = setupOf(made);
    ASSERT_EQ(setup.others.size(), 2u);
    // Down onto it, away from the teeth: 0.4 mm deep with the bur at rest, then turning.
    HapticSample still, last;
    run(setup,
        {at(0.0, 0, -5.5, 0.5, 0), at(0.4, 0, -5.5, -1.4, 0), at(1.2, 0, -5.5, -1.4, 0), at(1.21, 0, -5.5, -1.4, 1),
         at(2.0, 0, -5.5, -1.4, 1)},
        [&](const HapticSample& s) {
            if (s.timeS < 1.15) still = s;
            last = s;
        });
    const cases::TissueProperties& gum = cases::properties(cases::Tissue::gum);
    const double stiffness = gum.stiffnessFraction * device::Capability{}.maxStiffnessNPerMm;
    EXPECT_NEAR(still.forceN[2], 0.4 * stiffness, 0.02 * stiffness) << "a spring of its own, at rest";
    EXPECT_EQ(still.flags & (messages::kPressesGingiva | messages::kCutsGingiva), messages::kPressesGingiva);
    EXPECT_NEAR(still.proxyPositionMm[2], -1.4, 1e-6) << "it holds nothing off";
    EXPECT_TRUE((last.flags & messages::kCutsGingiva) != 0);
    EXPECT_EQ(removedOf(last), 0.0);
}

TEST(Mouth, WhereGingivaWasCutIsTheSameInAReplayAndWholeAfterAReset) {
    const test::TemporaryFolder folder;
    cases::Case made = mouth();
    made.scenery = {{"gingiva", cases::Tissue::gum, 0, test::boxMesh(Vec3(-6, -8, -6), Vec3(6, -3, -1)), true}};
    // Along in the gingiva, then into the tooth, so that there is something to be made whole.
    std::vector<device::TimedPose> path{
        at(0.0, -2, -5.5, 0.5, 1), at(0.3, -2, -5.5, -1.4, 1), at(0.9, 0, -5.5, -1.3, 1),
        at(1.0, 0, -5.5, 0.5, 1),  at(1.3, 0, 0, 0.5, 1),      at(1.6, 0, 0, -0.1, 1),
        at(1.8, 0, 0, 0.5, 1),     at(1.801, 0, 0, 0.5, 0),    at(3.0, 0, 0, 0.6, 0)};
    const SimulationSetup station = setupOf(made, true);
    LiveSessionSettings settings;
    settings.sessionFile = folder.path() / "session.h5";
    const auto lead = std::make_shared<Lead>();
    const auto live = std::make_shared<LiveTooth>(station, tooth::StateDelta{});
    LiveSession session(station, made, handOf(device::Motion(std::move(path)), lead), settings, live);
    const auto feed = session.subscribe();
    ASSERT_TRUE(leadTo(session, *lead, 2.2));
    const std::vector<messages::GingivaCut> cuts = live->gingiva().all();
    // Two millimetres along it, in steps of a fifth.
    ASSERT_GE(cuts.size(), 10u);
    ASSERT_LE(cuts.size(), 20u);
    EXPECT_NEAR(cuts.back().tipMm[0] - cuts.front().tipMm[0], 2.0, 0.3);
    EXPECT_EQ(cuts.front().stationRadiusMm.front(), 0.5) << "a flat end";
    session.undo();
    ASSERT_TRUE(waitUntilTaken(*feed, 1));
    EXPECT_EQ(live->gingiva().all(), cuts) << "no step back heals it";
    session.redo();
    ASSERT_TRUE(waitUntilTaken(*feed, 2));
    session.reset();
    ASSERT_TRUE(waitUntilTaken(*feed, 3));
    EXPECT_TRUE(live->gingiva().isEmpty());
    session.stop();

    SessionPlayer player(settings.sessionFile, false);
    player.seek(2.1);
    EXPECT_EQ(player.tooth()->gingiva().all(), cuts);
    player.seek(0.6);
    const std::size_t some = player.tooth()->gingiva().all().size();
    EXPECT_GT(some, 2u);
    EXPECT_LT(some, cuts.size());
    player.seek(player.durationS());
    EXPECT_TRUE(player.tooth()->gingiva().isEmpty());
    // What is jumped over is read, and stands nearly where it was.
    GingivaCuts recorded;
    hearRecorded(recorded, player.reader(), player.events(), station.settings, 2100, "session");
    EXPECT_NEAR(static_cast<double>(recorded.all().size()), static_cast<double>(cuts.size()), 1.0);
    hearRecorded(recorded, player.reader(), player.events(), station.settings, 1u << 30, "session");
    EXPECT_TRUE(recorded.isEmpty());
}

TEST(Mouth, BoneUnderTheGingivaHoldsTheBurOffAndIsNoTooth) {
    cases::Case made = mouth();
    made.scenery = {{"gingiva", cases::Tissue::gum, 0, test::boxMesh(Vec3(-6, -8, -6), Vec3(6, -3, -1)), true},
                    {"bone", cases::Tissue::bone, 1, test::boxMesh(Vec3(-6, -8, -6), Vec3(6, -3.5, -2)), true}};
    const SimulationSetup setup = setupOf(made);
    HapticSample last;
    bool touchedTooth = false;
    run(setup, {at(0.0, 0, -5.5, 0.5, 0), at(0.6, 0, -5.5, -2.3, 0), at(1.2, 0.4, -5.5, -2.3, 1)},
        [&](const HapticSample& s) {
            touchedTooth = touchedTooth || s.touchedNeighbour != 0;
            last = s;
        });
    EXPECT_NEAR(last.proxyPositionMm[2], -2.0, 1e-3) << "through the gingiva and no farther";
    EXPECT_EQ(last.tissue, static_cast<std::uint8_t>(cases::Tissue::bone));
    EXPECT_TRUE((last.flags & messages::kPressesGingiva) != 0);
    const double gumN =
        cases::properties(cases::Tissue::gum).stiffnessFraction * device::Capability{}.maxStiffnessNPerMm * 1.0;
    EXPECT_GT(last.forceN[2], 2.0 * gumN) << "bone is harder";
    EXPECT_FALSE(touchedTooth);
    EXPECT_EQ(removedOf(last), 0.0) << "bone takes no cut";
}

TEST(Mouth, ASessionCarriesAllThatWasFelt) {
    cases::Case made = mouth();
    made.scenery = {{"gingiva", cases::Tissue::gum, 0, test::boxMesh(Vec3(-6, -8, -6), Vec3(6, -3, -1)), true}};
    const SimulationSetup before = setupOf(made), after = setupOf(cases::decodeCase(cases::encodeCase(made), "test"));
    const std::vector<device::TimedPose> path{at(0.0, 1.2, -2.6, 1.0, 0), at(0.3, 1.2, -2.7, -1.2, 1),
                                              at(0.8, 1.9, -2.4, -1.4, 1)};
    std::vector<std::array<double, 3>> forces[2];
    for (int i = 0; i < 2; ++i)
        run(i == 0 ? before : after, path, [&](const HapticSample& s) { forces[i].push_back(s.forceN); });
    EXPECT_EQ(forces[0], forces[1]);
    EXPECT_GT(forces[0].size(), 500u);
}

}  // namespace
}  // namespace handpiece::simulation::mouth_test
