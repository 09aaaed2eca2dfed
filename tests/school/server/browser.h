// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Somebody at a browser, and paths to try.

#include <functional>
#include <regex>
#include <string>

#include "school/server/school_fixture.h"

namespace handpiece::school_server {

inline constexpr const char* kPassword = "a long enough one";

class Browser {
  public:
    explicit Browser(const std::string& address) : http_(address) { http_.set_read_timeout(60); }
    httplib::Result get(const std::string& path) { return http_.Get(path, headers()); }
    httplib::Result post(const std::string& path, const httplib::Params& form) {
        httplib::Result result = http_.Post(path, headers(), form);
        if (result) take(*result);
        return result;
    }
    httplib::Result post(const std::string& path, const httplib::MultipartFormDataItems& items) {
        return http_.Post(path, headers(), items);
    }
    int logIn(const std::string& login, const std::string& password = kPassword) {
        const auto result = post("/login", httplib::Params{{"login", login}, {"password", password}});
        return result ? result->status : 0;
    }
    /// Of this log-in's forms.
    std::string requestToken() {
        const std::string page = get("/classes")->body;
        std::smatch token;
        EXPECT_TRUE(std::regex_search(page, token, std::regex("name=\"token\" value=\"([0-9a-f]+)\"")));
        return token[1];
    }
    /// With the log-in's token.
    httplib::Result send(const std::string& path, httplib::Params form) {
        form.emplace("token", requestToken());
        return post(path, form);
    }
    [[nodiscard]] const std::string& cookie() const { return cookie_; }

  private:
    [[nodiscard]] httplib::Headers headers() const {
        return cookie_.empty() ? httplib::Headers{} : httplib::Headers{{"Cookie", "handpiece=" + cookie_}};
    }
    void take(const httplib::Response& response) {
        const std::string set = response.get_header_value("Set-Cookie");
        std::smatch found;
        if (std::regex_search(set, found, std::regex("handpiece=([0-9a-f]*);"))) cookie_ = found[1];
    }
    httplib::Client http_;
    std::string cookie_;
};

/// A pattern's word without its backslashes.
inline std::string plain(std::string word) {
    std::erase(word, '\\');
    return word;
}

/// A path that the route's pattern fits; `named`: what stands for a group, by its number from 0; else as many digits as
/// it wants, or the first of several words.
inline std::string pathOf(const std::string& pattern, const std::function<std::string(std::size_t)>& named = {}) {
    std::string path;
    std::size_t group = 0;
    for (std::size_t at = 0; at < pattern.size();) {
        if (pattern[at] != '(') {
            path += pattern[at++];
            continue;
        }
        const std::size_t end = pattern.find(')', at);
        const std::string inside = pattern.substr(at + 1, end - at - 1);
        const std::string own = named ? named(group) : std::string();
        const std::size_t counted = inside.rfind('{');
        path += !own.empty()                      ? own
                : inside.find('|') != inside.npos ? plain(inside.substr(0, inside.find('|')))
                : counted != inside.npos          ? std::string(std::stoul(inside.substr(counted + 1)), '2')
                                                  : std::string("2");
        ++group;
        at = end + 1;
    }
    return path;
}

}  // namespace handpiece::school_server
