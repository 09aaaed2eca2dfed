// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What stands over a window's buttons.

#include <QScrollArea>

class QLayout;

namespace handpiece::desktop {

/// As large as what is in it wherever there is room; on a small screen it scrolls, and the buttons below stay in sight.
class Scrolled : public QScrollArea {
    Q_OBJECT
  public:
    explicit Scrolled(QLayout* contents, QWidget* parent = nullptr);
    [[nodiscard]] QSize sizeHint() const override;
    [[nodiscard]] QSize minimumSizeHint() const override;

  protected:
    bool eventFilter(QObject* of, QEvent* event) override;
};

}  // namespace handpiece::desktop
