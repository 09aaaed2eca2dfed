// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The groove along which a replay's time moves.

#include <QWidget>
#include <vector>

#include "desktop/features/replay/replay_bar.h"

namespace handpiece::desktop {

/// Strokes as bars, other events as ticks; click, drag and arrow keys move the time [replayTimeline].
class Timeline : public QWidget {
    Q_OBJECT
  public:
    explicit Timeline(QWidget* parent = nullptr);
    void setDuration(double durationS);
    void setMarks(const std::vector<ReplayMark>& marks);
    void setTime(double timeS);
    [[nodiscard]] double timeS() const { return timeS_; }
    [[nodiscard]] double durationS() const { return durationS_; }
    [[nodiscard]] const std::vector<ReplayMark>& marks() const { return marks_; }
    /// Pixel of a time, for tests.
    [[nodiscard]] double xOf(double timeS) const;

    [[nodiscard]] QSize sizeHint() const override;
    [[nodiscard]] QSize minimumSizeHint() const override;

  signals:
    void moved(double timeS, bool dragging);

  protected:
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    bool event(QEvent* event) override;

  private:
    void moveTo(double timeS, bool dragging);
    [[nodiscard]] double timeAt(double x) const;

    double durationS_ = 0.0, timeS_ = 0.0;
    bool dragging_ = false;
    std::vector<ReplayMark> marks_;
};

/// "1:05.3"
[[nodiscard]] QString timeText(double timeS);

}  // namespace handpiece::desktop
