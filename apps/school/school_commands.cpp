// SPDX-License-Identifier: Apache-2.0
// On the server's machine: people, codes, exercises, results. On a station: enrol, push, status.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <memory>

#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/assess/task/task.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/people/secret.h"
#include "school/commands.h"
#include "school/library.h"
#include "school/school_settings.h"
#include "school/server.h"
#include "school/station.h"
#include "school/typed_secret.h"
#include "studies/progress_bar.h"

namespace handpiece::school_cli {
namespace {

namespace fs = std::filesystem;
using school::Act;
using school::Books;

struct BooksOptions {
    std::string data, database, name, code, file, role = "student", person, schoolClass, exercise;
    std::size_t hours = 24, days = 120;
    bool isForExams = false, isForWorks = false;
};

void addBooksOptions(cli::Command& command, BooksOptions& o) {
    command.option("--data", o.data, "the server's folder (school)");
    command.option("--database", o.database, "postgresql://... instead of SQLite in the folder");
}
/// Who sits at the server's machine.
void offerCode(const BooksOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    const std::string code = school::newStationCode();
    const Act act = now();
    books.offerCode(code, o.name, act.at + static_cast<school::Milliseconds>(o.hours) * 3'600'000, act,
                    o.isForExams   ? "exam"
                    : o.isForWorks ? "worker"
                                   : "practice",
                    o.person);
    fmt::print("{}\n", code);
}

void addPerson(const BooksOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    school::Person person;
    person.code = o.code, person.name = o.name, person.roles = {o.role};
    person.login = o.code;
    const Act act = now();
    person.made = act.at;
    books.add(std::span(&person, 1), act);
    fmt::print("{}: {}\n", person.code, o.role);
}

void setPassword(const BooksOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    const auto person = books.person(o.code);
    if (!person) throw core::Error("there is no such person", o.code, "add them: handpiece school person");
    const std::string password = typedSecret("password");
    school::requireGoodPassword(password, person->login);
    books.setPassword(o.code, school::hashOfPassword(password), now());
}

void addClass(const BooksOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    const Act act = now();
    school::SchoolClass made;
    made.id = school::newId(), made.name = o.name, made.made = act.at;
    books.add(made, act);
    fmt::print("{}\n", made.id);
}
void join(const BooksOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    const school::Enrolment one{o.schoolClass, o.person, o.role};
    books.enrol(std::span(&one, 1), now());
}
void assign(const BooksOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    const Act act = now();
    const auto pack = books.pack(o.exercise);
    if (!pack) throw core::Error("the school has no such exercise", o.exercise, "add it: handpiece school exercise");
    school::Assignment made;
    made.id = school::newId(), made.schoolClass = o.schoolClass, made.pack = pack->hash, made.rubric = pack->rubric;
    made.title = o.name.empty() ? pack->title : o.name, made.kind = "practice", made.opens = act.at;
    made.closes = act.at + static_cast<school::Milliseconds>(o.days) * 86'400'000;
    books.add(made, act);
    fmt::print("{}\n", made.id);
}

void addExercise(const BooksOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    const school_server::AddedExercise added = school_server::addExercise(books, o.file, now());
    fmt::print("{}: exercise {}, rubric {}\n", added.id, added.hash, added.rubric);
}

void tellResults(const BooksOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    for (const school::PushedAttempt& one : books.attemptsOf(o.person)) {
        const std::vector<school::Score> scores = books.scoresOf(one.attempt.id);
        if (scores.empty()) {
            fmt::print("{} {}: provisional, its station says {:.1f} of {:.1f}\n", one.attempt.id, one.attempt.exercise,
                       one.attempt.score, one.attempt.maxScore);
            continue;
        }
        const school::Score& s = scores.back();
        fmt::print("{} {}: {}, {:.1f} of {:.1f}, passed: {}{}\n", one.attempt.id, one.attempt.exercise, s.state,
                   s.score, s.maxScore, s.passed.empty() ? "-" : s.passed,
                   s.reason.empty() ? "" : " (" + s.reason + ")");
    }
    books.note(now(), "results shown", o.person);
}

struct StationOptions {
    std::string home, server, code, person;
    bool again = false;
};

/// Where the window keeps what a person has done.
fs::path homeOf(const StationOptions& o) {
    if (!o.home.empty()) return o.home;
    const char* data = std::getenv("XDG_DATA_HOME");
    const char* home = std::getenv("HOME");
    if (data != nullptr && *data == '/') return fs::path(data) / "Handpiece" / "Handpiece";
    if (home != nullptr && *home != '\0') return fs::path(home) / ".local" / "share" / "Handpiece" / "Handpiece";
    throw core::Error("it is not known where results are kept", "--home", "name the folder with results.db");
}

void enrol(const StationOptions& o) {
    const fs::path file = homeOf(o) / "school.json";
    // Again at the same school: what it has heard of it has.
    std::optional<school_station::Enrolment> before;
    if (core::isThere(file)) before = school_station::readEnrolment(file);
    if (before && (!o.again || before->server != o.server))
        throw core::Error("this station belongs to a school already", file.string(),
                          "say --again to enrol it with the same server anew; else move the file away");
    const std::string person = !o.person.empty() || !before ? o.person : before->person;
    school_station::Enrolment made = school_station::enrol(o.server, o.code, person);
    if (before && before->person == made.person) made.sent = before->sent, made.books = before->books;
    fs::create_directories(homeOf(o));
    school_station::writeEnrolment(made, file);
    fmt::print("enrolled as station {}\n", made.station);
}

void push(const StationOptions& o) {
    const fs::path home = homeOf(o), file = home / "school.json";
    school_station::Enrolment enrolment = school_station::readEnrolment(file);
    if (!fs::is_regular_file(home / "results.db"))
        throw core::Error("there are no results here", (home / "results.db").string(), "finish an exercise first");
    school::Store store(home / "results.db");
    studies::ProgressBar bar("pushing");
    const school_station::Pushed pushed =
        school_station::push(store, home / "sessions", enrolment, file, bar.listener());
    bar.finish();
    fmt::print("{} attempts, {} judgements, {} files ({:.1f} MB)\n", pushed.attempts, pushed.judgements, pushed.files,
               1e-6 * static_cast<double>(pushed.bytes));
    if (pushed.clockAhead != 0)
        std::fprintf(stderr,
                     "this computer's clock is %s the server's: set it right. Work is dated by it, and counts for what "
                     "the class has to do by the server's\n",
                     fmt::format("{:.1f} h {}", std::abs(1e-3 * static_cast<double>(pushed.clockAhead)) / 3600.0,
                                 pushed.clockAhead > 0 ? "ahead of" : "behind")
                         .c_str());
    for (const std::string& one : pushed.refused)
        std::fprintf(stderr, "refused: %s\n", one.c_str());
    if (!pushed.refused.empty())
        throw core::Error(fmt::format("the server refused {} of them", pushed.refused.size()), enrolment.server,
                          "the reason for each is above; what was refused stays on this station and is not sent again");
}

void status(const StationOptions& o) {
    const fs::path home = homeOf(o);
    const school_station::Enrolment enrolment = school_station::readEnrolment(home / "school.json");
    std::size_t waiting = 0;
    if (fs::is_regular_file(home / "results.db"))
        waiting = school_station::waitingIn(school::Store(home / "results.db"), enrolment);
    fmt::print("{}: {} waiting here\n", enrolment.server, waiting);
    const school_wire::Status there = school_station::status(enrolment);
    fmt::print("server {}, engine {}; files that have not come: {}\n", there.server, there.engine,
               there.missing.size());
}

}  // namespace

void addBooksCommands(cli::Command& app) {
    const auto options = std::make_shared<BooksOptions>();
    BooksOptions& o = *options;
    const std::string where = " (on the server's machine)";
    cli::Command code = app.subcommand("code", "A code with which one station enrols, once" + where);
    addBooksOptions(code, o);
    code.option("NAME", o.name, "of the station, as people know it").required();
    code.option("--hours", o.hours, "that it holds")
        .check(cli::range(std::size_t{1}, std::size_t{10000}))
        .showDefault();
    code.option("--person", o.person, "whose own it will be: it sends their work alone");
    code.flag("--exam", o.isForExams,
              "of a station that holds exams; when it has enrolled: handpiece school exam release")
        .excludes("--person");
    code.flag("--worker", o.isForWorks, "of a machine that cuts works again: there, handpiece school worker enrol")
        .excludes("--person")
        .excludes("--exam");
    code.callback([options] { offerCode(*options); });

    cli::Command person = app.subcommand("person", "Adds a person" + where);
    addBooksOptions(person, o);
    person.option("CODE", o.code, "that everything but one table has in the place of the name").required();
    person.option("--name", o.name, "the name, which is in that table");
    person.option("--role", o.role, "what they are")
        .check(cli::oneOf({"student", "teacher", "examiner", "administrator"}))
        .showDefault();
    person.callback([options] { addPerson(*options); });

    cli::Command password = app.subcommand("password", "Sets a person's password, read from standard input" + where);
    addBooksOptions(password, o);
    password.option("CODE", o.code, "of the person").required();
    password.callback([options] { setPassword(*options); });

    cli::Command made = app.subcommand("class", "Makes a class, and tells its id" + where);
    addBooksOptions(made, o);
    made.option("NAME", o.name, "as people know it").required();
    made.callback([options] { addClass(*options); });

    cli::Command joined = app.subcommand("join", "A person becomes one of a class" + where);
    addBooksOptions(joined, o);
    joined.option("CLASS", o.schoolClass, "its id").required();
    joined.option("PERSON", o.person, "their code").required();
    joined.option("--role", o.role, "in it").check(cli::oneOf({"student", "teacher", "examiner"})).showDefault();
    joined.callback([options] { join(*options); });

    cli::Command assigned =
        app.subcommand("assign", "Gives a class an exercise to do, and tells the assignment's id" + where);
    addBooksOptions(assigned, o);
    assigned.option("CLASS", o.schoolClass, "its id").required();
    assigned.option("EXERCISE", o.exercise, "hash of the exercise, as handpiece school exercise told it").required();
    assigned.option("--title", o.name, "as the class reads it");
    assigned.option("--days", o.days, "that it is open")
        .check(cli::range(std::size_t{1}, std::size_t{3650}))
        .showDefault();
    assigned.callback([options] { assign(*options); });

    cli::Command exercise = app.subcommand("exercise", "Adds an exercise, with its rubric" + where);
    addBooksOptions(exercise, o);
    exercise.option("FILE", o.file, "its folder or .handpiece file").required();
    exercise.callback([options] { addExercise(*options); });

    cli::Command results = app.subcommand("results", "What a person's work is worth" + where);
    addBooksOptions(results, o);
    results.option("PERSON", o.person, "their code").required();
    results.callback([options] { tellResults(*options); });
}

void addStationCommands(cli::Command& app) {
    const auto options = std::make_shared<StationOptions>();
    StationOptions& o = *options;
    const auto home = [&o](cli::Command& command) {
        command.option("--home", o.home, "folder with results.db and sessions; else the window's own");
    };
    cli::Command enrolCommand = app.subcommand("enrol", "This station becomes one of a school's");
    home(enrolCommand);
    enrolCommand.option("SERVER", o.server, "its address, as https://school.example:8620").required();
    enrolCommand.option("CODE", o.code, "a one-time code: handpiece-school code").required();
    enrolCommand.option("--person", o.person,
                        "whose results these are: the school's code; not needed with a code of one's own account");
    enrolCommand.flag("--again", o.again, "with another code at the same server; what was sent is not sent again");
    enrolCommand.callback([options] { enrol(*options); });

    cli::Command pushCommand = app.subcommand("push", "Sends the school what it has not heard of yet");
    home(pushCommand);
    pushCommand.callback([options] { push(*options); });

    cli::Command statusCommand = app.subcommand("status", "What waits here, and what the server says");
    home(statusCommand);
    statusCommand.callback([options] { status(*options); });
}

}  // namespace handpiece::school_cli
