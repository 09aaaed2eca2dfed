// SPDX-License-Identifier: Apache-2.0
#include "handpiece/record/session/record.h"

#include <algorithm>
#include <cmath>

namespace handpiece::session {
namespace {

std::int32_t stepsOf(double value, double step) noexcept {
    const double steps = std::nearbyint(value / step);
    constexpr double kMost = std::numeric_limits<std::int32_t>::max();
    return std::abs(steps) <= kMost ? static_cast<std::int32_t>(steps) : kNoNumber;  // also NaN
}

double valueOf(std::int32_t steps, double step) noexcept {
    return steps == kNoNumber ? std::numeric_limits<double>::quiet_NaN() : steps * step;
}

/// Nearest multiple of a power of two: the bits below it are zero and pack to nothing.
float rounded(double value, double step) noexcept {
    const auto result = static_cast<float>(std::nearbyint(value / step) * step);
    return result == 0.0f ? 0.0f : result;  // no minus zero: it would not pack with its neighbours
}

/// Root of 2^60 - x2 - y2 - z2 rounded down, in whole numbers: the same on every machine. 0 beyond unit length.
std::int64_t expectedW(const std::array<std::int32_t, 3>& xyz) noexcept {
    constexpr std::uint64_t kOne = std::uint64_t{1} << 60;
    std::uint64_t sum = 0;
    for (const std::int64_t c : xyz)
        sum += static_cast<std::uint64_t>(c * c);
    if (sum >= kOne) return 0;
    const std::uint64_t rest = kOne - sum;
    auto root = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(rest)));
    while (root * root > rest)
        --root;
    while ((root + 1) * (root + 1) <= rest)
        ++root;
    return static_cast<std::int64_t>(root);
}

constexpr double kVelocityStep = 0x1p-4, kForceStep = 0x1p-10, kTorqueStep = 0x1p-6, kDepthStep = 0x1p-13,
                 kSpeedStep = 4.0, kLoadTorqueStep = 0x1p-10, kFeedStep = 0x1p-8, kVolumeStep = 0x1p-16;

}  // namespace

std::int32_t wCodeOf(const std::array<std::int32_t, 3>& xyz, std::int32_t w) noexcept {
    if (w == kNoNumber) return kNoNumber;
    const std::int64_t code = 2 * (std::abs(std::int64_t{w}) - expectedW(xyz)) + (w < 0);
    constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
    return std::abs(code) <= kMost ? static_cast<std::int32_t>(code) : kNoNumber;
}

std::int32_t wOf(const std::array<std::int32_t, 3>& xyz, std::int32_t code) noexcept {
    if (code == kNoNumber) return kNoNumber;
    const bool negative = (code & 1) != 0;
    const std::int64_t size = expectedW(xyz) + (std::int64_t{code} - negative) / 2;
    const std::int64_t w = negative ? -size : size;
    return std::abs(w) <= std::numeric_limits<std::int32_t>::max() ? static_cast<std::int32_t>(w) : kNoNumber;
}

Record recordOf(const messages::HapticSample& s) noexcept {
    Record r;
    r.tick = s.tick;
    r.lastCommand = s.lastCommand;
    static_assert(std::tuple_size_v<decltype(s.removedMm3)> == cases::kTissueCount);
    for (std::size_t i = 0; i < r.removedMm3.size(); ++i)
        r.removedMm3[i] = std::nearbyint(s.removedMm3[i] / kVolumeStep) * kVolumeStep;
    r.removedOthersMm3 = std::nearbyint(s.removedOthersMm3 / kVolumeStep) * kVolumeStep;
    for (std::size_t i = 0; i < 3; ++i) {
        r.position[i] = stepsOf(s.positionMm[i], kPositionStepMm);
        r.velocityMmS[i] = rounded(s.velocityMmS[i], kVelocityStep);
        r.forceN[i] = rounded(s.forceN[i], kForceStep);
        r.torqueNmm[i] = rounded(s.torqueNmm[i], kTorqueStep);
    }
    for (std::size_t i = 0; i < 3; ++i)
        r.orientation[i] = stepsOf(s.orientation[i + 1], kOrientationStep);
    r.orientationW = wCodeOf(r.orientation, stepsOf(s.orientation[0], kOrientationStep));
    r.pedal = stepsOf(s.pedal, kPedalStep);
    r.depthMm = rounded(s.depthMm, kDepthStep);
    r.speedRpm = rounded(s.speedRpm, kSpeedStep);
    r.loadTorqueNmm = rounded(s.loadTorqueNmm, kLoadTorqueStep);
    r.feedMmS = rounded(s.feedMmS, kFeedStep);
    r.buttons = s.buttons;
    r.flags = s.flags;
    r.elapsedPeriods = static_cast<std::uint16_t>(std::clamp(s.elapsedPeriods, 0, 65535));
    r.tissue = s.tissue;
    r.tooth = static_cast<std::uint8_t>(s.tooth);
    return r;
}

Inputs inputsOf(const Record& r) noexcept {
    Inputs in;
    for (std::size_t i = 0; i < 3; ++i)
        in.positionMm[i] = valueOf(r.position[i], kPositionStepMm);
    for (std::size_t i = 0; i < 3; ++i)
        in.orientation[i + 1] = valueOf(r.orientation[i], kOrientationStep);
    in.orientation[0] = valueOf(wOf(r.orientation, r.orientationW), kOrientationStep);
    in.pedal = valueOf(r.pedal, kPedalStep);
    in.buttons = r.buttons;
    return in;
}

std::string_view nameOf(EventName name) noexcept {
    static constexpr std::array<std::string_view, kEventNameCount> kNames{
        "stroke begin", "stroke end",  "bur change",   "first dentine", "pulp exposure", "neighbour touched",
        "stall",        "force limit", "undo",         "redo",          "reset",         "parameter change",
        "fault",        "key frame",   "end",          "resume",        "scheduling",    "gingiva cut",
        "head touched", "working way", "neighbour cut"};
    return kNames[static_cast<std::size_t>(name)];
}

}  // namespace handpiece::session
