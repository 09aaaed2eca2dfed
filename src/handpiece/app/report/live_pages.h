// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What goes on at a class's stations, as a page: a tile each, and one station large. apps/web/live keeps it up.

#include <cstdint>
#include <string>
#include <vector>

#include "handpiece/app/report/school_pages.h"

namespace handpiece::report {

/// A station as somebody may see it.
struct LiveTile {
    enum class State { now, late, gone };
    std::string station;      ///< 32 hexadecimal digits
    std::string stationName;  ///< "chair 3"
    std::string person;       ///< name, or code
    std::string exercise;
    double elapsedS = 0.0, removedMm3 = 0.0;
    std::vector<std::string> flags{};  ///< "pulp-exposed", ...
    bool isShared = false;             ///< practice that its student shares
    std::int64_t ageMs = 0;            ///< of the picture
    State state = State::now;
    std::uint64_t sequence = 0;
};
[[nodiscard]] const char* nameOf(LiveTile::State state);
/// In the program's language.
[[nodiscard]] std::string liveFlagWord(const std::string& flag);
/// What stands under a picture, as HTML.
[[nodiscard]] std::string liveFigures(const LiveTile& tile);

[[nodiscard]] std::string liveClassPage(const Looker& who, const school::SchoolClass& schoolClass,
                                        const std::vector<LiveTile>& tiles);
[[nodiscard]] std::string liveStationPage(const Looker& who, const LiveTile& tile, const std::string& schoolClass);

}  // namespace handpiece::report
