// SPDX-License-Identifier: Apache-2.0
// What the paper cuts: Figure 11, Figure 12a, and Table III's cutting column.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "handpiece/app/report/plot.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/senses/surface/closed_surface.h"
#include "handpiece/tick/contact/hull/hull_method.h"
#include "studies/built_in_motion.h"
#include "studies/cut_run.h"
#include "studies/reproduce.h"
#include "studies/run_job.h"
#include "studies/stroboscope_picture.h"

namespace handpiece::studies {
namespace {

using Clock = std::chrono::steady_clock;
using messages::HapticSample;

/// The surface under the paper's bur, uncut. One tissue throughout, as the paper's teeth are.
simulation::SimulationSetup stationOn(const Reproduction& r, const std::shared_ptr<const tooth::ToothModel>& uncut) {
    simulation::SimulationSetup station;
    station.tooth = uncut;
    station.field = std::make_shared<tooth::ToothState>(uncut);
    station.settings.bur = r.bur;
    station.settings.cuttingParameters = instrument::makeInstrument("paper").cuttingParameters;
    station.settings.capability = device::SimulatedDeviceSettings{}.capability;
    return station;
}

double usSince(Clock::time_point start) {
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

Timing timingOf(std::vector<double> us) {
    std::sort(us.begin(), us.end());
    const auto at = [&](double q) { return us[static_cast<std::size_t>(q * static_cast<double>(us.size() - 1))]; };
    return {at(0.5), at(0.99), at(0.999), us.back()};
}

struct CutTrial {
    RunSummary summary;
    std::vector<HapticSample> samples;
};

CutTrial trial(const simulation::SimulationSetup& station, const RunSettings& settings, const device::Motion& motion,
               double pedal) {
    CutTrial result;
    result.summary = runLoop(
        settings, withPedal(motion, pedal), station.work(),
        [&](loop::HapticLoop&, const HapticSample& sample) { result.samples.push_back(sample); },
        [](const tooth::BrickSnapshot&) {});
    return result;
}

/// The bur that the eye sees, every `everyS`, until it leaves the tooth.
Stroboscope shotsOf(const CutTrial& trial, double yMm, double everyS, double upMm) {
    Stroboscope shot;
    shot.upMm = upMm;
    double nextS = 0.0;
    for (const HapticSample& s : trial.samples) {
        if (s.timeS < nextS) continue;
        nextS += everyS;
        shot.tipsMm.emplace_back(s.proxyPositionMm[0], yMm, s.proxyPositionMm[2]);
        shot.touching.push_back((s.flags & messages::kCutting) != 0);
    }
    return shot;
}

struct CutPicture {
    const char *motion, *caption;
    double speedMmS, depthMm, lengthMm, everyS;
};

void figure11(Reproduction& r, const Surface& s, const std::shared_ptr<const tooth::ToothModel>& uncut) {
    r.report.heading("Figure 11: a tooth being cut");
    Json rows = Json::array();
    const CutPicture pictures[] = {
        {"press", "A plunge and out again", 0.8, 1.6, 0.0, 0.5},
        {"slide", "Down, along a groove and out", 0.5, 1.4, 3.0, 1.0},
    };
    for (const CutPicture& picture : pictures) {
        r.step("cutting");
        const simulation::SimulationSetup station = stationOn(r, uncut);
        studies::MotionOptions options;
        options.speedMmS = picture.speedMmS;
        options.depthMm = picture.depthMm;
        options.lengthMm = picture.lengthMm;
        options.clearanceMm = 0.4;
        options.dwellS = 2.0;
        const device::Motion motion = studies::motionByName(picture.motion, *s.field, s.tooth->outer.bounds(), options);
        RunSettings settings;
        settings.device.rigidHand = true;
        const CutTrial cut = trial(station, settings, motion, 1.0);
        const double yMm = motion.poses().front().burInTooth.positionMm.y();
        const geometry::TriangleMesh left = surface::closedSurface(surface::FieldSource(station.field->field()));
        Stroboscope shot = shotsOf(cut, yMm, picture.everyS, 2.8);
        shot.before = &s.tooth->outer;
        r.report.figure(
            stroboscopeSvg(left, *r.bur, shot),
            fmt::format(
                "{}: the bur every {:.1f} s, red while it cuts; the tooth of {} cut open at the bur afterwards; "
                "dashed, its outline before. {:.3f} mm3 were removed at {:.1f} mm/s, with at most {:.2f} N.",
                picture.caption, picture.everyS, s.name, cut.samples.back().removedMm3[1], picture.speedMmS,
                cut.summary.peakForceN));
        const Json file = addStroboscope(
            r, uncut, station.field->state(), shot, fmt::format("figure11-{}.png", picture.motion),
            fmt::format("The same in three dimensions: the tooth afterwards, cut open at the bur, and the bur every "
                        "{:.1f} s.",
                        picture.everyS));
        const double before = geometry::enclosedVolumeMm3(s.tooth->outer), after = geometry::enclosedVolumeMm3(left);
        Json row{
            {"resolution", s.name},    {"motion", picture.motion}, {"removed_mm3", cut.samples.back().removedMm3[1]},
            {"outer_mm3", before},     {"cut_mm3", after},         {"peak_n", cut.summary.peakForceN},
            {"tip_mm", Json::array()}, {"cutting", shot.touching}, {"picture", file}};
        for (const core::Vec3& tip : shot.tipsMm)
            row["tip_mm"].push_back({tip.x(), tip.y(), tip.z()});
        if (cut.summary.removedMm3[1] <= 0.0)
            r.remarks.push_back(fmt::format("Figure 11: a {} removed nothing.", picture.motion));
        rows.push_back(std::move(row));
    }
    r.results["figure11"] = std::move(rows);
}

}  // namespace

std::shared_ptr<const tooth::ToothModel> wholeOf(const Surface& s) {
    return tooth::withTissues(*s.tooth, field::TissueMap::uniform(s.tooth->field, cases::Tissue::enamel));
}

Json addStroboscope(Reproduction& r, const std::shared_ptr<const tooth::ToothModel>& uncut,
                    const tooth::StateDelta& state, const Stroboscope& shot, const std::string& file,
                    const std::string& caption) {
    r.step("drawing " + file);
    const std::filesystem::path path = r.out / file;
    if (const std::string missing = writeStroboscope(uncut, state, *r.bur, shot, path); !missing.empty()) {
        r.report.paragraph("No picture in three dimensions: " + missing, report::HtmlReport::Tone::note);
        return {};
    }
    r.report.picture(path, caption);
    return file;
}

CutTiming timeCut(const Reproduction& r, const Surface& s, std::size_t count) {
    constexpr int kPasses = 3, kHulls = 5;
    const auto poses = sweepAt(*s.field, s.tooth->outer.bounds(), 0.1, count);
    const auto uncut = wholeOf(s);
    CutTiming timing;
    std::vector<double> best(poses.size(), std::numeric_limits<double>::infinity());
    for (int pass = 0; pass < kPasses; ++pass) {
        simulation::SimulationSetup station = stationOn(r, uncut);
        station.settings.fullRemoval = true;
        const loop::Work work = station.work();
        cutting::CutInput input;
        input.speedRadS = 1.0;  // it turns; how fast counts for nothing when all is removed
        for (std::size_t i = 0; i < poses.size(); ++i) {
            input.proxyInTooth = input.deviceInTooth = poses[i];
            const auto start = Clock::now();
            (void)work.method->depth(poses[i]);
            work.cutter->cut(*work.method, input);
            best[i] = std::min(best[i], usSince(start));
            while (station.field->handOver(256, [](const tooth::BrickSnapshot&) { return true; }) > 0) {
            }
        }
        timing.removedMm3 = station.field->removedMm3()[1];
    }
    best.erase(best.begin());  // the first tick takes away the whole bur's room at once
    timing.field = timingOf(std::move(best));
    std::vector<double> hulls;
    for (int i = 0; i < kHulls; ++i) {
        const core::Pose& pose = poses[poses.size() * static_cast<std::size_t>(i) / kHulls];
        const auto start = Clock::now();
        (void)contact::makeHullMethod(s.tooth->outer, r.bur->mesh())->depth(pose);
        hulls.push_back(usSince(start));
    }
    timing.hullAnew = timingOf(std::move(hulls));
    timing.hullAnew.p99 = timing.hullAnew.max;  // of so few
    return timing;
}

void reproduceCutPictures(Reproduction& r, const Surface& s) {
    figure11(r, s, wholeOf(s));
}

void reproduceCutForces(Reproduction& r, const Surface& s, Json& rows, std::vector<std::vector<std::string>>& cells) {
    const auto uncut = wholeOf(s);
    for (const char* name : {"press", "drag"}) {
        report::Plot plot{fmt::format("(a) cutting and (b) touching: the same {}", name),
                          "time [s]",
                          "force [N]",
                          {},
                          {{3.3, "3.3 N, the paper's device"}}};
        studies::MotionOptions options;
        options.speedMmS = 2.0;
        options.depthMm = 4.0;
        options.dwellS = r.quick ? 0.5 : 1.5;
        const device::Motion motion = studies::motionByName(name, *s.field, s.tooth->outer.bounds(), options);
        for (const bool cuts : {true, false}) {
            r.step("forces while cutting");
            const simulation::SimulationSetup station = stationOn(r, uncut);
            const RunSettings settings;
            const CutTrial run = trial(station, settings, motion, cuts ? 1.0 : 0.0);
            report::Series curve;
            curve.name = cuts ? "(a) the bur turns and cuts" : "(b) the bur stands still";
            for (const HapticSample& sample : run.samples) {
                curve.x.push_back(sample.timeS);
                curve.y.push_back(forceOf(sample));
            }
            const double limitN = settings.device.capability.maxForceN, peakN = run.summary.peakForceN;
            const double removedMm3 = run.summary.removedMm3[1];
            rows.push_back({{"part", cuts ? "a" : "b"},
                            {"resolution", s.name},
                            {"motion", name},
                            {"method", "field"},
                            {"force_mode", "proxy"},
                            {"speed_mm_s", options.speedMmS},
                            {"pedal", cuts ? 1.0 : 0.0},
                            {"removed_mm3", removedMm3},
                            {"peak_n", peakN},
                            {"limit_n", limitN},
                            {"under_limit", peakN <= limitN},
                            {"contact_s", run.summary.contactS},
                            {"deepest_mm", run.summary.deepestMm},
                            {"paper", "under 3.3 N"},
                            {"t_s", curve.x},
                            {"force_n", curve.y}});
            cells.push_back({cuts ? "(a) cutting" : "(b) touching", name, fmt::format("{:.3f}", peakN),
                             fmt::format("{:.4f}", removedMm3), yesNo(peakN <= limitN)});
            if (peakN > limitN) r.remarks.push_back(fmt::format("Figure 12: a {} reached {:.4f} N.", name, peakN));
            if (cuts == (removedMm3 <= 0.0))
                r.remarks.push_back(fmt::format("Figure 12: a {} {} removed {:.4g} mm3.", name,
                                                cuts ? "that cuts" : "that only touches", removedMm3));
            plot.series.push_back(std::move(curve));
        }
        r.report.figure(report::toSvg(plot, false),
                        fmt::format("A normal hand on the simulated device at 1 kHz, {:.0f} mm/s, on the tooth of {}; "
                                    "the hand's spring draws it {:.0f} mm beyond the surface.",
                                    options.speedMmS, s.name, options.depthMm));
    }
}

}  // namespace handpiece::studies
