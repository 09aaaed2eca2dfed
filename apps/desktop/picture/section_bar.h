// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The small bar by which a section is placed: direction, place, side.

#include <QFrame>

#include "desktop/picture/measuring.h"
#include "desktop/widgets/number_field.h"
#include "handpiece/base/core/vec.h"

class QButtonGroup;
class QToolButton;

namespace handpiece::desktop {

class SectionBar : public QFrame {
    Q_OBJECT
  public:
    explicit SectionBar(QWidget* parent = nullptr);
    /// Shows a place without telling anybody.
    void setPlace(const SectionPlace& place, const core::Box& bounds);
    [[nodiscard]] const SectionPlace& place() const { return place_; }

  signals:
    void placeChanged(const handpiece::desktop::SectionPlace& place);
    void closed();

  private:
    SectionPlace place_;
    core::Box bounds_;
    QButtonGroup* directions_ = nullptr;
    DecimalField* offset_ = nullptr;
    QToolButton* flip_ = nullptr;
};

/// The axis of the tooth frame a direction's plane stands across: 0, 1 or 2.
[[nodiscard]] int axisAcross(SectionPlace::Direction direction);

}  // namespace handpiece::desktop
