// SPDX-License-Identifier: Apache-2.0
#include "desktop/picture/latency.h"

#include <algorithm>

namespace handpiece::desktop {

namespace {

constexpr auto kWindow = std::chrono::seconds(2);
constexpr std::size_t kMaxWaiting = 1024;

double seconds(LatencyMeter::Clock::time_point at) {
    return std::chrono::duration<double>(at.time_since_epoch()).count();
}

}  // namespace

void LatencyMeter::target(Clock::time_point at) {
    if (waiting_.size() < kMaxWaiting) waiting_.push_back(at);
}

void LatencyMeter::sampleSeen(double timeS, Clock::time_point at) {
    if (now_.offsetS > 1e299) now_.since = at;
    if (at - now_.since > kWindow) {
        before_ = now_;
        now_ = Window{1e300, at};
    }
    now_.offsetS = std::min(now_.offsetS, seconds(at) - timeS);
}

double LatencyMeter::offsetS() const {
    return std::min(now_.offsetS, before_.offsetS);
}

void LatencyMeter::presented(double timeS, Clock::time_point at) {
    const double offset = offsetS();
    if (offset > 1e299) return;
    while (!waiting_.empty() && timeS + offset >= seconds(waiting_.front()) + kMarginS) {
        const double tookMs = std::chrono::duration<double, std::milli>(at - waiting_.front()).count();
        waiting_.pop_front();
        if (ms_.size() < kMaxKept)
            ms_.push_back(tookMs);
        else
            ms_[next_++ % kMaxKept] = tookMs;
    }
}

void LatencyMeter::reset() {
    *this = LatencyMeter{};
}

LatencyReport LatencyMeter::report() const {
    LatencyReport report;
    report.count = ms_.size();
    if (ms_.empty()) return report;
    std::vector<double> sorted = ms_;
    std::sort(sorted.begin(), sorted.end());
    const auto at = [&](double share) {
        return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1) + 0.5)];
    };
    report.p50Ms = at(0.5);
    report.p99Ms = at(0.99);
    report.worstMs = sorted.back();
    return report;
}

}  // namespace handpiece::desktop
