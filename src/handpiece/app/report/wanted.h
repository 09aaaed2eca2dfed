// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a criterion asks for, and to which side of it a value lies.

#include <optional>
#include <string>

#include "handpiece/assess/rubric/rubric.h"

namespace handpiece::report {

/// A closed interval; none: open there. Both none: nothing is asked.
struct Wanted {
    std::optional<double> from, to;
    [[nodiscard]] bool isAnything() const noexcept { return from || to; }
};
/// The values that have most points, else the best band, else what is no critical error.
[[nodiscard]] Wanted wantedOf(const rubric::Criterion& criterion, const rubric::Rubric& rubric);
/// "1.5 to 2 mm", "2 mm or more", in the program's language; empty where nothing is asked.
[[nodiscard]] std::string wantedText(const Wanted& wanted, const std::string& unit);

enum class Off { no, tooLow, tooHigh };
[[nodiscard]] Off offOf(const Wanted& wanted, double value);
/// By how much it lies outside, never negative.
[[nodiscard]] double offBy(const Wanted& wanted, double value);

/// A number of so many decimals as one reads it, with its unit as it is written: "0.3 mm", "9 %", "1.2 mm³", "4°".
[[nodiscard]] std::string amountText(double value, const std::string& unit);

}  // namespace handpiece::report
