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
#include <optional>
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
/// What went wrong on the way, in words that help.
inline std::string reasonOf(httplib::Error error) {
    switch (error) {
        case httplib::Error::SSLServerVerification:
            return "this computer does not trust its certificate; SSL_CERT_FILE names a file with the school's own";
        case httplib::Error::SSLConnection:
            return "it does not speak TLS: is its address http://...?";
        case httplib::Error::Write:
        case httplib::Error::Read:
            return "the connection broke; a server with TLS has an address of https://...";
        default:
            return httplib::to_string(error);
    }
}
/// As it is kept: http(s)://host[:port], nothing behind it.
inline std::string serverAddress(std::string server) {
    const std::size_t scheme = server.starts_with("http://") ? 7 : server.starts_with("https://") ? 8 : 0;
    while (scheme > 0 && server.size() > scheme && server.back() == '/')
        server.pop_back();
    if (scheme == 0 || server.size() == scheme || server.find('/', scheme) != server.npos)
        throw core::Error("this is no address of a server", server, "give one as https://school.example:8620")
            .as("server-address", {server});
    return server;
}

inline constexpr std::chrono::seconds kLinePatience{20};

/// One connection, for one thread. What it throws is core::Error: "server-silent", or what the server says. Of an
/// answer it takes no more than is asked for: who sends more is no server of ours.
class Line {
  public:
    static constexpr std::uint64_t kMostAnswer = 16u << 20, kMostFile = 80u << 20;

    Line(const std::string& server, std::string key, std::chrono::seconds patience = kLinePatience,
         int protocol = school_wire::kProtocol)
        : server_(serverAddress(server)), http_(server_) {
        http_.set_connection_timeout(patience);
        http_.set_read_timeout(patience);
        http_.set_write_timeout(patience);
        http_.set_keep_alive(true);
        headers_ = {{"Handpiece-Protocol", std::to_string(protocol)}};
        if (!key.empty()) headers_.emplace("Authorization", "Bearer " + key);
    }
    std::string get(const std::string& path, std::uint64_t most = kMostAnswer) {
        return asked("GET", path, {}, nullptr, most);
    }
    std::string post(const std::string& path, const std::string& json) {
        return asked("POST", path, json, "application/json", kMostAnswer);
    }
    std::string put(const std::string& path, const std::string& bytes) {
        return asked("PUT", path, bytes, "application/octet-stream", kMostAnswer);
    }
    /// Into `file`, of no more than `most` bytes. `goesOn` is asked between pieces.
    void fetch(const std::string& path, const std::filesystem::path& file, std::uint64_t most,
               const std::function<bool()>& goesOn) {
        const core::FileStream into = core::createOwnFile(file);
        const auto cannotKeep = [&] {
            return core::Error("what the server sends cannot be kept here", file.string(),
                               "see whether the disk is full")
                .as(core::writeErrorId(errno), {std::strerror(errno)});
        };
        if (!into) throw cannotKeep();
        ask("GET", path, {}, nullptr, most, [&](const char* data, std::size_t size) {
            if (std::fwrite(data, 1, size, into.get()) != size) throw cannotKeep();
            return goesOn();
        });
        if (std::fflush(into.get()) != 0) throw cannotKeep();
    }

  private:
    std::string asked(const char* method, const std::string& path, const std::string& body, const char* type,
                      std::uint64_t most) {
        std::string answer;
        ask(method, path, body, type, most, [&](const char* data, std::size_t size) {
            answer.append(data, size);
            return true;
        });
        return answer;
    }
    /// `take` is given what a good answer has; false ends it.
    void ask(const char* method, const std::string& path, const std::string& body, const char* type, std::uint64_t most,
             const std::function<bool(const char*, std::size_t)>& take) {
        constexpr std::size_t kMostSaid = 1 << 16;
        httplib::Request request;
        request.method = method, request.path = path, request.headers = headers_, request.body = body;
        if (type != nullptr) request.headers.emplace("Content-Type", type);
        std::string said;
        std::uint64_t bytes = 0;
        bool isGood = false;
        request.response_handler = [&](const httplib::Response& response) {
            isGood = response.status >= 200 && response.status <= 299;
            return true;
        };
        // An exception does not pass through the library.
        std::optional<core::Error> wrong;
        request.content_receiver = [&](const char* data, std::size_t size, std::uint64_t, std::uint64_t) {
            bytes += size;
            if (!isGood) {
                said.append(data, std::min(size, kMostSaid - std::min(kMostSaid, said.size())));
                return bytes <= kMostSaid;
            }
            if (bytes > most) wrong = school_wire::errorFrom("", 200);
            if (wrong) return false;
            try {
                return take(data, size);
            } catch (const core::Error& e) {
                wrong = e;
                return false;
            }
        };
        httplib::Response response;
        httplib::Error error = httplib::Error::Success;
        const bool isHeard = http_.send(request, response, error);
        if (wrong) throw *wrong;
        // Without a body nobody was asked.
        if (isHeard) isGood = response.status >= 200 && response.status <= 299;
        if (!isHeard && (isGood || said.empty())) throw silent(server_, reasonOf(error));
        if (!isGood) throw school_wire::errorFrom(said, response.status);
    }

    std::string server_;
    httplib::Client http_;
    httplib::Headers headers_;
};

}  // namespace handpiece::school_station
