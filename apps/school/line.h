// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A station's connection to its school's server.

#include <fmt/format.h>

#include <chrono>
#include <string>

#include "handpiece/base/core/error.h"
#include "school/http.h"
#include "school/wire.h"

namespace handpiece::school_station {

inline core::Error silent(const std::string& server, const std::string& why) {
    return core::Error(fmt::format("nobody answers there ({})", why), server,
                       "try again when the network is there: nothing is lost until then")
        .as("server-silent", {server, why});
}

inline constexpr std::chrono::seconds kLinePatience{20};

/// One connection, for one thread. What it throws is core::Error: "server-silent", or what the server says.
class Line {
  public:
    Line(const std::string& server, std::string key, std::chrono::seconds patience = kLinePatience,
         int protocol = school_wire::kProtocol)
        : server_(server), http_(checked(server)) {
        http_.set_connection_timeout(patience);
        http_.set_read_timeout(patience);
        http_.set_write_timeout(patience);
        http_.set_keep_alive(true);
        httplib::Headers headers{{"Handpiece-Protocol", std::to_string(protocol)}};
        if (!key.empty()) headers.emplace("Authorization", "Bearer " + key);
        http_.set_default_headers(headers);
    }
    std::string get(const std::string& path) { return heard(http_.Get(path)); }
    std::string post(const std::string& path, const std::string& json) {
        return heard(http_.Post(path, json, "application/json"));
    }
    std::string put(const std::string& path, const std::string& bytes) {
        return heard(http_.Put(path, bytes, "application/octet-stream"));
    }

  private:
    static const std::string& checked(const std::string& server) {
        if (!server.starts_with("http://") && !server.starts_with("https://"))
            throw core::Error("this is no address of a server", server, "give one as https://school.example:8620")
                .as("server-address", {server});
        return server;
    }
    std::string heard(const httplib::Result& result) const {
        if (!result) throw silent(server_, httplib::to_string(result.error()));
        if (result->status < 200 || result->status > 299) throw school_wire::errorFrom(result->body, result->status);
        return result->body;
    }

    std::string server_;
    httplib::Client http_;
};

}  // namespace handpiece::school_station
