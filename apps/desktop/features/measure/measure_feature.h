// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Measuring: its tools in the picture, the readouts beside it, the section, what was removed, and the plots.

#include <QTimer>

#include "desktop/framework/feature.h"
#include "handpiece/base/core/vec.h"

namespace handpiece::desktop {

class MeasureBox;
class PlotPanel;
class VolumeBars;

class MeasureFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { distance, depth, pulp, section, clear };
    explicit MeasureFeature(const FeatureContext& context);
    void showDocument() override;
    void showTick() override;
    void noteHand();

  private:
    void connectTools();
    void connectSection();
    void connectPlots();
    void showLegend();
    void showReadouts();
    void takeSection();
    void savePlot(const QString& format);
    [[nodiscard]] core::Box toothBounds() const;

    CommandSet<Command> commands_;
    MeasureBox* box_;
    VolumeBars* volumes_;
    PlotPanel* plots_;
    QTimer readouts_;
    bool isFittingHand_ = false;                          ///< to the panel: a new hand's own values are nobody's wish
    std::optional<double> probedDepthMm_, probedLeftMm_;  ///< by a click, until one cuts on
};

}  // namespace handpiece::desktop
