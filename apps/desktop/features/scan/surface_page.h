// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Step 3: how fine the surfaces shall be, and an intraoral scan as the outside.

#include "desktop/features/scan/choose_page.h"
#include "desktop/features/scan/page.h"
#include "desktop/widgets/number_field.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QPushButton;

namespace handpiece::desktop {

class SolidView;

class SurfacePage : public ScanPage {
    Q_OBJECT
  public:
    SurfacePage(ScanModel& model, ScanQuestions& questions, QWidget* parent = nullptr);
    [[nodiscard]] QString title() const override { return tr("Surfaces"); }
    [[nodiscard]] ScanModel::Depth depth() const override { return ScanModel::Depth::full; }
    [[nodiscard]] QString missing() const override;

  private:
    void showJob();
    void showResult();

    ScanQuestions& questions_;
    QComboBox* resolution_;
    WholeField* faces_;
    QCheckBox *smooth_, *scenery_;
    DecimalField *spacing_, *reach_;
    QLabel *mouth_, *registered_, *figures_;
    QPushButton* mouthRemove_;
    SolidView* solid_;
    bool showing_ = false;
};

}  // namespace handpiece::desktop
