// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A table as spreadsheet programs write it (CSV). docs/school-office.md#a-list-of-people.

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace handpiece::school {

inline constexpr std::size_t kMostSpreadsheetBytes = 64 << 20, kMostCellBytes = 2000;

/// A to Z as a to z.
[[nodiscard]] std::string inSmallLetters(std::string_view text);

/// Rows under a line of names. All texts are UTF-8 without control characters, without blanks around them.
class Spreadsheet {
  public:
    /// UTF-8 with and without a byte order mark, UTF-16 with one, or Shift_JIS (CP932); between cells a comma, a
    /// semicolon or a tab: whichever the line of names has most of, or what Excel's line "sep=;" names. Cells may stand
    /// in quotes (RFC 4180); rows without anything are passed over. Throws core::Error "list-unfit" with line and
    /// column.
    [[nodiscard]] static Spreadsheet parse(std::string_view bytes, std::string where);

    struct Row {
        std::size_t line = 0;
        std::vector<std::string> cells;  ///< as many as names
    };
    [[nodiscard]] const std::vector<std::string>& names() const noexcept { return names_; }
    [[nodiscard]] const std::vector<Row>& rows() const noexcept { return rows_; }
    [[nodiscard]] const std::string& where() const noexcept { return where_; }

    /// Which nothing in the file says: it was read so since it is no UTF-8.
    [[nodiscard]] bool isShiftJis() const noexcept { return isShiftJis_; }

    [[nodiscard]] bool has(std::string_view name) const;
    /// Throws core::Error for a column that is missing, naming those there are.
    void require(std::initializer_list<std::string_view> names) const;
    /// Empty where the column is not there. Large and small letters of names are the same.
    [[nodiscard]] const std::string& cell(const Row& row, std::string_view name) const;
    /// "FILE, line 3, column role".
    [[nodiscard]] std::string placeOf(const Row& row, std::string_view name) const;
    [[noreturn]] void fail(const Row& row, std::string_view name, const std::string& problem,
                           const std::string& remedy) const;

  private:
    [[nodiscard]] std::size_t columnOf(std::string_view name) const;
    std::string where_;
    std::vector<std::string> names_, small_;  ///< as written; in small letters
    std::vector<Row> rows_;
    bool isShiftJis_ = false;
};

}  // namespace handpiece::school
