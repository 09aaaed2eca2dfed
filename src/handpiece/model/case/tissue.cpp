// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/tissue.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "handpiece/base/config/table.h"
#include "handpiece/base/core/error.h"

namespace handpiece::cases {

extern const char* const kTissuesToml;  // data/tissues.toml

namespace {

using config::Table;

constexpr std::int64_t kFormatVersion = 1;
// More than these is a slip of the unit, not a tissue.
constexpr double kMaxDampingNSPerMm = 10.0, kMaxFriction = 5.0, kMaxCuttingMm2PerN = 1.0;
constexpr int kMaxPriority = 1000;
constexpr const char* kRemedy = "see docs/physics.md#tissues";
// In the order of Tissue: the one thing about tissues that is not in the file.
constexpr std::array<std::string_view, kTissueCount> kNames = {"none",
                                                               "enamel",
                                                               "dentine",
                                                               "pulp",
                                                               "caries",
                                                               "cementum",
                                                               "gum",
                                                               "bone",
                                                               "neighbour",
                                                               "restoration",
                                                               "demineralised-enamel",
                                                               "caries-soft",
                                                               "caries-soft-to-leathery",
                                                               "caries-leathery",
                                                               "caries-leathery-to-firm",
                                                               "caries-firm",
                                                               "caries-firm-to-hard",
                                                               "stained-enamel",
                                                               "calculus"};

constexpr TissueTable namesOnly() {
    TissueTable table{};
    for (std::size_t i = 0; i < kTissueCount; ++i)
        table.rows[i].name = kNames[i];
    return table;
}

std::optional<Tissue> find(std::string_view name) {
    for (std::size_t i = 1; i < kTissueCount; ++i)
        if (kNames[i] == name) return static_cast<Tissue>(i);
    return {};
}

std::string listOfNames() {
    return fmt::format("{}", fmt::join(kNames.begin() + 1, kNames.end(), ", "));
}

/// Where a value stands: `key = value` or `key = { value = ..., source = ..., unchecked = ... }`.
struct Place {
    Table table;
    std::string_view key;
};
Place placeOf(const Table& row, std::string_view key) {
    if (!row.isTable(key)) return {row, key};
    const Table inner = *row.table(key);
    inner.allowOnly({"value", "source", "unchecked"});
    (void)inner.text("source");
    (void)inner.flag("unchecked");
    if (!inner.has("value")) inner.fail(fmt::format("\"{}\" has no value", key), kRemedy);
    return {inner, "value"};
}

void readNumber(const Table& row, std::string_view tissue, std::string_view key, double most, double& value) {
    if (!row.has(key)) return;
    const Place place = placeOf(row, key);
    value = *place.table.number(place.key);
    if (value >= 0.0 && value <= most) return;
    place.table.fail(fmt::format("{} of {} is {}", key, tissue, value), fmt::format("give 0 to {}", most), place.key);
}

void readColour(const Table& row, std::string_view tissue, std::array<std::uint8_t, 3>& colour) {
    if (!row.has("colour")) return;
    const Place place = placeOf(row, "colour");
    const std::string text = *place.table.text(place.key);
    unsigned rgb = 0;
    const char* end = text.data() + text.size();
    const bool isHex = text.size() == 7 && text[0] == '#' && std::from_chars(text.data() + 1, end, rgb, 16).ptr == end;
    if (!isHex)
        place.table.fail(fmt::format("colour of {} is \"{}\"", tissue, text), "give it as \"#rrggbb\"", place.key);
    colour = {static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8 & 255),
              static_cast<std::uint8_t>(rgb & 255)};
}

void readPriority(const Table& row, std::string_view tissue, int& priority) {
    if (!row.has("priority")) return;
    const Place place = placeOf(row, "priority");
    const std::int64_t value = *place.table.integer(place.key);
    if (value < -kMaxPriority || value > kMaxPriority)
        place.table.fail(fmt::format("priority of {} is {}", tissue, value),
                         fmt::format("give {} to {}", -kMaxPriority, kMaxPriority), place.key);
    priority = static_cast<int>(value);
}

/// A level between two others: by ratios what a hand tells apart by ratios.
void layBetween(const TissueProperties& a, const TissueProperties& b, TissueProperties& level) {
    level.stiffnessFraction = std::sqrt(a.stiffnessFraction * b.stiffnessFraction);
    level.cuttingMm2PerN = std::sqrt(a.cuttingMm2PerN * b.cuttingMm2PerN);
    level.dampingNSPerMm = 0.5 * (a.dampingNSPerMm + b.dampingNSPerMm);
    level.friction = 0.5 * (a.friction + b.friction);
    for (std::size_t i = 0; i < level.colour.size(); ++i)
        level.colour[i] = static_cast<std::uint8_t>((a.colour[i] + b.colour[i]) / 2);
    level.priority = (a.priority + b.priority) / 2;
}

TissueTable readOver(const TissueTable& base, const Table& root) {
    const std::int64_t version = root.integer("format").value_or(0);
    if (version != kFormatVersion)
        root.fail(fmt::format("the table's format is {}, this program reads format {}", version, kFormatVersion),
                  version > kFormatVersion ? "use a newer Handpiece" : "add the line: format = 1", "format");
    TissueTable table = base;
    for (const std::string& name : root.keys()) {
        if (name == "format") continue;
        const auto tissue = find(name);
        if (!tissue) root.fail(fmt::format("there is no tissue \"{}\"", name), "one of " + listOfNames(), name);
        const Table row = *root.table(name);
        row.allowOnly({"stiffness", "damping", "friction", "cutting", "colour", "priority"});
        TissueProperties& p = table.rows[static_cast<std::size_t>(*tissue)];
        readNumber(row, name, "stiffness", 1.0, p.stiffnessFraction);
        readNumber(row, name, "damping", kMaxDampingNSPerMm, p.dampingNSPerMm);
        readNumber(row, name, "friction", kMaxFriction, p.friction);
        readNumber(row, name, "cutting", kMaxCuttingMm2PerN, p.cuttingMm2PerN);
        readColour(row, name, p.colour);
        readPriority(row, name, p.priority);
    }
    for (std::size_t i = 1; i < kCariousLevels.size(); i += 2) {
        const Tissue level = kCariousLevels[i],
                     harder = i + 1 < kCariousLevels.size() ? kCariousLevels[i + 1] : Tissue::dentine;
        const auto row = static_cast<std::size_t>(level);
        if (!root.has(kNames[row])) layBetween(table.of(kCariousLevels[i - 1]), table.of(harder), table.rows[row]);
    }
    return table;
}

}  // namespace

const TissueTable& builtInTissues() {
    static const TissueTable table = readOver(namesOnly(), Table::parse(kTissuesToml, "data/tissues.toml"));
    return table;
}

TissueTable parseTissues(std::string_view text, const std::string& where) {
    return readOver(builtInTissues(), Table::parse(text, where));
}

void validate(const TissueTable& table) {
    for (const TissueProperties& p : table.rows) {
        const auto require = [&p](double value, double low, double high, std::string_view what) {
            if (!(value >= low && value <= high))
                throw core::Error(fmt::format("{} of {} is {}", what, p.name, value), "tissues",
                                  fmt::format("give {} to {}", low, high));
        };
        require(p.stiffnessFraction, 0.0, 1.0, "stiffness");
        require(p.dampingNSPerMm, 0.0, kMaxDampingNSPerMm, "damping");
        require(p.friction, 0.0, kMaxFriction, "friction");
        require(p.cuttingMm2PerN, 0.0, kMaxCuttingMm2PerN, "cutting");
        require(p.priority, -kMaxPriority, kMaxPriority, "priority");
    }
}

TissueTable readTissues(const std::filesystem::path& file) {
    return readOver(builtInTissues(), Table::read(file));
}

const TissueProperties& properties(Tissue tissue) {
    return builtInTissues().of(tissue);
}

Tissue tissueByName(std::string_view name) {
    if (const auto tissue = find(name)) return *tissue;
    throw core::Error(fmt::format("there is no tissue \"{}\"", name), "tissue", "one of " + listOfNames());
}

}  // namespace handpiece::cases
