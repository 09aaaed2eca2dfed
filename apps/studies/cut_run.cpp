// SPDX-License-Identifier: Apache-2.0
#include "studies/cut_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/case/case_bytes.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/senses/measure/tooth_probe.h"
#include "handpiece/senses/surface/closed_surface.h"
#include "studies/progress_bar.h"

namespace handpiece::studies {
namespace {

using messages::HapticSample;

/// Of a run's progress, where surfaces are shaped after it.
constexpr double kCuttingShare = 0.5;

/// Steps of one kind that are still to be taken.
struct Due {
    simulation::CutSession::Step step;
    std::vector<double> atS;
    std::size_t next = 0;
};

/// The tooth that is left, as one closed surface and as a case of its own.
void writeCut(const simulation::SimulationSetup& station, const cases::Case& toothCase, const tooth::StateDelta& state,
              const CutRunOptions& options, Outputs& outputs, CutOutcome& outcome) {
    tooth::ToothMirror mirror(station.tooth);
    mirror.apply(state);
    if (const auto thinnest = measure::ToothProbe(mirror).thinnestOverPulp()) outcome.leftOverPulpMm = thinnest->leftMm;
    if (!options.surfaces) return;
    ProgressBar bar("shaping the cut tooth");
    // Ctrl-C has ended the cutting; what was cut is still written out. Pressed again it ends the program.
    core::Progress progress = [shown = bar.listener()](double fraction) {
        (void)shown(fraction);
        return true;
    };
    if (options.progress) progress = core::part(options.progress, kCuttingShare, 1.0);
    const surface::MirrorSource source(mirror);
    cases::Case cut = toothCase;
    cut.outer = surface::closedSurface(source, core::part(progress, 0.0, 0.4));
    outcome.cutMeshMm3 = geometry::enclosedVolumeMm3(cut.outer);
    cut.outerColours.clear();
    cut.parts.clear();
    const std::vector<cases::Tissue> tissues = station.tooth->tissues.tissues();
    for (std::size_t i = 0; i < tissues.size(); ++i) {
        const double done = static_cast<double>(i), all = static_cast<double>(tissues.size());
        cases::Part part;
        part.tissue = tissues[i];
        part.name = cases::properties(part.tissue).name;
        part.priority = cases::properties(part.tissue).priority;
        part.mesh = surface::closedPart(source, station.tooth->tissues, part.tissue,
                                        core::part(progress, 0.4 + 0.6 * done / all, 0.4 + 0.6 * (done + 1) / all));
        if (!part.mesh.triangles.empty()) cut.parts.push_back(std::move(part));
    }
    geometry::writeStl(outputs.path("cut.stl"), cut.outer);
    outputs.wrote("cut.stl");
    cases::writeCase(cut, outputs.path("cut"));
}

/// What was cut, to go on with later.
void writeAttempt(const simulation::SimulationSetup& station, const cases::Case& toothCase,
                  const tooth::StateDelta& state, const CutRunOptions& options, const CutOutcome& outcome,
                  const Outputs& outputs) {
    cases::Attempt attempt;
    attempt.caseFile = core::wholePath(options.casePath);
    attempt.caseKey = cases::contentKey(toothCase);
    attempt.caseName = toothCase.name;
    attempt.state = tooth::encodeState(state, station.identity());
    attempt.voxelMm = station.settings.field.voxelMm;
    attempt.removedMm3 = state.removedMm3.own;
    attempt.bur = station.settings.bur->name();
    attempt.cuttingParameters = station.settings.cuttingParameters.name;
    attempt.drive = station.settings.drive.name;
    attempt.elapsedS = options.elapsedS + outcome.summary.durationS;
    attempt.student = options.code;
    attempt.session = "session.h5";
    attempt.undoDepth = static_cast<std::int64_t>(outcome.undoSteps);
    cases::writeAttempt(attempt, outputs.path("attempt"));
}

}  // namespace

device::Motion withPedal(const device::Motion& motion, double pedal) {
    std::vector<device::TimedPose> poses = motion.poses();
    for (device::TimedPose& p : poses)
        p.pedal = pedal;
    device::TimedPose last = poses.back();
    last.pedal = 0.0;
    last.timeS += 0.001;
    poses.push_back(last);
    last.timeS += 0.2;
    poses.push_back(last);
    return device::Motion(std::move(poses));
}

device::Motion withTremor(const device::Motion& motion, double amplitudeMm, std::uint64_t seed) {
    return withNoise(motion, {{amplitudeMm, 8.0, 12.0}}, 0.004, seed);
}

device::Motion withNoise(const device::Motion& motion, const std::vector<Band>& bands, double stepS,
                         std::uint64_t seed) {
    constexpr int kWaves = 12;
    std::mt19937_64 random(seed);
    const auto share = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    struct Wave {
        double mm, hz, phase;
    };
    std::vector<Wave> waves[3];
    for (const Band& band : bands)
        for (auto& axis : waves)
            for (int i = 0; i < kWaves; ++i) {
                const double hz = band.lowHz + (band.highHz - band.lowHz) * share();
                axis.push_back({band.amplitudeMm * std::sqrt(2.0 / kWaves), hz, 2.0 * std::numbers::pi * share()});
            }
    std::vector<double> times;
    for (double t = 0.0; t < motion.durationS(); t += stepS)
        times.push_back(t);
    for (const device::TimedPose& p : motion.poses())
        times.push_back(p.timeS);
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    std::vector<device::TimedPose> poses;
    for (const double t : times) {
        device::TimedPose pose = motion.at(t);
        pose.timeS = t;
        for (int axis = 0; axis < 3; ++axis)
            for (const Wave& w : waves[axis])
                pose.burInTooth.positionMm[axis] += w.mm * core::sin(2.0 * std::numbers::pi * w.hz * t + w.phase);
        poses.push_back(pose);
    }
    return device::Motion(std::move(poses));
}

CutOutcome runCut(const simulation::SimulationSetup& station, const cases::Case& toothCase, const RunSettings& settings,
                  const device::Motion& motion, const CutRunOptions& options, Outputs& outputs) {
    const double duration = settings.durationS > 0.0 ? settings.durationS : motion.durationS();
    session::SessionInfo info;
    info.rateHz = settings.rateHz;
    info.code = options.code;
    info.version = HANDPIECE_VERSION;
    info.settings = simulation::settingsJson(station.settings);
    info.tooth = cases::encodeCase(toothCase);
    // Written where it stays: what was cut is worth keeping, also when the rest fails.
    session::Recorder recorder(outputs.path("session.h5"), info);
    simulation::CutSession session(station, &recorder, !settings.realTime);
    std::vector<Due> due{{simulation::CutSession::Step::undo, options.undoAtS},
                         {simulation::CutSession::Step::redo, options.redoAtS},
                         {simulation::CutSession::Step::reset, options.resetAtS}};
    CutOutcome outcome;
    RunTrace trace(outputs.path("trace.csv"), duration);
    ProgressBar bar("cutting");
    const core::Progress progress =
        options.progress ? core::part(options.progress, 0.0, options.surfaces ? kCuttingShare : 1.0) : bar.listener();
    std::uint64_t lastTick = 0;
    bool told = false;
    outcome.summary = runLoop(
        settings, motion, station.work(),
        [&](loop::HapticLoop& loop, const HapticSample& s) {
            trace.take(s);
            session.hear(s);
            if (options.listener) options.listener(s);
            lastTick = s.tick;
            for (Due& d : due)
                if (d.next < d.atS.size() && s.timeS >= d.atS[d.next] && !session.inStroke() && !loop.restoring()) {
                    ++d.next;
                    outcome.undone += session.take(d.step, loop);
                }
            if (s.tick % 256 != 0) return;
            if (options.progress)
                core::report(progress, s.timeS / duration);
            else
                progress(s.timeS / duration);
            if (const session::RecorderStatus status = recorder.status(); !told && !status.message.empty()) {
                told = true;
                fmt::print(stderr, "handpiece: recording has stopped: {}\n", status.message);
            }
        },
        [&](const tooth::BrickSnapshot& brick) { session.hear(brick); });
    bar.finish();
    const tooth::StateDelta state = station.state();
    outcome.stateHash = tooth::stateHash(state);
    outcome.nicked = simulation::nickedTeeth(station);
    outcome.leftMm3 = station.field->volumesMm3();
    session.finish(state, lastTick);
    outcome.recording = recorder.close();
    outcome.undoSteps = session.history().undoSteps();
    if (!told && !outcome.recording.message.empty())
        fmt::print(stderr, "handpiece: recording has stopped: {}\n", outcome.recording.message);
    writeAttempt(station, toothCase, state, options, outcome, outputs);
    writeCut(station, toothCase, state, options, outputs, outcome);
    trace.finish(outputs, settings.device.capability.maxForceN, true);
    return outcome;
}

}  // namespace handpiece::studies
