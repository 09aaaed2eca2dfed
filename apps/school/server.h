// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A school's server: what stations push goes into its books, is cut again, and scored. The one place that speaks HTTP.
/// docs/school.md.

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "handpiece/school/store/books.h"
#include "school/wire.h"

namespace handpiece::school_server {

/// Log-ins that a proxy vouches for, which speaks OpenID Connect: at /sign-on, in a header.
struct SignOn {
    std::vector<std::string> proxies{};  ///< addresses that are believed; none: nobody is
    std::string header = "X-Handpiece-User";
    std::string secret{};  ///< that comes along in X-Handpiece-Secret
};
struct Settings {
    std::filesystem::path data;  ///< its folder
    std::string database{};      ///< empty: SQLite in it; else postgresql://...
    std::string host = "127.0.0.1";
    int port = 8620;                   ///< 0: any that is free
    std::string certificate{}, key{};  ///< files (PEM) for TLS of its own; both or neither
    bool ownStationsOnly = false;      ///< class work comes from stations that are a person's own alone
    std::size_t threads = 400;         ///< at most; each serves one connection
    std::size_t connections = 60;      ///< to the database at once, at most; PostgreSQL has 100 for all its clients
    std::chrono::milliseconds slow{10'000};  ///< who sends and takes less than 2 kB in so long is cut off
    std::size_t workers = 1;                 ///< that cut sessions again; 0: other machines do
    std::string address{};  ///< as browsers know it, without a slash at its end; empty: no log-in by LTI
    SignOn signOn{};
    std::vector<std::string> proxies{};  ///< addresses whose X-Forwarded-For is believed; those of signOn are, too
    /// Versions of the messages that it takes from stations.
    int oldestProtocol = school_wire::kOldestProtocol, newestProtocol = school_wire::kProtocol;
    bool keepsHouse = true;  ///< what is over its time goes, and grades go out
};
/// Since 1970, UTC.
using Clock = std::function<school::Milliseconds()>;
[[nodiscard]] Clock systemClock();

/// Who may call a route.
/// A person is one who is logged in, by a cookie; what they may see is looked at page by page (pages.h).
enum class Caller { anyone, station, person, worker };
struct Route {
    std::string method, pattern;  ///< a regular expression that has to match the whole path
    Caller caller;
};
class Server {
  public:
    /// Opens the books and the port. Throws core::Error, also "port-taken".
    explicit Server(const Settings& settings, Clock clock = systemClock());
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    /// All there are: what is not in here is answered with 404.
    [[nodiscard]] static std::vector<Route> routes();

    [[nodiscard]] int port() const;
    /// Serves until stop(), which may be called from another thread or a signal's.
    void run();
    void stop();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::school_server
