// SPDX-License-Identifier: Apache-2.0
// Figures 8, 9, 10, 12b and 13 of the paper; those that cut are in reproduce_cutting.cpp.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "handpiece/app/report/plot.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/contact/hull/hull_method.h"
#include "studies/built_in_motion.h"
#include "studies/reproduce.h"
#include "studies/run_job.h"
#include "studies/stroboscope.h"

namespace handpiece::studies {
namespace {

constexpr double kSameDepthMm = 1e-6;  // answers hold to a nanometre

/// A drop along -z: depth at each place, minus the distance before contact.
struct Drop {
    std::vector<double> dropMm, depthMm, tipZMm;
    double leastStepMm = 0.0;  ///< of the depth from one place to the next, below touch
    double leastRiseMm = 0.0;  ///< the same over all
    [[nodiscard]] bool strictlyRising() const { return leastRiseMm > 0.0; }
    [[nodiscard]] bool nowhereFalling() const { return leastRiseMm >= -kSameDepthMm; }
};

Drop dropAt(contact::Method& method, const core::Box& box, const core::Vec2& xyMm, double belowMm) {
    constexpr double kAboveMm = 1.0, kStepMm = 0.005;
    core::Pose pose = touchAt(method, box, xyMm);
    const double touchZ = pose.positionMm.z();
    Drop drop;
    drop.leastRiseMm = drop.leastStepMm = kStepMm;
    const auto places = static_cast<int>(std::lround((kAboveMm + belowMm) / kStepMm));
    for (int i = 0; i <= places; ++i) {
        pose.positionMm.z() = touchZ + kAboveMm - i * kStepMm;
        const double depth = method.depth(pose).depthMm;
        if (i > 0) {
            const double rise = depth - drop.depthMm.back();
            drop.leastRiseMm = std::min(drop.leastRiseMm, rise);
            if (drop.depthMm.back() >= 0.0) drop.leastStepMm = std::min(drop.leastStepMm, rise);
        }
        drop.dropMm.push_back(i * kStepMm);
        drop.depthMm.push_back(depth);
        drop.tipZMm.push_back(pose.positionMm.z());
    }
    return drop;
}

Json dropJson(const Surface& s, const char* method, const Place& place, const Drop& d) {
    return {{"resolution", s.name},
            {"faces", s.faces},
            {"method", method},
            {"place", place.name},
            {"open", place.open},
            {"monotone", place.open ? d.strictlyRising() : d.nowhereFalling()},
            {"least_rise_um", 1e3 * d.leastRiseMm},
            {"drop_mm", d.dropMm},
            {"depth_mm", d.depthMm},
            {"paper", "depth grows as the distance shrinks"}};
}

/// The bur at every 0.25 mm of a drop.
Stroboscope shotsOf(const Drop& drop, const core::Vec2& xyMm, double upMm) {
    constexpr std::size_t kEvery = 50;
    Stroboscope shot;
    shot.upMm = upMm;
    for (std::size_t i = 0; i < drop.tipZMm.size(); i += kEvery) {
        shot.tipsMm.emplace_back(xyMm.x(), xyMm.y(), drop.tipZMm[i]);
        shot.touching.push_back(drop.depthMm[i] > 0.0);
    }
    return shot;
}

/// In three dimensions the places lie before each other: fewer are more.
Stroboscope everySecond(const Stroboscope& all) {
    Stroboscope shot;
    shot.upMm = 0.7 * all.upMm;
    for (std::size_t i = 0; i < all.tipsMm.size(); i += 2) {
        shot.tipsMm.push_back(all.tipsMm[i]);
        shot.touching.push_back(all.touching[i]);
    }
    return shot;
}

/// The tooth that pictures and forces are made of: not the finest, which the paper could not use.
const Surface& pictured(const Reproduction& r) {
    return r.surfaces[std::min<std::size_t>(r.surfaces.size() - 1, 4)];
}

void drops(Reproduction& r) {
    const double belowMm = r.quick ? 0.5 : 1.0;
    Json figure8 = Json::array(), figure9 = Json::array(), figure10 = Json::array();
    report::Plot cusp{"Dropped onto a cusp", "drop [mm]", "depth, above 0; distance, below [mm]", {}, {{0.0, "touch"}}};
    report::Plot fissure{"Dropped into the fissure", cusp.xLabel, cusp.yLabel, {}, {{0.0, "touch"}}};
    report::Plot plane{"Dropped onto the plane", cusp.xLabel, cusp.yLabel, {}, {{0.0, "touch"}}};
    std::vector<std::vector<std::string>> cells;
    std::vector<std::string> shots8;
    std::string shots10;
    std::vector<std::pair<std::size_t, Stroboscope>> solid;  // by row of figure 8
    for (const Surface& s : r.surfaces) {
        const core::Box box = s.tooth->outer.bounds();
        for (const auto& [name, method] : methodsOf(s)) {
            r.step(fmt::format("drops onto {}", s.name));
            for (const Place& place : placesOn(s)) {
                const Drop drop = dropAt(*method, box, place.xyMm, belowMm);
                const Json row = dropJson(s, name, place, drop);
                const bool good = row["monotone"].get<bool>(), isField = method == s.field.get();
                if (!good)
                    r.remarks.push_back(fmt::format(
                        "{}, {}, {} with {}: the depth fell by {:.4g} um over a step of 5 um.",
                        s.isPlane() ? "Figure 10" : "Figure 9", s.name, place.name, name, -1e3 * drop.leastRiseMm));
                cells.push_back({s.name, name, place.name, place.open ? "rises strictly" : "never falls", yesNo(good),
                                 fmt::format("{:.4f}", 1e3 * drop.leastRiseMm)});
                const bool first = place.name == "cusp 1", inFissure = !place.open;
                const report::Series series{
                    fmt::format("{} {}", s.name, name), drop.dropMm, drop.depthMm, true, false, !isField};
                if (s.isPlane()) {
                    figure10.push_back(row);
                    if (place.name == "middle") plane.series.push_back(series);
                    if (place.name == "middle" && isField)
                        shots10 = stroboscopeSvg(s.tooth->outer, *r.bur, shotsOf(drop, place.xyMm, 2.2));
                    continue;
                }
                figure9.push_back(row);
                if (first) cusp.series.push_back(series);
                if (inFissure) fissure.series.push_back(series);
                if (&s == &pictured(r) && (first || inFissure)) {
                    Json shot{{"resolution", s.name}, {"method", name}, {"place", place.name}};
                    shot["drop_mm"] = shot["depth_mm"] = shot["tip_mm"] = Json::array();
                    const Stroboscope strobe = shotsOf(drop, place.xyMm, 4.0);
                    for (std::size_t i = 0; i < strobe.tipsMm.size(); ++i) {
                        const auto at = static_cast<std::size_t>(std::lround(
                            (drop.tipZMm.front() - strobe.tipsMm[i].z()) / (drop.dropMm[1] - drop.dropMm[0])));
                        shot["drop_mm"].push_back(drop.dropMm[at]);
                        shot["depth_mm"].push_back(drop.depthMm[at]);
                        shot["tip_mm"].push_back({strobe.tipsMm[i].x(), strobe.tipsMm[i].y(), strobe.tipsMm[i].z()});
                    }
                    if (isField) {
                        shots8.push_back(stroboscopeSvg(s.tooth->outer, *r.bur, strobe));
                        solid.emplace_back(figure8.size(), everySecond(strobe));
                    }
                    figure8.push_back(std::move(shot));
                }
            }
        }
    }
    r.results["figure9"] = std::move(figure9);
    r.results["figure10"] = std::move(figure10);
    r.report.heading("Figure 8: a bur dropped onto a tooth");
    for (const std::string& svg : shots8)
        r.report.figure(svg, fmt::format("The tooth of {} cut open at the bur, its silhouette behind; the bur every "
                                         "0.25 mm of its drop, red once it overlaps the tooth (felt by the field).",
                                         pictured(r).name));
    for (const auto& [index, shot] : solid)
        figure8[index]["picture"] = addStroboscope(
            r, wholeOf(pictured(r)), {}, shot,
            index == solid.front().first ? "figure8-cusp.png" : "figure8-fissure.png",
            "The same in three dimensions: the tooth cut open at the bur, the bur every 0.5 mm, red once it overlaps.");
    r.results["figure8"] = std::move(figure8);
    r.report.heading("Figure 9: distance before contact, depth after it");
    r.report.figure(report::toSvg(cusp, false),
                    "Each drop starts 1 mm above its own touch; where curves lie on each other, resolutions agree.");
    r.report.figure(report::toSvg(fissure, false),
                    "Each drop starts 1 mm above its own touch. The hull covers the fissure and so touches higher up.");
    r.report.table({"resolution", "method", "place", "the depth", "so it is", "least rise [um]"}, cells,
                   "Every drop in steps of 5 um. Open drops must rise strictly; where walls face the bur it may stand "
                   "still, but not fall (to a nanometre).");
    r.report.heading("Figure 10: the same drop onto the plane");
    r.report.figure(shots10, "The slab whose top is the paper's plane, and the bur every 0.25 mm.");
    r.report.figure(report::toSvg(plane, false), "Both methods on the plane.");
}

struct ForceRun {
    const char *motion, *method, *mode;
    double speedMmS;
};

/// A run at 1 kHz by a normal hand; adds it to `rows` and gives its curve.
report::Series forceRun(Reproduction& r, const ForceRun& what, Json extra, Json& rows,
                        std::vector<std::vector<std::string>>& cells) {
    const Surface& s = pictured(r);
    const auto fresh = [&]() -> std::unique_ptr<contact::Method> {
        if (std::string_view(what.method) == "hull") return contact::makeHullMethod(s.tooth->outer, r.bur->mesh());
        return contact::makeFieldMethod(s.tooth, r.bur);
    };
    std::unique_ptr<contact::Method> method = fresh();
    studies::MotionOptions options;
    options.speedMmS = what.speedMmS;
    options.depthMm = std::string_view(what.motion) == "drop" ? 8.0 : 4.0;
    options.dwellS = r.quick ? 0.3 : 0.6;
    const device::Motion motion = studies::motionByName(what.motion, *method, s.tooth->outer.bounds(), options);
    RunSettings settings;
    settings.parameters.law = force::lawByName(what.mode);
    const RunRecord run = recordRun(settings, motion, std::move(method));
    const double limitN = settings.device.capability.maxForceN;
    const bool under = run.summary.peakForceN <= limitN;
    report::Series curve;
    for (const messages::HapticSample& sample : run.samples) {
        curve.x.push_back(sample.timeS);
        curve.y.push_back(forceOf(sample));
    }
    Json row = std::move(extra);
    row.update({{"resolution", s.name},
                {"motion", what.motion},
                {"method", what.method},
                {"force_mode", what.mode},
                {"speed_mm_s", what.speedMmS},
                {"peak_n", run.summary.peakForceN},
                {"limit_n", limitN},
                {"under_limit", under},
                {"contact_s", run.summary.contactS},
                {"deepest_mm", run.summary.deepestMm},
                {"paper", "under 3.3 N"},
                {"t_s", curve.x},
                {"force_n", curve.y}});
    rows.push_back(std::move(row));
    cells.push_back({what.motion, what.method, what.mode, fmt::format("{:.0f}", what.speedMmS),
                     fmt::format("{:.3f}", run.summary.peakForceN), fmt::format("{:.3f}", run.summary.contactS),
                     yesNo(under)});
    if (!under)
        r.remarks.push_back(fmt::format("A {} with {} ({}) reached {:.4f} N.", what.motion, what.method, what.mode,
                                        run.summary.peakForceN));
    return curve;
}

const std::vector<std::string> kForceHeader{"motion",         "method",      "force",      "approach [mm/s]",
                                            "peak force [N]", "contact [s]", "under 3.3 N"};
const report::Limit kPaperLimit{3.3, "3.3 N, the paper's device"};

void forces(Reproduction& r) {
    Json figure12 = Json::array(), figure13 = Json::array();
    std::vector<std::vector<std::string>> cells12, cells13;
    r.report.heading("Figure 12: force against time");
    std::vector<std::vector<std::string>> cells12a;
    reproduceCutForces(r, pictured(r), figure12, cells12a);
    r.report.table({"", "motion", "peak force [N]", "removed [mm3]", "under 3.3 N"}, cells12a,
                   "The same motions with the bur turning at full speed and with a still bur.");
    for (const char* motion : {"press", "drag"}) {
        report::Plot plot{
            fmt::format("(b) touching, by every method: a {}", motion), "time [s]", "force [N]", {}, {kPaperLimit}};
        for (const char* mode : {"proxy", "penalty"})
            for (const char* method : {"field", "hull"}) {
                r.step("forces while touching");
                report::Series curve = forceRun(r, {motion, method, mode, 10.0}, {{"part", "b"}}, figure12, cells12);
                curve.name = fmt::format("{}, {}", method, mode);
                curve.dashed = std::string_view(method) == "hull";
                plot.series.push_back(std::move(curve));
            }
        r.report.figure(
            report::toSvg(plot, false),
            fmt::format("A normal hand on the simulated device at 1 kHz, on the tooth of {}.", pictured(r).name));
    }
    r.report.table(kForceHeader, cells12, "Touching, by both methods and both forces.");
    r.report.heading("Figure 13: approaching slowly and quickly");
    struct Approach {
        const char* name;
        double speedMmS;
    };
    for (const Approach& approach : {Approach{"low", 10.0}, Approach{"high", 80.0}}) {
        report::Plot plot{fmt::format("{} speed: {:.0f} mm/s", approach.name, approach.speedMmS),
                          "time [s]",
                          "force [N]",
                          {},
                          {kPaperLimit}};
        for (const char* mode : {"penalty", "proxy"})
            for (const char* method : {"field", "hull"}) {
                r.step("approaches");
                report::Series curve = forceRun(r, {"drop", method, mode, approach.speedMmS},
                                                {{"approach", approach.name}}, figure13, cells13);
                curve.name = fmt::format("{}, {}", method, mode);
                curve.dashed = std::string_view(method) == "hull";
                plot.series.push_back(std::move(curve));
            }
        r.report.figure(report::toSvg(plot, false),
                        "The penalty force is the paper's: spring on the depth, damper on the approach.");
    }
    r.report.table(kForceHeader, cells13, "All runs of Figure 13. The speed is the approach's, not the rotation's.");
    r.results["figure12"] = std::move(figure12);
    r.results["figure13"] = std::move(figure13);
}

}  // namespace

std::vector<NamedMethod> methodsOf(const Surface& s) {
    return {{"field", s.field.get()}, {"hull", s.hull.get()}};
}

std::vector<Place> placesOn(const Surface& s) {
    const core::Box box = s.tooth->outer.bounds();
    const core::Vec2 centre(box.centre().x(), box.centre().y());
    if (s.isPlane())
        return {{"middle", centre, true},
                {"across an edge", centre + core::Vec2(0.5, 0.27), true},
                {"within a face", centre + core::Vec2(-2.31, 1.62), true}};
    constexpr int kSide = 21;
    constexpr double kShare = 0.7;  // of the crown's width
    const core::Vec3 size = box.size();
    std::array<std::array<double, kSide>, kSide> height{};
    const auto at = [&](int i, int j) {
        return core::Vec2(centre.x() + kShare * size.x() * (static_cast<double>(i) / (kSide - 1) - 0.5),
                          centre.y() + kShare * size.y() * (static_cast<double>(j) / (kSide - 1) - 0.5));
    };
    for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j)
            height[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
                touchAt(*s.field, box, at(i, j)).positionMm.z();
    struct Peak {
        double z;
        int i, j;
    };
    std::vector<Peak> peaks, pits;
    for (int i = 1; i + 1 < kSide; ++i)
        for (int j = 1; j + 1 < kSide; ++j) {
            const auto h = [&](int di, int dj) {
                return height[static_cast<std::size_t>(i + di)][static_cast<std::size_t>(j + dj)];
            };
            bool peak = true, pit = true;
            for (int di = -1; di <= 1; ++di)
                for (int dj = -1; dj <= 1; ++dj)
                    if (di != 0 || dj != 0) {
                        peak = peak && h(0, 0) > h(di, dj);
                        pit = pit && h(0, 0) < h(di, dj);
                    }
            if (peak) peaks.push_back({h(0, 0), i, j});
            if (pit) pits.push_back({h(0, 0), i, j});
        }
    std::sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.z > b.z; });
    std::sort(pits.begin(), pits.end(), [](const Peak& a, const Peak& b) { return a.z < b.z; });
    constexpr std::size_t kCusps = 4;
    std::vector<Place> places;
    for (std::size_t k = 0; k < std::min(kCusps, peaks.size()); ++k)
        places.push_back({fmt::format("cusp {}", k + 1), at(peaks[k].i, peaks[k].j), true});
    if (!pits.empty()) places.push_back({"fissure", at(pits.front().i, pits.front().j), false});
    // A tooth without either (an incisor's edge) is felt in its middle.
    if (places.empty()) places.push_back({"cusp 1", centre, true});
    return places;
}

void reproduceFigures(Reproduction& r) {
    drops(r);
    reproduceCutPictures(r, pictured(r));
    forces(r);
}

}  // namespace handpiece::studies
