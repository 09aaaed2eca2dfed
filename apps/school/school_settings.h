// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where a school's server lies and listens: from the command line, else the environment, else a file, else as built.
/// docs/school-office.md#settings.

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/school/store/books.h"

namespace handpiece::school_cli {

/// What was given; empty: not.
struct SchoolSettings {
    std::string file{};  ///< where the rest stands (TOML)
    std::string data{}, database{}, listen{}, certificate{}, key{};
    std::string address{};                       ///< as browsers know it
    std::vector<std::string> proxies{};          ///< addresses of proxies whose X-Forwarded-For is believed
    std::vector<std::string> signOnProxies{};    ///< addresses of proxies that vouch for who logs in
    std::string signOnSecret{}, signOnHeader{};  ///< file with what they know; in which they name who logs in
    std::optional<std::size_t> workers{}, connections{};
    std::optional<bool> ownStationsOnly{};  ///< class work of stations that are a person's own alone
};
inline constexpr std::size_t kMostWorkers = 64, kMostConnections = 1000;

/// A variable of the environment; null where it is not set.
using Environment = std::function<const char*(const char*)>;
[[nodiscard]] Environment ownEnvironment();

/// All of it: what `given` leaves out from HANDPIECE_SCHOOL_DATA, _DATABASE, _LISTEN, _CERTIFICATE, _KEY, _WORKERS,
/// _CONNECTIONS, _OWN_STATIONS_ONLY (yes or no), _ADDRESS, _SIGN_ON_PROXIES (with commas), _SIGN_ON_SECRET,
/// _SIGN_ON_HEADER, then from the file that `given`, HANDPIECE_SCHOOL_SETTINGS or the system names (`systemFile`, where
/// it is there). Throws core::Error: a file that cannot be read, a key that is none, a value that is none (which,
/// where).
[[nodiscard]] SchoolSettings settled(SchoolSettings given, const Environment& environment,
                                     const std::string& systemFile = "/etc/handpiece-school/settings.toml");

/// Of this process, for a command that opens the books: data and database are not empty where they have to be.
/// Throws as settled(), and for root where the folder is another's: what root makes there its server cannot use.
[[nodiscard]] SchoolSettings placeOfBooks(const std::string& data, const std::string& database);

/// Of a command on the server's machine, at this moment.
[[nodiscard]] school::Act now();

}  // namespace handpiece::school_cli
