// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the sources of Books share.

#include <chrono>
#include <concepts>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "handpiece/base/core/error.h"
#include "handpiece/school/store/books.h"
#include "handpiece/school/store/database.h"

namespace handpiece::school {

/// SQLite in `data`, or PostgreSQL: as it is.
[[nodiscard]] std::unique_ptr<Database> openBooksDatabase(const std::filesystem::path& data, const std::string& address,
                                                          std::chrono::milliseconds patience);
/// Makes new books, brings older ones up; throws for another program's database and for a newer version.
void bringUpBooks(Database& database);
/// 0: there are none. Throws as bringUpBooks().
[[nodiscard]] int versionOfBooks(Database& database);
/// In a transaction that writes: from the version that they have, or from nothing.
void raiseBooks(Database& database, int version);

[[nodiscard]] core::Error unknown(const Database& database, const std::string& what, const std::string& which);
[[nodiscard]] core::Error duplicate(const Database& database, const std::string& what, const std::string& which);
[[nodiscard]] core::Error changed(const Database& database, const std::string& what, const std::string& which);
[[nodiscard]] core::Error invalid(const std::string& field, const std::string& value, const std::string& remedy);

inline constexpr const char* kStationColumns =
    "SELECT id, name, enrolled, revoked, kind, released, person, ends FROM stations";
/// A row of these.
[[nodiscard]] Station stationOf(const Statement& row);

/// Throws unless both databases keep it as it is: UTF-8 without a zero.
void requireText(std::string_view text);
/// Throws for infinity and what is no number; -0 becomes 0, which SQLite makes of it too.
[[nodiscard]] double requireNumber(double number);

/// The score of attempt `t` that counts: of the campaign that its assignment counts (Teaching::setCounting), else the
/// last.
inline constexpr const char* kCountingJob =
    "(SELECT l.job FROM scores l LEFT JOIN counting k ON k.assignment = t.assignment AND k.campaign = l.campaign "
    "WHERE l.attempt = t.id ORDER BY CASE WHEN k.campaign IS NULL THEN 0 ELSE 1 END DESC, l.job DESC LIMIT 1)";

/// A line of the audit that tells which work a marker had under a code, while that is not to be told
/// (Visible::behindCode).
#define HANDPIECE_TELLS_BLIND                                                                                        \
    "(what = 'work seen blind' OR what = 'give in marks' OR (what = 'mark' AND detail = 'blind')) AND about NOT IN " \
    "(SELECT attempt FROM releases)"

struct Books::State {
    std::unique_ptr<Database> database;
    ContentFiles files;

    /// A sentence with its values.
    template <class... Values>
    [[nodiscard]] Statement ask(const char* sql, const Values&... values) {
        Statement statement(*database, sql);
        (give(statement, values), ...);
        return statement;
    }
    template <class... Values>
    void run(const char* sql, const Values&... values) {
        ask(sql, values...).run();
    }
    /// Whether there is a row.
    template <class... Values>
    [[nodiscard]] bool any(const char* sql, const Values&... values) {
        return ask(sql, values...).next();
    }
    /// In a transaction that writes.
    void note(const Act& act, const std::string& what, const std::string& about, const std::string& detail = {});
    void requirePerson(const std::string& code);
    void requireAttempt(const std::string& id);
    void requireClass(const std::string& id);
    /// In a transaction that writes; false: it was there, the same.
    bool push(const Mark& mark, const Act& act);
    /// In a transaction that writes: attempts that are whole by now wait to be scored.
    void queueArrived(const std::string& attempt, Milliseconds now);
    /// In a transaction that writes: they go, with all that hangs on them, each with its line in the audit. Returns the
    /// files that nobody has any more, to be removed when it is committed.
    [[nodiscard]] std::vector<std::string> removeAttempts(const std::vector<std::string>& attempts, const Act& act);
    void keepFile(const std::string& hash, Milliseconds now);
    /// Of a file that was deleted from the books: unless it came again in the meantime.
    void removeFile(const std::string& hash);

  private:
    static void give(Statement& statement, std::string_view text) {
        requireText(text);
        statement.with(text);
    }
    template <std::integral Number>
    static void give(Statement& statement, Number number) {
        statement.with(static_cast<std::int64_t>(number));
    }
    static void give(Statement& statement, double number) { statement.with(requireNumber(number)); }
    static void give(Statement& statement, const std::optional<double>& number) {
        statement.with(number ? std::optional(requireNumber(*number)) : number);
    }
};

/// A cell of a row in a text: what would end it is written as \t, \n, \r and \\.
void addEscaped(std::string& line, std::string_view text);

}  // namespace handpiece::school
