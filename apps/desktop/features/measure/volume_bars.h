// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How much of each tissue is gone.

#include <QWidget>
#include <array>
#include <vector>

#include "desktop/widgets/detail.h"
#include "handpiece/senses/view/look.h"

namespace handpiece::desktop {

/// Bars with values, one a tissue [volumeBars].
class VolumeBars : public QWidget {
    Q_OBJECT
  public:
    explicit VolumeBars(QWidget* parent = nullptr);

    /// By cases::Tissue [mm3].
    void setVolumes(const std::array<double, cases::kTissueCount>& removedMm3);
    /// The tissues shown and their colours; a tissue without an entry appears once something of it is gone.
    void setLegend(const std::vector<view::LegendEntry>& entries);
    void setDetail(Detail detail);
    /// Off where a dock's title says it already: then the first line says that it is the total.
    void setHeadingShown(bool shown);
    /// An exercise may hide the figures; it is said so in their place.
    void setLocked(bool locked);

    [[nodiscard]] QSize sizeHint() const override;
    [[nodiscard]] QSize minimumSizeHint() const override;

  protected:
    void paintEvent(QPaintEvent* event) override;
    bool event(QEvent* event) override;

  private:
    [[nodiscard]] std::vector<view::LegendEntry> rows() const;

    std::array<double, cases::kTissueCount> removedMm3_{};
    std::vector<view::LegendEntry> entries_;
    Detail detail_ = Detail::practice;
    bool headingShown_ = true, locked_ = false;
};

}  // namespace handpiece::desktop
