// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/scan/scan_model.h"

#include <algorithm>

#include "desktop/framework/settings.h"
#include "handpiece/app/scan_case/scan_report.h"
#include "handpiece/base/core/file.h"

namespace handpiece::desktop {

using scan_case::ScanJob;
using scan_case::ScanResult;
using scan_case::ScanStage;

namespace {

constexpr int kPatienceMs = 150, kRememberMs = 700;
constexpr std::size_t kMaxSteps = 500;
constexpr int kDrawing = 100;  ///< behind the stages of scan_case::ScanStage: the report is drawn

/// What reading depends on.
ScanJob readPart(const ScanJob& job) {
    ScanJob part;
    part.source = job.source;
    part.series = job.series;
    part.spacingMm = job.spacingMm;
    part.reverseSlices = job.reverseSlices;
    part.regionMm = job.regionMm;
    part.isLabels = job.isLabels;
    part.labelOrder = job.labelOrder;
    part.labelNumbers = job.labelNumbers;
    part.grey = job.grey;
    return part;
}

/// What the preview shows: everything but how fine it will be, the words and the scan from the mouth.
ScanJob previewPart(ScanJob job) {
    const ScanJob fresh;
    job.percents = fresh.percents;
    job.faces = fresh.faces;
    job.name = fresh.name;
    job.kind = fresh.kind;
    job.tissuesFile.clear();
    job.intraoral.clear();
    job.intraoralInScan.reset();
    job.scenery = false;
    if (job.segmentation.spacingMm < kPreviewMm) job.segmentation.spacingMm = 0;
    return job;
}

}  // namespace

std::filesystem::path unfinishedScanFile() {
    return Folders::standard().settingsFile.parent_path() / "unfinished-scan.toml";
}

ScanModel::ScanModel(std::filesystem::path unfinished, QObject* parent)
    : QObject(parent), unfinished_(std::move(unfinished)) {
    // The name is the person's; the command line has one for whom gives none.
    history_.front().name.clear();
    looks_.setSingleShot(true);
    looks_.setInterval(kPatienceMs);
    connect(&looks_, &QTimer::timeout, this, [this] {
        next();
        emit workChanged();
    });
    remembers_.setSingleShot(true);
    remembers_.setInterval(kRememberMs);
    connect(&remembers_, &QTimer::timeout, this, &ScanModel::rememberNow);
}

ScanModel::~ScanModel() {
    if (remembers_.isActive()) rememberNow();
    running_.reset();
}

// ---- decisions

void ScanModel::decide(const ScanJob& job, const QString& merge) {
    if (scan_case::toToml(job) == scan_case::toToml(this->job())) return;
    history_.resize(at_ + 1);
    if (!merge.isEmpty() && merge == merge_ && at_ > 0) {
        history_[at_] = job;
    } else {
        history_.push_back(job);
        if (history_.size() > kMaxSteps) history_.erase(history_.begin());
        at_ = history_.size() - 1;
    }
    merge_ = merge;
    changed();
}

void ScanModel::undo() {
    if (!canUndo()) return;
    --at_;
    merge_.clear();
    changed();
}

void ScanModel::redo() {
    if (!canRedo()) return;
    ++at_;
    merge_.clear();
    changed();
}

void ScanModel::restart(const ScanJob& job) {
    history_ = {job};
    at_ = 0;
    merge_.clear();
    changed();
}

void ScanModel::changed() {
    paused_ = false;
    finished_ = false;
    clearProblem();
    if (history_.size() == 1 || seriesKey_ != keyOf(Work::looking)) molarSpacingMm_.reset();
    if (!job().source.empty()) remembers_.start();
    if (seriesKey_ != keyOf(Work::looking) && !series_.empty()) {
        series_.clear();
        emit seriesFound();
    }
    if (scan_ && scanKey_ != keyOf(Work::reading)) forgetScan();
    emit decided();
    looks_.start();
    emit workChanged();
}

void ScanModel::forgetScan() {
    scan_.reset();
    preview_.reset();
    full_.reset();
    emit scanRead();
    emit previewReady();
    emit fullReady();
}

// ---- unfinished work

bool ScanModel::hasUnfinished() const {
    std::error_code error;
    return !unfinished_.empty() && std::filesystem::exists(unfinished_, error);
}

void ScanModel::goOn() {
    try {
        restart(scan_case::readScanJob(unfinished_));
    } catch (const core::Error& error) {
        setProblem(problemOf(error));
    }
}

void ScanModel::giveUp() {
    remembers_.stop();
    std::error_code error;
    if (!unfinished_.empty()) std::filesystem::remove(unfinished_, error);
}

void ScanModel::rememberNow() {
    remembers_.stop();
    if (unfinished_.empty() || job().source.empty() || finished_) return;
    try {
        std::filesystem::create_directories(unfinished_.parent_path());
        scan_case::writeScanJob(job(), unfinished_);
    } catch (const std::exception&) {
        // Not worth a message: the work itself goes on, and only a closed wizard would begin anew.
        return;
    }
}

// ---- work

std::string ScanModel::keyOf(Work work) const {
    switch (work) {
        case Work::looking:
            return job().source.string();
        case Work::reading:
            return scan_case::toToml(readPart(job()));
        case Work::estimating:
            return "estimate " + job().source.string() + ' ' + job().series;
        case Work::previewing:
            return "preview " + scan_case::toToml(previewPart(job()));
        case Work::finishing: {
            return "full " + scan_case::toToml(job());
        }
        case Work::writing:
            return out_.string() + scan_case::toToml(job());
        case Work::none:
            break;
    }
    return {};
}

ScanModel::Work ScanModel::needed() const {
    if (paused_ || job().source.empty()) return Work::none;
    const auto unless = [this](Work work) { return stoppedKey_ == keyOf(work) ? Work::none : work; };
    if (series_.empty()) return unless(Work::looking);
    if (estimateAsked_) return unless(Work::estimating);
    if (wanted_ == Depth::series) return Work::none;
    if (!scan_) return chosenSeries() && !isSpacingAsked() ? unless(Work::reading) : Work::none;
    if (writeAsked_) return isFullFresh() ? unless(Work::writing) : unless(Work::finishing);
    if (wanted_ >= Depth::preview && !isPreviewFresh()) return unless(Work::previewing);
    if (wanted_ >= Depth::full && !isFullFresh()) return unless(Work::finishing);
    return Work::none;
}

void ScanModel::want(Depth depth) {
    wanted_ = depth;
    next();
    emit workChanged();
}

void ScanModel::estimateSpacing() {
    estimateAsked_ = true;
    tryAgain();
}

void ScanModel::next() {
    if (running_) {
        // A preview that is nearly there is shown while the hand still drags; everything else stale is given up.
        if (!cancelling_ && workKey_ != keyOf(work_)) {
            cancelling_ = true;
            running_->cancel();
        }
        return;
    }
    const Work work = needed();
    const std::string key = keyOf(work);
    const ScanJob job = this->job();
    switch (work) {
        case Work::none:
            return;
        case Work::looking: {
            auto found = std::make_shared<std::vector<volume::Series>>();
            begin(
                work, key,
                [found, job](const core::Progress& progress) { *found = volume::findSeries(job.source, progress); },
                [this, found, key] {
                    series_ = *found;
                    seriesKey_ = key;
                    emit seriesFound();
                });
            return;
        }
        case Work::estimating: {
            auto spacing = std::make_shared<core::Vec3>(core::Vec3::Ones());
            if (const volume::Series* chosen = chosenSeries(); chosen && chosen->isSpacingKnown)
                *spacing = chosen->spacingMm / chosen->spacingMm.x();
            begin(
                work, key,
                [spacing, job](const core::Progress& progress) {
                    volume::ReadSettings settings = scan_case::readSettings(job);
                    settings.takeLargest = true;
                    settings.spacingMm = *spacing;
                    settings.regionMm.reset();  // in millimetres, which are what is looked for
                    const volume::Scan scan = volume::readScan(job.source, settings, core::part(progress, 0.0, 0.5));
                    *spacing *= scaleByMolar(scan.volume, core::part(progress, 0.5, 1.0));
                },
                [this, spacing] {
                    estimateAsked_ = false;
                    molarSpacingMm_ = *spacing;
                    emit spacingEstimated();
                });
            return;
        }
        case Work::reading: {
            auto shown = std::make_shared<ShownScan>();
            begin(
                work, key,
                [shown, job](const core::Progress& progress) {
                    volume::ReadSettings settings = scan_case::readSettings(job);
                    settings.takeLargest = true;
                    volume::Scan scan = volume::readScan(job.source, settings, core::part(progress, 0.0, 0.9));
                    *shown = shownScan(std::move(scan), job, core::part(progress, 0.9, 1.0));
                },
                [this, shown, key] {
                    scan_ = shown;
                    scanKey_ = key;
                    emit scanRead();
                });
            return;
        }
        case Work::previewing:
        case Work::finishing: {
            const bool isPreview = work == Work::previewing;
            auto made = std::make_shared<ShownResult>();
            const std::shared_ptr<const ShownResult> before = isPreview ? preview_ : full_;
            const ScanJob asked = isPreview ? previewPart(job) : job;
            ScanResult first;
            first.job = readPart(job);
            first.scan = isPreview ? scan_->coarse : scan_->scan;
            first.labels = isPreview ? scan_->coarseLabels : scan_->labels;
            first.labelKey = scan_->labelKey;
            begin(
                work, key,
                [this, made, before, asked, first, isPreview, shown = scan_](const core::Progress& progress) {
                    ScanResult from = before ? before->result : first;
                    if (isPreview && (!before || from.job.segmentation.toothAtMm != asked.segmentation.toothAtMm))
                        from.scan = previewScan(*shown, asked.segmentation);
                    const scan_case::ScanProgress told = [&](ScanStage stage, double fraction) {
                        stage_.store(static_cast<int>(stage), std::memory_order_relaxed);
                        // The last share is for what is shown of it.
                        const double stages = isPreview ? 4.2 : 6.5;
                        return !progress || progress(std::min(1.0, (static_cast<double>(stage) + fraction) / stages));
                    };
                    *made = shownResult(
                        scan_case::runScanJob(asked, told, &from, isPreview ? ScanStage::place : ScanStage::check),
                        core::part(progress, isPreview ? 0.95 : 0.91, 1.0));
                },
                [this, made, key, isPreview] {
                    (isPreview ? preview_ : full_) = made;
                    (isPreview ? previewKey_ : fullKey_) = key;
                    if (isPreview)
                        emit previewReady();
                    else
                        emit fullReady();
                });
            return;
        }
        case Work::writing: {
            struct Written {
                std::vector<std::filesystem::path> places;
                std::filesystem::path report;
                std::optional<Problem> problem;
            };
            auto made = std::make_shared<Written>();
            begin(
                work, key,
                [this, made, result = full_, out = out_](const core::Progress& progress) {
                    made->places = scan_case::writeScanCases(result->result, out);
                    stage_.store(kDrawing, std::memory_order_relaxed);
                    const std::filesystem::path place = scan_case::scanReportPlace(out, made->places);
                    try {
                        core::writeFile(place, scan_case::scanReport(result->result, made->places, {},
                                                                     core::part(progress, 0.1, 1.0)));
                        made->report = place;
                    } catch (const core::Error& error) {
                        // The case is there. Whoever stopped the drawing knows that there is none.
                        if (progress(1.0))
                            made->problem = problemById(QStringLiteral("scan-report-missing"), {problemOf(error).what},
                                                        toQString(place));
                    }
                },
                [this, made, key] {
                    written_ = made->places;
                    report_ = made->report;
                    writeAsked_ = false;
                    // A decision of the meantime is unfinished again.
                    if (key == keyOf(Work::writing)) {
                        finished_ = true;
                        giveUp();
                    }
                    emit casesWritten();
                    if (made->problem) setProblem(*made->problem);
                });
            return;
        }
    }
}

void ScanModel::begin(Work work, const std::string& key, Job::Work what, std::function<void()> then) {
    work_ = work;
    workKey_ = key;
    stage_ = -1;
    cancelling_ = byPerson_ = false;
    running_ = std::make_unique<Job>(doing(), std::move(what));
    Job* job = running_.get();
    connect(job, &Job::progressed, this, [this](double fraction) { emit progressed(fraction); });
    connect(job, &Job::done, this, [this, then = std::move(then)] {
        // An old preview is better than none; what was found in another scan is not.
        const bool stale =
            workKey_ != keyOf(work_) && (work_ == Work::looking || work_ == Work::reading || work_ == Work::estimating);
        ended();
        if (!stale) then();
        next();
        emit workChanged();
    });
    connect(job, &Job::failed, this, [this](const Problem& problem) {
        // What failed is old by now: it is told when it fails again.
        const bool stale = workKey_ != keyOf(work_);
        if (!stale) stoppedKey_ = workKey_;
        ended();
        writeAsked_ = estimateAsked_ = false;
        if (!stale) setProblem(problem);
        next();
        emit workChanged();
    });
    connect(job, &Job::cancelled, this, [this] {
        paused_ = byPerson_;
        if (byPerson_) writeAsked_ = estimateAsked_ = false;
        ended();
        next();
        emit workChanged();
    });
    job->start();
    emit workChanged();
}

void ScanModel::ended() {
    work_ = Work::none;
    running_.release()->deleteLater();
}

QString ScanModel::doing() const {
    switch (work_) {
        case Work::looking:
            return tr("Looking what is there");
        case Work::reading:
            return tr("Reading the slices");
        case Work::estimating:
            return tr("Measuring the tooth");
        case Work::writing:
            return stage_.load(std::memory_order_relaxed) == kDrawing ? tr("Drawing the report")
                                                                      : tr("Writing the case");
        case Work::previewing:
        case Work::finishing:
            break;
        case Work::none:
            return {};
    }
    const int stage = stage_.load(std::memory_order_relaxed);
    const QString what = stage == static_cast<int>(ScanStage::segment)    ? tr("Finding the tissues")
                         : stage == static_cast<int>(ScanStage::surface)  ? tr("Making surfaces")
                         : stage == static_cast<int>(ScanStage::place)    ? tr("Finding which way is up")
                         : stage == static_cast<int>(ScanStage::decimate) ? tr("Reducing the faces")
                         : stage == static_cast<int>(ScanStage::check)    ? tr("Checking the case")
                                                                          : tr("Reading the slices");
    return work_ == Work::previewing ? tr("Preview: %1").arg(what) : tr("In full: %1").arg(what);
}

void ScanModel::cancel() {
    if (!running_) return;
    byPerson_ = cancelling_ = true;
    running_->cancel();
}

void ScanModel::tryAgain() {
    paused_ = false;
    stoppedKey_.clear();
    clearProblem();
    next();
    emit workChanged();
}

void ScanModel::clearProblem() {
    if (!problem_) return;
    problem_.reset();
    emit problemChanged();
}

void ScanModel::setProblem(const Problem& problem) {
    problem_ = problem;
    emit problemChanged();
}

const volume::Series* ScanModel::chosenSeries() const {
    if (series_.size() == 1) return &series_.front();
    const auto found =
        std::find_if(series_.begin(), series_.end(), [this](const volume::Series& s) { return s.id == job().series; });
    return found == series_.end() ? nullptr : &*found;
}

bool ScanModel::isSpacingAsked() const {
    const volume::Series* chosen = chosenSeries();
    return chosen && !chosen->isSpacingKnown && !job().spacingMm;
}

bool ScanModel::isPreviewFresh() const {
    return preview_ && previewKey_ == keyOf(Work::previewing);
}

bool ScanModel::isFullFresh() const {
    return full_ && fullKey_ == keyOf(Work::finishing);
}

std::shared_ptr<const ShownResult> ScanModel::best() const {
    return isFullFresh() ? full_ : preview_ ? preview_ : full_;
}

void ScanModel::write(const std::filesystem::path& out) {
    out_ = out;
    writeAsked_ = true;
    tryAgain();
}

}  // namespace handpiece::desktop
