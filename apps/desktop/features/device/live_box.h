// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How a device is doing now: where its stylus is, its buttons, what it pushes, how warm and how punctual it is.

#include <QGridLayout>
#include <QWidget>

#include "handpiece/app/simulation/live_session.h"
#include "handpiece/devices/safety/guarded_device.h"

class QLabel;

namespace handpiece::desktop {

class ForceGauge;

/// The stylus in its reach: from the front and from above. A dot and a line along the stylus.
class ReachPicture : public QWidget {
    Q_OBJECT
  public:
    explicit ReachPicture(QWidget* parent = nullptr);
    void setReach(const core::Vec3& sizeMm);
    void setStylus(const std::array<double, 3>& positionMm, const std::array<double, 4>& orientation);
    [[nodiscard]] QSize sizeHint() const override { return {320, 170}; }
    [[nodiscard]] QSize minimumSizeHint() const override { return {220, 120}; }

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    core::Vec3 sizeMm_{160, 120, 70}, atMm_ = core::Vec3::Zero(), tailMm_ = core::Vec3::Zero();
};

/// [deviceLive]. Plain data in.
class LiveBox : public QWidget {
    Q_OBJECT
  public:
    explicit LiveBox(QWidget* parent = nullptr);
    void setDevice(const link::DriverInfo& info);
    /// `trouble`: in the person's words; empty while it is well.
    void setHealth(const safety::Health& health, const QString& trouble);
    /// How punctual the tick is that computes the force.
    void setTick(const simulation::LiveSessionStatus& status);
    void clear();

  private:
    QLabel* row(QGridLayout* grid, const char* object, const QString& name, const QString& tip);

    link::DriverInfo info_;
    double timeS_ = 0.0;
    ReachPicture* reach_;
    ForceGauge* gauge_;
    QLabel *model_, *pose_, *buttons_, *force_, *temperature_, *servo_, *late_, *scheduling_, *energy_, *trouble_;
};

}  // namespace handpiece::desktop
