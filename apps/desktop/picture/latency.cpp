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

void LatencyMeter::presented(const Picture& picture, Clock::time_point at) {
    const double offset = offsetS();
    if (offset > 1e299) return;
    const double madeS = picture.timeS + offset;
    while (!waiting_.empty() && madeS >= seconds(waiting_.front()) + kMarginS) {
        const std::array<double, kLatencyStages.size() + 1> times{seconds(waiting_.front()), madeS,
                                                                  seconds(picture.seen),     seconds(picture.begun),
                                                                  seconds(picture.drawn),    seconds(at)};
        waiting_.pop_front();
        Answer answer{1e3 * (times.back() - times.front()), {}};
        for (std::size_t i = 0; i < kLatencyStages.size(); ++i)
            answer.stagesMs[i] = 1e3 * (times[i + 1] - times[i]);
        if (answers_.size() < kMaxKept)
            answers_.push_back(answer);
        else
            answers_[next_++ % kMaxKept] = answer;
    }
}

void LatencyMeter::reset() {
    *this = LatencyMeter{};
}

LatencyReport LatencyMeter::report() const {
    LatencyReport report;
    report.count = answers_.size();
    if (answers_.empty()) return report;
    std::vector<Answer> sorted = answers_;
    std::sort(sorted.begin(), sorted.end(), [](const Answer& a, const Answer& b) { return a.ms < b.ms; });
    const auto rank = [&](double share) {
        return static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1) + 0.5);
    };
    report.p50Ms = sorted[rank(0.5)].ms;
    report.p99Ms = sorted[rank(0.99)].ms;
    report.worstMs = sorted.back().ms;
    for (std::size_t i = 0; i < kLatencyStages.size(); ++i) {
        std::vector<double> stage;
        double slowest = 0.0;
        for (std::size_t k = 0; k < sorted.size(); ++k) {
            stage.push_back(sorted[k].stagesMs[i]);
            if (k >= rank(0.99)) slowest += stage.back();
        }
        std::sort(stage.begin(), stage.end());
        report.stages[i] = {stage[rank(0.5)], stage[rank(0.99)],
                            slowest / static_cast<double>(sorted.size() - rank(0.99))};
    }
    return report;
}

}  // namespace handpiece::desktop
