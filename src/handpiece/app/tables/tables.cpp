// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/tables/tables.h"

#include <fmt/format.h>

#include "handpiece/base/core/csv_cell.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/package.h"

namespace handpiece::tables {
namespace {

std::string cellOf(const Column& column, std::size_t row) {
    if (const auto* texts = std::get_if<Texts>(&column.values)) return core::csvCell((*texts)[row]);
    if (const auto* whole = std::get_if<Whole>(&column.values)) return fmt::format("{}", (*whole)[row]);
    const std::optional<double>& value = std::get<Numbers>(column.values)[row];
    return value ? fmt::format("{}", *value) : std::string();
}

}  // namespace

std::size_t Table::rows() const {
    if (columns.empty()) return 0;
    return std::visit([](const auto& values) { return values.size(); }, columns.front().values);
}

std::string toCsv(const Table& table) {
    std::string out;
    for (std::size_t c = 0; c < table.columns.size(); ++c)
        out += (c > 0 ? "," : "") + core::csvCell(table.columns[c].name);
    out += "\r\n";
    for (std::size_t row = 0; row < table.rows(); ++row) {
        for (std::size_t c = 0; c < table.columns.size(); ++c) {
            if (c > 0) out += ',';
            out += cellOf(table.columns[c], row);
        }
        out += "\r\n";
    }
    return out;
}

std::string toZip(std::span<const Table> tables) {
    const core::PrivateFolder folder;
    const auto bytesOf = [](const std::string& text) {
        const auto* at = reinterpret_cast<const std::byte*>(text.data());
        return std::vector<std::byte>(at, at + text.size());
    };
    cases::PackageFiles files;
    for (const Table& table : tables)
        files[table.name + ".csv"] = bytesOf(toCsv(table));
    writeHdf5(tables, folder.path() / "results.h5");
    files["results.h5"] = core::readFile(folder.path() / "results.h5");
    cases::writePackage(folder.path() / "results.zip", files);
    const std::vector<std::byte> zip = core::readFile(folder.path() / "results.zip");
    return {reinterpret_cast<const char*>(zip.data()), zip.size()};
}

}  // namespace handpiece::tables
