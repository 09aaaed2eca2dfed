// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/config/outside_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <vector>

namespace handpiece::config {
namespace {

/// Keeps nothing but how many keys each object has that is open.
class Counter final : public nlohmann::json_sax<nlohmann::json> {
  public:
    Counter(const JsonBounds& bounds, std::string& problem) : bounds_(bounds), problem_(problem) {}

    bool null() override { return count(); }
    bool boolean(bool) override { return count(); }
    bool number_integer(number_integer_t) override { return count(); }
    bool number_unsigned(number_unsigned_t) override { return count(); }
    bool number_float(number_float_t, const string_t&) override { return count(); }
    bool string(string_t&) override { return count(); }
    bool binary(binary_t&) override { return count(); }
    bool start_object(std::size_t) override { return open(); }
    bool start_array(std::size_t) override { return open(); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }
    bool key(string_t&) override {
        if (++keys_.back() > bounds_.keys) return refuse("an object has more than {} keys", bounds_.keys);
        return count();
    }
    bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception&) override {
        problem_ = fmt::format("it is no JSON from byte {} on", position);
        return false;
    }

  private:
    bool count() { return ++values_ <= bounds_.values || refuse("it has more than {} values", bounds_.values); }
    bool open() {
        keys_.push_back(0);
        return keys_.size() > bounds_.depth ? refuse("it is nested more than {} deep", bounds_.depth) : count();
    }
    bool close() {
        keys_.pop_back();
        return true;
    }
    bool refuse(fmt::format_string<std::size_t&> why, std::size_t bound) {
        problem_ = fmt::format(why, bound);
        return false;
    }

    JsonBounds bounds_;
    std::string& problem_;
    std::vector<std::size_t> keys_;
    std::size_t values_ = 0;
};

}  // namespace

std::string jsonProblem(std::string_view text, const JsonBounds& bounds) {
    std::string problem;
    Counter counter(bounds, problem);
    if (!nlohmann::json::sax_parse(text, &counter) && problem.empty()) problem = "it is no JSON";
    return problem;
}

}  // namespace handpiece::config
