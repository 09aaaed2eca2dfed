// SPDX-License-Identifier: Apache-2.0
// A report for machines.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "handpiece/devices/fidelity/fidelity.h"

namespace handpiece::fidelity {
namespace {

constexpr std::array<std::string_view, 4> kIds{"pass", "warn", "fail", "not-measured"};

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        const auto u = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            out += std::string("\\") + c;
        else if (u < 0x20)
            out += fmt::format("\\u{:04x}", u);
        else
            out += c;
    }
    return out + '"';
}

/// JSON has no word for what is no number.
std::string number(double value) {
    return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

}  // namespace

std::string_view idOf(Verdict verdict) noexcept {
    const auto at = static_cast<std::size_t>(verdict);
    return kIds[at < kIds.size() ? at : 3];
}

std::string nameOf(const Finding& finding, const config::Words& words) {
    return words("fidelity.name." + finding.id);
}

std::string asJson(const Report& r) {
    const config::Words& english = config::Words::in("en");
    std::string s = "{\n";
    s += fmt::format("  \"format\": 1,\n  \"passed\": {},\n  \"duration_s\": {},\n  \"machine\": {},\n",
                     r.passed ? "true" : "false", number(r.durationS), quoted(r.machine));
    s += fmt::format(
        "  \"device\": {{\"driver\": {}, \"model\": {}, \"serial\": {}, \"version\": {}, \"pushes\": {}, "
        "\"servo_hz\": {}, \"sources\": {}}},\n  \"findings\": [\n",
        quoted(r.device.driver), quoted(r.device.model), quoted(r.device.serial), quoted(r.device.version),
        r.device.pushes ? "true" : "false", number(r.device.servoHz), quoted(r.device.sources));
    for (std::size_t i = 0; i < r.findings.size(); ++i) {
        const Finding& f = r.findings[i];
        std::string figures;
        for (const auto& [name, value] : f.figures)
            figures += fmt::format("{}{}: {}", figures.empty() ? "" : ", ", quoted(name), number(value));
        s += fmt::format(
            "    {{\"id\": {}, \"name\": {}, \"verdict\": \"{}\", \"value\": {}, \"against\": {}, \"remedy\": {}, "
            "\"figures\": {{{}}}}}{}\n",
            quoted(f.id), quoted(nameOf(f, english)), idOf(f.verdict), quoted(english(f.value)),
            quoted(english(f.against)), quoted(english(f.remedy)), figures, i + 1 < r.findings.size() ? "," : "");
    }
    const auto counts = [](const std::vector<double>& bins) {
        // Pairs of bin and count: nearly all of the bins are empty.
        std::string text;
        for (std::size_t i = 0; i < bins.size(); ++i)
            if (bins[i] > 0.0) text += fmt::format("{}[{}, {:.0f}]", text.empty() ? "" : ", ", i, bins[i]);
        return text;
    };
    s += fmt::format("  ],\n  \"period_histogram_us\": [{}],\n  \"lateness_histogram_us\": [{}]\n}}\n",
                     counts(r.periodHistogramUs), counts(r.latenessHistogramUs));
    return s;
}

}  // namespace handpiece::fidelity
