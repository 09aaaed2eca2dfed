// SPDX-License-Identifier: Apache-2.0
// Figures out of a recording; nothing is judged here.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "handpiece/base/rt/second.h"
#include "handpiece/devices/fidelity/recording.h"

namespace handpiece::fidelity {
namespace {
using rt::kNsPerS;
constexpr double kBeforeS = 0.010, kAfterS = 0.030;  // of a pulse, that are looked at
constexpr double kMinSteps = 1.5, kMaxSteps = 60.0;
constexpr double kMinPathSteps = 5.0;                           // a pulse that moves the arm less says nothing of time
constexpr double kGoodErrorS = 0.001, kStraightErrorS = 0.001;  // the latter: what bending takes off a straight line
constexpr double kMovedMm = 1.0, kWindowS = 0.05;
constexpr std::size_t kMinPoints = 4, kMinChanges = 20;

double seconds(std::int64_t from, std::int64_t to) {
    return static_cast<double>(to - from) / kNsPerS;
}

/// Square root of the way against time since the force was sent: a straight line while the force alone accelerates.
struct Point {
    double timeS, root;
};

struct Response {
    std::vector<Point> points;
    double pathMm = 0.0;
};

std::optional<Response> responseOf(const Recording& recording, const Pulse& pulse, double stepMm) {
    const auto& frames = recording.frames;
    const auto at = std::lower_bound(frames.begin(), frames.end(), pulse.commandedNs,
                                     [](const FrameRecord& f, std::int64_t ns) { return f.atNs < ns; });
    // Sent: half of the step has left the gate.
    const double half = 0.5 * (pulse.fromN + pulse.toN);
    auto sent = at;
    while (sent != frames.end() && sent->sentN[1] < half && seconds(pulse.commandedNs, sent->atNs) < kAfterS)
        ++sent;
    if (sent == frames.end() || sent->sentN[1] < half) return std::nullopt;
    double before = 0.0;
    int count = 0;
    for (auto f = sent; f != frames.begin() && seconds(f->atNs, sent->atNs) < kBeforeS; --f) {
        before += f->positionMm[1];
        ++count;
    }
    if (count == 0) return std::nullopt;
    before /= count;
    Response response;
    double furthest = 0.0;
    for (auto f = sent; f != frames.end() && seconds(sent->atNs, f->readNs) < kAfterS; ++f) {
        const double way = f->positionMm[1] - before;
        response.pathMm = std::max(response.pathMm, way);
        // Only on the way up, and before the force ends.
        if (way < furthest) continue;
        furthest = way;
        if (way >= kMinSteps * stepMm && way <= kMaxSteps * stepMm)
            response.points.push_back({seconds(sent->atNs, f->readNs), std::sqrt(way)});
    }
    return response;
}

/// When the way was zero: t = d + p s (+ q s^2) through all points, s the root of the way. The square is what damping
/// and the hand's spring bend; coarse encoders do not carry it.
std::optional<double> onsetOf(const std::vector<Response>& responses, std::size_t without, bool bent) {
    std::size_t n = 0;
    for (std::size_t i = 0; i < responses.size(); ++i)
        if (i != without) n += responses[i].points.size();
    if (n < kMinPoints) return std::nullopt;
    Eigen::MatrixXd a(static_cast<Eigen::Index>(n), bent ? 3 : 2);
    Eigen::VectorXd b(static_cast<Eigen::Index>(n));
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < responses.size(); ++i) {
        if (i == without) continue;
        for (const Point& p : responses[i].points) {
            a(row, 0) = 1.0;
            a(row, 1) = p.root;
            if (bent) a(row, 2) = p.root * p.root;
            b[row++] = p.timeS;
        }
    }
    const Eigen::VectorXd x = a.colPivHouseholderQr().solve(b);
    return x.allFinite() ? std::optional(x[0]) : std::nullopt;
}

/// The onset with twice its standard error, by leaving out one pulse after the other (jackknife).
struct Fitted {
    bool any = false;
    double onsetS = 0.0, errorS = 0.0;
};
Fitted fitted(const std::vector<Response>& responses, bool bent) {
    const auto all = onsetOf(responses, responses.size(), bent);
    if (!all) return {};
    const double n = static_cast<double>(responses.size());
    double square = 0.0;
    for (std::size_t i = 0; i < responses.size(); ++i)
        if (const auto without = onsetOf(responses, i, bent)) square += (*without - *all) * (*without - *all);
    return {true, *all, 2.0 * std::sqrt((n - 1.0) / n * square)};
}

}  // namespace

Quantiles quantilesOf(std::vector<double> values) {
    Quantiles q;
    if (values.empty()) return q;
    std::sort(values.begin(), values.end());
    const auto at = [&](double share) {
        return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
    };
    q = {at(0.5), at(0.99), at(0.999), values.back()};
    return q;
}

Rest restOf(const Recording& recording) {
    Rest rest;
    const auto& frames = recording.frames;
    const double restS = recording.plan.restS;
    std::vector<double> changes;
    double noise2 = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        double least = 0.0, most = 0.0, sum = 0.0, squares = 0.0, total2 = 0.0;
        std::size_t inWindow = 0, windows = 0;
        std::int64_t windowNs = recording.startNs;
        for (std::size_t i = 0; i < frames.size(); ++i) {
            const double x = frames[i].positionMm[axis];
            if (i > 0 && x != frames[i - 1].positionMm[axis])
                changes.push_back(std::abs(x - frames[i - 1].positionMm[axis]));
            if (seconds(recording.startNs, frames[i].atNs) > restS) continue;
            if (i == 0) least = most = x;
            least = std::min(least, x);
            most = std::max(most, x);
            const double y = x - frames[0].positionMm[axis];  // small: squares keep their digits
            if (seconds(windowNs, frames[i].atNs) > kWindowS && inWindow > 1) {
                const double n = static_cast<double>(inWindow);
                total2 += std::max(0.0, squares / n - (sum / n) * (sum / n));
                ++windows;
                sum = squares = 0.0;
                inWindow = 0;
                windowNs = frames[i].atNs;
            }
            sum += y;
            squares += y * y;
            ++inWindow;
        }
        if (windows > 0) noise2 = std::max(noise2, total2 / static_cast<double>(windows));
        rest.moved = rest.moved || most - least > kMovedMm;
    }
    rest.noiseMm = std::sqrt(noise2);
    if (changes.size() >= kMinChanges) {
        std::sort(changes.begin(), changes.end());
        rest.stepMm = changes[changes.size() / 50];
    }
    return rest;
}

Delay roundTripOf(const Recording& recording) {
    Delay delay;
    if (!recording.info.pushes) {
        delay.why = config::phrase("fidelity.unmeasured-cannot-push");
        return delay;
    }
    if (recording.pulses.empty()) {
        delay.why = config::phrase("fidelity.unmeasured-was-not-to-push");
        return delay;
    }
    const double told = recording.info.capability.encoderStepMm, seen = restOf(recording).stepMm;
    const double stepMm = std::max({told, std::min(seen, 1.0), 1e-4});
    std::vector<Response> responses;
    for (const Pulse& pulse : recording.pulses)
        if (auto response = responseOf(recording, pulse, stepMm)) responses.push_back(std::move(*response));
    std::vector<double> paths;
    for (const Response& r : responses)
        paths.push_back(r.pathMm);
    delay.pathMm = quantilesOf(paths).p50;
    if (responses.size() < 3 || delay.pathMm < kMinPathSteps * stepMm) {
        delay.why = config::phrase("fidelity.unmeasured-path", fmt::format("{:.3f}", delay.pathMm),
                                   fmt::format("{:.0f}", kMinPathSteps));
        return delay;
    }
    const Fitted bent = fitted(responses, true), straight = fitted(responses, false);
    if (!straight.any) {
        delay.why = config::phrase("fidelity.unmeasured-few-frames");
        return delay;
    }
    const bool useBent = bent.any && bent.errorS < kGoodErrorS;
    const double frameS = 1.0 / std::max(recording.info.servoHz, 1.0);
    delay.seconds = std::max(0.0, useBent ? bent.onsetS : straight.onsetS);
    delay.uncertaintyS = 0.5 * frameS + (useBent ? bent.errorS : straight.errorS + kStraightErrorS);
    delay.measured = true;
    return delay;
}

}  // namespace handpiece::fidelity
