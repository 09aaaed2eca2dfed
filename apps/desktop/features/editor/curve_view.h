// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A criterion's points by value, as a curve whose knots are dragged.

#include <QWidget>
#include <vector>

#include "handpiece/assess/rubric/rubric.h"

namespace handpiece::desktop {

/// [editorCurve]. Drag a knot; double click: another one; Delete or right button: away with it; Escape gives up a drag;
/// arrow keys move the one that was chosen.
class CurveView : public QWidget {
    Q_OBJECT
  public:
    explicit CurveView(QWidget* parent = nullptr);
    /// Of a measure that has values from `least` to `most`.
    void setCurve(const std::vector<rubric::Knot>& knots, const QString& unit, double least, double most);
    [[nodiscard]] QPointF at(const rubric::Knot& knot) const;

    [[nodiscard]] QSize sizeHint() const override { return {320, 150}; }
    [[nodiscard]] QSize minimumSizeHint() const override { return {180, 110}; }

  signals:
    void knotsChanged(const std::vector<handpiece::rubric::Knot>& knots);

  protected:
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    bool event(QEvent* event) override;

  private:
    [[nodiscard]] QRectF area() const;
    [[nodiscard]] rubric::Knot knotAt(const QPointF& place) const;
    [[nodiscard]] int knotUnder(const QPointF& place) const;
    /// Between its neighbours, on a round step.
    void moveKnot(int which, rubric::Knot to);
    void remove(int which);

    std::vector<rubric::Knot> knots_, before_;
    QString unit_;
    double least_ = 0.0, most_ = 1.0, low_ = 0.0, high_ = 1.0, step_ = 0.01;
    int chosen_ = -1;
    bool dragging_ = false;
};

}  // namespace handpiece::desktop
