// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/draft/cells.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "handpiece/base/core/error.h"

namespace handpiece::draft {
namespace {

std::string_view trimmed(std::string_view text) {
    const auto isBlank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
    while (!text.empty() && isBlank(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && isBlank(text.back()))
        text.remove_suffix(1);
    return text;
}
std::vector<std::string_view> split(std::string_view text, char at) {
    std::vector<std::string_view> parts;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find(at), text.size());
        if (const std::string_view part = trimmed(text.substr(0, end)); !part.empty()) parts.push_back(part);
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return parts;
}
[[noreturn]] void refuse(std::string_view part, const char* example) {
    throw core::Error(fmt::format("\"{}\" cannot be read", part.substr(0, 64)), {},
                      fmt::format("write it as in {}", example))
        .as("cell-unreadable", {std::string(part.substr(0, 64)), example});
}
double numberIn(std::string_view text, std::string_view part, const char* example) {
    text = trimmed(text);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) refuse(part, example);
    return value;
}
std::string cell(const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : std::string();
}

}  // namespace

std::string namesCell(const std::vector<std::string>& names) {
    return fmt::format("{}", fmt::join(names, ", "));
}

std::vector<std::string> readNames(std::string_view text) {
    std::vector<std::string> names;
    for (const std::string_view name : split(text, ','))
        names.emplace_back(name);
    return names;
}

std::optional<double> readNumber(std::string_view text) {
    if (trimmed(text).empty()) return std::nullopt;
    return numberIn(text, trimmed(text), "12.5");
}

std::string needsCell(const rubric::Rule& rule) {
    std::vector<std::string> parts;
    for (const rubric::Condition& need : rule.needs) {
        std::string part = need.rule.empty() ? namesCell(need.bands) : "rule " + need.rule;
        if (!need.of.empty()) part += " of " + namesCell(need.of);
        if (need.least) part += fmt::format(" least {}", *need.least);
        if (need.most) part += fmt::format(" most {}", *need.most);
        parts.push_back(std::move(part));
    }
    return fmt::format("{}", fmt::join(parts, "; "));
}

void readNeeds(rubric::Rule& rule, std::string_view text) {
    constexpr const char* kExample = "unacceptable most 0; modify of depth, outline most 2; rule other";
    std::vector<rubric::Condition> needs;
    for (const std::string_view part : split(text, ';')) {
        rubric::Condition need;
        std::string before;  // of the keyword that is read
        std::string_view key = "bands";
        const auto end = [&] {
            if (key == "bands")
                need.bands = readNames(before);
            else if (key == "of")
                need.of = readNames(before);
            else if (key == "rule")
                need.rule = trimmed(before);
            else {
                const double count = numberIn(before, part, kExample);
                if (count < 0.0 || count != std::floor(count) || count > 1e6) refuse(part, kExample);
                (key == "least" ? need.least : need.most) = static_cast<std::int64_t>(count);
            }
            before.clear();
        };
        for (const std::string_view word : split(part, ' ')) {
            if (word == "of" || word == "least" || word == "most" || word == "rule") {
                end();
                key = word;
            } else {
                before += std::string(word) + " ";
            }
        }
        end();
        if (need.rule.empty() ? need.bands.empty() || (!need.least && !need.most)
                              : !need.bands.empty() || !need.of.empty() || need.least || need.most)
            refuse(part, kExample);
        needs.push_back(std::move(need));
    }
    rule.needs = std::move(needs);
}

std::string knotsCell(const rubric::Criterion& criterion) {
    std::vector<std::string> parts;
    for (const rubric::Knot& k : criterion.knots)
        parts.push_back(fmt::format("{}: {}", k.value, k.points));
    return fmt::format("{}", fmt::join(parts, ", "));
}

std::string bandsCell(const rubric::Criterion& criterion) {
    std::vector<std::string> parts;
    for (const rubric::Band& b : criterion.bands)
        parts.push_back(
            fmt::format("{} {}..{}{}", b.id, cell(b.from), cell(b.to), b.points ? " = " + cell(b.points) : ""));
    return fmt::format("{}", fmt::join(parts, "; "));
}

std::string criticalCell(const rubric::Criterion& criterion) {
    if (!criterion.critical) return {};
    std::vector<std::string> parts;
    if (criterion.critical->below) parts.push_back("< " + cell(criterion.critical->below));
    if (criterion.critical->above) parts.push_back("> " + cell(criterion.critical->above));
    return fmt::format("{}", fmt::join(parts, ", "));
}

std::string selectionCell(const rubric::Criterion& criterion) {
    std::vector<std::string> parts;
    const auto add = [&](const char* what, const std::string& value) {
        if (!value.empty()) parts.push_back(fmt::format("{} {}", what, value));
    };
    add("zone", criterion.of.zone);
    add("tissue", criterion.of.tissue);
    add("side", criterion.of.side);
    add("statistic", criterion.of.statistic);
    add("limit", cell(criterion.of.limit));
    return fmt::format("{}", fmt::join(parts, ", "));
}

void readKnots(rubric::Criterion& criterion, std::string_view text) {
    constexpr const char* kExample = "1: 0, 1.5: 100, 2: 100, 2.5: 0";
    std::vector<rubric::Knot> knots;
    for (const std::string_view part : split(text, ',')) {
        const std::size_t colon = part.find(':');
        if (colon == std::string_view::npos) refuse(part, kExample);
        knots.push_back(
            {numberIn(part.substr(0, colon), part, kExample), numberIn(part.substr(colon + 1), part, kExample)});
    }
    criterion.knots = std::move(knots);
}

void readBands(rubric::Criterion& criterion, std::string_view text) {
    constexpr const char* kExample = "ideal 1.5..2; unacceptable 2..";
    std::vector<rubric::Band> bands;
    for (const std::string_view part : split(text, ';')) {
        const std::size_t dots = part.find(".."), blank = part.find_first_of(" \t");
        if (dots == std::string_view::npos || blank > dots) refuse(part, kExample);
        rubric::Band band;
        band.id = part.substr(0, blank);
        if (const std::string_view from = trimmed(part.substr(blank, dots - blank)); !from.empty())
            band.from = numberIn(from, part, kExample);
        std::string_view rest = part.substr(dots + 2);
        if (const std::size_t equals = rest.find('='); equals != std::string_view::npos) {
            band.points = numberIn(rest.substr(equals + 1), part, "fair 1..2 = 60");
            rest = rest.substr(0, equals);
        }
        if (rest = trimmed(rest); !rest.empty()) band.to = numberIn(rest, part, kExample);
        bands.push_back(std::move(band));
    }
    criterion.bands = std::move(bands);
}

void readCritical(rubric::Criterion& criterion, std::string_view text) {
    constexpr const char* kExample = "< 0.5, > 2.5";
    rubric::Critical critical;
    const std::vector<std::string_view> parts = split(text, ',');
    for (const std::string_view part : parts) {
        if (part.front() != '<' && part.front() != '>') refuse(part, kExample);
        (part.front() == '<' ? critical.below : critical.above) = numberIn(part.substr(1), part, kExample);
    }
    if (parts.empty()) {
        criterion.critical.reset();
        return;
    }
    if (criterion.critical) critical.title = criterion.critical->title;
    criterion.critical = std::move(critical);
}

void readSelection(rubric::Criterion& criterion, std::string_view text) {
    constexpr const char* kExample = "side mesial, statistic median";
    measures::Selection of;
    for (const std::string_view part : split(text, ',')) {
        const std::size_t blank = std::min(part.find(' '), part.size());
        const std::string_view what = part.substr(0, blank), value = trimmed(part.substr(blank));
        if (value.empty()) refuse(part, kExample);
        if (what == "zone")
            of.zone = value;
        else if (what == "tissue")
            of.tissue = value;
        else if (what == "side")
            of.side = value;
        else if (what == "statistic")
            of.statistic = value;
        else if (what == "limit")
            of.limit = numberIn(value, part, "limit 1.5");
        else
            refuse(part, kExample);
    }
    criterion.of = std::move(of);
}

}  // namespace handpiece::draft
