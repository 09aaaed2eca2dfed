// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/section_outlines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>
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
std::vector<SectionLine> linesOf(const Grid& grid) {
    std::vector<SectionLine> lines;
    // Where a node lies on the line two crossings are one.
    const auto add = [&](const Vec2& a, const Vec2& b) {
        if (a != b) lines.push_back({a, b});
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
                // From the lower end: the same bits in the cell beside.
                const int low = k < 2 ? k : k == 2 ? 3 : 0, high = k < 2 ? k + 1 : k == 2 ? 2 : 3;
                isCrossed[k] = (f[low] < 0.0) != (f[high] < 0.0);
                if (!isCrossed[k]) continue;
                ++count;
                crossing[k] = p[low] + f[low] / (f[low] - f[high]) * (p[high] - p[low]);
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
    return lines;
}

/// Pieces joined where they meet, so that a line's dashes run on along it; a closed one ends where it begins.
std::vector<std::vector<Vec2>> joined(const std::vector<SectionLine>& pieces) {
    using Key = std::pair<double, double>;
    const auto key = [](const Vec2& p) { return Key(p.x(), p.y()); };
    std::multimap<Key, std::size_t> at;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        at.emplace(key(pieces[i].from), i);
        at.emplace(key(pieces[i].to), i);
    }
    std::vector<bool> isTaken(pieces.size(), false);
    const auto extend = [&](std::vector<Vec2>& line) {
        for (bool isOn = true; isOn;) {
            isOn = false;
            const auto [begin, end] = at.equal_range(key(line.back()));
            for (auto i = begin; i != end && !isOn; ++i) {
                if (isTaken[i->second]) continue;
                isTaken[i->second] = isOn = true;
                const SectionLine& piece = pieces[i->second];
                line.push_back(piece.from == line.back() ? piece.to : piece.from);
            }
        }
    };
    std::vector<std::vector<Vec2>> lines;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (isTaken[i]) continue;
        isTaken[i] = true;
        std::vector<Vec2>& line = lines.emplace_back();
        line = {pieces[i].from, pieces[i].to};
        extend(line);
        std::reverse(line.begin(), line.end());
        extend(line);
    }
    return lines;
}

}  // namespace

std::vector<SectionLine> linesIn(const SectionOutlines& plane, const Vec2& low, const Vec2& high,
                                 const geometry::ScalarFunction& f) {
    Grid grid;
    grid.u0 = low.x();
    grid.v0 = low.y();
    grid.width = static_cast<int>((high.x() - low.x()) / kCellMm) + 2;
    grid.height = static_cast<int>((high.y() - low.y()) / kCellMm) + 2;
    if (grid.width < 2 || grid.height < 2) return {};
    grid.values.assign(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height), 0.0);
    core::parallelFor(static_cast<std::size_t>(grid.height), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t j = begin; j < end; ++j)
            for (int i = 0; i < grid.width; ++i)
                grid.values[static_cast<std::size_t>(i) + static_cast<std::size_t>(grid.width) * j] =
                    f(plane.originMm + (grid.u0 + kCellMm * i) * plane.right +
                      (grid.v0 + kCellMm * static_cast<double>(j)) * plane.up);
    });
    return linesOf(grid);
}

core::Vec3 outwardAt(const measure::ToothProbe& probe, double voxelMm, const Vec3& placeMm, const Vec3& otherwise) {
    Vec3 slope;
    for (int k = 0; k < 3; ++k)
        slope[k] = probe.signedDistanceMm(placeMm + voxelMm * Vec3::Unit(k)) -
                   probe.signedDistanceMm(placeMm - voxelMm * Vec3::Unit(k));
    return slope.norm() > 1e-12 ? Vec3(slope.normalized()) : otherwise;
}

std::string outlinesSvg(const SectionOutlines& outlines) {
    Vec2 low(1e300, 1e300), high(-1e300, -1e300);
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p((corner & 1) != 0 ? outlines.box.max.x() : outlines.box.min.x(),
                     (corner & 2) != 0 ? outlines.box.max.y() : outlines.box.min.y(),
                     (corner & 4) != 0 ? outlines.box.max.z() : outlines.box.min.z());
        const Vec3 off = p - outlines.originMm;
        const Vec2 at(outlines.right.dot(off), outlines.up.dot(off)), margin(kMarginMm, kMarginMm);
        low = low.cwiseMin(at - margin);
        high = high.cwiseMax(at + margin);
    }
    low.y() = std::max(low.y(), outlines.lowestMm - outlines.up.dot(outlines.originMm));
    high.y() = std::min(high.y(), outlines.highestMm - outlines.up.dot(outlines.originMm));
    if (high.y() < low.y()) return {};
    const double highU = high.x(), highV = high.y();
    const auto lineOf = [&](const geometry::ScalarFunction& f) {
        std::string d;
        const auto put = [&](const char* command, const Vec2& p) {
            fmt::format_to(std::back_inserter(d), "{}{:.2f} {:.2f}", command, (p.x() - low.x()) * kPixelsPerMm,
                           (highV - p.y()) * kPixelsPerMm);
        };
        for (const std::vector<Vec2>& line : joined(linesIn(outlines, low, high, f)))
            for (std::size_t i = 0; i < line.size(); ++i)
                put(i == 0 ? "M" : "L", line[i]);
        return d;
    };
    const double w = (highU - low.x()) * kPixelsPerMm, h = (highV - low.y()) * kPixelsPerMm;
    std::string svg = fmt::format(
        "<svg class=\"hp\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" xmlns=\"http://www.w3.org/2000/svg\">", w, h);
    for (double u = std::ceil(low.x()); u < highU; u += 1.0)
        svg += fmt::format("<line class=\"hp-grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"0\" y2=\"{1:.1f}\"/>",
                           (u - low.x()) * kPixelsPerMm, h);
    for (double v = std::ceil(low.y()); v < highV; v += 1.0)
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
