// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/scan_case/scan_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/app/report/report_html.h"
#include "handpiece/app/report/session_report.h"
#include "handpiece/app/scan_case/scan_measures.h"
#include "handpiece/app/scan_case/scan_pictures.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/case/package.h"

namespace handpiece::scan_case {
namespace {

using report::HtmlReport;
using Tone = HtmlReport::Tone;
using Group = HtmlReport::Group;
using Rows = std::vector<std::vector<std::string>>;
using config::words;

std::vector<cases::Tissue> tissuesOf(const ScanMeasures& m) {
    std::vector<cases::Tissue> tissues;
    for (std::size_t t = 1; t < cases::kTissueCount; ++t)
        if (m.volumesMm3[t] > 0.0) tissues.push_back(static_cast<cases::Tissue>(t));
    return tissues;
}

void addPictures(HtmlReport& page, const ScanResult& result, const ScanReportSettings& settings, const ScanMeasures& m,
                 const core::Progress& progress) {
    if (!settings.pictures) return page.paragraph(words()("report.no-pictures-asked"), Tone::missing);
    try {
        const std::vector<NamedPicture> pictures =
            viewsOf(result, settings.pictureWidth, settings.pictureHeight, progress);
        page.begin(Group::pictures);
        for (const NamedPicture& p : pictures)
            page.picture(p.image, p.caption);
        page.end();
    } catch (const core::Error& e) {
        if (e.problem() == "cancelled") throw;
        page.paragraph(words()("report.no-pictures", e.problem()), Tone::missing);
    }
    page.legend(report::chipsOf(tissuesOf(m)));
}

std::vector<std::string> thicknessRow(const std::string& what, const std::optional<Thickness>& t) {
    if (!t) return {what, "-", "-", "-", "0"};
    return {what, fmt::format("{:.2f}", t->leastMm), fmt::format("{:.2f}", t->medianMm),
            fmt::format("{:.2f}", t->mostMm), std::to_string(t->places)};
}

void addFigures(HtmlReport& page, const ScanMeasures& m) {
    Rows volumes;
    for (const cases::Tissue t : tissuesOf(m)) {
        const double mm3 = m.volumesMm3[static_cast<std::size_t>(t)];
        volumes.push_back({report::nameOf(t), fmt::format("{:.2f}", mm3),
                           fmt::format("{:.1f} %", 100.0 * mm3 / std::max(m.toothMm3, 1e-9))});
    }
    volumes.push_back({words()("scan.whole-tooth"), fmt::format("{:.2f}", m.toothMm3), ""});
    page.begin(Group::columns);
    page.table({words()("report.tissue"), words()("scan.volume-mm3"), words()("scan.share")}, volumes);
    page.table({words()("scan.size"), "mm"}, {{words()("scan.along-mesial"), fmt::format("{:.2f}", m.sizeMm.x())},
                                              {words()("scan.along-buccal"), fmt::format("{:.2f}", m.sizeMm.y())},
                                              {words()("scan.apex-to-cusp"), fmt::format("{:.2f}", m.sizeMm.z())},
                                              {words()("scan.neck-to-cusp"), fmt::format("{:.2f}", m.crownMm)}});
    page.end();
    page.table({words()("scan.thickness-mm"), words()("scan.least"), words()("scan.median"), words()("scan.most"),
                words()("scan.places")},
               {thicknessRow(words()("scan.enamel-top"), m.enamelTop),
                thicknessRow(words()("scan.enamel-sides"), m.enamelSides),
                thicknessRow(words()("scan.dentine-over-pulp"), m.dentineOverPulp)});
    page.paragraph(words()("scan.how-measured"), Tone::note);
}

void addQuality(HtmlReport& page, const ScanResult& result, const ScanMeasures& m) {
    const volume::Series& s = result.scan->series;
    const core::Vec3 spacing = result.scan->volume.grid.spacingMm;
    std::vector<std::pair<std::string, std::string>> scan{
        {words()("scan.kind"), fmt::format("{}{}{}", s.format, s.modality.empty() ? "" : ", ", s.modality)},
        {words()("scan.voxels"), fmt::format("{} x {} x {}", s.size[0], s.size[1], s.size[2])},
        {words()("scan.scan-voxel"),
         fmt::format("{:.1f} x {:.1f} x {:.1f} µm", 1e3 * spacing.x(), 1e3 * spacing.y(), 1e3 * spacing.z())},
        {words()("scan.spacing"),
         result.job.spacingMm ? words()("scan.spacing-by-hand") : words()("scan.spacing-of-file")},
        {words()("scan.result-voxel"), fmt::format("{:.1f} µm", 1e3 * m.voxelMm)}};
    if (!result.labels) {
        const segmentation::Thresholds& t = result.region->thresholds;
        scan.emplace_back(words()("scan.thresholds"), fmt::format("{:.5g}, {:.5g}", t.toothFrom, t.enamelFrom));
        scan.emplace_back(words()("scan.noise"), words()("scan.noise-value", m.noise, 100.0 * m.noiseShare));
        if (m.blurMm > 0.0)
            scan.emplace_back(words()("scan.blur"),
                              words()("scan.blur-value", 1e3 * m.blurMm, m.blurMm / m.scanVoxelMm));
    }
    scan.emplace_back(words()("scan.confidence"), words()("scan.confidence-value", result.placed.confidence));
    scan.emplace_back(words()("scan.mesial"),
                      result.placed.isMesialGuessed ? words()("scan.guessed") : words()("scan.given"));
    page.facts(words()("scan.scan"), scan);
    bool isClosed = true;
    Rows surfaces;
    for (const SurfaceQuality& q : m.surfaces) {
        isClosed = isClosed && q.isClosed && q.crossings == 0;
        surfaces.push_back({q.name, fmt::format("{:g} %", std::round(10.0 * q.percent) / 10.0),
                            std::to_string(q.vertices), std::to_string(q.faces), fmt::format("{:.2f}", q.volumeMm3),
                            q.genus ? std::to_string(*q.genus) : "-", std::to_string(q.crossings),
                            fmt::format("{:.1f} µm", 1e3 * q.errorBoundMm)});
    }
    page.table({words()("scan.surface"), words()("scan.of-full"), words()("scan.vertices"), words()("scan.faces"),
                words()("scan.volume-mm3"), words()("scan.genus"), words()("scan.crossings"), words()("scan.off-by")},
               surfaces);
    page.paragraph(isClosed ? words()("scan.surfaces-closed") : words()("scan.surface-open"),
                   isClosed ? Tone::good : Tone::bad);
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

void addTryIt(HtmlReport& page, const std::vector<std::filesystem::path>& places) {
    // One folder holds the page itself; several cases, or a file, stand beside it.
    const bool isWithin = places.size() == 1 && !cases::isPackageName(places[0]);
    page.begin(Group::frame);
    page.heading(words()("scan.try-it"));
    page.paragraph(words()("scan.in-the-folder"));
    for (const std::filesystem::path& place : places) {
        const std::string name = place.filename().string();
        page.link(isWithin ? "./case.toml" : addressOf(name), name);
        page.code(
            fmt::format("handpiece-desktop {0}\nhandpiece run --case {0} --bur 330 --motion class-one --out cavity\n"
                        "handpiece picture {0} --section x --grid --out section.png",
                        shellText(name)));
    }
    page.end();
}

}  // namespace

std::string scanReport(const ScanResult& result, const std::vector<std::filesystem::path>& places,
                       const ScanReportSettings& settings, const core::Progress& progress) {
    if (result.cases.empty() || places.size() != result.cases.size())
        throw core::Error("there is no case to report of", "report", "finish the scan's job first");
    const ScanMeasures m = measure(result, core::part(progress, 0.0, 0.3));
    const cases::Case& first = result.cases.front().toothCase;
    HtmlReport page(words()("scan.title", result.job.name));
    std::string about;
    if (!first.kind.empty()) about += first.kind + "; ";
    if (first.fdiNumber != 0) about += fmt::format("FDI {}; ", first.fdiNumber);
    page.paragraph(about + words()("scan.made-by", HANDPIECE_VERSION), Tone::note);
    page.heading(words()("report.the-tooth"));
    addPictures(page, result, settings, m, core::part(progress, 0.3, 0.9));
    page.heading(words()("scan.slices"));
    page.begin(Group::slices);
    for (const NamedPicture& p : slicesOf(result))
        page.picture(p.image, p.caption);
    page.end();
    page.paragraph(words()("scan.slices-note"), Tone::note);
    page.heading(words()("scan.volumes-and-thicknesses"));
    addFigures(page, m);
    page.heading(words()("scan.quality"));
    addQuality(page, result, m);
    if (const std::vector<std::string> notes = result.notes(); !notes.empty()) {
        page.heading(words()("scan.notes"));
        page.list(notes);
    }
    page.heading(words()("scan.cannot-show"));
    page.list(limitsOf(result, m));
    page.paragraph(words()("scan.no-diagnosis"), Tone::note);
    Rows times;
    for (const ScanStage stage : kScanStages)
        times.push_back({std::string(nameOf(stage)), fmt::format("{:.2f}", result.timings.of(stage))});
    times.push_back({words()("scan.all"), fmt::format("{:.2f}", result.timings.total())});
    page.heading(words()("scan.times"));
    page.table({words()("scan.step"), words()("scan.seconds")}, times);
    addTryIt(page, places);
    core::report(progress, 1.0);
    return page.text();
}

std::filesystem::path scanReportPlace(const std::filesystem::path& out,
                                      const std::vector<std::filesystem::path>& places) {
    if (places.size() == 1 && !cases::isPackageName(out)) return out / "report.html";
    const std::filesystem::path stem = cases::isPackageName(out) ? out.stem() : out.filename();
    return out.parent_path() / (stem.string() + "-report.html");
}

}  // namespace handpiece::scan_case
