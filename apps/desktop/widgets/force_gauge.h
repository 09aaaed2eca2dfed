// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How hard the bur presses: graded by fixed newtons of the drive, shown up to what the device can give.

#include <QWidget>

#include "desktop/widgets/detail.h"
#include "handpiece/model/instrument/press.h"

namespace handpiece::desktop {

/// A bar with a peak that stays for two seconds, coloured and in words [forceGauge].
class ForceGauge : public QWidget {
    Q_OBJECT
  public:
    enum class Zone { gentle, firm, hard };

    explicit ForceGauge(QWidget* parent = nullptr);

    void setLimit(double limitN);
    /// What is light and what is hard: the drive's, whatever the device can give.
    void setPressLimits(const instrument::PressLimits& limits);
    /// A force at a time of the session. `limited`: the device was asked for more than it can give.
    void setForce(double forceN, double timeS, bool limited = false);
    void setDetail(Detail detail);
    /// Off where a dock's title says it already.
    void setHeadingShown(bool shown);
    [[nodiscard]] double forceN() const { return forceN_; }
    [[nodiscard]] double peakN() const { return peakN_; }
    [[nodiscard]] Zone zone() const;
    /// As the load's, by the newton: "Light", "Firm"; at a device's limit that.
    [[nodiscard]] QString words() const;

    [[nodiscard]] QSize sizeHint() const override;
    [[nodiscard]] QSize minimumSizeHint() const override;

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    instrument::PressLimits press_ = instrument::pressLimitsOf("turbine");
    double limitN_ = 3.3, forceN_ = 0.0, peakN_ = 0.0, peakTimeS_ = 0.0;
    bool limited_ = false, headingShown_ = true;
    Detail detail_ = Detail::practice;
};

}  // namespace handpiece::desktop
