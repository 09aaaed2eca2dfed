// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How good this station feels: servo, jitter, lateness, delay, noise and limits of a device, measured, each with a
/// verdict and what to do.

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "handpiece/base/config/words.h"
#include "handpiece/base/core/progress.h"
#include "handpiece/devices/link/driver.h"

namespace handpiece::fidelity {

enum class Verdict : std::uint8_t { pass, warn, fail, notMeasured };
/// "pass", "warn", "fail", "not-measured".
[[nodiscard]] std::string_view idOf(Verdict verdict) noexcept;

struct Finding {
    std::string id;        ///< "servo-period"; nameOf() says it
    config::Phrase value;  ///< "1.000 ms, p99.9 1.043 ms"
    Verdict verdict = Verdict::notMeasured;
    config::Phrase against;                               ///< what it is judged by, with its source
    config::Phrase remedy;                                ///< what to do when it does not pass
    std::vector<std::pair<std::string, double>> figures;  ///< for machines, with units in their names
};

/// "Servo period".
[[nodiscard]] std::string nameOf(const Finding& finding, const config::Words& words);

struct Report {
    link::DriverInfo device;
    std::string machine;  ///< kernel, cores, scheduling granted: one line, nothing personal
    std::vector<Finding> findings;
    std::vector<double> periodHistogramUs, latenessHistogramUs;  ///< counts by microsecond bin, for the plot
    std::vector<link::DeviceFault> troubles;                     ///< told of while it was measured, each once
    std::int32_t vendorCode = 0;                                 ///< with the last of them; 0: none
    double durationS = 0.0;
    bool passed = false;  ///< nothing failed
};

struct CheckSettings {
    double durationS = 10.0;  ///< at least 1; with pushing at least 2
    double rateHz = 1000.0;   ///< of the tick
    bool push = true;         ///< may push a small known force to measure slope and delay (announced first)
    /// Told in one sentence what comes next and what to do; on the calling thread.
    std::function<void(const std::string& sentence)> announce;
    // Virtual time, as safety::GuardSettings has it: nothing waits, and nothing is late.
    std::function<std::int64_t()> nowNs;
    std::function<void(double periodS)> advance;
};

/// Runs `driver` behind its gate for a while and measures. Throws core::Error as the driver does.
[[nodiscard]] Report check(std::unique_ptr<link::Driver> driver, const CheckSettings& settings,
                           const core::Progress& progress = {});
/// For machines, in English; keys as the findings' ids and figures. docs/cli.md
[[nodiscard]] std::string asJson(const Report& report);

}  // namespace handpiece::fidelity
