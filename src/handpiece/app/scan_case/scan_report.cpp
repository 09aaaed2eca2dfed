// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/scan_case/scan_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/app/report/report_figures.h"
#include "handpiece/app/scan_case/scan_measures.h"
#include "handpiece/app/scan_case/scan_pictures.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/case/package.h"
#include "handpiece/senses/view/look.h"

namespace handpiece::scan_case {
namespace {

constexpr std::string_view kStyle = R"(
@page { size: A4; margin: 14mm; }
body { font: 10.5pt/1.4 "Helvetica Neue", Arial, sans-serif; color: #1c2430; background: #fff; max-width: 182mm; margin: 8mm auto; padding: 0 4mm; }
h1 { font-size: 17pt; margin: 0 0 1mm; } h2 { font-size: 12pt; margin: 6mm 0 2mm; border-bottom: 0.3mm solid #9aa5b4; }
.note { color: #59636f; font-size: 9pt; }
table { border-collapse: collapse; width: 100%; font-size: 9.5pt; margin-bottom: 3mm; }
th { text-align: left; vertical-align: bottom; border-bottom: 0.4mm solid #8a93a3; padding: 0.6mm 2mm; }
td { border-bottom: 0.2mm solid #dfe3e8; padding: 0.6mm 2mm; } th.n, td.n { text-align: right; font-variant-numeric: tabular-nums; }
.two { display: grid; grid-template-columns: 1fr 1fr; gap: 0 6mm; }
.pictures { display: grid; grid-template-columns: 1fr 1fr; gap: 2mm; } .slices { display: grid; grid-template-columns: 1fr 1fr 1fr; gap: 2mm; align-items: end; }
figure { margin: 0; } figure img { width: 100%; display: block; } .slices img { max-height: 90mm; object-fit: contain; background: #000; }
.missing { border: 0.3mm dashed #8a93a3; padding: 4mm; } figcaption { color: #59636f; font-size: 8.5pt; }
.chip { display: inline-block; width: 3.5mm; height: 3.5mm; border: 0.2mm solid #59636f; vertical-align: -0.5mm; margin: 0 1mm 0 3mm; }
.ok { color: #1d7a3f; font-weight: 600; } .bad { color: #c62828; font-weight: 600; }
.try { border: 0.4mm solid #0b62a4; border-radius: 2mm; padding: 3mm 4mm; background: #f2f7fc; break-inside: avoid; } .try h2 { margin-top: 0; }
code { font: 9.5pt/1.5 "DejaVu Sans Mono", Menlo, monospace; background: #eef1f5; padding: 0 1mm; } pre code { display: block; padding: 2mm; overflow-x: auto; }
@media print { body { margin: 0; padding: 0; max-width: none; } h2 { break-after: avoid; } figure, tr { break-inside: avoid; }
* { print-color-adjust: exact; -webkit-print-color-adjust: exact; } }
)";

/// A table whose first column is words and the others figures.
class Figures {
  public:
    explicit Figures(const std::vector<std::string>& head) {
        html_ = "<table><thead><tr>";
        for (std::size_t i = 0; i < head.size(); ++i)
            html_ += fmt::format("<th{}>{}</th>", i > 0 ? " class=\"n\"" : "", report::escapedText(head[i]));
        html_ += "</tr></thead><tbody>\n";
    }
    void row(const std::vector<std::string>& cells) {
        html_ += "<tr>";
        for (std::size_t i = 0; i < cells.size(); ++i)
            html_ += fmt::format("<td{}>{}</td>", i > 0 ? " class=\"n\"" : "", report::escapedText(cells[i]));
        html_ += "</tr>\n";
    }
    [[nodiscard]] std::string html() const { return html_ + "</tbody></table>\n"; }

  private:
    std::string html_;
};

std::string figure(const NamedPicture& picture) {
    return fmt::format("<figure><img alt=\"{0}\" src=\"{1}\"><figcaption>{0}</figcaption></figure>\n",
                       report::escapedText(picture.caption), dataAddressOf(picture.image));
}

std::vector<cases::Tissue> tissuesOf(const ScanMeasures& m) {
    std::vector<cases::Tissue> tissues;
    for (std::size_t t = 1; t < cases::kTissueCount; ++t)
        if (m.volumesMm3[t] > 0.0) tissues.push_back(static_cast<cases::Tissue>(t));
    return tissues;
}

std::string picturesOf(const ScanResult& result, const ScanReportSettings& settings, const ScanMeasures& m,
                       const core::Progress& progress) {
    if (!settings.pictures) return "<p class=\"missing\">No pictures were asked for.</p>\n";
    std::string html;
    try {
        html += "<div class=\"pictures\">\n";
        for (const NamedPicture& p : viewsOf(result, settings.pictureWidth, settings.pictureHeight, progress))
            html += figure(p);
        html += "</div>\n";
    } catch (const core::Error& e) {
        if (e.problem() == "cancelled") throw;
        html = fmt::format("<p class=\"missing\">No pictures of the tooth: {}</p>\n", report::escapedText(e.problem()));
    }
    html += "<p class=\"note\">";
    for (const view::LegendEntry& entry : view::legendOf(tissuesOf(m), view::Palette::textbook))
        html += fmt::format("<span class=\"chip\" style=\"background:#{:02x}{:02x}{:02x}\"></span>{}", entry.colour[0],
                            entry.colour[1], entry.colour[2], cases::properties(entry.tissue).name);
    return html + "</p>\n";
}

std::string slicesHtml(const ScanResult& result) {
    std::string html = "<div class=\"slices\">\n";
    for (const NamedPicture& p : slicesOf(result))
        html += figure(p);
    return html +
           "</div>\n<p class=\"note\">The line around all is the tooth's own surface; inside it each tissue's, "
           "in the colours above. They run between the voxels.</p>\n";
}

void thicknessRow(Figures& table, const char* what, const std::optional<Thickness>& t) {
    if (t)
        table.row({what, fmt::format("{:.2f}", t->leastMm), fmt::format("{:.2f}", t->medianMm),
                   fmt::format("{:.2f}", t->mostMm), std::to_string(t->places)});
    else
        table.row({what, "-", "-", "-", "0"});
}

std::string figuresOf(const ScanMeasures& m) {
    Figures volumes({"tissue", "volume [mm³]", "share"});
    for (const cases::Tissue t : tissuesOf(m)) {
        const double mm3 = m.volumesMm3[static_cast<std::size_t>(t)];
        volumes.row({std::string(cases::properties(t).name), fmt::format("{:.2f}", mm3),
                     fmt::format("{:.1f} %", 100.0 * mm3 / std::max(m.toothMm3, 1e-9))});
    }
    volumes.row({"the whole tooth", fmt::format("{:.2f}", m.toothMm3), ""});
    Figures sizes({"size", "mm"});
    sizes.row({"along mesial", fmt::format("{:.2f}", m.sizeMm.x())});
    sizes.row({"along buccal", fmt::format("{:.2f}", m.sizeMm.y())});
    sizes.row({"apex to cusp", fmt::format("{:.2f}", m.sizeMm.z())});
    sizes.row({"neck to cusp", fmt::format("{:.2f}", m.crownMm)});
    Figures thick({"thickness [mm]", "least", "median", "most", "places"});
    thicknessRow(thick, "enamel on top of the crown", m.enamelTop);
    thicknessRow(thick, "enamel of its sides", m.enamelSides);
    thicknessRow(thick, "dentine over the pulp, in the crown", m.dentineOverPulp);
    return "<div class=\"two\"><div>" + volumes.html() + "</div><div>" + sizes.html() + "</div></div>\n" +
           thick.html() +
           "<p class=\"note\">Volumes are counted below the voxel. Thickness is the nearest distance from a place on "
           "one "
           "surface to the next; on top: the crown's upper third where it looks up; sides: below, down to a quarter of "
           "its height.</p>\n";
}

std::string qualityOf(const ScanResult& result, const ScanMeasures& m) {
    Figures scan({"scan", ""});
    const volume::Series& s = result.scan->series;
    scan.row({"kind", fmt::format("{}{}{}", s.format, s.modality.empty() ? "" : ", ", s.modality)});
    scan.row({"voxels", fmt::format("{} x {} x {}", s.size[0], s.size[1], s.size[2])});
    const core::Vec3 spacing = result.scan->volume.grid.spacingMm;
    scan.row({"voxel of the scan",
              fmt::format("{:.1f} x {:.1f} x {:.1f} µm", 1e3 * spacing.x(), 1e3 * spacing.y(), 1e3 * spacing.z())});
    scan.row({"spacing", result.job.spacingMm ? "given by hand" : "as the file tells it"});
    scan.row({"voxel of the result", fmt::format("{:.1f} µm", 1e3 * m.voxelMm)});
    if (!result.labels) {
        const segmentation::Thresholds& t = result.region->thresholds;
        scan.row({"tooth, enamel from grey value", fmt::format("{:.5g}, {:.5g}", t.toothFrom, t.enamelFrom)});
        scan.row({"noise in dentine",
                  fmt::format("{:.4g} grey values, {:.0f} % of the step to enamel", m.noise, 100.0 * m.noiseShare)});
        if (m.blurMm > 0.0)
            scan.row({"blur (standard deviation)",
                      fmt::format("{:.0f} µm, {:.1f} voxels", 1e3 * m.blurMm, m.blurMm / m.scanVoxelMm)});
    }
    scan.row({"chewing surface found with confidence", fmt::format("{:.2f} of 1", result.placed.confidence)});
    scan.row({"mesial", result.placed.isMesialGuessed ? "guessed" : "given"});
    Figures surfaces(
        {"surface", "of full", "vertices", "faces", "volume [mm³]", "genus", "crossings", "off by at most"});
    bool isClosed = true;
    for (const SurfaceQuality& q : m.surfaces) {
        isClosed = isClosed && q.isClosed && q.crossings == 0;
        surfaces.row({q.name, fmt::format("{:g} %", std::round(10.0 * q.percent) / 10.0), std::to_string(q.vertices),
                      std::to_string(q.faces), fmt::format("{:.2f}", q.volumeMm3),
                      q.genus ? std::to_string(*q.genus) : "-", std::to_string(q.crossings),
                      fmt::format("{:.1f} µm", 1e3 * q.errorBoundMm)});
    }
    return scan.html() + surfaces.html() +
           fmt::format("<p class=\"{}\">{}</p>\n", isClosed ? "ok" : "bad",
                       isClosed ? "All surfaces are closed, two-manifold, oriented and do not cross themselves."
                                : "A surface is open or crosses itself: handpiece case check says which.");
}

/// For a shell, as it stands between blanks.
std::string shellText(const std::string& text) {
    if (!text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
            return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                   std::string_view("._-+").find(c) != std::string_view::npos;
        }))
        return text;
    std::string quoted = "'";
    for (const char c : text)
        quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

/// As a relative address.
std::string addressOf(const std::string& text) {
    std::string address;
    for (const char c : text) {
        const bool isPlain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                             std::string_view("._-").find(c) != std::string_view::npos;
        address += isPlain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return address;
}

std::string tryIt(const std::vector<std::filesystem::path>& places) {
    // One folder holds the page itself; several cases, or a file, stand beside it.
    const bool isWithin = places.size() == 1 && !cases::isPackageName(places[0]);
    std::string html = "<div class=\"try\"><h2>Try it now</h2>\n<p>In the folder that the case lies in:</p>\n";
    for (const std::filesystem::path& place : places) {
        const std::string name = place.filename().string();
        html += fmt::format(
            "<p><a href=\"{}\">{}</a></p>\n<pre><code>handpiece-desktop {}\nhandpiece run --case {} --bur 330 --motion "
            "class-one --out cavity\n"
            "handpiece picture {} --section x --grid --out section.png</code></pre>\n",
            isWithin ? "./case.toml" : addressOf(name), report::escapedText(name), report::escapedText(shellText(name)),
            report::escapedText(shellText(name)), report::escapedText(shellText(name)));
    }
    return html + "</div>\n";
}

}  // namespace

std::string scanReport(const ScanResult& result, const std::vector<std::filesystem::path>& places,
                       const ScanReportSettings& settings, const core::Progress& progress) {
    if (result.cases.empty() || places.size() != result.cases.size())
        throw core::Error("there is no case to report of", "report", "finish the scan's job first");
    const ScanMeasures m = measure(result, core::part(progress, 0.0, 0.3));
    const cases::Case& first = result.cases.front().toothCase;
    std::string body =
        fmt::format("<h1>Case from a scan: {}</h1>\n<p class=\"note\">", report::escapedText(result.job.name));
    if (!first.kind.empty()) body += report::escapedText(first.kind) + "; ";
    if (first.fdiNumber != 0) body += fmt::format("FDI {}; ", first.fdiNumber);
    body += "made by handpiece " HANDPIECE_VERSION
            ". The page holds no name, no date, no identity and no place of the scan, and only the region of this "
            "tooth.</p>\n";
    body += "<h2>The tooth</h2>\n" + picturesOf(result, settings, m, core::part(progress, 0.3, 0.9));
    body += "<h2>Slices</h2>\n" + slicesHtml(result);
    body += "<h2>Volumes and thicknesses</h2>\n" + figuresOf(m);
    body += "<h2>Quality</h2>\n" + qualityOf(result, m);
    if (const std::vector<std::string> notes = result.notes(); !notes.empty()) {
        body += "<h2>Notes</h2>\n<ul>\n";
        for (const std::string& note : notes)
            body += fmt::format("<li>{}</li>\n", report::escapedText(note));
        body += "</ul>\n";
    }
    body += "<h2>What this scan cannot show</h2>\n<ul>\n";
    for (const std::string& limit : limitsOf(result, m))
        body += fmt::format("<li>{}</li>\n", report::escapedText(limit));
    body += "</ul>\n<p class=\"note\">A training case, not a diagnosis.</p>\n";
    Figures times({"step", "seconds"});
    for (const ScanStage stage : kScanStages)
        times.row({std::string(nameOf(stage)), fmt::format("{:.2f}", result.timings.of(stage))});
    times.row({"all", fmt::format("{:.2f}", result.timings.total())});
    body += "<h2>Times</h2>\n" + times.html();
    body += tryIt(places);
    core::report(progress, 1.0);
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Case from a scan: {}</title>\n"
        "<style>{}</style></head>\n<body>\n{}</body></html>\n",
        report::escapedText(result.job.name), kStyle, body);
}

std::filesystem::path scanReportPlace(const std::filesystem::path& out,
                                      const std::vector<std::filesystem::path>& places) {
    if (places.size() == 1 && !cases::isPackageName(out)) return out / "report.html";
    const std::filesystem::path stem = cases::isPackageName(out) ? out.stem() : out.filename();
    return out.parent_path() / (stem.string() + "-report.html");
}

}  // namespace handpiece::scan_case
