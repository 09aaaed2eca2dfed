// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The table of what a server answers: a room of it in a source of its own (*_routes.cpp), all of them in
/// Server::routes().

#include <functional>
#include <variant>
#include <vector>

#include "school/http.h"
#include "school/pages.h"
#include "school/service.h"
#include "school/wire.h"

namespace handpiece::school_server {

using Handler = std::function<void(const httplib::Request&, httplib::Response&)>;
using StationHandler = std::function<void(const httplib::Request&, httplib::Response&, const school::Station&)>;
/// A page for who is logged in. What it may not show it refuses itself (pages.h).
using Shown = std::function<Page(const httplib::Request&, const Visit&)>;

/// For a machine that cuts works again; no other station's key opens these, and its key opens no other.
struct WorkerHandler {
    StationHandler answer;
};

/// A route and what answers it; who may call is what the answer needs to know.
struct Entry {
    const char* method;
    const char* pattern;
    std::variant<Handler, StationHandler, Shown, WorkerHandler> answer;  ///< in the order of Caller
    std::size_t most = school_wire::kMostMessage;  ///< bytes that may be sent; more only of who is logged in
    [[nodiscard]] Caller caller() const { return static_cast<Caller>(answer.index()); }
};

/// The address that asks: where a proxy of ours stands between, what that saw. Nobody else's word for it is taken.
[[nodiscard]] std::string clientOf(const httplib::Request& request, const Settings& settings);
/// That this came by TLS: to this server, or to a proxy of ours that says so.
[[nodiscard]] bool isSecure(const httplib::Request& request, const Settings& settings);

// Of `service`, which may be null where nobody calls them.
[[nodiscard]] std::vector<Entry> generalRoutes(Service* service);
[[nodiscard]] std::vector<Entry> stationRoutes(Service* service);
[[nodiscard]] std::vector<Entry> pageRoutes(Service* service);
[[nodiscard]] std::vector<Entry> examRoutes(Service* service);
[[nodiscard]] std::vector<Entry> signOnRoutes(Service* service);
[[nodiscard]] std::vector<Entry> officeRoutes(Service* service);
[[nodiscard]] std::vector<Entry> liveRoutes(Service* service);
[[nodiscard]] std::vector<Entry> teachingRoutes(Service* service);
[[nodiscard]] std::vector<Entry> workerRoutes(Service* service);

/// Whose a station is was shown by that person; it acts for nobody else. Throws core::Error "station-anothers".
void requireActsFor(const school::Station& station, const std::string& person);

}  // namespace handpiece::school_server
