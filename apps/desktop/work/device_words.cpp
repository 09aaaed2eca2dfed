// SPDX-License-Identifier: Apache-2.0
#include "desktop/work/device_words.h"

#include "desktop/work/simulator.h"

namespace handpiece::desktop {

bool holdsDevice(const Simulator& simulator) {
    return simulator.hands().current() && simulator.usedHand();
}

QString deviceInHand(const Simulator& simulator) {
    if (holdsDevice(simulator)) return simulator.hands().textOf(simulator.hands().wanted());
    const std::string& name = simulator.capability().name;
    if (name == "pointer") return Simulator::tr("Mouse");
    return name == "simulated" ? Simulator::tr("Simulated device") : QString::fromStdString(name);
}

}  // namespace handpiece::desktop
