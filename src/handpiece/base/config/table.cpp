// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/config/table.h"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::config {
namespace {

constexpr int kMaxDepth = 32;

const toml::table& tomlOf(const std::shared_ptr<const void>& node) {
    return *static_cast<const toml::table*>(node.get());
}

[[noreturn]] void wrongType(const Table& table, std::string_view key, std::string_view needed) {
    table.fail(fmt::format("\"{}\" has the wrong type", key), fmt::format("it must be {}", needed), key);
}

/// A list whose elements are all T.
template <class T>
std::vector<T> listOf(const Table& table, const toml::node* node, std::string_view key, const char* what) {
    std::vector<T> list;
    if (!node) return list;
    const toml::array* array = node->as_array();
    if (!array) table.fail(fmt::format("\"{}\" is not a list of {}", key, what), {}, key);
    for (const toml::node& element : *array) {
        const bool fits = std::is_same_v<T, double> ? element.is_number() : element.is_string();
        const auto value = fits ? element.value<T>() : std::optional<T>{};
        if (!value) table.fail(fmt::format("\"{}\" is not a list of {}", key, what), {}, key);
        list.push_back(*value);
    }
    return list;
}

/// Where a string that begins at `at` ends: behind its last quote, or where the reader will refuse it.
std::size_t endOfString(std::string_view text, std::size_t at) {
    const char quote = text[at];
    const std::string triple(3, quote);
    const bool isLong = text.substr(at, 3) == triple, hasEscapes = quote == '"';
    for (at += isLong ? 3 : 1; at < text.size(); ++at) {
        if (text[at] == '\\' && hasEscapes) {
            ++at;
        } else if (isLong ? text.substr(at, 3) == triple : text[at] == quote) {
            at += isLong ? 3 : 1;
            // A long one may have two quotes of its own before those that end it.
            for (int i = 0; isLong && i < 2 && at < text.size() && text[at] == quote; ++i)
                ++at;
            return at;
        } else if (text[at] == '\n' && !isLong) {
            return at;
        }
    }
    return text.size();
}

/// toml++ bounds how deep brackets may stand in one another, but not how many names a dotted key has; each is a table
/// in a table, and freeing a hundred thousand of them overflows the stack.
void requireShallow(std::string_view text, const std::string& where) {
    int brackets = 0, dots = 0;
    for (std::size_t at = 0; at < text.size();) {
        const char c = text[at];
        if (c == '"' || c == '\'') {
            at = endOfString(text, at);
            continue;
        }
        if (c == '#') {
            at = std::min(text.find('\n', at), text.size());
            continue;
        }
        ++at;
        if (c == '.') {
            ++dots;
        } else if (c == '[' || c == '{') {
            ++brackets;
            dots = 0;
        } else if (c == ']' || c == '}') {
            brackets = std::max(0, brackets - 1);
            dots = 0;
        } else if (c == '\n' || c == '=' || c == ',') {
            dots = 0;
        }
        if (brackets <= kMaxDepth && dots <= kMaxDepth) continue;
        const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
        const std::string problem =
            fmt::format("line {}: more than {} tables or lists in one another", line, kMaxDepth);
        throw core::Error(problem, where, "mend the file").as("bad-text", {problem});
    }
}

}  // namespace

Table Table::parse(std::string_view text, std::string where, std::uint64_t mostBytes) {
    if (text.size() > mostBytes)
        throw core::Error(fmt::format("the file has {} bytes, more than the {} that are read", text.size(), mostBytes),
                          where)
            .as("too-large");
    requireShallow(text, where);
    try {
        auto root = std::make_shared<toml::table>(toml::parse(text, where));
        return {std::shared_ptr<const void>(std::move(root)), std::move(where)};
    } catch (const toml::parse_error& e) {
        const std::string problem = fmt::format("line {}: {}", e.source().begin.line, e.description());
        throw core::Error(problem, where, "mend the file").as("bad-text", {problem});
    }
}

Table Table::read(const std::filesystem::path& file) {
    const std::vector<std::byte> bytes = core::readFile(file, kMaxBytes);
    return parse(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()), file.string());
}

bool Table::has(std::string_view key) const {
    return tomlOf(node_).contains(key);
}

std::vector<std::string> Table::keys() const {
    std::vector<std::string> found;
    for (const auto& [key, value] : tomlOf(node_))
        found.emplace_back(key.str());
    return found;
}

int Table::line(std::string_view key) const {
    const toml::node* at = key.empty() ? nullptr : tomlOf(node_).get(key);
    return static_cast<int>((at ? *at : static_cast<const toml::node&>(tomlOf(node_))).source().begin.line);
}

void Table::fail(const std::string& problem, const std::string& remedy, std::string_view key) const {
    const int at = line(key);
    const std::string told = at > 0 ? fmt::format("{} (line {})", problem, at) : problem;
    throw core::Error(told, where_, remedy).as("bad-text", {told});
}

std::optional<std::string> Table::text(std::string_view key) const {
    const toml::node* node = tomlOf(node_).get(key);
    if (!node) return {};
    if (auto value = node->value_exact<std::string>()) return value;
    wrongType(*this, key, "a text in quotes");
}

std::optional<double> Table::number(std::string_view key) const {
    const toml::node* node = tomlOf(node_).get(key);
    if (!node) return {};
    if (!node->is_number()) wrongType(*this, key, "a number");
    const double value = node->value<double>().value_or(std::nan(""));
    if (!std::isfinite(value)) fail(fmt::format("\"{}\" is {}", key, value), "give a finite number", key);
    return value;
}

std::optional<std::int64_t> Table::integer(std::string_view key) const {
    const toml::node* node = tomlOf(node_).get(key);
    if (!node) return {};
    if (const auto value = node->value_exact<std::int64_t>()) return value;
    wrongType(*this, key, "a whole number");
}

std::optional<bool> Table::flag(std::string_view key) const {
    const toml::node* node = tomlOf(node_).get(key);
    if (!node) return {};
    if (const auto value = node->value_exact<bool>()) return value;
    wrongType(*this, key, "true or false");
}

bool Table::isTable(std::string_view key) const {
    const toml::node* node = tomlOf(node_).get(key);
    return node && node->is_table();
}

std::optional<Table> Table::table(std::string_view key) const {
    const toml::node* node = tomlOf(node_).get(key);
    if (!node) return {};
    if (!node->is_table()) wrongType(*this, key, "a table");
    return Table(std::shared_ptr<const void>(node_, node->as_table()), where_);
}

std::vector<Table> Table::tables(std::string_view key) const {
    std::vector<Table> list;
    const toml::node* node = tomlOf(node_).get(key);
    if (!node) return list;
    const toml::array* array = node->as_array();
    if (!array) fail(fmt::format("\"{}\" is not a list of tables", key), {}, key);
    for (const toml::node& element : *array) {
        if (!element.is_table()) fail(fmt::format("\"{}\" is not a list of tables", key), {}, key);
        list.push_back(Table(std::shared_ptr<const void>(node_, element.as_table()), where_));
    }
    return list;
}

std::vector<std::string> Table::texts(std::string_view key) const {
    return listOf<std::string>(*this, tomlOf(node_).get(key), key, "texts");
}

std::vector<double> Table::numbers(std::string_view key) const {
    std::vector<double> list = listOf<double>(*this, tomlOf(node_).get(key), key, "numbers");
    for (const double value : list)
        if (!std::isfinite(value)) fail(fmt::format("\"{}\" holds {}", key, value), "give finite numbers", key);
    return list;
}

std::vector<std::vector<double>> Table::numberRows(std::string_view key) const {
    std::vector<std::vector<double>> rows;
    const toml::node* node = tomlOf(node_).get(key);
    if (!node) return rows;
    const toml::array* array = node->as_array();
    if (!array) fail(fmt::format("\"{}\" is not a list of lists of numbers", key), {}, key);
    for (const toml::node& row : *array) {
        rows.push_back(listOf<double>(*this, &row, key, "lists of numbers"));
        for (const double value : rows.back())
            if (!std::isfinite(value)) fail(fmt::format("\"{}\" holds {}", key, value), "give finite numbers", key);
    }
    return rows;
}

void Table::allowOnly(std::initializer_list<std::string_view> known) const {
    for (const auto& [key, value] : tomlOf(node_)) {
        if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
        fail(fmt::format("there is no key \"{}\"", key.str()),
             fmt::format("the keys are {}", fmt::join(known.begin(), known.end(), ", ")), key.str());
    }
}

}  // namespace handpiece::config
