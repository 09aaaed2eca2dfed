// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Line plots as SVG: axes with units, grid, legend, markers, limit lines.
///
/// Our own writer and not a plotting library: PLplot's SVG device paints an opaque page, writes a fixed colour onto
/// every element and keeps its state in globals, so that its plots cannot follow a page between light and dark.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace handpiece::report {

struct Series {
    std::string name;  ///< in the legend; empty: not listed
    std::vector<double> x, y;
    bool line = true, markers = false, dashed = false;
    int colour = -1;  ///< 0..7; -1: its place in the plot
};

/// A horizontal line that should not be crossed.
struct Limit {
    double y = 0.0;
    std::string label;
};

/// A vertical line where something happened.
struct Mark {
    double x = 0.0;
    std::string label;
};

struct Plot {
    std::string title, xLabel, yLabel;  ///< labels with their unit: "time [s]"
    std::vector<Series> series;
    std::vector<Limit> limits;
    std::vector<Mark> marks{};
    int width = 760, height = 340;
};

/// The plot as one `<svg>` element. `standalone` puts the style inside, for a file of its own; a page that holds many
/// carries svgStyle() once instead. Series longer than the plot is wide are drawn by the least and greatest value of
/// each pixel column. Values that are not finite leave gaps.
[[nodiscard]] std::string toSvg(const Plot& plot, bool standalone);

/// Counts by bins of one, as bars on a logarithmic scale: rare ones are what matters. From the first count, or from 0;
/// the last thousandth is left to the caption. `xLabel` with the unit of a bin. Empty without counts.
struct Histogram {
    std::string svg;
    double total = 0.0, beyond = 0.0;  ///< counts; those beyond the right edge
};
[[nodiscard]] Histogram histogramSvg(const std::vector<double>& counts, std::string_view title, std::string_view xLabel,
                                     bool fromZero);

/// The style sheet of all pictures, without the `<style>` tags.
[[nodiscard]] std::string_view svgStyle();

/// For text inside XML.
[[nodiscard]] std::string escaped(std::string_view text);

/// Round numbers that divide low..high into about `count` steps.
[[nodiscard]] std::vector<double> roundTicks(double low, double high, int count);

}  // namespace handpiece::report
