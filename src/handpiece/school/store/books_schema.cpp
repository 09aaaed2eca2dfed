// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>

#include "handpiece/school/store/books_state.h"

namespace handpiece::school {
namespace {

/// What each version adds to the one before. None is ever changed: books of that version are out there. Written once
/// for both: TEXT, INT8 and FLOAT8 are the types, STRICT is SQLite's alone (see inWordsOf).
constexpr std::array<const char*, Books::kVersion> kMigrations = {
    R"sql(
CREATE TABLE people (code TEXT PRIMARY KEY, made INT8 NOT NULL, erased INT8 NOT NULL) STRICT;
CREATE TABLE identities (
  person TEXT PRIMARY KEY REFERENCES people (code), name TEXT NOT NULL, login TEXT NOT NULL, external TEXT NOT NULL,
  password TEXT NOT NULL) STRICT;
CREATE UNIQUE INDEX identities_by_login ON identities (login) WHERE login <> '';
CREATE UNIQUE INDEX identities_by_external ON identities (external) WHERE external <> '';
CREATE TABLE roles (
  person TEXT NOT NULL REFERENCES people (code),
  role TEXT NOT NULL CHECK (role IN ('student', 'teacher', 'examiner', 'administrator')),
  PRIMARY KEY (person, role)) STRICT;
CREATE TABLE classes (
  id TEXT PRIMARY KEY, name TEXT NOT NULL, external TEXT NOT NULL, retention_days INT8 NOT NULL, made INT8 NOT NULL,
  closed INT8 NOT NULL) STRICT;
CREATE TABLE enrolments (
  class TEXT NOT NULL REFERENCES classes (id), person TEXT NOT NULL REFERENCES people (code),
  role TEXT NOT NULL CHECK (role IN ('student', 'teacher', 'examiner')), PRIMARY KEY (class, person)) STRICT;
CREATE INDEX enrolments_by_person ON enrolments (person);
CREATE TABLE files (hash TEXT PRIMARY KEY, bytes INT8 NOT NULL, made INT8 NOT NULL) STRICT;
CREATE TABLE rubrics (
  hash TEXT PRIMARY KEY, id TEXT NOT NULL, version INT8 NOT NULL, text TEXT NOT NULL, made INT8 NOT NULL) STRICT;
CREATE TABLE packs (
  hash TEXT PRIMARY KEY, file TEXT NOT NULL REFERENCES files (hash), exercise TEXT NOT NULL, title TEXT NOT NULL,
  rubric TEXT NOT NULL REFERENCES rubrics (hash), made INT8 NOT NULL) STRICT;
CREATE TABLE assignments (
  id TEXT PRIMARY KEY, class TEXT NOT NULL REFERENCES classes (id), pack TEXT NOT NULL REFERENCES packs (hash),
  rubric TEXT NOT NULL REFERENCES rubrics (hash), title TEXT NOT NULL,
  kind TEXT NOT NULL CHECK (kind IN ('practice', 'exam')), helps TEXT NOT NULL, opens INT8 NOT NULL,
  closes INT8 NOT NULL) STRICT;
CREATE INDEX assignments_by_class ON assignments (class);
CREATE TABLE stations (
  id TEXT PRIMARY KEY, name TEXT NOT NULL, key_hash TEXT NOT NULL UNIQUE, enrolled INT8 NOT NULL,
  revoked INT8 NOT NULL) STRICT;
CREATE TABLE station_codes (
  hash TEXT PRIMARY KEY, name TEXT NOT NULL, expires INT8 NOT NULL, station TEXT NOT NULL) STRICT;
CREATE TABLE attempts (
  id TEXT PRIMARY KEY, station TEXT NOT NULL REFERENCES stations (id), person TEXT NOT NULL REFERENCES people (code),
  assignment TEXT NOT NULL, exercise TEXT NOT NULL, exercise_hash TEXT NOT NULL, rubric_hash TEXT NOT NULL,
  session_hashes TEXT NOT NULL, began INT8 NOT NULL, finished INT8 NOT NULL, received INT8 NOT NULL,
  device TEXT NOT NULL, motion_scale FLOAT8 NOT NULL, score FLOAT8 NOT NULL, max_score FLOAT8 NOT NULL,
  whole_score FLOAT8 NOT NULL, passed TEXT NOT NULL CHECK (passed IN ('yes', 'no', 'teacher')),
  borderline INT8 NOT NULL, worked_s FLOAT8 NOT NULL, limit_s FLOAT8 NOT NULL, content TEXT NOT NULL,
  result TEXT NOT NULL) STRICT;
CREATE INDEX attempts_by_assignment ON attempts (assignment, person, finished, id);
CREATE INDEX attempts_by_person ON attempts (person, finished, id);
CREATE TABLE attempt_files (
  attempt TEXT NOT NULL REFERENCES attempts (id), place INT8 NOT NULL, file TEXT NOT NULL,
  PRIMARY KEY (attempt, place)) STRICT;
CREATE INDEX attempt_files_by_file ON attempt_files (file);
CREATE TABLE judgements (
  attempt TEXT PRIMARY KEY REFERENCES attempts (id), percent FLOAT8 NOT NULL, words TEXT NOT NULL,
  made INT8 NOT NULL) STRICT;
CREATE TABLE comments (
  id TEXT PRIMARY KEY, attempt TEXT NOT NULL REFERENCES attempts (id), author TEXT NOT NULL REFERENCES people (code),
  words TEXT NOT NULL, x_mm FLOAT8, y_mm FLOAT8, z_mm FLOAT8, t_s FLOAT8, made INT8 NOT NULL) STRICT;
CREATE INDEX comments_by_attempt ON comments (attempt);
CREATE TABLE shares (attempt TEXT PRIMARY KEY REFERENCES attempts (id), made INT8 NOT NULL) STRICT;
CREATE TABLE marks (
  id TEXT PRIMARY KEY, attempt TEXT NOT NULL REFERENCES attempts (id), marker TEXT NOT NULL REFERENCES people (code),
  kind TEXT NOT NULL CHECK (kind IN ('teacher', 'examiner', 'blind', 'adjudication')), verdict TEXT NOT NULL,
  points FLOAT8 NOT NULL, max_points FLOAT8 NOT NULL, marks TEXT NOT NULL, made INT8 NOT NULL) STRICT;
CREATE INDEX marks_by_attempt ON marks (attempt);
CREATE TABLE jobs (
  number INT8 PRIMARY KEY, campaign TEXT NOT NULL, attempt TEXT NOT NULL REFERENCES attempts (id),
  rubric TEXT NOT NULL, made INT8 NOT NULL, state TEXT NOT NULL CHECK (state IN ('waiting', 'taken', 'done', 'failed')),
  worker TEXT NOT NULL, lease_until INT8 NOT NULL, turn INT8 NOT NULL, UNIQUE (campaign, attempt)) STRICT;
CREATE INDEX jobs_open ON jobs (number) WHERE state IN ('waiting', 'taken');
CREATE INDEX jobs_by_attempt ON jobs (attempt);
CREATE TABLE scores (
  job INT8 PRIMARY KEY REFERENCES jobs (number), attempt TEXT NOT NULL REFERENCES attempts (id),
  campaign TEXT NOT NULL, rubric TEXT NOT NULL, engine INT8 NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('proven', 'refused')), reason TEXT NOT NULL, state_hash TEXT NOT NULL,
  score FLOAT8 NOT NULL, max_score FLOAT8 NOT NULL, whole_score FLOAT8 NOT NULL,
  passed TEXT NOT NULL CHECK (passed IN ('yes', 'no', 'teacher')), borderline INT8 NOT NULL, worker TEXT NOT NULL,
  made INT8 NOT NULL, result TEXT NOT NULL) STRICT;
CREATE INDEX scores_by_attempt ON scores (attempt, job);
CREATE TABLE audit (
  number INT8 PRIMARY KEY, at INT8 NOT NULL, who TEXT NOT NULL, what TEXT NOT NULL, about TEXT NOT NULL,
  detail TEXT NOT NULL) STRICT;
CREATE INDEX audit_by_about ON audit (about, number);
)sql",
    R"sql(
CREATE TABLE logins (
  token_hash TEXT PRIMARY KEY, person TEXT NOT NULL REFERENCES people (code), made INT8 NOT NULL,
  expires INT8 NOT NULL) STRICT;
CREATE INDEX logins_by_person ON logins (person);
)sql",
    // Operation of a server.
    R"sql(
CREATE TABLE suspensions (person TEXT PRIMARY KEY REFERENCES people (code), made INT8 NOT NULL) STRICT;
CREATE TABLE password_codes (
  person TEXT PRIMARY KEY REFERENCES people (code), hash TEXT NOT NULL, expires INT8 NOT NULL) STRICT;
CREATE TABLE incarnation (id TEXT PRIMARY KEY) STRICT;
)sql",
    // Teaching: marking, standards, exemplars.
    R"sql(
CREATE TABLE desks (
  assignment TEXT NOT NULL REFERENCES assignments (id), marker TEXT NOT NULL REFERENCES people (code),
  seed TEXT NOT NULL, made INT8 NOT NULL, PRIMARY KEY (assignment, marker)) STRICT;
CREATE TABLE desk_works (
  assignment TEXT NOT NULL, marker TEXT NOT NULL, batch INT8 NOT NULL, place INT8 NOT NULL, attempt TEXT NOT NULL,
  PRIMARY KEY (assignment, marker, batch, place), FOREIGN KEY (assignment, marker) REFERENCES desks) STRICT;
CREATE TABLE sheets (
  assignment TEXT NOT NULL, marker TEXT NOT NULL, code TEXT NOT NULL, attempt TEXT NOT NULL REFERENCES attempts (id),
  content TEXT NOT NULL, is_in INT8 NOT NULL, changed INT8 NOT NULL, PRIMARY KEY (assignment, marker, code),
  FOREIGN KEY (assignment, marker) REFERENCES desks) STRICT;
CREATE INDEX sheets_by_attempt ON sheets (attempt);
CREATE TABLE marking_rules (
  assignment TEXT PRIMARY KEY REFERENCES assignments (id), differ_percent FLOAT8 NOT NULL, made INT8 NOT NULL) STRICT;
CREATE TABLE releases (attempt TEXT PRIMARY KEY REFERENCES attempts (id), made INT8 NOT NULL) STRICT;
CREATE TABLE campaigns (
  id TEXT PRIMARY KEY, assignment TEXT NOT NULL REFERENCES assignments (id),
  rubric TEXT NOT NULL REFERENCES rubrics (hash), who TEXT NOT NULL, made INT8 NOT NULL) STRICT;
CREATE INDEX campaigns_by_assignment ON campaigns (assignment);
CREATE TABLE counting (
  assignment TEXT PRIMARY KEY REFERENCES assignments (id), campaign TEXT NOT NULL, first_rubric TEXT NOT NULL,
  made INT8 NOT NULL) STRICT;
CREATE TABLE estimates (
  assignment TEXT NOT NULL REFERENCES assignments (id), judge TEXT NOT NULL REFERENCES people (code),
  round INT8 NOT NULL CHECK (round IN (1, 2)), criterion TEXT NOT NULL, percent FLOAT8 NOT NULL, made INT8 NOT NULL,
  PRIMARY KEY (assignment, judge, round, criterion)) STRICT;
CREATE TABLE standards (
  id TEXT PRIMARY KEY, assignment TEXT NOT NULL REFERENCES assignments (id),
  method TEXT NOT NULL CHECK (method IN ('angoff', 'borderline')), content TEXT NOT NULL, who TEXT NOT NULL,
  made INT8 NOT NULL) STRICT;
CREATE INDEX standards_by_assignment ON standards (assignment);
CREATE TABLE exemplars (
  attempt TEXT PRIMARY KEY REFERENCES attempts (id), assignment TEXT NOT NULL REFERENCES assignments (id),
  content TEXT NOT NULL, who TEXT NOT NULL, made INT8 NOT NULL) STRICT;
CREATE INDEX exemplars_by_assignment ON exemplars (assignment);
CREATE TABLE calibrations (
  attempt TEXT NOT NULL REFERENCES attempts (id), marker TEXT NOT NULL REFERENCES people (code), content TEXT NOT NULL,
  made INT8 NOT NULL, PRIMARY KEY (attempt, marker)) STRICT;
)sql",
    // Exams and other systems.
    R"sql(
CREATE TABLE exam_stations (
  station TEXT PRIMARY KEY REFERENCES stations (id), key TEXT NOT NULL, made INT8 NOT NULL) STRICT;
CREATE TABLE exam_settings (
  exam TEXT PRIMARY KEY REFERENCES assignments (id), minutes INT8 NOT NULL, locked TEXT NOT NULL) STRICT;
CREATE TABLE exam_candidates (
  exam TEXT NOT NULL REFERENCES exam_settings (exam), person TEXT NOT NULL REFERENCES people (code),
  code TEXT NOT NULL, extra_percent INT8 NOT NULL, pause_minutes INT8 NOT NULL, helps TEXT NOT NULL,
  PRIMARY KEY (exam, person), UNIQUE (exam, code)) STRICT;
CREATE TABLE exam_codes (
  exam TEXT NOT NULL REFERENCES exam_settings (exam), code TEXT NOT NULL,
  person TEXT NOT NULL REFERENCES people (code), PRIMARY KEY (exam, code)) STRICT;
CREATE TABLE exam_invigilators (
  exam TEXT NOT NULL REFERENCES exam_settings (exam), person TEXT NOT NULL REFERENCES people (code),
  pin TEXT NOT NULL, PRIMARY KEY (exam, person)) STRICT;
CREATE TABLE exam_packs (
  exam TEXT NOT NULL REFERENCES exam_settings (exam), version INT8 NOT NULL, hash TEXT NOT NULL UNIQUE,
  text TEXT NOT NULL, key TEXT NOT NULL, signature TEXT NOT NULL, made INT8 NOT NULL,
  PRIMARY KEY (exam, version)) STRICT;
CREATE TABLE exam_sittings (
  id TEXT PRIMARY KEY, exam TEXT NOT NULL REFERENCES exam_settings (exam),
  station TEXT NOT NULL REFERENCES exam_stations (station), person TEXT NOT NULL REFERENCES people (code),
  candidate TEXT NOT NULL, pack TEXT NOT NULL, invigilator TEXT NOT NULL, began INT8 NOT NULL, number INT8 NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('begun', 'given-up', 'finished')), ended INT8 NOT NULL) STRICT;
CREATE INDEX exam_sittings_by_exam ON exam_sittings (exam, began, id);
CREATE INDEX exam_sittings_by_person ON exam_sittings (person);
CREATE TABLE exam_entries (
  station TEXT NOT NULL REFERENCES exam_stations (station), number INT8 NOT NULL, hash TEXT NOT NULL,
  kind TEXT NOT NULL, sitting TEXT NOT NULL, text TEXT NOT NULL, key TEXT NOT NULL, signature TEXT NOT NULL,
  at INT8 NOT NULL, received INT8 NOT NULL, PRIMARY KEY (station, number)) STRICT;
CREATE TABLE exam_doubts (
  sitting TEXT PRIMARY KEY REFERENCES exam_sittings (id), doubts TEXT NOT NULL, made INT8 NOT NULL) STRICT;
CREATE TABLE exam_decisions (
  id TEXT PRIMARY KEY, sitting TEXT NOT NULL REFERENCES exam_sittings (id),
  person TEXT NOT NULL REFERENCES people (code),
  kind TEXT NOT NULL CHECK (kind IN ('confirm', 'appeal', 'remark', 'decide')), verdict TEXT NOT NULL,
  points FLOAT8 NOT NULL, max_points FLOAT8 NOT NULL, words TEXT NOT NULL, made INT8 NOT NULL, place INT8 NOT NULL,
  UNIQUE (sitting, place)) STRICT;
CREATE TABLE retention (scope TEXT PRIMARY KEY, days INT8 NOT NULL) STRICT;
CREATE TABLE lti_platforms (
  id TEXT PRIMARY KEY, issuer TEXT NOT NULL, client TEXT NOT NULL, auth_address TEXT NOT NULL,
  token_address TEXT NOT NULL, keys_address TEXT NOT NULL, deployments TEXT NOT NULL, made INT8 NOT NULL,
  UNIQUE (issuer, client)) STRICT;
CREATE TABLE lti_states (
  hash TEXT PRIMARY KEY, platform TEXT NOT NULL REFERENCES lti_platforms (id), nonce_hash TEXT NOT NULL,
  expires INT8 NOT NULL) STRICT;
CREATE TABLE lti_lines (
  assignment TEXT NOT NULL REFERENCES assignments (id), person TEXT NOT NULL REFERENCES people (code),
  platform TEXT NOT NULL REFERENCES lti_platforms (id), subject TEXT NOT NULL, address TEXT NOT NULL,
  PRIMARY KEY (assignment, person)) STRICT;
CREATE TABLE lti_grades (
  number INT8 PRIMARY KEY, assignment TEXT NOT NULL REFERENCES assignments (id),
  person TEXT NOT NULL REFERENCES people (code), platform TEXT NOT NULL REFERENCES lti_platforms (id),
  subject TEXT NOT NULL, address TEXT NOT NULL, body TEXT NOT NULL, tries INT8 NOT NULL, made INT8 NOT NULL,
  next INT8 NOT NULL, sent INT8 NOT NULL, problem TEXT NOT NULL) STRICT;
CREATE INDEX lti_grades_open ON lti_grades (next) WHERE sent = 0;
)sql",
    // A practice station's key could make a whole exam. Those that hold exams are released anew, by an administrator
    // who knows which they are.
    R"sql(
ALTER TABLE station_codes ADD COLUMN kind TEXT NOT NULL DEFAULT 'practice';
ALTER TABLE stations ADD COLUMN kind TEXT NOT NULL DEFAULT 'practice';
ALTER TABLE stations ADD COLUMN released INT8 NOT NULL DEFAULT 0;
UPDATE stations SET kind = 'exam' WHERE id IN (SELECT station FROM exam_stations);
ALTER TABLE lti_platforms ADD COLUMN lists INT8 NOT NULL DEFAULT 0;
UPDATE lti_platforms SET lists = 1 WHERE (SELECT count(*) FROM lti_platforms) = 1;
CREATE TABLE lti_people (
  platform TEXT NOT NULL REFERENCES lti_platforms (id), subject TEXT NOT NULL,
  person TEXT NOT NULL REFERENCES people (code), PRIMARY KEY (platform, subject)) STRICT;
CREATE TABLE contents (file TEXT PRIMARY KEY, inputs TEXT NOT NULL) STRICT;
CREATE INDEX contents_by_inputs ON contents (inputs);
CREATE TABLE deliveries (
  file TEXT NOT NULL, station TEXT NOT NULL, made INT8 NOT NULL, PRIMARY KEY (file, station)) STRICT;
INSERT INTO deliveries (file, station, made)
  SELECT f.file, a.station, min(a.received) FROM attempt_files f JOIN attempts a ON a.id = f.attempt
  JOIN files c ON c.hash = f.file GROUP BY f.file, a.station;
)sql",
    // What confirms a candidate's identity is proven to the server, and an exam's exercise goes out sealed.
    R"sql(
CREATE TABLE exam_confirmations (
  exam TEXT NOT NULL REFERENCES exam_settings (exam), person TEXT NOT NULL REFERENCES people (code),
  number INT8 NOT NULL, hash TEXT NOT NULL, PRIMARY KEY (exam, person, number)) STRICT;
CREATE TABLE exam_openings (
  exam TEXT PRIMARY KEY REFERENCES exam_settings (exam), code TEXT NOT NULL, made INT8 NOT NULL) STRICT;
ALTER TABLE exam_sittings ADD COLUMN confirmation INT8 NOT NULL DEFAULT 0;
ALTER TABLE station_codes ADD COLUMN person TEXT NOT NULL DEFAULT '';
ALTER TABLE stations ADD COLUMN person TEXT NOT NULL DEFAULT '';
ALTER TABLE stations ADD COLUMN ends INT8 NOT NULL DEFAULT 0;
CREATE TABLE sketches (file TEXT NOT NULL, hash TEXT NOT NULL, PRIMARY KEY (file, hash)) STRICT;
CREATE INDEX sketches_by_hash ON sketches (hash);
)sql",
};

/// What is written once and never changed, also by whoever comes to the database by another way; since which version.
struct Stays {
    std::int64_t since;
    std::string_view what;
};
constexpr std::array kStays = {
    Stays{1, "attempts UPDATE"},   Stays{1, "audit UPDATE"},        Stays{1, "audit DELETE"},
    Stays{1, "marks UPDATE"},      Stays{1, "scores UPDATE"},       Stays{1, "rubrics UPDATE"},
    Stays{5, "exam_packs UPDATE"}, Stays{5, "exam_entries UPDATE"}, Stays{5, "exam_decisions UPDATE"}};

std::string replaced(std::string text, std::string_view from, std::string_view to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size())
        text.replace(at, from.size(), to);
    return text;
}

std::string inWordsOf(Database::Engine engine, std::string sql) {
    if (engine == Database::Engine::sqlite) return replaced(replaced(sql, "INT8", "INTEGER"), "FLOAT8", "REAL");
    // In the order of bytes, whatever the server's language: as SQLite has it.
    return replaced(replaced(sql, ") STRICT;", ");"), " TEXT", " TEXT COLLATE \"C\"");
}

/// Of what came after `version`, until `to`.
std::string guards(Database::Engine engine, std::int64_t version, std::int64_t to) {
    std::string sql;
    if (engine == Database::Engine::postgres && version == 0)
        sql =
            "CREATE FUNCTION handpiece_stays() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN "
            "RAISE EXCEPTION 'this is never changed'; END $$;";
    for (const auto& [since, stays] : kStays) {
        if (since <= version || since > to) continue;
        const std::string_view table = stays.substr(0, stays.find(' ')), action = stays.substr(stays.find(' ') + 1);
        sql += fmt::format("CREATE TRIGGER {0}_{1}_stays BEFORE {1} ON {0} ", table, action);
        sql += engine == Database::Engine::sqlite ? "BEGIN SELECT RAISE(ABORT, 'this is never changed'); END;"
                                                  : "FOR EACH ROW EXECUTE FUNCTION handpiece_stays();";
    }
    return sql;
}

std::int64_t tables(Database& database, const std::string& which) {
    const bool isSqlite = database.engine() == Database::Engine::sqlite;
    const std::string sql = isSqlite ? "SELECT count(*) FROM sqlite_schema WHERE type = 'table'"
                                     : "SELECT count(*) FROM pg_tables WHERE schemaname = current_schema()";
    const std::string name = isSqlite ? "name" : "tablename";
    return database.number((sql + (which.empty() ? "" : " AND " + name + " = '" + which + "'")).c_str());
}

std::int64_t versionOf(Database& database) {
    // In this order: another program may make all of them between these two.
    if (tables(database, "") == 0) return 0;
    if (tables(database, "handpiece_books") == 0)
        throw core::Error("this is a database of another program", database.where(),
                          "name an empty database, or another folder")
            .as("store-damaged", {"a database of another program"});
    const std::int64_t version = database.number("SELECT version FROM handpiece_books");
    if (version < 1)
        throw core::Error(fmt::format("these books are damaged: version {}", version), database.where(),
                          "restore a backup of it")
            .as("store-damaged", {fmt::format("version {}", version)});
    if (version > Books::kVersion)
        throw core::Error(fmt::format("these books are of version {}, and this program knows {}", version,
                                      static_cast<int>(Books::kVersion)),
                          database.where(), "start the newer Handpiece")
            .as("store-newer", {std::to_string(version), std::to_string(Books::kVersion)});
    return version;
}

}  // namespace

int versionOfBooks(Database& database) {
    return static_cast<int>(versionOf(database));
}

void bringUpBooks(Database& database) {
    if (versionOf(database) == Books::kVersion) return;
    Transaction transaction(database);
    // It asks again now that nobody else can write: two programs may have come to the same old books.
    raiseBooks(database, Books::kVersion);
    transaction.commit();
}

void raiseBooks(Database& database, int to) {
    const std::int64_t version = versionOf(database);
    if (version >= to) return;
    if (version == 0)
        database.run(
            inWordsOf(database.engine(), "CREATE TABLE handpiece_books (version INT8 NOT NULL) STRICT;").c_str());
    for (std::int64_t next = version; next < to; ++next)
        database.run(inWordsOf(database.engine(), kMigrations[static_cast<std::size_t>(next)]).c_str());
    if (const std::string kept = guards(database.engine(), version, to); !kept.empty()) database.run(kept.c_str());
    constexpr int kHasIncarnation = 3;
    if (version < kHasIncarnation && to >= kHasIncarnation)
        Statement(database, "INSERT INTO incarnation (id) VALUES ($1)").with(newId()).run();
    database.run("DELETE FROM handpiece_books");
    database.run(fmt::format("INSERT INTO handpiece_books (version) VALUES ({})", to).c_str());
}

}  // namespace handpiece::school
