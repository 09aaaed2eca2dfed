// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The surfaces that a scan becomes, turned by hand.

#include <QImage>
#include <QWidget>
#include <memory>
#include <vector>

#include "handpiece/model/case/case.h"
#include "handpiece/senses/view/camera.h"
#include "handpiece/senses/view/look.h"

class QHBoxLayout;

namespace handpiece::desktop {

/// Drag: turn; right or middle button: shift; wheel: nearer; double click or Home: all of it; arrow keys turn. Drawn in
/// a thread of its own by the renderer of the simulator.
class SolidView : public QWidget {
    Q_OBJECT
  public:
    explicit SolidView(const char* name, QWidget* parent = nullptr);
    ~SolidView() override;

    /// Nothing to be seen: no parts. The eye stays where it is unless the size is quite another.
    void setParts(std::shared_ptr<const std::vector<cases::Part>> parts, const core::Box& bounds);
    /// A line about what is shown, above the picture ("Preview"); dimmed when it is no longer true.
    void setCaption(const QString& caption, bool isStale);
    /// In the picture's place while there is nothing to be seen.
    void setPlaceholder(const QString& words);
    /// Occlusal, mesial and the sides as arrows; `buccalSign` 0: the sides without names.
    void setAxesShown(bool shown, int buccalSign);
    /// As the buttons below the picture do, one a tissue that there is [NAME_enamel, ...].
    void setTissueShown(cases::Tissue tissue, bool shown);
    void lookFrom(view::StandardView from, int buccalSign = 0);
    /// The latest picture is of the latest wish.
    [[nodiscard]] bool isDrawn() const noexcept;
    [[nodiscard]] const QImage& picture() const noexcept { return picture_; }
    [[nodiscard]] const view::Camera& camera() const noexcept { return camera_; }

    [[nodiscard]] QSize sizeHint() const override { return {360, 320}; }
    [[nodiscard]] QSize minimumSizeHint() const override { return {160, 140}; }

  protected:
    void paintEvent(QPaintEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void showEvent(QShowEvent* event) override;
    void changeEvent(QEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;

  private:
    struct Worker;
    void wish();
    void take();
    void fit();
    void makeTissueButtons();
    void drawAxes(QPainter& painter) const;

    std::unique_ptr<Worker> worker_;
    std::shared_ptr<const std::vector<cases::Part>> parts_;
    core::Box bounds_;
    view::Camera camera_;
    view::Look look_;
    QImage picture_;
    QString caption_, missing_, placeholder_;
    bool isStale_ = false, axesShown_ = false, placed_ = false;
    int buccalSign_ = 0;
    Qt::MouseButton held_ = Qt::NoButton;
    QPointF last_;
    QHBoxLayout* tissues_;
    std::vector<cases::Tissue> there_;
};

}  // namespace handpiece::desktop
