// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What stations show of the work that goes on at them: the last of each, in memory and nowhere else; and who looks.

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "school/wire.h"

namespace handpiece::school_server {

/// What a station showed last.
struct LiveWork {
    std::string station, stationName;
    school_wire::Live live;                           ///< its title is the server's own; its picture is below
    std::string personName;                           ///< as the books have it
    std::vector<std::string> classes;                 ///< whose teachers may watch
    school::Milliseconds captured = 0, received = 0;  ///< by the server's clock
    std::uint64_t sequence = 0;                       ///< grows with everything that any station shows
    std::shared_ptr<const std::string> picture{};

    enum class State { now, late, gone };
    [[nodiscard]] State state(school::Milliseconds now) const;
};

/// Any thread.
class LiveBoard {
  public:
    /// A station that sent nothing for so long is late, then gone: its picture is shown no more.
    static constexpr school::Milliseconds kLateMs = 6'000, kGoneMs = 15'000;
    /// Then it is forgotten, also who watched.
    static constexpr school::Milliseconds kForgottenMs = 120'000;
    /// Who asked so long ago watches no more.
    static constexpr school::Milliseconds kWatchesMs = 10'000;

    LiveBoard();
    void put(LiveWork shown);
    /// Nothing of it is there any more.
    void end(const std::string& station);
    /// Null: nothing.
    [[nodiscard]] std::shared_ptr<const LiveWork> of(const std::string& station, school::Milliseconds now);
    /// By the names of their stations.
    [[nodiscard]] std::vector<std::shared_ptr<const LiveWork>> inClass(const std::string& schoolClass,
                                                                       school::Milliseconds now);

    /// `code` is shown what there is. `closely`: this station alone. True: they begin to watch this person.
    bool watch(const std::string& code, const school_wire::Watcher& who, const LiveWork& shown, bool closely,
               school::Milliseconds now);
    [[nodiscard]] school_wire::Watched watched(const std::string& station, school::Milliseconds now);

  private:
    struct Look {
        school_wire::Watcher who;
        std::string person;
        school::Milliseconds at = 0, closelyAt = 0;
    };
    void forget(school::Milliseconds now);

    std::mutex mutex_;
    std::uint64_t sequence_;  ///< also after a new start greater than any that a browser has
    std::map<std::string, std::shared_ptr<const LiveWork>> shown_;
    std::map<std::pair<std::string, std::string>, Look> looks_;  ///< by station and who
};

}  // namespace handpiece::school_server
