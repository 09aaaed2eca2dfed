// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A block of enamel over dentine, a hand that cuts two holes in three seconds, and a sitting at it.

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "app/simulation/led_hand.h"
#include "handpiece/app/simulation/live_session.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/instrument/shapes.h"
#include "support/closed_meshes.h"
#include "support/random.h"

namespace handpiece::simulation {

inline cases::Case blockCase() {
    using core::Vec3;
    cases::Case made;
    made.name = "block";
    made.outer = test::boxMesh(Vec3(-2, -1.5, -2), Vec3(2, 1.5, 0));
    cases::Part dentine;
    dentine.tissue = cases::Tissue::dentine;
    dentine.name = "dentine";
    dentine.priority = 1;
    dentine.mesh = test::boxMesh(Vec3(-1.9, -1.4, -1.9), Vec3(1.9, 1.4, -0.3));
    made.parts.push_back(std::move(dentine));
    return made;
}

inline std::shared_ptr<const instrument::Bur> burOf(const char* shape) {
    return std::make_shared<const instrument::Bur>(instrument::makeBur(shape));
}

inline SimulationSettings blockSettings() {
    SimulationSettings settings;
    settings.field.voxelMm = 0.08;
    settings.bur = burOf("round:1.0x0.9");
    return settings;
}

inline SimulationSetup blockStation() {
    return makeSimulation(blockCase(), blockSettings(), false);
}

/// Down at x = -0.9 until 1.1 s, and at x = 0.9 from 1.8 to 2.8 s, the pedal up in between.
inline device::Motion twoHoles() {
    const auto at = [](double timeS, double x, double z, double pedal) {
        return device::TimedPose{timeS, {core::Vec3(x, 0, z), core::Quat::Identity()}, pedal};
    };
    return device::Motion({at(0.0, -0.9, 0.3, 1), at(0.4, -0.9, 0.3, 1), at(0.7, -0.9, -1.8, 1), at(1.0, -0.9, -1.8, 1),
                           at(1.1, -0.9, 0.3, 1), at(1.101, -0.9, 0.3, 0), at(1.5, -0.9, 0.4, 0), at(1.7, 0.9, 0.3, 0),
                           at(1.701, 0.9, 0.3, 1), at(2.0, 0.9, 0.3, 1), at(2.2, 0.9, -1.8, 1), at(2.6, 0.9, -1.8, 1),
                           at(2.8, 0.9, 0.3, 1), at(2.801, 0.9, 0.3, 0), at(3.2, 0.9, 0.3, 0)});
}

/// One of 1.1 s at this x, the pedal up from then on.
inline device::Motion hole(double x) {
    const auto at = [x](double timeS, double z, double pedal) {
        return device::TimedPose{timeS, {core::Vec3(x, 0, z), core::Quat::Identity()}, pedal};
    };
    return device::Motion({at(0.0, 0.3, 1), at(0.4, 0.3, 1), at(0.7, -1.8, 1), at(1.0, -1.8, 1), at(1.1, 0.3, 1),
                           at(1.101, 0.3, 0), at(3.0, 0.4, 0)});
}

inline std::unique_ptr<device::Device> handOf(device::Motion motion, std::shared_ptr<Lead> lead = nullptr) {
    return std::make_unique<LedHand>(std::move(motion), std::move(lead));
}

/// Asks until it is so; false when a minute has passed.
template <typename Condition>
bool waitUntilTrue(Condition&& isSo) {
    for (int i = 0; i < 12000; ++i) {
        if (isSo()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
}

/// Waits until the sitting has come so far; false when it has ended or a minute has passed.
inline bool waitUntil(const LiveSession& liveSession, double timeS) {
    LiveSessionStatus now;
    const auto hasCome = [&] {
        now = liveSession.status();
        return !now.fault.empty() || now.timeS >= timeS;
    };
    return waitUntilTrue(hasCome) && now.fault.empty();
}

/// Leads the hand on to a moment of its motion and waits until the sitting has heard of it; false when it has ended or
/// a minute has passed.
inline bool leadTo(const LiveSession& liveSession, Lead& lead, double motionS) {
    lead.untilS = motionS;
    const auto hasCome = [&] { return lead.atS >= motionS || !liveSession.status().fault.empty(); };
    return waitUntilTrue(hasCome) && waitUntil(liveSession, lead.loopS - 1e-6);
}

/// Waits until a tick has taken this many of the sitting's changes and steps, and has put what they change in place.
inline bool waitUntilTaken(SampleFeed& feed, std::uint64_t commands) {
    return waitUntilTrue([&] {
        const messages::HapticSample& sample = feed.read();
        return sample.lastCommand >= commands && (sample.flags & messages::kRestoring) == 0;
    });
}

/// Copies a file that grows meanwhile, between two of its writes.
inline void copyGrowing(const std::filesystem::path& from, const std::filesystem::path& to) {
    std::filesystem::file_time_type before;
    do {
        before = std::filesystem::last_write_time(from);
        std::filesystem::copy_file(from, to, std::filesystem::copy_options::overwrite_existing);
    } while (std::filesystem::last_write_time(from) != before);
}

/// Three seconds of work in which all changes that can. Returns the state at the end.
inline tooth::StateDelta workThreeSeconds(const std::filesystem::path& file,
                                          const std::filesystem::path& copyAt2700ms = {}) {
    const SimulationSetup station = blockStation();
    LiveSessionSettings settings;
    settings.sessionFile = file;
    settings.code = "test";
    const auto lead = std::make_shared<Lead>();
    LiveSession liveSession(station, blockCase(), handOf(twoHoles(), lead), settings, nullptr);
    const auto feed = liveSession.subscribe();
    force::Parameters parameters = station.settings.parameters;
    parameters.stiffnessMultiplier = 0.7;
    EXPECT_TRUE(leadTo(liveSession, *lead, 0.7));
    liveSession.setParameters(parameters);
    EXPECT_TRUE(waitUntilTaken(*feed, 1));
    EXPECT_TRUE(leadTo(liveSession, *lead, 1.15));
    EXPECT_TRUE(waitUntilTrue([&] { return liveSession.status().undoSteps == 1; }));
    liveSession.undo();
    liveSession.redo();
    liveSession.undo();
    liveSession.setBur(burOf("cylinder-flat:1.2x4"), instrument::abilityByName("diamond-medium"));
    liveSession.setDrive(instrument::driveByName("speed-increasing"));
    EXPECT_TRUE(waitUntilTaken(*feed, 6));
    EXPECT_TRUE(leadTo(liveSession, *lead, 1.4));
    liveSession.redo();
    EXPECT_TRUE(waitUntilTaken(*feed, 7));
    EXPECT_TRUE(leadTo(liveSession, *lead, 2.2));
    parameters.stiffnessMultiplier = 1.0;
    parameters.frictionMultiplier = 0.5;
    liveSession.setParameters(parameters);
    liveSession.setDrive(instrument::driveByName("turbine"));
    EXPECT_TRUE(waitUntilTaken(*feed, 9));
    EXPECT_TRUE(leadTo(liveSession, *lead, 2.7));
    if (!copyAt2700ms.empty()) {
        // By then the first stroke and more than half of the work are in the file.
        EXPECT_TRUE(waitUntilTrue([&] { return liveSession.status().recording.writtenRecords > 2000; }));
        copyGrowing(file, copyAt2700ms);
    }
    EXPECT_TRUE(leadTo(liveSession, *lead, 3.1));
    liveSession.stop();
    return liveSession.state();
}

}  // namespace handpiece::simulation
