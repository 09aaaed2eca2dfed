// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What this room asks of a database, whichever it is: statements that throw core::Error, transactions that end
/// themselves. SQLite in database_sqlite.h, PostgreSQL in database_postgres.h.
///
/// A sentence for both is written once, with values $1, $2, ... and what both understand: ON CONFLICT, RETURNING,
/// window functions, row numbers, CAST. One for SQLite alone may have ?, ?1 as well. What differs and cannot be written
/// once is asked of engine().

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace handpiece::school {

class Database {
  public:
    enum class Engine { sqlite, postgres };
    /// `write`: one at a time, whoever else writes waits. `beside`: goes on beside writers in PostgreSQL (rows are
    /// locked one by one), as `write` in SQLite. `read`: sees one state.
    enum class Access { write, beside, read };

    /// A statement with its values, then its rows. Columns count from 0, values from 1.
    class Rows {
      public:
        Rows() = default;
        Rows(const Rows&) = delete;
        Rows& operator=(const Rows&) = delete;
        virtual ~Rows() = default;
        virtual void bind(int place, std::string_view text) = 0;
        virtual void bind(int place, std::int64_t number) = 0;
        virtual void bind(int place, double number) = 0;
        virtual void bindNothing(int place) = 0;
        [[nodiscard]] virtual bool next() = 0;
        [[nodiscard]] virtual std::string text(int column) const = 0;
        [[nodiscard]] virtual std::int64_t integer(int column) const = 0;
        [[nodiscard]] virtual double number(int column) const = 0;
        [[nodiscard]] virtual bool isNothing(int column) const = 0;
    };

    Database() = default;
    virtual ~Database() = default;
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    [[nodiscard]] virtual Engine engine() const noexcept = 0;
    /// Statements without values, one or several.
    virtual void run(const char* statements) = 0;
    [[nodiscard]] virtual std::unique_ptr<Rows> prepare(const char* sql) = 0;
    virtual void begin(Access access) = 0;
    virtual void commit() = 0;
    virtual void rollBack() noexcept = 0;
    /// File or server, without a password.
    [[nodiscard]] const std::string& where() const noexcept { return where_; }

    /// The first column of the first row; 0 or nothing where there is none.
    [[nodiscard]] std::int64_t number(const char* query);
    [[nodiscard]] std::string text(const char* query);

  protected:
    std::string where_;
};

/// Values in their order, then rows.
class Statement {
  public:
    Statement(Database& database, const char* sql) : rows_(database.prepare(sql)) {}

    Statement& with(std::string_view text) { return rows_->bind(++bound_, text), *this; }
    Statement& with(std::int64_t number) { return rows_->bind(++bound_, number), *this; }
    Statement& with(double number) { return rows_->bind(++bound_, number), *this; }
    Statement& with(const std::optional<double>& number) {
        if (number) return with(*number);
        return rows_->bindNothing(++bound_), *this;
    }
    /// To the next row; false: there is none.
    [[nodiscard]] bool next() { return rows_->next(); }
    /// To the end.
    void run() {
        while (next()) {
        }
    }

    [[nodiscard]] std::string text(int column) const { return rows_->text(column); }
    [[nodiscard]] std::int64_t integer(int column) const { return rows_->integer(column); }
    [[nodiscard]] double number(int column) const { return rows_->number(column); }
    [[nodiscard]] std::optional<double> optional(int column) const {
        if (rows_->isNothing(column)) return {};
        return number(column);
    }

  private:
    std::unique_ptr<Database::Rows> rows_;
    int bound_ = 0;
};

/// Taken back unless it was committed. One that writes has the right to from its beginning, so that two programs wait
/// for each other and never find at the end that they cannot both have it.
class Transaction {
  public:
    explicit Transaction(Database& database, Database::Access access = Database::Access::write) : database_(database) {
        database_.begin(access);
    }
    ~Transaction() {
        if (isOpen_) database_.rollBack();
    }
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
    void commit() {
        database_.commit();
        isOpen_ = false;
    }

  private:
    Database& database_;
    bool isOpen_ = true;
};

/// A list in one field: none of the values has a line's end in it.
[[nodiscard]] std::string joinedLines(const std::vector<std::string>& all);
[[nodiscard]] std::vector<std::string> partedLines(const std::string& text);

}  // namespace handpiece::school
