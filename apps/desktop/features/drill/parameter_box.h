// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the tooth feels like: spring, damper and friction, and what the device allows of it.

#include <QWidget>
#include <vector>

#include "desktop/widgets/detail.h"
#include "desktop/widgets/number_field.h"
#include "handpiece/model/case/tissue.h"
#include "handpiece/tick/force/parameters.h"

class QComboBox;
class QGridLayout;
class QLabel;
class QPushButton;
class QSlider;
class QTableWidget;

namespace handpiece::desktop {

/// Multipliers, table of the tissues, contact method and voxel size [parameterBox].
class ParameterBox : public QWidget {
    Q_OBJECT
  public:
    /// On the tissues' own values; 1 is the tissue's own.
    struct Multipliers {
        double stiffness = 1.0, damping = 1.0, friction = 1.0;
        friend bool operator==(const Multipliers&, const Multipliers&) = default;
    };
    /// What may change now.
    enum class Cutting {
        none,    ///< the tooth is whole
        begun,   ///< something is missing of it
        stroke,  ///< the bur is at work
    };
    static constexpr double kLargest = 3.0;

    explicit ParameterBox(QWidget* parent = nullptr);

    // Setters tell nobody.
    void setTissues(const cases::TissueTable& tissues);
    /// The rows shown; empty: all but `none`.
    void setPresent(const std::vector<cases::Tissue>& tissues);
    void setLimits(const force::Limits& limits, const QString& device);
    void setMultipliers(const Multipliers& multipliers);
    [[nodiscard]] Multipliers multipliers() const { return multipliers_; }
    void setHullMethod(bool hull);
    void setForceMode(force::LawId mode);
    void setVoxelUm(int um);
    void setCutting(Cutting cutting);
    void setDetail(Detail detail);
    /// Off where a dock's title says it already.
    void setHeadingShown(bool shown);

    /// A tissue's spring through this device with these multipliers: what is wanted and what is given [N/mm].
    struct Spring {
        double wantedNPerMm, givenNPerMm;
        [[nodiscard]] bool clipped() const { return givenNPerMm < wantedNPerMm; }
    };
    [[nodiscard]] Spring springOf(cases::Tissue tissue) const;
    [[nodiscard]] Spring damperOf(cases::Tissue tissue) const;  ///< the same of the damper [N s/mm]

  signals:
    void multipliersChanged(double stiffness, double damping, double friction);
    void resetRequested();  ///< after the multipliers have gone back to 1 and told so
    void hullMethodChosen(bool hull);
    void forceModeChosen(handpiece::force::LawId mode);
    /// Once cut, the window cuts the tooth again at the new size by replay.
    void voxelChosen(int um);

  private:
    struct Row {
        QLabel* name;
        QSlider* slider;
        DecimalField* spin;
    };
    Row addRow(QGridLayout* grid, int row, const QString& object, double Multipliers::*value);
    void showMultipliers();
    void showTable();
    void showCutting();

    Row rows_[3]{};
    QTableWidget* table_;
    QLabel *limitsNote_, *clipNote_, *forceNote_, *methodNote_, *voxelNote_, *tableCaption_, *heading_;
    QComboBox *force_, *method_, *voxel_;
    QLabel *forceName_, *methodName_, *voxelName_;
    QPushButton* reset_;
    cases::TissueTable tissues_ = cases::builtInTissues();
    std::vector<cases::Tissue> present_;
    force::Limits limits_;
    QString device_;
    Multipliers multipliers_;
    Cutting cutting_ = Cutting::none;
    Detail detail_ = Detail::laboratory;
    bool hull_ = false;
    int voxelUm_ = 50;
};

}  // namespace handpiece::desktop
