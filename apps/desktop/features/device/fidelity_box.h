// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The check of how good a station feels: started here, its findings as a list, its report to a file.

#include <QWidget>
#include <optional>

#include "desktop/widgets/number_field.h"
#include "handpiece/devices/fidelity/fidelity.h"

class QCheckBox;
class QLabel;
class QProgressBar;
class QPushButton;
class QTreeWidget;

namespace handpiece::desktop {

/// [fidelityBox]. Plain data in, signals out.
class FidelityBox : public QWidget {
    Q_OBJECT
  public:
    explicit FidelityBox(QWidget* parent = nullptr);

    void setAvailable(bool available);
    void begin();
    void setFraction(double fraction);
    /// What comes next, and what the person does for it.
    void say(const QString& sentence);
    /// It ended without findings; `why` in the person's words.
    void end(const QString& why);
    void setReport(const fidelity::Report& report);
    [[nodiscard]] const std::optional<fidelity::Report>& report() const noexcept { return report_; }
    /// "Passed", "Look at this", "Failed", "Not measured".
    [[nodiscard]] static QString wordOf(fidelity::Verdict verdict);

  signals:
    void startRequested(const handpiece::fidelity::CheckSettings& settings);
    void cancelRequested();
    void saveRequested();

  private:
    void showRunning(bool running);

    std::optional<fidelity::Report> report_;
    bool available_ = false, running_ = false;
    WholeField* seconds_;
    QCheckBox* push_;
    QPushButton *start_, *cancel_, *save_;
    QProgressBar* progress_;
    QLabel* verdict_;
    QTreeWidget* list_;
};

}  // namespace handpiece::desktop
