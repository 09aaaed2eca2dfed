// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// JSON that somebody else wrote. It is counted before any of it is kept: values that lie deep within each other are
/// copied by recursion, and an ordered object looks through all its keys for each new one.

#include <string>
#include <string_view>

namespace handpiece::config {

struct JsonBounds {
    std::size_t depth = 64;          ///< arrays and objects within each other
    std::size_t keys = 512;          ///< of one object
    std::size_t values = 1'000'000;  ///< in all, keys too
};

/// Why it is not read: no JSON, or over the bounds; empty: neither. In time linear in the text, in memory linear in the
/// depth alone.
[[nodiscard]] std::string jsonProblem(std::string_view text, const JsonBounds& bounds = {});

/// `Json`: nlohmann::json or ordered_json. Json::value_t::discarded, as Json::parse() gives it, when there is a
/// problem.
template <class Json>
[[nodiscard]] Json outsideJson(std::string_view text, const JsonBounds& bounds = {}) {
    if (!jsonProblem(text, bounds).empty()) return Json(Json::value_t::discarded);
    return Json::parse(text, nullptr, false);
}

/// Throws Json::exception when there is a problem.
template <class Json>
[[nodiscard]] Json requireOutsideJson(std::string_view text, const JsonBounds& bounds = {}) {
    if (const std::string problem = jsonProblem(text, bounds); !problem.empty())
        throw Json::other_error::create(599, problem, nullptr);
    return Json::parse(text);
}

}  // namespace handpiece::config
