// SPDX-License-Identifier: Apache-2.0
// handpiece run: a simulated hand moves the bur, the loop feels the tooth; a trace, plots and a summary come out.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "cli/commands.h"
#include "cli/inputs.h"
#include "cli/run_device.h"
#include "cli/sound_track.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/tick/device/capability.h"
#include "studies/built_in_motion.h"
#include "studies/cut_run.h"
#include "studies/cutting_motion.h"
#include "studies/excavation.h"
#include "studies/progress_bar.h"
#include "studies/run_job.h"
#include "studies/run_output.h"

namespace handpiece::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct RunOptions {
    ContactInputs inputs;
    DeviceOptions device;
    std::string motion = "drop", deviceModel = "simulated", hand = "normal", force = "proxy", out, sound;
    double rateHz = 1000.0, durationS = 0.0, stiffness = 1.0, damping = 1.0, slide = 1.0, speedMmS = 10.0;
    double loadN = 1.0, depthMm = 0.0, delayMs = 0.0, frictionN = 0.26, lengthMm = 0.0;
    std::vector<double> at{0.0, 0.0};
    bool realTime = false, json = false;
    // Of a cut.
    double pedal = 0.0, isthmusMm = 1.2, heightMm = 2.5, dwellS = 4.0, tremorUm = 0.0;
    double pulpGuardMm = studies::kPulpGuardMm;
    std::uint64_t seed = 1;
    bool fullRemoval = false, pedalGiven = false, handGiven = false, speedGiven = false, motionGiven = false;
    std::string drive = "turbine", cuttingParameters, abilities, tissues, code;
    std::vector<double> undoAtS, redoAtS, resetAtS;
};

constexpr std::uint64_t kWatchTicks = 64;

/// Before a person's hand moves the bur.
void printHint(const RunOptions& o, const studies::RunSettings& settings) {
    if (isReal(o.device) && !o.json)
        fmt::print(stderr, "handpiece: the device is yours for {:.0f} s; Ctrl-C ends it sooner.\n", settings.durationS);
}

Json spreadJson(const loop::Spread& s) {
    return {{"p50", s.p50}, {"p99", s.p99}, {"p999", s.p999}, {"max", s.max}};
}

Json summaryJson(const RunOptions& o, const studies::RunSummary& s, const std::string& method,
                 const std::string& hand) {
    return {{"tooth", o.inputs.tooth},
            {"bur", o.inputs.bur.name},
            {"method", method},
            {"motion", o.motion},
            {"force", o.force},
            {"device", o.device.name},
            {"device_model", o.deviceModel},
            {"hand", hand},
            {"rate_hz", o.rateHz},
            {"real_time", o.realTime},
            {"stopped_early", s.stopped},
            {"duration_s", s.durationS},
            {"ticks", s.report.ticks},
            {"late_ticks", s.report.lateTicks},
            {"missed_periods", s.report.missedPeriods},
            {"queue_overflow", s.report.queueOverflow},
            {"scheduling", s.report.scheduling.line()},
            {"scheduling_class", rt::nameOf(s.report.scheduling.scheduling)},
            {"work_us", spreadJson(s.report.workUs)},
            {"lateness_us", spreadJson(s.report.latenessUs)},
            {"peak_force_n", s.peakForceN},
            {"deepest_mm", s.deepestMm},
            {"contact_s", s.contactS},
            {"largest_area_mm2", s.largestAreaMm2},
            {"force_limited_ticks", s.limitedTicks},
            {"slope_limited_ticks", s.slopeLimitedTicks},
            {"fault_ticks", s.faultTicks},
            {"truncated_ticks", s.truncatedTicks}};
}

void printRow(const char* name, const std::string& value) {
    fmt::print("  {:<14}{}\n", name, value);
}

void printSummary(const RunOptions& o, const studies::RunSummary& s, const std::string& method) {
    const auto row = printRow;
    const loop::RunReport& r = s.report;
    fmt::print("{}{}\n", o.out, s.stopped ? " (stopped early; what there was is written)" : "");
    row("ran", fmt::format("{} on {} with {}, {}, {:.3f} s at {:.0f} Hz", o.motion, o.inputs.tooth, o.inputs.bur.name,
                           method, s.durationS, o.rateHz));
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

studies::RunSettings settingsOf(const RunOptions& o) {
    validate(o.device);
    if (isReal(o.device) && o.motionGiven)
        throw core::Error("a person moves a real device", "--motion", "leave it out, or take --device simulated");
    // The loop says the same of rates out of range, but only after the tooth was read.
    if (!(o.rateHz >= 100.0 && o.rateHz <= 10000.0))
        throw core::Error(fmt::format("a rate of {} Hz cannot be run", o.rateHz), "--rate",
                          "choose 1000, 2000, 4000 or 8000");
    if (!(o.durationS >= 0.0 && o.durationS <= 86400.0))
        throw core::Error(fmt::format("a run of {} s", o.durationS), "--duration", "give up to a day; 0: the motion's");
    studies::RunSettings s;
    s.rateHz = o.rateHz;
    s.durationS = o.durationS;
    s.realTime = o.realTime;
    s.device.capability = device::capabilityByName(o.deviceModel);
    s.device.frictionN = o.frictionN;
    s.device.delayS = 1e-3 * o.delayMs;
    s.device.rigidHand = o.hand == "rigid";
    if (!s.device.rigidHand && !isReal(o.device)) s.device.hand = device::handByName(o.hand);
    s.parameters.law = force::lawByName(o.force);
    s.parameters.stiffnessMultiplier = o.stiffness;
    s.parameters.dampingMultiplier = o.damping;
    s.parameters.frictionMultiplier = o.slide;
    s.parameters.transients.on = s.parameters.vibration.on = o.device.crisp == "on";
    s.controller = o.device.controller == "on" && !isGuarded(o.device);
    s.drive = instrument::driveByName(o.drive);
    force::validate(s.parameters);
    return s;
}

device::Motion motionOf(const RunOptions& o, const studies::RunSettings& s, contact::Method& method,
                        const core::Box& box) {
    studies::MotionOptions m;
    m.speedMmS = o.speedMmS;
    m.lengthMm = o.lengthMm;
    m.offsetMm = {o.at[0], o.at[1]};
    constexpr double kRigidDepthMm = 0.5;  // a rigid hand goes exactly there
    // A depth that is no number goes on to be refused.
    m.depthMm = !(o.depthMm <= 0.0)  ? o.depthMm
                : s.device.rigidHand ? kRigidDepthMm
                                     : o.loadN / s.device.hand.stiffnessNPerMm;
    return studies::motionByName(o.motion, method, box, m);
}

bool isCuttingMotion(const std::string& name) {
    const auto& all = studies::cuttingMotions();
    return std::any_of(all.begin(), all.end(), [&](const studies::BuiltInMotion& m) { return m.name == name; });
}

bool isMotionFile(const std::string& name) {
    return fs::path(name).has_extension() || name == "-";
}

simulation::SimulationSettings stationSettingsOf(const RunOptions& o, const studies::RunSettings& run,
                                                 const cases::Case& toothCase, const tooth::LoadSettings& prepare) {
    simulation::SimulationSettings s;
    s.rateHz = run.rateHz;
    s.field = prepare.field;
    const instrument::Instrument instrument =
        instrument::makeInstrument(o.inputs.bur.name, o.abilities, o.cuttingParameters, o.inputs.bur.mmPerUnit());
    s.cuttingParameters = instrument.cuttingParameters;
    s.bur = instrument.bur;
    s.drive = run.drive;
    s.tissues = o.tissues.empty() ? toothCase.tissues : cases::readTissues(o.tissues);
    s.capability = run.device.capability;
    s.parameters = run.parameters;
    const force::Parameters feel = force::defaultParameters(s.tissues);
    s.parameters.tissues = feel.tissues;
    s.fullRemoval = o.fullRemoval;
    return s;
}

/// How fast this bur comes through the tissues under this hand.
studies::CuttingRates ratesOf(const RunOptions& o, const studies::RunSettings& run,
                              const simulation::SimulationSettings& s) {
    constexpr double kUnderLoad = 0.85;  // of the free speed
    studies::CuttingRates rates;
    for (std::size_t t = 0; t < cases::kTissueCount; ++t) {
        const double felt =
            std::min(1.0, s.parameters.tissues[t].stiffnessFraction * run.parameters.stiffnessMultiplier) *
            s.capability.maxStiffnessNPerMm;
        const double hand = run.device.hand.stiffnessNPerMm;
        rates.stiffnessNPerMm[t] = run.device.rigidHand ? felt : felt * hand / (felt + hand);
        rates.cuttingMm2PerN[t] = s.cuttingParameters.cutting * s.tissues.rows[t].cuttingMm2PerN;
    }
    rates.speedRadS = kUnderLoad * s.drive.freeSpeedRpm * std::numbers::pi / 30.0 * (o.pedalGiven ? o.pedal : 1.0);
    rates.loadN = o.loadN;
    rates.loadCapN = s.cuttingParameters.loadCapN;
    rates.maxFeedMmS =
        s.cuttingParameters.chipMm * s.cuttingParameters.edges * rates.speedRadS / (2.0 * std::numbers::pi);
    rates.centreRadius = s.cuttingParameters.centreRadius;
    return rates;
}

device::Motion cutMotionOf(const RunOptions& o, const studies::RunSettings& settings, const cases::Case& toothCase,
                           const simulation::SimulationSetup& station, std::vector<studies::LesionPlan>& lesions) {
    const double pedal = o.pedalGiven ? o.pedal : 1.0;
    const auto& tooth = station.tooth;
    const auto method = contact::makeFieldMethod(tooth, station.settings.bur);
    if (!isCuttingMotion(o.motion)) {
        device::Motion motion = isMotionFile(o.motion)
                                    ? studies::readMotion(o.motion, settings.device.capability, o.rateHz)
                                    : motionOf(o, settings, *method, tooth->outer.bounds());
        return studies::withPedal(motion, pedal);
    }
    studies::CuttingScene scene;
    scene.toothBounds = tooth->outer.bounds();
    scene.burRadiusMm = station.settings.bur->maxRadiusMm();
    scene.burLengthMm = station.settings.bur->lengthMm();
    studies::CuttingOptions cut;
    cut.pedal = pedal;
    cut.depthMm = o.depthMm;
    cut.lengthMm = o.lengthMm;
    cut.isthmusMm = o.isthmusMm;
    cut.heightMm = o.heightMm;
    cut.dwellS = o.dwellS;
    if (o.speedGiven) cut.feedMmS = o.speedMmS;
    cut.offsetMm = {o.at[0], o.at[1]};
    cut.pulpGuardMm = o.pulpGuardMm;
    if (o.motion != "excavate") return studies::cuttingMotionByName(o.motion, *method, scene, cut);
    scene = studies::excavationScene(station, toothCase);
    if (!o.fullRemoval && pedal > 0.0) scene.rates = ratesOf(o, settings, station.settings);
    studies::Excavation plan = studies::planExcavation(scene, cut);
    lesions = std::move(plan.lesions);
    return std::move(plan.motion);
}

double shareOf(const studies::LesionOutcome& outcome) {
    return outcome.decayMm3 > 0.0 ? outcome.takenMm3 / outcome.decayMm3 : 1.0;
}

Json lesionsJson(const std::vector<studies::LesionPlan>& lesions, const std::vector<studies::LesionOutcome>& outcomes) {
    Json all = Json::array();
    for (std::size_t i = 0; i < lesions.size(); ++i) {
        const studies::LesionPlan& l = lesions[i];
        all.push_back({{"centre_mm", {l.centreMm.x(), l.centreMm.y(), l.centreMm.z()}},
                       {"axis", {l.axis.x(), l.axis.y(), l.axis.z()}},
                       {"decay_mm3", l.decayMm3},
                       {"planned_decay_mm3", l.reachedMm3},
                       {"planned_sound_mm3", l.soundMm3},
                       {"left_for_the_pulp_mm3", l.guardedMm3},
                       {"planned_over_pulp_mm", std::isfinite(l.nearestPulpMm) ? Json(l.nearestPulpMm) : Json()},
                       {"taken_decay_mm3", outcomes[i].takenMm3},
                       {"taken_share", shareOf(outcomes[i])},
                       {"taken_sound_mm3", outcomes[i].soundMm3}});
    }
    return all;
}

void printLesions(const std::vector<studies::LesionPlan>& lesions, const std::vector<studies::LesionOutcome>& outcomes,
                  double guardMm) {
    for (std::size_t i = 0; i < lesions.size(); ++i) {
        const studies::LesionPlan& l = lesions[i];
        std::string text = fmt::format(
            "{} of {} at ({:.1f}, {:.1f}, {:.1f}), from ({:.2f}, {:.2f}, {:.2f}): {:.2f} of {:.2f} mm3 taken "
            "({:.0f} %), {:.2f} mm3 of sound tooth with it",
            i + 1, lesions.size(), l.centreMm.x(), l.centreMm.y(), l.centreMm.z(), l.axis.x(), l.axis.y(), l.axis.z(),
            outcomes[i].takenMm3, outcomes[i].decayMm3, 100.0 * shareOf(outcomes[i]), outcomes[i].soundMm3);
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
    // A cut is judged by what the hand intends, and an eye leads it there: the simulated hand alone is blind, and would
    // come to rest where its spring and the device's friction let it.
    if (!o.handGiven) settings.device.rigidHand = true;
    // What is left of it names the file that it was, and no unit.
    if (o.inputs.unit.mmPerUnit() != 1.0)
        throw core::Error(
            "a tooth that is cut is kept in millimetres", "--unit",
            fmt::format("first: handpiece mesh repair {} OUT.stl --unit {}", o.inputs.tooth, o.inputs.unit.name));
    std::optional<RunDevice> device;
    if (isGuarded(o.device)) device.emplace(o.device);
    const tooth::LoadSettings prepare = prepareSettingsOf(o.inputs);
    studies::Outputs outputs(o.out);  // before the work: a folder that cannot be written is told at once
    // An attempt goes on where it was.
    std::optional<cases::OpenAttempt> before;
    if (cases::isAttempt(o.inputs.tooth)) before = cases::openAttempt(o.inputs.tooth);
    const cases::Case toothCase = before ? before->toothCase : cases::readCase(o.inputs.tooth);
    simulation::SimulationSettings stationSettings = stationSettingsOf(o, settings, toothCase, prepare);
    if (before && std::abs(before->attempt.voxelMm - prepare.field.voxelMm) > 1e-9)
        throw core::Error(fmt::format("the attempt was cut with voxels of {:.6g} um, not {:.6g}",
                                      1e3 * before->attempt.voxelMm, o.inputs.voxelUm),
                          o.inputs.tooth, fmt::format("give --voxel {:.6g}", 1e3 * before->attempt.voxelMm));
    stationSettings.resumed = before.has_value();
    studies::ProgressBar preparing("preparing the tooth");
    simulation::SimulationSetup station =
        simulation::makeSimulation(toothCase, std::move(stationSettings), prepare.useCache, preparing.listener());
    preparing.finish();
    if (before) station.resume(tooth::decodeState(before->attempt.state, station.teeth(), o.inputs.tooth));
    settings.parameters = station.settings.parameters;
    std::vector<studies::LesionPlan> lesions;
    device::Motion motion = isReal(o.device) ? noMotion() : cutMotionOf(o, settings, toothCase, station, lesions);
    if (o.tremorUm > 0.0 && !isReal(o.device)) motion = studies::withTremor(motion, 1e-3 * o.tremorUm, o.seed);
    if (device) {
        device->open(settings, &motion, placeOf(toothCase, station));
        station.settings.capability = settings.device.capability;
        station.settings.parameters = settings.parameters;
        printHint(o, settings);
    }
    std::optional<SoundTrack> sound;
    if (!o.sound.empty())
        sound.emplace(o.sound, *station.settings.bur, station.settings.cuttingParameters, station.settings.drive,
                      settings.rateHz, settings.durationS > 0.0 ? settings.durationS : motion.durationS());
    const studies::CutOutcome outcome =
        studies::runCut(station, toothCase, settings, motion,
                        {o.code, before ? before->attempt.elapsedS : 0.0,
                         before ? before->attempt.caseFile : fs::path(o.inputs.tooth), o.undoAtS, o.redoAtS, o.resetAtS,
                         [&](const messages::HapticSample& s) {
                             if (sound) sound->take(s);
                             if (device && s.tick % kWatchTicks == 0) device->watch();
                         }},
                        outputs);
    if (sound) sound->finish();

    Json json = summaryJson(o, outcome.summary, "field",
                            isReal(o.device)            ? "person"
                            : settings.device.rigidHand ? "rigid"
                                                        : o.hand);
    if (device) device->add(json);
    Json removed, left;
    for (const cases::Tissue t : station.tooth->tissues.tissues()) {
        const std::string name(cases::properties(t).name);
        removed[name] = outcome.summary.removedMm3[static_cast<std::size_t>(t)];
        left[name] = outcome.leftMm3[static_cast<std::size_t>(t)];
    }
    json["pedal"] = o.pedalGiven ? o.pedal : 1.0;
    json["full_removal"] = o.fullRemoval;
    json["seed"] = o.seed;
    json["tremor_um"] = o.tremorUm;
    json["voxel_um"] = o.inputs.voxelUm;
    json["ability"] = station.settings.cuttingParameters.name;
    json["drive"] = station.settings.drive.name;
    json["removed_mm3"] = removed;
    json["left_mm3"] = left;
    if (!toothCase.others.empty()) json["other_teeth"] = Json::parse(simulation::nickedJson(outcome.nicked));
    const std::vector<studies::LesionOutcome> outcomes = studies::lesionOutcomes(
        lesions, station.tooth->outer.bounds(), [&](const core::Vec3& p) { return station.tooth->field.distance(p); },
        [&](const core::Vec3& p) { return station.field->field().distance(p); });
    if (!lesions.empty()) json["lesions"] = lesionsJson(lesions, outcomes);
    json["left_over_pulp_mm"] = outcome.leftOverPulpMm ? Json(*outcome.leftOverPulpMm) : Json();
    json["cut_stl_mm3"] = outcome.cutMeshMm3;
    json["outer_mm3"] = geometry::enclosedVolumeMm3(toothCase.outer);
    json["cutting_ticks"] = outcome.summary.cuttingTicks;
    json["rpm_while_cutting"] = {{"least", outcome.summary.leastRpm}, {"most", outcome.summary.mostRpm}};
    json["stalled_ticks"] = outcome.summary.stalledTicks;
    json["out_of_bricks_ticks"] = outcome.summary.outOfBricksTicks;
    json["undo_steps_taken"] = outcome.undone;
    json["state_hash"] = simulation::hashText(outcome.stateHash);
    json["session"] = {{"records", outcome.recording.writtenRecords},
                       {"lost_records", outcome.recording.lostRecords},
                       {"bytes", outcome.recording.sizeBytes},
                       {"message", outcome.recording.message}};
    const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace);
    outputs.write("summary.json", text + "\n");
    outputs.keep();
    if (o.json) {
        fmt::print("{}\n", text);
        return;
    }
    printSummary(o, outcome.summary, "field");
    if (device) device->print();
    std::string volumes;
    for (const auto& [name, mm3] : removed.items())
        if (mm3.get<double>() > 0.0)
            volumes += fmt::format("{}{} {:.4f}", volumes.empty() ? "" : ", ", name, mm3.get<double>());
    printRow("removed", volumes.empty() ? "nothing" : volumes + " mm3");
    for (const simulation::NickedTooth& tooth : outcome.nicked)
        printRow("nicked", fmt::format("{}: {:.4f} mm3", tooth.name, tooth::sumOf(tooth.removedMm3)));
    if (!lesions.empty()) {
        double soundMm3 = 0.0, gone = 0.0, remaining = 0.0;
        for (std::size_t t = 0; t < cases::kTissueCount; ++t) {
            const auto tissue = static_cast<cases::Tissue>(t);
            if (cases::isCarious(tissue)) remaining += outcome.leftMm3[t];
            if (tissue != cases::Tissue::demineralisedEnamel)
                (cases::isCarious(tissue) ? gone : soundMm3) += outcome.summary.removedMm3[t];
        }
        const double all = gone + remaining;
        printLesions(lesions, outcomes, o.pulpGuardMm);
        double plannedMm3 = 0.0;
        for (const studies::LesionPlan& l : lesions)
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
    studies::RunSettings settings = settingsOf(o);
    const bool real = isReal(o.device);
    if (o.pedalGiven || o.fullRemoval || isCuttingMotion(o.motion) || (real && o.inputs.method == "field"))
        return cutCommand(o, std::move(settings));
    std::optional<RunDevice> device;
    if (isGuarded(o.device)) device.emplace(o.device);
    const bool isFile = !real && isMotionFile(o.motion);
    std::unique_ptr<device::Motion> motion;
    if (isFile)
        motion = std::make_unique<device::Motion>(studies::readMotion(o.motion, settings.device.capability, o.rateHz));
    studies::Outputs outputs(o.out);  // before the work: a folder that cannot be written is told at once
    const auto tooth = loadTooth(o.inputs);
    auto method = makeMethod(o.inputs.method, methods, tooth, loadBur(o.inputs.bur));
    const std::string methodName = method->name();
    if (real) motion = std::make_unique<device::Motion>(noMotion());
    if (!motion) motion = std::make_unique<device::Motion>(motionOf(o, settings, *method, tooth->outer.bounds()));
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
    Json json = summaryJson(o, summary, methodName, real ? "person" : o.hand);
    if (device) device->add(json);
    const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace);
    outputs.write("summary.json", text + "\n");
    outputs.keep();
    if (o.json) {
        fmt::print("{}\n", text);
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
        runCommand(*options, methods);
    });
}

}  // namespace handpiece::cli
