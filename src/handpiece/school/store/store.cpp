// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/store/store.h"

#include <fmt/format.h>

#include <array>
#include <random>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/store/database_sqlite.h"

namespace handpiece::school {
namespace {

/// "HPst": tells a store from any other file of SQLite's.
constexpr std::int64_t kApplicationId = 0x48507374;

/// What each version adds to the one before. None is ever changed: stores of that version are out there.
constexpr std::array<const char*, Store::kVersion> kMigrations = {
    R"sql(
CREATE TABLE exercises (
  id TEXT NOT NULL, version INTEGER NOT NULL, hash TEXT NOT NULL, title TEXT NOT NULL,
  first_seen INTEGER NOT NULL, last_seen INTEGER NOT NULL, PRIMARY KEY (id, hash)) STRICT;
CREATE TABLE attempts (
  id TEXT PRIMARY KEY, exercise TEXT NOT NULL, exercise_hash TEXT NOT NULL, rubric_hash TEXT NOT NULL,
  session_hashes TEXT NOT NULL, recordings TEXT NOT NULL, began INTEGER NOT NULL, finished INTEGER NOT NULL,
  device TEXT NOT NULL, motion_scale REAL NOT NULL, score REAL NOT NULL, max_score REAL NOT NULL,
  passed TEXT NOT NULL CHECK (passed IN ('yes', 'no', 'teacher')), borderline INTEGER NOT NULL,
  proven INTEGER NOT NULL, result TEXT NOT NULL) STRICT;
CREATE INDEX attempts_by_exercise ON attempts (exercise, finished);
CREATE TABLE outbox (
  sequence INTEGER PRIMARY KEY AUTOINCREMENT, kind TEXT NOT NULL, id TEXT NOT NULL, made INTEGER NOT NULL) STRICT;
CREATE TRIGGER attempts_stay BEFORE UPDATE ON attempts BEGIN SELECT RAISE(ABORT, 'attempts are not changed'); END;
CREATE TRIGGER outbox_stays BEFORE UPDATE ON outbox BEGIN SELECT RAISE(ABORT, 'the outbox only grows'); END;
CREATE TRIGGER outbox_keeps BEFORE DELETE ON outbox BEGIN SELECT RAISE(ABORT, 'the outbox only grows'); END;
)sql",
    R"sql(
CREATE TABLE judgements (
  attempt TEXT PRIMARY KEY REFERENCES attempts (id), percent REAL NOT NULL, words TEXT NOT NULL,
  made INTEGER NOT NULL) STRICT;
CREATE TABLE comments (
  id TEXT PRIMARY KEY, attempt TEXT NOT NULL REFERENCES attempts (id), author TEXT NOT NULL, words TEXT NOT NULL,
  x_mm REAL, y_mm REAL, z_mm REAL, t_s REAL, made INTEGER NOT NULL) STRICT;
CREATE INDEX comments_by_attempt ON comments (attempt, made);
ALTER TABLE attempts ADD COLUMN whole_score REAL NOT NULL DEFAULT 0;
)sql",
    R"sql(
CREATE TABLE retests (
  exercise TEXT NOT NULL, criterion TEXT NOT NULL, attempt TEXT NOT NULL REFERENCES attempts (id),
  step INTEGER NOT NULL, due INTEGER NOT NULL, PRIMARY KEY (exercise, criterion)) STRICT;
ALTER TABLE attempts ADD COLUMN worked_s REAL NOT NULL DEFAULT 0;
ALTER TABLE attempts ADD COLUMN limit_s REAL NOT NULL DEFAULT 0;
ALTER TABLE exercises ADD COLUMN place TEXT NOT NULL DEFAULT '';
)sql",
    R"sql(
CREATE TABLE returned (
  attempt TEXT NOT NULL REFERENCES attempts (id), marker TEXT NOT NULL, marks TEXT NOT NULL, made INTEGER NOT NULL,
  PRIMARY KEY (attempt, marker)) STRICT;
)sql",
};

void post(Database& database, const char* kind, const std::string& id, Milliseconds made) {
    Statement(database, "INSERT INTO outbox (kind, id, made) VALUES (?, ?, ?)").with(kind).with(id).with(made).run();
}

void migrate(Database& database) {
    Transaction transaction(database);
    // Asked again now that nobody else can write: two programs may have come to the same old file.
    const std::int64_t version = database.number("PRAGMA user_version");
    for (std::int64_t next = version; next < Store::kVersion; ++next)
        database.run(kMigrations[static_cast<std::size_t>(next)]);
    database.run(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", kApplicationId,
                             static_cast<int>(Store::kVersion))
                     .c_str());
    transaction.commit();
}

/// New, of now, of before; throws for what is another's, or of a later program.
void bringUp(Database& database) {
    // Looked at in one moment: another program may make it meanwhile.
    Transaction seen(database, Database::Access::read);
    const std::int64_t application = database.number("PRAGMA application_id");
    const std::int64_t version = database.number("PRAGMA user_version");
    const bool isNew = application == 0 && version == 0 && database.number("SELECT count(*) FROM sqlite_schema") == 0;
    seen.commit();
    if (!isNew && application != kApplicationId)
        throw core::Error("this is a database of another program", database.where(),
                          "move the file away: a new one is made")
            .as("store-damaged", {"a database of another program"});
    if (version < 0)
        throw core::Error(fmt::format("this store of results is damaged: version {}", version), database.where(),
                          "move the file away: a new one is made")
            .as("store-damaged", {fmt::format("version {}", version)});
    if (version > Store::kVersion)
        throw core::Error(fmt::format("this store is of version {}, and this program knows {}", version,
                                      static_cast<int>(Store::kVersion)),
                          database.where(), "open it with the newer Handpiece")
            .as("store-newer", {std::to_string(version), std::to_string(Store::kVersion)});
    if (version < Store::kVersion) migrate(database);
    if (const std::string sound = database.text("PRAGMA quick_check(1)"); sound != "ok")
        throw core::Error("this store of results is damaged: " + sound, database.where(),
                          "move the file away: a new one is made")
            .as("store-damaged", {sound});
}

constexpr const char* kAttemptColumns =
    "id, exercise, exercise_hash, rubric_hash, session_hashes, recordings, began, finished, device, motion_scale, "
    "score, max_score, passed, borderline, proven, result, whole_score, worked_s, limit_s";

Attempt attemptOf(const Statement& row) {
    Attempt attempt;
    attempt.id = row.text(0);
    attempt.exercise = row.text(1);
    attempt.exerciseHash = row.text(2);
    attempt.rubricHash = row.text(3);
    attempt.sessionHashes = partedLines(row.text(4));
    attempt.recordings = partedLines(row.text(5));
    attempt.began = row.integer(6);
    attempt.finished = row.integer(7);
    attempt.device = row.text(8);
    attempt.motionScale = row.number(9);
    attempt.score = row.number(10);
    attempt.maxScore = row.number(11);
    attempt.passed = row.text(12);
    attempt.borderline = row.integer(13) != 0;
    attempt.proven = row.integer(14) != 0;
    attempt.result = row.text(15);
    attempt.wholeScore = row.number(16);
    attempt.workedS = row.number(17);
    attempt.limitS = row.number(18);
    return attempt;
}

}  // namespace

std::string newId() {
    std::random_device device;
    std::string id;
    for (int word = 0; word < 4; ++word)
        id += fmt::format("{:08x}", device());
    return id;
}

struct Store::State {
    SqliteDatabase database;
};

Store::Store(const std::filesystem::path& file, std::chrono::milliseconds patience) {
    std::error_code error;
    if (!file.parent_path().empty() && !std::filesystem::exists(file, error))
        core::prepareOutputFolder(file.parent_path(), true);
    state_.reset(new State{{file, patience, {}}});
    Database& database = state_->database;
    // In a journal beside it: one file when nobody writes, and sound on a network's disk, where shared memory is not.
    database.run("PRAGMA journal_mode = DELETE; PRAGMA synchronous = EXTRA; PRAGMA foreign_keys = ON");
    bringUp(database);
    std::filesystem::permissions(file, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write, error);
}

Store::~Store() = default;

void Store::see(const Exercise& exercise) {
    Transaction transaction(state_->database);
    Statement(state_->database,
              "INSERT INTO exercises (id, version, hash, title, first_seen, last_seen, place) VALUES (?1, ?2, ?3, ?4, "
              "?5, ?6, ?7) ON CONFLICT (id, hash) DO UPDATE SET version = ?2, title = ?4, last_seen = ?6, "
              "place = CASE ?7 WHEN '' THEN place ELSE ?7 END")
        .with(exercise.id)
        .with(exercise.version)
        .with(exercise.hash)
        .with(exercise.title)
        .with(exercise.firstSeen)
        .with(exercise.lastSeen)
        .with(exercise.place)
        .run();
    transaction.commit();
}

std::vector<Exercise> Store::exercises() const {
    std::vector<Exercise> all;
    Statement rows(state_->database,
                   "SELECT id, version, hash, title, first_seen, last_seen, place FROM exercises ORDER BY id, "
                   "first_seen");
    while (rows.next())
        all.push_back({rows.text(0), rows.integer(1), rows.text(2), rows.text(3), rows.integer(4), rows.integer(5),
                       rows.text(6)});
    return all;
}

void Store::add(const Attempt& attempt) {
    Transaction transaction(state_->database);
    insert(attempt);
    transaction.commit();
}

void Store::add(const Attempt& attempt, const std::vector<Retest>& retests) {
    Transaction transaction(state_->database);
    insert(attempt);
    Statement(state_->database, "DELETE FROM retests WHERE exercise = ?").with(attempt.exercise).run();
    for (const Retest& retest : retests)
        Statement(state_->database,
                  "INSERT INTO retests (exercise, criterion, attempt, step, due) VALUES (?, ?, ?, ?, ?)")
            .with(attempt.exercise)
            .with(retest.criterion)
            .with(retest.attempt)
            .with(std::int64_t{retest.step})
            .with(retest.due)
            .run();
    transaction.commit();
}

std::vector<Retest> Store::retests(const std::string& exercise) const {
    std::vector<Retest> all;
    Statement rows(state_->database,
                   "SELECT exercise, criterion, attempt, step, due FROM retests WHERE ?1 = '' OR exercise = ?1 "
                   "ORDER BY due, exercise, criterion");
    rows.with(exercise);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2), static_cast<int>(rows.integer(3)), rows.integer(4)});
    return all;
}

/// In a transaction.
void Store::insert(const Attempt& a) {
    Statement(state_->database,
              fmt::format("INSERT INTO attempts ({}) VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)", kAttemptColumns)
                  .c_str())
        .with(a.id)
        .with(a.exercise)
        .with(a.exerciseHash)
        .with(a.rubricHash)
        .with(joinedLines(a.sessionHashes))
        .with(joinedLines(a.recordings))
        .with(a.began)
        .with(a.finished)
        .with(a.device)
        .with(a.motionScale)
        .with(a.score)
        .with(a.maxScore)
        .with(a.passed)
        .with(std::int64_t{a.borderline})
        .with(std::int64_t{a.proven})
        .with(a.result)
        .with(a.wholeScore)
        .with(a.workedS)
        .with(a.limitS)
        .run();
    post(state_->database, "attempt", a.id, a.finished);
}

void Store::add(const Judgement& judgement) {
    Transaction transaction(state_->database);
    Statement(state_->database, "INSERT INTO judgements (attempt, percent, words, made) VALUES (?, ?, ?, ?)")
        .with(judgement.attempt)
        .with(judgement.percent)
        .with(judgement.words)
        .with(judgement.made)
        .run();
    post(state_->database, "judgement", judgement.attempt, judgement.made);
    transaction.commit();
}

std::vector<Attempt> Store::attempts(const std::string& exercise) const {
    std::vector<Attempt> all;
    Statement rows(
        state_->database,
        fmt::format("SELECT {} FROM attempts WHERE ?1 = '' OR exercise = ?1 ORDER BY finished, rowid", kAttemptColumns)
            .c_str());
    rows.with(exercise);
    while (rows.next())
        all.push_back(attemptOf(rows));
    return all;
}

std::optional<Attempt> Store::attempt(const std::string& id) const {
    Statement rows(state_->database, fmt::format("SELECT {} FROM attempts WHERE id = ?", kAttemptColumns).c_str());
    rows.with(id);
    if (!rows.next()) return {};
    return attemptOf(rows);
}

std::optional<Judgement> Store::judgementOf(const std::string& attempt) const {
    Statement rows(state_->database, "SELECT attempt, percent, words, made FROM judgements WHERE attempt = ?");
    rows.with(attempt);
    if (!rows.next()) return {};
    return Judgement{rows.text(0), rows.number(1), rows.text(2), rows.integer(3)};
}

void Store::add(const Comment& c) {
    const auto axis = [&](int i) { return c.placeMm ? std::optional((*c.placeMm)[i]) : std::nullopt; };
    Transaction transaction(state_->database);
    Statement(state_->database,
              "INSERT INTO comments (id, attempt, author, words, x_mm, y_mm, z_mm, t_s, made) "
              "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)")
        .with(c.id)
        .with(c.attempt)
        .with(c.author)
        .with(c.words)
        .with(axis(0))
        .with(axis(1))
        .with(axis(2))
        .with(c.timeS)
        .with(c.made)
        .run();
    post(state_->database, "comment", c.id, c.made);
    transaction.commit();
}

std::vector<Comment> Store::commentsOn(const std::string& attempt) const {
    std::vector<Comment> all;
    Statement rows(state_->database,
                   "SELECT id, attempt, author, words, x_mm, y_mm, z_mm, t_s, made FROM comments WHERE attempt = ? "
                   "ORDER BY made, rowid");
    rows.with(attempt);
    while (rows.next()) {
        Comment comment{rows.text(0), rows.text(1), rows.text(2), rows.text(3), {}, rows.optional(7), rows.integer(8)};
        const std::optional<double> x = rows.optional(4), y = rows.optional(5), z = rows.optional(6);
        if (x && y && z) comment.placeMm = core::Vec3(*x, *y, *z);
        all.push_back(std::move(comment));
    }
    return all;
}

void Store::add(const Returned& returned) {
    Transaction transaction(state_->database);
    Statement(state_->database, "INSERT OR REPLACE INTO returned (attempt, marker, marks, made) VALUES (?, ?, ?, ?)")
        .with(returned.attempt)
        .with(returned.marker)
        .with(returned.marks)
        .with(returned.made)
        .run();
    post(state_->database, "returned", returned.attempt, returned.made);
    transaction.commit();
}

std::vector<Returned> Store::returnedOf(const std::string& attempt) const {
    std::vector<Returned> all;
    Statement rows(state_->database,
                   "SELECT attempt, marker, marks, made FROM returned WHERE attempt = ? ORDER BY made, rowid");
    rows.with(attempt);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2), rows.integer(3)});
    return all;
}

std::vector<Outgoing> Store::outbox(std::int64_t sequence, std::size_t most) const {
    std::vector<Outgoing> all;
    Statement rows(state_->database,
                   "SELECT sequence, kind, id, made FROM outbox WHERE sequence > ? ORDER BY sequence LIMIT ?");
    rows.with(sequence).with(static_cast<std::int64_t>(most));
    while (rows.next())
        all.push_back({rows.integer(0), rows.text(1), rows.text(2), rows.integer(3)});
    return all;
}

}  // namespace handpiece::school
