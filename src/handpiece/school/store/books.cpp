// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/store/books.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "handpiece/base/core/file.h"
#include "handpiece/base/core/utf8.h"
#include "handpiece/school/store/books_state.h"
#include "handpiece/school/store/database_postgres.h"
#include "handpiece/school/store/database_sqlite.h"

namespace handpiece::school {
namespace {

constexpr Milliseconds kDay = 86'400'000;

}  // namespace

std::unique_ptr<Database> openBooksDatabase(const std::filesystem::path& data, const std::string& address,
                                            std::chrono::milliseconds patience) {
    if (!address.empty()) return std::make_unique<PostgresDatabase>(address, patience);
    const std::filesystem::path file = data / "books.db";
    const bool isNew = !core::isThere(file);
    auto database =
        std::make_unique<SqliteDatabase>(file, patience, DatabaseKind{"school's books", "restore a backup of it"});
    std::error_code none;
    if (isNew)
        std::filesystem::permissions(file, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write,
                                     none);
    // Pages are read while stations push; what is deleted is overwritten.
    database->writeAhead();
    database->run("PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON; PRAGMA secure_delete = ON");
    return database;
}

namespace {

/// What pages show on one line.
void requireName(const char* field, const std::string& name) {
    constexpr std::size_t kMostBytes = 1000;
    if (name.size() > kMostBytes) throw invalid(field, name.substr(0, 40), "say it in 300 characters");
}
/// Safe in an address, a table and a file's name.
void requireCode(const char* field, const std::string& code) {
    const bool isFit = !code.empty() && code.size() <= 64 && std::all_of(code.begin(), code.end(), [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_' ||
               c == '.';
    });
    if (!isFit) throw invalid(field, code, "use 1 to 64 letters, digits, '-', '_' and '.'");
}

template <std::size_t n>
void requireOneOf(const char* field, const std::string& value, const std::array<const char*, n>& all) {
    if (std::find(all.begin(), all.end(), value) == all.end())
        throw invalid(field, value, fmt::format("write one of {}", fmt::join(all, ", ")));
}
constexpr std::array kRoles = {"student", "teacher", "examiner", "administrator"};
constexpr std::array kClassRoles = {"student", "teacher", "examiner"};
constexpr std::array kAssignmentKinds = {"practice", "exam"};

constexpr const char* kPersonColumns =
    "p.code, coalesce(i.name, ''), coalesce(i.login, ''), coalesce(i.external, ''), coalesce(i.password, ''), p.made, "
    "p.erased FROM people p LEFT JOIN identities i ON i.person = p.code";
Person personOf(const Statement& row) {
    return {row.text(0), row.text(1), row.text(2), row.text(3), row.text(4), {}, row.integer(5), row.integer(6)};
}
SchoolClass classOf(const Statement& row) {
    return {row.text(0), row.text(1), row.text(2), row.integer(3), row.integer(4), row.integer(5)};
}
constexpr const char* kAssignmentColumns =
    "SELECT id, class, pack, rubric, title, kind, helps, opens, closes FROM assignments";
Assignment assignmentOf(const Statement& row) {
    return {row.text(0), row.text(1), row.text(2),    row.text(3),   row.text(4),
            row.text(5), row.text(6), row.integer(7), row.integer(8)};
}

}  // namespace

core::Error unknown(const Database& database, const std::string& what, const std::string& which) {
    return core::Error(fmt::format("there is no {} '{}'", what, which), database.where(), "check it, or add it first")
        .as("books-unknown", {what, which});
}
core::Error duplicate(const Database& database, const std::string& what, const std::string& which) {
    return core::Error(fmt::format("there is a {} '{}' already", what, which), database.where(), "give it another")
        .as("books-duplicate", {what, which});
}
core::Error changed(const Database& database, const std::string& what, const std::string& which) {
    return core::Error(fmt::format("the {} '{}' is there with another content, which stays", what, which),
                       database.where(), "give what is new an id of its own")
        .as("books-changed", {what, which});
}
core::Error invalid(const std::string& field, const std::string& value, const std::string& remedy) {
    return core::Error(fmt::format("this is no {}", field), value.substr(0, 80), remedy).as("books-invalid", {field});
}

void requireText(std::string_view text) {
    const std::size_t good = std::min(core::utf8Prefix(text), text.find('\0'));
    if (good < text.size())
        throw core::Error(fmt::format("byte {} of a text is not UTF-8, or zero", good), {}, "send it as UTF-8")
            .as("books-invalid", {"text"});
}

double requireNumber(double number) {
    if (!std::isfinite(number)) throw invalid("number", fmt::format("{}", number), "send a finite one");
    return number + 0.0;
}

void Books::State::note(const Act& act, const std::string& what, const std::string& about, const std::string& detail) {
    if (act.who.empty()) throw invalid("doer", act.who, "say who does this");
    run("INSERT INTO audit (number, at, who, what, about, detail) "
        "SELECT coalesce(max(number), 0) + 1, CAST($1 AS INT8), $2, $3, $4, $5 FROM audit",
        act.at, act.who, what, about, detail);
}

void Books::State::requirePerson(const std::string& code) {
    if (!any("SELECT 1 FROM people WHERE code = $1", code)) throw unknown(*database, "person", code);
}
void Books::State::requireClass(const std::string& id) {
    if (!any("SELECT 1 FROM classes WHERE id = $1", id)) throw unknown(*database, "class", id);
}

Books::Books(const std::filesystem::path& data, const std::string& address, std::chrono::milliseconds patience) {
    core::prepareOutputFolder(data, true);
    state_.reset(new State{openBooksDatabase(data, address, patience), ContentFiles(data)});
    bringUpBooks(*state_->database);
}

Books::~Books() = default;

// People.

void Books::add(std::span<const Person> people, const Act& act) {
    Transaction transaction(*state_->database);
    for (const Person& person : people) {
        requireCode("code of a person", person.code);
        requireName("name", person.name), requireName("login", person.login);
        if (!state_->any("INSERT INTO people (code, made, erased) VALUES ($1, $2, 0) "
                         "ON CONFLICT DO NOTHING RETURNING code",
                         person.code, act.at))
            throw duplicate(*state_->database, "person", person.code);
        if (state_->any("SELECT 1 FROM identities WHERE login = $1 AND login <> ''", person.login))
            throw duplicate(*state_->database, "login", person.login);
        if (state_->any("SELECT 1 FROM identities WHERE external = $1 AND external <> ''", person.external))
            throw duplicate(*state_->database, "external id", person.external);
        state_->run("INSERT INTO identities (person, name, login, external, password) VALUES ($1, $2, $3, $4, $5)",
                    person.code, person.name, person.login, person.external, person.password);
        for (const std::string& role : person.roles) {
            requireOneOf("role", role, kRoles);
            state_->run("INSERT INTO roles (person, role) VALUES ($1, $2) ON CONFLICT DO NOTHING", person.code, role);
        }
        state_->note(act, "add person", person.code);
    }
    transaction.commit();
}

void Books::rename(const std::string& code, const std::string& name, const std::string& login, const Act& act) {
    requireName("name", name), requireName("login", login);
    Transaction transaction(*state_->database);
    if (state_->any("SELECT 1 FROM identities WHERE login = $1 AND login <> '' AND person <> $2", login, code))
        throw duplicate(*state_->database, "login", login);
    if (!state_->any("UPDATE identities SET name = $1, login = $2 WHERE person = $3 RETURNING person", name, login,
                     code))
        throw unknown(*state_->database, "person", code);
    state_->note(act, "rename", code);
    transaction.commit();
}

void Books::setPassword(const std::string& code, const std::string& hash, const Act& act) {
    Transaction transaction(*state_->database);
    if (!state_->any("UPDATE identities SET password = $1 WHERE person = $2 RETURNING person", hash, code))
        throw unknown(*state_->database, "person", code);
    state_->run("DELETE FROM logins WHERE person = $1", code);
    state_->note(act, "set password", code);
    transaction.commit();
}

void Books::setRoles(const std::string& code, const std::vector<std::string>& roles, const Act& act) {
    Transaction transaction(*state_->database);
    state_->requirePerson(code);
    state_->run("DELETE FROM roles WHERE person = $1", code);
    for (const std::string& role : roles) {
        requireOneOf("role", role, kRoles);
        state_->run("INSERT INTO roles (person, role) VALUES ($1, $2) ON CONFLICT DO NOTHING", code, role);
    }
    state_->run("DELETE FROM logins WHERE person = $1", code);
    state_->note(act, "set roles", code, fmt::format("{}", fmt::join(roles, " ")));
    transaction.commit();
}

namespace {
std::vector<Person> withRoles(Statement rows, Statement roles) {
    std::vector<Person> all;
    while (rows.next())
        all.push_back(personOf(rows));
    std::map<std::string, std::vector<std::string>> of;
    while (roles.next())
        of[roles.text(0)].push_back(roles.text(1));
    for (Person& person : all)
        person.roles = of[person.code];
    return all;
}
}  // namespace

std::optional<Person> Books::person(const std::string& code) const {
    Transaction transaction(*state_->database, Database::Access::read);
    std::vector<Person> found =
        withRoles(state_->ask(fmt::format("SELECT {} WHERE p.code = $1", kPersonColumns).c_str(), code),
                  state_->ask("SELECT person, role FROM roles WHERE person = $1 ORDER BY role", code));
    transaction.commit();
    if (found.empty()) return {};
    return found.front();
}

std::optional<Person> Books::personByLogin(const std::string& login) const {
    std::string code;
    {
        Statement row = state_->ask("SELECT person FROM identities WHERE login = $1 AND login <> ''", login);
        if (!row.next()) return {};
        code = row.text(0);
    }
    return person(code);
}

std::vector<Person> Books::people() const {
    Transaction transaction(*state_->database, Database::Access::read);
    std::vector<Person> all = withRoles(state_->ask(fmt::format("SELECT {} ORDER BY p.code", kPersonColumns).c_str()),
                                        state_->ask("SELECT person, role FROM roles ORDER BY person, role"));
    transaction.commit();
    return all;
}

void Books::erase(const std::string& code, const Act& act) {
    Transaction transaction(*state_->database);
    state_->requirePerson(code);
    if (state_->any("UPDATE people SET erased = $1 WHERE code = $2 AND erased = 0 RETURNING code", act.at, code)) {
        state_->run("DELETE FROM identities WHERE person = $1", code);
        for (const char* sql : {"DELETE FROM logins WHERE person = $1", "DELETE FROM password_codes WHERE person = $1",
                                // What a learning platform calls them.
                                "DELETE FROM lti_people WHERE person = $1", "DELETE FROM lti_lines WHERE person = $1",
                                "DELETE FROM lti_grades WHERE person = $1"})
            state_->run(sql, code);
        state_->note(act, "erase", code);
    }
    transaction.commit();
    // Nor in the log of changes: as far as nobody reads from it just now.
    if (state_->database->engine() == Database::Engine::sqlite) state_->ask("PRAGMA wal_checkpoint(TRUNCATE)").run();
}

void Books::addLogin(const std::string& token, const std::string& person, Milliseconds expires, const Act& act) {
    if (token.size() < 32) throw invalid("token of a log-in", "", "use 32 characters or more, by chance");
    Transaction transaction(*state_->database);
    if (!state_->any("SELECT 1 FROM identities WHERE person = $1", person))
        throw unknown(*state_->database, "person", person);
    if (state_->any("SELECT 1 FROM suspensions WHERE person = $1", person))
        throw core::Error("this account is suspended", person, "an administrator can open it again")
            .as("account-suspended", {person});
    state_->run("DELETE FROM logins WHERE person = $1 AND expires <= $2", person, act.at);
    if (!state_->any("INSERT INTO logins (token_hash, person, made, expires) VALUES ($1, $2, $3, $4) "
                     "ON CONFLICT DO NOTHING RETURNING person",
                     sha256(token), person, act.at, expires))
        throw duplicate(*state_->database, "log-in of", person);
    state_->note(act, "log in", person);
    transaction.commit();
}

std::optional<Person> Books::personByToken(const std::string& token, Milliseconds now) const {
    std::string code;
    {
        Statement row =
            state_->ask("SELECT person FROM logins WHERE token_hash = $1 AND expires > $2", sha256(token), now);
        if (!row.next()) return {};
        code = row.text(0);
    }
    return person(code);
}

void Books::endLogin(const std::string& token) {
    Transaction transaction(*state_->database);
    state_->run("DELETE FROM logins WHERE token_hash = $1", sha256(token));
    transaction.commit();
}

// Classes.

void Books::add(const SchoolClass& c, const Act& act) {
    requireCode("id of a class", c.id);
    requireName("name of a class", c.name);
    if (c.retentionDays < 0 || c.retentionDays > 36500)
        throw invalid("retention in days", std::to_string(c.retentionDays), "write 0 to 36500");
    Transaction transaction(*state_->database);
    if (!state_->any("INSERT INTO classes (id, name, external, retention_days, made, closed) "
                     "VALUES ($1, $2, $3, $4, $5, 0) ON CONFLICT DO NOTHING RETURNING id",
                     c.id, c.name, c.external, c.retentionDays, act.at))
        throw duplicate(*state_->database, "class", c.id);
    state_->note(act, "add class", c.id);
    transaction.commit();
}

void Books::close(const std::string& schoolClass, const Act& act) {
    Transaction transaction(*state_->database);
    state_->requireClass(schoolClass);
    if (state_->any("UPDATE classes SET closed = $1 WHERE id = $2 AND closed = 0 RETURNING id", act.at, schoolClass))
        state_->note(act, "close class", schoolClass);
    transaction.commit();
}

void Books::enrol(std::span<const Enrolment> enrolments, const Act& act) {
    Transaction transaction(*state_->database);
    for (const Enrolment& one : enrolments) {
        requireOneOf("role in a class", one.role, kClassRoles);
        state_->requireClass(one.schoolClass);
        state_->requirePerson(one.person);
        state_->run(
            "INSERT INTO enrolments (class, person, role) VALUES ($1, $2, $3) "
            "ON CONFLICT (class, person) DO UPDATE SET role = excluded.role",
            one.schoolClass, one.person, one.role);
        state_->note(act, "enrol", one.person, fmt::format("{} as {}", one.schoolClass, one.role));
    }
    transaction.commit();
}

void Books::leave(const std::string& schoolClass, const std::string& person, const Act& act) {
    Transaction transaction(*state_->database);
    if (!state_->any("DELETE FROM enrolments WHERE class = $1 AND person = $2 RETURNING person", schoolClass, person))
        throw unknown(*state_->database, "enrolment", person);
    state_->note(act, "leave", person, schoolClass);
    transaction.commit();
}

std::vector<SchoolClass> Books::classes() const {
    std::vector<SchoolClass> all;
    Statement rows = state_->ask("SELECT id, name, external, retention_days, made, closed FROM classes ORDER BY id");
    while (rows.next())
        all.push_back(classOf(rows));
    return all;
}

std::vector<Enrolment> Books::enrolments(const std::string& schoolClass) const {
    std::vector<Enrolment> all;
    Statement rows =
        state_->ask("SELECT class, person, role FROM enrolments WHERE class = $1 ORDER BY person", schoolClass);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2)});
    return all;
}

ClassPage Books::classPage(const std::string& schoolClass) const {
    ClassPage page;
    Transaction transaction(*state_->database, Database::Access::read);
    {
        Statement row = state_->ask(
            "SELECT id, name, external, retention_days, made, closed FROM classes WHERE id = $1", schoolClass);
        if (!row.next()) throw unknown(*state_->database, "class", schoolClass);
        page.schoolClass = classOf(row);
    }
    page.assignments = assignments(schoolClass);
    {
        Statement rows = state_->ask(fmt::format("SELECT {} JOIN enrolments e ON e.person = p.code "
                                                 "WHERE e.class = $1 AND e.role = 'student' ORDER BY p.code",
                                                 kPersonColumns)
                                         .c_str(),
                                     schoolClass);
        while (rows.next()) {
            page.students.push_back(personOf(rows));
            page.students.back().password.clear();
            page.students.back().roles = {"student"};
        }
    }
    {
        // How many and which is the last: answered by the index attempts_by_assignment alone.
        Statement rows = state_->ask(
            fmt::format("SELECT r.assignment, r.person, r.n, t.id, t.finished, coalesce(s.state, 'provisional'), "
                        "coalesce(s.score, t.score), coalesce(s.max_score, t.max_score), coalesce(s.passed, t.passed), "
                        "coalesce(s.reason, ''), (SELECT count(*) FROM marks m WHERE m.attempt = t.id) "
                        "FROM (SELECT x.assignment, x.person, count(*) AS n FROM assignments a JOIN attempts x ON "
                        "x.assignment = "
                        "a.id WHERE a.class = $1 GROUP BY x.assignment, x.person) r JOIN attempts t ON t.id = (SELECT "
                        "l.id FROM "
                        "attempts l WHERE l.assignment = r.assignment AND l.person = r.person ORDER BY l.finished "
                        "DESC, l.id DESC "
                        "LIMIT 1) "
                        "LEFT JOIN scores s ON s.job = {} ORDER BY r.assignment, r.person",
                        kCountingJob)
                .c_str(),
            schoolClass);
        while (rows.next())
            page.cells.push_back({rows.text(1), rows.text(0), rows.integer(2), rows.text(3), rows.integer(4),
                                  rows.text(5), rows.number(6), rows.number(7), rows.text(8), rows.text(9),
                                  rows.integer(10)});
    }
    transaction.commit();
    return page;
}

std::vector<std::string> Books::State::removeAttempts(const std::vector<std::string>& attempts, const Act& act) {
    std::vector<std::string> orphans;
    for (const std::string& id : attempts) {
        std::vector<std::string> itsFiles;
        {
            Statement rows = ask("SELECT file FROM attempt_files WHERE attempt = $1", id);
            while (rows.next())
                itsFiles.push_back(rows.text(0));
        }
        // Of an exam: what its station noted stays as a link of the station's chain, without a person.
        for (const char* sql :
             {"DELETE FROM scores WHERE attempt = $1", "DELETE FROM jobs WHERE attempt = $1",
              "DELETE FROM marks WHERE attempt = $1", "DELETE FROM comments WHERE attempt = $1",
              "DELETE FROM judgements WHERE attempt = $1", "DELETE FROM shares WHERE attempt = $1",
              "DELETE FROM sheets WHERE attempt = $1", "DELETE FROM releases WHERE attempt = $1",
              "DELETE FROM calibrations WHERE attempt = $1", "DELETE FROM exemplars WHERE attempt = $1",
              "DELETE FROM exam_doubts WHERE sitting = $1", "DELETE FROM exam_decisions WHERE sitting = $1",
              "DELETE FROM exam_sittings WHERE id = $1", "DELETE FROM attempt_files WHERE attempt = $1",
              "DELETE FROM attempts WHERE id = $1"})
            run(sql, id);
        for (const std::string& file : itsFiles)
            if (any("DELETE FROM files WHERE hash = $1 AND NOT EXISTS (SELECT 1 FROM attempt_files f WHERE f.file = "
                    "files.hash) AND NOT EXISTS (SELECT 1 FROM packs p WHERE p.file = files.hash) RETURNING hash",
                    file))
                orphans.push_back(file);
        note(act, "expire", id);
    }
    return orphans;
}

// Exercises.

void Books::add(const RubricVersion& r, const Act& act) {
    if (!isHex(r.hash, 16)) throw invalid("hash of a rubric", r.hash, "write 16 hexadecimal digits");
    Transaction transaction(*state_->database);
    if (state_->any("INSERT INTO rubrics (hash, id, version, text, made) VALUES ($1, $2, $3, $4, $5) "
                    "ON CONFLICT DO NOTHING RETURNING hash",
                    r.hash, r.id, r.version, r.text, act.at))
        state_->note(act, "add rubric", r.hash);
    else if (!state_->any("SELECT 1 FROM rubrics WHERE hash = $1 AND text = $2", r.hash, r.text))
        throw changed(*state_->database, "rubric", r.hash);
    transaction.commit();
}

void Books::add(const Pack& p, const Act& act) {
    if (!isHex(p.hash, 16)) throw invalid("hash of an exercise", p.hash, "write 16 hexadecimal digits");
    Transaction transaction(*state_->database);
    if (!state_->any("SELECT 1 FROM files WHERE hash = $1", p.file)) throw unknown(*state_->database, "file", p.file);
    if (!state_->any("SELECT 1 FROM rubrics WHERE hash = $1", p.rubric))
        throw unknown(*state_->database, "rubric", p.rubric);
    if (state_->any("INSERT INTO packs (hash, file, exercise, title, rubric, made) VALUES ($1, $2, $3, $4, $5, $6) "
                    "ON CONFLICT DO NOTHING RETURNING hash",
                    p.hash, p.file, p.exercise, p.title, p.rubric, act.at))
        state_->note(act, "add exercise", p.hash);
    else if (!state_->any("SELECT 1 FROM packs WHERE hash = $1 AND exercise = $2 AND rubric = $3", p.hash, p.exercise,
                          p.rubric))
        throw changed(*state_->database, "exercise", p.hash);
    transaction.commit();
}

void Books::add(const Assignment& a, const Act& act) {
    requireCode("id of an assignment", a.id);
    requireOneOf("kind of an assignment", a.kind, kAssignmentKinds);
    requireName("title of an assignment", a.title);
    if (a.closes < a.opens) throw invalid("time to close", std::to_string(a.closes), "close it after it opens");
    Transaction transaction(*state_->database);
    state_->requireClass(a.schoolClass);
    if (!state_->any("SELECT 1 FROM packs WHERE hash = $1", a.pack))
        throw unknown(*state_->database, "exercise", a.pack);
    if (!state_->any("SELECT 1 FROM rubrics WHERE hash = $1", a.rubric))
        throw unknown(*state_->database, "rubric", a.rubric);
    if (state_->any("INSERT INTO assignments (id, class, pack, rubric, title, kind, helps, opens, closes) "
                    "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9) ON CONFLICT DO NOTHING RETURNING id",
                    a.id, a.schoolClass, a.pack, a.rubric, a.title, a.kind, a.helps, a.opens, a.closes))
        state_->note(act, "add assignment", a.id);
    else if (!state_->any("SELECT 1 FROM assignments WHERE id = $1 AND class = $2 AND pack = $3 AND rubric = $4 AND "
                          "title = $5 AND kind = $6 AND helps = $7 AND opens = $8 AND closes = $9",
                          a.id, a.schoolClass, a.pack, a.rubric, a.title, a.kind, a.helps, a.opens, a.closes))
        throw changed(*state_->database, "assignment", a.id);
    transaction.commit();
}

std::optional<RubricVersion> Books::rubric(const std::string& hash) const {
    Statement row = state_->ask("SELECT hash, id, text, version, made FROM rubrics WHERE hash = $1", hash);
    if (!row.next()) return {};
    return RubricVersion{row.text(0), row.text(1), row.text(2), row.integer(3), row.integer(4)};
}

std::optional<Pack> Books::pack(const std::string& hash) const {
    Statement row = state_->ask("SELECT hash, file, exercise, title, rubric, made FROM packs WHERE hash = $1", hash);
    if (!row.next()) return {};
    return Pack{row.text(0), row.text(1), row.text(2), row.text(3), row.text(4), row.integer(5)};
}

std::vector<Assignment> Books::assignments(const std::string& schoolClass) const {
    std::vector<Assignment> all;
    Statement rows =
        state_->ask(fmt::format("{} WHERE class = $1 ORDER BY opens, id", kAssignmentColumns).c_str(), schoolClass);
    while (rows.next())
        all.push_back(assignmentOf(rows));
    return all;
}

std::optional<Assignment> Books::assignment(const std::string& id) const {
    Statement row = state_->ask(fmt::format("{} WHERE id = $1", kAssignmentColumns).c_str(), id);
    if (!row.next()) return {};
    return assignmentOf(row);
}

// Stations.

/// Whose station or code it is, they may come in: not suspended, not erased.
constexpr const char* kIsIn =
    "(person = '' OR (person IN (SELECT code FROM people WHERE erased = 0) AND person NOT IN (SELECT person FROM "
    "suspensions)))";

Station stationOf(const Statement& row) {
    return {row.text(0), row.text(1),    row.integer(2), row.integer(3),
            row.text(4), row.integer(5), row.text(6),    row.integer(7)};
}

void Books::offerCode(const std::string& code, const std::string& name, Milliseconds expires, const Act& act,
                      const std::string& kind, const std::string& person) {
    if (kind != "practice" && kind != "exam" && kind != "worker")
        throw invalid("kind of station", kind, "write practice, exam or worker");
    if (kind != "practice" && !person.empty()) throw invalid("kind of a person's own station", kind, "write practice");
    if (code.size() < 8) throw invalid("code of a station", code, "use 8 characters or more, by chance");
    requireName("name of a station", name);
    Transaction transaction(*state_->database);
    if (!person.empty()) {
        constexpr std::int64_t kMostOpen = 10;
        state_->requirePerson(person);
        state_->run("DELETE FROM station_codes WHERE person = $1 AND station = '' AND expires <= $2", person, act.at);
        Statement open = state_->ask("SELECT count(*) FROM station_codes WHERE person = $1 AND station = ''", person);
        if (open.next() && open.integer(0) >= kMostOpen)
            throw invalid("number of codes", std::to_string(kMostOpen), "use those that were made, or wait a day");
    }
    if (!state_->any("INSERT INTO station_codes (hash, name, expires, station, kind, person) VALUES ($1, $2, $3, '', "
                     "$4, $5) ON CONFLICT DO NOTHING RETURNING hash",
                     sha256(code), name, expires, kind, person))
        throw duplicate(*state_->database, "code of a station", name);
    state_->note(act, kind == "practice" ? "offer station code" : fmt::format("offer {} station code", kind), name);
    transaction.commit();
}

std::optional<Books::Offered> Books::offered(const std::string& code, Milliseconds now) const {
    Statement row = state_->ask(
        fmt::format("SELECT name, kind, person FROM station_codes WHERE hash = $1 AND station = '' AND expires > $2 "
                    "AND {}",
                    kIsIn)
            .c_str(),
        sha256(code), now);
    if (!row.next()) return {};
    return Offered{row.text(0), row.text(1), row.text(2)};
}

std::optional<Station> Books::enrolStation(const std::string& code, const std::string& id, const std::string& key,
                                           Milliseconds now) {
    if (!isHex(id, 32)) throw invalid("id of a station", id, "send 32 hexadecimal digits");
    if (key.size() < 32) throw invalid("key of a station", "", "use 32 characters or more, by chance");
    Transaction transaction(*state_->database);
    Station station;
    station.id = id, station.enrolled = now;
    {
        Statement row = state_->ask(
            fmt::format(
                "UPDATE station_codes SET station = $1 WHERE hash = $2 AND station = '' AND expires > $3 AND {} "
                "RETURNING name, kind, person",
                kIsIn)
                .c_str(),
            id, sha256(code), now);
        if (!row.next()) return {};
        station.name = row.text(0), station.kind = row.text(1), station.person = row.text(2);
        if (!station.person.empty()) station.ends = now + kTerm;
    }
    if (!state_->any(
            "INSERT INTO stations (id, name, key_hash, enrolled, revoked, kind, released, person, ends) VALUES "
            "($1, $2, $3, $4, 0, $5, 0, $6, $7) ON CONFLICT DO NOTHING RETURNING id",
            id, station.name, sha256(key), now, station.kind, station.person, station.ends))
        throw duplicate(*state_->database, "station", id);
    state_->note({"station " + id, now}, "enrol station", id);
    transaction.commit();
    return station;
}

void Books::revoke(const std::string& station, const Act& act) {
    Transaction transaction(*state_->database);
    if (!state_->any("UPDATE stations SET revoked = $1 WHERE id = $2 AND revoked = 0 RETURNING id", act.at, station))
        throw unknown(*state_->database, "station", station);
    state_->note(act, "revoke station", station);
    transaction.commit();
}

void Books::releaseForExams(const std::string& station, const Act& act) {
    Transaction transaction(*state_->database);
    if (!state_->any("SELECT 1 FROM stations WHERE id = $1 AND kind = 'exam' AND revoked = 0", station))
        throw unknown(*state_->database, "station for exams", station);
    if (state_->any("UPDATE stations SET released = $1 WHERE id = $2 AND released = 0 RETURNING id", act.at, station))
        state_->note(act, "release station for exams", station);
    transaction.commit();
}

std::optional<Station> Books::stationByKey(const std::string& key, Milliseconds now) const {
    Statement row = state_->ask(
        fmt::format("{} WHERE key_hash = $1 AND revoked = 0 AND (ends = 0 OR ends > $2) AND {}", kStationColumns, kIsIn)
            .c_str(),
        sha256(key), now);
    if (!row.next()) return {};
    return stationOf(row);
}

std::optional<Station> Books::station(const std::string& id) const {
    Statement row = state_->ask(fmt::format("{} WHERE id = $1", kStationColumns).c_str(), id);
    if (!row.next()) return {};
    return stationOf(row);
}

std::vector<Station> Books::stationsOf(const std::string& person) const {
    std::vector<Station> all;
    Statement rows =
        state_->ask(fmt::format("{} WHERE person = $1 ORDER BY enrolled, id", kStationColumns).c_str(), person);
    while (rows.next())
        all.push_back(stationOf(rows));
    return all;
}

void Books::sweep(Milliseconds now) {
    state_->files.removeUploadsBefore(now - kDay);
    for (const std::string& hash : state_->files.all())
        if (state_->files.madeAt(hash) < now - kDay) state_->removeFile(hash);
}

void Books::note(const Act& act, const std::string& what, const std::string& about, const std::string& detail) {
    Transaction transaction(*state_->database);
    state_->note(act, what, about, detail);
    transaction.commit();
}

std::vector<AuditLine> Books::audit(std::int64_t number, std::size_t most, const std::string& about) const {
    std::vector<AuditLine> all;
    Statement rows = state_->ask(
        fmt::format("SELECT number, at, who, what, about, detail FROM audit WHERE number > $1 {} ORDER BY number "
                    "LIMIT $2",
                    about.empty() ? "AND $3 = ''" : "AND about = $3")
            .c_str(),
        number, most, about);
    while (rows.next())
        all.push_back({rows.integer(0), rows.integer(1), rows.text(2), rows.text(3), rows.text(4), rows.text(5)});
    return all;
}

}  // namespace handpiece::school
