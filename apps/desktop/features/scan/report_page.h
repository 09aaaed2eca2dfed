// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Step 5: what came out and how good it is; saving and trying it.

#include "desktop/features/scan/choose_page.h"
#include "desktop/features/scan/page.h"

class QLabel;
class QLineEdit;
class QPushButton;

namespace handpiece::desktop {

class SolidView;

class ReportPage : public ScanPage {
    Q_OBJECT
  public:
    ReportPage(ScanModel& model, ScanQuestions& questions, const QString& folder, QWidget* parent = nullptr);
    [[nodiscard]] QString title() const override { return tr("Report and finish"); }
    [[nodiscard]] ScanModel::Depth depth() const override { return ScanModel::Depth::full; }

    /// Where it will be written.
    [[nodiscard]] QString place() const;
    void setPlace(const QString& place);

  signals:
    /// The case at `place` shall be opened in the simulator.
    void tryNow(const QString& place);

  private:
    void showJob();
    void showResult();
    void save(bool thenTry);
    [[nodiscard]] QString reportHtml() const;

    ScanQuestions& questions_;
    QString folder_;
    QLabel* text_;
    QLineEdit* place_;
    QPushButton *save_, *try_, *open_;
    QLabel* saved_;
    SolidView* solid_;
    bool placeChosen_ = false, tryWhenSaved_ = false;
};

}  // namespace handpiece::desktop
