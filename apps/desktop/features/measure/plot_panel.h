// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Force, depth and speed of the last 20 seconds.

#include <QByteArray>
#include <QImage>
#include <QWidget>
#include <vector>

#include "desktop/widgets/detail.h"
#include "handpiece/app/simulation/live_session.h"

class QLabel;
class QToolButton;

namespace handpiece::desktop {

class PlotView;

/// Live plots [plotPanel]. Fed about 30 times a second; a hidden panel costs nothing but keeping the points.
class PlotPanel : public QWidget {
    Q_OBJECT
  public:
    static constexpr double kSpanS = 20.0;

    explicit PlotPanel(QWidget* parent = nullptr);

    /// Points in the order of time; a time before the last one begins anew.
    void append(const std::vector<simulation::PlotPoint>& points);
    /// A mark over all plots.
    void addEvent(double timeS, const QString& label);
    void clear();
    /// The device's largest force [N]: a line in the plot. 0: none.
    void setForceLimit(double limitN);
    /// Top of the speed's axis [rpm].
    void setFreeSpeed(double rpm);
    /// Stands still; what comes meanwhile is kept.
    void setPaused(bool paused);
    [[nodiscard]] bool paused() const;
    void setDetail(Detail detail);

    // What is shown now, to be written by the window.

    [[nodiscard]] QByteArray svg(const QSize& size = {1000, 600}) const;
    [[nodiscard]] QImage picture(const QSize& size = {1000, 600}, double pixelRatio = 2.0) const;
    /// A header with units and a row a point.
    [[nodiscard]] QByteArray csv() const;
    /// The largest value drawn in a column of pixels, for tests: plot 0 force, 1 depth, 2 speed.
    [[nodiscard]] double largestDrawn(int plot) const;

  signals:
    void pausedChanged(bool paused);
    /// "svg", "png" or "csv": the window asks where to and writes svg(), picture() or csv().
    void saveRequested(const QString& format);

  private:
    PlotView* view_;
    QToolButton *pause_, *save_;
    QLabel* readout_;
};

}  // namespace handpiece::desktop
