// SPDX-License-Identifier: Apache-2.0
// handpiece run: a simulated hand moves the bur, the loop feels the tooth; a trace, plots and a summary come out.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/commands.h"
#include "cli/inputs.h"
#include "cli/run_device.h"
#include "cli/sound_track.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/tick/device/capability.h"
#include "studies/built_in_motion.h"
#include "studies/cut_run.h"
#include "studies/cutting_motion.h"
#include "studies/hand_run.h"
#include "studies/progress_bar.h"
#include "studies/run_job.h"
#include "studies/run_output.h"

namespace handpiece::cli {
namespace {

using Json = nlohmann::ordered_json;

struct RunOptions : studies::HandOptions {
    ContactInputs inputs;
    DeviceOptions device;
    std::string out, sound;
    bool json = false, motionGiven = false;
};

constexpr std::uint64_t kWatchTicks = 64;

/// Before a person's hand moves the bur.
void printHint(const RunOptions& o, const studies::RunSettings& settings) {
    if (isReal(o.device) && !o.json)
        fmt::print(stderr, "handpiece: the device is yours for {:.0f} s; Ctrl-C ends it sooner.\n", settings.durationS);
}

void printRow(const char* name, const std::string& value) {
    fmt::print("  {:<14}{}\n", name, value);
}

void printSummary(const RunOptions& o, const studies::RunSummary& s, const std::string& method) {
    const auto row = printRow;
    const loop::RunReport& r = s.report;
    fmt::print("{}{}\n", o.out, s.stopped ? " (stopped early; what there was is written)" : "");
    row("ran", fmt::format("{} on {} with {}, {}, {:.3f} s at {:.0f} Hz", o.motion, o.tooth, o.bur, method, s.durationS,
                           o.rateHz));
    row("ticks", fmt::format("{}, late {}, left out {}", r.ticks, r.lateTicks, r.missedPeriods));
    row("scheduling", r.scheduling.line());
    row("work", fmt::format("p50 {:.1f}, p99 {:.1f}, p99.9 {:.1f}, worst {:.1f} us a tick", r.workUs.p50, r.workUs.p99,
                            r.workUs.p999, r.workUs.max));
    row("contact", s.touched ? fmt::format("{:.3f} s, deepest {:.4f} mm, largest area {:.3f} mm2", s.contactS,
                                           s.deepestMm, s.largestAreaMm2)
                             : fmt::format("none, nearest {:.4f} mm", -s.deepestMm));
    row("peak force",
        fmt::format("{:.3f} N{}", s.peakForceN,
                    s.limitedTicks ? fmt::format(", at the device's limit in {} ticks", s.limitedTicks) : ""));
    if (s.slopeLimitedTicks) row("slope", fmt::format("limited in {} ticks", s.slopeLimitedTicks));
    if (s.faultTicks) row("fault", fmt::format("{} ticks without a believable pose: no force", s.faultTicks));
    if (s.truncatedTicks) row("truncated", fmt::format("{} ticks had more contacts than are kept", s.truncatedTicks));
    if (r.queueOverflow) row("lost", fmt::format("{} samples came too fast to be written", r.queueOverflow));
}

/// Refuses what cannot be together.
void validate(const RunOptions& o) {
    validate(o.device);
    if (isReal(o.device) && o.motionGiven)
        throw core::Error("a person moves a real device", "--motion", "leave it out, or take --device simulated");
}

void printLesions(const std::vector<studies::LesionPlan>& lesions, const std::vector<studies::LesionOutcome>& outcomes,
                  double guardMm) {
    for (std::size_t i = 0; i < lesions.size(); ++i) {
        const studies::LesionPlan& l = lesions[i];
        std::string text = fmt::format(
            "{} of {} at ({:.1f}, {:.1f}, {:.1f}), from ({:.2f}, {:.2f}, {:.2f}): {:.2f} of {:.2f} mm3 taken "
            "({:.0f} %), {:.2f} mm3 of sound tooth with it",
            i + 1, lesions.size(), l.centreMm.x(), l.centreMm.y(), l.centreMm.z(), l.axis.x(), l.axis.y(), l.axis.z(),
            outcomes[i].takenMm3, outcomes[i].decayMm3, 100.0 * studies::shareOf(outcomes[i]), outcomes[i].soundMm3);
        if (l.guardedMm3 > 0.0)
            text +=
                fmt::format("; stopped {:.2g} mm short of the pulp: {:.2f} mm3 stay for that", guardMm, l.guardedMm3);
        printRow("lesion", text);
    }
}

/// How much dentine remains over the pulp, and whether that is little: of every cut, not only an excavation.
void printPulp(const studies::CutOutcome& outcome) {
    if (outcome.summary.removedMm3[static_cast<std::size_t>(cases::Tissue::pulp)] > 0.0)
        printRow("pulp", "EXPOSED");
    else if (outcome.leftOverPulpMm)
        printRow("pulp", fmt::format("{:.2f} mm of dentine remain over it{}", *outcome.leftOverPulpMm,
                                     *outcome.leftOverPulpMm < studies::kPulpGuardMm ? ": NEAR" : ""));
}

/// A motion for whoever moves by hand: it is not looked at.
device::Motion noMotion() {
    return device::Motion({{0.0, core::Pose{}, 0.0}, {1.0, core::Pose{}, 0.0}});
}

input::ToothPlace placeOf(const cases::Case& toothCase, const simulation::SimulationSetup& station) {
    return {station.tooth->outer.bounds(), toothCase.fdiNumber, toothCase.buccalSign};
}

void cutCommand(const RunOptions& o, studies::RunSettings settings) {
    if (o.inputs.method != "field")
        throw core::Error(fmt::format("the method \"{}\" knows no tooth that changes", o.inputs.method), "--method",
                          "cut with field");
    // What is left of it names the file that it was, and no unit.
    if (o.inputs.unit.mmPerUnit() != 1.0)
        throw core::Error(
            "a tooth that is cut is kept in millimetres", "--unit",
            fmt::format("first: handpiece mesh repair {} OUT.stl --unit {}", o.inputs.tooth, o.inputs.unit.name));
    std::optional<RunDevice> device;
    if (isGuarded(o.device)) device.emplace(o.device);
    const tooth::LoadSettings prepare = prepareSettingsOf(o.inputs);
    studies::Outputs outputs(o.out);  // before the work: a folder that cannot be written is told at once
    studies::ProgressBar preparing("preparing the tooth");
    studies::CutJob job = studies::prepareCut(o, settings, prepare, isReal(o.device), preparing.listener());
    preparing.finish();
    const simulation::SimulationSetup& station = job.station;
    const device::Motion motion = job.motion ? *job.motion : noMotion();
    if (device) {
        device->open(settings, &motion, placeOf(job.toothCase, station));
        job.station.settings.capability = settings.device.capability;
        job.station.settings.parameters = settings.parameters;
        printHint(o, settings);
    }
    std::optional<SoundTrack> sound;
    if (!o.sound.empty())
        sound.emplace(o.sound, *station.settings.bur, station.settings.cuttingParameters, station.settings.drive,
                      settings.rateHz, settings.durationS > 0.0 ? settings.durationS : motion.durationS());
    studies::CutRunOptions listening;
    listening.listener = [&](const messages::HapticSample& s) {
        if (sound) sound->take(s);
        if (device && s.tick % kWatchTicks == 0) device->watch();
    };
    const studies::CutOutcome outcome = studies::runCutJob(job, o, settings, motion, listening, outputs);
    if (sound) sound->finish();

    Json json = studies::summaryOf(o, outcome.summary, "field", o.device.name,
                                   isReal(o.device)            ? "person"
                                   : settings.device.rigidHand ? "rigid"
                                                               : o.hand);
    if (device) device->add(json);
    const std::vector<studies::LesionOutcome> outcomes = studies::lesionOutcomes(job);
    studies::addCut(json, o, job, outcome, outcomes);
    const std::string text = studies::textOf(json);
    outputs.write("summary.json", text);
    outputs.keep();
    if (o.json) {
        fmt::print("{}", text);
        return;
    }
    printSummary(o, outcome.summary, "field");
    if (device) device->print();
    std::string volumes;
    for (const auto& [name, mm3] : json["removed_mm3"].items())
        if (mm3.get<double>() > 0.0)
            volumes += fmt::format("{}{} {:.4f}", volumes.empty() ? "" : ", ", name, mm3.get<double>());
    printRow("removed", volumes.empty() ? "nothing" : volumes + " mm3");
    for (const simulation::NickedTooth& tooth : outcome.nicked)
        printRow("nicked", fmt::format("{}: {:.4f} mm3", tooth.name, tooth::sumOf(tooth.removedMm3)));
    if (!job.lesions.empty()) {
        double soundMm3 = 0.0, gone = 0.0, remaining = 0.0;
        for (std::size_t t = 0; t < cases::kTissueCount; ++t) {
            const auto tissue = static_cast<cases::Tissue>(t);
            if (cases::isCarious(tissue)) remaining += outcome.leftMm3[t];
            if (tissue != cases::Tissue::demineralisedEnamel)
                (cases::isCarious(tissue) ? gone : soundMm3) += outcome.summary.removedMm3[t];
        }
        const double all = gone + remaining;
        printLesions(job.lesions, outcomes, o.pulpGuardMm);
        double plannedMm3 = 0.0;
        for (const studies::LesionPlan& l : job.lesions)
            plannedMm3 += l.reachedMm3;
        constexpr double kKeptUp = 0.8;
        printRow("caries",
                 fmt::format("{:.2f} mm3 taken ({:.0f} %), {:.2f} mm3 left; {:.2f} mm3 of sound tissue taken{}", gone,
                             all > 0.0 ? 100.0 * gone / all : 0.0, remaining, soundMm3,
                             gone < kKeptUp * plannedMm3
                                 ? "; the bur did not keep up with the hand: a lower --speed, or a faster drive"
                                 : ""));
    }
    printPulp(outcome);
    if (outcome.summary.cuttingTicks > 0)
        printRow("rotor",
                 fmt::format("{:.0f} to {:.0f} rpm while cutting", outcome.summary.leastRpm, outcome.summary.mostRpm));
    if (outcome.summary.stalledTicks > 0) printRow("stalled", fmt::format("{} ticks", outcome.summary.stalledTicks));
    if (outcome.summary.outOfBricksTicks > 0)
        printRow("memory", "the tooth's memory for cuts was used up: cut no deeper (take larger voxels)");
    printRow("state", simulation::hashText(outcome.stateHash));
    printRow("files",
             "session.h5 attempt/ cut.stl cut/ trace.csv depth.svg speed.svg force.svg rotor.svg feed.svg removed.svg "
             "summary.json");
    if (!o.sound.empty()) printRow("sound", o.sound);
}

void runCommand(const RunOptions& o, const MethodRegistry& methods) {
    validate(o);
    studies::RunSettings settings = studies::settingsOf(o);
    const bool real = isReal(o.device);
    if (studies::isCut(o) || (real && o.inputs.method == "field")) return cutCommand(o, std::move(settings));
    std::optional<RunDevice> device;
    if (isGuarded(o.device)) device.emplace(o.device);
    const bool isFile = !real && studies::isMotionFile(o.motion);
    std::unique_ptr<device::Motion> motion;
    if (isFile)
        motion = std::make_unique<device::Motion>(studies::readMotion(o.motion, settings.device.capability, o.rateHz));
    studies::Outputs outputs(o.out);  // before the work: a folder that cannot be written is told at once
    const auto tooth = loadTooth(o.inputs);
    auto method = makeMethod(o.inputs.method, methods, tooth, loadBur(o.inputs.bur));
    const std::string methodName = method->name();
    if (real) motion = std::make_unique<device::Motion>(noMotion());
    if (!motion)
        motion = std::make_unique<device::Motion>(studies::touchMotionOf(o, settings, *method, tooth->outer.bounds()));
    if (device) {
        device->open(settings, motion.get(), {tooth->outer.bounds(), 0, 1});
        printHint(o, settings);
    }

    const double duration = o.durationS > 0.0 ? o.durationS : motion->durationS();
    studies::RunTrace trace(outputs.path("trace.csv"), duration);
    std::optional<SoundTrack> sound;
    if (!o.sound.empty()) {
        const instrument::Instrument held =
            instrument::makeInstrument(o.inputs.bur.name, {}, {}, o.inputs.bur.mmPerUnit());
        sound.emplace(o.sound, *held.bur, held.cuttingParameters, settings.drive, settings.rateHz, duration);
    }
    studies::ProgressBar bar("running");
    const core::Progress progress = bar.listener();
    const studies::RunSummary summary =
        studies::runLoop(settings, *motion, std::move(method), [&](const messages::HapticSample& s) {
            trace.take(s);
            if (sound) sound->take(s);
            if (device && s.tick % kWatchTicks == 0) device->watch();
            if (s.tick % 256 == 0) progress(s.timeS / duration);
        });
    bar.finish();
    trace.finish(outputs, settings.device.capability.maxForceN, false);
    if (sound) sound->finish();
    Json json = studies::summaryOf(o, summary, methodName, o.device.name, real ? "person" : o.hand);
    if (device) device->add(json);
    const std::string text = studies::textOf(json);
    outputs.write("summary.json", text);
    outputs.keep();
    if (o.json) {
        fmt::print("{}", text);
    } else {
        printSummary(o, summary, methodName);
        if (device) device->print();
        printRow("files", "trace.csv depth.svg speed.svg force.svg summary.json");
        if (!o.sound.empty()) printRow("sound", o.sound);
    }
}

}  // namespace

void addRunCommand(Command& app, const MethodRegistry& methods) {
    Command command = app.subcommand("run", "A hand, simulated or real, works on a tooth: trace, plots, summary");
    const auto options = std::make_shared<RunOptions>();
    RunOptions& o = *options;
    addContactOptions(command, o.inputs, methods);
    std::string motions;
    for (const studies::BuiltInMotion& m : studies::builtInMotions())
        motions += fmt::format("{}{} ({})", motions.empty() ? "" : ", ", m.name, m.description);
    std::string cutNames;
    for (const studies::BuiltInMotion& m : studies::cuttingMotions())
        cutNames += fmt::format("{}{} ({})", cutNames.empty() ? "" : ", ", m.name, m.description);
    std::string models;
    for (const device::Capability& c : device::knownDevices())
        models += (models.empty() ? "" : ", ") + c.name;
    const auto add = [&](const char* name, auto& value, std::string help) {
        return command.option(name, value, std::move(help)).showDefault();
    };
    add("--motion", o.motion, motions + "; cuts: " + cutNames + "; or a CSV of t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz");
    command.option("--out", o.out, "folder for trace.csv, the plots and summary.json").required().typeName("FOLDER");
    command.option("--sound", o.sound, "WAV file of what is heard, for headphones (48 kHz stereo)").typeName("FILE");
    addDeviceOptions(command, o.device);
    command.option("--inject", o.device.inject, "faults on purpose, \"unplug@2.5, stall@3:0.2\" or \"random:100\"")
        .group("Device");
    command.option("--crisp", o.device.crisp, "on or off: contact knocks, cutting hums").group("Device");
    command.flag("--foot-pedal", o.device.pedal, "a pedal beside the device").group("Device");
    add("--device-model", o.deviceModel, "what the simulated device is like: " + models);
    add("--rate", o.rateHz, "ticks a second: 1000, 2000, 4000 or 8000");
    add("--duration", o.durationS, "seconds; 0: as long as the motion");
    add("--force", o.force, "proxy, or penalty (the paper's)");
    add("--stiffness", o.stiffness, "multiplier on every tissue's stiffness");
    add("--damping", o.damping, "multiplier on every tissue's damping");
    add("--slide-friction", o.slide, "multiplier on every tissue's friction under a still bur");
    add("--speed", o.speedMmS, "of the named motions [mm/s]; the feed of a cut: 2 unless given");
    add("--load", o.loadN, "what the hand presses with, as far as it gives way [N]").check(positive());
    add("--depth", o.depthMm, "instead of a load: how far beyond the surface the hand intends to go [mm]")
        .check(nonNegative());
    add("--length", o.lengthMm, "of a slide or drag [mm]; 0: 60 % of the tooth");
    add("--at", o.at, "x and y of the first touch from the tooth's middle [mm]").expected(2);
    add("--hand", o.hand, "loose, normal, stiff, or rigid (exactly on the path; cuts are rigid unless given)");
    add("--delay", o.delayMs, "from the command to the force [ms]");
    add("--friction", o.frictionN, "of the device [N]");
    std::string drives;
    for (const instrument::Drive& d : instrument::drives())
        drives += (drives.empty() ? "" : ", ") + d.name;
    const auto cut = [&](const char* name, auto& value, std::string help) {
        return command.option(name, value, std::move(help)).showDefault().group("Cutting");
    };
    cut("--pedal", o.pedal, "0 to 1: the bur turns and cuts (1 for the cutting motions)").check(range(0.0, 1.0));
    command.flag("--full-removal", o.fullRemoval, "take away all that the bur sweeps, whatever the load (rigid hand)")
        .group("Cutting");
    cut("--drive", o.drive, drives);
    cut("--ability", o.cuttingParameters, "of the bur, instead of its own: see docs/burs.md");
    cut("--abilities", o.abilities, "TOML file with abilities and burs of one's own");
    cut("--tissues", o.tissues, "TOML file with tissues of one's own");
    cut("--isthmus", o.isthmusMm, "width of a class I cavity [mm]");
    cut("--height", o.heightMm, "of a shoulder over z = 0 of the tooth [mm]");
    cut("--pulp-guard", o.pulpGuardMm, "excavate comes no nearer to the pulp [mm]; 0: does not heed it");
    cut("--dwell", o.dwellS, "at the end of a cut [s]");
    cut("--tremor", o.tremorUm, "of the hand, root mean square [um]").check(range(0.0, 1000.0));
    cut("--seed", o.seed, "of the tremor");
    cut("--code,--student", o.code, "kept in the session: who cut, as letters, digits, - and _; never a name");
    cut("--undo-at", o.undoAtS, "take the last stroke back at this time [s]; may be given several times");
    cut("--redo-at", o.redoAtS, "do it again at this time [s]");
    cut("--reset-at", o.resetAtS, "make the tooth whole at this time [s]");
    command.flag("--real-time", o.realTime, "on the wall clock, with what priority the machine grants");
    command.flag("--json", o.json, "print summary.json instead of a table");
    command.footer(
        "Without --real-time the same command gives the same trace, but for its two columns of time.\n"
        "Examples:\n"
        "  handpiece run --tooth molar --motion drop --out drop\n"
        "  handpiece run --tooth molar --bur round-4 --motion drag --rate 4000 --real-time --out drag\n"
        "  handpiece run --case molar --bur 330 --motion class-one --out cavity\n"
        "  handpiece run --case molar --bur round-4 --motion excavate --drive low-speed --out excavated\n"
        "  handpiece run --case molar --bur mine.stl --motion path.csv --full-removal --out swept\n"
        "  handpiece run --case molar --device openhaptics --scale 2 --out practice\n"
        "  handpiece run --case molar --motion class-one --inject random:100 --out faults\n"
        "  handpiece run --tooth molar --method hull --force penalty --motion press --speed 60 --out hull");
    command.callback([options, command, &methods] {
        options->pedalGiven = command.isGiven("--pedal");
        options->handGiven = command.isGiven("--hand");
        options->speedGiven = command.isGiven("--speed");
        options->motionGiven = command.isGiven("--motion");
        applySchoolDefaults(command, options->device);
        if (isReal(options->device) && !options->motionGiven) options->motion = "hand";
        const ContactInputs& in = options->inputs;
        options->tooth = in.tooth;
        options->bur = in.bur.name;
        options->burMmPerUnit = in.bur.mmPerUnit();
        options->voxelUm = in.voxelUm;
        options->crisp = options->device.crisp == "on";
        options->controller = options->device.controller == "on" && !isGuarded(options->device);
        runCommand(*options, methods);
    });
}

}  // namespace handpiece::cli
