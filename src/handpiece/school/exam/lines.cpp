// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/exam/lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "handpiece/school/store/content_files.h"

namespace handpiece::exam {
namespace {

bool isPlain(std::string_view text) {
    return std::all_of(text.begin(), text.end(), [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return byte >= 0x20 && byte != 0x7f;
    });
}

}  // namespace

LineWriter::LineWriter(std::string_view kind) : text_(fmt::format("{}\n", kind)) {}

LineWriter& LineWriter::add(std::string_view key, std::string_view value) {
    if (!isPlain(value))
        throw core::Error(fmt::format("this cannot be a {}", key), std::string(value.substr(0, 80)),
                          "write it on one line, without control characters")
            .as("books-invalid", {std::string(key)});
    text_ += fmt::format("{}: {}\n", key, value);
    return *this;
}
LineWriter& LineWriter::add(std::string_view key, std::int64_t value) {
    return add(key, std::to_string(value));
}

LineReader::LineReader(std::string_view text, std::string_view kind, std::string where)
    : rest_(text), where_(std::move(where)) {
    const std::size_t end = rest_.find('\n');
    const std::string_view first = rest_.substr(0, end);
    ++line_;
    // "handpiece exam pack 1": the last word is the version.
    const std::string_view name = kind.substr(0, kind.rfind(' ') + 1);
    if (end == std::string_view::npos || !first.starts_with(name))
        throw damaged(fmt::format("it does not begin with \"{}\"", kind));
    if (first != kind)
        throw core::Error(fmt::format("this is of version \"{}\", and this program knows \"{}\"",
                                      first.substr(name.size(), 20), kind.substr(name.size())),
                          where_, "bring this station up to date")
            .as("exam-newer", {std::string(first.substr(name.size(), 20))});
    rest_.remove_prefix(end + 1);
}

core::Error LineReader::damaged(std::string_view why) const {
    return core::Error(fmt::format("line {}: {}", line_, why), where_,
                       "fetch it again: it is not as the school's server writes it")
        .as("exam-damaged", {std::to_string(line_), std::string(why)});
}

bool LineReader::isNext(std::string_view key) const {
    return rest_.size() > key.size() + 2 && rest_.starts_with(key) && rest_.substr(key.size()).starts_with(": ");
}

std::string LineReader::text(std::string_view key, std::size_t most) {
    ++line_;
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos || !isNext(key) || end < key.size() + 2)
        throw damaged(fmt::format("\"{}\" is not there", key));
    const std::string_view value = rest_.substr(key.size() + 2, end - key.size() - 2);
    if (value.size() > most || !isPlain(value)) throw damaged(fmt::format("\"{}\" is none", key));
    rest_.remove_prefix(end + 1);
    return std::string(value);
}

std::string LineReader::hex(std::string_view key, std::size_t digits) {
    std::string value = text(key, digits);
    if (!school::isHex(value, digits)) throw damaged(fmt::format("\"{}\" has no {} digits", key, digits));
    return value;
}

std::string LineReader::code(std::string_view key) {
    std::string value = text(key, 64);
    if (!isCode(value)) throw damaged(fmt::format("\"{}\" is no code", key));
    return value;
}

std::int64_t LineReader::whole(std::string_view key, std::int64_t low, std::int64_t high) {
    return wholeOf(*this, text(key, 24), low, high);
}

void LineReader::end() const {
    if (!rest_.empty()) throw damaged("something follows it");
}

bool isOfKind(std::string_view text, std::string_view kind) {
    return text.substr(0, text.find('\n')) == kind;
}

bool isCode(std::string_view text) {
    return !text.empty() && text.size() <= 64 && std::all_of(text.begin(), text.end(), [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_' ||
               c == '.';
    });
}

std::int64_t wholeOf(const LineReader& reader, std::string_view text, std::int64_t low, std::int64_t high) {
    std::int64_t value = 0;
    const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (ec != std::errc() || end != text.data() + text.size() || std::to_string(value) != text)
        throw reader.damaged(fmt::format("\"{}\" is no whole number", text));
    if (value < low || value > high) throw reader.damaged(fmt::format("{} is out of range", value));
    return value;
}

std::vector<std::string> partsOf(std::string_view text, char between) {
    std::vector<std::string> parts;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find(between), text.size());
        parts.emplace_back(text.substr(0, end));
        if (end == text.size()) break;
        text.remove_prefix(end + 1);
        if (text.empty()) parts.emplace_back();
    }
    return parts;
}

}  // namespace handpiece::exam
