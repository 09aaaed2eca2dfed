// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the colours of the picture mean.

#include <QWidget>
#include <vector>

#include "handpiece/senses/view/look.h"

namespace handpiece::desktop {

/// Swatches with the tissues' names, or the scale of removed depth [legend].
class Legend : public QWidget {
    Q_OBJECT
  public:
    explicit Legend(QWidget* parent = nullptr);
    void setEntries(const std::vector<view::LegendEntry>& entries);
    /// A scale from 0 to `mostMm` in these colours (from least to most) instead of the tissues; 0: the tissues.
    void setDepthScale(double mostMm, const std::vector<std::array<std::uint8_t, 3>>& colours = {});

    [[nodiscard]] QSize sizeHint() const override;
    [[nodiscard]] QSize minimumSizeHint() const override;

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    std::vector<view::LegendEntry> entries_;
    double mostMm_ = 0.0;
    std::vector<std::array<std::uint8_t, 3>> scale_;
};

}  // namespace handpiece::desktop
