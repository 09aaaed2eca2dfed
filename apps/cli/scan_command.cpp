// SPDX-License-Identifier: Apache-2.0
// handpiece scan: from a patient's CT to a tooth that can be cut.
#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/inputs.h"
#include "handpiece/app/scan_case/scan_job.h"
#include "handpiece/app/scan_case/scan_report.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/utf8.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/scan/volume/write_scan.h"
#include "handpiece/senses/view/image.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using core::Vec3;
using scan_case::ScanJob;
using scan_case::ScanResult;
using scan_case::ScanStage;

/// One bar a stage.
class StageBars {
  public:
    [[nodiscard]] scan_case::ScanProgress listener() {
        return [this](ScanStage stage, double fraction) {
            const std::lock_guard lock(mutex_);
            if (!bar_ || stage != stage_) {
                bar_ = std::make_unique<studies::ProgressBar>(std::string(scan_case::nameOf(stage)));
                stage_ = stage;
            }
            return bar_->listener()(fraction);
        };
    }
    void finish() {
        const std::lock_guard lock(mutex_);
        bar_.reset();
    }

  private:
    std::mutex mutex_;
    std::unique_ptr<studies::ProgressBar> bar_;
    ScanStage stage_ = ScanStage::read;
};

/// Numbers with commas between.
std::vector<double> numbers(const std::string& text, const char* option) {
    std::vector<double> values;
    const char* at = text.data();
    const char* const end = at + text.size();
    for (;;) {
        double value = 0.0;
        const auto [next, problem] = std::from_chars(at, end, value);
        if (problem != std::errc() || !std::isfinite(value) || (next != end && *next != ','))
            throw core::Error(fmt::format("\"{}\" is no list of numbers", text), option,
                              "write them with commas between, without blanks");
        values.push_back(value);
        if (next == end) return values;
        at = next + 1;
    }
}

std::vector<double> numbers(const std::string& text, const char* option, std::size_t count) {
    std::vector<double> values = numbers(text, option);
    if (values.size() != count)
        throw core::Error(fmt::format("\"{}\" has {} numbers", text, values.size()), option,
                          fmt::format("give {}", count));
    return values;
}

Vec3 vectorOf(const std::string& text, const char* option) {
    const std::vector<double> v = numbers(text, option, 3);
    return {v[0], v[1], v[2]};
}

Vec3 directionOf(const std::string& text, const char* option) {
    const Vec3 v = vectorOf(text, option);
    if (!(v.norm() > 1e-9)) throw core::Error("this is no direction", option, "give one that is not zero");
    return v;
}

struct ScanOptions {
    std::string path, out, job, saveJob, series, spacing, region, labelOrder, numbers, grey, at, threshold, occlusal,
        mesial, name, kind, tissues, intraoral, intraoralUnit = "mm", percent, pictures;
    std::vector<std::string> lesions, cuts, marks;
    double voxelMm = 0.0;
    double openingMm = -1.0;  ///< below 0: not given
    std::size_t faces = 0, threads = 0;
    int tooth = 0;
    bool reverseSlices = false, labels = false, noDamp = false, noCaries = false, noSmooth = false, tableTwo = false,
         scenery = false, report = false, json = false, teeth = false;
};

void takeThresholds(ScanJob& job, const std::string& text) {
    constexpr const char* kRemedy = "write tooth=VALUE,enamel=VALUE, or one of them";
    for (std::size_t from = 0; from <= text.size();) {
        const std::size_t comma = std::min(text.find(',', from), text.size());
        const std::string one = text.substr(from, comma - from);
        const std::size_t equals = one.find('=');
        const std::string key = one.substr(0, equals);
        if (equals == std::string::npos || (key != "tooth" && key != "enamel"))
            throw core::Error(fmt::format("\"{}\" is no threshold", one), "--threshold", kRemedy);
        (key == "tooth" ? job.toothFrom : job.enamelFrom) = numbers(one.substr(equals + 1), "--threshold", 1)[0];
        from = comma + 1;
    }
}

/// The job's file, if one is given, with what stands on the command line in place of what it says.
ScanJob jobOf(const ScanOptions& o) {
    ScanJob job;
    if (!o.job.empty()) job = scan_case::readScanJob(o.job);
    if (!o.path.empty()) job.source = o.path;
    if (job.source.empty())
        throw core::Error("no scan is named", "scan",
                          "give a file, a folder, a ZIP or a DICOMDIR, or a --job with one");
    if (!o.series.empty()) job.series = o.series;
    if (!o.spacing.empty()) {
        const std::vector<double> v = numbers(o.spacing, "--spacing");
        if (v.size() != 1 && v.size() != 3)
            throw core::Error(fmt::format("\"{}\" is no spacing", o.spacing), "--spacing",
                              "give one number of millimetres, or three for columns, rows and slices");
        job.spacingMm = v.size() == 1 ? Vec3::Constant(v[0]) : Vec3(v[0], v[1], v[2]);
        constexpr double kMinMm = 1e-3, kMaxMm = 10.0;
        if (!(job.spacingMm->minCoeff() >= kMinMm && job.spacingMm->maxCoeff() <= kMaxMm))
            throw core::Error(fmt::format("a spacing of {} mm is none of a tooth's scan", o.spacing), "--spacing",
                              fmt::format("give {} to {}", kMinMm, kMaxMm));
    }
    if (o.reverseSlices) job.reverseSlices = true;
    if (!o.region.empty()) {
        const std::vector<double> v = numbers(o.region, "--region", 6);
        job.regionMm = std::array{Vec3(v[0], v[1], v[2]), Vec3(v[3], v[4], v[5])};
    }
    if (o.labels) job.isLabels = true;
    if (!o.grey.empty()) job.grey = o.grey;
    if (o.openingMm >= 0.0) job.openingMm = o.openingMm;
    if (!o.numbers.empty()) {
        job.isLabels = true;
        job.labelNumbers = segmentation::labelNumbersByName(o.numbers);
    }
    if (!o.labelOrder.empty()) {
        job.labelOrder.clear();
        for (const double v : numbers(o.labelOrder, "--label-order")) {
            if (!(v >= 0.0 && v <= 7.0) || v != std::floor(v))
                throw core::Error(fmt::format("{} is no label", v), "--label-order", "give 0 to 7");
            job.labelOrder.push_back(static_cast<std::uint8_t>(v));
        }
    }
    if (!o.at.empty()) job.segmentation.toothAtMm = vectorOf(o.at, "--at");
    if (!o.threshold.empty()) takeThresholds(job, o.threshold);
    for (const std::string& text : o.lesions) {
        const std::vector<double> v = numbers(text, "--lesion", 4);
        if (!(v[3] > 0.0)) throw core::Error("a lesion's radius must be above zero", "--lesion", "give X,Y,Z,R");
        job.segmentation.lesions.push_back({Vec3(v[0], v[1], v[2]), Vec3::Constant(v[3])});
    }
    for (const std::string& text : o.cuts) {
        const std::vector<double> v = numbers(text, "--cut", 6);
        const Vec3 normal(v[3], v[4], v[5]);
        if (!(normal.norm() > 1e-9)) throw core::Error("a plane needs a direction", "--cut", "give X,Y,Z,NX,NY,NZ");
        job.segmentation.cutPlanes.push_back({Vec3(v[0], v[1], v[2]), normal.normalized()});
    }
    for (const std::string& text : o.marks) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos)
            throw core::Error(fmt::format("\"{}\" is no mark", text), "--mark", "give TISSUE=X,Y,Z,R");
        const std::string tissue = text.substr(0, equals);
        const std::vector<double> v = numbers(text.substr(equals + 1), "--mark", 4);
        if (!(v[3] > 0.0)) throw core::Error("a mark's radius must be above zero", "--mark", "give TISSUE=X,Y,Z,R");
        job.segmentation.marks.push_back(
            {Vec3(v[0], v[1], v[2]), v[3], tissue == "none" ? cases::Tissue::none : cases::tissueByName(tissue)});
    }
    if (o.noDamp) job.segmentation.damp = false;
    if (o.noCaries) job.segmentation.findCaries = false;
    if (o.noSmooth) job.smooth = false;
    if (o.voxelMm > 0.0) job.segmentation.spacingMm = o.voxelMm;
    if (!o.occlusal.empty()) job.placing.occlusal = directionOf(o.occlusal, "--occlusal");
    if (!o.mesial.empty()) job.placing.mesial = directionOf(o.mesial, "--mesial");
    if (o.tooth != 0) job.placing.fdiNumber = o.tooth;
    if (!o.name.empty()) job.name = o.name;
    if (!o.kind.empty()) job.kind = o.kind;
    if (!o.tissues.empty()) job.tissuesFile = o.tissues;
    if (!o.intraoral.empty()) {
        job.intraoral = o.intraoral;
        job.intraoralUnit = o.intraoralUnit;
    }
    if (o.scenery) job.scenery = true;
    if (static_cast<int>(o.faces > 0) + static_cast<int>(!o.percent.empty()) + static_cast<int>(o.tableTwo) > 1)
        throw core::Error("give one of --faces, --percent and --table2", "scan", "they all say how fine the case is");
    if (o.faces > 0) job.faces = o.faces;
    if (!o.percent.empty() || o.tableTwo) {
        job.faces = 0;
        job.percents =
            o.tableTwo ? std::vector<double>(surfacing::kTableTwoPercents.begin(), surfacing::kTableTwoPercents.end())
                       : numbers(o.percent, "--percent");
    }
    return job;
}

/// Nobody waits for a scan to hear that its result has no place.
void requireFolder(const fs::path& out) {
    if (const fs::path folder = core::wholePath(out).lexically_normal().parent_path(); !core::isFolder(folder))
        throw core::Error("there is no such folder", folder.string(), "make it first");
}

ScanResult worked(const ScanOptions& o, const ScanJob& job, ScanStage last) {
    core::setThreadCount(o.threads);
    // Before the work, so that a job that is cancelled can be taken up again. Nothing but a job is replaced by one.
    if (!o.saveJob.empty()) {
        if (core::isThere(o.saveJob)) try {
                (void)scan_case::readScanJob(o.saveJob);
            } catch (const core::Error&) {
                throw core::Error("this file is no job of a scan, and is not replaced", o.saveJob,
                                  "name another file for --save-job");
            }
        scan_case::writeScanJob(job, o.saveJob);
    }
    StageBars bars;
    ScanResult result = scan_case::runScanJob(job, bars.listener(), nullptr, last);
    bars.finish();
    return result;
}

void row(std::string_view label, const std::string& value) {
    fmt::print("  {:<14} {}\n", label, value);
}

void tellNotes(const std::vector<std::string>& notes) {
    // The window names its own switch.
    for (const std::string& note : notes)
        fmt::print("  note: {}{}\n", note,
                   note.starts_with("left and right may be swapped") ? " (--reverse-slices)" : "");
}

void tellVolumes(const ScanResult& result) {
    for (std::size_t t = 1; t < cases::kTissueCount; ++t)
        if (result.volumesMm3[t] > 0.0)
            row(cases::properties(static_cast<cases::Tissue>(t)).name, fmt::format("{:.2f} mm3", result.volumesMm3[t]));
}

/// With what was done after the job itself.
void tellTimes(const ScanResult& result, const std::vector<std::pair<std::string_view, double>>& more = {}) {
    std::string text;
    double all = 0.0;
    const auto add = [&](std::string_view what, double seconds) {
        if (seconds <= 0.0) return;
        text += fmt::format("{} {:.1f} s, ", what, seconds);
        all += seconds;
    };
    for (const ScanStage stage : scan_case::kScanStages)
        add(scan_case::nameOf(stage), result.timings.of(stage));
    for (const auto& [what, seconds] : more)
        add(what, seconds);
    row("times", fmt::format("{}in all {:.1f} s", text, all));
}

// scan info

view::Image pictureOf(const volume::Series& series) {
    view::Image image;
    image.width = series.thumbnailSize[0];
    image.height = series.thumbnailSize[1];
    for (const std::uint8_t v : series.thumbnail)
        image.rgba.insert(image.rgba.end(), {v, v, v, 255});
    return image;
}

Json toJson(const Vec3& v) {
    return {v.x(), v.y(), v.z()};
}

Json teethJson(const std::vector<segmentation::Candidate>& teeth) {
    Json list = Json::array();
    for (const segmentation::Candidate& c : teeth)
        list.push_back({{"at_mm", toJson(c.atMm)},
                        {"size_mm", toJson(c.boundsMm.size())},
                        {"volume_mm3", c.volumeMm3},
                        {"touches_border", c.touchesBorder}});
    return list;
}

struct FoundTeeth {
    std::vector<segmentation::Candidate> teeth;         ///< of grey values
    std::vector<segmentation::LabelledTooth> labelled;  ///< or of labels
    std::vector<std::string> notes;                     ///< of those
    std::size_t others = 0;
};

FoundTeeth teethOf(const ScanOptions& o, const volume::Series& series) {
    const ScanJob job = jobOf(o);
    volume::ReadSettings settings = scan_case::readSettings(job);
    settings.series = series.id;
    studies::ProgressBar bar("looking for teeth");
    const core::Progress progress = bar.listener();
    const volume::Scan scan = volume::readScan(o.path, settings, core::part(progress, 0.0, 0.3));
    FoundTeeth found;
    if (const auto labels = scan_case::readLabels(scan, job); labels && labels->key->isMouth) {
        found.labelled = segmentation::teethOf(*labels->labels, *labels->key);
        found.notes = labels->key->notes;
        return found;
    }
    const segmentation::Thresholds thresholds =
        segmentation::findThresholds(scan.volume, core::part(progress, 0.3, 0.5));
    found.teeth = segmentation::findTeeth(scan.volume, thresholds, core::part(progress, 0.5, 1.0));
    found.others = std::erase_if(found.teeth, [](const auto& c) { return !segmentation::isToothLike(c); });
    return found;
}

void info(const ScanOptions& o) {
    core::setThreadCount(o.threads);
    studies::ProgressBar bar("looking into the scan");
    const std::vector<volume::Series> all = volume::findSeries(o.path, bar.listener());
    bar.finish();
    FoundTeeth found;
    if (o.teeth) {
        if (all.size() > 1 && o.series.empty())
            throw core::Error(fmt::format("there are {} series", all.size()), "--teeth", "name one with --series");
        const auto one =
            std::find_if(all.begin(), all.end(), [&](const auto& s) { return o.series.empty() || s.id == o.series; });
        if (one == all.end())
            throw core::Error("there is no series of this name", o.series, "leave --teeth out to see those there are");
        found = teethOf(o, *one);
    }
    const auto& [teeth, labelled, labelNotes, others] = found;
    if (!o.pictures.empty()) {
        core::prepareOutputFolder(o.pictures);
        for (const volume::Series& s : all)
            if (!s.thumbnail.empty()) view::writePng(pictureOf(s), fs::path(o.pictures) / (s.id + ".png"));
    }
    if (o.json) {
        Json list = Json::array();
        for (const volume::Series& s : all)
            list.push_back(
                {{"series", s.id},
                 {"format", s.format},
                 {"modality", s.modality},
                 {"slices", s.slices},
                 {"size", s.size},
                 {"spacing_mm", s.isSpacingKnown ? toJson(s.spacingMm) : Json(nullptr)},
                 {"side_known", s.isSideKnown},
                 {"bits", s.bits},
                 {"picture", o.pictures.empty() || s.thumbnail.empty() ? Json(nullptr) : Json(s.id + ".png")},
                 {"notes", s.notes}});
        Json out{{"series", std::move(list)}};
        if (o.teeth) {
            out["teeth"] = teethJson(teeth);
            out["other_hard_things"] = others;
            if (!labelled.empty()) {
                Json named = Json::array();
                for (const segmentation::LabelledTooth& tooth : labelled)
                    named.push_back({{"fdi", tooth.fdi}, {"volume_mm3", tooth.volumeMm3}});
                out["labelled_teeth"] = std::move(named);
            }
        }
        fmt::print("{}\n", out.dump(2, ' ', false, Json::error_handler_t::replace));
        return;
    }
    fmt::print("{:<7} {:<16} {:<9} {:>6}  {:<16} {:<24} {:>4}\n", "series", "format", "modality", "slices", "voxels",
               "spacing [mm]", "bits");
    for (const volume::Series& s : all) {
        fmt::print("{:<7} {:<16} {:<9} {:>6}  {:<16} {:<24} {:>4}\n", s.id, s.format,
                   s.modality.empty() ? "-" : s.modality, s.slices,
                   fmt::format("{} x {} x {}", s.size[0], s.size[1], s.size[2]),
                   s.isSpacingKnown
                       ? fmt::format("{:.4g} x {:.4g} x {:.4g}", s.spacingMm.x(), s.spacingMm.y(), s.spacingMm.z())
                       : "unknown: give --spacing",
                   s.bits);
        tellNotes(s.notes);
    }
    tellNotes(labelNotes);
    for (const segmentation::LabelledTooth& tooth : labelled)
        fmt::print("labelled tooth: --tooth {}  {:.0f} mm3{}\n", tooth.fdi, tooth.volumeMm3,
                   tooth.isCutOff ? ", cut off by the border" : "");
    if (o.teeth && teeth.empty() && labelled.empty()) fmt::print("no tooth was told apart in it\n");
    for (const segmentation::Candidate& c : teeth)
        fmt::print("tooth: --at {:.2f},{:.2f},{:.2f}  {:.0f} mm3, {:.1f} x {:.1f} x {:.1f} mm{}\n", c.atMm.x(),
                   c.atMm.y(), c.atMm.z(), c.volumeMm3, c.boundsMm.size().x(), c.boundsMm.size().y(),
                   c.boundsMm.size().z(), c.touchesBorder ? ", cut off by the border" : "");
    if (others > 0)
        fmt::print("{} more hard {} left out: by size and shape no {}\n", others,
                   others == 1 ? "thing was" : "things were", others == 1 ? "tooth" : "teeth");
}

// scan segment, surface, case

void segment(const ScanOptions& o) {
    if (fs::path(o.out).extension() != ".nrrd")
        throw core::Error("labels are written as .nrrd", o.out, "name the output so");
    requireFolder(o.out);
    const ScanResult result = worked(o, jobOf(o), ScanStage::segment);
    const volume::Labels labels = segmentation::labelsOf(*result.region);
    volume::writeLabels(labels, o.out);
    fmt::print("{}: {} x {} x {} voxels of {:.4g} mm\n", o.out, labels.grid.size[0], labels.grid.size[1],
               labels.grid.size[2], labels.grid.spacingMm.x());
    tellVolumes(result);
    if (!result.labels) {
        const segmentation::Thresholds& t = result.region->thresholds;
        row("thresholds", fmt::format("tooth={:.6g},enamel={:.6g}", t.toothFrom, t.enamelFrom));
    }
    tellTimes(result);
    tellNotes(result.notes());
}

std::string fileNameOf(const surfacing::Surface& s) {
    return s.tissue == cases::Tissue::none
               ? "outer"
               : fmt::format("{}{}", cases::properties(s.tissue).name, s.isAuthored ? "-authored" : "");
}

void surface(const ScanOptions& o) {
    requireFolder(o.out);
    const bool isNew = !core::isThere(o.out);
    ScanJob job = jobOf(o);
    // For other programs as well, which have no field of ours.
    if (job.percents.empty() && job.faces == 0) job.percents = {100.0};
    const ScanResult result = worked(o, job, ScanStage::decimate);
    core::prepareOutputFolder(o.out);
    std::vector<fs::path> made;
    try {
        for (const scan_case::ScannedCase& c : result.cases) {
            const std::string ending = result.cases.size() > 1 ? fmt::format("-{:g}", c.percent) : "";
            std::vector<const surfacing::Surface*> all{&c.surfaces->outer};
            for (const surfacing::Surface& s : c.surfaces->tissues)
                all.push_back(&s);
            for (std::size_t i = 0; i < all.size(); ++i) {
                std::string name = fileNameOf(*all[i]);
                // A second lesion of one kind gets a number.
                const auto same = std::count_if(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(i),
                                                [&](const auto* s) { return fileNameOf(*s) == name; });
                if (same > 0) name += fmt::format("-{}", same + 1);
                const fs::path file = fs::path(o.out) / (name + ending + ".stl");
                made.push_back(file);
                geometry::writeStl(file, all[i]->mesh);
                fmt::print("  {:<24} {:>8} faces {:>10.2f} mm3, at most {:.1f} um off the full surface\n",
                           file.filename().string(), all[i]->mesh.triangles.size(),
                           geometry::enclosedVolumeMm3(all[i]->mesh), 1e3 * all[i]->errorBoundMm);
            }
        }
    } catch (const core::Error&) {
        std::error_code left;  // the error that is thrown says more
        for (const fs::path& file : made)
            fs::remove(file, left);
        if (isNew) fs::remove(o.out, left);
        throw;
    }
    for (const scan_case::OtherTooth& other : result.others) {
        const fs::path file = fs::path(o.out) / fmt::format("tooth-{}.stl", other.fdi);
        geometry::writeStl(file, other.full->outer.mesh);
        fmt::print("  {:<24} {:>8} faces {:>10.2f} mm3\n", file.filename().string(),
                   other.full->outer.mesh.triangles.size(), geometry::enclosedVolumeMm3(other.full->outer.mesh));
    }
    fmt::print("{}: in the scanner's frame, millimetres\n", o.out);
    tellTimes(result);
    tellNotes(result.notes());
}

void makeCase(const ScanOptions& o) {
    requireFolder(o.out);
    const ScanJob job = jobOf(o);
    for (const fs::path& place : scan_case::casePlaces(job, o.out))
        if (core::isFolder(place)) core::requireReplaceable(place, "case.toml");
    const ScanResult result = worked(o, job, ScanStage::check);
    using Clock = std::chrono::steady_clock;
    const auto secondsSince = [](Clock::time_point start) {
        return std::chrono::duration<double>(Clock::now() - start).count();
    };
    std::string page;
    double drawingS = 0.0;
    if (o.report) {
        const Clock::time_point start = Clock::now();
        studies::ProgressBar bar("drawing the report");
        page = scan_case::scanReport(result, scan_case::casePlaces(job, o.out), {}, bar.listener());
        drawingS = secondsSince(start);
    }
    const Clock::time_point start = Clock::now();
    const std::vector<fs::path> places = scan_case::writeScanCases(result, o.out);
    const double writingS = secondsSince(start);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const cases::Case& c = result.cases[i].toothCase;
        fmt::print("{}: {}\n  {:<14} {:>8} faces {:>10.2f} mm3\n", places[i].string(), core::printable(c.name), "outer",
                   c.outer.triangles.size(), geometry::enclosedVolumeMm3(c.outer));
        for (const cases::Part& part : c.parts)
            if (part.tissue != cases::Tissue::enamel)  // its part is the whole tooth; its volume stands below
                fmt::print("  {:<14} {:>8} faces {:>10.2f} mm3\n", core::printable(part.name),
                           part.mesh.triangles.size(), geometry::enclosedVolumeMm3(part.mesh));
        for (const cases::PlacedTooth& other : c.others)
            fmt::print("  tooth {:<8} {:>8} faces {:>10.2f} mm3{}\n", other.fdiNumber, other.outer.triangles.size(),
                       geometry::enclosedVolumeMm3(other.outer), other.isCuttable ? ", to be cut too" : "");
        for (const cases::Part& part : c.scenery)
            fmt::print("  {:<14} {:>8} faces, scenery\n", part.name, part.mesh.triangles.size());
    }
    fmt::print("as the scan shows it\n");
    tellVolumes(result);
    tellTimes(result, {{"drawing the report", drawingS}, {"writing", writingS}});
    tellNotes(result.notes());
    if (o.report) {
        const fs::path place = scan_case::scanReportPlace(o.out, places);
        core::writeFile(place, page);
        fmt::print("{}: the case's report\n", place.string());
    }
}

void addReadingOptions(Command& command, ScanOptions& o) {
    command.flag("--reverse-slices", o.reverseSlices,
                 "read the slices from the other end: without it the tooth is a mirror image");
    command.option("--region", o.region,
                   "X,Y,Z,X,Y,Z, two corners of a box [mm, the scan's frame]: nothing else is read");
}

void addJobOptions(Command& command, ScanOptions& o) {
    command.option("PATH", o.path, "file, folder, ZIP or DICOMDIR; may be left out with --job");
    command.option("--job", o.job, "file of decisions to start from; options given here win over it");
    command.option("--save-job", o.saveJob, "file to keep all decisions in (with the scan's place)");
    command.option("--series", o.series, "which series, as scan info numbers them");
    command.option("--spacing", o.spacing, "millimetres between voxels, one number or X,Y,Z; wins over the file's");
    addReadingOptions(command, o);
    command.flag("--labels", o.labels,
                 "the scan is labels: teeth by FDI numbers, or 1 caries, 2 enamel, 3 dentine, 4 pulp, 5 restoration, "
                 "6 bone, 7 gingiva");
    command.option("--numbers", o.numbers, "what labels' numbers are: tissues, fdi, universal or consecutive")
        .check(oneOf({"tissues", "fdi", "universal", "consecutive"}));
    command.option("--grey", o.grey, "the scan that a mouth's labels are of: tells the tissues in each tooth");
    command
        .option("--opening", o.openingMm,
                "of a mouth's labels: open the jaws so far between the incisal edges [mm], else by 40; 0: as scanned")
        .check(range(0.0, dentition::kWidestOpeningMm));
    command.option("--label-order", o.labelOrder, "what the file's labels 0, 1, 2, ... mean, in those numbers");
    command.option("--at", o.at, "X,Y,Z of a place in the tooth wanted [mm, the scan's frame]; else the largest");
    command.option("--threshold", o.threshold, "tooth=VALUE,enamel=VALUE: grey values from which on they begin");
    command.option("--lesion", o.lesions, "X,Y,Z,R of an authored lesion, a ball in the tooth; as often as wanted")
        .takeAll();
    command.option("--cut", o.cuts, "X,Y,Z,NX,NY,NZ: leave out what lies on this side of a plane").takeAll();
    command.option("--mark", o.marks, "TISSUE=X,Y,Z,R: within this ball there is this tissue (or none)").takeAll();
    command.flag("--no-damp", o.noDamp, "leave noise, streaks and rings as they are");
    command.flag("--no-caries", o.noCaries, "do not look for caries");
    command.option("--voxel", o.voxelMm, "voxel of the result [mm]; 0: the scan's")
        .check(range(0.0, 5.0))
        .showDefault();
    command.option("--threads", o.threads, "threads for long work; 0: all cores")
        .check(range(std::size_t{0}, std::size_t{1024}))
        .showDefault();
}

void addSurfaceOptions(Command& command, ScanOptions& o) {
    command.flag("--no-smooth", o.noSmooth, "surfaces as they come out of the voxels");
    command.option("--faces", o.faces, "triangles of all surfaces together");
    command.option("--percent", o.percent,
                   "share of the full surfaces' triangles, P or P,P,...: a case each; "
                   "else a case has as many as its field can use, and scan surface all");
    command.flag("--table2", o.tableTwo, "the paper's five: 6, 12, 25, 50 and 100 %");
    command.option("--intraoral", o.intraoral, "mesh of an intraoral scan: found on the tooth, then its outer surface");
    addLengthUnit(command, "--intraoral-unit", o.intraoralUnit, "unit of that mesh: mm, cm, m, inch or um");
}

}  // namespace

void addScanCommand(Command& app) {
    Command command = app.subcommand("scan", "From a CT scan to a tooth that can be cut");
    command.requireSubcommand();
    command.footer(
        "Reads DICOM, BMP, JPEG, PNG, TIFF, NRRD, MetaImage, NIfTI and raw with a description. Nothing that names the\n"
        "patient, no path and no file's name goes into a case, a report or the cache.\n"
        "Examples:\n  handpiece scan info slices --pictures seen\n"
        "  handpiece scan case slices --spacing 0.05 --tooth 46 --out mine --report\n"
        "  handpiece scan case teeth.nii.gz --labels --tooth 46 --out mouth\n"
        "  handpiece scan case jaw.zip --at 21.5,-8,40 --percent 6,25 --scenery --out mine.handpiece");
    const auto options = std::make_shared<ScanOptions>();
    ScanOptions& o = *options;

    Command looking = command.subcommand("info", "What a scan holds: series, sizes, spacings, pictures, teeth");
    looking.option("PATH", o.path, "file, folder, ZIP or DICOMDIR").required();
    looking.flag("--json", o.json, "print JSON instead of a table");
    looking.option("--pictures", o.pictures, "folder for a small picture of each series");
    looking.flag("--teeth", o.teeth, "also what may be a tooth in it, each with its --at");
    looking.option("--series", o.series, "of which series --teeth tells");
    looking.option("--spacing", o.spacing, "for --teeth, where the file tells none [mm]");
    addReadingOptions(looking, o);
    looking.option("--threads", o.threads, "threads for long work; 0: all cores").showDefault();
    looking.footer("Example:\n  handpiece scan info slices --json --pictures seen");
    looking.callback([options] { info(*options); });

    Command labels = command.subcommand("segment", "Tissues of one tooth as labels");
    addJobOptions(labels, o);
    labels.option("--out", o.out, "labels to write (.nrrd)").required();
    labels.footer("Example:\n  handpiece scan segment slices --spacing 0.05 --out labels.nrrd");
    labels.callback([options] { segment(*options); });

    Command surfaces = command.subcommand("surface", "Surfaces of a tooth and its tissues as STL");
    addJobOptions(surfaces, o);
    addSurfaceOptions(surfaces, o);
    surfaces.option("--out", o.out, "folder to write into").required();
    surfaces.footer("Example:\n  handpiece scan surface slices --percent 25 --out meshes");
    surfaces.callback([options] { surface(*options); });

    Command cases = command.subcommand("case", "A case that can be felt and cut");
    addJobOptions(cases, o);
    addSurfaceOptions(cases, o);
    cases.option("--out", o.out, "folder or .handpiece file; several percents make OUT-6, OUT-12, ...").required();
    cases.option("--name", o.name, "name of the case, never taken from the scan [default: scanned tooth]");
    cases.option("--kind", o.kind, "kind of tooth, as lower-first-molar");
    cases
        .option("--tooth", o.tooth, "FDI number of the tooth, 11 to 48 or 51 to 85; of a mouth's labels: which of them")
        .check(range(11, 85))
        .typeName("FDI");
    cases.option("--occlusal", o.occlusal, "X,Y,Z direction out of the crown in the scan's frame");
    cases.option("--mesial", o.mesial, "X,Y,Z direction to mesial in the scan's frame");
    cases.option("--tissues", o.tissues, "table of tissues of one's own (TOML), kept in the case");
    cases.flag("--scenery", o.scenery, "keep what stands around the tooth, to be seen");
    cases.flag("--report", o.report, "also a page to print: pictures, volumes, thicknesses, quality");
    cases.footer("Example:\n  handpiece scan case slices --spacing 0.05 --tooth 46 --table2 --out mine --report");
    cases.callback([options] { makeCase(*options); });
}

}  // namespace handpiece::cli
