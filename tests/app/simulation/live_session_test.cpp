// SPDX-License-Identifier: Apache-2.0
// The live sitting: what it tells, what it refuses, how it ends.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <numeric>
#include <set>

#include "app/simulation/live_session_fixture.h"
#include "handpiece/app/input/held_button.h"
#include "handpiece/app/simulation/session_player.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/record/session/session_reader.h"
#include "handpiece/senses/surface/surface.h"
#include "handpiece/tick/device/passing_device.h"
#include "support/error_of.h"

namespace handpiece::simulation::live_session_test {
namespace {

/// Waits for a notice; false when it has not come within a minute. What else was told is gone.
bool isTold(LiveSession& liveSession, const char* id) {
    return waitUntilTrue([&] {
        const std::vector<Notice> notices = liveSession.takeNotices();
        return std::any_of(notices.begin(), notices.end(), [&](const Notice& n) { return n.id == id; });
    });
}

double removed(const tooth::StateDelta& state) {
    double sum = 0.0;
    for (const double v : state.removedMm3.own)
        sum += v;
    return sum;
}

TEST(LiveSession, tellsWhatIsCutAndWhatIsShownIsWhatIsLeft) {
    const SimulationSetup station = blockStation();
    const auto live = std::make_shared<LiveTooth>(station.tooth, tooth::StateDelta{});
    const auto lead = std::make_shared<Lead>();
    LiveSession liveSession(station, blockCase(), handOf(twoHoles(), lead), {}, live);
    const auto feed = liveSession.subscribe();
    ASSERT_TRUE(leadTo(liveSession, *lead, 1.3));
    EXPECT_GE(feed->read().timeS, 1.2);
    EXPECT_GT(feed->read().removedMm3[2], 0.0);
    EXPECT_TRUE(waitUntilTrue([&] { return liveSession.status().undoSteps == 1; }));
    const tooth::StateDelta midway = liveSession.state();
    EXPECT_GT(removed(midway), 0.1);
    ASSERT_TRUE(leadTo(liveSession, *lead, 3.0));
    EXPECT_TRUE(waitUntilTrue([&] { return liveSession.status().undoSteps == 2; }));
    liveSession.stop();
    liveSession.stop();

    const tooth::StateDelta state = liveSession.state();
    EXPECT_GT(removed(state), removed(midway) + 0.1);
    EXPECT_EQ(tooth::stateHash(state), station.field->stateHash());
    const LiveSessionStatus status = liveSession.status();
    EXPECT_EQ(status.fault, "");
    EXPECT_EQ(status.strokes, 2u);
    EXPECT_EQ(status.undoSteps, 2u);
    EXPECT_TRUE(status.cut);
    EXPECT_FALSE(status.recording.recording);
    EXPECT_GT(status.workUs.p50, 0.0);
    const std::vector<PlotPoint> plot = liveSession.takePlot();
    ASSERT_GT(plot.size(), 100u);
    EXPECT_TRUE(std::is_sorted(plot.begin(), plot.end(),
                               [](const PlotPoint& a, const PlotPoint& b) { return a.timeS < b.timeS; }));
    EXPECT_GT(std::max_element(plot.begin(), plot.end(),
                               [](const PlotPoint& a, const PlotPoint& b) { return a.forceN < b.forceN; })
                  ->forceN,
              0.1f);
    EXPECT_TRUE(liveSession.takePlot().empty());

    // The surface kept up by news is that of the tooth that is left, built at once.
    tooth::ToothMirror mirror(station.tooth);
    mirror.apply(state);
    const surface::MirrorSource source(mirror);
    surface::Surface fine(source, &station.tooth->tissues);
    fine.build();
    std::vector<std::shared_ptr<const surface::BrickMesh>> shown(source.grid().count());
    for (const surface::BrickUpdate& update : live->uncutSurface())
        shown[update.id] = update.mesh;
    std::set<std::uint32_t> seen;
    const std::vector<surface::BrickUpdate> news = live->takeNews();
    EXPECT_FALSE(news.empty());
    for (const surface::BrickUpdate& update : news) {
        EXPECT_TRUE(seen.insert(update.id).second) << "told twice";
        shown[update.id] = update.mesh;
    }
    for (std::uint32_t dense = 0; dense < shown.size(); ++dense) {
        const auto expected = fine.mesh(dense);
        ASSERT_EQ(expected == nullptr, shown[dense] == nullptr) << dense;
        ASSERT_TRUE(expected == nullptr || *expected == *shown[dense]) << dense;
    }
    EXPECT_FALSE(live->hasNews());
    EXPECT_EQ(tooth::stateHash(live->state({})), tooth::stateHash(state));

    // Another window over the same tooth shows the same.
    shown.assign(shown.size(), nullptr);
    for (const surface::BrickUpdate& update : live->uncutSurface())
        shown[update.id] = update.mesh;
    for (const surface::BrickUpdate& update : live->takeNews())
        shown[update.id] = update.mesh;
    for (std::uint32_t dense = 0; dense < shown.size(); ++dense) {
        const auto expected = fine.mesh(dense);
        ASSERT_EQ(expected == nullptr, shown[dense] == nullptr) << dense;
        ASSERT_TRUE(expected == nullptr || *expected == *shown[dense]) << dense;
    }

    live->wantRemovedDepths(true);
    live->refresh();
    float deepest = 0.0f;
    for (const surface::BrickUpdate& update : live->takeNews())
        if (update.removedDepthMm) {
            ASSERT_EQ(update.removedDepthMm->size(), update.mesh->vertices.size());
            for (const float d : *update.removedDepthMm)
                deepest = std::max(deepest, d);
        }
    EXPECT_GT(deepest, 0.2f);
    EXPECT_LT(deepest, 1.3f);
}

TEST(LiveSession, refusesWhatCannotBeDoneNow) {
    const auto lead = std::make_shared<Lead>();
    LiveSession liveSession(blockStation(), blockCase(), handOf(twoHoles(), lead), {}, nullptr);
    ASSERT_TRUE(leadTo(liveSession, *lead, 0.05));
    liveSession.setHullMethod(true);
    EXPECT_TRUE(isTold(liveSession, "hull-needs-whole-tooth"));
    EXPECT_FALSE(liveSession.status().hull);
    ASSERT_TRUE(leadTo(liveSession, *lead, 0.9));
    liveSession.undo();
    EXPECT_TRUE(isTold(liveSession, "not-while-cutting"));
    ASSERT_TRUE(leadTo(liveSession, *lead, 1.25));
    liveSession.setHullMethod(true);
    EXPECT_TRUE(isTold(liveSession, "hull-needs-whole-tooth"));
    EXPECT_FALSE(liveSession.settings().hull);
    liveSession.undo();
    liveSession.undo();
    liveSession.setHullMethod(true);
    EXPECT_TRUE(isTold(liveSession, "nothing-to-undo"));
    EXPECT_TRUE(waitUntilTrue([&] { return liveSession.status().hull; }));
    liveSession.redo();
    EXPECT_TRUE(isTold(liveSession, "hull-only-touches"));
    ASSERT_TRUE(leadTo(liveSession, *lead, 2.6));
    liveSession.stop();
    EXPECT_TRUE(liveSession.state().bricks.empty());
    EXPECT_THROW(liveSession.setBur(nullptr, {}), core::Error);
}

TEST(LiveSession, aListenerThatFailsEndsItWithAFaultAndKeepsTheCut) {
    const test::TemporaryFolder folder;
    LiveSessionSettings settings;
    settings.sessionFile = folder.path() / "session.h5";
    const SimulationSetup station = blockStation();
    LiveSession liveSession(station, blockCase(), handOf(twoHoles()), settings, nullptr);
    liveSession.setListener([](const messages::HapticSample& sample) {
        if (std::accumulate(sample.removedMm3.begin(), sample.removedMm3.end(), 0.0) > 0.2)
            throw core::Error("no room in the head", "listener");
    });
    EXPECT_FALSE(waitUntil(liveSession, 60.0));
    EXPECT_NE(liveSession.status().fault.find("no room in the head"), std::string::npos);
    const tooth::StateDelta state = liveSession.state();
    EXPECT_GT(removed(state), 0.1);
    liveSession.undo();
    liveSession.stop();
    const session::SessionReader reader(settings.sessionFile);
    EXPECT_TRUE(reader.isComplete());
    const std::vector<session::Event> events = reader.events();
    ASSERT_FALSE(events.empty());
    EXPECT_EQ(events.back().name, "end");
    const std::string granted = rt::nameOf(liveSession.status().scheduling.scheduling);
    EXPECT_NE(granted, "not-asked");
    EXPECT_TRUE(std::any_of(events.begin(), events.end(), [&](const session::Event& e) {
        return e.name == "scheduling" && e.text == R"({"class": ")" + granted + "\"}";
    }));
}

TEST(LiveSession, stopsInAnyStateAndKeepsAnAttempt) {
    for (const double after : {0.0, 0.05, 0.9}) {
        const auto lead = std::make_shared<Lead>();
        LiveSession liveSession(blockStation(), blockCase(), handOf(twoHoles(), lead), {}, nullptr);
        ASSERT_TRUE(leadTo(liveSession, *lead, after));
        if (after > 0.5) {
            const cases::Attempt attempt = liveSession.attempt("block");
            EXPECT_EQ(attempt.caseKey, cases::contentKey(blockCase()));
            EXPECT_GT(attempt.elapsedS, 0.8);
            EXPECT_EQ(attempt.bur, "round:1.0x0.9");
            EXPECT_FALSE(attempt.state.empty());
        }
    }
}

TEST(LiveSession, aFullDiskIsToldAndTheSittingGoesOn) {
    const test::TemporaryFolder folder;
    LiveSessionSettings settings;
    settings.sessionFile = folder.path() / "session.h5";
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const auto lead = std::make_shared<Lead>();
    LiveSession liveSession(blockStation(), blockCase(), handOf(twoHoles(), lead), settings, nullptr);
    // A page: wherever in the file the next chunk belongs, there is no room for it.
    const rlimit full{4096, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &full), 0);
    const bool cameThrough = leadTo(liveSession, *lead, 2.9), wasTold = isTold(liveSession, "recording-stopped");
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    ASSERT_TRUE(cameThrough);
    EXPECT_TRUE(wasTold);
    liveSession.stop();
    EXPECT_NE(liveSession.status().recording.message, "");
    EXPECT_GT(removed(liveSession.state()), 0.1);
}

TEST(LiveSession, aSessionFileThatCannotBeBegunIsOneError) {
    LiveSessionSettings settings;
    settings.sessionFile = "/nowhere/at/all/session.h5";
    EXPECT_THROW(LiveSession(blockStation(), blockCase(), handOf(twoHoles()), settings, nullptr), core::Error);
}

/// A led hand with a button under its finger.
class ButtonHand final : public device::PassingDevice {
  public:
    ButtonHand(std::unique_ptr<device::Device> hand, std::shared_ptr<std::atomic<std::uint32_t>> buttons)
        : PassingDevice(std::move(hand)), buttons_(std::move(buttons)) {}
    device::Reading read(double periodS) noexcept override {
        device::Reading reading = PassingDevice::read(periodS);
        reading.buttons = *buttons_;
        return reading;
    }

  private:
    std::shared_ptr<std::atomic<std::uint32_t>> buttons_;
};

TEST(LiveSession, theLowerButtonHeldClearOfTheToothUndoesOnceAndIsRecorded) {
    const test::TemporaryFolder folder;
    for (const bool allowed : {true, false}) {
        const std::filesystem::path file = folder.path() / (allowed ? "undone.h5" : "kept.h5");
        const auto lead = std::make_shared<Lead>();
        const auto buttons = std::make_shared<std::atomic<std::uint32_t>>(0u);
        LiveSessionSettings settings;
        settings.sessionFile = file;
        settings.lowerButtonUndoes = allowed;
        LiveSession liveSession(blockStation(), blockCase(),
                                std::make_unique<ButtonHand>(handOf(twoHoles(), lead), buttons), settings, nullptr);
        const auto feed = liveSession.subscribe();
        // Gripped hard in the tooth, with the bur turning: not meant.
        ASSERT_TRUE(leadTo(liveSession, *lead, 0.9));
        *buttons = input::kLowerButton;
        ASSERT_TRUE(waitUntil(liveSession, lead->loopS + 0.8));
        EXPECT_EQ(liveSession.status().undoSteps + liveSession.status().redoSteps, 0u);
        *buttons = 0;
        ASSERT_TRUE(leadTo(liveSession, *lead, 1.6));
        ASSERT_TRUE(waitUntilTrue([&] { return liveSession.status().undoSteps == 1; }));
        // Too short.
        const double beganS = lead->loopS;
        *buttons = input::kLowerButton;
        ASSERT_TRUE(waitUntil(liveSession, beganS + 0.1));
        *buttons = 0;
        ASSERT_TRUE(waitUntil(liveSession, lead->loopS + 0.1));
        if (lead->loopS - beganS < 0.4) {
            EXPECT_EQ(liveSession.status().redoSteps, 0u);
        }
        *buttons = input::kLowerButton;
        ASSERT_TRUE(waitUntil(liveSession, lead->loopS + 1.5));
        EXPECT_TRUE(waitUntilTrue([&] { return liveSession.status().redoSteps == (allowed ? 1u : 0u); }));
        EXPECT_EQ(liveSession.status().undoSteps, allowed ? 0u : 1u);
        liveSession.stop();
        std::size_t undone = 0;
        for (const session::Event& event : session::SessionReader(file).events())
            undone += event.name == session::nameOf(session::EventName::undo) ? 1u : 0u;
        EXPECT_EQ(undone, allowed ? 1u : 0u);
        // What was recorded plays again.
        SessionPlayer player(file, false);
        EXPECT_EQ(player.compareAll().differingTicks, 0u);
    }
}

}  // namespace
}  // namespace handpiece::simulation::live_session_test
