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

/// Steps of 1, 2 or 5 times a power of ten, so that about `count` fill `span`.
[[nodiscard]] double niceStep(double span, int count);
/// Drawn digits grouped by the locale: "212,000"; rounded to about three digits so that it reads calmly.
[[nodiscard]] QString rpmText(double rpm);

}  // namespace handpiece::desktop
