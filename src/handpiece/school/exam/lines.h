// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The texts of this room: a first line that says what it is, then `key: value` a line, all of them, in one order.
/// There is one way to write each, so what is signed is what is read.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/base/core/error.h"

namespace handpiece::exam {

class LineWriter {
  public:
    /// `kind` with its version, as "handpiece exam pack 1".
    explicit LineWriter(std::string_view kind);
    /// Throws core::Error "books-invalid" for a value with a line's end or another control character.
    LineWriter& add(std::string_view key, std::string_view value);
    LineWriter& add(std::string_view key, std::int64_t value);
    [[nodiscard]] std::string text() const { return text_; }

  private:
    std::string text_;
};

/// Throws core::Error: "exam-damaged" (line, why), "exam-newer" for a later version.
class LineReader {
  public:
    LineReader(std::string_view text, std::string_view kind, std::string where);
    [[nodiscard]] bool isNext(std::string_view key) const;
    [[nodiscard]] std::string text(std::string_view key, std::size_t most);
    [[nodiscard]] std::string hex(std::string_view key, std::size_t digits);
    /// 1 to 64 letters, digits, '-', '_' and '.'.
    [[nodiscard]] std::string code(std::string_view key);
    [[nodiscard]] std::int64_t whole(std::string_view key, std::int64_t low, std::int64_t high);
    void end() const;
    [[nodiscard]] core::Error damaged(std::string_view why) const;
    [[nodiscard]] const std::string& where() const { return where_; }

  private:
    std::string_view rest_;
    std::string where_;
    std::size_t line_ = 0;
};

/// Whether a text's first line says that it is of this kind and version.
[[nodiscard]] bool isOfKind(std::string_view text, std::string_view kind);
[[nodiscard]] bool isCode(std::string_view text);
/// Throws "exam-damaged" through the reader.
[[nodiscard]] std::int64_t wholeOf(const LineReader& reader, std::string_view text, std::int64_t low,
                                   std::int64_t high);
/// At single spaces; an empty text has no part.
[[nodiscard]] std::vector<std::string> partsOf(std::string_view text, char between);

}  // namespace handpiece::exam
