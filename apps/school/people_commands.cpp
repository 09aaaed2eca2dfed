// SPDX-License-Identifier: Apache-2.0
// On the server's machine: lists of people, and what is held of one.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>

#include "handpiece/base/core/csv_cell.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/keeping/person_export.h"
#include "handpiece/school/people/secret.h"
#include "handpiece/school/roster/roster_files.h"
#include "handpiece/school/store/books_accounts.h"
#include "school/commands.h"
#include "school/roster_words.h"
#include "school/school_settings.h"
#include "school/server.h"

namespace handpiece::school_cli {
namespace {

using school::Act;
using school::Books;

struct PeopleOptions {
    std::string data, database, file, code, out, codes;
    bool isDryRun = false, isWhole = false, administrators = false, endsMany = false, yes = false;
    std::size_t days = 14;
};

Act actOfServer() {
    return {"server", school_server::systemClock()()};
}

/// A code for each who is new and has a login, to be cut into slips.
void writeCodes(Books& books, const std::vector<school::RosterChange>& changes, const PeopleOptions& o) {
    const Act act = actOfServer();
    std::string csv =
        "\xef\xbb\xbf"
        "login,name,code\r\n";
    std::size_t count = 0, without = 0;
    for (const school::RosterChange& change : changes) {
        if (change.kind != school::RosterChange::Kind::addPerson) continue;
        const auto person = books.person(change.person);
        if (person && person->login.empty()) ++without;
        if (!person || person->login.empty()) continue;
        const std::string code = school::newStationCode();
        school::BooksAccounts(books).offerPasswordCode(
            person->code, code, act.at + static_cast<school::Milliseconds>(o.days) * 86'400'000, act);
        csv += fmt::format("{},{},{}\r\n", core::csvCell(person->login), core::csvCell(person->name), code);
        ++count;
    }
    core::writeFile(o.codes, csv, {.ownerOnly = true});
    fmt::print("{} codes in {}, for {} days: each sets its own password at /first\n", count, o.codes, o.days);
    if (without > 0)
        std::fprintf(stderr,
                     "%zu new people have no login, and so no code: give the list a column \"login\", and import it "
                     "again\n",
                     without);
}

bool makesAdministrators(const school::Roster& roster) {
    return std::any_of(roster.people.begin(), roster.people.end(), [](const school::Roster::Person& p) {
        return p.roles && std::find(p.roles->begin(), p.roles->end(), "administrator") != p.roles->end();
    });
}

void importPeople(const PeopleOptions& o) {
    const Act act = actOfServer();
    school::Roster roster = school::readRoster(o.file, school_server::today(act.at));
    if (!roster.isExternal) roster.hasAllEnrolments = o.isWhole;
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    const school::RosterRules rules{o.isDryRun, o.administrators, o.endsMany, school_server::newPersonCode};
    const auto changes = school::BooksRoster(books).import(roster, rules, act);
    for (const school::RosterChange& change : changes)
        fmt::print("{}\n", school_server::inWords(change));
    for (const std::string& notice : roster.notices)
        fmt::print("{}\n", notice);
    if (!o.administrators && makesAdministrators(roster))
        fmt::print("the list would make administrators, and did not: say --administrators\n");
    fmt::print("{} {}\n", changes.size(), o.isDryRun ? "changes would be made (nothing was)" : "changes");
    if (!o.codes.empty() && !o.isDryRun) writeCodes(books, changes, o);
}

void exportOne(const PeopleOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    school::exportPerson(books, o.code, o.out, actOfServer());
    fmt::print("{}\n", o.out);
}

void eraseOne(const PeopleOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    const auto person = books.person(o.code);
    if (!person) throw core::Error("there is no such person", o.code, "see the list in the browser: /office/people");
    if (!o.yes)
        throw core::Error(fmt::format("{} ({}) would be erased, which cannot be taken back", person->name, o.code),
                          "--yes", "say it to do it; handpiece school people export first gives them what is theirs");
    books.erase(o.code, actOfServer());
    fmt::print("{} is erased; what they did stays under the code\n", o.code);
}

}  // namespace

void addPeopleCommands(cli::Command& app) {
    const auto options = std::make_shared<PeopleOptions>();
    PeopleOptions& o = *options;
    cli::Command people = app.subcommand("people", "Lists of people; what is held of one (on the server's machine)");
    people.requireSubcommand();
    const auto books = [&o](cli::Command& command) {
        command.option("--data", o.data, "the server's folder (school)");
        command.option("--database", o.database, "postgresql://... instead of SQLite in the folder");
    };
    cli::Command import = people.subcommand("import", "People, classes and who is in which, from a list");
    books(import);
    import.option("FILE", o.file, "a table (CSV) or OneRoster 1.1 (zip or folder)").required();
    import.flag("--dry-run", o.isDryRun, "only say what would change");
    import.flag("--whole", o.isWhole, "students who are not in the table leave the classes that it names");
    import.flag("--administrators", o.administrators, "the list may make people administrators");
    import.flag("--ends-many", o.endsMany, "so many are missing in it because they are gone");
    import.option("--codes", o.codes, "a file for one-time codes of those who are new");
    import.option("--days", o.days, "that these hold")
        .check(cli::range(std::size_t{1}, std::size_t{365}))
        .showDefault();
    import.footer("Example:\n  handpiece school people import --data /srv/handpiece --dry-run class-list.csv");
    import.callback([options] { importPeople(*options);
});

cli::Command exported = people.subcommand("export", "All that is held of a person, as a zip for them");
books(exported);
exported.option("PERSON", o.code, "their code").required();
exported.option("--out", o.out, "the zip").required();
exported.callback([options] { exportOne(*options); });

cli::Command erased = people.subcommand("erase", "The name goes, and what leads to it; what they did stays");
books(erased);
erased.option("PERSON", o.code, "their code").required();
erased.flag("--yes", o.yes, "do it: it cannot be taken back");
erased.callback([options] { eraseOne(*options); });
}  // namespace handpiece::school_cli

}  // namespace handpiece::school_cli
