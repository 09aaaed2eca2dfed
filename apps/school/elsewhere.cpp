// SPDX-License-Identifier: Apache-2.0
#include "school/elsewhere.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>

#include "handpiece/base/core/error.h"
#include "school/http.h"

namespace handpiece::school_server {
namespace {

constexpr std::size_t kMostAnswer = 1 << 18;

struct Address {
    std::string server, path;
};
Address addressOf(const std::string& address) {
    const auto wrong = [&] {
        return core::Error("this is no address that is called", address.substr(0, 200),
                           "give one as https://platform.example/path")
            .as("platform-address", {address.substr(0, 200)});
    };
    const std::size_t scheme = address.find("://");
    if (scheme == address.npos ||
        std::any_of(address.begin(), address.end(), [](char c) { return static_cast<unsigned char>(c) <= 0x20; }))
        throw wrong();
    const std::size_t path = std::min(address.find_first_of("/?#", scheme + 3), address.size());
    const std::string server = address.substr(0, path), host = server.substr(scheme + 3);
    // Without TLS only this very machine: a test, or a proxy on it.
    const bool isHere =
        host == "127.0.0.1" || host.starts_with("127.0.0.1:") || host == "localhost" || host.starts_with("localhost:");
    if (host.empty() || host.find('@') != host.npos ||
        !(server.starts_with("https://") || (server.starts_with("http://") && isHere)))
        throw wrong();
    const std::string rest = address.substr(path);
    return {server, rest.starts_with('/') ? rest : "/" + rest};
}

Elsewhere asked(const std::string& address,
                const std::function<httplib::Result(httplib::Client&, const std::string&)>& ask) {
    const Address at = addressOf(address);
    httplib::Client http(at.server);
    http.set_connection_timeout(10);
    http.set_read_timeout(20);
    http.set_follow_location(false);
    const httplib::Result result = ask(http, at.path);
    if (!result)
        throw core::Error(fmt::format("nobody answers there ({})", httplib::to_string(result.error())), at.server,
                          "try again later")
            .as("platform-silent", {httplib::to_string(result.error())});
    if (result->body.size() > kMostAnswer)
        throw core::Error("too much is answered there", at.server, "check its address")
            .as("platform-silent", {"too long"});
    return {result->status, result->body};
}

}  // namespace

Elsewhere fetch(const std::string& address) {
    return asked(address, [](httplib::Client& http, const std::string& path) { return http.Get(path); });
}

Elsewhere post(const std::string& address, const std::string& body, const char* type,
               const std::vector<std::pair<std::string, std::string>>& headers) {
    return asked(address, [&](httplib::Client& http, const std::string& path) {
        httplib::Headers all(headers.begin(), headers.end());
        all.emplace("Accept", "application/json");
        return http.Post(path, all, body, type);
    });
}

void requireAddress(const std::string& address) {
    (void)addressOf(address);
}

std::string hostOf(const std::string& address) {
    try {
        const std::string server = addressOf(address).server;
        std::string host = server.substr(server.find("://") + 3);
        if (const std::size_t port = host.rfind(':'); port != host.npos && host.find(']', port) == host.npos)
            host.resize(port);
        std::transform(host.begin(), host.end(), host.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        return host;
    } catch (const core::Error&) {
        return {};
    }
}

}  // namespace handpiece::school_server
