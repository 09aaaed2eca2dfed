// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where the driver's thread comes in: the gate with its triple buffers. Private to this room.

#include <atomic>
#include <functional>

#include "handpiece/base/rt/triple_buffer.h"
#include "handpiece/devices/safety/gate.h"
#include "handpiece/devices/safety/guarded_device.h"

namespace handpiece::safety {

/// What one exchange came to; crosses threads by value.
struct Frame {
    link::DriverReading reading;
    GateStatus gate;
    std::array<double, 3> sentN{};
    std::int64_t nowNs = 0;
    std::uint64_t count = 0;  ///< exchanges so far; 0: none yet
    double servoHz = 0.0;     ///< over the last second
};
/// What the servo's side of a device knows of its health.
[[nodiscard]] inline Health healthOf(const Frame& frame) noexcept {
    Health health;
    health.gate = frame.gate;
    health.frames = frame.count;
    health.servoHz = frame.servoHz;
    health.positionMm = frame.reading.positionMm;
    health.orientation = frame.reading.orientation;
    health.buttons = frame.reading.buttons;
    health.sentN = frame.sentN;
    return health;
}
using FrameBuffer = rt::TripleBuffer<Frame>;

class GuardServo final : public link::Servo {
  public:
    GuardServo(const GateSettings& settings, std::function<std::int64_t()> nowNs, FrameBuffer& forTick,
               FrameBuffer& forBoard)
        : gate_(settings), nowNs_(std::move(nowNs)), forTick_(forTick), forBoard_(forBoard) {}

    [[nodiscard]] link::DriverCommand exchange(const link::DriverReading& reading) noexcept HANDPIECE_REALTIME override;

    /// The tick's side.
    rt::TripleBuffer<link::DriverCommand>& commands() noexcept { return commands_; }
    /// When the last exchange was; 0: none yet. Any thread.
    [[nodiscard]] std::int64_t lastNs() const noexcept { return lastNs_.load(std::memory_order_acquire); }

    // For faults on purpose; the driver's thread.

    /// From now on (or no longer) the tick's commands do not arrive.
    void holdTick(bool held) noexcept { held_ = held; }
    [[nodiscard]] const GateStatus& gateStatus() const noexcept { return gate_.status(); }

  private:
    Gate gate_;
    std::function<std::int64_t()> nowNs_;
    FrameBuffer &forTick_, &forBoard_;
    rt::TripleBuffer<link::DriverCommand> commands_;
    link::DriverCommand latest_;
    Frame frame_;
    std::atomic<std::int64_t> lastNs_{0};
    std::int64_t windowNs_ = 0;
    std::uint64_t windowCount_ = 0;
    bool held_ = false;
};

}  // namespace handpiece::safety
