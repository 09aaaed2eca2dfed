// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The scan that is being made into a case: what a person decided, undo and redo of it, and the work that follows.

#include <QObject>
#include <QString>
#include <QTimer>
#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "desktop/features/scan/shown_scan.h"
#include "desktop/framework/job.h"
#include "handpiece/app/scan_case/scan_job.h"

namespace handpiece::desktop {

/// Where it lies for tests and for the program: beside the settings.
[[nodiscard]] std::filesystem::path unfinishedScanFile();

/// Knows no widget. Decisions come in by decide(); what they ask for is worked out on a thread of its own, one thing at
/// a time, begun again when a decision changes it. Everything is signalled on the thread that made it.
class ScanModel : public QObject {
    Q_OBJECT
  public:
    /// How far the work shall go by itself: as far as the page that is open needs.
    enum class Depth { series, scan, preview, full };

    /// `unfinished`: where decisions are kept until the case is written; empty: nowhere.
    explicit ScanModel(std::filesystem::path unfinished, QObject* parent = nullptr);
    ~ScanModel() override;

    // Decisions.
    [[nodiscard]] const scan_case::ScanJob& job() const noexcept { return history_[at_]; }
    /// Decisions with the same `merge` in a row are one step of undo (a handle that is dragged); empty: never merged.
    void decide(const scan_case::ScanJob& job, const QString& merge = {});
    /// The next decision is a step of its own, whatever its `merge`.
    void endMerge() { merge_.clear(); }
    [[nodiscard]] bool canUndo() const noexcept { return at_ > 0; }
    [[nodiscard]] bool canRedo() const noexcept { return at_ + 1 < history_.size(); }
    void undo();
    void redo();
    /// All decisions at once, as out of a file; without history.
    void restart(const scan_case::ScanJob& job);

    // Unfinished work of another time.
    [[nodiscard]] bool hasUnfinished() const;
    void goOn();    ///< with it
    void giveUp();  ///< the file goes
    void rememberNow();

    // Work.
    void want(Depth depth);
    [[nodiscard]] bool isBusy() const noexcept { return work_ != Work::none || looks_.isActive(); }
    [[nodiscard]] QString doing() const;
    void cancel();
    /// After an error or a cancel.
    void tryAgain();
    [[nodiscard]] bool isPaused() const noexcept { return paused_; }
    [[nodiscard]] const std::optional<Problem>& problem() const noexcept { return problem_; }
    /// Told as the work's own are.
    void setProblem(const Problem& problem);

    // What came out. Null or empty: not yet.
    [[nodiscard]] const std::vector<volume::Series>& series() const noexcept { return series_; }
    [[nodiscard]] bool isSeriesKnown() const noexcept { return !series_.empty(); }
    /// The chosen one; null when none is.
    [[nodiscard]] const volume::Series* chosenSeries() const;
    /// Whether the slices' spacing must be given by the person.
    [[nodiscard]] bool isSpacingAsked() const;
    /// What a mean molar makes of it [mm], in proportion to what the scan tells; none until it was asked for.
    [[nodiscard]] const std::optional<core::Vec3>& molarSpacingMm() const noexcept { return molarSpacingMm_; }
    void estimateSpacing();
    [[nodiscard]] std::shared_ptr<const ShownScan> scan() const noexcept { return scan_; }
    /// As the person says, or as the scan plainly is.
    [[nodiscard]] bool isLabels() const { return job().isLabels || (scan_ && scan_->labels); }
    [[nodiscard]] std::shared_ptr<const ShownResult> preview() const noexcept { return preview_; }
    [[nodiscard]] std::shared_ptr<const ShownResult> full() const noexcept { return full_; }
    /// Whether it is of the decisions as they are now.
    [[nodiscard]] bool isPreviewFresh() const;
    [[nodiscard]] bool isFullFresh() const;
    /// The full one when it is fresh, else the preview.
    [[nodiscard]] std::shared_ptr<const ShownResult> best() const;

    /// Writes the finished case or cases, and then their report: where that fails, the cases stay.
    void write(const std::filesystem::path& out);
    [[nodiscard]] const std::vector<std::filesystem::path>& written() const noexcept { return written_; }
    /// Of what was written; empty where it could not be made, or was stopped.
    [[nodiscard]] const std::filesystem::path& report() const noexcept { return report_; }

  signals:
    void decided();      ///< job() is another
    void seriesFound();  ///< also when they are gone
    void spacingEstimated();
    void scanRead();  ///< also when it is gone
    void previewReady();
    void fullReady();
    void workChanged();  ///< isBusy(), doing(), isPaused()
    void progressed(double fraction);
    void problemChanged();
    void casesWritten();

  private:
    enum class Work { none, looking, reading, estimating, previewing, finishing, writing };
    void changed();
    void next();
    void begin(Work work, const std::string& key, Job::Work what, std::function<void()> then);
    void ended();
    [[nodiscard]] std::string keyOf(Work work) const;
    [[nodiscard]] Work needed() const;
    void clearProblem();
    void forgetScan();

    std::filesystem::path unfinished_;
    std::vector<scan_case::ScanJob> history_{1};
    std::size_t at_ = 0;
    QString merge_;

    Depth wanted_ = Depth::series;
    Work work_ = Work::none;
    std::string workKey_;
    std::unique_ptr<Job> running_;
    std::atomic<int> stage_{-1};
    bool paused_ = false, cancelling_ = false, byPerson_ = false;
    QTimer looks_, remembers_;
    std::optional<Problem> problem_;
    std::string stoppedKey_;

    std::vector<volume::Series> series_;
    std::string seriesKey_, scanKey_, previewKey_, fullKey_;
    std::optional<core::Vec3> molarSpacingMm_;
    bool estimateAsked_ = false;
    std::shared_ptr<const ShownScan> scan_;
    std::shared_ptr<const ShownResult> preview_, full_;
    std::filesystem::path out_, report_;
    std::vector<std::filesystem::path> written_;
    bool writeAsked_ = false, finished_ = false;
};

}  // namespace handpiece::desktop
