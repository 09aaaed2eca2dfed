// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A station's connection to its school's server.

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
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
    /// Into `file`, of no more than `most` bytes: who sends more, or others than it said, is no server of ours.
    /// `goesOn` is asked between pieces.
    void fetch(const std::string& path, const std::filesystem::path& file, std::uint64_t most,
               const std::function<bool()>& goesOn) {
        const core::FileStream into = core::createOwnFile(file);
        if (!into)
            throw core::Error("what the server sends cannot be kept here", file.string(),
                              "see whether the disk is full")
                .as(core::writeErrorId(errno), {std::strerror(errno)});
        std::string said;
        std::uint64_t bytes = 0;
        bool isWell = false, isWritten = true;
        const auto result = http_.Get(
            path,
            [&](const httplib::Response& response) {
                isWell = response.status == 200;
                return true;
            },
            [&](const char* data, std::size_t size) {
                constexpr std::size_t kMostSaid = 1 << 16;
                bytes += size;
                if (!isWell) said.append(data, std::min(size, kMostSaid - std::min(kMostSaid, said.size())));
                if (isWell && bytes <= most) isWritten = std::fwrite(data, 1, size, into.get()) == size;
                return isWritten && bytes <= std::max<std::uint64_t>(most, kMostSaid) && goesOn();
            });
        if (!isWritten || std::fflush(into.get()) != 0)
            throw core::Error("what the server sends cannot be kept here", file.string(),
                              "see whether the disk is full")
                .as(core::writeErrorId(errno), {std::strerror(errno)});
        if (isWell && bytes > most) throw school_wire::errorFrom("", 200);
        if (result && !isWell) throw school_wire::errorFrom(said, result->status);
        if (!result) throw silent(server_, httplib::to_string(result.error()));
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
