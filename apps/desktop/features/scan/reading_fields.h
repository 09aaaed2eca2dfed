// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How a scan is read, where the file alone does not settle it: which part of it, and what the numbers of labels mean.

#include <QWidget>
#include <array>
#include <functional>

#include "desktop/features/scan/scan_model.h"
#include "desktop/widgets/number_field.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QPushButton;

namespace handpiece::desktop {

struct ScanQuestions;

class ReadingFields : public QWidget {
    Q_OBJECT
  public:
    ReadingFields(ScanModel& model, ScanQuestions& questions, QWidget* parent);
    void showJob();

  private:
    void decide(const std::function<void(scan_case::ScanJob&)>& change);
    [[nodiscard]] QWidget* regionFields();
    [[nodiscard]] QWidget* labelFields();
    void takeRegion();

    ScanModel& model_;
    ScanQuestions& questions_;
    QCheckBox *part_, *labels_;
    QWidget *corners_, *meaning_;
    std::array<DecimalField*, 6> corner_{};  ///< x, y, z of the one, then of the other [mm]
    QComboBox* numbers_;
    QPushButton *grey_, *noGrey_;
    QLabel* greyFile_;
    bool showing_ = false;
};

}  // namespace handpiece::desktop
