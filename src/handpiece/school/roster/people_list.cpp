// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "handpiece/school/roster/roster_files.h"
#include "handpiece/school/roster/spreadsheet.h"

namespace handpiece::school {
namespace {

constexpr std::array<std::string_view, 6> kColumns = {"code", "name", "login", "role", "class", "class role"};
constexpr std::array<std::string_view, 4> kRoles = {"student", "teacher", "examiner", "administrator"};

std::vector<std::string> rolesIn(const Spreadsheet& table, const Spreadsheet::Row& row, std::string_view column) {
    std::set<std::string> roles;
    const std::string text = inSmallLetters(table.cell(row, column));
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find_first_of(" ,;/+", at), text.size());
        if (const std::string one = text.substr(at, end - at); !one.empty()) {
            if (std::find(kRoles.begin(), kRoles.end(), one) == kRoles.end())
                table.fail(row, column, fmt::format("'{}' is no role", one.substr(0, 60)),
                           fmt::format("write one of {}", fmt::join(kRoles, ", ")));
            roles.insert(one);
        }
        at = end + 1;
    }
    return {roles.begin(), roles.end()};
}

/// Of two lines about one person: what both say must be the same.
template <class T>
void agree(const Spreadsheet& table, const Spreadsheet::Row& row, std::string_view column, std::optional<T>& before,
           const std::optional<T>& now, const std::string& first) {
    if (!now) return;
    if (before && *before != *now)
        table.fail(row, column, fmt::format("it is another one in {}", first),
                   "write the same in both, or leave it out");
    before = now;
}

}  // namespace

Roster peopleList(std::string_view bytes, const std::string& where) {
    const Spreadsheet table = Spreadsheet::parse(bytes, where);
    table.require({"code"});
    Roster roster;
    std::string unread;
    for (const std::string& name : table.names())
        if (!name.empty() && std::find(kColumns.begin(), kColumns.end(), inSmallLetters(name)) == kColumns.end())
            unread += (unread.empty() ? "" : ", ") + name;
    if (table.isShiftJis()) roster.notices.emplace_back("it is no UTF-8 and was read as Shift_JIS: look at the names");
    if (!unread.empty()) roster.notices.push_back(fmt::format("columns that are not read: {}", unread));
    std::map<std::string, std::size_t> placeOf;
    std::set<std::string> classes;
    std::map<std::pair<std::string, std::string>, std::size_t> enrolled;
    for (const Spreadsheet::Row& row : table.rows()) {
        const std::string& code = table.cell(row, "code");
        if (code.empty()) table.fail(row, "code", "it is empty", "give each person a code, or take out the line");
        const auto said = [&](std::string_view column) {
            const std::string& text = table.cell(row, column);
            return text.empty() ? std::nullopt : std::optional(text);
        };
        const std::vector<std::string> roles = rolesIn(table, row, "role");
        const auto [place, isNew] = placeOf.emplace(code, roster.people.size());
        if (isNew) {
            Roster::Person person;
            person.key = code, person.where = table.placeOf(row, "code");
            roster.people.push_back(person);
        }
        Roster::Person& person = roster.people[place->second];
        agree(table, row, "name", person.name, said("name"), person.where);
        agree(table, row, "login", person.login, said("login"), person.where);
        agree(table, row, "role", person.roles, roles.empty() ? std::nullopt : std::optional(roles), person.where);
        const std::string& schoolClass = table.cell(row, "class");
        const std::vector<std::string> inClass = rolesIn(table, row, "class role");
        if (schoolClass.empty()) {
            if (!inClass.empty()) table.fail(row, "class", "it is empty, and a role in it is given", "name the class");
            continue;
        }
        if (inClass.size() > 1 || (!inClass.empty() && inClass[0] == "administrator"))
            table.fail(row, "class role", "this is no role in a class", "write student, teacher or examiner");
        if (classes.insert(schoolClass).second)
            roster.classes.push_back({schoolClass, schoolClass, false, table.placeOf(row, "class")});
        Roster::Enrolment enrolment{schoolClass, code, {}, false, table.placeOf(row, "class")};
        if (!inClass.empty()) enrolment.role = inClass[0];
        if (!enrolled.emplace(std::pair(schoolClass, code), row.line).second)
            table.fail(row, "class",
                       fmt::format("'{}' is in it already, in line {}", code, enrolled[{schoolClass, code}]),
                       "take out one of the two lines");
        roster.enrolments.push_back(std::move(enrolment));
    }
    return roster;
}

}  // namespace handpiece::school
