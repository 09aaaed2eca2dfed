// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/package_type.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "handpiece/base/config/table.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/model/case/case_files.h"

namespace handpiece::cases {
namespace {

constexpr std::int64_t kTypeFormat = 1;
constexpr std::size_t kMostTypeBytes = 64 << 10;
constexpr const char* kExerciseFile = "exercise.toml";

const char* holds(PackageType type) {
    switch (type) {
        case PackageType::toothCase:
            return kCaseFile;
        case PackageType::exercise:
            return kExerciseFile;
        case PackageType::attempt:
        case PackageType::handIn:
            return kAttemptFile;
        case PackageType::exam:
            break;
    }
    return kPackageFile;
}

}  // namespace

void setPackageType(PackageFiles& files, PackageType type) {
    const std::string text =
        fmt::format("format = {}\ntype = \"{}\"\n", kTypeFormat, kPackageTypes[static_cast<std::size_t>(type)]);
    const auto bytes = std::as_bytes(std::span(text));
    files[kPackageFile] = {bytes.begin(), bytes.end()};
}

std::optional<PackageType> packageType(const PackageFiles& files, const std::string& where) {
    const auto said = files.find(kPackageFile);
    if (said == files.end()) {
        for (const PackageType type : {PackageType::exercise, PackageType::attempt, PackageType::toothCase})
            if (files.contains(holds(type))) return type;
        return std::nullopt;
    }
    const std::string in = fmt::format("{} in {}", kPackageFile, where);
    if (said->second.size() > kMostTypeBytes)
        throw core::Error(fmt::format("it has {} bytes, more than {}", said->second.size(), kMostTypeBytes), in,
                          "get it from where it was made");
    const config::Table root =
        config::Table::parse({reinterpret_cast<const char*>(said->second.data()), said->second.size()}, in);
    if (const std::int64_t format = root.integer("format").value_or(0); format != kTypeFormat)
        root.fail(fmt::format("the file's format is {}, this program reads format {}", format, kTypeFormat),
                  format > kTypeFormat ? "use a newer Handpiece" : "get it from where it was made", "format");
    const std::string name = root.text("type").value_or("");
    const auto found = std::find(kPackageTypes.begin(), kPackageTypes.end(), name);
    if (found == kPackageTypes.end())
        root.fail(fmt::format("there is no type \"{}\"", name.substr(0, 60)),
                  fmt::format("one of {}; a newer Handpiece may know it", fmt::join(kPackageTypes, ", ")), "type");
    const auto type = static_cast<PackageType>(found - kPackageTypes.begin());
    if (!files.contains(holds(type)))
        throw core::Error(fmt::format("it says that it is of type {}, and has no {}", name, holds(type)), where,
                          "get it from where it was made");
    return type;
}

std::optional<PackageType> packageType(const std::filesystem::path& file) {
    return packageType(lookInto(file, [](const std::string& name) { return name == kPackageFile; }), file.string());
}

void requireOpenable(const PackageFiles& files, const std::string& where) {
    if (packageType(files, where) == PackageType::exam)
        throw core::Error("this is an exam, which only its school's station opens", where, "ask who gave it out");
}

}  // namespace handpiece::cases
