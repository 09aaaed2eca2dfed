// SPDX-License-Identifier: Apache-2.0
// OneRoster 1.1 as CSV tables (1EdTech, version 1.1.1, 2023): what of it is about people and classes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>

#include "handpiece/base/core/error.h"
#include "handpiece/school/roster/roster_files.h"
#include "handpiece/school/roster/spreadsheet.h"

namespace handpiece::school {
namespace {

enum class Mode { absent, bulk, delta };

bool isDigits(std::string_view text) {
    return std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}
/// "2026-11-27", also with a time behind.
bool isDate(std::string_view text, bool withTime) {
    if (text.size() < 10 || text[4] != '-' || text[7] != '-' || !isDigits(text.substr(0, 4)) ||
        !isDigits(text.substr(5, 2)) || !isDigits(text.substr(8, 2)))
        return false;
    if (text.substr(5, 2) < "01" || text.substr(5, 2) > "12" || text.substr(8, 2) < "01" || text.substr(8, 2) > "31")
        return false;
    return text.size() == 10 || (withTime && (text[10] == 'T' || text[10] == ' '));
}

std::vector<std::string> listed(const std::string& text) {
    std::vector<std::string> all;
    for (std::size_t at = 0; at < text.size();) {
        std::size_t end = std::min(text.find(',', at), text.size());
        std::string one = text.substr(at, end - at);
        while (one.starts_with(' '))
            one.erase(0, 1);
        while (one.ends_with(' '))
            one.pop_back();
        if (!one.empty()) all.push_back(std::move(one));
        at = end + 1;
    }
    return all;
}

class Files {
  public:
    Files(const std::map<std::string, std::vector<std::byte>>& files, std::string where)
        : files_(files), where_(std::move(where)) {
        // Some programs pack a folder with the files in it.
        for (const auto& [name, bytes] : files_)
            if (name == "manifest.csv" || name.ends_with("/manifest.csv"))
                if (!name.starts_with("__MACOSX/")) folders_.push_back(name.substr(0, name.size() - 12));
        if (folders_.size() != 1)
            throw core::Error(folders_.empty() ? "there is no manifest.csv in it" : "there are two manifest.csv in it",
                              where_, "give the files of one OneRoster 1.1 export, or a table with a column \"code\"")
                .as("list-unfit", {where_, "manifest.csv"});
    }
    [[nodiscard]] std::optional<Spreadsheet> table(const std::string& name) const {
        const auto found = files_.find(folders_[0] + name + ".csv");
        if (found == files_.end()) return {};
        const std::string_view text(reinterpret_cast<const char*>(found->second.data()), found->second.size());
        return Spreadsheet::parse(text, where_.empty() ? name + ".csv" : where_ + "/" + name + ".csv");
    }
    [[nodiscard]] const std::string& where() const { return where_; }

  private:
    const std::map<std::string, std::vector<std::byte>>& files_;
    std::string where_;
    std::vector<std::string> folders_;
};

/// One of the tables, and what stands in each of its lines first.
struct Table {
    std::string name;
    Mode mode = Mode::absent;
    std::optional<Spreadsheet> sheet{};
    std::map<std::string, bool> isGone{};  ///< by sourcedId

    [[nodiscard]] bool isWhole() const { return mode == Mode::bulk; }
    /// In a whole file all are there; otherwise the rest is elsewhere.
    [[nodiscard]] bool knows(const std::string& id) const { return isGone.count(id) > 0; }
    const std::string& needed(const Spreadsheet::Row& row, std::string_view column) const {
        const std::string& text = sheet->cell(row, column);
        if (text.empty()) sheet->fail(row, column, "it is empty, and has to be there", "fill it in");
        return text;
    }
};

class OneRoster {
  public:
    OneRoster(const Files& files, std::string today) : files_(files), today_(std::move(today)) {
        readManifest();
        for (Table* table : {&orgs_, &sessions_, &courses_, &users_, &classes_, &enrolments_})
            open(*table);
    }
    Roster read() {
        Roster roster;
        roster.isExternal = true;
        roster.hasAllPeople = users_.isWhole(), roster.hasAllClasses = classes_.isWhole(),
        roster.hasAllEnrolments = enrolments_.isWhole();
        users(roster);
        classes(roster);
        enrolments(roster);
        for (const auto& [what, count] : unread_)
            roster.notices.push_back(
                fmt::format("{} with the role {} are not read: {}", what.first, what.second, count));
        return roster;
    }

  private:
    void readManifest() {
        const std::optional<Spreadsheet> manifest = files_.table("manifest");
        manifest->require({"propertyName", "value"});
        std::map<std::string, std::pair<std::string, const Spreadsheet::Row*>> values;
        for (const Spreadsheet::Row& row : manifest->rows())
            values[manifest->cell(row, "propertyName")] = {manifest->cell(row, "value"), &row};
        const auto version = values.find("oneroster.version");
        if (version == values.end())
            throw core::Error("it does not say of which version it is", manifest->where(),
                              "add a line oneroster.version,1.1")
                .as("list-unfit", {manifest->where(), "oneroster.version"});
        if (version->second.first != "1.1")
            manifest->fail(*version->second.second, "value",
                           fmt::format("this is OneRoster {}", version->second.first.substr(0, 20)),
                           "export it as version 1.1");
        for (Table* table : {&orgs_, &sessions_, &courses_, &users_, &classes_, &enrolments_}) {
            const auto found = values.find("file." + table->name);
            const std::string mode = found == values.end() ? "absent" : found->second.first;
            if (mode != "absent" && mode != "bulk" && mode != "delta")
                manifest->fail(*found->second.second, "value",
                               fmt::format("'{}' is no way in which {}.csv comes", mode.substr(0, 60), table->name),
                               "write absent, bulk or delta");
            table->mode = mode == "bulk" ? Mode::bulk : mode == "delta" ? Mode::delta : Mode::absent;
        }
        if (users_.mode == Mode::absent && classes_.mode == Mode::absent && enrolments_.mode == Mode::absent)
            throw core::Error("it brings neither people nor classes", manifest->where(),
                              "export users, classes and enrollments")
                .as("list-unfit", {manifest->where(), "absent"});
    }

    /// What all tables have: an id of its own, and in a delta what became of it.
    void open(Table& table) {
        if (table.mode == Mode::absent) return;
        table.sheet = files_.table(table.name);
        if (!table.sheet)
            throw core::Error(fmt::format("the manifest names {}.csv, and it is not there", table.name), files_.where(),
                              "export it again, whole")
                .as("list-unfit", {files_.where(), table.name});
        table.sheet->require({"sourcedId", "status", "dateLastModified"});
        for (const Spreadsheet::Row& row : table.sheet->rows()) {
            const std::string& id = table.needed(row, "sourcedId");
            const std::string &status = table.sheet->cell(row, "status"),
                              &modified = table.sheet->cell(row, "dateLastModified");
            if (status != "active" && status != "tobedeleted" && !(status.empty() && table.isWhole()))
                table.sheet->fail(row, "status", fmt::format("'{}' is no status", status.substr(0, 60)),
                                  table.isWhole() ? "leave it empty" : "write active or tobedeleted");
            if (!(modified.empty() && table.isWhole()) && !isDate(modified, true))
                table.sheet->fail(row, "dateLastModified", fmt::format("'{}' is no date", modified.substr(0, 60)),
                                  "write it as 2026-11-27T08:30:00Z");
            if (!table.isGone.emplace(id, status == "tobedeleted").second)
                table.sheet->fail(row, "sourcedId", fmt::format("'{}' stands in the file twice", id.substr(0, 80)),
                                  "keep one line of each");
        }
    }

    /// What a line refers to must be in the files, where they are whole.
    static void requireThere(const Table& from, const Spreadsheet::Row& row, std::string_view column,
                             const std::string& id, const Table& in) {
        if (!in.isWhole() || in.knows(id)) return;
        from.sheet->fail(row, column, fmt::format("{}.csv has no '{}'", in.name, id.substr(0, 80)),
                         "export both files at the same time");
    }

    void users(Roster& roster) {
        if (!users_.sheet) return;
        const Spreadsheet& sheet = *users_.sheet;
        sheet.require({"enabledUser", "orgSourcedIds", "role", "username", "givenName", "familyName"});
        static constexpr std::array<std::string_view, 8> kRoles = {"administrator", "aide",     "guardian", "parent",
                                                                   "proctor",       "relative", "student",  "teacher"};
        for (const Spreadsheet::Row& row : sheet.rows()) {
            const std::string& id = sheet.cell(row, "sourcedId");
            const std::string& role = users_.needed(row, "role");
            if (std::find(kRoles.begin(), kRoles.end(), role) == kRoles.end())
                sheet.fail(row, "role", fmt::format("'{}' is no role", role.substr(0, 60)),
                           fmt::format("write one of {}", fmt::join(kRoles, ", ")));
            const std::string enabled = inSmallLetters(users_.needed(row, "enabledUser"));
            if (enabled != "true" && enabled != "false")
                sheet.fail(
                    row, "enabledUser",
                    fmt::format("'{}' is neither true nor false", users_.needed(row, "enabledUser").substr(0, 60)),
                    "write true or false");
            for (const std::string& org : listed(users_.needed(row, "orgSourcedIds")))
                requireThere(users_, row, "orgSourcedIds", org, orgs_);
            Roster::Person person;
            person.key = id, person.where = sheet.placeOf(row, "username");
            if (role != "student" && role != "teacher" && role != "administrator") {
                skipped_.insert(id);
                ++unread("people", role);
                continue;
            }
            person.isGone = users_.isGone.at(id);
            const std::string &given = users_.needed(row, "givenName"), &family = users_.needed(row, "familyName");
            const std::string& middle = sheet.cell(row, "middleName");
            person.name = fmt::format("{} {}{}{}", given, middle, middle.empty() ? "" : " ", family);
            person.login = users_.needed(row, "username");
            person.roles = std::vector<std::string>{role};
            person.mayLogIn = enabled == "true";
            roster.people.push_back(std::move(person));
        }
    }

    void classes(Roster& roster) {
        if (!classes_.sheet) return;
        const Spreadsheet& sheet = *classes_.sheet;
        sheet.require({"title", "courseSourcedId", "classType", "schoolSourcedId", "termSourcedIds"});
        for (const Spreadsheet::Row& row : sheet.rows()) {
            const std::string &id = sheet.cell(row, "sourcedId"), &type = classes_.needed(row, "classType");
            if (type != "homeroom" && type != "scheduled")
                sheet.fail(row, "classType", fmt::format("'{}' is no type of a class", type.substr(0, 60)),
                           "write homeroom or scheduled");
            requireThere(classes_, row, "courseSourcedId", classes_.needed(row, "courseSourcedId"), courses_);
            requireThere(classes_, row, "schoolSourcedId", classes_.needed(row, "schoolSourcedId"), orgs_);
            for (const std::string& term : listed(classes_.needed(row, "termSourcedIds")))
                requireThere(classes_, row, "termSourcedIds", term, sessions_);
            roster.classes.push_back(
                {id, classes_.needed(row, "title"), classes_.isGone.at(id), sheet.placeOf(row, "title")});
        }
    }

    void enrolments(Roster& roster) {
        if (!enrolments_.sheet) return;
        const Spreadsheet& sheet = *enrolments_.sheet;
        sheet.require({"classSourcedId", "schoolSourcedId", "userSourcedId", "role"});
        static constexpr std::array<std::string_view, 4> kRoles = {"administrator", "proctor", "student", "teacher"};
        for (const Spreadsheet::Row& row : sheet.rows()) {
            const std::string &schoolClass = enrolments_.needed(row, "classSourcedId"),
                              &user = enrolments_.needed(row, "userSourcedId");
            requireThere(enrolments_, row, "classSourcedId", schoolClass, classes_);
            requireThere(enrolments_, row, "userSourcedId", user, users_);
            requireThere(enrolments_, row, "schoolSourcedId", enrolments_.needed(row, "schoolSourcedId"), orgs_);
            const std::string& role = enrolments_.needed(row, "role");
            if (std::find(kRoles.begin(), kRoles.end(), role) == kRoles.end())
                sheet.fail(row, "role", fmt::format("'{}' is no role in a class", role.substr(0, 60)),
                           fmt::format("write one of {}", fmt::join(kRoles, ", ")));
            const std::string begins = day(sheet, row, "beginDate"), ends = day(sheet, row, "endDate");
            if (skipped_.count(user) > 0) continue;
            if (role != "student" && role != "teacher") {
                ++unread("enrolments", role);
                continue;
            }
            bool isGone = enrolments_.isGone.at(sheet.cell(row, "sourcedId"));
            // What has not begun or is over by today.
            if ((!begins.empty() && begins > today_) || (!ends.empty() && ends < today_)) isGone = true;
            if (classes_.knows(schoolClass) && classes_.isGone.at(schoolClass)) isGone = true;
            if (users_.knows(user) && users_.isGone.at(user)) isGone = true;
            roster.enrolments.push_back({schoolClass, user, role, isGone, sheet.placeOf(row, "userSourcedId")});
        }
    }
    static std::string day(const Spreadsheet& sheet, const Spreadsheet::Row& row, std::string_view column) {
        const std::string& text = sheet.cell(row, column);
        if (!text.empty() && !isDate(text, false))
            sheet.fail(row, column, fmt::format("'{}' is no date", text.substr(0, 60)), "write it as 2026-11-27");
        return text;
    }
    std::size_t& unread(const std::string& what, const std::string& role) { return unread_[{what, role}]; }

    const Files& files_;
    std::string today_;
    Table orgs_{"orgs"}, sessions_{"academicSessions"}, courses_{"courses"}, users_{"users"}, classes_{"classes"},
        enrolments_{"enrollments"};
    std::set<std::string> skipped_;
    std::map<std::pair<std::string, std::string>, std::size_t> unread_;
};

}  // namespace

Roster oneRoster(const std::map<std::string, std::vector<std::byte>>& files, const std::string& where,
                 const std::string& today) {
    const Files opened(files, where);
    return OneRoster(opened, today).read();
}

}  // namespace handpiece::school
