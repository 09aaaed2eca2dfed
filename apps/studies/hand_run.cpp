// SPDX-License-Identifier: Apache-2.0
#include "studies/hand_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/model/tooth/state_file.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/device/capability.h"
#include "studies/built_in_motion.h"
#include "studies/cutting_motion.h"

namespace handpiece::studies {
namespace {

using Json = nlohmann::ordered_json;

Json spreadJson(const loop::Spread& s) {
    return {{"p50", s.p50}, {"p99", s.p99}, {"p999", s.p999}, {"max", s.max}};
}

bool isCuttingMotion(const HandOptions& o) {
    const auto& all = cuttingMotions();
    return !o.path && std::any_of(all.begin(), all.end(), [&](const BuiltInMotion& m) { return m.name == o.motion; });
}

/// With the pedal all the way down unless somebody said how far.
double pedalOf(const HandOptions& o) {
    return o.pedalGiven ? o.pedal : 1.0;
}

simulation::SimulationSettings stationSettingsOf(const HandOptions& o, const RunSettings& run,
                                                 const cases::Case& toothCase, const tooth::LoadSettings& prepare) {
    simulation::SimulationSettings s;
    s.rateHz = run.rateHz;
    s.field = prepare.field;
    const instrument::Instrument instrument =
        instrument::makeInstrument(o.bur, o.abilities, o.cuttingParameters, o.burMmPerUnit);
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
CuttingRates ratesOf(const HandOptions& o, const RunSettings& run, const simulation::SimulationSettings& s) {
    constexpr double kUnderLoad = 0.85;  // of the free speed
    CuttingRates rates;
    for (std::size_t t = 0; t < cases::kTissueCount; ++t) {
        const double felt =
            std::min(1.0, s.parameters.tissues[t].stiffnessFraction * run.parameters.stiffnessMultiplier) *
            s.capability.maxStiffnessNPerMm;
        const double hand = run.device.hand.stiffnessNPerMm;
        rates.stiffnessNPerMm[t] = run.device.rigidHand ? felt : felt * hand / (felt + hand);
        rates.cuttingMm2PerN[t] = s.cuttingParameters.cutting * s.tissues.rows[t].cuttingMm2PerN;
    }
    rates.speedRadS = kUnderLoad * s.drive.freeSpeedRpm * std::numbers::pi / 30.0 * pedalOf(o);
    rates.loadN = o.loadN;
    rates.loadCapN = s.cuttingParameters.loadCapN;
    rates.maxFeedMmS =
        s.cuttingParameters.chipMm * s.cuttingParameters.edges * rates.speedRadS / (2.0 * std::numbers::pi);
    rates.centreRadius = s.cuttingParameters.centreRadius;
    return rates;
}

device::Motion cutMotionOf(const HandOptions& o, const RunSettings& settings, CutJob& job) {
    const simulation::SimulationSetup& station = job.station;
    const auto& tooth = station.tooth;
    const auto method = contact::makeFieldMethod(tooth, station.settings.bur);
    if (!isCuttingMotion(o)) return withPedal(touchMotionOf(o, settings, *method, tooth->outer.bounds()), pedalOf(o));
    CuttingScene scene;
    scene.toothBounds = tooth->outer.bounds();
    scene.burRadiusMm = station.settings.bur->maxRadiusMm();
    scene.burLengthMm = station.settings.bur->lengthMm();
    CuttingOptions cut;
    cut.pedal = pedalOf(o);
    cut.depthMm = o.depthMm;
    cut.lengthMm = o.lengthMm;
    cut.isthmusMm = o.isthmusMm;
    cut.heightMm = o.heightMm;
    cut.dwellS = o.dwellS;
    if (o.speedGiven) cut.feedMmS = o.speedMmS;
    cut.offsetMm = {o.at[0], o.at[1]};
    cut.pulpGuardMm = o.pulpGuardMm;
    if (o.motion != "excavate") return cuttingMotionByName(o.motion, *method, scene, cut);
    scene = excavationScene(station, job.toothCase);
    if (!o.fullRemoval && cut.pedal > 0.0) scene.rates = ratesOf(o, settings, station.settings);
    Excavation plan = planExcavation(scene, cut);
    job.lesions = std::move(plan.lesions);
    return std::move(plan.motion);
}

Json lesionsJson(const std::vector<LesionPlan>& lesions, const std::vector<LesionOutcome>& outcomes) {
    Json all = Json::array();
    for (std::size_t i = 0; i < lesions.size(); ++i) {
        const LesionPlan& l = lesions[i];
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

}  // namespace

double shareOf(const LesionOutcome& outcome) {
    return outcome.decayMm3 > 0.0 ? outcome.takenMm3 / outcome.decayMm3 : 1.0;
}

bool isMotionFile(const std::string& name) {
    return std::filesystem::path(name).has_extension() || name == "-";
}

bool isCut(const HandOptions& options) {
    return options.pedalGiven || options.fullRemoval || isCuttingMotion(options);
}

RunSettings settingsOf(const HandOptions& o) {
    // The loop says the same of rates out of range, but only after the tooth was read.
    if (!(o.rateHz >= 100.0 && o.rateHz <= 10000.0))
        throw core::Error(fmt::format("a rate of {} Hz cannot be run", o.rateHz), "--rate",
                          "choose 1000, 2000, 4000 or 8000");
    if (!(o.durationS >= 0.0 && o.durationS <= 86400.0))
        throw core::Error(fmt::format("a run of {} s", o.durationS), "--duration", "give up to a day; 0: the motion's");
    RunSettings s;
    s.rateHz = o.rateHz;
    s.durationS = o.durationS;
    s.realTime = o.realTime;
    s.device.capability = device::capabilityByName(o.deviceModel);
    s.device.frictionN = o.frictionN;
    s.device.delayS = 1e-3 * o.delayMs;
    s.device.rigidHand = o.hand == "rigid";
    if (!s.device.rigidHand) s.device.hand = device::handByName(o.hand);
    s.parameters.law = force::lawByName(o.force);
    s.parameters.stiffnessMultiplier = o.stiffness;
    s.parameters.dampingMultiplier = o.damping;
    s.parameters.frictionMultiplier = o.slide;
    s.parameters.transients.on = s.parameters.vibration.on = o.crisp;
    s.controller = o.controller;
    s.drive = instrument::driveByName(o.drive);
    force::validate(s.parameters);
    return s;
}

device::Motion touchMotionOf(const HandOptions& o, const RunSettings& s, contact::Method& method,
                             const core::Box& box) {
    if (o.path) return readMotion(*o.path, s.device.capability, o.rateHz);
    if (isMotionFile(o.motion)) return readMotion(o.motion, s.device.capability, o.rateHz);
    MotionOptions m;
    m.speedMmS = o.speedMmS;
    m.lengthMm = o.lengthMm;
    m.offsetMm = {o.at[0], o.at[1]};
    constexpr double kRigidDepthMm = 0.5;  // a rigid hand goes exactly there
    // A depth that is no number goes on to be refused.
    m.depthMm = !(o.depthMm <= 0.0)  ? o.depthMm
                : s.device.rigidHand ? kRigidDepthMm
                                     : o.loadN / s.device.hand.stiffnessNPerMm;
    return motionByName(o.motion, method, box, m);
}

CutJob prepareCut(const HandOptions& o, RunSettings& settings, const tooth::LoadSettings& prepare, bool byPerson,
                  const core::Progress& progress) {
    // A cut is judged by what the hand intends, and an eye leads it there: the simulated hand alone is blind, and would
    // come to rest where its spring and the device's friction let it.
    if (!o.handGiven) settings.device.rigidHand = true;
    CutJob job;
    // An attempt goes on where it was.
    if (cases::isAttempt(o.tooth)) job.before = cases::openAttempt(o.tooth);
    job.toothCase = job.before ? job.before->toothCase : cases::readCase(o.tooth);
    simulation::SimulationSettings stationSettings = stationSettingsOf(o, settings, job.toothCase, prepare);
    if (job.before && std::abs(job.before->attempt.voxelMm - prepare.field.voxelMm) > 1e-9)
        throw core::Error(fmt::format("the attempt was cut with voxels of {:.6g} um, not {:.6g}",
                                      1e3 * job.before->attempt.voxelMm, o.voxelUm),
                          o.tooth, fmt::format("give --voxel {:.6g}", 1e3 * job.before->attempt.voxelMm));
    stationSettings.resumed = job.before.has_value();
    job.station = simulation::makeSimulation(job.toothCase, std::move(stationSettings), prepare.useCache, progress);
    if (job.before) job.station.resume(tooth::decodeState(job.before->attempt.state, job.station.teeth(), o.tooth));
    settings.parameters = job.station.settings.parameters;
    if (byPerson) return job;
    job.motion = cutMotionOf(o, settings, job);
    if (o.tremorUm > 0.0) job.motion = withTremor(*job.motion, 1e-3 * o.tremorUm, o.seed);
    return job;
}

CutOutcome runCutJob(const CutJob& job, const HandOptions& o, const RunSettings& settings, const device::Motion& motion,
                     CutRunOptions listening, Outputs& outputs) {
    listening.code = o.code;
    listening.elapsedS = job.before ? job.before->attempt.elapsedS : 0.0;
    listening.casePath = job.before ? job.before->attempt.caseFile : std::filesystem::path(o.tooth);
    listening.undoAtS = o.undoAtS;
    listening.redoAtS = o.redoAtS;
    listening.resetAtS = o.resetAtS;
    return runCut(job.station, job.toothCase, settings, motion, listening, outputs);
}

std::vector<LesionOutcome> lesionOutcomes(const CutJob& job) {
    return lesionOutcomes(
        job.lesions, job.station.tooth->outer.bounds(),
        [&](const core::Vec3& p) { return job.station.tooth->field.distance(p); },
        [&](const core::Vec3& p) { return job.station.field->field().distance(p); });
}

Json summaryOf(const HandOptions& o, const RunSummary& s, const std::string& method, const std::string& device,
               const std::string& hand) {
    return {{"tooth", o.tooth},
            {"bur", o.bur},
            {"method", method},
            {"motion", o.path ? o.path->source : o.motion},
            {"force", o.force},
            {"device", device},
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

void addCut(Json& json, const HandOptions& o, const CutJob& job, const CutOutcome& outcome,
            const std::vector<LesionOutcome>& lesions) {
    Json removed, left;
    for (const cases::Tissue t : job.station.tooth->tissues.tissues()) {
        const std::string name(cases::properties(t).name);
        removed[name] = outcome.summary.removedMm3[static_cast<std::size_t>(t)];
        left[name] = outcome.leftMm3[static_cast<std::size_t>(t)];
    }
    json["pedal"] = pedalOf(o);
    json["full_removal"] = o.fullRemoval;
    json["seed"] = o.seed;
    json["tremor_um"] = o.tremorUm;
    json["voxel_um"] = o.voxelUm;
    json["ability"] = job.station.settings.cuttingParameters.name;
    json["drive"] = job.station.settings.drive.name;
    json["removed_mm3"] = removed;
    json["left_mm3"] = left;
    if (!job.toothCase.others.empty()) json["other_teeth"] = Json::parse(simulation::nickedJson(outcome.nicked));
    if (!job.lesions.empty()) json["lesions"] = lesionsJson(job.lesions, lesions);
    json["left_over_pulp_mm"] = outcome.leftOverPulpMm ? Json(*outcome.leftOverPulpMm) : Json();
    json["cut_stl_mm3"] = outcome.cutMeshMm3;
    json["outer_mm3"] = geometry::enclosedVolumeMm3(job.toothCase.outer);
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
}

std::string textOf(const Json& summary) {
    return summary.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace handpiece::studies
