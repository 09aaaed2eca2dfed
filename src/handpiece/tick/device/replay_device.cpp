// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/device/replay_device.h"

#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/tick/device/capability.h"

namespace handpiece::device {

ReplayDevice::ReplayDevice(Capability capability, std::vector<Reading> readings) : capability_(std::move(capability)) {
    validate(capability_);
    continueWith(std::move(readings));
}

void ReplayDevice::continueWith(std::vector<Reading> readings) {
    if (readings.empty()) throw core::Error("there is nothing to replay", "replay", "record at least one tick");
    readings_ = std::move(readings);
    next_ = 0;
}

Reading ReplayDevice::read(double) noexcept {
    if (next_ < readings_.size()) return readings_[next_++];
    Reading past = readings_.back();
    past.status = ReadStatus::lost;
    return past;
}

void ReplayDevice::command(const core::Vec3& forceN, const core::Vec3&) noexcept {
    forceN_ = forceN;
}

core::Vec3 ReplayDevice::truePositionMm() const noexcept {
    return readings_[next_ > 0 ? next_ - 1 : 0].burInTooth.positionMm;
}

}  // namespace handpiece::device
