// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/device/capability.h"

#include <fmt/format.h>

#include <string>

#include "handpiece/base/core/error.h"

namespace handpiece::device {

const std::vector<Capability>& knownDevices() {
    // Force, stiffness, damping: the device tables of CHAI3D 3.3. Continuous force, encoder step, workspace of the Omni
    // and all of the Touch X: recalled from data sheets, unchecked. Slope: ours, 5 N in a millisecond.
    static const std::vector<Capability> devices = [] {
        Capability simulated;
        simulated.name = "simulated";
        Capability omni = simulated;
        omni.name = "omni";
        omni.maxStiffnessNPerMm = 0.7;
        Capability touch = simulated;
        touch.name = "touch";
        touch.maxStiffnessNPerMm = 0.4;
        touch.maxDampingNSPerMm = 0.004;
        Capability touchX = simulated;
        touchX.name = "touch-x";
        touchX.maxForceN = 7.9;
        touchX.continuousForceN = 1.75;
        touchX.maxStiffnessNPerMm = 1.0;
        touchX.encoderStepMm = 0.023;
        return std::vector<Capability>{simulated, omni, touch, touchX};
    }();
    return devices;
}

const Capability& capabilityByName(std::string_view name) {
    std::string names;
    for (const Capability& c : knownDevices()) {
        if (c.name == name) return c;
        names += (names.empty() ? "" : ", ") + c.name;
    }
    throw core::Error(fmt::format("no device is called \"{}\"", name), "device", "there are " + names);
}

void validate(const Capability& c) {
    const auto require = [&](bool good, const char* what, double value) {
        if (!good || !std::isfinite(value)) {
            throw core::Error(fmt::format("{} of {}", what, value), fmt::format("device \"{}\"", c.name),
                              "correct the capability record");
        }
    };
    require(c.maxForceN > 0, "a largest force", c.maxForceN);
    require(c.continuousForceN > 0, "a continuous force", c.continuousForceN);
    require(c.maxStiffnessNPerMm > 0, "a largest stiffness", c.maxStiffnessNPerMm);
    require(c.maxDampingNSPerMm >= 0, "a largest damping", c.maxDampingNSPerMm);
    require(c.maxForceSlopeNPerS > 0, "a largest slope of force", c.maxForceSlopeNPerS);
    require(c.maxTorqueNmm >= 0, "a largest torque", c.maxTorqueNmm);
    require(c.encoderStepMm >= 0, "an encoder step", c.encoderStepMm);
}

}  // namespace handpiece::device
