// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The teeth of a mouth, to choose one by.

#include <QPainterPath>
#include <QPolygonF>
#include <QWidget>
#include <map>
#include <set>
#include <vector>

#include "desktop/widgets/notation.h"

namespace handpiece::desktop {

/// A tooth as it is, seen from above [mm]: x towards mesial, y towards buccal.
struct ToothDrawing {
    QPolygonF outline;
    std::vector<QPolygonF> grooves;
};

/// The arches as a dentist sees them, patient's right on the left [toothChart]. Arrow keys move, Enter chooses.
class ToothChart : public QWidget {
    Q_OBJECT
  public:
    explicit ToothChart(QWidget* parent = nullptr);

    void setNotation(Notation notation);
    [[nodiscard]] Notation notation() const { return notation_; }
    /// The 20 primary teeth inside the arches.
    void setPrimaryShown(bool shown);
    /// FDI numbers that can be chosen; the others look absent.
    void setAvailable(const std::set<int>& teeth);
    /// Those that are drawn as they are; the others as their kind.
    void setDrawings(std::map<int, ToothDrawing> drawings);
    /// Teeth of which there is more, with what a tooltip tells of it.
    void setMarks(std::map<int, QString> marks);
    /// The tooth on the screen; 0: none.
    void setChosen(int fdi);
    [[nodiscard]] int chosen() const { return chosen_; }
    /// Middle of a tooth in widget pixels, for tests and scripts.
    [[nodiscard]] QPointF centreOf(int fdi) const;

    [[nodiscard]] QSize sizeHint() const override;
    [[nodiscard]] QSize minimumSizeHint() const override;

  signals:
    void toothChosen(int fdi);

  protected:
    void paintEvent(QPaintEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void leaveEvent(QEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    bool event(QEvent* event) override;

  private:
    struct Place {
        int fdi;
        QPointF centre;
        QPainterPath outline, grooves;
        QPointF label;
    };
    void layOut();
    [[nodiscard]] const Place* at(const QPointF& point) const;
    void choose(int fdi);
    void moveFocus(int along, bool otherArch);

    std::vector<Place> places_;
    std::set<int> available_;
    std::map<int, ToothDrawing> drawings_;
    std::map<int, QString> marks_;
    Notation notation_ = Notation::fdi;
    bool primary_ = false;
    int chosen_ = 0, hovered_ = 0, focused_ = 0;
};

}  // namespace handpiece::desktop
