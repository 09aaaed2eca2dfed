// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/simulation/tick_statistics.h"

#include <algorithm>
#include <numeric>

namespace handpiece::simulation {

TickStatistics::TickStatistics(double rateHz)
    : periodUs_(1e6 / rateHz),
      tenSeconds_(static_cast<std::size_t>(10.0 * rateHz)),
      oneSecond_(static_cast<std::size_t>(rateHz)) {}

void TickStatistics::Ring::add(float value, std::size_t most) {
    if (values.size() < most)
        values.push_back(value);
    else
        values[next] = value;
    next = (next + 1) % most;
}

void TickStatistics::take(const messages::HapticSample& sample) {
    ++ticks_;
    late_ += static_cast<double>(sample.lateUs) + static_cast<double>(sample.workUs) > periodUs_;
    missed_ += static_cast<std::uint64_t>(sample.elapsedPeriods - 1);
    timeS_ = sample.timeS;
    workUs_.add(sample.workUs, tenSeconds_);
    allWorkUs_.add(sample.workUs);
    allLateUs_.add(sample.lateUs);
    lateUs_.add(sample.lateUs, tenSeconds_);
    busyUs_.add(sample.workUs + sample.cutUs, oneSecond_);
}

loop::Spread TickStatistics::spreadOf(std::vector<float> values) {
    if (values.empty()) return {};
    const auto at = [&](double share) {
        const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
        std::nth_element(values.begin(), place, values.end());
        return static_cast<double>(*place);
    };
    return {at(0.5), at(0.99), at(0.999), at(1.0)};
}

void TickStatistics::fill(LiveSessionStatus& status) const {
    status.timeS = timeS_;
    status.ticks = ticks_;
    status.lateTicks = late_;
    status.missedPeriods = missed_;
    status.workUs = spreadOf(workUs_.values);
    status.latenessUs = spreadOf(lateUs_.values);
    const double busy = std::accumulate(busyUs_.values.begin(), busyUs_.values.end(), 0.0);
    status.load = busyUs_.values.empty() ? 0.0 : busy / (periodUs_ * static_cast<double>(busyUs_.values.size()));
}

void TickStatistics::fillAll(LiveSessionStatus& status) const {
    const auto spread = [](const Histogram& all) {
        return loop::Spread{all.at(0.5), all.at(0.99), all.at(0.999), all.most()};
    };
    status.allWorkUs = spread(allWorkUs_);
    status.allLatenessUs = spread(allLateUs_);
}

}  // namespace handpiece::simulation
