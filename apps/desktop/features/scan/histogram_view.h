// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How often grey values occur, and handles between the tissues.

#include <QWidget>
#include <optional>

#include "desktop/features/scan/shown_scan.h"
#include "handpiece/scan/segmentation/segment.h"

namespace handpiece::desktop {

/// [histogram]. Three handles: where the tooth begins, where enamel does, where a filling does (at the right end: there
/// is none). Dragged, or chosen with Tab-like Up and Down and moved with Left and Right.
class HistogramView : public QWidget {
    Q_OBJECT
  public:
    enum Handle { tooth, enamel, restoration, handleCount };
    explicit HistogramView(QWidget* parent = nullptr);

    void setHistogram(const GreyHistogram& histogram);
    /// None: not known yet. `byHand`: they are the person's.
    void setThresholds(const std::optional<segmentation::Thresholds>& thresholds, bool byHand);
    [[nodiscard]] const std::optional<segmentation::Thresholds>& thresholds() const noexcept { return thresholds_; }
    /// Where a handle stands, for tests and scripts; and the widget's x of a grey value.
    [[nodiscard]] double pixelOf(float grey) const;
    [[nodiscard]] float valueOf(Handle handle) const;

    [[nodiscard]] QSize sizeHint() const override { return {360, 130}; }
    [[nodiscard]] QSize minimumSizeHint() const override { return {200, 110}; }

  signals:
    /// While dragged; `dragEnded` once when it is let go.
    void thresholdsMoved(const handpiece::segmentation::Thresholds& thresholds);
    void dragEnded();

  protected:
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void focusInEvent(QFocusEvent* event) override;
    void focusOutEvent(QFocusEvent* event) override;

  private:
    [[nodiscard]] QRectF plot() const;
    [[nodiscard]] float greyAt(double x) const;
    void move(Handle handle, float grey);
    void tell();

    GreyHistogram histogram_;
    bool hasHistogram_ = false, byHand_ = false;
    std::optional<segmentation::Thresholds> thresholds_;
    int held_ = -1, chosen_ = 0;
};

}  // namespace handpiece::desktop
