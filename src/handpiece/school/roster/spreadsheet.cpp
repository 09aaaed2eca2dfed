// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/roster/spreadsheet.h"

#include <fmt/format.h>
#include <iconv.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/utf8.h"

namespace handpiece::school {
namespace {

constexpr std::size_t kMostColumns = 500;
constexpr const char* kSaveAnew = "save it as \"CSV UTF-8\"";

[[noreturn]] void refuse(const std::string& where, std::size_t line, const std::string& problem,
                         const std::string& remedy) {
    const std::string place = fmt::format("{}, line {}", where, line);
    throw core::Error(problem, place, remedy).as("list-unfit", {place, problem});
}

void addUtf8(std::string& text, std::uint32_t c) {
    const auto add = [&text](std::uint32_t byte) { text += static_cast<char>(byte); };
    if (c < 0x80) return add(c);
    if (c < 0x800) return add(0xc0 | c >> 6), add(0x80 | (c & 63));
    if (c < 0x10000) return add(0xe0 | c >> 12), add(0x80 | (c >> 6 & 63)), add(0x80 | (c & 63));
    add(0xf0 | c >> 18), add(0x80 | (c >> 12 & 63)), add(0x80 | (c >> 6 & 63)), add(0x80 | (c & 63));
}

/// What Excel calls "Unicode text".
std::string fromUtf16(std::string_view bytes, bool isBigEndian, const std::string& where) {
    std::string text;
    std::size_t line = 1;
    const auto unit = [&](std::size_t at) {
        const auto a = static_cast<unsigned char>(bytes[at]), b = static_cast<unsigned char>(bytes[at + 1]);
        return static_cast<std::uint32_t>(isBigEndian ? a << 8 | b : b << 8 | a);
    };
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
        std::uint32_t c = unit(i);
        if (c >= 0xd800 && c < 0xe000) {
            const std::uint32_t second = c < 0xdc00 && i + 3 < bytes.size() ? unit(i + 2) : 0;
            if (second < 0xdc00 || second >= 0xe000) refuse(where, line, "half a character stands here", kSaveAnew);
            c = 0x10000 + ((c - 0xd800) << 10) + (second - 0xdc00), i += 2;
        }
        if (c == '\n') ++line;
        addUtf8(text, c);
    }
    if (bytes.size() % 2 != 0) refuse(where, line, "the text ends in the middle of a character", "save it again");
    return text;
}

/// What a Japanese Windows calls "CSV". Empty where these bytes are none of its, or would be a kanji behind a small
/// letter: so the accented letters of western Europe look.
std::string fromShiftJis(std::string_view bytes) {
    const iconv_t way = iconv_open("UTF-8", "CP932");
    if (way == reinterpret_cast<iconv_t>(-1)) return {};
    std::string text(3 * bytes.size() + 16, '\0');
    char* from = const_cast<char*>(bytes.data());
    char* to = text.data();
    std::size_t left = bytes.size(), room = text.size();
    const bool isRead = iconv(way, &from, &left, &to, &room) != static_cast<std::size_t>(-1) && left == 0;
    iconv_close(way);
    if (!isRead) return {};
    text.resize(text.size() - room);
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = core::utf8Length(std::string_view(text).substr(i));
        if (length > 1) {
            const std::string_view one = std::string_view(text).substr(i, length);
            const bool isJapanese = (one >= "\u3000" && one <= "\u30ff") || (one >= "\u4e00" && one <= "\u9fff") ||
                                    (one >= "\uff01" && one <= "\uff9f");
            if (!isJapanese || (i > 0 && text[i - 1] >= 'a' && text[i - 1] <= 'z')) return {};
        }
        i += std::max<std::size_t>(length, 1);
    }
    return text;
}

void requireUtf8(std::string_view text, const std::string& where) {
    const std::size_t good = core::utf8Prefix(text);
    if (good == text.size()) return;
    const auto line = 1 + static_cast<std::size_t>(std::count(text.begin(), text.begin() + good, '\n'));
    refuse(where, line, fmt::format("byte {:02x} is no UTF-8", static_cast<unsigned char>(text[good])), kSaveAnew);
}

/// Of the three the one that stands most often in the first line, outside of quotes.
char separatorOf(std::string_view text) {
    std::size_t count[3] = {};
    constexpr std::string_view kKnown = ",;\t";
    bool isQuoted = false;
    for (const char c : text) {
        if (c == '"') isQuoted = !isQuoted;
        if (isQuoted) continue;
        if (c == '\n' || c == '\r') break;
        if (const std::size_t which = kKnown.find(c); which != kKnown.npos) ++count[which];
    }
    return kKnown[static_cast<std::size_t>(std::max_element(std::begin(count), std::end(count)) - std::begin(count))];
}

class Reader {
  public:
    Reader(std::string_view text, char separator, std::size_t line, const std::string& where)
        : text_(text), separator_(separator), line_(line), where_(where) {}

    std::vector<Spreadsheet::Row> rows() {
        std::vector<Spreadsheet::Row> rows;
        while (at_ < text_.size())
            if (Spreadsheet::Row row = oneRow();
                std::any_of(row.cells.begin(), row.cells.end(), [](const std::string& c) { return !c.empty(); }))
                rows.push_back(std::move(row));
        return rows;
    }

  private:
    Spreadsheet::Row oneRow() {
        Spreadsheet::Row row{line_, {}};
        for (;;) {
            row.cells.push_back(cell());
            if (row.cells.size() > kMostColumns)
                refuse(where_, row.line, fmt::format("there are more than {} columns", kMostColumns),
                       "leave out those that are not needed");
            if (at_ < text_.size() && text_[at_] == separator_) {
                ++at_;
                continue;
            }
            endLine();
            return row;
        }
    }
    bool isLineEnd() const { return at_ >= text_.size() || text_[at_] == '\n' || text_[at_] == '\r'; }
    void endLine() {
        if (at_ < text_.size() && text_[at_] == '\r') ++at_;
        if (at_ < text_.size() && text_[at_] == '\n') ++at_;
        ++line_;
    }
    bool isBlank() const {
        return at_ < text_.size() && (text_[at_] == ' ' || (text_[at_] == '\t' && separator_ != '\t'));
    }
    std::string cell() {
        while (isBlank())
            ++at_;
        std::string out;
        if (at_ < text_.size() && text_[at_] == '"') {
            out = quoted();
        } else {
            const std::size_t from = at_;
            while (!isLineEnd() && text_[at_] != separator_)
                ++at_;
            out = text_.substr(from, at_ - from);
        }
        trim(out);
        if (out.size() > kMostCellBytes)
            refuse(where_, line_, fmt::format("a cell is longer than {} bytes", kMostCellBytes), "shorten it");
        for (const char c : out)
            if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
                refuse(where_, line_, "a cell has a line's end or another control character in it", "take it out");
        return out;
    }
    std::string quoted() {
        const std::size_t from = line_;
        std::string out;
        for (++at_;; ++at_) {
            if (at_ >= text_.size())
                refuse(where_, from, "a quote is opened and never closed", "close it, or double it");
            if (text_[at_] == '"') {
                if (at_ + 1 >= text_.size() || text_[at_ + 1] != '"') break;
                ++at_;
            }
            if (text_[at_] == '\n') ++line_;
            out += text_[at_];
        }
        ++at_;
        while (isBlank())
            ++at_;
        if (!isLineEnd() && text_[at_] != separator_)
            refuse(where_, line_, "there is something behind a closed quote",
                   "double a quote that belongs to the text, as \"\"");
        return out;
    }
    /// Also the blank that Japanese has, and the one that does not break.
    static void trim(std::string& text) {
        constexpr std::string_view kBlanks[] = {" ", "\t", "\r", "\n", "\xc2\xa0", "\xe3\x80\x80"};
        for (bool more = true; more;) {
            more = false;
            for (const std::string_view blank : kBlanks) {
                if (text.starts_with(blank)) text.erase(0, blank.size()), more = true;
                if (text.ends_with(blank)) text.erase(text.size() - blank.size()), more = true;
            }
        }
    }

    std::string_view text_;
    char separator_;
    std::size_t line_, at_ = 0;
    const std::string& where_;
};

}  // namespace

std::string inSmallLetters(std::string_view text) {
    std::string out(text);
    for (char& c : out)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return out;
}

Spreadsheet Spreadsheet::parse(std::string_view bytes, std::string where) {
    if (bytes.size() > kMostSpreadsheetBytes)
        refuse(where, 1, fmt::format("it has more than {} MB", kMostSpreadsheetBytes >> 20), "import it in parts");
    if (bytes.starts_with("PK\x03\x04") || bytes.starts_with("\xd0\xcf\x11\xe0"))
        refuse(where, 1, "this is a spreadsheet program's own file", kSaveAnew);
    std::string decoded;
    const bool isUtf16 = bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff");
    if (isUtf16) {
        decoded = fromUtf16(bytes.substr(2), bytes.starts_with("\xfe\xff"), where);
        bytes = decoded;
    } else if (bytes.starts_with("\xef\xbb\xbf")) {
        bytes.remove_prefix(3);
    } else if (core::utf8Prefix(bytes) < bytes.size()) {
        if (decoded = fromShiftJis(bytes); !decoded.empty()) bytes = decoded;
    }
    requireUtf8(bytes, where);
    std::size_t line = 1;
    char separator = separatorOf(bytes);
    // Excel's own first line, which it never shows.
    if (inSmallLetters(bytes.substr(0, 4)) == "sep=" && bytes.size() > 5 && (bytes[5] == '\r' || bytes[5] == '\n')) {
        separator = bytes[4];
        bytes.remove_prefix(bytes.substr(5).starts_with("\r\n") ? 7 : 6);
        ++line;
    }
    Spreadsheet table;
    table.where_ = std::move(where);
    table.isShiftJis_ = !decoded.empty() && !isUtf16;
    std::vector<Row> rows = Reader(bytes, separator, line, table.where_).rows();
    if (rows.empty()) refuse(table.where_, line, "there is nothing in it", "begin with a line of columns' names");
    Row head = std::move(rows.front());
    rows.erase(rows.begin());
    for (const std::string& name : head.cells) {
        const bool isTwice = !name.empty() && table.columnOf(name) < table.names_.size();
        if (isTwice) refuse(table.where_, head.line, fmt::format("there are two columns \"{}\"", name), "keep one");
        table.names_.push_back(name);
        table.small_.push_back(inSmallLetters(name));
    }
    for (Row& row : rows) {
        for (std::size_t i = table.names_.size(); i < row.cells.size(); ++i)
            if (!row.cells[i].empty())
                refuse(table.where_, row.line,
                       fmt::format("\"{}\" stands in column {}, and {} columns have a name", row.cells[i].substr(0, 60),
                                   i + 1, table.names_.size()),
                       "put a cell that has a separator in it in quotes");
        row.cells.resize(table.names_.size());
    }
    table.rows_ = std::move(rows);
    return table;
}

std::size_t Spreadsheet::columnOf(std::string_view name) const {
    const std::string wanted = inSmallLetters(name);
    std::size_t i = 0;
    while (i < small_.size() && small_[i] != wanted)
        ++i;
    return i;
}

bool Spreadsheet::has(std::string_view name) const {
    return columnOf(name) < names_.size();
}

void Spreadsheet::require(std::initializer_list<std::string_view> names) const {
    for (const std::string_view name : names)
        if (!has(name)) {
            const std::string place = where_ + ", line 1";
            const std::string problem = fmt::format("there is no column \"{}\"", name);
            throw core::Error(problem, place, fmt::format("add it; there are: {}", fmt::join(names_, ", ")))
                .as("list-unfit", {place, problem});
        }
}

const std::string& Spreadsheet::cell(const Row& row, std::string_view name) const {
    static const std::string none;
    const std::size_t column = columnOf(name);
    return column < names_.size() ? row.cells[column] : none;
}

std::string Spreadsheet::placeOf(const Row& row, std::string_view name) const {
    return fmt::format("{}, line {}, column {}", where_, row.line, name);
}

void Spreadsheet::fail(const Row& row, std::string_view name, const std::string& problem,
                       const std::string& remedy) const {
    const std::string place = placeOf(row, name);
    throw core::Error(problem, place, remedy).as("list-unfit", {place, problem});
}

}  // namespace handpiece::school
