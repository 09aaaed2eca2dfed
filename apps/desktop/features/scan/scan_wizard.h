// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// File, New case from scan: from a folder of slices to a case, in one window with five steps.

#include <QDialog>
#include <vector>

#include "desktop/features/scan/choose_page.h"
#include "desktop/features/scan/scan_model.h"

class QFrame;
class QLabel;
class QListWidget;
class QProgressBar;
class QPushButton;
class QStackedWidget;
class QToolButton;

namespace handpiece::desktop {

class PlacingPage;
class ReportPage;
class ScanPage;
class SurfacePage;
class TissuePage;

/// [scanWizard]. Not modal: the simulator goes on behind it. Closed before its end it keeps its decisions, and offers
/// them at its next start.
class ScanWizard : public QDialog {
    Q_OBJECT
  public:
    enum Step { choose, tissues, surfaces, placing, report, stepCount };
    /// `unfinished` as ScanModel's; `folder`: where cases are saved when nothing else is said.
    ScanWizard(std::filesystem::path unfinished, const QString& folder, QWidget* parent = nullptr);
    ~ScanWizard() override;

    /// A file or folder to begin with.
    void take(const QString& path);
    /// Shows a step, if nothing that stands before it is missing.
    bool goTo(Step step);
    [[nodiscard]] Step step() const;
    [[nodiscard]] ScanModel& model() noexcept { return model_; }
    [[nodiscard]] ReportPage* reportPage() const noexcept { return report_; }

    ScanQuestions questions;

  signals:
    void tryNow(const QString& place);

  protected:
    void keyPressEvent(QKeyEvent* event) override;
    void changeEvent(QEvent* event) override;

  private:
    void showWork();
    void showProblem();
    void showSteps();
    void saveSteps();
    [[nodiscard]] ScanPage* page(int step) const;

    ScanModel model_;
    QListWidget* steps_;
    QStackedWidget* pages_;
    ChoosePage* choose_;
    TissuePage* tissues_;
    SurfacePage* surfaces_;
    PlacingPage* placing_;
    ReportPage* report_;
    QFrame *problem_, *unfinished_, *work_;
    QLabel *problemSymbol_, *problemWhat_, *problemRemedy_, *doing_, *missing_;
    QProgressBar* progress_;
    QToolButton *undo_, *redo_;
    QPushButton *cancel_, *again_, *saveSteps_, *back_, *next_, *close_;
};

}  // namespace handpiece::desktop
