// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The three curves as they are painted, on a screen, a picture or an SVG.

#include <QPixmap>
#include <QPolygonF>
#include <QWidget>
#include <deque>
#include <vector>

#include "desktop/features/measure/plot_panel.h"

namespace handpiece::desktop {

/// Axes are drawn once and kept; a repaint draws the curves, reduced to the extremes of each column of pixels.
class PlotView : public QWidget {
    Q_OBJECT
  public:
    static constexpr int kPlots = 3;
    struct Mark {
        double timeS;
        QString label;
    };

    explicit PlotView(QWidget* parent = nullptr);

    void append(const std::vector<simulation::PlotPoint>& points);
    void addMark(double timeS, const QString& label);
    void clear();
    void setForceLimit(double limitN);
    void setFreeSpeed(double rpm);
    void setPaused(bool paused);
    void setPractice(bool practice);
    [[nodiscard]] bool paused() const { return paused_; }
    [[nodiscard]] const std::deque<simulation::PlotPoint>& points() const { return paused_ ? frozen_ : points_; }
    /// Everything, for a device of any kind.
    void draw(QPainter& painter, const QSize& size) const;
    [[nodiscard]] double largestDrawn(int plot) const;
    [[nodiscard]] QSize sizeHint() const override { return {420, 330}; }
    [[nodiscard]] QSize minimumSizeHint() const override { return {240, 200}; }

  signals:
    /// What lies under the mouse; empty: nothing.
    void hovered(const QString& text);

  protected:
    void paintEvent(QPaintEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void changeEvent(QEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void leaveEvent(QEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;

  private:
    struct Axis {
        double least = 0, most = 1, step = 1;
    };
    [[nodiscard]] QRectF frameOf(int plot, const QSize& size) const;
    [[nodiscard]] double endS() const;
    /// Curve in pixels: the extremes of each column, in the order they came.
    [[nodiscard]] QPolygonF curve(int plot, const QRectF& frame) const;
    [[nodiscard]] static double valueOf(const simulation::PlotPoint& point, int plot);
    void fitAxes();
    void drawAxes(QPainter& painter, const QSize& size) const;
    /// `live`: as fast as a screen needs, else as fine as a file should be.
    void drawCurves(QPainter& painter, const QSize& size, bool live) const;
    void setHover(double timeS);

    std::deque<simulation::PlotPoint> points_, frozen_;
    std::vector<Mark> marks_;
    Axis axes_[kPlots];
    double limitN_ = 3.3, freeRpm_ = 400000, hoverS_ = -1;
    bool paused_ = false, practice_ = false;
    QPixmap axesPicture_;
};

}  // namespace handpiece::desktop
