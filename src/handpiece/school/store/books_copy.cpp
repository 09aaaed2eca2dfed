// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/store/books_copy.h"

#include <fmt/format.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "handpiece/base/core/file.h"
#include "handpiece/school/store/books_state.h"

namespace handpiece::school {
namespace {

namespace fs = std::filesystem;
using Engine = Database::Engine;

constexpr const char* kRemedy = "take another backup";

struct Column {
    std::string name;
    char kind;  ///< t text, i whole number, r number
};

std::vector<std::string> tablesOf(Database& database) {
    std::vector<std::string> all;
    // In the order in which they were made, so that each refers to earlier ones only.
    Statement rows(database, database.engine() == Engine::sqlite
                                 ? "SELECT name FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'sqlite_%' "
                                   "AND name <> 'handpiece_books' ORDER BY rowid"
                                 : "SELECT c.relname FROM pg_class c WHERE c.relkind = 'r' AND c.relnamespace = "
                                   "current_schema()::regnamespace AND c.relname <> 'handpiece_books' ORDER BY c.oid");
    while (rows.next())
        all.push_back(rows.text(0));
    return all;
}

std::vector<Column> columnsOf(Database& database, const std::string& table) {
    std::vector<Column> all;
    Statement rows(database, database.engine() == Engine::sqlite
                                 ? "SELECT name, type FROM pragma_table_info($1) ORDER BY cid"
                                 : "SELECT column_name, data_type FROM information_schema.columns WHERE table_schema = "
                                   "current_schema() AND table_name = $1 ORDER BY ordinal_position");
    rows.with(table);
    while (rows.next()) {
        const std::string type = rows.text(1);
        all.push_back({rows.text(0), type == "INTEGER" || type == "bigint"          ? 'i'
                                     : type == "REAL" || type == "double precision" ? 'r'
                                                                                    : 't'});
    }
    return all;
}

void addCell(std::string& line, const Database::Rows& rows, int at, char kind) {
    if (rows.isNothing(at))
        line += "\\N";
    else if (kind == 'i')
        line += std::to_string(rows.integer(at));
    else if (kind == 'r')
        line += fmt::format("{}", rows.number(at));
    else
        addEscaped(line, rows.text(at));
}

/// In the transaction that sees the state.
std::int64_t copyTable(Database& database, const std::string& table, const fs::path& file) {
    const std::vector<Column> columns = columnsOf(database, table);
    const core::FileStream out = core::createOwnFile(file);
    if (!out)
        throw core::Error(fmt::format("cannot be written: {}", std::strerror(errno)), file.string(), "make room")
            .as(core::writeErrorId(errno), {std::strerror(errno)});
    const auto write = [&](const std::string& line) {
        if (std::fwrite(line.data(), 1, line.size(), out.get()) != line.size())
            throw core::Error(fmt::format("cannot be written: {}", std::strerror(errno)), file.string(), "make room")
                .as(core::writeErrorId(errno), {std::strerror(errno)});
    };
    std::string head, names;
    for (const Column& column : columns) {
        head += fmt::format("{}{}:{}", head.empty() ? "" : "\t", column.name, column.kind);
        names += (names.empty() ? "" : ", ") + column.name;
    }
    write(head + "\n");
    std::int64_t count = 0;
    const auto copyRows = [&](const char* sql) {
        const std::unique_ptr<Database::Rows> rows = database.prepare(sql);
        std::int64_t some = 0;
        std::string line;
        for (; rows->next(); ++some) {
            line.clear();
            for (std::size_t i = 0; i < columns.size(); ++i) {
                if (i > 0) line += '\t';
                addCell(line, *rows, static_cast<int>(i), columns[i].kind);
            }
            write(line + "\n");
        }
        count += some;
        return some;
    };
    const std::string select = fmt::format("SELECT {} FROM {}", names, table);
    if (database.engine() == Engine::sqlite) {
        copyRows(select.c_str());
    } else {
        // libpq takes the whole answer into memory: some rows at a time.
        database.run(("DECLARE copied CURSOR FOR " + select).c_str());
        while (copyRows("FETCH 200 FROM copied") > 0) {
        }
        database.run("CLOSE copied");
    }
    if (std::fflush(out.get()) != 0)
        throw core::Error(fmt::format("cannot be written: {}", std::strerror(errno)), file.string(), "make room")
            .as(core::writeErrorId(errno), {std::strerror(errno)});
    return count;
}

core::Error damaged(const std::string& table, std::size_t line, const std::string& why) {
    return core::Error(fmt::format("line {} of the table {} is damaged: {}", line, table, why), {}, kRemedy)
        .as("store-damaged", {table});
}

std::vector<std::string_view> cellsOf(std::string_view line) {
    std::vector<std::string_view> all;
    for (std::size_t at = 0;;) {
        const std::size_t end = line.find('\t', at);
        all.push_back(line.substr(at, end == line.npos ? line.npos : end - at));
        if (end == line.npos) return all;
        at = end + 1;
    }
}

std::string unescaped(std::string_view text, const std::string& table, std::size_t line) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '\\') {
            out += text[i];
            continue;
        }
        const char next = ++i < text.size() ? text[i] : '\0';
        if (next != 't' && next != 'n' && next != 'r' && next != '\\') throw damaged(table, line, "a broken escape");
        out += next == 't' ? '\t' : next == 'n' ? '\n' : next == 'r' ? '\r' : '\\';
    }
    return out;
}

template <class Number>
Number numberIn(std::string_view text, const std::string& table, std::size_t line) {
    Number value{};
    const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (ec != std::errc() || end != text.data() + text.size()) throw damaged(table, line, "no number");
    return value;
}

void loadTable(Database& database, const CopiedTable& table, const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string text;
    if (!std::getline(in, text)) throw damaged(table.name, 1, "it is not there");
    const std::vector<Column> columns = columnsOf(database, table.name);
    std::string names, places;
    std::vector<char> kinds;
    for (const std::string_view one : cellsOf(text)) {
        const std::string_view name = one.substr(0, one.rfind(':'));
        const auto found =
            std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.name == name; });
        if (found == columns.end() || one != fmt::format("{}:{}", name, found->kind))
            throw damaged(table.name, 1, fmt::format("there is no column {}", one));
        kinds.push_back(found->kind);
        names += fmt::format("{}{}", names.empty() ? "" : ", ", name);
        places += fmt::format("{}${}", places.empty() ? "" : ", ", kinds.size());
    }
    const std::string sql = fmt::format("INSERT INTO {} ({}) VALUES ({})", table.name, names, places);
    std::size_t line = 1;
    for (; std::getline(in, text); ++line) {
        const std::vector<std::string_view> cells = cellsOf(text);
        if (cells.size() != kinds.size()) throw damaged(table.name, line + 1, "too many or too few cells");
        const std::unique_ptr<Database::Rows> row = database.prepare(sql.c_str());
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const int place = static_cast<int>(i) + 1;
            if (cells[i] == "\\N") {
                row->bindNothing(place);
            } else if (kinds[i] == 'i') {
                row->bind(place, numberIn<std::int64_t>(cells[i], table.name, line + 1));
            } else if (kinds[i] == 'r') {
                row->bind(place, numberIn<double>(cells[i], table.name, line + 1));
            } else {
                const std::string value = unescaped(cells[i], table.name, line + 1);
                requireText(value);
                row->bind(place, std::string_view(value));
            }
        }
        while (row->next()) {
        }
    }
    if (static_cast<std::int64_t>(line) - 1 != table.rows)
        throw damaged(table.name, line, fmt::format("{} rows were copied", table.rows));
}

/// Tables that a new school's books have rows in from their beginning.
bool isOfItself(const std::string& table) {
    return table == "incarnation";
}

/// In a transaction that writes.
void requireEmpty(Database& database) {
    for (const std::string& table : tablesOf(database))
        if (!isOfItself(table) && database.number(("SELECT count(*) FROM " + table).c_str()) > 0)
            throw core::Error(fmt::format("there are books already: {} has rows", table), database.where(),
                              "restore into an empty folder and database")
                .as("store-not-empty", {table});
}

}  // namespace

BooksCopy copyBooks(const fs::path& data, const std::string& address, const fs::path& folder) {
    // Books of before come up first.
    const Books books(data, address);
    constexpr auto kPatience = std::chrono::seconds(30);
    const std::unique_ptr<Database> writer = openBooksDatabase(data, address, kPatience),
                                    reader = openBooksDatabase(data, address, kPatience);
    BooksCopy copy;
    copy.version = Books::kVersion;
    fs::create_directories(folder / "files");
    std::unique_ptr<Transaction> seen;
    {
        // While nobody else writes: one state for the reader, and the files that belong to it.
        const Transaction still(*writer);
        seen = std::make_unique<Transaction>(*reader, Database::Access::read);
        Statement rows(*reader, "SELECT hash FROM files ORDER BY hash");
        while (rows.next())
            copy.files.push_back(rows.text(0));
        for (const std::string& hash : copy.files) {
            const fs::path from = books.files().path(hash), to = folder / "files" / hash;
            std::error_code why;
            fs::create_hard_link(from, to, why);
            if (why && core::isThere(from)) why.clear(), fs::copy_file(from, to, why);
            if (why)
                throw core::Error("a file that the books name cannot be read: " + why.message(), from.string(),
                                  "restore it from a backup of before")
                    .as("store-damaged", {hash});
        }
    }
    for (const std::string& table : tablesOf(*reader))
        copy.tables.push_back({table, copyTable(*reader, table, folder / (table + ".tsv"))});
    seen->commit();
    return copy;
}

void loadBooks(const BooksCopy& copy, const fs::path& folder, const fs::path& data, const std::string& address) {
    if (copy.version > Books::kVersion || copy.version < 1)
        throw core::Error(fmt::format("this backup is of version {}, and this program knows {}", copy.version,
                                      static_cast<int>(Books::kVersion)),
                          {}, "restore it with the newer Handpiece")
            .as("store-newer", {std::to_string(copy.version), std::to_string(static_cast<int>(Books::kVersion))});
    core::prepareOutputFolder(data, true);
    const ContentFiles files(data);
    const std::unique_ptr<Database> database = openBooksDatabase(data, address, std::chrono::seconds(30));
    Transaction transaction(*database);
    const int there = versionOfBooks(*database);
    if (there > 0) requireEmpty(*database);
    if (there > 0 && there != copy.version)
        throw core::Error(
            fmt::format("the books here are of version {}, and the backup of version {}", there, copy.version),
            database->where(), "restore it into a new folder and database, which come up by themselves")
            .as("store-not-empty", {std::to_string(there)});
    if (there == 0) raiseBooks(*database, copy.version);
    for (const std::string& hash : copy.files) {
        const fs::path from = folder / "files" / hash, to = files.path(hash);
        if (core::isThere(to)) continue;
        if (const int why = core::replaceFile(from, to, true); why != 0)
            throw core::Error(fmt::format("cannot be written: {}", std::strerror(why)), to.string(), "make room")
                .as(core::writeErrorId(why), {std::strerror(why)});
    }
    if (copy.version >= 3) database->run("DELETE FROM incarnation");
    for (const CopiedTable& table : copy.tables)
        loadTable(*database, table, folder / (table.name + ".tsv"));
    if (copy.version >= 2) database->run("DELETE FROM logins");
    raiseBooks(*database, Books::kVersion);
    // Stations send once more what they sent since the backup.
    database->run("DELETE FROM incarnation");
    Statement(*database, "INSERT INTO incarnation (id) VALUES ($1)").with(newId()).run();
    transaction.commit();
}

}  // namespace handpiece::school
