// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/people/throttle.h"

#include <algorithm>

namespace handpiece::school {
namespace {
constexpr std::int64_t kLongestMs = 900'000;
}  // namespace

std::int64_t waitAfterFailures(int failures, int free) {
    if (failures < free) return 0;
    const int doubled = std::min(failures - free + 1, 20);
    return std::min(kLongestMs, std::int64_t{1000} << doubled);
}

std::int64_t Throttle::waitMs(const std::string& key, std::int64_t now, int free) const {
    const auto found = failures_.find(key);
    if (found == failures_.end()) return 0;
    const std::int64_t wait = waitAfterFailures(found->second.count, free), since = now - found->second.last;
    return since < 0 ? wait : std::max<std::int64_t>(0, wait - since);
}

void Throttle::failed(const std::string& key, std::int64_t now) {
    Failures& mine = failures_[key];
    if (now - mine.last > kForgottenMs) mine.count = 0;
    mine.count = std::min(mine.count + 1, 1000);
    mine.last = now;
    if (failures_.size() <= kMostKeys) return;
    const auto oldest = std::min_element(failures_.begin(), failures_.end(),
                                         [](const auto& a, const auto& b) { return a.second.last < b.second.last; });
    failures_.erase(oldest);
}

void Throttle::succeeded(const std::string& key) {
    failures_.erase(key);
}

void Throttle::takenBack(const std::string& key) {
    if (const auto found = failures_.find(key); found != failures_.end() && --found->second.count <= 0)
        failures_.erase(found);
}

}  // namespace handpiece::school
