// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/report_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace handpiece::report {
namespace {

constexpr std::size_t kStretch = 4096;
/// Forces are counted in bins so fine.
constexpr double kBinN = 0.002;
constexpr std::size_t kBins = 20000;

double niceAbove(double value) {
    if (!(value > 0.0)) return 1.0;
    const double decade = std::pow(10.0, std::floor(std::log10(value)));
    for (const double step : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.5})
        if (value <= step * decade) return step * decade;
    return 10.0 * decade;
}

}  // namespace

SessionFigures figuresOf(const session::SessionReader& reader) {
    SessionFigures f;
    const double period = 1.0 / reader.info().rateHz;
    std::vector<std::uint64_t> bins(kBins, 0);
    std::uint64_t contact = 0, limited = 0, cutting = 0;
    double forceSum = 0.0, rpmSum = 0.0;
    for (std::uint64_t first = 0; first < reader.size(); first += kStretch)
        for (const session::Record& r : reader.records(first, kStretch)) {
            const double lasts = period * r.elapsedPeriods;
            ++f.ticks;
            f.missedPeriods += r.elapsedPeriods - 1u;
            f.totalS = period * static_cast<double>(r.tick);
            if (r.pedal > 0) f.pedalS += lasts;
            // A file may say anything: what is no number counts for nothing.
            const double rpm = std::isfinite(r.speedRpm) ? static_cast<double>(r.speedRpm) : 0.0;
            f.mostRpm = std::max(f.mostRpm, rpm);
            f.removedMm3 = r.removedMm3;
            if ((r.flags & messages::kCutting) != 0) {
                f.cuttingS += lasts;
                rpmSum += rpm;
                ++cutting;
            }
            const double force = std::hypot(static_cast<double>(r.forceN[0]), static_cast<double>(r.forceN[1]),
                                            static_cast<double>(r.forceN[2]));
            if (!(r.depthMm > 0.0f) || !std::isfinite(force)) continue;
            f.contactS += lasts;
            ++contact;
            forceSum += force;
            f.peakForceN = std::max(f.peakForceN, force);
            limited += (r.flags & messages::kForceLimited) != 0;
            ++bins[std::min(static_cast<std::size_t>(std::min(force / kBinN, 1.0 * kBins)), kBins - 1)];
        }
    if (contact > 0) {
        f.meanForceN = forceSum / static_cast<double>(contact);
        f.limitedShare = static_cast<double>(limited) / static_cast<double>(contact);
        std::uint64_t below = 0;
        std::size_t bin = 0;
        for (; bin + 1 < kBins && static_cast<double>(below += bins[bin]) < 0.95 * static_cast<double>(contact);
             ++bin) {
        }
        f.p95ForceN = std::min((static_cast<double>(bin) + 1.0) * kBinN, f.peakForceN);
    }
    if (cutting > 0) f.meanCuttingRpm = rpmSum / static_cast<double>(cutting);
    return f;
}

std::string timePlot(const std::vector<simulation::PlotPoint>& points, float simulation::PlotPoint::*value,
                     const std::vector<EventMark>& marks, const std::string& label, const std::string& unit) {
    constexpr double kLeft = 52.0, kTop = 16.0, kWide = 680.0, kHigh = 110.0, kMaxTicks = 8.0;
    const double end = points.empty() ? 1.0 : std::max(points.back().timeS, 1e-3);
    double most = 0.0;
    for (const simulation::PlotPoint& p : points)
        most = std::max(most, static_cast<double>(p.*value));
    most = niceAbove(most);
    const auto x = [&](double timeS) { return kLeft + kWide * timeS / end; };
    const auto y = [&](double v) { return kTop + kHigh * (1.0 - std::clamp(v / most, 0.0, 1.0)); };
    std::string svg = fmt::format(
        "<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\"><title>{}</title><g class=\"axis\"><path d=\"M{:.1f} "
        "{:.1f}V{:.1f}H{:.1f}\"/>",
        kLeft + kWide + 22, kTop + kHigh + 34, escapedText(label), kLeft, kTop, kTop + kHigh, kLeft + kWide);
    for (int i = 0; i <= 2; ++i) {
        const double v = most * i / 2.0;
        svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", kLeft - 5, y(v) + 4,
                           most >= 1e4 ? fmt::format("{:.0f}", v) : fmt::format("{:.4g}", v));
    }
    const double step = niceAbove(end / kMaxTicks);
    for (int i = 0; i * step <= end * (1.0 + 1e-9); ++i)
        svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:.6g}</text>", x(i * step),
                           kTop + kHigh + 15, i * step);
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">time [s]</text></g>", kLeft + kWide / 2,
                       kTop + kHigh + 30);
    svg += fmt::format("<text class=\"label\" x=\"{:.1f}\" y=\"11\">{} [{}]</text>", kLeft, escapedText(label),
                       escapedText(unit));
    for (const EventMark& mark : marks)
        svg += fmt::format("<path class=\"mark\" d=\"M{:.1f} {:.1f}V{:.1f}\"><title>{:.2f} s: {}</title></path>",
                           x(mark.timeS), kTop, kTop + kHigh, mark.timeS, escapedText(mark.name));
    // The greatest of each column of the picture.
    std::string line;
    std::size_t i = 0;
    for (int column = 0; column <= static_cast<int>(kWide); ++column) {
        double high = -1.0;
        for (; i < points.size() && x(points[i].timeS) <= kLeft + column + 0.5; ++i)
            high = std::max(high, static_cast<double>(points[i].*value));
        if (high >= 0.0 || (i > 0 && column == 0)) line += fmt::format("{:.1f},{:.1f} ", kLeft + column, y(high));
    }
    svg += fmt::format("<polyline class=\"line\" points=\"{}\"/></svg>\n", line);
    return svg;
}

std::string escapedText(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '&')
            out += "&amp;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

std::string base64Of(const std::vector<std::uint8_t>& bytes) {
    static constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = std::min<std::size_t>(bytes.size() - i, 3);
        std::uint32_t three = 0;
        for (std::size_t k = 0; k < 3; ++k)
            three = three << 8 | (k < left ? bytes[i + k] : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            out += k <= left ? kLetters[three >> (18 - 6 * k) & 63] : '=';
    }
    return out;
}

}  // namespace handpiece::report
