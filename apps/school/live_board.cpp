// SPDX-License-Identifier: Apache-2.0
#include "school/live_board.h"

#include <algorithm>
#include <chrono>
#include <tuple>

namespace handpiece::school_server {

using school::Milliseconds;

namespace {

/// "chair 2" comes before "chair 10": numbers are written as long as the longest.
std::string inOrder(const std::string& name) {
    constexpr std::size_t kDigits = 12;
    std::string key;
    for (std::size_t i = 0; i < name.size();) {
        std::size_t end = i;
        while (end < name.size() && name[end] >= '0' && name[end] <= '9')
            ++end;
        if (end > i)
            key += std::string(kDigits - std::min(kDigits, end - i), '0') + name.substr(i, end - i);
        else
            key += name[end++];
        i = end;
    }
    return key;
}

}  // namespace

LiveWork::State LiveWork::state(Milliseconds now) const {
    const Milliseconds age = now - received;
    return age > LiveBoard::kGoneMs ? State::gone : age > LiveBoard::kLateMs ? State::late : State::now;
}

LiveBoard::LiveBoard()
    : sequence_(static_cast<std::uint64_t>(
          std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch())
              .count())) {}

void LiveBoard::put(LiveWork shown) {
    const std::lock_guard lock(mutex_);
    shown.sequence = ++sequence_;
    const std::string station = shown.station;
    shown_[station] = std::make_shared<const LiveWork>(std::move(shown));
}

void LiveBoard::end(const std::string& station) {
    const std::lock_guard lock(mutex_);
    shown_.erase(station);
}

std::shared_ptr<const LiveWork> LiveBoard::of(const std::string& station, Milliseconds now) {
    const std::lock_guard lock(mutex_);
    forget(now);
    const auto found = shown_.find(station);
    return found != shown_.end() ? found->second : nullptr;
}

std::vector<std::shared_ptr<const LiveWork>> LiveBoard::inClass(const std::string& schoolClass, Milliseconds now) {
    std::vector<std::shared_ptr<const LiveWork>> all;
    {
        const std::lock_guard lock(mutex_);
        forget(now);
        for (const auto& [station, shown] : shown_)
            if (std::find(shown->classes.begin(), shown->classes.end(), schoolClass) != shown->classes.end())
                all.push_back(shown);
    }
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
        const auto key = [](const LiveWork& w) { return std::make_tuple(inOrder(w.stationName), w.station); };
        return key(*a) < key(*b);
    });
    return all;
}

bool LiveBoard::watch(const std::string& code, const school_wire::Watcher& who, const LiveWork& shown, bool closely,
                      Milliseconds now) {
    const std::lock_guard lock(mutex_);
    const auto [at, isNew] = looks_.try_emplace({shown.station, code});
    Look& look = at->second;
    const bool begins = isNew || look.person != shown.live.person;
    look.who = who, look.person = shown.live.person, look.at = now;
    if (closely) look.closelyAt = now;
    return begins;
}

school_wire::Watched LiveBoard::watched(const std::string& station, Milliseconds now) {
    school_wire::Watched watched;
    const std::lock_guard lock(mutex_);
    for (auto at = looks_.lower_bound({station, {}}); at != looks_.end() && at->first.first == station; ++at) {
        if (now - at->second.at > kWatchesMs) continue;
        watched.by.push_back(at->second.who);
        watched.closely |= at->second.closelyAt > 0 && now - at->second.closelyAt <= kWatchesMs;
    }
    return watched;
}

void LiveBoard::forget(Milliseconds now) {
    std::erase_if(shown_, [&](const auto& one) { return now - one.second->received > kForgottenMs; });
    std::erase_if(looks_, [&](const auto& one) { return now - one.second.at > kForgottenMs; });
    for (auto& [station, shown] : shown_)
        if (shown->picture && shown->state(now) == LiveWork::State::gone) {
            auto without = std::make_shared<LiveWork>(*shown);
            without->picture.reset();
            shown = std::move(without);
        }
}

}  // namespace handpiece::school_server
