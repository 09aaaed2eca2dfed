// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What holds the handpiece: the menu of devices and pedals, what is told of them, their page and first three steps.

#include <QPointer>

#include "desktop/features/device/device_page.h"
#include "desktop/features/device/first_plug_in.h"
#include "desktop/framework/feature.h"
#include "handpiece/devices/link/driver.h"

class QMenu;

namespace handpiece::desktop {

class PedalMenu;

class DeviceFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { page, setUp, byName, search };
    explicit DeviceFeature(const FeatureContext& context);

  private:
    void connectMenu();
    void connectDevices();
    void list();
    void choose(const QString& name);
    void askForName();
    void tellTrouble(link::DeviceFault trouble, int vendorCode);
    void showDevice(StatusFigures& figures) const;
    void showRate(StatusFigures& figures);
    void openPage();
    void setUp();

    CommandSet<Command> commands_;
    QMenu* menu_;
    PedalMenu* pedals_;
    bool realTime_;
    QPointer<DevicePage> page_;
    QPointer<FirstPlugIn> steps_;
    bool isAsked_ = false;  ///< a person is waiting for it: what goes wrong is worth a dialog
    QString tried_;
    // Of the tick, over the last second.
    std::uint64_t ticks_ = 0, lateTicks_ = 0;
    qint64 sinceNs_ = 0;
    double rateHz_ = 0.0;
    bool isLate_ = false;
};

}  // namespace handpiece::desktop
