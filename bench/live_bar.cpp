// SPDX-License-Identifier: Apache-2.0
// What the live bar costs the tick: the same sitting with and without a thread that counts zones, by turns.
#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <ctime>
#include <thread>
#include <vector>

#include "handpiece/app/course/live_shares.h"
#include "handpiece/app/course/shipped_exercises.h"
#include "handpiece/app/simulation/live_session.h"
#include "handpiece/base/rt/realtime_thread.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/tick/device/simulated_device.h"

namespace {

using namespace handpiece;

double threadMs() {
    std::timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Along the line of the block and back, a little deeper each time.
device::Motion alongTheLine(double lastsS) {
    std::vector<device::TimedPose> poses;
    for (double t = 0.0; t <= lastsS; t += 1.0) {
        const double x = static_cast<long>(t) % 2 == 0 ? -3.0 : 3.0;
        poses.push_back({t, {core::Vec3(x, 0.0, 0.3 - 1.6 * t / lastsS), core::Quat::Identity()}, 1.0});
    }
    return device::Motion(std::move(poses));
}

struct Run {
    loop::Spread workUs;
    std::uint64_t ticks = 0;
    int counts = 0;
    double countMs = 0.0, removedMm3 = 0.0;
};

Run sit(const tasks::Task& task, const preparation::Laid& laid, const simulation::SimulationSetup& made, double lastsS,
        bool counts) {
    simulation::SimulationSetup station = made;
    station.renewFields();
    const auto tooth = std::make_shared<simulation::LiveTooth>(station, tooth::StateDelta{});
    auto hand = std::make_unique<device::SimulatedDevice>(device::SimulatedDeviceSettings{}, alongTheLine(lastsS));
    simulation::LiveSession session(station, task.toothCase, std::move(hand), {}, tooth);
    std::atomic<bool> isOver{false};
    Run run;
    const zones::WholeVolumes whole = zones::wholeVolumes(*laid.zones, *station.tooth);
    std::thread counter([&] {
        rt::stepBack();
        while (counts && !isOver) {
            const double begun = threadMs();
            run.removedMm3 = course::liveShares(*laid.zones, whole, *tooth).targetRemoved;
            run.countMs += threadMs() - begun;
            ++run.counts;
            std::this_thread::sleep_for(std::chrono::milliseconds(400));
        }
    });
    while (session.status().timeS < lastsS && session.status().fault.empty())
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    isOver = true;
    counter.join();
    session.stop();
    run.workUs = session.status().allWorkUs;
    run.ticks = session.status().ticks;
    return run;
}

}  // namespace

int main(int argc, char** argv) {
    const int turns = argc > 1 ? std::atoi(argv[1]) : 5;
    const double lastsS = argc > 2 ? std::atof(argv[2]) : 20.0;
    const tasks::Task task = course::blockTask("line", 1);
    const preparation::Laid laid = preparation::layOn(task.toothCase, *task.preparation);
    simulation::SimulationSettings settings;
    settings.field = simulation::fieldSettingsAt(task.voxelMm);
    instrument::Instrument bur = instrument::makeInstrument("330");
    settings.bur = bur.bur;
    settings.cuttingParameters = bur.cuttingParameters;
    const simulation::SimulationSetup station = simulation::makeSimulation(task.toothCase, settings, false);
    fmt::print("{:>10} {:>8} {:>8} {:>8} {:>8} {:>8} {:>7} {:>9}\n", "tick, us", "p50", "p99", "p99.9", "worst",
               "ticks", "counts", "ms each");
    for (int turn = 0; turn < turns; ++turn)
        for (const bool counts : {false, true}) {
            const Run run = sit(task, laid, station, lastsS, counts);
            fmt::print("{:>10} {:8.1f} {:8.1f} {:8.1f} {:8.1f} {:8} {:7} {:9.1f}\n", counts ? "with bar" : "without",
                       run.workUs.p50, run.workUs.p99, run.workUs.p999, run.workUs.max, run.ticks, run.counts,
                       run.counts > 0 ? run.countMs / run.counts : 0.0);
        }
    return 0;
}
