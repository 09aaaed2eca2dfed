// SPDX-License-Identifier: Apache-2.0
#include "studies/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <iostream>
#include <iterator>
#include <optional>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::studies {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMaxCsvBytes = 2ull << 30;

std::string_view trimmed(std::string_view text) {
    const auto isSpace = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '"'; };
    while (!text.empty() && isSpace(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && isSpace(text.back()))
        text.remove_suffix(1);
    return text;
}

std::vector<std::string_view> cellsOf(std::string_view line) {
    std::vector<std::string_view> cells;
    for (std::size_t from = 0; from <= line.size();) {
        const std::size_t comma = std::min(line.find(',', from), line.size());
        cells.push_back(trimmed(line.substr(from, comma - from)));
        from = comma + 1;
    }
    return cells;
}

std::optional<double> numberIn(std::string_view cell) {
    if (!cell.empty() && cell.front() == '+') cell.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc{} || end != cell.data() + cell.size() || cell.empty()) return {};
    return value;
}

}  // namespace

CsvTable readCsv(const std::string& path, const std::vector<std::string>& columns) {
    CsvTable table;
    table.source = path == "-" ? "standard input" : path;
    std::string text;
    if (path == "-") {
        text.assign(std::istreambuf_iterator<char>(std::cin), {});
    } else {
        const std::vector<std::byte> bytes = core::readFile(path, kMaxCsvBytes);
        text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }
    std::vector<std::size_t> place;
    std::size_t width = columns.size(), number = 0;
    std::string_view rest(text);
    if (rest.substr(0, 3) == "\xef\xbb\xbf") rest.remove_prefix(3);
    while (!rest.empty()) {
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        const std::string_view line = trimmed(rest.substr(0, end));
        rest.remove_prefix(std::min(end + 1, rest.size()));
        ++number;
        if (line.empty() || line.front() == '#') continue;
        const std::vector<std::string_view> cells = cellsOf(line);
        if (place.empty()) {
            const bool isHeader = !numberIn(cells.front()).has_value() &&
                                  std::find(cells.begin(), cells.end(), columns.front()) != cells.end();
            for (std::size_t c = 0; c < columns.size(); ++c) {
                const auto at = isHeader ? std::find(cells.begin(), cells.end(), columns[c]) - cells.begin()
                                         : static_cast<std::ptrdiff_t>(c);
                if (at == static_cast<std::ptrdiff_t>(cells.size()))
                    throw core::Error(fmt::format("line {}: there is no column \"{}\"", number, columns[c]),
                                      table.source, fmt::format("the columns are {}", fmt::join(columns, ",")));
                place.push_back(static_cast<std::size_t>(at));
            }
            if (isHeader) {
                width = cells.size();
                continue;
            }
        }
        if (cells.size() != width)
            throw core::Error(fmt::format("line {} has {} values, not {}", number, cells.size(), width), table.source,
                              fmt::format("the columns are {}", fmt::join(columns, ",")));
        std::vector<double> row;
        for (const std::size_t at : place) {
            const std::optional<double> value = numberIn(cells[at]);
            if (!value || !std::isfinite(*value))
                throw core::Error(
                    fmt::format("line {}: \"{}\" is not a finite number", number, cells[at].substr(0, 40)),
                    table.source);
            row.push_back(*value);
        }
        table.rows.push_back(std::move(row));
        table.lines.push_back(number);
    }
    if (table.rows.empty())
        throw core::Error("there is no line of numbers", table.source,
                          fmt::format("the columns are {}", fmt::join(columns, ",")));
    return table;
}

core::Pose poseFrom(const std::vector<double>& row, std::size_t first, const CsvTable& table, std::size_t index) {
    core::Pose pose;
    pose.positionMm = {row[first], row[first + 1], row[first + 2]};
    pose.orientation = core::Quat(row[first + 3], row[first + 4], row[first + 5], row[first + 6]);
    const double norm = pose.orientation.norm();
    if (std::abs(norm - 1.0) > 1e-3)
        throw core::Error(fmt::format("line {}: the quaternion's length is {:.6g}, not 1", table.lines[index], norm),
                          table.source, "columns qw,qx,qy,qz of a rotation");
    pose.orientation.coeffs() /= norm;
    return pose;
}

TextWriter::TextWriter(std::string path) : path_(std::move(path)) {
    if (path_ == "-") {
        file_ = stdout;
        return;
    }
    std::error_code ec;
    const fs::path target(path_);
    if (fs::is_directory(target, ec)) throw core::Error("this is a folder, not a file", path_, "name a file");
    // Devices and pipes are written to directly: they cannot be renamed into.
    temporary_ = fs::exists(target, ec) && !fs::is_regular_file(target, ec) ? path_ : path_ + ".part";
    file_ = std::fopen(temporary_.c_str(), "wb");
    if (!file_)
        throw core::Error(fmt::format("cannot be written: {}", std::strerror(errno)), path_,
                          "check the folder, its permissions and the free space");
}

TextWriter::~TextWriter() {
    if (file_ && file_ != stdout) {
        std::fclose(file_);
        std::error_code ec;
        if (temporary_ != path_) fs::remove(temporary_, ec);
    }
}

void TextWriter::fail() {
    throw core::Error(fmt::format("cannot be written: {}", std::strerror(errno)),
                      path_ == "-" ? "standard output" : path_, "check the folder, its permissions and the free space");
}

void TextWriter::write(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail();
}

void TextWriter::commit() {
    if (std::fflush(file_) != 0) fail();
    if (file_ == stdout) return;
    std::FILE* closing = file_;
    file_ = nullptr;
    std::error_code ec;
    if (std::fclose(closing) != 0) {
        const int why = errno;
        if (temporary_ != path_) fs::remove(temporary_, ec);
        errno = why;
        fail();
    }
    if (temporary_ == path_) return;
    fs::rename(temporary_, path_, ec);
    if (ec) {
        const std::string why = ec.message();
        fs::remove(temporary_, ec);
        throw core::Error("cannot be written: " + why, path_, "check the folder and its permissions");
    }
}

}  // namespace handpiece::studies
