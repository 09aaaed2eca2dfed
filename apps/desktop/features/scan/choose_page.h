// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Step 1: which scan.

#include <functional>

#include "desktop/features/scan/page.h"
#include "desktop/widgets/number_field.h"

class QCheckBox;
class QFrame;
class QLabel;
class QListWidget;
class QPushButton;

namespace handpiece::desktop {

/// Asks for a file or folder, or shows one; tests put their own answers here.
struct ScanQuestions {
    std::function<QString(const QString& title)> folder;
    std::function<QString(const QString& title, const QString& filter)> fileToOpen;
    std::function<QString(const QString& title, const QString& name, const QString& filter)> fileToSave;
    std::function<bool(const QString& file)> showPage;
};

class ReadingFields;

class ChoosePage : public ScanPage {
    Q_OBJECT
  public:
    ChoosePage(ScanModel& model, ScanQuestions& questions, QWidget* parent = nullptr);
    [[nodiscard]] QString title() const override { return tr("Choose the scan"); }
    [[nodiscard]] ScanModel::Depth depth() const override { return ScanModel::Depth::scan; }
    [[nodiscard]] QString missing() const override;

    /// A file or folder, dropped or found.
    void take(const QString& path);

  protected:
    void dragEnterEvent(QDragEnterEvent* event) override;
    void dragLeaveEvent(QDragLeaveEvent* event) override;
    void dropEvent(QDropEvent* event) override;

  private:
    void showSeries();
    void showDetails();
    void showJob();
    void takeSpacing();

    ScanQuestions& questions_;
    QWidget* found_;
    QFrame *drop_, *details_, *spacingBox_;
    QLabel *dropText_, *source_, *picture_, *what_, *notes_, *spacingWhy_, *molar_, *way_;
    QListWidget* list_;
    DecimalField *within_, *between_;
    QPushButton* estimate_;
    QCheckBox* reverse_;
    ReadingFields* reading_;
    bool showing_ = false;
};

}  // namespace handpiece::desktop
