// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/scan_case/scan_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numeric>

#include "handpiece/app/scan_case/scan_mouth.h"
#include "handpiece/app/scan_case/scan_scenery.h"
#include "handpiece/app/scan_case/scan_toml.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/memory.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/case/case_check.h"
#include "handpiece/model/case/package.h"
#include "handpiece/model/case/work_on.h"
#include "handpiece/model/field/distance_field.h"
#include "handpiece/scan/landmarks/find_landmarks.h"

namespace handpiece::scan_case {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMinFaces = 200, kMostFaces = 20'000'000;  // of a case

class Clock {
  public:
    [[nodiscard]] double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

core::Progress listenerOf(const ScanProgress& progress, ScanStage stage) {
    if (!progress) return {};
    return [progress, stage](double fraction) { return progress(stage, fraction); };
}

/// Labels, and what they mean.
ReadLabels keyed(volume::Labels labels, const volume::Series& series, const ScanJob& job) {
    const std::string where = job.source.filename().string();
    segmentation::LabelKey key;
    if (!job.labelOrder.empty()) {
        for (std::uint8_t& v : labels.values)
            if (v < job.labelOrder.size()) v = job.labelOrder[v];
        key = segmentation::labelKeyOf(labels, {}, segmentation::LabelNumbers::tissues, where);
    } else {
        key = segmentation::labelKeyOf(labels, series.labelNames, job.labelNumbers, where);
        using What = segmentation::LabelMeaning::What;
        if (!key.isMouth)
            for (std::uint8_t& v : labels.values)
                v = key.of[v].what == What::tissue ? static_cast<std::uint8_t>(key.of[v].number) : std::uint8_t{0};
    }
    if (!job.isLabels) key.notes.insert(key.notes.begin(), "its numbers are labels of teeth, not grey values");
    return {std::make_shared<const volume::Labels>(std::move(labels)),
            std::make_shared<const segmentation::LabelKey>(std::move(key))};
}

void read(ScanResult& result, const core::Progress& progress) {
    const ScanJob& job = result.job;
    if (job.source.empty()) throw core::Error("no scan is named", "scan", "give a file, a folder, a ZIP or a DICOMDIR");
    const double share = job.grey.empty() ? 0.9 : 0.5;
    const core::Progress reading = core::part(progress, 0.0, share);
    result.grey.reset();
    result.labels.reset();
    result.labelKey.reset();
    volume::Scan scan;
    std::optional<ReadLabels> labels;
    if (job.isLabels) {
        volume::LabelScan read = volume::readLabels(job.source, readSettings(job), reading);
        scan = {{read.labels.grid, {}}, std::move(read.series)};
        labels = keyed(std::move(read.labels), scan.series, job);
    } else {
        scan = volume::readScan(job.source, readSettings(job), reading);
        labels = readLabels(scan, job);
        // The labels are all that is needed: a scan of numbers is four times their size.
        if (labels) std::vector<float>().swap(scan.volume.values);
    }
    if (labels) {
        result.labels = labels->labels;
        result.labelKey = labels->key;
    }
    result.scan = std::make_shared<const volume::Scan>(std::move(scan));
    if (!job.grey.empty()) {
        if (!result.isMouth())
            throw core::Error("the scan that labels are of is asked of a mouth's labels alone",
                              job.grey.filename().string(), "give labels of teeth by their numbers, or leave it out");
        volume::ReadSettings own;
        own.takeLargest = true;
        result.grey =
            std::make_shared<const volume::Scan>(volume::readScan(job.grey, own, core::part(progress, share, 1.0)));
    }
    core::report(progress, 1.0);
}

void segment(ScanResult& result, const core::Progress& progress) {
    const ScanJob& job = result.job;
    segmentation::Region region;
    result.teeth.clear();
    result.toothNotes.clear();
    if (result.isMouth()) {
        region = segmentMouth(result, progress);
    } else if (result.labels) {
        region = segmentation::segmentLabels(*result.labels, job.segmentation, progress);
    } else {
        segmentation::Settings settings = job.segmentation;
        double from = 0.0;
        if (!settings.thresholds && (job.toothFrom || job.enamelFrom)) {
            from = 0.2;
            settings.thresholds = segmentation::findThresholds(result.scan->volume, core::part(progress, 0.0, from));
            if (job.toothFrom) settings.thresholds->toothFrom = static_cast<float>(*job.toothFrom);
            if (job.enamelFrom) settings.thresholds->enamelFrom = static_cast<float>(*job.enamelFrom);
        }
        region = segmentation::segment(result.scan->volume, settings, core::part(progress, from, 1.0));
    }
    result.volumesMm3 = segmentation::volumesMm3(region);
    result.region = std::make_shared<const segmentation::Region>(std::move(region));
    core::report(progress, 1.0);
}

void surface(ScanResult& result, const core::Progress& progress) {
    const ScanJob& job = result.job;
    const double share = job.intraoral.empty() ? 1.0 : 0.4;
    surfacing::Surfaces surfaces =
        surfacing::makeSurfaces(*result.region, {job.smooth}, core::part(progress, 0.0, share));
    result.registered.reset();
    if (!job.intraoral.empty()) {
        const geometry::TriangleMesh scan = geometry::scaled(
            geometry::readMesh(job.intraoral), geometry::millimetresPer(geometry::unitByName(job.intraoralUnit)));
        registration::RegisterSettings settings;
        settings.roughly = job.intraoralInScan;
        settings.overlap = job.intraoralOverlap;
        result.registered =
            registration::registerOnto(scan, surfaces.outer.mesh, settings, core::part(progress, share, 0.7));
        surfaces =
            registration::withOuterSurface(surfaces, geometry::transformed(scan, result.registered->movingInFixed),
                                           job.intraoralReachMm, core::part(progress, 0.7, 1.0));
    }
    if (result.isMouth()) surfaceOthers(result, surfaces, core::part(progress, share, 1.0));
    result.full = std::make_shared<const surfacing::Surfaces>(std::move(surfaces));
    core::report(progress, 1.0);
}

/// Mesial was guessed by the crown's width: another way where its shape, beside the average one's, says so.
void turnByShape(ScanResult& result) {
    cases::Tooth tooth;
    tooth.fdiNumber = result.job.placing.fdiNumber;
    tooth.outer = geometry::transformed(result.full->outer.mesh, result.placed.scanInTooth);
    const double rad = landmarks::turnOfCrown(tooth);
    if (rad == 0.0) return;
    registration::Hints hints = result.job.placing;
    hints.mesial = result.placed.scanInTooth.orientation.conjugate() * core::Vec3(core::cos(rad), core::sin(rad), 0.0);
    result.placed = registration::place(*result.full, hints);
    result.placed.isMesialGuessed = true;
    result.placed.notes.push_back(
        "mesial is a guess by the crown's shape, which is laid over the average tooth of its number: look at it, and "
        "turn the tooth by hand where it matters");
}

void place(ScanResult& result, const core::Progress& progress) {
    const ScanJob& job = result.job;
    if (result.isMouth()) return placeMouth(result, progress);
    result.placed = registration::place(*result.full, job.placing);
    if (!job.placing.mesial) turnByShape(result);
    core::report(progress, 0.2);
    result.scenery.clear();
    result.ownNotes.clear();
    if (job.scenery) {
        const core::Progress rest = core::part(progress, 0.2, 1.0);
        const geometry::TriangleMesh& outer = result.full->outer.mesh;
        result.scenery = result.labels
                             ? sceneryOf(*result.labels, outer, kSceneryReachMm, rest)
                             : sceneryOf(result.scan->volume, result.region->thresholds, outer, kSceneryReachMm, rest);
        if (result.scenery.empty())
            result.ownNotes.push_back(fmt::format(
                "nothing stands within {:.0f} mm of the tooth in this scan: there is no scenery", kSceneryReachMm));
    }
    core::report(progress, 1.0);
}

std::string tissuesOf(const fs::path& file) {
    if (file.empty()) return {};
    (void)cases::readTissues(file);
    const std::vector<std::byte> bytes = core::readFile(file);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::size_t facesOf(const surfacing::Surfaces& s) {
    std::size_t faces = s.outer.mesh.triangles.size();
    for (const surfacing::Surface& t : s.tissues)
        faces += t.mesh.triangles.size();
    return faces;
}

double worstOfTissuesMm(const surfacing::Surfaces& s) {
    double worst = 0.0;
    for (const surfacing::Surface& t : s.tissues)
        worst = std::max(worst, t.errorBoundMm);
    return worst;
}

std::string shown(double percent) {
    return fmt::format("{:g}", percent);
}

void decimate(ScanResult& result, const core::Progress& progress) {
    const ScanJob& job = result.job;
    registration::CaseText text;
    text.name = job.name;
    text.kind = job.kind;
    // What was segmented stays when another number is typed; which tooth of a mouth it is was decided with it.
    text.fdiNumber = result.isMouth() ? result.fdiNumber : job.placing.fdiNumber;
    if (result.isMouth() && text.kind.empty()) text.kind = wordsOf(result.fdiNumber).kind;
    text.tissuesToml = tissuesOf(job.tissuesFile);
    result.cases.clear();
    result.caseNotes.clear();
    const auto add = [&](double percent, surfacing::Surfaces surfaces) {
        ScannedCase made;
        made.percent = percent;
        made.surfaces = std::make_shared<const surfacing::Surfaces>(std::move(surfaces));
        registration::CaseText own = text;
        if (job.faces == 0 && job.percents.size() > 1) own.name += fmt::format(" ({} %)", shown(percent));
        made.toothCase = registration::makeCase(*made.surfaces, result.placed, own, result.scenery);
        if (result.isMouth()) {
            addOthers(result, percent, made.toothCase);
            if (job.openingMm > 0.0 && cases::openJaws(made.toothCase, job.openingMm) && result.cases.empty())
                result.caseNotes.push_back(fmt::format(
                    "the jaws are opened to {:g} mm between the incisal edges, about a hinge as people have "
                    "it on average; an opening of 0 leaves them as they were scanned",
                    job.openingMm));
        }
        result.cases.push_back(std::move(made));
    };
    if (job.faces > 0) {
        surfacing::Surfaces surfaces = surfacing::decimatedTo(*result.full, job.faces, progress);
        const double percent =
            100.0 * static_cast<double>(facesOf(surfaces)) / static_cast<double>(facesOf(*result.full));
        add(percent, std::move(surfaces));
    } else {
        std::vector<double> percents = job.percents;
        const double fieldVoxelMm = field::FieldSettings{}.voxelMm;
        if (percents.empty()) percents = {surfacing::usefulPercent(*result.full, fieldVoxelMm)};
        for (const double percent : percents)
            if (const double left = 0.01 * percent * static_cast<double>(facesOf(*result.full));
                percent < 100.0 && left < static_cast<double>(kMinFaces))
                throw core::Error(fmt::format("{} % of the scan's {} faces do not make a tooth", shown(percent),
                                              facesOf(*result.full)),
                                  "scan", fmt::format("give as many as leave {} faces", kMinFaces));
        std::vector<surfacing::Surfaces> steps = surfacing::decimatedSteps(*result.full, percents, progress);
        if (job.percents.empty() && percents[0] < 100.0)
            result.caseNotes.push_back(fmt::format(
                "{} of the scan's {} faces are kept ({} %): finer ones do not show in a field of {} mm voxels. By that "
                "the tooth's surface moved by {:.4f} mm at most, a tissue's in it by {:.3f} mm. Ask for 100 % to keep "
                "all",
                facesOf(steps[0]), facesOf(*result.full), shown(percents[0]), fieldVoxelMm, steps[0].outer.errorBoundMm,
                worstOfTissuesMm(steps[0])));
        for (std::size_t i = 0; i < steps.size(); ++i)
            add(percents[i], std::move(steps[i]));
    }
    core::report(progress, 1.0);
}

/// Nothing is written that could not be opened.
void check(ScanResult& result, const core::Progress& progress) {
    const double share = 1.0 / static_cast<double>(result.cases.size());
    for (std::size_t i = 0; i < result.cases.size(); ++i) {
        const ScannedCase& made = result.cases[i];
        const double from = share * static_cast<double>(i);
        const std::string which =
            result.cases.size() > 1 ? fmt::format("the case of {} %: ", shown(made.percent)) : std::string();
        for (const cases::CaseFinding& f : cases::checkCase(made.toothCase, core::part(progress, from, from + share))) {
            const std::string told = which + (f.part.empty() ? "" : f.part + ": ") + f.what;
            if (f.isError)
                throw core::Error("the tooth of this scan cannot be cut: " + told, "scan",
                                  "ask for more faces or another grid of the tissues, or mark what is there by hand");
            result.caseNotes.push_back(told);
        }
    }
}

void requireJob(const ScanJob& job) {
    for (const double p : job.percents)
        if (!(p > 0.0 && p <= 100.0))
            throw core::Error(fmt::format("{} % is no share of a surface", p), "scan", "give above 0 to 100");
    if (job.faces > kMostFaces)
        throw core::Error(fmt::format("{} faces are more than are made", job.faces), "scan",
                          fmt::format("give {} at most", kMostFaces));
    if (job.faces > 0 && job.faces < kMinFaces)
        throw core::Error(fmt::format("{} faces do not make a tooth", job.faces), "scan",
                          fmt::format("give {} at least", kMinFaces));
    for (std::size_t i = 0; i < job.percents.size(); ++i)
        if (std::find(job.percents.begin() + static_cast<std::ptrdiff_t>(i) + 1, job.percents.end(), job.percents[i]) !=
            job.percents.end())
            throw core::Error(fmt::format("{} % is asked for twice", shown(job.percents[i])), "scan", "name it once");
}

}  // namespace

std::string_view nameOf(ScanStage stage) {
    constexpr std::array<std::string_view, kScanStages.size()> kNames{"reading", "segmenting", "making surfaces",
                                                                      "placing", "reducing",   "checking"};
    return kNames[static_cast<std::size_t>(stage)];
}

double ScanTimings::total() const {
    return std::accumulate(seconds.begin(), seconds.end(), 0.0);
}

volume::ReadSettings readSettings(const ScanJob& job) {
    volume::ReadSettings settings;
    settings.series = job.series;
    settings.spacingMm = job.spacingMm;
    settings.reverseSlices = job.reverseSlices;
    settings.isLabels = job.isLabels;
    settings.regionMm = job.regionMm;
    return settings;
}

std::vector<std::string> ScanResult::notes() const {
    std::vector<std::string> all;
    const auto take = [&](const std::vector<std::string>& some) {
        for (const std::string& note : some)
            if (std::find(all.begin(), all.end(), note) == all.end()) all.push_back(note);
    };
    if (scan) take(scan->series.notes);
    if (labelKey) take(labelKey->notes);
    if (region) take(region->notes);
    take(toothNotes);
    if (full) take(full->notes);
    if (registered)
        all.push_back(
            fmt::format("the intraoral scan lies {:.3f} mm (rms) off the CT's surface, 95 % of it within "
                        "{:.3f} mm, over {:.0f} % of it",
                        registered->rmsMm, registered->worstMm, 100.0 * registered->overlap));
    take(mouthNotes);
    take(placed.notes);
    take(ownNotes);
    for (const ScannedCase& c : cases)
        take(c.surfaces->notes);
    take(caseNotes);
    return all;
}

std::optional<ReadLabels> readLabels(const volume::Scan& scan, const ScanJob& job) {
    const std::string where = job.source.filename().string();
    if (!job.isLabels && !segmentation::looksLikeMouth(scan.volume, scan.series.labelNames)) {
        if (const int numbers = segmentation::unsaidLabels(scan.volume, scan.series.labelNames); numbers > 0)
            throw core::Error(fmt::format("its values are {} whole numbers and nothing between them: these look like "
                                          "labels, not like grey values",
                                          numbers),
                              where,
                              "say that they are labels (--labels), and of teeth what their numbers are (--numbers)")
                .as("labels-unsaid", {std::to_string(numbers)});
        return std::nullopt;
    }
    return keyed(volume::toLabels(scan.volume, where), scan.series, job);
}

ScanResult runScanJob(const ScanJob& job, const ScanProgress& progress, const ScanResult* before, ScanStage last) {
    requireJob(job);
    registration::requireFdi(job.placing.fdiNumber);
    // Known to be missing now, not after a minute of work.
    (void)tissuesOf(job.tissuesFile);
    if (!job.intraoral.empty() && !fs::is_regular_file(core::statusOf(job.intraoral)))
        throw core::Error("there is no such file", job.intraoral.string(), "check the intraoral scan's name");
    ScanResult result;
    if (before) result = *before;
    const ScanJob old = result.job;
    result.job = job;
    result.timings = {};
    result.cases.clear();
    result.caseNotes.clear();
    bool isStale = before == nullptr;
    struct Step {
        ScanStage stage;
        bool isSame, isThere;
        void (*work)(ScanResult&, const core::Progress&);
        void (*drop)(ScanResult&);
    };
    // In a mouth the number is a choice among its teeth; it is read before anybody asks.
    const auto sameRegion = [&] {
        return segmentToml(job) == segmentToml(old) &&
               (!result.isMouth() || job.placing.fdiNumber == old.placing.fdiNumber);
    };
    const auto sameSurface = [&] { return job.smooth == old.smooth && surfaceToml(job) == surfaceToml(old); };
    const auto samePlace = [&] {
        return job.scenery == old.scenery && job.placing.fdiNumber == old.placing.fdiNumber &&
               placeToml(job) == placeToml(old);
    };
    const std::array<Step, kScanStages.size()> steps{
        {{ScanStage::read, readToml(job) == readToml(old), result.scan != nullptr && (!job.isLabels || result.labelKey),
          &read,
          [](ScanResult& r) {
              r.scan.reset();
              r.labels.reset();
              r.labelKey.reset();
              r.grey.reset();
          }},
         {ScanStage::segment, sameRegion(), result.region != nullptr, &segment,
          [](ScanResult& r) {
              r.region.reset();
              r.volumesMm3 = {};
          }},
         {ScanStage::surface, sameSurface(), result.full != nullptr, &surface,
          [](ScanResult& r) {
              r.full.reset();
              r.registered.reset();
              r.others.clear();
              r.mouthNotes.clear();
          }},
         {ScanStage::place, samePlace(), result.isPlaced, &place,
          [](ScanResult& r) {
              r.placed = {};
              r.scenery.clear();
              r.ownNotes.clear();
              r.isPlaced = false;
          }},
         {ScanStage::decimate, false, false, &decimate, [](ScanResult& r) { r.cases.clear(); }},
         {ScanStage::check, false, false, &check, [](ScanResult&) {}}}};
    for (const Step& step : steps) {
        isStale = isStale || !step.isSame || !step.isThere;
        if (!isStale) continue;
        step.drop(result);
        if (step.stage > last) continue;
        const core::Progress listener = listenerOf(progress, step.stage);
        core::report(listener, 0.0);
        const Clock clock;
        step.work(result, listener);
        core::giveBackFreeMemory();
        if (step.stage == ScanStage::place) result.isPlaced = true;
        result.timings.seconds[static_cast<std::size_t>(step.stage)] = clock.seconds();
        core::report(listener, 1.0);
    }
    return result;
}

std::vector<fs::path> casePlaces(const ScanJob& job, const fs::path& out) {
    if (out.empty() || !out.has_filename())
        throw core::Error("a case needs a folder or a .handpiece file", "output", "name one");
    if (job.faces > 0 || job.percents.size() <= 1) return {out};
    std::vector<fs::path> places;
    for (const double percent : job.percents) {
        fs::path place = out;
        const bool isPackage = cases::isPackageName(out);
        place.replace_filename(fmt::format("{}-{}{}", (isPackage ? out.stem() : out.filename()).string(),
                                           shown(percent), isPackage ? out.extension().string() : ""));
        places.push_back(place);
    }
    return places;
}

std::vector<fs::path> writeScanCases(const ScanResult& result, const fs::path& out) {
    if (result.cases.empty()) throw core::Error("there is no case to write", "scan", "finish the scan's job first");
    const std::vector<fs::path> places = casePlaces(result.job, out);
    std::vector<fs::path> made;
    try {
        for (std::size_t i = 0; i < places.size(); ++i) {
            if (!core::isThere(places[i])) made.push_back(places[i]);
            cases::writeCase(result.cases[i].toothCase, places[i]);
        }
    } catch (const core::Error&) {
        std::error_code left;  // the error that is thrown says more
        for (const fs::path& place : made)
            fs::remove_all(place, left);
        throw;
    }
    return places;
}

}  // namespace handpiece::scan_case
