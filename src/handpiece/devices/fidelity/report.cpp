// SPDX-License-Identifier: Apache-2.0
// A report for machines (JSON) and for people (one HTML page).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "handpiece/devices/fidelity/fidelity.h"

namespace handpiece::fidelity {
namespace {

constexpr std::array<std::string_view, 4> kIds{"pass", "warn", "fail", "not-measured"};
constexpr std::array<std::string_view, 4> kWords{"good", "mind this", "not good", "not measured"};

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

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

/// What of a histogram is worth drawing: from its first to its last count, at most so far.
struct Drawn {
    std::size_t first = 0, last = 0, perBar = 1;
    double most = 0.0, total = 0.0, beyond = 0.0;
    std::vector<double> bars;
};

Drawn drawnOf(const std::vector<double>& counts, bool fromZero) {
    Drawn d;
    for (const double c : counts)
        d.total += c;
    const auto counted = [](double c) { return c > 0.0; };
    const auto begin = std::find_if(counts.begin(), counts.end(), counted);
    d.first = fromZero ? 0 : static_cast<std::size_t>(begin - counts.begin());
    // The last thousandth is told in words: one late frame would make a line of all the others.
    double sum = 0.0;
    d.last = d.first;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        sum += counts[i];
        if (sum <= 0.999 * d.total) d.last = std::max(d.last, i + 1);
    }
    d.last = std::min(std::max(d.last, d.first + 10), std::max(counts.size(), d.first + 10));
    constexpr std::size_t kBars = 120;
    d.perBar = std::max<std::size_t>(1, (d.last - d.first + kBars) / kBars);
    for (std::size_t i = d.first; i <= d.last; i += d.perBar) {
        double bar = 0.0;
        for (std::size_t j = i; j < std::min(i + d.perBar, counts.size()); ++j)
            bar += counts[j];
        d.bars.push_back(bar);
        d.most = std::max(d.most, bar);
    }
    const std::size_t end = d.first + d.bars.size() * d.perBar;
    for (std::size_t i = end; i < counts.size(); ++i)
        d.beyond += counts[i];
    return d;
}

/// Bars on a logarithmic scale: rare late ones are what matters.
std::string histogramSvg(const std::vector<double>& counts, const std::string& title, bool fromZero) {
    constexpr double kWidth = 640, kHeight = 150, kLeft = 46, kBottom = 34, kTop = 8, kRight = 24;
    const Drawn d = drawnOf(counts, fromZero);
    if (d.total <= 0.0) return {};
    const double w = kWidth - kLeft - kRight, h = kHeight - kBottom - kTop;
    const double decades = std::max(1.0, std::ceil(std::log10(std::max(d.most, 1.0)) + 1e-9));
    std::string s = fmt::format(
        "<figure><svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\" xmlns=\"http://www.w3.org/2000/svg\">",
        kWidth, kHeight, escaped(title));
    for (int k = 0; k <= static_cast<int>(decades); ++k) {
        const double y = kTop + h * (1.0 - k / decades);
        s += fmt::format("<line class=\"grid\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", kLeft,
                         kLeft + w, y, y);
        s += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{:.0f}</text>", kLeft - 5, y + 4,
                         std::pow(10.0, k));
    }
    const double each = w / static_cast<double>(d.bars.size());
    for (std::size_t i = 0; i < d.bars.size(); ++i) {
        if (d.bars[i] <= 0.0) continue;
        // One count is seen too.
        const double tall = h * std::max(0.02, std::log10(d.bars[i]) / decades);
        s += fmt::format("<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>",
                         kLeft + each * static_cast<double>(i), kTop + h - tall, std::max(each - 0.4, 0.6), tall);
    }
    const double firstUs = static_cast<double>(d.first);
    const double spanUs = static_cast<double>(d.bars.size() * d.perBar);
    for (int k = 0; k <= 4; ++k)
        s += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:.0f}</text>", kLeft + w * k / 4.0,
                         kTop + h + 15, firstUs + spanUs * k / 4.0);
    s += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">microseconds</text></svg>", kLeft + w / 2,
                     kHeight - 4);
    const std::string beyond = d.beyond > 0.0 ? fmt::format(", {:.0f} beyond the right edge", d.beyond) : std::string();
    return s + fmt::format("<figcaption>{}: {:.0f} in all{}; how many, in tens.</figcaption></figure>", escaped(title),
                           d.total, beyond);
}

constexpr std::string_view kStyle =
    "body{font:15px/1.45 system-ui,sans-serif;color:#1c2733;max-width:60em;margin:2em auto;padding:0 1.2em}"
    "h1{font-size:1.5em;margin:0 0 .2em}p{margin:.3em 0}.sub{color:#52606d}"
    "table{border-collapse:collapse;width:100%;margin:1em 0}td,th{text-align:left;vertical-align:top;padding:.45em "
    ".6em;"
    "border-top:1px solid #d7dde3}th{font-weight:600;white-space:nowrap}.why{color:#52606d;font-size:.87em}"
    ".v{white-space:nowrap;font-weight:600}.pass{color:#13692f}.warn{color:#8a5200}.fail{color:#a61b1b}"
    ".not-measured{color:#52606d}.do{font-size:.93em}.sum{font-size:1.1em;font-weight:600}"
    "figure{margin:1em 0;break-inside:avoid}svg{width:100%;height:auto}svg rect{fill:#2f6f9f}svg text{font-size:11px;"
    "fill:#3d4a57}svg .grid{stroke:#e3e8ec}figcaption{color:#52606d;font-size:.87em}tr{break-inside:avoid}"
    "@page{margin:14mm}@media print{body{font-size:10.5pt;margin:0;max-width:none;padding:0}}";

}  // namespace

std::string_view idOf(Verdict verdict) noexcept {
    const auto at = static_cast<std::size_t>(verdict);
    return kIds[at < kIds.size() ? at : 3];
}

std::string asJson(const Report& r) {
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
            quoted(f.id), quoted(f.name), idOf(f.verdict), quoted(f.value), quoted(f.against), quoted(f.remedy),
            figures, i + 1 < r.findings.size() ? "," : "");
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

std::string asHtml(const Report& r) {
    const auto count = [&](Verdict v) {
        return std::count_if(r.findings.begin(), r.findings.end(), [v](const Finding& f) { return f.verdict == v; });
    };
    std::string s = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
        "<meta name=\"viewport\" content=\"width=device-width\"><title>Fidelity of {0}</title><style>{1}</style></head>"
        "<body>\n<h1>How good this station feels: {0}</h1>\n",
        escaped(r.device.model), kStyle);
    s += fmt::format("<p class=\"sub\">Driver {}{}{}; measured for {:.1f} s.</p>\n<p class=\"sub\">{}</p>\n",
                     escaped(r.device.driver),
                     r.device.version.empty() ? std::string() : ", version " + escaped(r.device.version),
                     r.device.serial.empty() ? std::string() : ", serial " + escaped(r.device.serial), r.durationS,
                     escaped(r.machine));
    s += fmt::format("<p class=\"sum {}\">{}: {} good, {} to mind, {} not good, {} not measured.</p>\n",
                     r.passed ? "pass" : "fail", r.passed ? "Fit to practise with" : "Not fit to practise with",
                     count(Verdict::pass), count(Verdict::warn), count(Verdict::fail), count(Verdict::notMeasured));
    s += "<table>\n";
    for (const Finding& f : r.findings) {
        const auto at = static_cast<std::size_t>(f.verdict);
        s += fmt::format(
            "<tr><th>{}</th><td>{}<div class=\"why\">Held against: {}</div>{}</td>"
            "<td class=\"v {}\">{}</td></tr>\n",
            escaped(f.name), escaped(f.value), escaped(f.against),
            f.remedy.empty() ? std::string() : fmt::format("<div class=\"do\">To do: {}</div>", escaped(f.remedy)),
            kIds[at], kWords[at]);
    }
    s += "</table>\n";
    s += histogramSvg(r.periodHistogramUs, "Time between two frames of the device's servo", false);
    s += histogramSvg(r.latenessHistogramUs, "Lateness of the tick", true);
    s += "<p class=\"why\">[R]: recalled, not checked. Measured by handpiece device check; nothing here was taken from "
         "the maker's own words but what is called its record.</p>\n</body></html>\n";
    return s;
}

}  // namespace handpiece::fidelity
