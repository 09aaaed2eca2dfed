// SPDX-License-Identifier: Apache-2.0
#include "trajectory.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "handpiece/base/core/error.h"

namespace handpiece::bench {
namespace {

using core::Pose;
using core::Vec3;

constexpr double kSpacingMm = 0.01;  // between the places where the way is solved

core::Quat tilt() {
    return core::Quat(Eigen::AngleAxisd(15.0 * std::numbers::pi / 180.0, Vec3(0.6, 0.8, 0.0)));
}

/// Coming down from above (x, y, from), the first height at which the depth reaches the target.
double heightOfDepth(Query& surface, double x, double y, double from, double floor, double targetMm) {
    const auto depth = [&](double z) { return surface.depthMm({Vec3(x, y, z), tilt()}); };
    double high = from, low = from;
    while (depth(low) < targetMm) {
        high = low;
        low -= 0.05;
        if (low < floor) throw core::Error("the bur fell past the tooth", "benchmark trajectory");
    }
    if (low == high) return high;
    for (int i = 0; i < 24; ++i) {
        const double middle = 0.5 * (low + high);
        (depth(middle) < targetMm ? high : low) = middle;
    }
    return low;
}

}  // namespace

std::vector<Pose> makeTrajectory(Way way, Query& surface, const geometry::TriangleMesh& tooth, int ticks) {
    const core::Box whole = tooth.bounds();
    core::Box crown;
    for (const Vec3& v : tooth.vertices)
        if (v.z() > whole.max.z() - 2.5) crown.extend(v);
    const Vec3 centre = crown.centre(), half = 0.5 * crown.size();
    const double wantedMm = way == Way::hover ? 22.0 : 24.0;

    // A figure of eight over the crown: it crosses the fissures and climbs the cusps.
    std::vector<Vec3> points;
    std::vector<double> lengths;
    double along = 0.0, t = 0.0;
    while (lengths.empty() || lengths.back() < wantedMm) {
        const double x = centre.x() + 0.6 * half.x() * std::sin(t),
                     y = centre.y() + 0.5 * half.y() * std::sin(2.0 * t + 0.4);
        const double target = way == Way::hover  ? -1.0
                              : way == Way::deep ? 1.0
                                                 : 0.275 - 0.225 * std::cos(std::numbers::pi * along);
        const double from = points.empty() ? whole.max.z() + 3.0 : points.back().z() + 0.5;
        points.emplace_back(x, y, heightOfDepth(surface, x, y, from, whole.min.z(), target));
        lengths.push_back(points.size() < 2 ? 0.0
                                            : lengths.back() + (points.back() - points[points.size() - 2]).norm());
        const double dx = 0.6 * half.x() * std::cos(t), dy = half.y() * std::cos(2.0 * t + 0.4);
        t += kSpacingMm / std::max(0.1, std::hypot(dx, dy));
        along += kSpacingMm;
    }

    std::vector<Pose> poses;
    std::size_t next = 1;
    for (int i = 0; i < ticks; ++i) {
        const double at = wantedMm * i / ticks;
        while (lengths[next] < at)
            ++next;
        const double f = (at - lengths[next - 1]) / std::max(1e-12, lengths[next] - lengths[next - 1]);
        poses.push_back({points[next - 1] + f * (points[next] - points[next - 1]), tilt()});
    }
    return poses;
}

}  // namespace handpiece::bench
