// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// SQLite as this room needs it: statements that throw core::Error, transactions that end themselves.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace handpiece::school {

class Database {
  public:
    Database(const std::filesystem::path& file, std::chrono::milliseconds patience);
    ~Database();
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    /// Statements without values, one or several.
    void run(const char* statements);
    [[nodiscard]] std::int64_t number(const char* query);
    [[nodiscard]] std::string text(const char* query);
    [[nodiscard]] bool isReadOnly() const;
    [[nodiscard]] const std::string& where() const noexcept { return where_; }
    /// What went wrong last, as core::Error.
    [[noreturn]] void fail() const;

  private:
    friend class Statement;
    friend class Transaction;
    std::string where_;
    sqlite3* handle_ = nullptr;
};

/// Values in their order, then rows.
class Statement {
  public:
    Statement(Database& database, const char* sql);
    ~Statement();
    Statement(const Statement&) = delete;
    Statement& operator=(const Statement&) = delete;

    Statement& with(std::string_view text);
    Statement& with(std::int64_t number);
    Statement& with(double number);
    Statement& with(const std::optional<double>& number);
    /// To the next row; false: there is none.
    [[nodiscard]] bool next();
    /// Without rows.
    void run();

    [[nodiscard]] std::string text(int column) const;
    [[nodiscard]] std::int64_t integer(int column) const;
    [[nodiscard]] double number(int column) const;
    [[nodiscard]] std::optional<double> optional(int column) const;

  private:
    Database& database_;
    sqlite3_stmt* statement_ = nullptr;
    int bound_ = 0;
};

/// Taken back unless it was committed. It has the right to write from its beginning, so that two programs wait for each
/// other and never find at the end that they cannot both have it.
class Transaction {
  public:
    explicit Transaction(Database& database) : database_(database) { database_.run("BEGIN IMMEDIATE"); }
    ~Transaction();
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
    void commit();

  private:
    Database& database_;
    bool isOpen_ = true;
};

}  // namespace handpiece::school
