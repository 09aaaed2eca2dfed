// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A station at its school, for as long as its window is open: shows the work that goes on where it may be watched, and
/// pushes what was finished. Nobody waits for it.

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "school/station.h"

namespace handpiece::school_station {

/// How it stands, for the window.
struct Standing {
    bool isConnected = false;
    std::size_t waiting = 0;                       ///< things that the server has not heard of
    bool isShown = false;                          ///< the server has the work that goes on
    std::vector<school_wire::Watcher> watchers{};  ///< who looks at it
    bool closely = false;                          ///< at this station alone
    std::vector<std::string> assigned{};           ///< hashes of the exercises that the person has to do now
    std::string trouble{};                         ///< why it is not connected, or not shown
    friend bool operator==(const Standing&, const Standing&) = default;
};
/// One line, without its end.
[[nodiscard]] std::string toJson(const Standing& standing);

struct StationFolders {
    std::filesystem::path home;      ///< with school.json and results.db
    std::filesystem::path sessions;  ///< recordings
};

/// Two threads of its own, one for what is live and one for what is kept. `tell` is called from both, one at a time,
/// when something is otherwise than told before.
class StationService {
  public:
    using Clock = std::chrono::steady_clock;
    /// Throws core::Error "not-enrolled".
    StationService(StationFolders folders, std::function<void(const Standing&)> tell,
                   std::chrono::milliseconds pushPause = std::chrono::minutes(3));
    /// Waits for what is on its way.
    ~StationService();
    StationService(const StationService&) = delete;
    StationService& operator=(const StationService&) = delete;

    /// The latest counts: what was not sent yet is left out. Person and assignment are filled in here.
    void show(school_wire::Live live);
    /// Nothing goes on that may be watched.
    void rest();
    /// Now, and again every `pushPause`.
    void push();

  private:
    void loopLive();
    void loopPush();
    [[nodiscard]] std::string assignmentOf(const std::string& exerciseHash);
    void tell(const std::function<void(Standing&)>& change);

    const StationFolders folders_;
    const std::function<void(const Standing&)> tell_;
    const std::chrono::milliseconds pushPause_;
    const Enrolment enrolment_;

    std::mutex mutex_;
    std::condition_variable wake_;
    bool ends_ = false, wantsPush_ = true, wantsRest_ = false;
    std::optional<school_wire::Live> live_;
    Clock::time_point liveAt_;
    std::vector<school_wire::Task> tasks_;

    std::mutex telling_;
    Standing standing_;
    bool wasTold_ = false;
    std::thread liveThread_, pushThread_;
};

}  // namespace handpiece::school_station
