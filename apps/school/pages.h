// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a person sees of a school in a browser, and who may: pages by address, for the server to send. No HTTP here.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "handpiece/base/core/file.h"
#include "handpiece/school/store/books.h"

namespace handpiece::school_server {

class Readings;
class ReviewShelf;

/// What goes back to the browser.
struct Page {
    int status = 200;
    std::string body{};
    std::string to{};                    ///< another address instead of a page
    std::optional<std::string> login{};  ///< token of a log-in from here on; empty: none any more
    std::string type = "text/html; charset=utf-8";
    std::string fileName{};     ///< to be kept as a file of this name
    core::FileStream stream{};  ///< instead of `body`: may be large
    bool runsScript = false;    ///< modules of this server, which may ask it; else none runs
    bool isReview = false;      ///< the viewer that stands in it runs, and asks nobody
};

/// One request of somebody who is logged in.
struct Visit {
    school::Books& books;
    school::Person person;
    std::string token;  ///< of the log-in
    school::Milliseconds now = 0;
};

[[nodiscard]] Page classesOf(const Visit& visit);
[[nodiscard]] Page classOf(const Visit& visit, const std::string& id);
[[nodiscard]] Page personOf(const Visit& visit, const std::string& code);
[[nodiscard]] Page attemptOf(const Visit& visit, const std::string& id);
[[nodiscard]] Page resultOf(const Visit& visit, const std::string& id, Readings& readings);
/// The review, or how far the making of it is.
[[nodiscard]] Page reviewOf(const Visit& visit, const std::string& id, ReviewShelf& shelf);
[[nodiscard]] Page refused(const std::string& what, int status);

}  // namespace handpiece::school_server
