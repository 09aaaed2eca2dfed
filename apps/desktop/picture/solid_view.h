// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Surfaces of a tooth, turned by hand, with glass over them and handles to drag.

#include <QImage>
#include <QWidget>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "handpiece/model/case/case.h"
#include "handpiece/senses/view/camera.h"
#include "handpiece/senses/view/look.h"
#include "handpiece/senses/view/renderer.h"

class QHBoxLayout;

namespace handpiece::desktop {

/// Something to be dragged along a line, tooth frame.
struct SolidHandle {
    core::Vec3 placeMm = core::Vec3::Zero(), way = core::Vec3::UnitZ();
    QString text;  ///< beside it, under the pointer and while it is dragged
};

/// Drag: turn; right or middle button: shift; wheel: nearer; double click or Home: all of it; arrow keys turn. Drawn in
/// a thread of its own by the renderer of the simulator.
class SolidView : public QWidget {
    Q_OBJECT
  public:
    explicit SolidView(const char* name, QWidget* parent = nullptr);
    ~SolidView() override;

    /// Nothing to be seen: no parts. The eye stays where it is unless the size is quite another.
    void setParts(std::shared_ptr<const std::vector<cases::Part>> parts, const core::Box& bounds);
    /// What is shown stands for something else by now: nothing is seen until the next is drawn.
    void forgetPicture();
    /// A line about what is shown, above the picture ("Preview"); dimmed when it is no longer true.
    void setCaption(const QString& caption, bool isStale);
    [[nodiscard]] const QString& caption() const noexcept { return caption_; }
    /// In the picture's place while there is nothing to be seen.
    void setPlaceholder(const QString& words);
    /// Occlusal, mesial and the sides as arrows; `buccalSign` 0: the sides without names.
    void setAxesShown(bool shown, int buccalSign);
    /// As the buttons below the picture do, one a tissue that there is [NAME_enamel, ...].
    void setTissueShown(cases::Tissue tissue, bool shown);
    void lookFrom(view::StandardView from, const view::Standing& standing = {});
    void setCamera(const view::Camera& camera);
    /// Over the parts; none: away with it.
    void setGlass(std::vector<view::GlassSurface> surfaces);
    /// While one is dragged it stays where the pointer has it.
    void setHandles(std::vector<SolidHandle> handles);
    void setHandleText(int handle, const QString& text);
    /// Where one is seen; nothing behind the eye.
    [[nodiscard]] std::optional<QPointF> handleAt(int handle) const;
    [[nodiscard]] bool isDragging() const noexcept { return grabbed_ >= 0; }
    /// The latest picture is of the latest wish.
    [[nodiscard]] bool isDrawn() const noexcept;
    [[nodiscard]] const QImage& picture() const noexcept { return picture_; }
    [[nodiscard]] const view::Camera& camera() const noexcept { return camera_; }

    [[nodiscard]] QSize sizeHint() const override { return {360, 320}; }
    [[nodiscard]] QSize minimumSizeHint() const override { return {160, 140}; }

  signals:
    /// So far along its way, from where it was taken.
    void handleDragged(int handle, double movedMm);
    /// Let go there; or given up: it stands where it was.
    void handleDropped(int handle, double movedMm);
    void handleGivenUp(int handle);

  protected:
    bool event(QEvent* event) override;
    void focusOutEvent(QFocusEvent* event) override;
    void leaveEvent(QEvent* event) override;
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
    void drawHandles(QPainter& painter) const;
    [[nodiscard]] int handleUnder(const QPointF& pointer) const;
    [[nodiscard]] double movedBy(const QPointF& pointer) const;
    void giveUpHandle();

    std::unique_ptr<Worker> worker_;
    std::shared_ptr<const std::vector<cases::Part>> parts_;
    core::Box bounds_;
    view::Camera camera_;
    view::Look look_;
    QImage picture_;
    std::uint64_t forgotten_ = 0;  ///< pictures of wishes up to this one are of something else
    QString caption_, missing_, placeholder_;
    bool isStale_ = false, axesShown_ = false, placed_ = false;
    int buccalSign_ = 0;
    Qt::MouseButton held_ = Qt::NoButton;
    QPointF last_;
    QHBoxLayout* tissues_;
    std::vector<cases::Tissue> there_;
    std::shared_ptr<const std::vector<view::GlassSurface>> glass_;
    std::vector<SolidHandle> handles_;
    int grabbed_ = -1, hovered_ = -1;
    QPointF grabbedAt_;
    double movedMm_ = 0.0;
};

}  // namespace handpiece::desktop
