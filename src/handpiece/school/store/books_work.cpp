// SPDX-License-Identifier: Apache-2.0
// What stations push, what is said of it, and the work that it makes.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "handpiece/school/store/books_state.h"

namespace handpiece::school {
namespace {

void requireId(const char* what, const std::string& id) {
    if (!isHex(id, 32)) throw invalid(what, id, "send 32 hexadecimal digits");
}
void requirePassed(const std::string& passed) {
    if (passed != "yes" && passed != "no" && passed != "teacher")
        throw invalid("verdict", passed, "send yes, no or teacher");
}

/// All that may not differ when it is pushed again. Not when the server had it.
std::string contentOf(const PushedAttempt& p) {
    std::string all;
    const auto add = [&all](const std::string& text) { all += fmt::format("{}:{};", text.size(), text); };
    const Attempt& a = p.attempt;
    for (const std::string* text : {&a.id, &p.station, &p.person, &p.assignment, &a.exercise, &a.exerciseHash,
                                    &a.rubricHash, &a.device, &a.passed, &a.result})
        add(*text);
    add(joinedLines(a.sessionHashes));
    add(joinedLines(p.files));
    for (const double number : {a.motionScale, a.score, a.maxScore, a.wholeScore, a.workedS, a.limitS})
        add(fmt::format("{}", requireNumber(number)));
    for (const std::int64_t number : {a.began, a.finished, std::int64_t{a.borderline}})
        add(std::to_string(number));
    return sha256(all);
}

// Whether attempt t's own station delivered file f: that somebody else did is nothing to it. A macro so that the
// sentences stay literals.
#define HANDPIECE_DELIVERED                                                                                     \
    "EXISTS (SELECT 1 FROM files c JOIN deliveries d ON d.file = c.hash WHERE c.hash = f.file AND d.station = " \
    "t.station)"

constexpr const char* kAttemptFields =
    "SELECT id, station, person, assignment, exercise, exercise_hash, rubric_hash, session_hashes, began, finished, "
    "received, device, motion_scale, score, max_score, whole_score, passed, borderline, worked_s, limit_s, result "
    "FROM attempts";
PushedAttempt pushedOf(const Statement& row) {
    PushedAttempt p;
    Attempt& a = p.attempt;
    a.id = row.text(0);
    p.station = row.text(1);
    p.person = row.text(2);
    p.assignment = row.text(3);
    a.exercise = row.text(4);
    a.exerciseHash = row.text(5);
    a.rubricHash = row.text(6);
    a.sessionHashes = partedLines(row.text(7));
    a.began = row.integer(8);
    a.finished = row.integer(9);
    p.received = row.integer(10);
    a.device = row.text(11);
    a.motionScale = row.number(12);
    a.score = row.number(13);
    a.maxScore = row.number(14);
    a.wholeScore = row.number(15);
    a.passed = row.text(16);
    a.borderline = row.integer(17) != 0;
    a.workedS = row.number(18);
    a.limitS = row.number(19);
    a.result = row.text(20);
    return p;
}

}  // namespace

void Books::State::requireAttempt(const std::string& id) {
    if (!any("SELECT 1 FROM attempts WHERE id = $1", id)) throw unknown(*database, "attempt", id);
}

void Books::State::queueArrived(const std::string& attempt, Milliseconds now) {
    run("INSERT INTO jobs (number, campaign, attempt, rubric, made, state, worker, lease_until, turn) "
        "SELECT (SELECT coalesce(max(number), 0) FROM jobs) + 1, 'arrival', t.id, "
        "coalesce((SELECT a.rubric FROM assignments a WHERE a.id = t.assignment), t.rubric_hash), CAST($1 AS INT8), "
        "'waiting', '', 0, 0 FROM attempts t WHERE t.id = $2 AND NOT EXISTS (SELECT 1 FROM attempt_files f "
        "WHERE f.attempt = t.id AND NOT " HANDPIECE_DELIVERED ") ON CONFLICT (campaign, attempt) DO NOTHING",
        now, attempt);
}

void Books::State::keepFile(const std::string& hash, Milliseconds now) {
    if (any("SELECT 1 FROM files WHERE hash = $1", hash)) return;
    Transaction transaction(*database);
    // Another may have thrown it away between its coming and this.
    if (!files.has(hash)) throw unknown(*database, "file", hash);
    if (any("INSERT INTO files (hash, bytes, made) VALUES ($1, $2, $3) ON CONFLICT DO NOTHING RETURNING hash", hash,
            std::filesystem::file_size(files.path(hash)), now)) {
        std::vector<std::string> attempts;
        {
            Statement rows = ask("SELECT DISTINCT attempt FROM attempt_files WHERE file = $1 ORDER BY attempt", hash);
            while (rows.next())
                attempts.push_back(rows.text(0));
        }
        for (const std::string& attempt : attempts)
            queueArrived(attempt, now);
    }
    transaction.commit();
}

void Books::State::removeFile(const std::string& hash) {
    Transaction transaction(*database);
    if (!any("SELECT 1 FROM files WHERE hash = $1", hash)) files.remove(hash);
    transaction.commit();
}

bool Books::push(const PushedAttempt& p) {
    const Attempt& a = p.attempt;
    requireId("id of an attempt", a.id);
    for (const std::string* hash : {&a.exerciseHash, &a.rubricHash})
        if (!isHex(*hash, 16)) throw invalid("hash", *hash, "send 16 hexadecimal digits");
    for (const std::string& hash : a.sessionHashes)
        if (!isHex(hash, 16)) throw invalid("hash of a session", hash, "send 16 hexadecimal digits");
    if (p.files.size() != a.sessionHashes.size()) throw invalid("list of files", a.id, "send one for each session");
    for (const std::string& file : p.files)
        static_cast<void>(state_->files.path(file));
    requirePassed(a.passed);
    const std::string content = contentOf(p);
    Transaction transaction(*state_->database);
    {
        Statement row = state_->ask("SELECT content FROM attempts WHERE id = $1", a.id);
        if (row.next()) {
            if (row.text(0) != content) throw changed(*state_->database, "attempt", a.id);
            return false;
        }
    }
    if (!state_->any("SELECT 1 FROM stations WHERE id = $1", p.station))
        throw unknown(*state_->database, "station", p.station);
    if (state_->any("SELECT 1 FROM exam_sittings WHERE id = $1 AND (station <> $2 OR exam <> $3)", a.id, p.station,
                    p.assignment))
        throw invalid("id of an attempt", a.id, "that is an exam's: send another");
    state_->requirePerson(p.person);
    if (!p.assignment.empty() && !state_->any("SELECT 1 FROM assignments WHERE id = $1", p.assignment))
        throw unknown(*state_->database, "assignment", p.assignment);
    state_->run(
        "INSERT INTO attempts (id, station, person, assignment, exercise, exercise_hash, rubric_hash, session_hashes, "
        "began, finished, received, device, motion_scale, score, max_score, whole_score, passed, borderline, worked_s, "
        "limit_s, content, result) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17, "
        "$18, $19, $20, $21, $22)",
        a.id, p.station, p.person, p.assignment, a.exercise, a.exerciseHash, a.rubricHash, joinedLines(a.sessionHashes),
        a.began, a.finished, p.received, a.device, a.motionScale, a.score, a.maxScore, a.wholeScore, a.passed,
        std::int64_t{a.borderline}, a.workedS, a.limitS, content, a.result);
    for (std::size_t i = 0; i < p.files.size(); ++i)
        state_->run("INSERT INTO attempt_files (attempt, place, file) VALUES ($1, $2, $3)", a.id, i, p.files[i]);
    state_->queueArrived(a.id, p.received);
    transaction.commit();
    return true;
}

bool Books::push(const Judgement& j) {
    Transaction transaction(*state_->database);
    state_->requireAttempt(j.attempt);
    const bool isNew = state_->any(
        "INSERT INTO judgements (attempt, percent, words, made) VALUES ($1, $2, $3, $4) "
        "ON CONFLICT DO NOTHING RETURNING attempt",
        j.attempt, j.percent, j.words, j.made);
    if (!isNew && !state_->any("SELECT 1 FROM judgements WHERE attempt = $1 AND percent = CAST($2 AS FLOAT8) AND "
                               "words = $3 AND made = $4",
                               j.attempt, j.percent, j.words, j.made))
        throw changed(*state_->database, "judgement", j.attempt);
    transaction.commit();
    return isNew;
}

bool Books::push(const Comment& c) {
    requireId("id of a comment", c.id);
    const auto axis = [&](int i) { return c.placeMm ? std::optional((*c.placeMm)[i]) : std::nullopt; };
    Transaction transaction(*state_->database);
    state_->requireAttempt(c.attempt);
    state_->requirePerson(c.author);
    const bool isNew = state_->any(
        "INSERT INTO comments (id, attempt, author, words, x_mm, y_mm, z_mm, t_s, made) "
        "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9) ON CONFLICT DO NOTHING RETURNING id",
        c.id, c.attempt, c.author, c.words, axis(0), axis(1), axis(2), c.timeS, c.made);
    if (!isNew && !state_->any("SELECT 1 FROM comments WHERE id = $1 AND attempt = $2 AND author = $3 AND words = $4 "
                               "AND x_mm IS NOT DISTINCT FROM CAST($5 AS FLOAT8) "
                               "AND y_mm IS NOT DISTINCT FROM CAST($6 AS FLOAT8) "
                               "AND z_mm IS NOT DISTINCT FROM CAST($7 AS FLOAT8) "
                               "AND t_s IS NOT DISTINCT FROM CAST($8 AS FLOAT8) AND made = $9",
                               c.id, c.attempt, c.author, c.words, axis(0), axis(1), axis(2), c.timeS, c.made))
        throw changed(*state_->database, "comment", c.id);
    transaction.commit();
    return isNew;
}

bool Books::hasDelivered(const Upload& upload) const {
    return state_->files.has(upload.hash) &&
           state_->any("SELECT 1 FROM deliveries WHERE file = $1 AND station = $2", upload.hash, upload.station);
}

bool Books::isWhole(const std::string& attempt) const {
    return !state_->any(
        "SELECT 1 FROM attempts t JOIN attempt_files f ON f.attempt = t.id WHERE t.id = $1 AND "
        "NOT " HANDPIECE_DELIVERED,
        attempt);
}

std::uint64_t Books::received(const Upload& upload, Milliseconds now) {
    const std::uint64_t part = state_->files.received(upload), there = hasDelivered(upload) ? upload.bytes : part;
    // A server that was killed may have put it in its place and not have written it down.
    if (state_->files.has(upload.hash)) state_->keepFile(upload.hash, now);
    return there;
}

bool Books::append(const Upload& upload, std::uint64_t offset, std::span<const std::byte> piece, Milliseconds now) {
    if (hasDelivered(upload)) {
        state_->keepFile(upload.hash, now);
        return true;
    }
    if (!state_->files.append(upload, offset, piece)) return false;
    state_->keepFile(upload.hash, now);
    Transaction transaction(*state_->database);
    state_->run("INSERT INTO deliveries (file, station, made) VALUES ($1, $2, $3) ON CONFLICT DO NOTHING", upload.hash,
                upload.station, now);
    std::vector<std::string> attempts;
    {
        Statement rows = state_->ask(
            "SELECT DISTINCT f.attempt FROM attempt_files f JOIN attempts t ON t.id = f.attempt WHERE f.file = $1 AND "
            "t.station = $2 ORDER BY f.attempt",
            upload.hash, upload.station);
        while (rows.next())
            attempts.push_back(rows.text(0));
    }
    for (const std::string& attempt : attempts)
        state_->queueArrived(attempt, now);
    transaction.commit();
    return true;
}

const ContentFiles& Books::files() const {
    return state_->files;
}

std::vector<std::string> Books::missingFiles(const std::string& station) const {
    std::vector<std::string> all;
    Statement rows = state_->ask(
        "SELECT DISTINCT f.file FROM attempts t JOIN attempt_files f ON f.attempt = t.id WHERE t.station = $1 AND "
        "NOT " HANDPIECE_DELIVERED " ORDER BY f.file",
        station);
    while (rows.next())
        all.push_back(rows.text(0));
    return all;
}

std::optional<PushedAttempt> Books::attempt(const std::string& id) const {
    std::optional<PushedAttempt> found;
    {
        Statement row = state_->ask(fmt::format("{} WHERE id = $1", kAttemptFields).c_str(), id);
        if (!row.next()) return {};
        found = pushedOf(row);
    }
    Statement rows = state_->ask("SELECT file FROM attempt_files WHERE attempt = $1 ORDER BY place", id);
    while (rows.next())
        found->files.push_back(rows.text(0));
    return found;
}

std::vector<PushedAttempt> Books::attemptsOf(const std::string& person, const std::string& assignment) const {
    std::vector<std::string> ids;
    {
        Statement rows = state_->ask(
            "SELECT id FROM attempts WHERE person = $1 AND ($2 = '' OR assignment = $2) ORDER BY finished, id", person,
            assignment);
        while (rows.next())
            ids.push_back(rows.text(0));
    }
    std::vector<PushedAttempt> all;
    for (const std::string& id : ids)
        if (std::optional<PushedAttempt> one = attempt(id)) all.push_back(std::move(*one));
    return all;
}

void Books::keepContent(const std::string& file, const std::string& inputs) {
    Transaction transaction(*state_->database, Database::Access::beside);
    state_->run(
        "INSERT INTO contents (file, inputs) VALUES ($1, $2) ON CONFLICT (file) DO UPDATE SET inputs = "
        "excluded.inputs",
        file, inputs);
    transaction.commit();
}

void Books::keepSketch(const std::string& file, const std::vector<std::string>& hashes) {
    if (hashes.empty()) return;
    Transaction transaction(*state_->database, Database::Access::beside);
    state_->run("DELETE FROM sketches WHERE file = $1", file);
    for (const std::string& hash : hashes)
        state_->run("INSERT INTO sketches (file, hash) VALUES ($1, $2) ON CONFLICT DO NOTHING", file, hash);
    transaction.commit();
}

std::vector<Books::Alike> Books::alike(const std::string& attempt) const {
    constexpr std::int64_t kLeastPercent = 25, kMost = 5;
    std::vector<Alike> all;
    Statement rows = state_->ask(
        "WITH own AS (SELECT DISTINCT s.hash FROM attempt_files f JOIN sketches s ON s.file = f.file WHERE f.attempt = "
        "$1), shared AS (SELECT t.id, t.person, count(DISTINCT s.hash) AS n FROM own o JOIN sketches s ON s.hash = "
        "o.hash JOIN attempt_files f ON f.file = s.file JOIN attempts t ON t.id = f.attempt WHERE t.person <> (SELECT "
        "person FROM attempts WHERE id = $1) GROUP BY t.id, t.person), compared AS (SELECT h.id, h.person, 100 * h.n / "
        "(SELECT CASE WHEN a.n < b.n THEN a.n ELSE b.n END FROM (SELECT count(*) AS n FROM own) a, (SELECT "
        "count(DISTINCT s.hash) AS n FROM attempt_files f JOIN sketches s ON s.file = f.file WHERE f.attempt = h.id) "
        "b) "
        "AS percent FROM shared h) SELECT id, person, percent FROM compared WHERE percent >= $2 ORDER BY percent DESC, "
        "id LIMIT $3",
        attempt, kLeastPercent, kMost);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.integer(2)});
    return all;
}

std::optional<std::string> Books::otherPersonWith(const std::string& attempt) const {
    Statement row = state_->ask(
        "SELECT a.person FROM attempt_files f JOIN attempts t ON t.id = f.attempt JOIN attempt_files g ON g.file = "
        "f.file OR g.file IN (SELECT d.file FROM contents c JOIN contents d ON d.inputs = c.inputs WHERE c.file = "
        "f.file) JOIN attempts a ON a.id = g.attempt JOIN deliveries y ON y.file = g.file AND y.station = a.station "
        "LEFT JOIN deliveries x ON x.file = f.file AND x.station = t.station WHERE f.attempt = $1 AND a.person <> "
        "t.person AND (x.made IS NULL OR y.made < x.made OR (y.made = x.made AND (a.received < t.received OR "
        "(a.received = t.received AND a.id < t.id)))) ORDER BY y.made, a.id LIMIT 1",
        attempt);
    if (!row.next()) return {};
    return row.text(0);
}

std::vector<Score> Books::scoresOf(const std::string& attempt) const {
    std::vector<Score> all;
    Statement rows = state_->ask(
        "SELECT attempt, campaign, rubric, engine, state, reason, state_hash, score, max_score, whole_score, passed, "
        "borderline, result, worker, made FROM scores s WHERE attempt = $1 ORDER BY CASE WHEN EXISTS (SELECT 1 FROM "
        "attempts t JOIN counting k ON k.assignment = t.assignment WHERE t.id = $1 AND k.campaign = s.campaign) THEN 1 "
        "ELSE 0 END, job",
        attempt);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2), rows.integer(3), rows.text(4), rows.text(5),
                       rows.text(6), rows.number(7), rows.number(8), rows.number(9), rows.text(10),
                       rows.integer(11) != 0, rows.text(12), rows.text(13), rows.integer(14)});
    return all;
}

bool Books::State::push(const Mark& m, const Act& act) {
    requireId("id of a mark", m.id);
    constexpr std::array kKinds = {"teacher", "examiner", "blind", "adjudication"};
    if (std::find(kKinds.begin(), kKinds.end(), m.kind) == kKinds.end())
        throw invalid("kind of mark", m.kind, "send teacher, examiner, blind or adjudication");
    requireAttempt(m.attempt);
    requirePerson(m.marker);
    const bool isNew =
        any("INSERT INTO marks (id, attempt, marker, kind, verdict, points, max_points, marks, "
            "made) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9) ON CONFLICT DO NOTHING "
            "RETURNING id",
            m.id, m.attempt, m.marker, m.kind, m.verdict, m.points, m.maxPoints, m.marks, m.made);
    if (isNew)
        note(act, "mark", m.attempt, m.kind);
    else if (!any("SELECT 1 FROM marks WHERE id = $1 AND attempt = $2 AND marker = $3 AND kind = $4 AND "
                  "verdict = $5 AND points = CAST($6 AS FLOAT8) AND max_points = CAST($7 AS FLOAT8) AND "
                  "marks = $8 AND made = $9",
                  m.id, m.attempt, m.marker, m.kind, m.verdict, m.points, m.maxPoints, m.marks, m.made))
        throw changed(*database, "mark", m.id);
    return isNew;
}

bool Books::push(const Mark& m, const Act& act) {
    Transaction transaction(*state_->database);
    const bool isNew = state_->push(m, act);
    transaction.commit();
    return isNew;
}

std::vector<Mark> Books::marksOf(const std::string& attempt) const {
    std::vector<Mark> all;
    Statement rows = state_->ask(
        "SELECT id, attempt, marker, kind, verdict, points, max_points, marks, made FROM marks WHERE attempt = $1 "
        "ORDER BY made, id",
        attempt);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2), rows.text(3), rows.text(4), rows.number(5),
                       rows.number(6), rows.text(7), rows.integer(8)});
    return all;
}

std::vector<Comment> Books::commentsOn(const std::string& attempt) const {
    std::vector<Comment> all;
    Statement rows = state_->ask(
        "SELECT id, attempt, author, words, x_mm, y_mm, z_mm, t_s, made FROM comments WHERE attempt = $1 ORDER BY "
        "made, id",
        attempt);
    while (rows.next()) {
        Comment comment{rows.text(0), rows.text(1), rows.text(2), rows.text(3), {}, rows.optional(7), rows.integer(8)};
        const std::optional<double> x = rows.optional(4), y = rows.optional(5), z = rows.optional(6);
        if (x && y && z) comment.placeMm = core::Vec3(*x, *y, *z);
        all.push_back(std::move(comment));
    }
    return all;
}

void Books::share(const std::string& attempt, bool shared, const Act& act) {
    Transaction transaction(*state_->database);
    state_->requireAttempt(attempt);
    const bool moved = shared
                           ? state_->any(
                                 "INSERT INTO shares (attempt, made) VALUES ($1, $2) ON CONFLICT DO NOTHING RETURNING "
                                 "attempt",
                                 attempt, act.at)
                           : state_->any("DELETE FROM shares WHERE attempt = $1 RETURNING attempt", attempt);
    if (moved) state_->note(act, shared ? "share" : "share no more", attempt);
    transaction.commit();
}

bool Books::isShared(const std::string& attempt) const {
    return state_->any("SELECT 1 FROM shares WHERE attempt = $1", attempt);
}

std::int64_t Books::rescore(const std::string& campaign, const std::string& assignment, const std::string& rubric,
                            const Act& act) {
    if (campaign.empty() || campaign == "arrival") throw invalid("campaign", campaign, "give it a name of its own");
    Transaction transaction(*state_->database);
    if (!state_->any("SELECT 1 FROM assignments WHERE id = $1", assignment))
        throw unknown(*state_->database, "assignment", assignment);
    if (!state_->any("SELECT 1 FROM rubrics WHERE hash = $1", rubric))
        throw unknown(*state_->database, "rubric", rubric);
    std::int64_t added = 0;
    {
        Statement rows = state_->ask(
            "INSERT INTO jobs (number, campaign, attempt, rubric, made, state, worker, lease_until, turn) "
            "SELECT (SELECT coalesce(max(number), 0) FROM jobs) + row_number() OVER (ORDER BY t.id), $1, t.id, $2, "
            "CAST($3 AS INT8), 'waiting', '', 0, 0 FROM attempts t WHERE t.assignment = $4 AND NOT EXISTS "
            "(SELECT 1 FROM jobs j WHERE j.campaign = $1 AND j.attempt = t.id) AND NOT EXISTS (SELECT 1 FROM "
            "attempt_files f WHERE f.attempt = t.id AND NOT " HANDPIECE_DELIVERED ") RETURNING number",
            campaign, rubric, act.at, assignment);
        while (rows.next())
            ++added;
    }
    state_->note(act, "rescore", assignment, fmt::format("{} by {}", campaign, rubric));
    transaction.commit();
    return added;
}

Milliseconds Books::sharedTime(Milliseconds own) const {
    if (state_->database->engine() == Database::Engine::sqlite) return own;
    return state_->database->number("SELECT CAST(extract(epoch FROM clock_timestamp()) * 1000 AS INT8)");
}

std::optional<Job> Books::takeJob(const std::string& worker, Milliseconds now, Milliseconds lease) {
    const bool isPostgres = state_->database->engine() == Database::Engine::postgres;
    const char* const skip = isPostgres ? " FOR UPDATE SKIP LOCKED" : "";
    std::optional<Job> job;
    Transaction transaction(*state_->database, Database::Access::beside);
    state_->run(fmt::format("UPDATE jobs SET state = 'failed' WHERE number IN (SELECT number FROM jobs WHERE state = "
                            "'taken' AND lease_until <= $1 AND turn >= {}{})",
                            static_cast<int>(kMostTurns), skip)
                    .c_str(),
                now);
    {
        Statement row = state_->ask(
            fmt::format("UPDATE jobs SET state = 'taken', worker = $1, lease_until = $2, turn = turn + 1 WHERE number "
                        "= (SELECT number FROM jobs WHERE state IN ('waiting', 'taken') AND lease_until <= $3 "
                        "ORDER BY number LIMIT 1{}) RETURNING number, turn, campaign, attempt, rubric, lease_until",
                        skip)
                .c_str(),
            worker, now + lease, now);
        if (row.next())
            job = Job{row.integer(0), row.integer(1), row.text(2), row.text(3), row.text(4), row.integer(5)};
    }
    transaction.commit();
    return job;
}

std::optional<Job> Books::lent(const std::string& worker, std::int64_t number, std::int64_t turn) const {
    Statement row = state_->ask(
        "SELECT campaign, attempt, rubric, lease_until FROM jobs WHERE number = $1 AND turn = $2 AND worker = $3 AND "
        "state = 'taken'",
        number, turn, worker);
    if (!row.next()) return {};
    return Job{number, turn, row.text(0), row.text(1), row.text(2), row.integer(3)};
}

std::int64_t Books::countLent(const std::string& worker) const {
    // As the index of open jobs says it, or all jobs ever done would be looked at.
    Statement row = state_->ask(
        "SELECT count(*) FROM jobs WHERE state IN ('waiting', 'taken') AND state = 'taken' AND worker = $1", worker);
    return row.next() ? row.integer(0) : 0;
}

namespace {
/// Still this lending of this job.
constexpr const char* kStillMine =
    "WHERE number = $1 AND turn = $2 AND campaign = $3 AND attempt = $4 AND state = 'taken' RETURNING number";
}  // namespace

bool Books::renew(Job& job, Milliseconds now, Milliseconds lease) {
    Transaction transaction(*state_->database, Database::Access::beside);
    const bool mine = state_->any(fmt::format("UPDATE jobs SET lease_until = $5 {}", kStillMine).c_str(), job.number,
                                  job.turn, job.campaign, job.attempt, now + lease);
    transaction.commit();
    if (mine) job.leaseUntil = now + lease;
    return mine;
}

bool Books::finish(const Job& job, const Score& s) {
    if (s.state != "proven" && s.state != "refused")
        throw invalid("state of a score", s.state, "send proven or refused");
    requirePassed(s.passed);
    Transaction transaction(*state_->database, Database::Access::beside);
    if (!state_->any(fmt::format("UPDATE jobs SET state = 'done' {}", kStillMine).c_str(), job.number, job.turn,
                     job.campaign, job.attempt))
        return false;
    state_->run(
        "INSERT INTO scores (job, attempt, campaign, rubric, engine, state, reason, state_hash, score, max_score, "
        "whole_score, passed, borderline, worker, made, result) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, "
        "$12, $13, $14, $15, $16)",
        job.number, job.attempt, job.campaign, job.rubric, s.engine, s.state, s.reason, s.stateHash, s.score,
        s.maxScore, s.wholeScore, s.passed, std::int64_t{s.borderline}, s.worker, s.made, s.result);
    transaction.commit();
    return true;
}

bool Books::giveBack(const Job& job, Milliseconds notBefore, bool counts) {
    Transaction transaction(*state_->database, Database::Access::beside);
    const bool mine = state_->any(
        fmt::format("UPDATE jobs SET state = CASE WHEN turn >= {} AND $6 = 1 THEN 'failed' ELSE 'waiting' END, "
                    "lease_until = $5, turn = turn - CASE WHEN $6 = 1 THEN 0 ELSE 1 END {}",
                    static_cast<int>(kMostTurns), kStillMine)
            .c_str(),
        job.number, job.turn, job.campaign, job.attempt, notBefore, std::int64_t{counts});
    transaction.commit();
    return mine;
}

std::int64_t Books::retry(Milliseconds now) {
    constexpr Milliseconds kHour = 3'600'000;
    std::int64_t again = 0;
    Transaction transaction(*state_->database, Database::Access::beside);
    {
        Statement rows = state_->ask(
            "UPDATE jobs SET state = 'waiting' WHERE state = 'failed' AND lease_until <= $1 RETURNING number",
            now - kHour);
        while (rows.next())
            ++again;
    }
    transaction.commit();
    return again;
}

Progress Books::progress(const std::string& campaign) const {
    Progress all;
    Statement rows =
        state_->ask("SELECT state, count(*) FROM jobs WHERE campaign = $1 GROUP BY state ORDER BY state", campaign);
    while (rows.next()) {
        const std::string state = rows.text(0);
        (state == "waiting" ? all.waiting
         : state == "taken" ? all.taken
         : state == "done"  ? all.done
                            : all.failed) = rows.integer(1);
    }
    return all;
}

}  // namespace handpiece::school
