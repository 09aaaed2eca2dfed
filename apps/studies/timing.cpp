// SPDX-License-Identifier: Apache-2.0
#include "studies/timing.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <thread>

#include "handpiece/base/core/error.h"
#include "studies/built_in_motion.h"

namespace handpiece::studies {
namespace {

constexpr int kPasses = 3;

template <class Work>
Timing timed(std::size_t count, const Work& work) {
    std::vector<double> best(count, std::numeric_limits<double>::infinity());
    for (int pass = 0; pass < kPasses; ++pass)
        for (std::size_t i = 0; i < count; ++i) {
            const auto start = std::chrono::steady_clock::now();
            work(i);
            const std::chrono::duration<double, std::micro> us = std::chrono::steady_clock::now() - start;
            best[i] = std::min(best[i], us.count());
        }
    std::sort(best.begin(), best.end());
    const auto at = [&](double q) { return best[static_cast<std::size_t>(q * static_cast<double>(best.size() - 1))]; };
    return {at(0.5), at(0.99), at(0.999), best.back()};
}

/// Keeps the compiler from leaving out what nobody reads.
void use(double value) {
    asm volatile("" : : "r,m"(value) : "memory");
}

double arithmetic(long steps) {
    double x = 0.5;
    for (long i = 0; i < steps; ++i) {
        x = 3.7 * x * (1.0 - x);
        use(x);
    }
    return x;
}

}  // namespace

core::Pose touchAt(contact::Method& method, const core::Box& bounds, const core::Vec2& xyMm) {
    core::Pose start;
    start.positionMm = {xyMm.x(), xyMm.y(), bounds.max.z() + 1.0};
    method.reset();
    const core::Vec3 down(0.0, 0.0, -1.0);
    start.positionMm += distanceToTouch(method, start, down, bounds.size().z() + 2.0) * down;
    return start;
}

std::vector<core::Pose> sweepAt(contact::Method& method, const core::Box& bounds, double depthMm, std::size_t count) {
    // The touch is felt at knots; in between the height is linear, as a hand would go.
    constexpr int kLines = 6, kKnots = 24;
    const core::Vec3 centre = bounds.centre(), size = bounds.size();
    std::vector<core::Vec3> knots;
    for (int line = 0; line < kLines; ++line)
        for (int k = 0; k <= kKnots; ++k) {
            const double along = (line % 2 == 0 ? 1.0 : -1.0) * (static_cast<double>(k) / kKnots - 0.5);
            const double across = static_cast<double>(line) / (kLines - 1) - 0.5;
            const core::Pose touch =
                touchAt(method, bounds, {centre.x() + 0.6 * size.x() * along, centre.y() + 0.4 * size.y() * across});
            knots.push_back(touch.positionMm - core::Vec3(0.0, 0.0, depthMm));
        }
    std::vector<core::Pose> poses(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double at = static_cast<double>(i) / static_cast<double>(count) * static_cast<double>(knots.size() - 1);
        const auto k = static_cast<std::size_t>(at);
        const double t = at - static_cast<double>(k);
        poses[i].positionMm = (1.0 - t) * knots[k] + t * knots[k + 1];
    }
    return poses;
}

Timing timeQueries(contact::Method& method, const std::vector<core::Pose>& poses, bool withPatches) {
    method.reset();
    contact::PatchSet patches;
    return timed(poses.size(), [&](std::size_t i) {
        use(method.depth(poses[i]).depthMm);
        if (withPatches) {
            method.patches(poses[i], patches);
            use(patches.areaMm2);
        }
    });
}

Timing timeConstantLoad(double us, std::size_t count) {
    constexpr long kProbe = 100000;
    const Timing probe = timed(5, [](std::size_t) { use(arithmetic(kProbe)); });
    const long steps = std::max(1L, std::lround(us / probe.p50 * static_cast<double>(kProbe)));
    return timed(count, [&](std::size_t) { use(arithmetic(steps)); });
}

std::string machineDescription() {
    std::ifstream info("/proc/cpuinfo");
    std::string line, model = "unknown processor";
    while (std::getline(info, line))
        if (line.rfind("model name", 0) == 0) {
            model = line.substr(std::min(line.find(':') + 2, line.size()));
            break;
        }
    return fmt::format("{}, {} threads", model, std::thread::hardware_concurrency());
}

}  // namespace handpiece::studies
