// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Faults on purpose: a Driver around a Driver that unplugs, lies, jumps, stalls and errs when it is told to.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "handpiece/devices/link/driver.h"

namespace handpiece::safety {

enum class FaultKind : std::uint8_t { unplug, notANumber, jump, stall, error, badData, hot, dropInput, tickStall };

struct Fault {
    FaultKind kind = FaultKind::unplug;
    double atS = 0.0;     ///< after start()
    double lastsS = 0.1;  ///< then the device is well again
    double size = 1.0;    ///< of a jump [in 100 mm], of an error its code
};

/// "unplug@2.5, stall@3:0.2, jump@4, error@5:0.1=0x0301" or "random:1000:seed=7:every=0.15:from=2". Kinds: unplug, nan,
/// jump, stall, error, garbage, hot, drop, tick. docs/devices.md#faults. Throws core::Error that shows the place.
[[nodiscard]] std::vector<Fault> parseFaults(const std::string& specification);

/// `driver` with these faults. What passes between gate and device is the injector's to spoil; what the gate answers is
/// recorded: see FaultLog.
[[nodiscard]] std::unique_ptr<link::Driver> withFaults(std::unique_ptr<link::Driver> driver, std::vector<Fault> faults);

/// What each fault came to, measured at the gate's output; for a report after the driver has stopped.
struct FaultOutcome {
    Fault fault;
    std::int64_t beganNs = 0;
    double forceBeforeN = 0.0, largestN = 0.0;  ///< largest: from its beginning to the next one's
    double toZeroS = -1.0;                      ///< from its beginning until the force was zero; below 0: never
    bool told = false;                          ///< the gate named a trouble
};

}  // namespace handpiece::safety
