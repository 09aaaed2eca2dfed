// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A TOML file as typed values, each wrong one told with file and line.

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace handpiece::config {

/// A table of a TOML document; cheap to copy, immutable, keeps the document alive. What a getter does not find it gives
/// as nothing; what has the wrong type throws core::Error with file, line and key.
class Table {
  public:
    /// Bytes of the longest text that is read.
    static constexpr std::uint64_t kMaxBytes = 1 << 20;
    /// `where` names the text in messages. Throws core::Error with the line when it is no TOML, or one of tables in
    /// tables without end; and when it is too long.
    [[nodiscard]] static Table parse(std::string_view text, std::string where, std::uint64_t mostBytes = kMaxBytes);
    /// Of a plain file.
    [[nodiscard]] static Table read(const std::filesystem::path& file);

    [[nodiscard]] bool has(std::string_view key) const;
    /// In alphabetical order.
    [[nodiscard]] std::vector<std::string> keys() const;
    [[nodiscard]] std::optional<std::string> text(std::string_view key) const;
    /// Integers too; never infinite, never not-a-number (those throw).
    [[nodiscard]] std::optional<double> number(std::string_view key) const;
    [[nodiscard]] std::optional<std::int64_t> integer(std::string_view key) const;
    [[nodiscard]] std::optional<bool> flag(std::string_view key) const;
    [[nodiscard]] std::optional<Table> table(std::string_view key) const;
    [[nodiscard]] bool isTable(std::string_view key) const;
    /// Lists; empty when there is none.
    [[nodiscard]] std::vector<Table> tables(std::string_view key) const;
    [[nodiscard]] std::vector<std::string> texts(std::string_view key) const;
    [[nodiscard]] std::vector<double> numbers(std::string_view key) const;
    /// A list of lists of numbers.
    [[nodiscard]] std::vector<std::vector<double>> numberRows(std::string_view key) const;

    /// Where a key stands in the text, from 1 (the table itself when empty); 0 where nobody knows.
    [[nodiscard]] int line(std::string_view key = {}) const;

    /// Throws for a key that is none of these: a misspelt one would be passed over in silence.
    void allowOnly(std::initializer_list<std::string_view> known) const;
    /// Throws core::Error: `problem` with the line of `key` (of the table itself when empty).
    [[noreturn]] void fail(const std::string& problem, const std::string& remedy = {}, std::string_view key = {}) const;
    [[nodiscard]] const std::string& where() const { return where_; }

  private:
    Table(std::shared_ptr<const void> node, std::string where) : node_(std::move(node)), where_(std::move(where)) {}
    std::shared_ptr<const void> node_;  // a toml::table: its header stays in the source
    std::string where_;
};

}  // namespace handpiece::config
