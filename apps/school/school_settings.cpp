// SPDX-License-Identifier: Apache-2.0
#include "school/school_settings.h"

#include <fmt/format.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>

#include "handpiece/base/config/table.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "school/server.h"

namespace handpiece::school_cli {
namespace {

void fill(std::string& value, const std::string& from) {
    if (value.empty()) value = from;
}

/// A number of something, and how many of it there may be.
struct Count {
    const char* key;
    const char* variable;
    std::size_t least, most, asBuilt;
    std::optional<std::size_t> SchoolSettings::*value;
};
constexpr Count kCounts[] = {
    {"workers", "HANDPIECE_SCHOOL_WORKERS", 0, kMostWorkers, 1, &SchoolSettings::workers},
    {"connections", "HANDPIECE_SCHOOL_CONNECTIONS", 1, kMostConnections, 60, &SchoolSettings::connections}};

std::size_t countIn(const std::string& text, const Count& of) {
    std::size_t count = 0;
    const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (text.empty() || ec != std::errc() || end != text.data() + text.size() || count < of.least || count > of.most)
        throw core::Error(fmt::format("\"{}\" is no number of {}", text, of.key), of.variable,
                          fmt::format("write {} to {}", of.least, of.most));
    return count;
}

std::vector<std::string> partsOf(const std::string& text) {
    std::vector<std::string> parts;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find(',', at), text.size());
        if (end > at) parts.push_back(text.substr(at, end - at));
        at = end + 1;
    }
    return parts;
}

}  // namespace

Environment ownEnvironment() {
    return [](const char* name) { return static_cast<const char*>(std::getenv(name)); };
}

SchoolSettings settled(SchoolSettings s, const Environment& environment, const std::string& systemFile) {
    const auto variable = [&environment](const char* name) {
        const char* const value = environment(name);
        return std::string(value ? value : "");
    };
    fill(s.file, variable("HANDPIECE_SCHOOL_SETTINGS"));
    fill(s.data, variable("HANDPIECE_SCHOOL_DATA"));
    fill(s.database, variable("HANDPIECE_SCHOOL_DATABASE"));
    fill(s.listen, variable("HANDPIECE_SCHOOL_LISTEN"));
    fill(s.certificate, variable("HANDPIECE_SCHOOL_CERTIFICATE"));
    fill(s.key, variable("HANDPIECE_SCHOOL_KEY"));
    fill(s.address, variable("HANDPIECE_SCHOOL_ADDRESS"));
    fill(s.signOnSecret, variable("HANDPIECE_SCHOOL_SIGN_ON_SECRET"));
    fill(s.signOnHeader, variable("HANDPIECE_SCHOOL_SIGN_ON_HEADER"));
    if (s.signOnProxies.empty()) s.signOnProxies = partsOf(variable("HANDPIECE_SCHOOL_SIGN_ON_PROXIES"));
    if (s.proxies.empty()) s.proxies = partsOf(variable("HANDPIECE_SCHOOL_PROXIES"));
    if (const std::string text = variable("HANDPIECE_SCHOOL_OWN_STATIONS_ONLY"); !s.ownStationsOnly && !text.empty()) {
        if (text != "yes" && text != "no")
            throw core::Error(fmt::format("\"{}\" is neither yes nor no", text), "HANDPIECE_SCHOOL_OWN_STATIONS_ONLY",
                              "write yes or no");
        s.ownStationsOnly = text == "yes";
    }
    for (const Count& of : kCounts)
        if (const std::string text = variable(of.variable); !(s.*of.value) && !text.empty())
            s.*of.value = countIn(text, of);
    // The system's file is for those who may read it: a database's password may stand in it.
    if (s.file.empty() && !systemFile.empty() && access(systemFile.c_str(), R_OK) == 0) s.file = systemFile;
    if (!s.file.empty()) {
        const config::Table file = config::Table::read(s.file);
        file.allowOnly({"data", "database", "listen", "certificate", "key", "workers", "connections", "address",
                        "proxies", "sign_on_proxies", "sign_on_secret", "sign_on_header", "own_stations_only"});
        if (!s.ownStationsOnly) s.ownStationsOnly = file.flag("own_stations_only");
        fill(s.data, file.text("data").value_or(""));
        fill(s.database, file.text("database").value_or(""));
        fill(s.listen, file.text("listen").value_or(""));
        fill(s.certificate, file.text("certificate").value_or(""));
        fill(s.key, file.text("key").value_or(""));
        fill(s.address, file.text("address").value_or(""));
        fill(s.signOnSecret, file.text("sign_on_secret").value_or(""));
        fill(s.signOnHeader, file.text("sign_on_header").value_or(""));
        if (s.signOnProxies.empty()) s.signOnProxies = file.texts("sign_on_proxies");
        if (s.proxies.empty()) s.proxies = file.texts("proxies");
        for (const Count& of : kCounts)
            if (const auto count = file.integer(of.key)) {
                if (*count < static_cast<std::int64_t>(of.least) || *count > static_cast<std::int64_t>(of.most))
                    file.fail(fmt::format("{} is no number of {}", *count, of.key),
                              fmt::format("write {} to {}", of.least, of.most), of.key);
                if (!(s.*of.value)) s.*of.value = static_cast<std::size_t>(*count);
            }
    }
    fill(s.data, "school");
    fill(s.listen, "127.0.0.1:8620");
    fill(s.signOnHeader, "X-Handpiece-User");
    if (!s.ownStationsOnly) s.ownStationsOnly = false;
    for (const Count& of : kCounts)
        if (!(s.*of.value)) s.*of.value = of.asBuilt;
    return s;
}

SchoolSettings placeOfBooks(const std::string& data, const std::string& database) {
    SchoolSettings given;
    given.data = data, given.database = database;
    SchoolSettings place = settled(std::move(given), ownEnvironment());
    struct stat folder {};
    if (geteuid() == 0 && stat(place.data.c_str(), &folder) == 0 && folder.st_uid != 0) {
        const passwd* const owner = getpwuid(folder.st_uid);
        const std::string name = owner ? owner->pw_name : std::to_string(folder.st_uid);
        throw core::Error(
            fmt::format("the school's folder is {}'s, and files that root makes in it the server cannot use", name),
            place.data, fmt::format("runuser -u {} -- handpiece school ...", name))
            .as("not-owner", {name});
    }
    if (place.database.empty() && access((place.data + "/books.db").c_str(), F_OK) != 0)
        std::fprintf(stderr, "there was no school in %s: this begins a new one\n", place.data.c_str());
    return place;
}

school::Act now() {
    return {"server", school_server::systemClock()()};
}

}  // namespace handpiece::school_cli
