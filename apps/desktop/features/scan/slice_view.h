// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// One slice of a scan, along one of its own axes: looked at, windowed, pointed at.

#include <QImage>
#include <QLineF>
#include <QWidget>
#include <memory>
#include <vector>

#include "handpiece/scan/segmentation/segment.h"
#include "handpiece/scan/volume/volume.h"

namespace handpiece::desktop {

/// What the left button does in a slice.
enum class SliceTool { look, pick, brush, cut, lesion };

/// Of the three views [sliceAxial, sliceCoronal, sliceSagittal]. Left button: the tool; right: brightness and contrast;
/// middle: shift; wheel: through the slices; Ctrl and wheel: nearer. Arrow keys move the cross, Page up and down go
/// through the slices, Return uses the tool at the cross.
class SliceView : public QWidget {
    Q_OBJECT
  public:
    enum class Direction { axial, coronal, sagittal };
    explicit SliceView(Direction direction, QWidget* parent = nullptr);

    /// Null: nothing to be seen.
    void setScan(std::shared_ptr<const volume::Volume> scan);
    /// The tissues that are drawn over it; null: none.
    void setRegion(std::shared_ptr<const segmentation::Region> region);
    /// What a person decided, drawn where it lies in this slice.
    void setDecisions(const segmentation::Settings& decisions);
    void setCross(const core::Vec3& mm);
    /// Grey values that are black and white.
    void setWindow(float black, float white);
    void setTool(SliceTool tool, double radiusMm, cases::Tissue tissue);
    void setFillShown(bool shown);
    void fit();

    [[nodiscard]] Direction direction() const noexcept { return direction_; }
    [[nodiscard]] int slice() const;
    /// Widget pixels of a point in the scanner's frame, and back in this slice; for tests and scripts too.
    [[nodiscard]] QPointF pixelOf(const core::Vec3& mm) const;
    [[nodiscard]] core::Vec3 pointAt(const QPointF& pixel) const;
    [[nodiscard]] QSize sizeHint() const override { return {320, 280}; }
    [[nodiscard]] QSize minimumSizeHint() const override { return {160, 140}; }

  signals:
    void crossMoved(const handpiece::core::Vec3& mm);
    void windowDragged(float black, float white);
    void picked(const handpiece::core::Vec3& mm);
    void painted(const std::vector<handpiece::core::Vec3>& mm);  ///< the next balls of a stroke
    void strokeEnded();
    void cutDrawn(const handpiece::core::Vec3& fromMm, const handpiece::core::Vec3& toMm,
                  const handpiece::core::Vec3& sliceNormal);
    void lesionPlaced(const handpiece::core::Vec3& mm);

  protected:
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void leaveEvent(QEvent* event) override;
    void focusInEvent(QFocusEvent* event) override;
    void focusOutEvent(QFocusEvent* event) override;

  private:
    struct Contour {
        cases::Tissue tissue;
        bool isAuthored;
        std::vector<QLineF> lines;  ///< [mm] along the slice's axes from the scan's first voxel
    };
    [[nodiscard]] double pixelsPerMm() const;
    [[nodiscard]] QPointF pixelOfMm(const QPointF& mm) const;
    [[nodiscard]] QPointF inSlice(const core::Vec3& mm) const;
    void step(int slices);
    void use(const QPointF& at);
    void makeGrey();
    void makeOverlay();
    void drawDecisions(QPainter& painter) const;
    void tell();

    Direction direction_;
    int u_, v_, w_;
    std::shared_ptr<const volume::Volume> scan_;
    std::shared_ptr<const segmentation::Region> region_;
    segmentation::Settings decisions_;
    core::Vec3 crossMm_ = core::Vec3::Zero();
    float black_ = 0, white_ = 1;
    SliceTool tool_ = SliceTool::look;
    double radiusMm_ = 0.5;
    cases::Tissue tissue_ = cases::Tissue::none;
    bool fillShown_ = true;
    double zoom_ = 1.0;  ///< 1: all of the slice
    QPointF shiftMm_;    ///< of the middle
    QImage grey_, fill_;
    std::vector<Contour> contours_;
    bool greyStale_ = true, overlayStale_ = true;
    Qt::MouseButton held_ = Qt::NoButton;
    QPointF from_, last_, hover_;
    bool hovering_ = false;
};

}  // namespace handpiece::desktop
