// SPDX-License-Identifier: Apache-2.0
// handpiece school lti, retention (on the server's machine), statements (on a station).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <cstdlib>
#include <memory>

#include "handpiece/base/core/error.h"
#include "handpiece/school/store/lti_books.h"
#include "handpiece/school/store/retention.h"
#include "school/commands.h"
#include "school/elsewhere.h"
#include "school/lti.h"
#include "school/school_settings.h"
#include "school/server.h"
#include "school/statements_push.h"
#include "school/typed_secret.h"

namespace handpiece::school_cli {
namespace {

namespace fs = std::filesystem;
using school::Books;

struct ElsewhereOptions {
    std::string data, database;
    school::LtiPlatform platform;
    std::string person, external, schoolClass, issuer, client;
    int practiceDays = -1, closedDays = -1, personalDays = -1;
    bool go = false;
    std::string home, lrs, user;
    statements::Actor actor;
};

school::Act act() {
    return {"server", school_server::systemClock()()};
}

void setPlatform(const ElsewhereOptions& o) {
    for (const std::string* address : {&o.platform.authAddress, &o.platform.tokenAddress, &o.platform.keysAddress})
        school_server::requireAddress(*address);
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    fmt::print("{}\n", school::LtiBooks(books).set(o.platform, act()));
}

void tellGrades(const ElsewhereOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    for (const school::LtiGrade& grade : school::LtiBooks(books).grades())
        fmt::print("{} {} {}: {}{}\n", grade.number, grade.line.person, grade.line.assignment,
                   grade.sent > 0 ? "sent" : fmt::format("waits, {} tries", grade.tries),
                   grade.problem.empty() ? "" : " (" + grade.problem + ")");
}

/// Without --go nothing goes.
void retention(const ElsewhereOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    school::Retention retention(books);
    if (o.personalDays >= 0) retention.setForPersonal(o.personalDays, act());
    if (!o.schoolClass.empty()) {
        school::RetentionRules rules = retention.ofClass(o.schoolClass);
        if (o.practiceDays >= 0) rules.practiceDays = o.practiceDays;
        if (o.closedDays >= 0) rules.closedDays = o.closedDays;
        retention.setForClass(o.schoolClass, rules, act());
    } else if (o.practiceDays >= 0 || o.closedDays >= 0) {
        throw core::Error("of which class?", "--class", "name its id");
    }
    const auto told = [](std::int64_t days) {
        return days == 0 ? std::string("for good") : fmt::format("{} days", days);
    };
    fmt::print("practice of nobody's class: {}\n", told(retention.ofPersonal()));
    for (const school::SchoolClass& one : books.classes()) {
        const school::RetentionRules rules = retention.ofClass(one.id);
        fmt::print("{} {}: practice {}, after it is closed {}\n", one.id, one.name, told(rules.practiceDays),
                   told(rules.closedDays));
    }
    std::uint64_t bytes = 0;
    const std::vector<school::Expiring> expiring = retention.expiring(act().at);
    for (const school::Expiring& one : expiring) {
        fmt::print("{} {} {}: {}\n", one.attempt, one.person, one.assignment.empty() ? "-" : one.assignment, one.why);
        bytes += one.bytes;
    }
    if (o.go)
        fmt::print("{} attempts went\n", retention.expire(act()));
    else
        fmt::print("{} attempts with {:.1f} MB would go (--go, or the server by itself once a day)\n", expiring.size(),
                   1e-6 * static_cast<double>(bytes));
}

void pushStatements(const ElsewhereOptions& o) {
    fs::path home = o.home;
    if (!fs::is_regular_file(home / "results.db"))
        throw core::Error("there are no results here", (home / "results.db").string(),
                          "name the folder with results.db: --home");
    school_station::RecordStore to{o.lrs, o.user, {}};
    if (!o.user.empty()) to.password = typedSecret("password");
    const school::Store store(home / "results.db");
    const school_station::PushedStatements pushed =
        school_station::pushStatements(store, o.actor, to, home / "statements.json");
    fmt::print("{} statements sent, {} were there\n", pushed.sent, pushed.there);
}

}  // namespace

void addElsewhereCommands(cli::Command& app) {
    const auto options = std::make_shared<ElsewhereOptions>();
    ElsewhereOptions& o = *options;
    const std::string where = " (on the server's machine)";
    const auto books = [&o](cli::Command& command) {
        command.option("--data", o.data, "the server's folder (school)");
        command.option("--database", o.database, "postgresql://... instead of SQLite in the folder");
    };
    cli::Command lti = app.subcommand("lti", "Learning platforms: people come by LTI 1.3, grades go back" + where);
    lti.requireSubcommand();
    cli::Command platform = lti.subcommand("platform", "A platform, as its administrator tells it");
    books(platform);
    platform.option("ISSUER", o.platform.issuer, "https://platform.example").required();
    platform.option("CLIENT", o.platform.client, "the id that it gave this server").required();
    platform.option("--auth", o.platform.authAddress, "where log-ins are asked for").required();
    platform.option("--token", o.platform.tokenAddress, "where access is asked for").required();
    platform.option("--keys", o.platform.keysAddress, "its key set").required();
    platform.option("--deployment", o.platform.deployments, "id of a deployment; several times").required().takeAll();
    platform.flag("--lists", o.platform.hasLists, "what it calls people are the ids of the school's class lists");
    platform.callback([options] { setPlatform(*options); });
    cli::Command person =
        lti.subcommand("person", "What class lists and single sign-on call a person, or one platform");
    books(person);
    person.option("CODE", o.person, "of the person").required();
    person.option("EXTERNAL", o.external, "their id there").required();
    person.option("--platform", o.issuer, "issuer of a platform that has no class lists of the school's");
    person.option("--client", o.client, "where it has several here");
    person.callback([options] {
        Books open(options->data, options->database);
        school::LtiBooks platforms(open);
        if (options->issuer.empty()) return platforms.setExternal(options->person, options->external, act());
        const auto found = platforms.platform(options->issuer, options->client);
        if (!found)
            throw core::Error("there is no such platform, or several", options->issuer, "give --client as well");
        platforms.setPerson(*found, options->external, options->person, act());
    });
    cli::Command grades = lti.subcommand("grades", "Which grades went, which wait, and why");
    books(grades);
    grades.callback([options] { tellGrades(*options); });

    cli::Command keep = app.subcommand("retention", "How long work is kept, and what would go now" + where);
    books(keep);
    keep.option("--class", o.schoolClass, "id of a class, with what follows");
    keep.option("--practice-days", o.practiceDays, "its practice, from when it came; 0: for good")
        .check(cli::range(0, 36500));
    keep.option("--closed-days", o.closedDays, "all its work, from when it was closed; 0: for good")
        .check(cli::range(0, 36500));
    keep.option("--personal-days", o.personalDays, "practice of nobody's class; 0: for good")
        .check(cli::range(0, 36500));
    keep.flag("--go", o.go, "what would go goes now");
    keep.callback([options] { retention(*options); });

    cli::Command statements = app.subcommand("statements", "Results as xAPI statements");
    statements.requireSubcommand();
    cli::Command push = statements.subcommand(
        "push", "To a learning record store, from where it was; of a user the password is read from standard input");
    push.option("--lrs", o.lrs, "address of its xAPI, as https://lrs.example/xapi").required();
    push.option("--user", o.user, "of HTTP Basic");
    push.option("--person", o.actor.code, "the code that the school knows the person by").required();
    push.option("--home-page", o.actor.homePage, "the school's address, https://...").required();
    push.option("--home", o.home, "folder with results.db").required();
    push.callback([options] { pushStatements(*options); });
}

}  // namespace handpiece::school_cli
