// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>

#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/config/table.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::rubric {
namespace {

using config::Table;

constexpr std::size_t kMaxIdBytes = 64, kMaxLanguages = 40;
constexpr double kMostNumber = 1e12;

bool isId(std::string_view text) {
    return !text.empty() && text.size() <= kMaxIdBytes && std::all_of(text.begin(), text.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '.';
    });
}

std::string idIn(const Table& table, std::string_view key) {
    const std::optional<std::string> text = table.text(key);
    if (!text) table.fail(fmt::format("\"{}\" is missing", key), "give it a short name");
    if (!isId(*text))
        table.fail(fmt::format("\"{}\" is no name", text->substr(0, kMaxIdBytes)),
                   "small letters, digits, - and . only, 64 at most", key);
    return *text;
}

std::vector<std::string> idsIn(const Table& table, std::string_view key, std::size_t most) {
    std::vector<std::string> ids = table.texts(key);
    if (ids.size() > most) table.fail(fmt::format("\"{}\" has {} names, more than {}", key, ids.size(), most), {}, key);
    for (const std::string& id : ids)
        if (!isId(id))
            table.fail(fmt::format("\"{}\" is no name", id.substr(0, kMaxIdBytes)),
                       "small letters, digits, - and . only, 64 at most", key);
    if (std::set<std::string>(ids.begin(), ids.end()).size() != ids.size())
        table.fail(fmt::format("\"{}\" names something twice", key), "once is enough", key);
    return ids;
}

std::string textIn(const Table& table, std::string_view key) {
    std::string text = table.text(key).value_or("");
    if (text.size() > kMaxTextBytes)
        table.fail(fmt::format("\"{}\" has {} bytes, more than {}", key, text.size(), kMaxTextBytes), "say it shorter",
                   key);
    return text;
}

Texts textsIn(const Table& table, std::string_view key) {
    Texts texts;
    const std::optional<Table> inner = table.table(key);
    if (!inner) return texts;
    const std::vector<std::string> languages = inner->keys();
    if (languages.size() > kMaxLanguages) table.fail("more languages than there may be", "40 at most", key);
    for (const std::string& language : languages)
        texts.emplace(language, textIn(*inner, language));
    return texts;
}

std::optional<double> numberIn(const Table& table, std::string_view key) {
    const std::optional<double> number = table.number(key);
    if (number && std::abs(*number) > kMostNumber)
        table.fail(fmt::format("\"{}\" is {}", key, *number), "mind the unit", key);
    return number;
}

template <class T>
void requireFew(const Table& table, const std::vector<T>& list, std::string_view key, std::size_t most) {
    if (list.size() > most)
        table.fail(fmt::format("\"{}\" has {} entries, more than {}", key, list.size(), most), {}, key);
}
std::vector<Table> fewTables(const Table& table, std::string_view key, std::size_t most) {
    std::vector<Table> list = table.tables(key);
    requireFew(table, list, key, most);
    return list;
}

Status statusIn(const Table& table, std::string_view key) {
    const std::string name = textIn(table, key);
    for (const Status status : {Status::published, Status::adapted, Status::proposal})
        if (nameOf(status) == name) return status;
    table.fail(fmt::format("there is no status \"{}\"", name.substr(0, kMaxIdBytes)), "published, adapted or proposal",
               key);
}

Band readBand(const Table& table) {
    table.allowOnly({"id", "from", "to", "points"});
    Band band;
    band.id = idIn(table, "id");
    band.from = numberIn(table, "from");
    band.to = numberIn(table, "to");
    band.points = numberIn(table, "points");
    band.line = table.line();
    return band;
}

void readMeasure(const Table& table, std::string& measure, std::string& unit, measures::Selection& of) {
    measure = idIn(table, "measure");
    unit = textIn(table, "unit");
    of.zone = textIn(table, "zone");
    of.tissue = textIn(table, "tissue");
    of.side = textIn(table, "side");
    of.statistic = textIn(table, "statistic");
    of.limit = numberIn(table, "limit");
}

std::vector<Knot> knotsIn(const Table& table, const char* problem, const char* example) {
    std::vector<Knot> knots;
    const std::vector<std::vector<double>> rows = table.numberRows("knots");
    requireFew(table, rows, "knots", kMaxPieces);
    for (const std::vector<double>& row : rows) {
        if (row.size() != 2 || std::abs(row[0]) > kMostNumber) table.fail(problem, example, "knots");
        knots.push_back({row[0], row[1]});
    }
    return knots;
}

Completeness readCompleteness(const Table& table) {
    table.allowOnly(
        {"measure", "unit", "zone", "tissue", "side", "statistic", "limit", "knots", "title", "words", "source"});
    Completeness c;
    c.line = table.line();
    readMeasure(table, c.measure, c.unit, c.of);
    c.knots = knotsIn(table, "a knot is not [value, factor]", "write knots = [[0, 0], [70, 1]]");
    c.title = textsIn(table, "title");
    c.words = textsIn(table, "words");
    c.source = textIn(table, "source");
    return c;
}

Criterion readCriterion(const Table& table) {
    table.allowOnly({"id", "measure", "unit", "zone", "tissue", "side", "statistic", "limit", "weight", "knots",
                     "bands", "critical", "devices", "excludes", "title", "words", "leaves_out", "status", "source"});
    Criterion c;
    c.line = table.line();
    c.id = idIn(table, "id");
    readMeasure(table, c.measure, c.unit, c.of);
    if (const std::optional<double> weight = numberIn(table, "weight")) {
        if (*weight <= 0.0)
            table.fail(fmt::format("the weight is {}", *weight),
                       "give points above 0, or no weight at all to show the criterion without grading it", "weight");
        c.weight = *weight;
    }
    c.knots = knotsIn(table, "a knot is not [value, points]", "write knots = [[1.0, 0], [1.5, 100]]");
    for (const Table& row : fewTables(table, "bands", kMaxPieces))
        c.bands.push_back(readBand(row));
    if (const std::optional<Table> critical = table.table("critical")) {
        critical->allowOnly({"below", "above", "title"});
        c.critical = Critical{numberIn(*critical, "below"), numberIn(*critical, "above"), textsIn(*critical, "title"),
                              critical->line()};
    }
    c.devices = idsIn(table, "devices", kMaxPieces);
    c.excludes = idsIn(table, "excludes", kMaxCriteria);
    c.title = textsIn(table, "title");
    c.words = textsIn(table, "words");
    c.leavesOut = textsIn(table, "leaves_out");
    if (table.has("status")) c.status = statusIn(table, "status");
    c.source = textIn(table, "source");
    return c;
}

std::optional<std::int64_t> countIn(const Table& table, std::string_view key) {
    const std::optional<std::int64_t> count = table.integer(key);
    if (count && (*count < 0 || *count > static_cast<std::int64_t>(kMaxCriteria)))
        table.fail(fmt::format("\"{}\" is {}", key, *count), "count criteria, from 0", key);
    return count;
}

Rule readRule(const Table& table) {
    table.allowOnly({"id", "title", "needs", "required", "else_at_most", "source"});
    Rule rule;
    rule.line = table.line();
    rule.id = idIn(table, "id");
    rule.title = textsIn(table, "title");
    rule.required = table.flag("required").value_or(false);
    rule.elseAtMost = numberIn(table, "else_at_most");
    rule.source = textIn(table, "source");
    for (const Table& row : fewTables(table, "needs", kMaxPieces)) {
        row.allowOnly({"bands", "of", "least", "most", "rule"});
        Condition condition;
        condition.bands = idsIn(row, "bands", kMaxPieces);
        condition.of = idsIn(row, "of", kMaxCriteria);
        condition.least = countIn(row, "least");
        condition.most = countIn(row, "most");
        if (row.has("rule")) condition.rule = idIn(row, "rule");
        const bool counts = !condition.bands.empty() && (condition.least || condition.most);
        if (counts == !condition.rule.empty() || (!condition.rule.empty() && row.keys().size() > 1))
            row.fail("a condition is neither a count nor a rule",
                     "write { bands = [\"unacceptable\"], most = 0 } or { rule = \"name\" }");
        rule.needs.push_back(std::move(condition));
    }
    if (rule.needs.empty()) table.fail("the rule needs nothing", "give needs = [ ... ]");
    return rule;
}

}  // namespace

std::string_view nameOf(Status status) {
    return status == Status::published ? "published" : status == Status::adapted ? "adapted" : "proposal";
}

const Criterion* Rubric::criterion(std::string_view name) const {
    const auto at = std::find_if(criteria.begin(), criteria.end(), [&](const Criterion& c) { return c.id == name; });
    return at == criteria.end() ? nullptr : &*at;
}

Rubric parseRubric(std::string_view text, const std::string& where) {
    const Table table = Table::parse(text, where, kMaxBytes);
    table.allowOnly({"format", "id", "version", "title", "words", "status", "source", "total_weight", "pass_mark",
                     "completeness", "band", "step", "criterion", "rule"});
    const std::optional<std::int64_t> format = table.integer("format");
    if (!format) table.fail("\"format\" is missing", "write format = 1");
    if (*format != 1)
        table.fail(fmt::format("format {} is not known", *format), "this program reads format 1: get a newer one",
                   "format");
    Rubric rubric;
    rubric.where = where;
    rubric.id = idIn(table, "id");
    rubric.version = idIn(table, "version");
    rubric.title = textsIn(table, "title");
    rubric.words = textsIn(table, "words");
    if (!table.has("status")) table.fail("\"status\" is missing", "published, adapted or proposal");
    rubric.status = statusIn(table, "status");
    rubric.source = textIn(table, "source");
    rubric.totalWeight = numberIn(table, "total_weight");
    rubric.passMark = numberIn(table, "pass_mark");
    if (const std::optional<Table> completeness = table.table("completeness"))
        rubric.completeness = readCompleteness(*completeness);
    for (const Table& row : fewTables(table, "band", kMaxPieces)) {
        row.allowOnly({"id", "title"});
        rubric.bands.push_back({idIn(row, "id"), textsIn(row, "title")});
    }
    for (const Table& row : fewTables(table, "step", kMaxCriteria)) {
        row.allowOnly({"id", "title", "criteria"});
        rubric.steps.push_back(
            {idIn(row, "id"), textsIn(row, "title"), idsIn(row, "criteria", kMaxCriteria), row.line()});
    }
    for (const Table& row : fewTables(table, "criterion", kMaxCriteria))
        rubric.criteria.push_back(readCriterion(row));
    for (const Table& row : fewTables(table, "rule", kMaxRules))
        rubric.rules.push_back(readRule(row));
    return rubric;
}

Rubric readRubric(const std::filesystem::path& file) {
    const std::vector<std::byte> bytes = core::readFile(file, kMaxBytes);
    return parseRubric({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string());
}

Rubric rubricByNameOrFile(const std::string& nameOrFile) {
    const std::vector<std::string> shipped = shippedRubrics();
    if (std::find(shipped.begin(), shipped.end(), nameOrFile) != shipped.end()) return shippedRubric(nameOrFile);
    if (isId(nameOrFile) && !core::isThere(nameOrFile)) return shippedRubric(nameOrFile);
    return readRubric(nameOrFile);
}

const Band* bandOf(const Criterion& criterion, double value) {
    for (const Band& band : criterion.bands)
        if ((!band.from || value >= *band.from) && (!band.to || value <= *band.to)) return &band;
    return nullptr;
}

namespace {

double onCurve(const std::vector<Knot>& knots, double value) {
    if (value <= knots.front().value) return knots.front().points;
    for (std::size_t i = 1; i < knots.size(); ++i) {
        const Knot &a = knots[i - 1], &b = knots[i];
        if (value > b.value) continue;
        const double points = a.points + (b.points - a.points) * ((value - a.value) / (b.value - a.value));
        // Rounding must not lead out of the piece.
        return std::clamp(points, std::min(a.points, b.points), std::max(a.points, b.points));
    }
    return knots.back().points;
}

}  // namespace

std::optional<double> pointsOf(const Criterion& criterion, double value) {
    if (!criterion.knots.empty()) return onCurve(criterion.knots, value);
    const Band* band = bandOf(criterion, value);
    return band ? band->points : std::nullopt;
}

double factorOf(const Completeness& completeness, double value) {
    return onCurve(completeness.knots, value);
}

}  // namespace handpiece::rubric
