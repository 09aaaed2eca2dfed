// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/session_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "handpiece/app/report/artist.h"
#include "handpiece/app/report/page_png.h"
#include "handpiece/app/report/plot.h"
#include "handpiece/app/report/report_figures.h"
#include "handpiece/base/config/outside_json.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"

namespace handpiece::report {
namespace {

using Tone = HtmlReport::Tone;
using Group = HtmlReport::Group;
using config::words;
using Facts = std::vector<std::pair<std::string, std::string>>;

std::string clock(double seconds) {
    const auto tenths = static_cast<long>(seconds * 10.0 + 0.5);
    return tenths < 600 ? fmt::format("{:.1f} s", static_cast<double>(tenths) / 10.0)
                        : fmt::format("{} min {:04.1f} s", tenths / 600, static_cast<double>(tenths % 600) / 10.0);
}

/// The cut's deepest place below the uncut surface.
struct Deepest {
    core::Vec3 pointMm = core::Vec3::Zero();
    double depthMm = 0.0;
};

Deepest deepestOf(const std::vector<surface::BrickUpdate>& updates) {
    Deepest deepest;
    for (const surface::BrickUpdate& update : updates) {
        if (!update.removedDepthMm || !update.mesh || tooth::toothOf(update.id) != 0) continue;
        for (std::size_t i = 0; i < update.removedDepthMm->size(); ++i) {
            const double depth = static_cast<double>((*update.removedDepthMm)[i]);
            if (depth <= deepest.depthMm) continue;
            const auto& p = update.mesh->vertices[i].positionMm;
            deepest = {core::Vec3(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])),
                       depth};
        }
    }
    return deepest;
}

void addPictures(HtmlReport& page, const simulation::SessionPlayer& player, const ReportSettings& settings,
                 const std::vector<surface::BrickUpdate>& news, const Deepest& deepest) {
    if (!settings.pictures) return page.paragraph(words()("report.no-pictures-asked"), Tone::missing);
    using view::StandardView, view::ToothShown;
    std::vector<std::pair<std::vector<std::byte>, std::string>> pictures;
    try {
        Artist artist(player, {settings.pictureWidth, settings.pictureHeight});
        pictures.emplace_back(pagePng(artist.picture(StandardView::occlusal, ToothShown::before)),
                              words()("session.occlusal-before"));
        artist.cut(news);
        pictures.emplace_back(pagePng(artist.picture(StandardView::occlusal, ToothShown::now)),
                              words()("session.occlusal-after"));
        pictures.emplace_back(pagePng(artist.picture(StandardView::buccal, ToothShown::now)),
                              words()("session.buccal-after"));
        if (deepest.depthMm > 0.0)
            pictures.emplace_back(pagePng(artist.section(*player.tooth(), deepest.pointMm)),
                                  words()("session.section"));
    } catch (const core::Error& e) {
        return page.paragraph(words()("report.no-pictures", e.problem()), Tone::missing);
    }
    page.begin(Group::pictures);
    for (const auto& [png, caption] : pictures)
        page.picture(std::span(png), caption);
    page.end();
    page.legend(chipsOf(player.station().tooth->tissues.tissues()));
}

void addVolumes(HtmlReport& page, const simulation::SessionPlayer& player, const SessionFigures& figures) {
    const tooth::TissueVolumes& uncut = player.station().tooth->volumesMm3;
    std::vector<std::vector<std::string>> rows;
    for (const cases::Tissue tissue : player.station().tooth->tissues.tissues()) {
        const auto t = static_cast<std::size_t>(tissue);
        const double before = uncut[t], gone = figures.removedMm3[t];
        rows.push_back({nameOf(tissue), fmt::format("{:.2f}", before), fmt::format("{:.3f}", gone),
                        fmt::format("{:.2f}", before - gone),
                        fmt::format("{:.1f}", before > 0.0 ? 100.0 * gone / before : 0.0)});
    }
    page.table({words()("report.tissue"), words()("session.before-mm3"), words()("session.removed-mm3"),
                words()("session.left-mm3"), words()("session.removed-percent")},
               rows);
    rows.clear();
    for (const simulation::NickedTooth& tooth : simulation::nickedTeeth(player.station()))
        for (const cases::Tissue tissue : player.station().others[tooth.number - 1u].model->tissues.tissues())
            if (const double gone = tooth.removedMm3[static_cast<std::size_t>(tissue)]; gone > 0.0)
                rows.push_back({tooth.name, nameOf(tissue), fmt::format("{:.3f}", gone)});
    if (rows.empty()) return;
    page.heading(words()("session.other-teeth"));
    page.table({words()("session.tooth"), words()("report.tissue"), words()("session.removed-mm3")}, rows);
}

/// A line plot of one member of the points over time, with marks at the events.
std::string timePlot(const std::vector<simulation::PlotPoint>& points, float simulation::PlotPoint::*value,
                     const std::vector<Mark>& marks, const std::string& label) {
    Plot plot{{}, words()("report.time-axis"), label, {{}}, {}, marks};
    plot.height = 220;
    for (const simulation::PlotPoint& p : points) {
        plot.series[0].x.push_back(p.timeS);
        plot.series[0].y.push_back(static_cast<double>(p.*value));
    }
    return toSvg(plot, false);
}

/// {"removed_mm3": 2.9} as "removed mm3 2.9"; what is no such object as it is.
std::string readable(const std::string& text) {
    const auto json = config::outsideJson<nlohmann::ordered_json>(text);
    if (!json.is_object()) return text;
    std::string all;
    for (const auto& [key, value] : json.items()) {
        std::string name = key;
        std::replace(name.begin(), name.end(), '_', ' ');
        all += fmt::format("{}{} {}", all.empty() ? "" : ", ", name,
                           value.is_string() ? value.get<std::string>() : value.dump());
    }
    return all;
}

void addEvents(HtmlReport& page, const simulation::SessionPlayer& player) {
    std::vector<std::vector<std::string>> rows;
    simulation::SimulationSettings now = simulation::settingsFromJson(player.reader().info().settings, "session");
    for (const session::Event& e : player.events()) {
        std::string about;
        if (e.name == session::nameOf(session::EventName::burChange) ||
            e.name == session::nameOf(session::EventName::parameterChange)) {
            const simulation::Changed changed = simulation::applyChange(e.text, now, "session");
            if (changed.work)
                about = fmt::format("{}, {}{}", now.bur->name(), now.cuttingParameters.name,
                                    now.hull ? words()("session.touching-only") : "");
            if (changed.drive) about = now.drive.name;
            if (changed.parameters)
                about = words()("session.multipliers", now.parameters.stiffnessMultiplier,
                                now.parameters.dampingMultiplier, now.parameters.frictionMultiplier);
        } else if (e.name == session::nameOf(session::EventName::resume)) {
            const simulation::Resumption resumption = simulation::resumptionFromJson(e.text, "session");
            now = resumption.settings;
            about = resumption.isRecovered
                        ? words()("session.resumed-after-its-end", now.bur->name(), resumption.stateHash)
                        : words()("session.resumed-after-a-pause", now.bur->name(), resumption.stateHash);
        } else if (e.name == session::nameOf(session::EventName::scheduling)) {
            const auto json = config::outsideJson<nlohmann::ordered_json>(e.text);
            const std::string id =
                "scheduling.class." + (json.is_object() && json.contains("class") && json["class"].is_string()
                                           ? json["class"].get<std::string>()
                                           : "");
            if (words().has(id)) about = words().text(id);
        } else if (e.text.size() < 80) {
            about = readable(e.text);
        }
        rows.push_back(
            {fmt::format("{:.2f} s", static_cast<double>(e.tick) / player.reader().info().rateHz), e.name, about});
    }
    page.table({words()("session.time"), words()("session.event"), words()("session.about")}, rows);
}

Facts settingsOf(const simulation::SimulationSettings& s) {
    return {{words()("session.bur-at-start"), fmt::format("{} ({})", s.bur->name(), s.cuttingParameters.name)},
            {words()("session.handpiece"),
             words()("session.drive", s.drive.name, s.drive.freeSpeedRpm, s.drive.stallTorqueNmm)},
            {words()("session.device"), words()("session.device-limit", s.capability.name, s.capability.maxForceN)},
            {words()("session.multipliers-name"),
             fmt::format("x {:.3g}, x {:.3g}, x {:.3g}", s.parameters.stiffnessMultiplier,
                         s.parameters.dampingMultiplier, s.parameters.frictionMultiplier)},
            {words()("session.contact"), s.hull ? words()("session.hulls") : words()("session.field")},
            {words()("session.voxel"), fmt::format("{:.0f} µm", 1000.0 * s.field.voxelMm)}};
}

}  // namespace

std::string nameOf(cases::Tissue tissue) {
    return words()(fmt::format("tissue.{}", cases::properties(tissue).name));
}

std::vector<HtmlReport::Chip> chipsOf(const std::vector<cases::Tissue>& tissues) {
    std::vector<HtmlReport::Chip> chips;
    for (const view::LegendEntry& entry : view::legendOf(tissues, view::Palette::textbook))
        chips.push_back({{entry.colour[0], entry.colour[1], entry.colour[2]}, nameOf(entry.tissue)});
    return chips;
}

std::string sessionReport(simulation::SessionPlayer& player, const ReportSettings& settings,
                          const core::Progress& progress) {
    const session::SessionInfo& info = player.reader().info();
    const simulation::SimulationSettings first = simulation::settingsFromJson(info.settings, "session");
    ReviewGatherer gatherer(settings.pictures ? kReviewPictures : 0, settings.against.task);
    gatherer.follow(player);
    const simulation::Verdict verdict =
        player.compareAll(core::part(progress, 0.0, 0.7), {ReviewGatherer::stepS(), [&gatherer] { gatherer.look(); }});
    const SessionFigures f = figuresOf(player.reader());
    core::report(progress, 0.75);
    const std::vector<simulation::PlotPoint> points =
        player.plot(std::max(simulation::kPlotStepS, player.durationS() / 2000.0));
    simulation::LiveTooth& live = *player.tooth();
    live.wantRemovedDepths(true);
    live.settle();
    // All of it again: the pictures along the way have had their news.
    static_cast<void>(live.uncutSurface());
    const std::vector<surface::BrickUpdate> news = live.takeNews();
    const Deepest deepest = deepestOf(news);
    const auto thinnest = live.withProbe([](const measure::ToothProbe& probe) { return probe.thinnestOverPulp(); });
    core::report(progress, 0.85);

    const double removed = std::accumulate(f.removedMm3.begin(), f.removedMm3.end(), 0.0);
    const std::string title = words()("session.title", player.toothCase().name);
    HtmlReport page(title);
    page.paragraph(
        words()("session.recorded", info.code.empty() ? words()("session.no-code") : words()("session.code", info.code),
                info.version, info.rateHz),
        Tone::note);
    page.reviewHere();
    page.heading(words()("report.the-tooth"));
    addPictures(page, player, settings, news, deepest);
    addVolumes(page, player, f);
    page.heading(words()("session.figures"));
    page.begin(Group::columns);
    page.facts(words()("session.cavity"),
               {{words()("session.removed-in-all"), fmt::format("{:.3f} mm³", removed)},
                {words()("session.deepest"), fmt::format("{:.2f} mm", deepest.depthMm)},
                {words()("session.least-over-pulp"),
                 thinnest ? fmt::format("{:.2f} mm", thinnest->leftMm) : words()("session.no-cut-over-pulp")}});
    Facts times{{words()("session.total"), clock(f.totalS)},
                {words()("session.pedal-down"), clock(f.pedalS)},
                {words()("session.in-contact"), clock(f.contactS)},
                {words()("session.cutting"), clock(f.cuttingS)}};
    if (f.byMirrorS > 0.0) times.emplace_back(words()("session.by-mirror"), clock(f.byMirrorS));
    if (f.fingerRestS > 0.0) times.emplace_back(words()("session.finger-rest"), clock(f.fingerRestS));
    for (const auto& [hour, seconds] : f.atHourS)
        times.emplace_back(words()("session.at-hour", hour), clock(seconds));
    page.facts(words()("session.times"), times);
    page.facts(words()("session.force-and-speed"),
               {{words()("session.mean-force"), fmt::format("{:.3f} N", f.meanForceN)},
                {words()("session.p95-force"), fmt::format("{:.3f} N", f.p95ForceN)},
                {words()("session.peak-force"), fmt::format("{:.3f} N", f.peakForceN)},
                {words()("session.limited"), fmt::format("{:.1f} %", 100.0 * f.limitedShare)},
                {words()("session.mean-speed"), fmt::format("{:.0f} rpm", f.meanCuttingRpm)},
                {words()("session.highest-speed"), fmt::format("{:.0f} rpm", f.mostRpm)}});
    page.end();

    std::vector<Mark> marks;
    for (const session::Event& e : player.events())
        marks.push_back({static_cast<double>(e.tick) / info.rateHz, e.name});
    page.heading(words()("session.over-time"));
    page.paragraph(words()("session.dashed"), Tone::note);
    page.figure(timePlot(points, &simulation::PlotPoint::forceN, marks, words()("session.force-axis")), {});
    page.figure(timePlot(points, &simulation::PlotPoint::depthMm, marks, words()("session.depth-axis")), {});
    page.figure(timePlot(points, &simulation::PlotPoint::speedRpm, marks, words()("session.speed-axis")), {});
    page.heading(words()("session.events"));
    addEvents(page, player);

    Facts record{
        {words()("session.ticks"), fmt::format("{}", f.ticks)},
        {words()("session.periods-left-out"), fmt::format("{}", f.missedPeriods)},
        {words()("session.closed-properly"), verdict.complete ? words()("session.closed") : words()("session.cut-off")},
        {words()("session.differing-ticks"), fmt::format("{}", verdict.differingTicks)}};
    if (verdict.seams > 0)
        record.emplace_back(words()("session.gone-on"),
                            words()("session.times-of", verdict.seams - verdict.brokenSeams, verdict.seams));
    page.heading(words()("session.how-recorded"));
    page.begin(Group::columns);
    page.facts(words()("session.settings"), settingsOf(first));
    page.facts(words()("session.record"), record);
    page.end();
    const std::string told = verdict.isOtherEngine()
                                 ? words()("session.other-engine", verdict.engineRevision, core::kEngineRevision)
                             : verdict.matches          ? words()("session.same")
                             : verdict.recorded.empty() ? words()("session.no-state")
                             : verdict.brokenSeams > 0  ? words()("session.another-after-pause")
                                                        : words()("session.another");
    page.paragraph(words()("session.state", told, verdict.hash), verdict.matches           ? Tone::good
                                                                 : verdict.isOtherEngine() ? Tone::note
                                                                                           : Tone::bad);
    if (!verdict.matches) gatherer.note(told);
    page.review(gatherer.review(title, settings.against, page.roomForReview()));
    core::report(progress, 1.0);
    return page.text();
}

}  // namespace handpiece::report
