// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/keeping/person_export.h"

#include <fmt/format.h>

#include <map>
#include <vector>

#include "handpiece/base/core/csv_cell.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/large_package.h"
#include "handpiece/school/store/books_accounts.h"

namespace handpiece::school {
namespace {

std::string csvOf(const BookTable& table) {
    std::string csv = "\xef\xbb\xbf";
    const auto add = [&csv](const std::vector<std::string>& row) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (i > 0) csv += ',';
            csv += core::csvCell(row[i]);
        }
        csv += "\r\n";
    };
    add(table.columns);
    for (const std::vector<std::string>& row : table.rows)
        add(row);
    return csv;
}

constexpr const char* kAbout =
    "All that this school's server holds of one person, {}.\n\n"
    "tables/*.csv     each table of the server's books, the lines that are about them; open with any spreadsheet\n"
    "                 program. Times are milliseconds since 1970-01-01 (UTC). audit.csv: who looked at what, and "
    "when.\n"
    "                 Not who marked it: marks are the school's.\n"
    "sessions/*.h5    recordings of their work, by their SHA-256 (HDF5; handpiece replay, or h5dump); which belongs "
    "to\n"
    "                 which attempt stands in tables/attempt_files.csv\n\n"
    "Passwords and codes are kept as hashes only and are not in here.\n";

std::vector<std::byte> asBytesOf(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

}  // namespace

void exportPerson(Books& books, const std::string& code, const std::filesystem::path& file, const Act& act) {
    cases::PackageFiles small;
    small["READ-ME.txt"] = asBytesOf(fmt::format(kAbout, code));
    for (const BookTable& table : books.about(code, act))
        small["tables/" + table.name + ".csv"] = asBytesOf(csvOf(table));
    std::map<std::string, std::filesystem::path> sessions;
    for (const std::string& hash : BooksAccounts(books).filesOf(code))
        sessions["sessions/" + hash + ".h5"] = books.files().path(hash);
    cases::writeLargePackage(file, small, sessions);
}

}  // namespace handpiece::school
