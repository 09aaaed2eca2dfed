// SPDX-License-Identifier: Apache-2.0
// Any bytes as a list of people must give a list whose references hold, or one core::Error. The first byte says whether
// they are a table of one's own, or the users, classes and enrolments of OneRoster, parted by a byte 1.
#include <set>

#include "fuzz_model.h"
#include "handpiece/school/roster/roster_files.h"
#include "handpiece/school/roster/spreadsheet.h"

namespace school = handpiece::school;

namespace {

void requireSound(const school::Roster& roster) {
    std::set<std::string> people, classes;
    for (const auto& person : roster.people)
        if (person.key.empty() || !people.insert(person.key).second) __builtin_trap();
    for (const auto& one : roster.classes)
        if (one.key.empty() || !classes.insert(one.key).second) __builtin_trap();
    for (const auto& one : roster.enrolments) {
        if (one.schoolClass.empty() || one.person.empty() || one.where.empty()) __builtin_trap();
        if (!roster.isExternal && (people.count(one.person) == 0 || classes.count(one.schoolClass) == 0))
            __builtin_trap();
    }
}

std::vector<std::byte> asBytes(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

school::Roster oneRoster(std::string_view text) {
    static const char* const names[] = {"users.csv", "classes.csv", "enrollments.csv", "orgs.csv"};
    std::map<std::string, std::vector<std::byte>> files;
    const bool isDelta = !text.empty() && text[0] == 'd';
    std::string manifest = "propertyName,value\noneroster.version,1.1\n";
    for (std::size_t at = 0, i = 0; i < 4; ++i) {
        const std::size_t end = std::min(text.find('\x01', at), text.size());
        files[names[i]] = asBytes(text.substr(at, end - at));
        at = std::min(end + 1, text.size());
        const std::string name = std::string(names[i]).substr(0, std::string(names[i]).size() - 4);
        if (!files[names[i]].empty()) manifest += "file." + name + (isDelta ? ",delta\n" : ",bulk\n");
    }
    files["manifest.csv"] = asBytes(manifest);
    return school::oneRoster(files, "x", "2026-11-27");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    (void)handpiece::fuzz::readText(data + 1, size - 1, [&](std::string_view text) {
        requireSound(data[0] % 2 == 0 ? school::peopleList(text, "x") : oneRoster(text));
    });
    return 0;
}
