// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How good this station feels: servo, jitter, lateness, delay, noise and limits of a device, measured, each with a
/// verdict and what to do.

#include <string>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/devices/link/driver.h"

namespace handpiece::fidelity {

enum class Verdict : std::uint8_t { pass, warn, fail, notMeasured };

struct Finding {
    std::string id;     ///< "servo-period"
    std::string name;   ///< "Servo period"
    std::string value;  ///< "1.000 ms, p99.9 1.043 ms"
    Verdict verdict = Verdict::notMeasured;
    std::string against;                                  ///< what it is judged by, with its source
    std::string remedy;                                   ///< what to do when it does not pass
    std::vector<std::pair<std::string, double>> figures;  ///< for machines, with units in their names
};

struct Report {
    link::DriverInfo device;
    std::string machine;  ///< kernel, cores, scheduling granted: one line, nothing personal
    std::vector<Finding> findings;
    std::vector<double> periodHistogramUs, latenessHistogramUs;  ///< counts by microsecond bin, for the plot
    double durationS = 0.0;
    bool passed = false;  ///< nothing failed
};

struct CheckSettings {
    double durationS = 10.0;
    double rateHz = 1000.0;  ///< of the tick
    bool push = true;        ///< may push a small known force to measure slope and delay (announced first)
};

/// Runs `driver` behind its gate for a while and measures. Throws core::Error as the driver does.
[[nodiscard]] Report check(std::unique_ptr<link::Driver> driver, const CheckSettings& settings,
                           const core::Progress& progress = {});
[[nodiscard]] std::string asJson(const Report& report);
/// One page, printable, no outside references.
[[nodiscard]] std::string asHtml(const Report& report);

}  // namespace handpiece::fidelity
