// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/measures/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::measures {

using core::Vec2;
using core::Vec3;

bool solveNormal(double* a, double* b, int n) {
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j <= i; ++j) {
            double sum = a[i * n + j];
            for (int k = 0; k < j; ++k)
                sum -= a[i * n + k] * a[j * n + k];
            if (i != j) {
                a[i * n + j] = sum / a[j * n + j];
            } else {
                if (!(sum > 1e-10 * std::abs(a[i * n + i])) || !(sum > 0.0)) return false;
                a[i * n + i] = std::sqrt(sum);
            }
        }
    }
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < i; ++k)
            b[i] -= a[i * n + k] * b[k];
        b[i] /= a[i * n + i];
    }
    for (int i = n - 1; i >= 0; --i) {
        for (int k = i + 1; k < n; ++k)
            b[i] -= a[k * n + i] * b[k];
        b[i] /= a[i * n + i];
    }
    return true;
}

double localScatter(std::span<const double> values, std::size_t lag) {
    if (values.size() <= lag) return 0.0;
    double squares = 0.0;
    for (std::size_t i = lag; i < values.size(); ++i)
        squares += (values[i] - values[i - lag]) * (values[i] - values[i - lag]);
    return std::sqrt(0.5 * squares / static_cast<double>(values.size() - lag));
}

double rmsAboutCurve(std::span<const Vec3> points) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : points)
        middle += p / static_cast<double>(points.size());
    double a[36] = {}, b[6] = {};
    const auto termsOf = [&](const Vec3& p, double* u) {
        const double x = p.x() - middle.x(), y = p.y() - middle.y();
        u[0] = 1.0, u[1] = x, u[2] = y, u[3] = x * x, u[4] = x * y, u[5] = y * y;
    };
    double u[6];
    for (const Vec3& p : points) {
        termsOf(p, u);
        for (int row = 0; row < 6; ++row) {
            for (int column = 0; column <= row; ++column)
                a[row * 6 + column] += u[row] * u[column];
            b[row] += u[row] * (p.z() - middle.z());
        }
    }
    if (points.size() < 12 || !solveNormal(a, b, 6)) return 0.0;
    double squares = 0.0;
    for (const Vec3& p : points) {
        termsOf(p, u);
        double off = p.z() - middle.z();
        for (int k = 0; k < 6; ++k)
            off -= b[k] * u[k];
        squares += off * off;
    }
    return std::sqrt(squares / static_cast<double>(points.size()));
}

double medianOf(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return percentile(values, 0.5);
}

double percentile(std::span<const double> sorted, double share) {
    if (sorted.empty()) return 0.0;
    const double at = share * static_cast<double>(sorted.size() - 1);
    const auto low = std::min(static_cast<std::size_t>(at), sorted.size() - 1);
    const auto high = std::min(low + 1, sorted.size() - 1);
    return sorted[low] + (at - static_cast<double>(low)) * (sorted[high] - sorted[low]);
}

double statisticOf(std::span<const double> values, std::string_view statistic, std::size_t* where) {
    std::vector<double> sorted(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end());
    double value = 0.0;
    if (statistic == "mean") {
        for (const double v : sorted)
            value += v;
        value /= static_cast<double>(std::max<std::size_t>(1, sorted.size()));
    } else {
        value = percentile(sorted, statistic == "least"      ? 0.0
                                   : statistic == "p5"       ? 0.05
                                   : statistic == "p95"      ? 0.95
                                   : statistic == "greatest" ? 1.0
                                                             : 0.5);
    }
    if (where != nullptr) {
        *where = 0;
        for (std::size_t i = 1; i < values.size(); ++i)
            if (std::abs(values[i] - value) < std::abs(values[*where] - value)) *where = i;
    }
    return value;
}

Line robustLine(std::span<const Vec2> points) {
    Line line;
    if (points.size() < 4) return line;
    std::vector<double> weights(points.size(), 1.0), sizes(points.size());
    for (int round = 0; round < 10; ++round) {
        double w = 0.0, x = 0.0, y = 0.0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            w += weights[i];
            x += weights[i] * points[i].x();
            y += weights[i] * points[i].y();
        }
        if (!(w > 0.0)) return {};
        x /= w;
        y /= w;
        double xx = 0.0, xy = 0.0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            xx += weights[i] * (points[i].x() - x) * (points[i].x() - x);
            xy += weights[i] * (points[i].x() - x) * (points[i].y() - y);
        }
        if (!(xx > 1e-12 * w)) return {};
        line = {x, y, xy / xx, 0.0, true};
        for (std::size_t i = 0; i < points.size(); ++i)
            sizes[i] = std::abs(points[i].y() - line.of(points[i].x()));
        const double scale = std::max(1e-5, 1.4826 * medianOf(sizes));
        double squares = 0.0, kept = 0.0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            squares += weights[i] * sizes[i] * sizes[i];
            kept += weights[i];
            const double u = sizes[i] / (4.685 * scale);
            weights[i] = u < 1.0 ? (1.0 - u * u) * (1.0 - u * u) : 0.0;
        }
        line.rms = std::sqrt(squares / kept);
    }
    return line;
}

Plane planeThrough(std::span<const Vec3> points) {
    Plane plane;
    if (points.size() < 3) return plane;
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : points)
        middle += p;
    middle /= static_cast<double>(points.size());
    double a[4] = {}, b[2] = {};
    for (const Vec3& p : points) {
        const double x = p.x() - middle.x(), y = p.y() - middle.y(), z = p.z() - middle.z();
        a[0] += x * x;
        a[2] += x * y;
        a[3] += y * y;
        b[0] += x * z;
        b[1] += y * z;
    }
    if (!solveNormal(a, b, 2)) return plane;
    plane.middle = Vec2(middle.x(), middle.y());
    plane.slope = Vec2(b[0], b[1]);
    plane.at = middle.z();
    plane.isFound = true;
    double squares = 0.0;
    for (const Vec3& p : points) {
        const double off = p.z() - plane.of(p.x(), p.y());
        squares += off * off;
    }
    plane.rms = std::sqrt(squares / static_cast<double>(points.size()));
    return plane;
}

std::vector<double> rough(std::span<const Vec3> points, double cutOffMm) {
    constexpr double kConstant = 0.7309, kPi = 3.14159265358979323846;
    constexpr std::size_t kMost = 4000;
    const double scale = kConstant * cutOffMm, reach = 1.1 * scale;
    // Cells as wide as the window: what counts lies in nine of them.
    std::map<std::pair<int, int>, std::vector<std::size_t>> cells;
    const auto cellOf = [&](double v) { return static_cast<int>(std::floor(v / reach)); };
    for (std::size_t i = 0; i < points.size(); ++i)
        cells[{cellOf(points[i].x()), cellOf(points[i].y())}].push_back(i);
    const std::size_t stride = std::max<std::size_t>(1, (points.size() + kMost - 1) / kMost);
    const std::size_t asked = (points.size() + stride - 1) / stride;
    constexpr double kNone = std::numeric_limits<double>::infinity();
    std::vector<double> found(asked, kNone);
    core::parallelFor(asked, 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const Vec3& p = points[k * stride];
            double a[36] = {}, b[6] = {}, weight = 0.0;
            std::size_t count = 0;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const auto cell = cells.find({cellOf(p.x()) + dx, cellOf(p.y()) + dy});
                    if (cell == cells.end()) continue;
                    for (const std::size_t i : cell->second) {
                        const double x = points[i].x() - p.x(), y = points[i].y() - p.y(), r2 = x * x + y * y;
                        if (r2 > reach * reach) continue;
                        const double w = core::exp(-kPi * r2 / (scale * scale));
                        const double u[6] = {1.0, x, y, x * x, x * y, y * y};
                        for (int row = 0; row < 6; ++row) {
                            for (int column = 0; column <= row; ++column)
                                a[row * 6 + column] += w * u[row] * u[column];
                            b[row] += w * u[row] * points[i].z();
                        }
                        weight += w;
                        ++count;
                    }
                }
            if (count < 12 || !solveNormal(a, b, 6)) continue;
            found[k] = (p.z() - b[0]) / std::sqrt(1.0 + b[1] * b[1] + b[2] * b[2]);
        }
    });
    std::erase(found, kNone);
    return found;
}

}  // namespace handpiece::measures
