// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/section_outlines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "handpiece/base/core/parallel.h"

namespace handpiece::report {
namespace {

using core::Vec2;
using core::Vec3;

constexpr double kCellMm = 0.1, kMarginMm = 0.5, kPixelsPerMm = 40.0;

/// A regular grid in the plane, rows upwards.
struct Grid {
    double u0 = 0.0, v0 = 0.0;
    int width = 0, height = 0;
    std::vector<double> values;
    [[nodiscard]] double at(int i, int j) const { return values[static_cast<std::size_t>(i + width * j)]; }
};

/// Marching squares: each cell's crossings, joined in pairs; the middle decides a saddle.
std::string pathOf(const Grid& grid, double highV) {
    std::string d;
    const auto add = [&](const Vec2& a, const Vec2& b) {
        const auto put = [&](const char* command, const Vec2& p) {
            fmt::format_to(std::back_inserter(d), "{}{:.2f} {:.2f}", command, (p.x() - grid.u0) * kPixelsPerMm,
                           (highV - p.y()) * kPixelsPerMm);
        };
        put("M", a);
        put("L", b);
    };
    for (int j = 0; j + 1 < grid.height; ++j)
        for (int i = 0; i + 1 < grid.width; ++i) {
            // Corners counter-clockwise; edge k lies between corner k and the next.
            const int du[4] = {0, 1, 1, 0}, dv[4] = {0, 0, 1, 1};
            double f[4];
            Vec2 p[4], crossing[4];
            bool isCrossed[4];
            int count = 0;
            for (int k = 0; k < 4; ++k) {
                f[k] = grid.at(i + du[k], j + dv[k]);
                p[k] = {grid.u0 + kCellMm * (i + du[k]), grid.v0 + kCellMm * (j + dv[k])};
            }
            for (int k = 0; k < 4; ++k) {
                const int n = (k + 1) % 4;
                isCrossed[k] = (f[k] < 0.0) != (f[n] < 0.0);
                if (!isCrossed[k]) continue;
                ++count;
                crossing[k] = p[k] + f[k] / (f[k] - f[n]) * (p[n] - p[k]);
            }
            if (count == 2) {
                int found = 0;
                Vec2 ends[2];
                for (int k = 0; k < 4; ++k)
                    if (isCrossed[k]) ends[found++] = crossing[k];
                add(ends[0], ends[1]);
            } else if (count == 4) {
                const bool inside = f[0] + f[1] + f[2] + f[3] < 0.0;
                const int first = inside == (f[0] < 0.0) ? 0 : 3;
                add(crossing[first], crossing[(first + 1) % 4]);
                add(crossing[(first + 2) % 4], crossing[(first + 3) % 4]);
            }
        }
    return d;
}

}  // namespace

std::string outlinesSvg(const SectionOutlines& outlines) {
    Grid grid;
    double highU = -1e300, highV = -1e300;
    grid.u0 = grid.v0 = 1e300;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p((corner & 1) != 0 ? outlines.box.max.x() : outlines.box.min.x(),
                     (corner & 2) != 0 ? outlines.box.max.y() : outlines.box.min.y(),
                     (corner & 4) != 0 ? outlines.box.max.z() : outlines.box.min.z());
        const double u = outlines.right.dot(p - outlines.originMm), v = outlines.up.dot(p - outlines.originMm);
        grid.u0 = std::min(grid.u0, u - kMarginMm);
        highU = std::max(highU, u + kMarginMm);
        grid.v0 = std::min(grid.v0, v - kMarginMm);
        highV = std::max(highV, v + kMarginMm);
    }
    grid.v0 = std::max(grid.v0, outlines.lowestMm - outlines.up.dot(outlines.originMm));
    grid.width = static_cast<int>((highU - grid.u0) / kCellMm) + 2;
    grid.height = static_cast<int>((highV - grid.v0) / kCellMm) + 2;
    if (grid.width < 2 || grid.height < 2) return {};
    const auto lineOf = [&](const geometry::ScalarFunction& f) {
        grid.values.assign(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height), 0.0);
        core::parallelFor(static_cast<std::size_t>(grid.height), 4, [&](std::size_t begin, std::size_t end) {
            for (std::size_t j = begin; j < end; ++j)
                for (int i = 0; i < grid.width; ++i)
                    grid.values[static_cast<std::size_t>(i) + static_cast<std::size_t>(grid.width) * j] =
                        f(outlines.originMm + (grid.u0 + kCellMm * i) * outlines.right +
                          (grid.v0 + kCellMm * static_cast<double>(j)) * outlines.up);
        });
        return pathOf(grid, highV);
    };
    const double w = (highU - grid.u0) * kPixelsPerMm, h = (highV - grid.v0) * kPixelsPerMm;
    std::string svg = fmt::format(
        "<svg class=\"hp\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" xmlns=\"http://www.w3.org/2000/svg\">", w, h);
    for (double u = std::ceil(grid.u0); u < highU; u += 1.0)
        svg += fmt::format("<line class=\"hp-grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"0\" y2=\"{1:.1f}\"/>",
                           (u - grid.u0) * kPixelsPerMm, h);
    for (double v = std::ceil(grid.v0); v < highV; v += 1.0)
        svg += fmt::format("<line class=\"hp-grid\" x1=\"0\" x2=\"{1:.1f}\" y1=\"{0:.1f}\" y2=\"{0:.1f}\"/>",
                           (highV - v) * kPixelsPerMm, w);
    const auto draw = [&](const geometry::ScalarFunction& f, const char* style) {
        if (f) svg += fmt::format("<path class=\"hp-line {}\" d=\"{}\"/>", style, lineOf(f));
    };
    // As the words of the page say: grey dashes, green, and one's own on top.
    draw(outlines.before, "hp-c7 hp-dash");
    draw(outlines.ideal, "hp-c2 hp-wide");
    draw(outlines.own, "hp-c1 hp-wide");
    return svg + "</svg>";
}

}  // namespace handpiece::report
