// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/assessment/marks.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::assessment {
namespace {

constexpr std::size_t kMaxNameBytes = 200;

struct Row {
    std::vector<std::string> cells;
    std::size_t line = 0;
};

[[noreturn]] void fail(const std::string& where, std::size_t line, const std::string& problem,
                       const std::string& remedy) {
    throw core::Error(problem, fmt::format("{}:{}", where, line), remedy).as("bad-text", {problem});
}

/// Rows as RFC 4180 has them: cells in quotes may hold commas, line breaks and doubled quotes. Empty lines are passed
/// over.
std::vector<Row> rowsOf(std::string_view text, const std::string& where) {
    if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
    std::vector<Row> rows;
    Row row{{}, 1};
    std::string cell;
    std::size_t line = 1;
    bool wasQuoted = false;
    const auto endCell = [&] {
        if (!wasQuoted) {
            const auto first = cell.find_first_not_of(" \t"), last = cell.find_last_not_of(" \t");
            cell = first == std::string::npos ? std::string() : cell.substr(first, last - first + 1);
        }
        if (cell.size() > kMaxNameBytes) fail(where, line, "a cell is longer than 200 bytes", "shorten it");
        row.cells.push_back(std::move(cell));
        cell.clear();
        wasQuoted = false;
    };
    const auto endRow = [&] {
        endCell();
        if (row.cells.size() > 1 || !row.cells.front().empty()) rows.push_back(std::move(row));
        row = {{}, line + 1};
    };
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '"' && cell.find_first_not_of(" \t") == std::string::npos && !wasQuoted) {
            cell.clear();
            wasQuoted = true;
            const std::size_t from = line;
            for (++i;; ++i) {
                if (i >= text.size()) fail(where, from, "a quote is not closed", "close it");
                if (text[i] == '"') {
                    if (i + 1 >= text.size() || text[i + 1] != '"') break;
                    ++i;
                }
                if (text[i] == '\n') ++line;
                cell += text[i];
            }
        } else if (c == ',') {
            endCell();
        } else if (c == '\n') {
            endRow();
            ++line;
        } else if (c == '\r' && (i + 1 >= text.size() || text[i + 1] == '\n')) {
            continue;
        } else if (c == '\0') {
            fail(where, line, "the file is no text", "save it as CSV in UTF-8");
        } else if (wasQuoted) {
            if (c != ' ' && c != '\t')
                fail(where, line, "there is something behind a closed quote", "put a comma between");
        } else {
            cell += c;
        }
    }
    if (!cell.empty() || wasQuoted || !row.cells.empty()) endRow();
    return rows;
}

}  // namespace

std::vector<MarkTable> parseMarks(std::string_view text, const std::string& where) {
    if (text.size() > kMaxMarksBytes)
        throw core::Error(
            fmt::format("the file has {} bytes, more than the {} that are read", text.size(), kMaxMarksBytes), where)
            .as("too-large");
    const std::vector<Row> rows = rowsOf(text, where);
    if (rows.empty()) throw core::Error("there are no marks", where, "begin with the line item,rater,mark");
    const auto column = [&](const char* name) {
        const auto& head = rows.front().cells;
        if (std::count(head.begin(), head.end(), name) > 1)
            fail(where, rows.front().line, fmt::format("there are two columns \"{}\"", name), "keep one");
        const auto at = std::find(head.begin(), head.end(), name);
        return at == head.end() ? std::optional<std::size_t>{} : static_cast<std::size_t>(at - head.begin());
    };
    const auto needed = [&](const char* name) {
        const std::optional<std::size_t> at = column(name);
        if (!at)
            fail(where, rows.front().line, fmt::format("there is no column \"{}\"", name),
                 "begin with the line item,rater,mark");
        return *at;
    };
    const std::size_t itemAt = needed("item"), raterAt = needed("rater"), markAt = needed("mark");
    const std::optional<std::size_t> criterionAt = column("criterion");

    struct Building {
        MarkTable table;
        std::map<std::string, std::size_t> items, raters;
        std::vector<std::tuple<std::size_t, std::size_t, std::string>> marks;
        std::set<std::pair<std::size_t, std::size_t>> given;
    };
    std::vector<Building> all;
    std::map<std::string, std::size_t> byCriterion;
    for (std::size_t r = 1; r < rows.size(); ++r) {
        const Row& row = rows[r];
        if (row.cells.size() != rows.front().cells.size())
            fail(where, row.line,
                 fmt::format("the row has {} cells, the first line {}", row.cells.size(), rows.front().cells.size()),
                 "mend the row");
        const std::string criterion = criterionAt ? row.cells[*criterionAt] : std::string();
        const std::string &item = row.cells[itemAt], &rater = row.cells[raterAt], &mark = row.cells[markAt];
        if (item.empty() || rater.empty() || (criterionAt && criterion.empty()))
            fail(where, row.line, "item, rater or criterion is empty", "say whose mark it is and of what");
        const auto [at, isNew] = byCriterion.emplace(criterion, all.size());
        if (isNew) all.push_back({{criterion, {}, {}, {}, where}, {}, {}, {}, {}});
        Building& b = all[at->second];
        const auto place = [](std::map<std::string, std::size_t>& known, std::vector<std::string>& list,
                              const std::string& name) {
            const auto [found, added] = known.emplace(name, list.size());
            if (added) list.push_back(name);
            return found->second;
        };
        const std::size_t i = place(b.items, b.table.items, item), j = place(b.raters, b.table.raters, rater);
        if (b.table.raters.size() > kMaxRaters)
            fail(where, row.line, fmt::format("there are more than {} raters", kMaxRaters), "compare fewer at a time");
        if (!b.given.emplace(i, j).second)
            fail(where, row.line, fmt::format("\"{}\" has marked \"{}\" already", rater, item),
                 "give a repeated marking another rater's name, as \"A again\"");
        if (!mark.empty()) b.marks.emplace_back(i, j, mark);
    }
    if (all.empty()) throw core::Error("there are no marks", where, "add rows below the first line");
    std::vector<MarkTable> tables;
    std::size_t cells = 0;
    for (Building& b : all) {
        cells += b.table.items.size() * b.table.raters.size();
        if (cells > kMaxCells)
            throw core::Error(fmt::format("there are more than {} pairs of item and rater", kMaxCells), where,
                              "split the file");
        b.table.marks.resize(b.table.items.size() * b.table.raters.size());
        for (auto& [i, j, mark] : b.marks)
            b.table.marks[i * b.table.raters.size() + j] = std::move(mark);
        tables.push_back(std::move(b.table));
    }
    return tables;
}

std::vector<MarkTable> readMarks(const std::filesystem::path& file) {
    const std::vector<std::byte> bytes = core::readFile(file, kMaxMarksBytes);
    return parseMarks({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string());
}

}  // namespace handpiece::assessment
