// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What is measured: depth, distance, dentine over the pulp; the load, the depth stop, the section.

#include <QWidget>
#include <optional>

#include "desktop/widgets/detail.h"
#include "desktop/widgets/number_field.h"
#include "handpiece/app/exercise/permissions.h"
#include "handpiece/app/input/pointer_controller.h"
#include "handpiece/model/instrument/press.h"
#include "handpiece/senses/measure/pulp_light.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QPushButton;
class QSlider;
class QToolButton;

namespace handpiece::desktop {

class TrafficLight;

/// [measureBox]. Lengths in millimetres, loads in newtons.
class PassRow;

class MeasureBox : public QWidget {
    Q_OBJECT
  public:
    enum class Orientation { buccolingual, mesiodistal, horizontal };
    Q_ENUM(Orientation)
    static constexpr double kMinLoadN = 0.1, kMaxLoadN = 3.0, kLeastStopMm = 0.1, kMaxStopMm = 9.9,
                            kFirstStopMm = input::kFirstStopMm;

    explicit MeasureBox(QWidget* parent = nullptr);

    // Readouts; nothing shows a dash.
    void setDepth(const std::optional<double>& depthMm);
    void setCalliper(const std::optional<double>& distanceMm);
    /// Dentine left over the pulp. `exposed`: the pulp is open.
    void setLeftOverPulp(const std::optional<double>& leftMm, bool exposed = false);
    /// Of its lamps.
    void setPulpLimits(const measure::PulpLimits& limits) { pulpLimits_ = limits; }

    // Controls; setters tell nobody.
    void setLoad(double loadN);
    [[nodiscard]] double loadN() const noexcept { return loadN_; }
    [[nodiscard]] std::optional<double> depthStopMm() const;
    /// What is light and what is hard, by the drive.
    void setPressLimits(const instrument::PressLimits& limits);
    /// 0: off.
    void setDepthStop(double stopMm);
    /// Off too it has a depth, which is there when it is switched on.
    void keepDepthStop(bool isOn, double stopMm);
    void setSection(bool on, MeasureBox::Orientation orientation, double offsetMm);
    /// How far the section may move [mm].
    void setSectionRange(double leastMm, double mostMm);
    void setCalliperActive(bool active);
    void setPermissions(const exercise::Permissions& permissions);
    [[nodiscard]] PassRow* passRow() const noexcept { return passRow_; }
    void setDetail(Detail detail);

  signals:
    void loadChanged(double loadN);
    void depthStopChanged(double stopMm);
    void calliperToggled(bool on);
    void sectionChanged(bool on, MeasureBox::Orientation orientation, double offsetMm);

  private:
    measure::PulpLimits pulpLimits_;
    instrument::PressLimits press_ = instrument::pressLimitsOf("turbine");
    void showLoad();
    void tellSection();

    QLabel *depth_, *calliper_, *left_, *leftWords_, *depthCaption_, *calliperCaption_, *leftCaption_;
    TrafficLight* light_;
    QToolButton* calliperButton_;
    QLabel *loadCaption_, *loadValue_;
    QSlider* load_;
    PassRow* passRow_;
    QCheckBox* stopOn_;
    DecimalField* stop_;
    QCheckBox* sectionOn_;
    QComboBox* orientation_;
    QSlider* offset_;
    DecimalField* offsetValue_;
    QLabel* locked_;
    Detail detail_ = Detail::practice;
    double loadN_ = 1.0, offsetMm_ = 0.0;
    bool stopWaits_ = false;
};

}  // namespace handpiece::desktop
