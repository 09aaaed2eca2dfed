// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Step 4: which way is up, which way is mesial, and what the case is called.

#include "desktop/features/scan/page.h"

class QComboBox;
class QLabel;
class QLineEdit;
class QPushButton;

namespace handpiece::desktop {

class FdiPicker;
class SolidView;

/// +1: buccal is +y in the tooth's frame, -1: lingual is, 0: no tooth of the mouth. It follows from the quadrant, since
/// +z is occlusal and +x mesial.
[[nodiscard]] int buccalSignOf(int fdi);

class PlacingPage : public ScanPage {
    Q_OBJECT
  public:
    explicit PlacingPage(ScanModel& model, QWidget* parent = nullptr);
    [[nodiscard]] QString title() const override { return tr("Name and placing"); }
    [[nodiscard]] ScanModel::Depth depth() const override { return ScanModel::Depth::preview; }
    [[nodiscard]] QString missing() const override;

    /// Turns the tooth in its own frame.
    void turn(const core::Vec3& axis, double rad);

  private:
    void showJob();
    void showResult();

    QLineEdit* name_;
    FdiPicker* tooth_;
    QLabel *advice_, *confidence_;
    QPushButton* again_;
    SolidView* solid_;
};

}  // namespace handpiece::desktop
