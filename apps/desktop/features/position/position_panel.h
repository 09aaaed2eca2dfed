// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where the operator sits: a clock about the patient's head.

#include <QWidget>
#include <array>
#include <vector>

class QCheckBox;
class QLabel;
class QToolButton;

namespace handpiece::desktop {

/// Hours to sit at, as buttons about a head seen from above [positionClock]. Left and right arrow: the hour beside.
class PositionClock : public QWidget {
    Q_OBJECT
  public:
    explicit PositionClock(QWidget* parent = nullptr);
    void setHour(int hour);  ///< 0: none is chosen
    [[nodiscard]] QSize sizeHint() const override;
    [[nodiscard]] QSize minimumSizeHint() const override { return sizeHint(); }

  signals:
    void chosen(int hour);

  protected:
    void paintEvent(QPaintEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;

  private:
    [[nodiscard]] QPointF placeOf(int hour, double share) const;
    std::vector<std::pair<int, QToolButton*>> hours_;  ///< in the order of the clock, from 8
    int hour_ = 0;
};

/// Clock and what is usual for the tooth [positionPanel].
class PositionPanel : public QWidget {
    Q_OBJECT
  public:
    explicit PositionPanel(QWidget* parent = nullptr);
    void setHour(int hour) { clock_->setHour(hour); }
    /// Of the tooth that is open; `isKnown`: where its head lies is known.
    void setTooth(int fdiNumber, bool isKnown);

  signals:
    void chosen(int hour);

  private:
    void tell();
    PositionClock* clock_;
    QCheckBox* leftHanded_;
    QLabel* usual_;
    int fdiNumber_ = 0;
    bool isKnown_ = false;
};

}  // namespace handpiece::desktop
