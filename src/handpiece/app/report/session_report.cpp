// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/session_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <vector>

#include "handpiece/app/report/report_figures.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/senses/view/renderer.h"

namespace handpiece::report {
namespace {

constexpr double kSectionPixelMm = 0.03;

constexpr std::string_view kStyle = R"(
@page { size: A4; margin: 14mm; }
body { font: 10.5pt/1.4 "Helvetica Neue", Arial, sans-serif; color: #1c2430; background: #fff; max-width: 182mm; margin: 8mm auto; }
h1 { font-size: 17pt; margin: 0 0 1mm; } h2 { font-size: 12pt; margin: 6mm 0 2mm; border-bottom: 0.3mm solid #9aa5b4; }
.note { color: #59636f; font-size: 9pt; }
table { border-collapse: collapse; width: 100%; font-size: 9.5pt; }
th { text-align: left; vertical-align: bottom; border-bottom: 0.4mm solid #8a93a3; padding: 0.6mm 2mm; }
td { border-bottom: 0.2mm solid #dfe3e8; padding: 0.6mm 2mm; } th.n, td.n { text-align: right; } .when { width: 20mm; } table { margin-bottom: 3mm; } td.n { font-variant-numeric: tabular-nums; }
.two { display: grid; grid-template-columns: 1fr 1fr; gap: 0 6mm; }
.pictures { display: grid; grid-template-columns: 1fr 1fr; gap: 2mm; } figure { margin: 0; }
.pictures img { width: 100%; display: block; } .missing { border: 0.3mm dashed #8a93a3; padding: 4mm; }
figcaption { color: #59636f; font-size: 8.5pt; }
.chip { display: inline-block; width: 3.5mm; height: 3.5mm; border: 0.2mm solid #59636f; vertical-align: -0.5mm; margin: 0 1mm 0 3mm; }
.ok { color: #1d7a3f; font-weight: 600; } .bad { color: #c62828; font-weight: 600; }
svg { width: 100%; height: auto; display: block; } svg text { font-size: 11px; fill: #59636f; } svg .label { fill: #1c2430; }
svg .axis path { stroke: #59636f; fill: none; } svg .line { stroke: #0b62a4; fill: none; stroke-width: 1.2; }
svg .mark { stroke: #c9762b; stroke-width: 0.8; stroke-dasharray: 3 2; }
@media print { body { margin: 0; max-width: none; } h2 { break-after: avoid; } figure, tr, svg { break-inside: avoid; }
* { print-color-adjust: exact; -webkit-print-color-adjust: exact; } }
)";

/// A table of two columns: what, and how much.
class Facts {
  public:
    void add(std::string_view what, const std::string& value) {
        rows_ += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td></tr>\n", escapedText(what), escapedText(value));
    }
    [[nodiscard]] std::string html(std::string_view caption) const {
        return fmt::format("<table><thead><tr><th colspan=\"2\">{}</th></tr></thead><tbody>\n{}</tbody></table>\n",
                           escapedText(caption), rows_);
    }

  private:
    std::string rows_;
};

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
        if (!update.removedDepthMm || !update.mesh) continue;
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

std::string dataAddress(const view::Image& image) {
    const core::PrivateFolder folder;
    const std::filesystem::path file = folder.path() / "picture.png";
    view::writePng(image, file);
    const std::vector<std::byte> bytes = core::readFile(file);
    std::vector<std::uint8_t> numbers(bytes.size());
    std::transform(bytes.begin(), bytes.end(), numbers.begin(),
                   [](std::byte b) { return std::to_integer<std::uint8_t>(b); });
    return "data:image/png;base64," + base64Of(numbers);
}

class Artist {
  public:
    Artist(const simulation::SessionPlayer& player, const ReportSettings& settings)
        : bounds_(player.station().tooth->tooth->outer.bounds()),
          buccal_(player.toothCase().buccalSign),
          viewport_{settings.pictureWidth, settings.pictureHeight} {
        renderer_.setTooth(bounds_);
        renderer_.updateBricks(player.tooth()->wholeSurface(), true);
        look_.quality = view::Quality::fine;
        look_.palette = view::Palette::textbook;
        look_.bur = look_.turbine = look_.debris = look_.spray = false;
        look_.scaleBar = true;
        look_.backgroundTop = look_.backgroundBottom = {236, 239, 243};
        moment_.burShown = false;
    }
    void cut(const std::vector<surface::BrickUpdate>& news) { renderer_.updateBricks(news); }
    [[nodiscard]] std::string picture(view::StandardView from, view::ToothShown shown, std::string_view caption) {
        look_.tooth = shown;
        return drawn(view::standardView(from, bounds_, buccal_, viewport_), caption);
    }
    [[nodiscard]] std::string section(const simulation::LiveTooth& tooth, const core::Vec3& atMm,
                                      std::string_view caption) {
        const core::Vec3 normal = core::Vec3::UnitX();
        const double offset = normal.dot(atMm);
        const measure::Section s = tooth.withProbe(
            [&](const measure::ToothProbe& probe) { return probe.section(normal, offset, kSectionPixelMm); });
        view::SectionFace face;
        face.plane = {normal, offset};
        face.originMm = s.originMm;
        face.uAxis = s.uAxis;
        face.vAxis = s.vAxis;
        face.mmPerPixel = s.mmPerPixel;
        face.width = s.width;
        face.height = s.height;
        face.tissue = s.tissue;
        renderer_.setSectionFace(std::move(face));
        look_.tooth = view::ToothShown::now;
        look_.cutAway = view::Plane{normal, offset};
        look_.sectionGrid = true;
        std::string html = drawn(view::standardView(view::StandardView::mesial, bounds_, buccal_, viewport_), caption);
        look_.cutAway.reset();
        return html;
    }
    [[nodiscard]] static std::string legend(const std::vector<cases::Tissue>& tissues) {
        std::string html = "<p class=\"note\">";
        for (const view::LegendEntry& entry : view::legendOf(tissues, view::Palette::textbook))
            html +=
                fmt::format("<span class=\"chip\" style=\"background:#{:02x}{:02x}{:02x}\"></span>{}", entry.colour[0],
                            entry.colour[1], entry.colour[2], cases::properties(entry.tissue).name);
        return html + "</p>\n";
    }

  private:
    std::string drawn(const view::Camera& camera, std::string_view caption) {
        view::Image image;
        for (int i = 0; i < 8 && (renderer_.draw(camera, viewport_, look_, moment_, image).refining || i == 0); ++i) {
        }
        return fmt::format("<figure><img alt=\"{0}\" src=\"{1}\"><figcaption>{0}</figcaption></figure>\n",
                           escapedText(caption), dataAddress(image));
    }
    view::Renderer renderer_;
    core::Box bounds_;
    int buccal_;
    view::Viewport viewport_;
    view::Look look_;
    view::Moment moment_;
};

std::string picturesOf(const simulation::SessionPlayer& player, const ReportSettings& settings,
                       const std::vector<surface::BrickUpdate>& news, const Deepest& deepest) {
    if (!settings.pictures) return "<p class=\"missing\">No pictures were asked for.</p>\n";
    try {
        using view::StandardView, view::ToothShown;
        Artist artist(player, settings);
        std::string html = "<div class=\"pictures\">\n";
        html += artist.picture(StandardView::occlusal, ToothShown::before, "occlusal, before");
        artist.cut(news);
        html += artist.picture(StandardView::occlusal, ToothShown::now, "occlusal, after");
        html += artist.picture(StandardView::buccal, ToothShown::now, "buccal, after");
        if (deepest.depthMm > 0.0)
            html += artist.section(*player.tooth(), deepest.pointMm,
                                   "section through the deepest place, lines every millimetre");
        return html + "</div>\n" + Artist::legend(player.station().tooth->tissues.tissues());
    } catch (const core::Error& e) {
        return fmt::format("<p class=\"missing\">No pictures: {}</p>\n", escapedText(e.problem()));
    }
}

std::string volumesOf(const simulation::SessionPlayer& player, const SessionFigures& figures) {
    const tooth::TissueVolumes& whole = player.station().tooth->volumesMm3;
    std::string html =
        "<table><thead><tr><th>tissue</th><th class=\"n\">before [mm³]</th><th class=\"n\">removed [mm³]</th><th "
        "class=\"n\">left [mm³]</th><th class=\"n\">removed [%]</th></tr></thead><tbody>\n";
    for (const cases::Tissue tissue : player.station().tooth->tissues.tissues()) {
        const auto t = static_cast<std::size_t>(tissue);
        const double before = whole[t], gone = figures.removedMm3[t];
        html += fmt::format(
            "<tr><td>{}</td><td class=\"n\">{:.2f}</td><td class=\"n\">{:.3f}</td><td class=\"n\">{:.2f}</td><td "
            "class=\"n\">{:.1f}</td></tr>\n",
            cases::properties(tissue).name, before, gone, before - gone, before > 0.0 ? 100.0 * gone / before : 0.0);
    }
    return html + "</tbody></table>\n";
}

/// {"removed_mm3": 2.9} as "removed mm3 2.9"; what is no such object as it is.
std::string wordsOf(const std::string& text) {
    const auto json = nlohmann::ordered_json::parse(text, nullptr, false);
    if (!json.is_object()) return text;
    std::string words;
    for (const auto& [key, value] : json.items()) {
        std::string name = key;
        std::replace(name.begin(), name.end(), '_', ' ');
        words += fmt::format("{}{} {}", words.empty() ? "" : ", ", name,
                             value.is_string() ? value.get<std::string>() : value.dump());
    }
    return words;
}

std::string eventsOf(const simulation::SessionPlayer& player) {
    std::string html =
        "<table><thead><tr><th class=\"n when\">time</th><th>event</th><th>about</th></tr></thead><tbody>\n";
    simulation::SimulationSettings now = simulation::settingsFromJson(player.reader().info().settings, "session");
    for (const session::Event& e : player.events()) {
        std::string about;
        if (e.name == session::nameOf(session::EventName::burChange) ||
            e.name == session::nameOf(session::EventName::parameterChange)) {
            const simulation::Changed changed = simulation::applyChange(e.text, now, "session");
            if (changed.work)
                about = fmt::format("{}, {}{}", now.bur->name(), now.cuttingParameters.name,
                                    now.hull ? ", hull: touching only" : "");
            if (changed.drive) about = now.drive.name;
            if (changed.parameters)
                about = fmt::format("stiffness x {:.3g}, damping x {:.3g}, friction x {:.3g}",
                                    now.parameters.stiffnessMultiplier, now.parameters.dampingMultiplier,
                                    now.parameters.frictionMultiplier);
        } else if (e.name == session::nameOf(session::EventName::resume)) {
            const simulation::Resumption resumption = simulation::resumptionFromJson(e.text, "session");
            now = resumption.settings;
            about = fmt::format("{}, {}, tooth {}", resumption.isRecovered ? "its program had ended" : "after a pause",
                                now.bur->name(), resumption.stateHash);
        } else if (e.text.size() < 80) {
            about = wordsOf(e.text);
        }
        html += fmt::format("<tr><td class=\"n\">{:.2f} s</td><td>{}</td><td>{}</td></tr>\n",
                            static_cast<double>(e.tick) / player.reader().info().rateHz, escapedText(e.name),
                            escapedText(about));
    }
    return html + "</tbody></table>\n";
}

std::string settingsOf(const simulation::SimulationSettings& s) {
    Facts facts;
    facts.add("bur at the start", fmt::format("{} ({})", s.bur->name(), s.cuttingParameters.name));
    facts.add("handpiece", fmt::format("{}, {:.0f} rpm free, {:.2g} N mm", s.drive.name, s.drive.freeSpeedRpm,
                                       s.drive.stallTorqueNmm));
    facts.add("device", fmt::format("{}, at most {:.2f} N", s.capability.name, s.capability.maxForceN));
    facts.add("stiffness, damping, friction",
              fmt::format("x {:.3g}, x {:.3g}, x {:.3g}", s.parameters.stiffnessMultiplier,
                          s.parameters.dampingMultiplier, s.parameters.frictionMultiplier));
    facts.add("contact", s.hull ? "hulls" : "field");
    facts.add("voxel", fmt::format("{:.0f} µm", 1000.0 * s.field.voxelMm));
    return facts.html("Settings");
}

}  // namespace

std::string sessionReport(simulation::SessionPlayer& player, const ReportSettings& settings,
                          const core::Progress& progress) {
    const session::SessionInfo& info = player.reader().info();
    const simulation::SimulationSettings first = simulation::settingsFromJson(info.settings, "session");
    const simulation::Verdict verdict = player.compareAll(core::part(progress, 0.0, 0.7));
    const SessionFigures f = figuresOf(player.reader());
    core::report(progress, 0.75);
    const std::vector<simulation::PlotPoint> points =
        player.plot(std::max(simulation::kPlotStepS, player.durationS() / 2000.0));
    simulation::LiveTooth& live = *player.tooth();
    live.wantRemovedDepths(true);
    live.refresh();
    const std::vector<surface::BrickUpdate> news = live.takeNews();
    const Deepest deepest = deepestOf(news);
    const auto thinnest = live.withProbe([](const measure::ToothProbe& probe) { return probe.thinnestOverPulp(); });
    core::report(progress, 0.85);

    const std::string& name = player.toothCase().name;
    const double removed = std::accumulate(f.removedMm3.begin(), f.removedMm3.end(), 0.0);
    std::string body = fmt::format("<h1>Session report: {}</h1>\n<p class=\"note\">", escapedText(name));
    body += info.code.empty() ? std::string("no code was given") : "code " + escapedText(info.code);
    body += fmt::format("; recorded by handpiece {} at {:.0f} ticks a second; the session holds no date</p>\n",
                        escapedText(info.version), info.rateHz);

    body += "<h2>The tooth</h2>\n" + picturesOf(player, settings, news, deepest) + volumesOf(player, f);
    Facts cavity, times, forces, record;
    cavity.add("removed in all", fmt::format("{:.3f} mm³", removed));
    cavity.add("deepest below the uncut surface", fmt::format("{:.2f} mm", deepest.depthMm));
    cavity.add("least over the pulp, where it was cut",
               thinnest ? fmt::format("{:.2f} mm", thinnest->leftMm) : "no cut surface over a pulp");
    times.add("total", clock(f.totalS));
    times.add("pedal down", clock(f.pedalS));
    times.add("in contact", clock(f.contactS));
    times.add("cutting", clock(f.cuttingS));
    forces.add("mean force in contact", fmt::format("{:.3f} N", f.meanForceN));
    forces.add("95 % below", fmt::format("{:.3f} N", f.p95ForceN));
    forces.add("peak", fmt::format("{:.3f} N", f.peakForceN));
    forces.add("of the contact at the device's limit", fmt::format("{:.1f} %", 100.0 * f.limitedShare));
    forces.add("mean speed while cutting", fmt::format("{:.0f} rpm", f.meanCuttingRpm));
    forces.add("highest speed", fmt::format("{:.0f} rpm", f.mostRpm));
    record.add("ticks recorded", fmt::format("{}", f.ticks));
    record.add("periods left out (the machine was late)", fmt::format("{}", f.missedPeriods));
    record.add("closed properly", verdict.complete ? "yes" : "no: it was cut off");
    record.add("ticks that differ when cut again", fmt::format("{}", verdict.differingTicks));
    if (verdict.seams > 0)
        record.add("gone on with, on the tooth of before",
                   fmt::format("{} of {} times", verdict.seams - verdict.brokenSeams, verdict.seams));
    body += "<h2>Figures</h2>\n<div class=\"two\"><div>" + cavity.html("Cavity") + times.html("Times") + "</div><div>" +
            forces.html("Force and speed") + "</div></div>\n";

    std::vector<EventMark> marks;
    for (const session::Event& e : player.events())
        marks.push_back({static_cast<double>(e.tick) / info.rateHz, e.name});
    body += "<h2>Over time</h2>\n<p class=\"note\">Dashed: events, listed below.</p>\n";
    body += timePlot(points, &simulation::PlotPoint::forceN, marks, "force on the hand", "N");
    body += timePlot(points, &simulation::PlotPoint::depthMm, marks, "depth of the hand's bur in the tooth", "mm");
    body += timePlot(points, &simulation::PlotPoint::speedRpm, marks, "speed of the bur", "rpm");

    body += "<h2>Events</h2>\n" + eventsOf(player);
    body += "<h2>How it was recorded</h2>\n<div class=\"two\"><div>" + settingsOf(first) + "</div><div>" +
            record.html("Record") + "</div></div>\n";
    body +=
        verdict.matches
            ? fmt::format(
                  "<p class=\"ok\">Cut again from the record, the tooth is the same, bit for bit (state {}).</p>\n",
                  verdict.hash)
            : fmt::format("<p class=\"bad\">{} (state {})</p>\n",
                          verdict.recorded.empty() ? "The session was cut off before it told a state to compare with."
                          : verdict.brokenSeams > 0
                              ? "Where the session goes on after a pause, it does so on another tooth than was left."
                              : "Cut again from the record, the tooth is another.",
                          verdict.hash);
    core::report(progress, 1.0);
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Session report: {}</title>\n"
        "<style>{}</style></head>\n<body>\n{}</body></html>\n",
        escapedText(name), kStyle, body);
}

}  // namespace handpiece::report
