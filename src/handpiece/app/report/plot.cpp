// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace handpiece::report {
namespace {

constexpr int kColours = 8;
constexpr double kLetter = 6.6;  // mean width of a letter of 12 px

struct Range {
    double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
    void take(double v) {
        if (!std::isfinite(v)) return;
        low = std::min(low, v);
        high = std::max(high, v);
    }
    void open(double margin) {
        if (!(low <= high)) low = 0.0, high = 1.0;
        const double size = high - low;
        const double by = size > 0.0 ? margin * size : std::max(1.0, std::abs(high)) * 0.5;
        if (size == 0.0 || margin > 0.0) low -= by, high += by;
    }
};

/// Pixels of the axes' box.
struct Frame {
    double left, top, right, bottom;
    Range x, y;
    [[nodiscard]] double px(double v) const { return left + (v - x.low) / (x.high - x.low) * (right - left); }
    [[nodiscard]] double py(double v) const { return bottom - (v - y.low) / (y.high - y.low) * (bottom - top); }
};

/// Collects "x,y" pairs into polylines; a gap starts a new one.
class Polyline {
  public:
    void to(double x, double y) { points_ += fmt::format("{:.1f},{:.1f} ", x, y); }
    void gap() {
        if (!points_.empty()) lines_.push_back(std::move(points_));
        points_.clear();
    }
    [[nodiscard]] std::string svg(std::string_view attributes) {
        gap();
        std::string text;
        for (const std::string& line : lines_)
            text += fmt::format("<polyline {} points=\"{}\"/>\n", attributes, line);
        return text;
    }

  private:
    std::string points_;
    std::vector<std::string> lines_;
};

bool drawable(const Series& s, std::size_t i) {
    return std::isfinite(s.x[i]) && std::isfinite(s.y[i]);
}

std::string lineOf(const Series& s, const Frame& f, int colour) {
    Polyline line;
    const std::size_t n = std::min(s.x.size(), s.y.size());
    const bool isLong = static_cast<double>(n) > 2.0 * (f.right - f.left);
    for (std::size_t i = 0; i < n;) {
        if (!drawable(s, i)) {
            line.gap();
            ++i;
            continue;
        }
        if (!isLong) {
            line.to(f.px(s.x[i]), f.py(s.y[i]));
            ++i;
            continue;
        }
        // One pixel column: first, least, greatest and last, in the order they came.
        const double column = std::floor(f.px(s.x[i]));
        const std::size_t begin = i;
        std::size_t least = i, greatest = i;
        for (; i < n && drawable(s, i) && std::floor(f.px(s.x[i])) == column; ++i) {
            if (s.y[i] < s.y[least]) least = i;
            if (s.y[i] > s.y[greatest]) greatest = i;
        }
        std::vector<std::size_t> kept{begin, std::min(least, greatest), std::max(least, greatest), i - 1};
        kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
        for (const std::size_t k : kept)
            line.to(f.px(s.x[k]), f.py(s.y[k]));
    }
    return line.svg(fmt::format("class=\"hp-line hp-c{}{}\"", colour, s.dashed ? " hp-dash" : ""));
}

std::string markersOf(const Series& s, const Frame& f, int colour) {
    std::string text;
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i)
        if (drawable(s, i))
            text += fmt::format("<circle class=\"hp-dot hp-c{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>\n", colour,
                                f.px(s.x[i]), f.py(s.y[i]));
    return text;
}

std::string axes(const Plot& plot, const Frame& f) {
    std::string text;
    for (const double v : roundTicks(f.x.low, f.x.high, 8)) {
        const double x = f.px(v);
        text += fmt::format("<line class=\"hp-grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>", x,
                            f.top, f.bottom);
        text +=
            fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:.6g}</text>\n", x, f.bottom + 17, v);
    }
    for (const double v : roundTicks(f.y.low, f.y.high, 6)) {
        const double y = f.py(v);
        text += fmt::format("<line class=\"hp-grid\" x1=\"{1:.1f}\" x2=\"{2:.1f}\" y1=\"{0:.1f}\" y2=\"{0:.1f}\"/>", y,
                            f.left, f.right);
        text +=
            fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{:.6g}</text>\n", f.left - 7, y + 4, v);
    }
    text += fmt::format(
        "<rect class=\"hp-frame\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n"
        "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n"
        "<text transform=\"translate(15 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
        f.left, f.top, f.right - f.left, f.bottom - f.top, 0.5 * (f.left + f.right), f.bottom + 36,
        escaped(plot.xLabel), 0.5 * (f.top + f.bottom), escaped(plot.yLabel));
    if (!plot.title.empty())
        text += fmt::format("<text class=\"hp-title\" x=\"{:.1f}\" y=\"18\">{}</text>\n", f.left, escaped(plot.title));
    return text;
}

std::string limitsOf(const Plot& plot, const Frame& f) {
    std::string text;
    for (const Limit& limit : plot.limits) {
        const double y = f.py(limit.y);
        text += fmt::format(
            "<line class=\"hp-limit\" x1=\"{0:.1f}\" x2=\"{1:.1f}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>"
            "<text class=\"hp-limit-text\" x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
            f.left, f.right, y, f.right - 5, y - f.top < 16.0 ? y + 14.0 : y - 5.0, escaped(limit.label));
    }
    return text;
}

int colourOf(const Series& s, std::size_t place) {
    return (s.colour >= 0 ? s.colour : static_cast<int>(place)) % kColours;
}

/// Rows of names above the axes; returns the height they take.
double legend(const Plot& plot, double left, double right, double top, std::string& out) {
    double x = left, y = top;
    bool any = false;
    for (std::size_t i = 0; i < plot.series.size(); ++i) {
        const Series& s = plot.series[i];
        if (s.name.empty()) continue;
        const double width = 26.0 + kLetter * static_cast<double>(s.name.size()) + 14.0;
        if (any && x + width > right) x = left, y += 17.0;
        any = true;
        if (s.line)
            out += fmt::format(
                "<line class=\"hp-line hp-c{}{}\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>",
                colourOf(s, i), s.dashed ? " hp-dash" : "", x, x + 20, y - 4, y - 4);
        if (s.markers)
            out += fmt::format("<circle class=\"hp-dot hp-c{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>", colourOf(s, i),
                               x + 10, y - 4);
        out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x + 26, y, escaped(s.name));
        x += width;
    }
    return any ? y - top + 20.0 : 0.0;
}

std::string marksOf(const Plot& plot, const Frame& f) {
    std::string text;
    for (const Mark& mark : plot.marks)
        text += fmt::format("<path class=\"hp-mark\" d=\"M{:.1f} {:.1f}V{:.1f}\"><title>{:.2f}: {}</title></path>\n",
                            f.px(mark.x), f.top, f.bottom, mark.x, escaped(mark.label));
    return text;
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

}  // namespace

std::string toSvg(const Plot& plot, bool standalone) {
    Frame f{64.0, plot.title.empty() ? 12.0 : 30.0, plot.width - 14.0, plot.height - 46.0, {}, {}};
    for (const Series& s : plot.series)
        for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i)
            if (drawable(s, i)) f.x.take(s.x[i]), f.y.take(s.y[i]);
    for (const Limit& limit : plot.limits)
        f.y.take(limit.y);
    for (const Mark& mark : plot.marks)
        f.x.take(mark.x);
    f.x.open(0.0);
    f.y.open(0.06);
    std::string names;
    f.top += legend(plot, f.left, f.right, f.top + 12.0, names);
    std::string body = axes(plot, f) + names + marksOf(plot, f);
    for (std::size_t i = 0; i < plot.series.size(); ++i) {
        const Series& s = plot.series[i];
        if (s.line) body += lineOf(s, f, colourOf(s, i));
        if (s.markers) body += markersOf(s, f, colourOf(s, i));
    }
    body += limitsOf(plot, f);
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"hp\" viewBox=\"0 0 {0} {1}\" "
        "{4}role=\"img\">\n{2}{3}</svg>\n",
        plot.width, plot.height,
        standalone
            ? fmt::format("<style>{}</style>\n<rect class=\"hp-page\" width=\"100%\" height=\"100%\"/>\n", svgStyle())
            : "",
        body, standalone ? fmt::format("width=\"{}\" height=\"{}\" ", plot.width, plot.height) : "");
}

Histogram histogramSvg(const std::vector<double>& counts, std::string_view title, std::string_view xLabel,
                       bool fromZero) {
    constexpr double kWidth = 640, kHeight = 150, kLeft = 46, kBottom = 34, kTop = 8, kRight = 24;
    const Drawn d = drawnOf(counts, fromZero);
    if (d.total <= 0.0) return {};
    const double w = kWidth - kLeft - kRight, h = kHeight - kBottom - kTop;
    const double decades = std::max(1.0, std::ceil(std::log10(std::max(d.most, 1.0)) + 1e-9));
    std::string s = fmt::format(
        "<svg class=\"hp\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\" "
        "xmlns=\"http://www.w3.org/2000/svg\">",
        kWidth, kHeight, escaped(title));
    for (int k = 0; k <= static_cast<int>(decades); ++k) {
        const double y = kTop + h * (1.0 - k / decades);
        s += fmt::format(
            "<line class=\"hp-grid\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>"
            "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{:.0f}</text>",
            kLeft, kLeft + w, y, y, kLeft - 5, y + 4, std::pow(10.0, k));
    }
    const double each = w / static_cast<double>(d.bars.size());
    for (std::size_t i = 0; i < d.bars.size(); ++i) {
        if (d.bars[i] <= 0.0) continue;
        // One count is seen too.
        const double tall = h * std::max(0.02, std::log10(d.bars[i]) / decades);
        s += fmt::format("<rect class=\"hp-bar\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>",
                         kLeft + each * static_cast<double>(i), kTop + h - tall, std::max(each - 0.4, 0.6), tall);
    }
    const double first = static_cast<double>(d.first), span = static_cast<double>(d.bars.size() * d.perBar);
    for (int k = 0; k <= 4; ++k)
        s += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:.0f}</text>", kLeft + w * k / 4.0,
                         kTop + h + 15, first + span * k / 4.0);
    s += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text></svg>", kLeft + w / 2,
                     kHeight - 4, escaped(xLabel));
    return {std::move(s), d.total, d.beyond};
}

std::string_view svgStyle() {
    // Plain classes, no CSS variables: converters know them too.
    return R"(
.hp { color: #1c2430; font: 12px "Helvetica Neue", Arial, sans-serif; }
.hp text { fill: currentColor; } .hp .hp-page { fill: #ffffff; } .hp .hp-title { font-size: 14px; font-weight: 600; }
.hp .hp-grid { stroke: #8a93a3; stroke-opacity: 0.28; stroke-width: 1; }
.hp .hp-frame { fill: none; stroke: #8a93a3; stroke-width: 1; }
.hp .hp-line { fill: none; stroke-width: 1.7; stroke-linejoin: round; } .hp .hp-dash { stroke-dasharray: 6 4; } .hp .hp-wide { stroke-width: 3.5; stroke-linecap: round; }
.hp .hp-mark { stroke: #c9762b; stroke-width: 0.8; stroke-dasharray: 3 2; } .hp .hp-bar { fill: #2f6f9f; }
.hp .hp-limit { stroke: #c62828; stroke-width: 1.3; stroke-dasharray: 8 5; } .hp .hp-limit-text { fill: #c62828; }
.hp .hp-tooth { fill: #d9c9a3; fill-opacity: 0.75; stroke: #8c7a4f; stroke-width: 1; }
.hp .hp-behind { fill: #d9c9a3; fill-opacity: 0.30; stroke: none; }
.hp .hp-bur { fill: #4b6f9c; fill-opacity: 0.10; stroke: #2a5590; stroke-width: 1; }
.hp .hp-bur-touch { fill: #c8501e; fill-opacity: 0.16; stroke: #c8501e; stroke-width: 1.6; }
.hp .hp-c0 { stroke: #1f5fa8; } .hp .hp-c1 { stroke: #c8501e; } .hp .hp-c2 { stroke: #2b8a50; }
.hp .hp-c3 { stroke: #84419c; } .hp .hp-c4 { stroke: #a87d00; } .hp .hp-c5 { stroke: #15858f; }
.hp .hp-c6 { stroke: #b03060; } .hp .hp-c7 { stroke: #5b6470; } .hp .hp-dot { fill: #ffffff; stroke-width: 1.7; }
@media (prefers-color-scheme: dark) {
.hp { color: #dfe4ec; } .hp .hp-page { fill: #14181f; } .hp .hp-dot { fill: #14181f; } .hp .hp-limit { stroke: #ff7b72; } .hp .hp-limit-text { fill: #ff7b72; }
.hp .hp-c0 { stroke: #6fa8ee; } .hp .hp-c1 { stroke: #f29261; } .hp .hp-c2 { stroke: #66c98c; } .hp .hp-c3 { stroke: #c68ee0; }
.hp .hp-c4 { stroke: #e0bb4a; } .hp .hp-c5 { stroke: #5cc4cf; } .hp .hp-c6 { stroke: #ee7fa6; } .hp .hp-c7 { stroke: #a3adba; }
.hp .hp-bur { stroke: #8db8f0; } .hp .hp-bur-touch { stroke: #f29261; } .hp .hp-tooth { fill-opacity: 0.55; }
}
)";
}

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

std::vector<double> roundTicks(double low, double high, int count) {
    const double rough = (high - low) / std::max(1, count);
    if (!(rough > 0.0) || !std::isfinite(rough)) return {};
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    double step = 10.0 * power;
    for (const double factor : {1.0, 2.0, 5.0})
        if (factor * power >= rough * (1.0 - 1e-9)) {
            step = factor * power;
            break;
        }
    std::vector<double> ticks;
    for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i)
        ticks.push_back(i == 0.0 ? 0.0 : i * step);
    return ticks;
}

}  // namespace handpiece::report
