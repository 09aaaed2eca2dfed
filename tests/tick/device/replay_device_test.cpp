// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/device/replay_device.h"

#include <gtest/gtest.h>

#include "handpiece/base/core/error.h"

namespace handpiece::replay_device_test {
namespace {

TEST(ReplayDevice, GivesTheReadingsInOrderAndIsLostPastTheEnd) {
    std::vector<device::Reading> readings(3);
    for (int i = 0; i < 3; ++i) {
        readings[static_cast<std::size_t>(i)].burInTooth.positionMm = core::Vec3(i, 2, 3);
        readings[static_cast<std::size_t>(i)].pedal = 0.25 * i;
        readings[static_cast<std::size_t>(i)].buttons = static_cast<std::uint32_t>(i);
    }
    device::ReplayDevice replay({}, readings);
    for (int i = 0; i < 3; ++i) {
        const device::Reading r = replay.read(0.001);
        EXPECT_EQ(r.burInTooth.positionMm, core::Vec3(i, 2, 3));
        EXPECT_EQ(r.pedal, 0.25 * i);
        EXPECT_EQ(r.buttons, static_cast<std::uint32_t>(i));
        EXPECT_EQ(r.status, device::ReadStatus::ok);
        EXPECT_EQ(replay.truePositionMm(), core::Vec3(i, 2, 3));
        replay.command(core::Vec3(0, 0, i), core::Vec3::Zero());
        EXPECT_EQ(replay.appliedForceN(), core::Vec3(0, 0, i));
    }
    EXPECT_EQ(replay.played(), 3u);
    EXPECT_EQ(replay.read(0.001).status, device::ReadStatus::lost);
    EXPECT_EQ(replay.played(), 3u);
}

TEST(ReplayDevice, NeedsReadingsAndADevice) {
    EXPECT_THROW(device::ReplayDevice({}, {}), core::Error);
    device::Capability impossible;
    impossible.maxForceN = -1;
    EXPECT_THROW(device::ReplayDevice(impossible, std::vector<device::Reading>(1)), core::Error);
}

}  // namespace
}  // namespace handpiece::replay_device_test
