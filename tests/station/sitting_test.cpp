// SPDX-License-Identifier: Apache-2.0
// The live sitting: what it tells, what it refuses, how it ends.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <numeric>
#include <set>

#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/record/session/session_reader.h"
#include "handpiece/senses/surface/surface.h"
#include "handpiece/tick/device/passing_device.h"
#include "station/held_button.h"
#include "station/session_player.h"
#include "station/sitting_fixture.h"
#include "support/error_of.h"

namespace handpiece::station {
namespace {

/// Waits for a notice; false when it has not come within a minute. What else was told is gone.
bool isTold(Sitting& sitting, const char* id) {
    return waitUntilTrue([&] {
        const std::vector<Notice> notices = sitting.takeNotices();
        return std::any_of(notices.begin(), notices.end(), [&](const Notice& n) { return n.id == id; });
    });
}

double removed(const tooth::CutState& state) {
    double sum = 0.0;
    for (const double v : state.removedMm3)
        sum += v;
    return sum;
}

TEST(Sitting, tellsWhatIsCutAndWhatIsShownIsWhatIsLeft) {
    const Station station = blockStation();
    const auto live = std::make_shared<LiveTooth>(station.tooth, tooth::CutState{});
    const auto lead = std::make_shared<Lead>();
    Sitting sitting(station, blockCase(), handOf(twoHoles(), lead), {}, live);
    const auto feed = sitting.subscribe();
    ASSERT_TRUE(leadTo(sitting, *lead, 1.3));
    EXPECT_GE(feed->read().timeS, 1.2);
    EXPECT_GT(feed->read().removedMm3[2], 0.0);
    EXPECT_TRUE(waitUntilTrue([&] { return sitting.status().undoSteps == 1; }));
    const tooth::CutState midway = sitting.state();
    EXPECT_GT(removed(midway), 0.1);
    ASSERT_TRUE(leadTo(sitting, *lead, 3.0));
    EXPECT_TRUE(waitUntilTrue([&] { return sitting.status().undoSteps == 2; }));
    sitting.stop();
    sitting.stop();

    const tooth::CutState state = sitting.state();
    EXPECT_GT(removed(state), removed(midway) + 0.1);
    EXPECT_EQ(tooth::stateHash(state), station.field->stateHash());
    const SittingStatus status = sitting.status();
    EXPECT_EQ(status.fault, "");
    EXPECT_EQ(status.strokes, 2u);
    EXPECT_EQ(status.undoSteps, 2u);
    EXPECT_TRUE(status.cut);
    EXPECT_FALSE(status.recording.recording);
    EXPECT_GT(status.workUs.p50, 0.0);
    const std::vector<PlotPoint> plot = sitting.takePlot();
    ASSERT_GT(plot.size(), 100u);
    EXPECT_TRUE(std::is_sorted(plot.begin(), plot.end(),
                               [](const PlotPoint& a, const PlotPoint& b) { return a.timeS < b.timeS; }));
    EXPECT_GT(std::max_element(plot.begin(), plot.end(),
                               [](const PlotPoint& a, const PlotPoint& b) { return a.forceN < b.forceN; })
                  ->forceN,
              0.1f);
    EXPECT_TRUE(sitting.takePlot().empty());

    // The surface kept up by news is that of the tooth that is left, built at once.
    tooth::CutMirror mirror(station.tooth);
    mirror.apply(state);
    const surface::MirrorSource source(mirror);
    surface::Surface fine(source, &station.tooth->tissues);
    fine.build();
    std::vector<std::shared_ptr<const surface::BrickMesh>> shown(source.grid().count());
    for (const surface::BrickUpdate& update : live->wholeSurface())
        shown[update.dense] = update.mesh;
    std::set<std::uint32_t> seen;
    const std::vector<surface::BrickUpdate> news = live->takeNews();
    EXPECT_FALSE(news.empty());
    for (const surface::BrickUpdate& update : news) {
        EXPECT_TRUE(seen.insert(update.dense).second) << "told twice";
        shown[update.dense] = update.mesh;
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
    for (const surface::BrickUpdate& update : live->wholeSurface())
        shown[update.dense] = update.mesh;
    for (const surface::BrickUpdate& update : live->takeNews())
        shown[update.dense] = update.mesh;
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

TEST(Sitting, refusesWhatCannotBeDoneNow) {
    const auto lead = std::make_shared<Lead>();
    Sitting sitting(blockStation(), blockCase(), handOf(twoHoles(), lead), {}, nullptr);
    ASSERT_TRUE(leadTo(sitting, *lead, 0.05));
    sitting.setHullMethod(true);
    EXPECT_TRUE(isTold(sitting, "hull-needs-whole-tooth"));
    EXPECT_FALSE(sitting.status().hull);
    ASSERT_TRUE(leadTo(sitting, *lead, 0.9));
    sitting.undo();
    EXPECT_TRUE(isTold(sitting, "not-while-cutting"));
    ASSERT_TRUE(leadTo(sitting, *lead, 1.25));
    sitting.setHullMethod(true);
    EXPECT_TRUE(isTold(sitting, "hull-needs-whole-tooth"));
    EXPECT_FALSE(sitting.settings().hull);
    sitting.undo();
    sitting.undo();
    sitting.setHullMethod(true);
    EXPECT_TRUE(isTold(sitting, "nothing-to-undo"));
    EXPECT_TRUE(waitUntilTrue([&] { return sitting.status().hull; }));
    sitting.redo();
    EXPECT_TRUE(isTold(sitting, "hull-only-touches"));
    ASSERT_TRUE(leadTo(sitting, *lead, 2.6));
    sitting.stop();
    EXPECT_TRUE(sitting.state().bricks.empty());
    EXPECT_THROW(sitting.setBur(nullptr, {}), core::Error);
}

TEST(Sitting, aListenerThatFailsEndsItWithAFaultAndKeepsTheCut) {
    const test::TemporaryFolder folder;
    SittingSettings settings;
    settings.sessionFile = folder.path() / "session.h5";
    const Station station = blockStation();
    Sitting sitting(station, blockCase(), handOf(twoHoles()), settings, nullptr);
    sitting.setListener([](const messages::HapticSample& sample) {
        if (std::accumulate(sample.removedMm3.begin(), sample.removedMm3.end(), 0.0) > 0.2)
            throw core::Error("no room in the head", "listener");
    });
    EXPECT_FALSE(waitUntil(sitting, 60.0));
    EXPECT_NE(sitting.status().fault.find("no room in the head"), std::string::npos);
    const tooth::CutState state = sitting.state();
    EXPECT_GT(removed(state), 0.1);
    sitting.undo();
    sitting.stop();
    const session::SessionReader reader(settings.sessionFile);
    EXPECT_TRUE(reader.isComplete());
    ASSERT_FALSE(reader.events().empty());
    EXPECT_EQ(reader.events().back().name, "end");
}

TEST(Sitting, stopsInAnyStateAndKeepsAnAttempt) {
    for (const double after : {0.0, 0.05, 0.9}) {
        const auto lead = std::make_shared<Lead>();
        Sitting sitting(blockStation(), blockCase(), handOf(twoHoles(), lead), {}, nullptr);
        ASSERT_TRUE(leadTo(sitting, *lead, after));
        if (after > 0.5) {
            const tooth::Attempt attempt = sitting.attempt("block");
            EXPECT_EQ(attempt.caseKey, tooth::contentKey(blockCase()));
            EXPECT_GT(attempt.elapsedS, 0.8);
            EXPECT_EQ(attempt.bur, "round:1.0x0.9");
            EXPECT_FALSE(attempt.state.empty());
        }
    }
}

TEST(Sitting, aFullDiskIsToldAndTheSittingGoesOn) {
    const test::TemporaryFolder folder;
    SittingSettings settings;
    settings.sessionFile = folder.path() / "session.h5";
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const auto lead = std::make_shared<Lead>();
    Sitting sitting(blockStation(), blockCase(), handOf(twoHoles(), lead), settings, nullptr);
    // A page: wherever in the file the next chunk belongs, there is no room for it.
    const rlimit full{4096, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &full), 0);
    const bool cameThrough = leadTo(sitting, *lead, 2.9), wasTold = isTold(sitting, "recording-stopped");
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    ASSERT_TRUE(cameThrough);
    EXPECT_TRUE(wasTold);
    sitting.stop();
    EXPECT_NE(sitting.status().recording.message, "");
    EXPECT_GT(removed(sitting.state()), 0.1);
}

TEST(Sitting, aSessionFileThatCannotBeBegunIsOneError) {
    SittingSettings settings;
    settings.sessionFile = "/nowhere/at/all/session.h5";
    EXPECT_THROW(Sitting(blockStation(), blockCase(), handOf(twoHoles()), settings, nullptr), core::Error);
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

TEST(Sitting, theLowerButtonHeldClearOfTheToothUndoesOnceAndIsRecorded) {
    const test::TemporaryFolder folder;
    for (const bool allowed : {true, false}) {
        const std::filesystem::path file = folder.path() / (allowed ? "undone.h5" : "kept.h5");
        const auto lead = std::make_shared<Lead>();
        const auto buttons = std::make_shared<std::atomic<std::uint32_t>>(0u);
        SittingSettings settings;
        settings.sessionFile = file;
        settings.lowerButtonUndoes = allowed;
        Sitting sitting(blockStation(), blockCase(), std::make_unique<ButtonHand>(handOf(twoHoles(), lead), buttons),
                        settings, nullptr);
        const auto feed = sitting.subscribe();
        // Gripped hard in the tooth, with the bur turning: not meant.
        ASSERT_TRUE(leadTo(sitting, *lead, 0.9));
        *buttons = kLowerButton;
        ASSERT_TRUE(waitUntil(sitting, lead->loopS + 0.8));
        EXPECT_EQ(sitting.status().undoSteps + sitting.status().redoSteps, 0u);
        *buttons = 0;
        ASSERT_TRUE(leadTo(sitting, *lead, 1.6));
        ASSERT_TRUE(waitUntilTrue([&] { return sitting.status().undoSteps == 1; }));
        // Too short.
        const double beganS = lead->loopS;
        *buttons = kLowerButton;
        ASSERT_TRUE(waitUntil(sitting, beganS + 0.1));
        *buttons = 0;
        ASSERT_TRUE(waitUntil(sitting, lead->loopS + 0.1));
        if (lead->loopS - beganS < 0.4) {
            EXPECT_EQ(sitting.status().redoSteps, 0u);
        }
        *buttons = kLowerButton;
        ASSERT_TRUE(waitUntil(sitting, lead->loopS + 1.5));
        EXPECT_TRUE(waitUntilTrue([&] { return sitting.status().redoSteps == (allowed ? 1u : 0u); }));
        EXPECT_EQ(sitting.status().undoSteps, allowed ? 0u : 1u);
        sitting.stop();
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
}  // namespace handpiece::station
