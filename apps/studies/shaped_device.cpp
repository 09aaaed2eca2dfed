// SPDX-License-Identifier: Apache-2.0
#include "studies/shaped_device.h"

#include <algorithm>
#include <utility>

namespace handpiece::studies {
namespace {

using core::Vec3;

const stability::ShaperSettings& checked(const stability::ShaperSettings& settings) {
    stability::validate(settings);
    return settings;
}

}  // namespace

stability::ShaperSettings shaperSettingsFor(const device::Capability& c) {
    stability::ShaperSettings settings;
    stability::limitTo(c, settings);
    return settings;
}

ShapedDevice::ShapedDevice(std::unique_ptr<device::Device> inner, const stability::ShaperSettings& settings)
    : PassingDevice(std::move(inner)), shaper_(checked(settings)) {}

device::Reading ShapedDevice::read(double periodS) noexcept {
    const device::Reading reading = PassingDevice::read(periodS);
    periodS_ = periodS;
    if (reading.status == device::ReadStatus::ok && reading.burInTooth.positionMm.allFinite()) {
        positionMm_ = reading.burInTooth.positionMm;
    } else {
        fresh_ = true;
    }
    return reading;
}

void ShapedDevice::command(const Vec3& forceN, const Vec3& torqueNmm) noexcept {
    // Outside a tick only the end of a run commands: no force.
    if (!(periodS_ > 0.0)) {
        sentN_.setZero();
        PassingDevice::command(sentN_, Vec3::Zero());
        return;
    }
    sentN_ = shaper_.shape(positionMm_, forceN, periodS_, fresh_);
    fresh_ = false;
    periodS_ = 0.0;
    const double wanted = forceN.norm();
    const double share = wanted > 0.0 ? std::min(1.0, sentN_.norm() / wanted) : 1.0;
    PassingDevice::command(sentN_, share * torqueNmm);
}

}  // namespace handpiece::studies
