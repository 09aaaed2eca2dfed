// SPDX-License-Identifier: Apache-2.0
// sitting_child FILE: cuts a hole and then a long groove into a block until it is killed, and records it.
#include <chrono>
#include <cstdio>
#include <thread>

#include "app/simulation/live_session_fixture.h"
#include "handpiece/base/core/error.h"

int main(int argc, char** argv) {
    using namespace handpiece;
    if (argc != 2) return 2;
    const auto at = [](double timeS, double x, double z, double pedal) {
        return device::TimedPose{timeS, {core::Vec3(x, 0, z), core::Quat::Identity()}, pedal};
    };
    try {
        simulation::LiveSessionSettings settings;
        settings.sessionFile = argv[1];
        settings.code = "child";
        const simulation::LiveSession liveSession(
            simulation::blockStation(), simulation::blockCase(),
            simulation::handOf(
                device::Motion({at(0.0, -0.9, 0.3, 1), at(0.2, -0.9, 0.3, 1), at(0.4, -0.9, -0.8, 1),
                                at(0.9, -0.9, 0.3, 1), at(0.901, -0.9, 0.3, 0), at(1.2, 0.1, 0.3, 0),
                                at(1.201, 0.1, 0.3, 1), at(1.5, 0.1, -0.6, 1), at(120.0, 1.6, -0.6, 1)})),
            settings, nullptr);
        for (;;)
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
    } catch (const core::Error& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
