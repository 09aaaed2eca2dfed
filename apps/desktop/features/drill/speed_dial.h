// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A rev counter.

#include <QWidget>

namespace handpiece::desktop {

/// Scale to the free speed, needle, a mark at the set speed, the number in the middle [speedDial].
class SpeedDial : public QWidget {
    Q_OBJECT
  public:
    explicit SpeedDial(QWidget* parent = nullptr);
    void setFreeSpeed(double rpm);
    void setSetSpeed(double rpm);
    void setSpeed(double rpm, bool stalled);

    [[nodiscard]] QSize sizeHint() const override;
    [[nodiscard]] QSize minimumSizeHint() const override;

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    double freeRpm_ = 400000, setRpm_ = 400000, rpm_ = 0;
    bool stalled_ = false;
};

}  // namespace handpiece::desktop
