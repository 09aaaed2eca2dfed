// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/wanted.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "handpiece/base/config/words.h"

namespace handpiece::report {
namespace {

using config::words;

/// As it is written where the file has it plain.
std::string_view written(std::string_view unit) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kWritten{
        {{"mm2", "mm²"}, {"mm3", "mm³"}, {"um", "µm"}, {"deg", "°"}, {"N s", "N·s"}}};
    for (const auto& [plain, sign] : kWritten)
        if (plain == unit) return sign;
    return unit;
}

std::string withUnit(const std::string& number, const std::string& unit) {
    const std::string_view sign = written(unit);
    return sign.empty() ? number : sign == "°" ? number + "°" : fmt::format("{} {}", number, sign);
}

}  // namespace

Wanted wantedOf(const rubric::Criterion& c, const rubric::Rubric& rubric) {
    if (!c.knots.empty()) {
        double most = 0.0;
        for (const rubric::Knot& k : c.knots)
            most = std::max(most, k.points);
        const auto isBest = [&](const rubric::Knot& k) { return k.points == most; };
        const auto first = std::find_if(c.knots.begin(), c.knots.end(), isBest);
        const auto last = std::find_if(c.knots.rbegin(), c.knots.rend(), isBest);
        // Held at its ends: the first knot's points are those of all that is less.
        return {first == c.knots.begin() ? std::nullopt : std::optional(first->value),
                last == c.knots.rbegin() ? std::nullopt : std::optional(last->value)};
    }
    for (const rubric::BandName& name : rubric.bands)
        for (const rubric::Band& band : c.bands)
            if (band.id == name.id) return {band.from, band.to};
    if (c.critical) return {c.critical->below, c.critical->above};
    return {};
}

std::string wantedText(const Wanted& wanted, const std::string& unit) {
    const auto number = [](double value) { return fmt::format("{:g}", value); };
    if (wanted.from && wanted.to)
        return *wanted.from == *wanted.to
                   ? withUnit(number(*wanted.from), unit)
                   : words()("assessment.from-to", number(*wanted.from), withUnit(number(*wanted.to), unit));
    if (wanted.from) return words()("assessment.at-least", withUnit(number(*wanted.from), unit));
    if (wanted.to) return words()("assessment.at-most", withUnit(number(*wanted.to), unit));
    return {};
}

Off offOf(const Wanted& wanted, double value) {
    if (wanted.from && value < *wanted.from) return Off::tooLow;
    if (wanted.to && value > *wanted.to) return Off::tooHigh;
    return Off::no;
}

double offBy(const Wanted& wanted, double value) {
    switch (offOf(wanted, value)) {
        case Off::tooLow:
            return *wanted.from - value;
        case Off::tooHigh:
            return value - *wanted.to;
        case Off::no:
            break;
    }
    return 0.0;
}

std::string amountText(double value, const std::string& unit) {
    const double size = std::abs(value);
    // A tenth of a millimetre is what a hand can do something about.
    const int decimals = unit == "deg" || unit == "um" || unit == "rpm" || unit == "%" ? (size < 0.95 ? 1 : 0)
                         : unit.empty()  ? (size == std::floor(size) ? 0 : 1)
                         : size >= 9.95  ? 0
                         : size >= 0.095 ? 1
                                         : 2;
    return withUnit(fmt::format("{:.{}f}", value, decimals), unit);
}

}  // namespace handpiece::report
