// SPDX-License-Identifier: Apache-2.0
#include "school/door.h"

#include <algorithm>
#include <charconv>
#include <string_view>

namespace handpiece::school_server {
namespace {

using httplib::Request;

std::optional<std::uint64_t> numberIn(const std::string& text) {
    std::uint64_t number = 0;
    const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (text.empty() || ec != std::errc() || end != text.data() + text.size()) return {};
    return number;
}

}  // namespace

Door::Door(const std::vector<Entry>& routes) {
    for (const Entry& entry : routes)
        if (const std::string_view method = entry.method; method != "GET")
            ways_.push_back({entry.method, std::regex(entry.pattern)});
}

std::optional<int> Door::refuses(const Request& request) const {
    std::size_t bytes = 0;
    for (const auto& [name, value] : request.headers)
        bytes += name.size() + value.size();
    if (request.headers.size() > kMostHeaders || bytes > kMostHeaderBytes) return 431;
    // Packed bodies grow a million times; nobody who belongs here packs any.
    if (request.has_header("Content-Encoding")) return 415;
    // Each piece is sent with a head of its own: of two thousand the answer is many times what is asked for.
    if (request.ranges.size() > kMostRanges) return 416;
    const bool hasBody = request.method == "POST" || request.method == "PUT";
    if (!hasBody && request.method != "GET" && request.method != "HEAD") return 405;
    // One length, told beforehand: else where it ends, and what comes next, is anybody's guess.
    if (request.has_header("Transfer-Encoding")) return 411;
    const std::size_t lengths = request.get_header_value_count("Content-Length");
    if (lengths == 0) return hasBody ? std::optional(411) : std::nullopt;
    const std::optional<std::uint64_t> length = numberIn(request.get_header_value("Content-Length"));
    if (lengths > 1 || !length || (!hasBody && *length > 0)) return 400;
    if (!hasBody) return {};
    const bool isThere = std::any_of(ways_.begin(), ways_.end(), [&](const Way& one) {
        return one.method == request.method && std::regex_match(request.path, one.address);
    });
    return isThere ? std::nullopt : std::optional(404);
}

std::uint64_t Door::lengthOf(const Request& request) {
    return numberIn(request.get_header_value("Content-Length")).value_or(0);
}

}  // namespace handpiece::school_server
