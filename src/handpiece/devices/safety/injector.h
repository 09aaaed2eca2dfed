// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Faults on purpose: a Driver around a Driver that unplugs, lies, jumps, stalls and errs when it is told to.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/devices/link/driver.h"

namespace handpiece::safety {

enum class FaultKind : std::uint8_t { unplug, notANumber, jump, stall, error, badData, hot, dropInput, tickStall };
/// As it is typed: "unplug", "nan", "jump", "stall", "error", "garbage", "hot", "drop", "tick".
[[nodiscard]] std::string_view nameOf(FaultKind kind) noexcept;
inline constexpr std::size_t kFaultKinds = 9;

struct Fault {
    FaultKind kind = FaultKind::unplug;
    double atS = 0.0;     ///< after start()
    double lastsS = 0.1;  ///< then the device is well again
    double size = 1.0;    ///< of a jump [in 100 mm], of an error its code
};

/// "unplug@2.5, stall@3:0.2, jump@4, error@5:0.1=0x0301" or "random:1000:seed=7:every=0.15:from=2": kind @ seconds
/// : how long = size. Random ones last 5 to 500 ms (stalls) or 1 to 100 ms, `every` seconds apart on the mean, never
/// two at once; `kinds=unplug+nan` chooses among them. docs/devices/safety.md#faults. In the order of their times.
/// Throws core::Error that shows the place.
[[nodiscard]] std::vector<Fault> parseFaults(const std::string& specification);

/// What each fault came to, measured at the gate's output; for a report after the driver has stopped.
struct FaultOutcome {
    Fault fault;
    std::int64_t beganNs = 0;
    double forceBeforeN = 0.0, largestN = 0.0;  ///< largest: from its beginning to the next one's
    double toZeroS = -1.0;                      ///< from its beginning until the force was zero; below 0: never
    bool told = false;                          ///< the gate named a trouble
    link::DeviceFault trouble = link::DeviceFault::none;  ///< the first one it named
};

/// All that left the gate.
struct GateOutput {
    std::uint64_t samples = 0;
    double largestN = 0.0;
    double largestSlopeNPerS = 0.0;  ///< of the force while the gate was in no doubt: releases are steeper
};

/// Where the driver's thread writes what the faults came to. Made by the caller, shared with withFaults(); read once
/// the driver has stopped (count() any time).
class FaultLog {
  public:
    /// Those that have begun, in their order.
    [[nodiscard]] std::vector<FaultOutcome> outcomes() const;
    [[nodiscard]] const GateOutput& output() const noexcept { return output_; }
    /// How many have begun so far. Any thread.
    [[nodiscard]] std::size_t count() const noexcept { return begun_.load(std::memory_order_acquire); }

  private:
    friend class FaultyDriver;
    std::vector<FaultOutcome> outcomes_;
    std::atomic<std::size_t> begun_{0};
    GateOutput output_;
};

/// `driver` with these faults, by the time stamps of its readings. What passes between gate and driver is the
/// injector's to spoil; what the gate answers is recorded. While a stall lasts the gate is not called and the device
/// goes on pushing with what it was sent last, as the worst of devices would, until the watchdog relaxes it.
/// `tickStall` needs a GuardedDevice's servo; started with any other it does nothing.
[[nodiscard]] std::unique_ptr<link::Driver> withFaults(std::unique_ptr<link::Driver> driver, std::vector<Fault> faults,
                                                       std::shared_ptr<FaultLog> log = nullptr);

}  // namespace handpiece::safety
