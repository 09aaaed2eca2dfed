// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A block and a bur from the side: what is felt, seen.

#include <QWidget>

#include "handpiece/base/messages/haptic_sample.h"

namespace handpiece::desktop {

/// [feelPicture]. Plain data in.
class BlockView : public QWidget {
    Q_OBJECT
  public:
    explicit BlockView(double halfMm, double depthMm, QWidget* parent = nullptr);
    void setSample(const messages::HapticSample& sample);
    [[nodiscard]] QSize sizeHint() const override { return {360, 200}; }
    [[nodiscard]] QSize minimumSizeHint() const override { return {240, 140}; }

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    double halfMm_, depthMm_;
    messages::HapticSample sample_;
};

}  // namespace handpiece::desktop
