// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/roster/roster_files.h"

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/package.h"
#include "handpiece/school/roster/spreadsheet.h"

namespace handpiece::school {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kZip = "PK\x03\x04";

std::string_view textOf(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

Roster readRoster(std::span<const std::byte> bytes, const std::string& name, const std::string& today) {
    if (!textOf(bytes).starts_with(kZip)) return peopleList(textOf(bytes), name);
    cases::PackageLimits limits;
    limits.bytes = kMostSpreadsheetBytes;
    return oneRoster(cases::readPackage(bytes, name, limits), name, today);
}

Roster readRoster(const fs::path& path, const std::string& today) {
    if (!core::isFolder(path)) return readRoster(core::readFile(path, kMostSpreadsheetBytes), path.string(), today);
    std::map<std::string, std::vector<std::byte>> files;
    std::error_code why;
    for (const auto& entry : fs::directory_iterator(path, why))
        if (entry.is_regular_file(why) && entry.path().extension() == ".csv")
            files[entry.path().filename().string()] = core::readFile(entry.path(), kMostSpreadsheetBytes);
    if (why) throw core::Error("the folder cannot be read: " + why.message(), path.string(), "check its permissions");
    return oneRoster(files, path.string(), today);
}

}  // namespace handpiece::school
