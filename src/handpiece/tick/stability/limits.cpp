// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/stability/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/tick/device/units.h"

namespace handpiece::stability {
namespace {

/// The hands of docs/physics.md#device: kg, N s/mm, N/mm.
struct Hand {
    double massKg, dampingNSPerMm, stiffnessNPerMm;
};
constexpr std::array<Hand, 3> kHands{{{0.01, 0.0005, 0.05}, {0.05, 0.003, 0.3}, {0.10, 0.010, 1.0}}};
constexpr std::array<double, 6> kDamping{0.0, 0.0005, 0.001, 0.002, 0.005, 0.01};
constexpr double kSoftest = 0.02, kHardest = 20.0, kStep = 1.12, kShare = 0.8;
using device::kKgPerUnit;
constexpr double kSubStepS = 50e-6, kApproachMmS = 60.0, kAboveMm = 0.3, kRestS = 0.9, kWindowS = 0.3;
constexpr double kDampingRampMm = 0.05, kRoundingNmm = 1e-9;

/// One tap of a wall at x = 0 from above and the rest that follows; true when it is passive and comes to rest.
bool stable(const DeviceFigures& d, const Hand& hand, double k, double b) {
    const double period = 1.0 / d.rateHz, load = std::min(1.0, 0.5 * d.maxForceN);
    const double aim = -(load / hand.stiffnessNPerMm + load / k);
    const double arrive = (kAboveMm - aim) / kApproachMmS, end = arrive + kRestS;
    const int sub = std::max(1, static_cast<int>(std::ceil(period / kSubStepS)));
    const double h = period / sub, mass = (d.massKg + hand.massKg) / kKgPerUnit;
    const double response = 1.0 / (mass + h * hand.dampingNSPerMm + h * h * hand.stiffnessNPerMm);
    const double stick = d.frictionN * h * response;
    const double activity = std::max(0.0, k * (0.5 * period + d.delayS) - b);
    const auto ticks = static_cast<std::size_t>(std::ceil(end / period));
    const auto delaySteps = static_cast<std::size_t>(std::lround(d.delayS / h));

    std::vector<double> commanded(delaySteps + 1, 0.0);  // a ring, one entry a sub-step
    double x = kAboveMm, v = 0.0, applied = 0.0, force = 0.0, filtered = 0.0, lastRead = x;
    double work = 0.0, variation = 0.0, motion = 0.0;
    double lowA = 1e9, highA = -1e9, lowB = 1e9, highB = -1e9;
    std::size_t step = 0;
    for (std::size_t n = 0; n < ticks; ++n) {
        const double t = static_cast<double>(n) * period;
        const double read = d.encoderStepMm > 0.0 ? std::round(x / d.encoderStepMm) * d.encoderStepMm : x;
        filtered += period / (d.velocityTauS + period) * ((read - lastRead) / period - filtered);
        lastRead = read;
        const double depth = -read, ramp = std::clamp(depth / kDampingRampMm, 0.0, 1.0);
        force = depth > 0.0 ? std::clamp(k * depth - ramp * b * filtered, 0.0, d.maxForceN) : 0.0;
        const double before = x;
        for (int i = 0; i < sub; ++i, ++step) {
            commanded[step % commanded.size()] = force;
            const double now = commanded[(step + commanded.size() - delaySteps) % commanded.size()];
            variation += std::abs(now - applied);
            applied = now;
            const double s = std::min(1.0, (t + (i + 1) * h) / arrive), intended = kAboveMm + s * (aim - kAboveMm);
            const double intendedV = t + i * h < arrive ? -kApproachMmS : 0.0;
            double next =
                response *
                (mass * v + h * (applied + hand.dampingNSPerMm * intendedV + hand.stiffnessNPerMm * (intended - x)));
            next = std::abs(next) > stick ? next - std::copysign(stick, next) : 0.0;
            v = next;
            x += h * v;
            work += applied * h * v;
        }
        motion += (x - before) * (x - before) / period;
        if (work > 0.5 * d.encoderStepMm * variation + activity * motion + kRoundingNmm) return false;
        if (t > end - kWindowS) {
            lowB = std::min(lowB, force);
            highB = std::max(highB, force);
        } else if (t > end - 2 * kWindowS) {
            lowA = std::min(lowA, force);
            highA = std::max(highA, force);
        }
    }
    const double ripple = highB - lowB;
    const double allowed = 2.1 * k * d.encoderStepMm + b * d.encoderStepMm / d.velocityTauS + 1e-6;
    return ripple <= allowed && ripple <= 1.05 * (highA - lowA) + 1e-6;
}

bool stableInEveryHand(const DeviceFigures& d, double k, double b) {
    return std::all_of(kHands.begin(), kHands.end(), [&](const Hand& hand) { return stable(d, hand, k, b); });
}

}  // namespace

StableLimits limitsFor(const DeviceFigures& d, const core::Progress& progress) {
    const auto require = [](bool good, const char* what, double value) {
        if (!good || !std::isfinite(value))
            throw core::Error(fmt::format("{} is {}", what, value), "limits of a device", "correct it");
    };
    require(d.massKg > 0.001 && d.massKg <= 10.0, "the arm's mass [kg]", d.massKg);
    require(d.frictionN >= 0.0 && d.frictionN <= 10.0, "the arm's friction [N]", d.frictionN);
    require(d.delayS >= 0.0 && d.delayS <= 0.05, "the delay [s]", d.delayS);
    require(d.rateHz >= 100.0 && d.rateHz <= 20000.0, "the rate [Hz]", d.rateHz);
    require(d.encoderStepMm >= 0.0 && d.encoderStepMm <= 1.0, "the encoder step [mm]", d.encoderStepMm);
    require(d.maxForceN > 0.01 && d.maxForceN <= 1000.0, "the largest force [N]", d.maxForceN);
    require(d.velocityTauS > 1e-4 && d.velocityTauS <= 1.0, "the velocity's filter [s]", d.velocityTauS);

    StableLimits best;
    double done = 0.0;
    for (const double b : kDamping) {
        // Upwards until the first that is not: what lies beyond a gap is not relied on.
        double found = 0.0;
        for (double k = kSoftest; k <= kHardest && stableInEveryHand(d, k, b); k *= kStep)
            found = k;
        if (b == 0.0) best.withoutDampingNPerMm = kShare * found;
        if (found > best.foundNPerMm) {
            best.foundNPerMm = found;
            best.dampingNSPerMm = b;
        }
        core::report(progress, (done += 1.0) / static_cast<double>(kDamping.size()));
    }
    best.stiffnessNPerMm = kShare * best.foundNPerMm;
    return best;
}

}  // namespace handpiece::stability
