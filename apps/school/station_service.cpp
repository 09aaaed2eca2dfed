// SPDX-License-Identifier: Apache-2.0
#include "school/station_service.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/error.h"
#include "school/line.h"

namespace handpiece::school_station {
namespace {

using namespace std::chrono_literals;

/// What is live is worth nothing later.
constexpr auto kLivePatience = 5s;
/// After the server did not answer: first so long, then twice that, and so on.
constexpr auto kFirstPause = 2s, kLongestPause = 30s;

}  // namespace

std::string toJson(const Standing& s) {
    nlohmann::ordered_json watchers = nlohmann::ordered_json::array();
    for (const school_wire::Watcher& one : s.watchers)
        watchers.push_back({{"name", one.name}, {"role", one.role}});
    return nlohmann::ordered_json{{"connected", s.isConnected}, {"waiting", s.waiting},
                                  {"shown", s.isShown},         {"watchers", std::move(watchers)},
                                  {"closely", s.closely},       {"assigned", s.assigned},
                                  {"trouble", s.trouble}}
        .dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

StationService::StationService(StationFolders folders, std::function<void(const Standing&)> tell,
                               std::chrono::milliseconds pushPause)
    : folders_(std::move(folders)),
      tell_(std::move(tell)),
      pushPause_(pushPause),
      enrolment_(readEnrolment(folders_.home / "school.json")) {
    liveThread_ = std::thread([this] { loopLive(); });
    pushThread_ = std::thread([this] { loopPush(); });
}

StationService::~StationService() {
    {
        const std::lock_guard lock(mutex_);
        ends_ = true;
    }
    wake_.notify_all();
    liveThread_.join();
    pushThread_.join();
}

void StationService::show(school_wire::Live live) {
    {
        const std::lock_guard lock(mutex_);
        live_ = std::move(live);
        liveAt_ = Clock::now();
        wantsRest_ = false;
    }
    wake_.notify_all();
}

void StationService::rest() {
    {
        const std::lock_guard lock(mutex_);
        live_.reset();
        wantsRest_ = true;
    }
    wake_.notify_all();
}

void StationService::push() {
    {
        const std::lock_guard lock(mutex_);
        wantsPush_ = true;
    }
    wake_.notify_all();
}

/// As the server gave it to do; empty: practice. The server looks again, by its own clock.
std::string StationService::assignmentOf(const std::string& exerciseHash) {
    const school::Milliseconds now = clockNow();
    const std::lock_guard lock(mutex_);
    for (const school_wire::Task& t : tasks_)
        if (t.exerciseHash == exerciseHash && now >= t.opens && now <= t.closes) return t.assignment;
    return {};
}

void StationService::tell(const std::function<void(Standing&)>& change) {
    const std::lock_guard lock(telling_);
    const Standing before = standing_;
    change(standing_);
    if (wasTold_ && standing_ == before) return;
    wasTold_ = true;
    tell_(standing_);
}

void StationService::loopLive() {
    std::optional<Line> line;
    std::chrono::milliseconds pause = 0ms;
    for (;;) {
        std::optional<school_wire::Live> live;
        Clock::time_point at;
        {
            std::unique_lock lock(mutex_);
            if (pause > 0ms) wake_.wait_for(lock, pause, [this] { return ends_; });
            wake_.wait(lock, [this] { return ends_ || live_ || wantsRest_; });
            if (ends_) return;
            live = std::exchange(live_, {});
            wantsRest_ = false;
            at = liveAt_;
        }
        try {
            if (!line) line.emplace(enrolment_.server, enrolment_.key, kLivePatience);
            if (!live) {
                (void)line->post("/api/v1/live/end", "{}");
                tell([](Standing& s) { s.isShown = s.closely = false, s.watchers.clear(); });
                continue;
            }
            live->person = enrolment_.person;
            live->assignment = assignmentOf(live->exerciseHash);
            live->ageMs += std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - at).count();
            const school_wire::Watched watched =
                school_wire::watchedFrom(line->put("/api/v1/live", school_wire::toBytes(*live)));
            pause = 0ms;
            tell([&](Standing& s) {
                s.isConnected = s.isShown = true, s.trouble.clear();
                s.watchers = watched.by, s.closely = watched.closely;
            });
        } catch (const std::exception& thrown) {
            const core::Error e = core::asError(thrown);
            const bool isSilent = e.id() == "server-silent";
            if (isSilent) line.reset();
            pause = isSilent ? std::clamp<std::chrono::milliseconds>(2 * pause, kFirstPause, kLongestPause)
                             : std::chrono::milliseconds(kFirstPause);
            tell([&](Standing& s) {
                s.isShown = s.closely = false, s.watchers.clear();
                if (isSilent) s.isConnected = false;
                s.trouble = e.problem();
            });
        }
    }
}

void StationService::loopPush() {
    std::chrono::milliseconds pause = 0ms;
    Enrolment enrolment = enrolment_;
    const std::filesystem::path file = folders_.home / "school.json";
    for (;;) {
        {
            std::unique_lock lock(mutex_);
            wake_.wait_for(lock, pause > 0ms ? pause : pushPause_, [this] { return ends_ || wantsPush_; });
            if (ends_) return;
            wantsPush_ = false;
        }
        try {
            // Somebody may have pushed by hand.
            enrolment.sent = std::max(enrolment.sent, readEnrolment(file).sent);
            std::optional<school::Store> store;
            if (std::filesystem::is_regular_file(folders_.home / "results.db"))
                store.emplace(folders_.home / "results.db");
            if (store) tell([&](Standing& s) { s.waiting = waitingIn(*store, enrolment); });
            std::vector<school_wire::Task> tasks = tasksOf(enrolment);
            std::vector<std::string> assigned;
            for (const school_wire::Task& t : tasks)
                if (clockNow() >= t.opens && clockNow() <= t.closes) assigned.push_back(t.exerciseHash);
            {
                const std::lock_guard lock(mutex_);
                tasks_ = std::move(tasks);
            }
            tell([&](Standing& s) { s.isConnected = true, s.assigned = assigned; });
            Pushed pushed;
            if (store)
                pushed = school_station::push(*store, folders_.sessions, enrolment, file, [this](double) {
                    const std::lock_guard lock(mutex_);
                    return !ends_;
                });
            tell([&](Standing& s) {
                s.waiting = store ? waitingIn(*store, enrolment) : 0;
                s.trouble = pushed.refused.empty() ? std::string() : pushed.refused.back();
            });
            pause = 0ms;
        } catch (const std::exception& thrown) {
            const core::Error e = core::asError(thrown);
            if (e.problem() == "cancelled") continue;
            pause = std::clamp<std::chrono::milliseconds>(2 * pause, kFirstPause, kLongestPause);
            tell([&](Standing& s) { s.isConnected = false, s.trouble = e.what(); });
        }
    }
}

}  // namespace handpiece::school_station
