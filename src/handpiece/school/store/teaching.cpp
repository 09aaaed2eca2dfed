// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/store/teaching.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "handpiece/school/store/books_state.h"

namespace handpiece::school {
namespace {

constexpr const char* kSheetFields =
    "SELECT assignment, marker, code, attempt, content, is_in, changed FROM sheets WHERE assignment = $1 ";
MarkingSheet sheetOf(const Statement& row) {
    return {row.text(0), row.text(1), row.text(2), row.text(3), row.text(4), row.integer(5) != 0, row.integer(6)};
}
constexpr const char* kCampaignFields = "SELECT id, assignment, rubric, who, made FROM campaigns ";
Campaign campaignOf(const Statement& row) {
    return {row.text(0), row.text(1), row.text(2), row.text(3), row.integer(4)};
}
std::uint64_t seedOf(const std::string& hex) {
    std::uint64_t value = 0;
    std::from_chars(hex.data(), hex.data() + hex.size(), value, 16);
    return value;
}

}  // namespace

void Teaching::requireAssignment(const std::string& id) const {
    if (!state_.any("SELECT 1 FROM assignments WHERE id = $1", id)) throw unknown(*state_.database, "assignment", id);
}

// Exercises, rubrics, assignments.

std::vector<Pack> Teaching::packs() const {
    std::vector<Pack> all;
    Statement rows =
        state_.ask("SELECT hash, file, exercise, title, rubric, made FROM packs ORDER BY title, made, hash");
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2), rows.text(3), rows.text(4), rows.integer(5)});
    return all;
}

std::vector<RubricVersion> Teaching::rubrics() const {
    std::vector<RubricVersion> all;
    Statement rows = state_.ask("SELECT hash, id, text, version, made FROM rubrics ORDER BY id, version, made, hash");
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2), rows.integer(3), rows.integer(4)});
    return all;
}

RubricVersion Teaching::addRubric(const RubricVersion& rubric, const Act& act) {
    if (!isHex(rubric.hash, 16)) throw invalid("hash of a rubric", rubric.hash, "write 16 hexadecimal digits");
    RubricVersion made = rubric;
    made.made = act.at;
    Transaction transaction(*state_.database);
    Statement there = state_.ask("SELECT id, text, version, made FROM rubrics WHERE hash = $1", rubric.hash);
    if (there.next()) {
        if (there.text(1) != rubric.text) throw changed(*state_.database, "rubric", rubric.hash);
        return {rubric.hash, there.text(0), there.text(1), there.integer(2), there.integer(3)};
    }
    {
        Statement last = state_.ask("SELECT coalesce(max(version), 0) FROM rubrics WHERE id = $1", rubric.id);
        made.version = last.next() ? last.integer(0) + 1 : 1;
    }
    state_.run("INSERT INTO rubrics (hash, id, version, text, made) VALUES ($1, $2, $3, $4, $5)", made.hash, made.id,
               made.version, made.text, made.made);
    state_.note(act, "add rubric", made.hash, fmt::format("{} version {}", made.id, made.version));
    transaction.commit();
    return made;
}

void Teaching::setTimes(const std::string& assignment, Milliseconds opens, Milliseconds closes, const Act& act) {
    if (closes < opens) throw invalid("time to close", std::to_string(closes), "close it after it opens");
    Transaction transaction(*state_.database);
    requireAssignment(assignment);
    std::string before;
    {
        Statement row = state_.ask("SELECT opens, closes FROM assignments WHERE id = $1", assignment);
        if (row.next()) before = fmt::format("{} to {}", row.integer(0), row.integer(1));
    }
    state_.run("UPDATE assignments SET opens = $1, closes = $2 WHERE id = $3", opens, closes, assignment);
    state_.note(act, "set times", assignment, fmt::format("{} to {}, was {}", opens, closes, before));
    transaction.commit();
}

// Marking.

std::vector<std::string> Teaching::worksOf(const std::string& assignment) const {
    std::vector<std::string> all;
    Statement rows = state_.ask(
        "SELECT t.id FROM attempts t WHERE t.assignment = $1 AND t.id = (SELECT l.id FROM attempts l WHERE "
        "l.assignment = t.assignment AND l.person = t.person AND EXISTS (SELECT 1 FROM scores s WHERE s.attempt = "
        "l.id) ORDER BY l.finished DESC, l.id DESC LIMIT 1) AND NOT EXISTS (SELECT 1 FROM exemplars e WHERE e.attempt "
        "= "
        "t.id) ORDER BY t.id",
        assignment);
    while (rows.next())
        all.push_back(rows.text(0));
    return all;
}

std::vector<MarkingDesk> Teaching::desks(const std::string& assignment, const std::string& marker) const {
    std::vector<MarkingDesk> all;
    Statement rows = state_.ask(
        "SELECT d.marker, d.seed, d.made, coalesce(w.batch, -1), coalesce(w.attempt, '') FROM desks d LEFT JOIN "
        "desk_works w ON w.assignment = d.assignment AND w.marker = d.marker WHERE d.assignment = $1 AND ($2 = '' OR "
        "d.marker = $2) ORDER BY d.marker, w.batch, w.place",
        assignment, marker);
    while (rows.next()) {
        if (all.empty() || all.back().marker != rows.text(0))
            all.push_back({assignment, rows.text(0), seedOf(rows.text(1)), rows.integer(2), {}});
        const std::int64_t batch = rows.integer(3);
        if (batch < 0) continue;
        if (static_cast<std::int64_t>(all.back().batches.size()) <= batch) all.back().batches.emplace_back();
        all.back().batches.back().push_back(rows.text(4));
    }
    return all;
}

std::optional<MarkingDesk> Teaching::desk(const std::string& assignment, const std::string& marker) const {
    if (marker.empty()) return {};
    std::vector<MarkingDesk> found = desks(assignment, marker);
    if (found.empty()) return {};
    return std::move(found.front());
}

MarkingDesk Teaching::takeWorks(const std::string& assignment, const std::string& marker, std::uint64_t seed,
                                const Act& act) {
    Transaction transaction(*state_.database);
    requireAssignment(assignment);
    state_.requirePerson(marker);
    if (state_.any("INSERT INTO desks (assignment, marker, seed, made) VALUES ($1, $2, $3, $4) ON CONFLICT DO NOTHING "
                   "RETURNING marker",
                   assignment, marker, fmt::format("{:016x}", seed), act.at))
        state_.note(act, "begin marking", assignment);
    MarkingDesk made = desk(assignment, marker).value();
    std::vector<std::string> batch;
    for (const std::string& id : worksOf(assignment)) {
        const bool isThere = std::any_of(made.batches.begin(), made.batches.end(), [&](const auto& one) {
            return std::find(one.begin(), one.end(), id) != one.end();
        });
        if (isThere || state_.any("SELECT 1 FROM attempts WHERE id = $1 AND person = $2", id, marker)) continue;
        state_.run("INSERT INTO desk_works (assignment, marker, batch, place, attempt) VALUES ($1, $2, $3, $4, $5)",
                   assignment, marker, made.batches.size(), batch.size(), id);
        batch.push_back(id);
    }
    if (!batch.empty()) {
        state_.note(act, "take works", assignment, std::to_string(batch.size()));
        made.batches.push_back(std::move(batch));
    }
    transaction.commit();
    return made;
}

std::vector<MarkingSheet> Teaching::sheets(const std::string& assignment, const std::string& marker) const {
    std::vector<MarkingSheet> all;
    Statement rows = state_.ask(
        fmt::format("{}AND ($2 = '' OR marker = $2) ORDER BY marker, code", kSheetFields).c_str(), assignment, marker);
    while (rows.next())
        all.push_back(sheetOf(rows));
    return all;
}

std::optional<MarkingSheet> Teaching::sheet(const std::string& assignment, const std::string& marker,
                                            const std::string& code) const {
    Statement row =
        state_.ask(fmt::format("{}AND marker = $2 AND code = $3", kSheetFields).c_str(), assignment, marker, code);
    if (!row.next()) return {};
    return sheetOf(row);
}

bool Teaching::save(const MarkingSheet& s, const std::optional<Mark>& mark, const Act& act) {
    Transaction transaction(*state_.database);
    state_.requireAttempt(s.attempt);
    if (!state_.any("SELECT 1 FROM desk_works WHERE assignment = $1 AND marker = $2 AND attempt = $3", s.assignment,
                    s.marker, s.attempt))
        throw unknown(*state_.database, "work on this desk", s.attempt);
    const bool isSaved = state_.any(
        "INSERT INTO sheets (assignment, marker, code, attempt, content, is_in, changed) VALUES ($1, $2, $3, $4, $5, "
        "$6, $7) ON CONFLICT (assignment, marker, code) DO UPDATE SET content = excluded.content, is_in = "
        "excluded.is_in, changed = excluded.changed WHERE sheets.is_in = 0 RETURNING code",
        s.assignment, s.marker, s.code, s.attempt, s.content, std::int64_t{s.isIn}, act.at);
    if (isSaved && s.isIn) {
        state_.note(act, "give in marks", s.attempt, s.assignment);
        if (mark) (void)state_.push(*mark, act);
    }
    transaction.commit();
    return isSaved;
}

std::vector<Mark> Teaching::marksOn(const std::string& assignment) const {
    std::vector<Mark> all;
    Statement rows = state_.ask(
        "SELECT m.id, m.attempt, m.marker, m.kind, m.verdict, m.points, m.max_points, m.marks, m.made FROM marks m "
        "JOIN attempts t ON t.id = m.attempt WHERE t.assignment = $1 ORDER BY m.attempt, m.made, m.id",
        assignment);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2), rows.text(3), rows.text(4), rows.number(5),
                       rows.number(6), rows.text(7), rows.integer(8)});
    return all;
}

double Teaching::differenceAllowed(const std::string& assignment) const {
    Statement row = state_.ask("SELECT differ_percent FROM marking_rules WHERE assignment = $1", assignment);
    return row.next() ? row.number(0) : kUsualDifference;
}

void Teaching::setDifferenceAllowed(const std::string& assignment, double percent, const Act& act) {
    if (!(percent >= 0.0 && percent <= 100.0))
        throw invalid("difference", fmt::format("{}", percent), "write 0 to 100 %");
    Transaction transaction(*state_.database);
    requireAssignment(assignment);
    state_.run(
        "INSERT INTO marking_rules (assignment, differ_percent, made) VALUES ($1, $2, $3) ON CONFLICT (assignment) DO "
        "UPDATE SET differ_percent = excluded.differ_percent, made = excluded.made",
        assignment, percent, act.at);
    state_.note(act, "set difference", assignment, fmt::format("{}", percent));
    transaction.commit();
}

void Teaching::release(std::span<const std::string> attempts, bool released, const Act& act) {
    Transaction transaction(*state_.database);
    for (const std::string& id : attempts) {
        state_.requireAttempt(id);
        const bool moved = released ? state_.any(
                                          "INSERT INTO releases (attempt, made) VALUES ($1, $2) ON CONFLICT DO NOTHING "
                                          "RETURNING attempt",
                                          id, act.at)
                                    : state_.any("DELETE FROM releases WHERE attempt = $1 RETURNING attempt", id);
        if (moved) state_.note(act, released ? "release marks" : "take back marks", id);
    }
    transaction.commit();
}

bool Teaching::isReleased(const std::string& attempt) const {
    return state_.any("SELECT 1 FROM releases WHERE attempt = $1", attempt);
}

std::set<std::string> Teaching::released(const std::string& assignment) const {
    std::set<std::string> all;
    Statement rows = state_.ask(
        "SELECT r.attempt FROM releases r JOIN attempts t ON t.id = r.attempt WHERE t.assignment = $1", assignment);
    while (rows.next())
        all.insert(rows.text(0));
    return all;
}

// Re-scoring.

void Teaching::pin(const std::string& assignment, const Act& act) {
    state_.run(
        "INSERT INTO counting (assignment, campaign, first_rubric, made) SELECT id, CAST($1 AS TEXT), rubric, "
        "CAST($2 AS INT8) FROM assignments WHERE id = $3 ON CONFLICT DO NOTHING",
        kArrival, act.at, assignment);
}

void Teaching::add(const Campaign& c, const Act& act) {
    if (c.id.empty() || c.id == kArrival) throw invalid("campaign", c.id, "give it a name of its own");
    Transaction transaction(*state_.database);
    requireAssignment(c.assignment);
    if (!state_.any("SELECT 1 FROM rubrics WHERE hash = $1", c.rubric))
        throw unknown(*state_.database, "rubric", c.rubric);
    if (!state_.any("INSERT INTO campaigns (id, assignment, rubric, who, made) VALUES ($1, $2, $3, $4, $5) ON CONFLICT "
                    "DO NOTHING RETURNING id",
                    c.id, c.assignment, c.rubric, c.who, act.at))
        throw duplicate(*state_.database, "campaign", c.id);
    pin(c.assignment, act);
    state_.note(act, "begin rescore", c.assignment, fmt::format("{} by {}", c.id, c.rubric));
    transaction.commit();
}

std::vector<Campaign> Teaching::campaigns(const std::string& assignment) const {
    std::vector<Campaign> all;
    Statement rows =
        state_.ask(fmt::format("{}WHERE assignment = $1 ORDER BY made, id", kCampaignFields).c_str(), assignment);
    while (rows.next())
        all.push_back(campaignOf(rows));
    return all;
}

std::optional<Campaign> Teaching::campaign(const std::string& id) const {
    Statement row = state_.ask(fmt::format("{}WHERE id = $1", kCampaignFields).c_str(), id);
    if (!row.next()) return {};
    return campaignOf(row);
}

std::string Teaching::counting(const std::string& assignment) const {
    Statement row = state_.ask("SELECT campaign FROM counting WHERE assignment = $1", assignment);
    return row.next() ? row.text(0) : std::string();
}

void Teaching::setCounting(const std::string& assignment, const std::string& campaign, const Act& act) {
    Transaction transaction(*state_.database);
    requireAssignment(assignment);
    pin(assignment, act);
    std::string rubric;
    {
        Statement row =
            campaign == kArrival
                ? state_.ask("SELECT first_rubric FROM counting WHERE assignment = $1", assignment)
                : state_.ask("SELECT rubric FROM campaigns WHERE assignment = $1 AND id = $2", assignment, campaign);
        if (!row.next()) throw unknown(*state_.database, "campaign", campaign);
        rubric = row.text(0);
    }
    state_.run("UPDATE counting SET campaign = $1, made = $2 WHERE assignment = $3", campaign, act.at, assignment);
    state_.run("UPDATE assignments SET rubric = $1 WHERE id = $2", rubric, assignment);
    state_.note(act, "set counting", assignment, fmt::format("{} by {}", campaign, rubric));
    transaction.commit();
}

std::vector<Score> Teaching::scores(const std::string& assignment, const std::string& campaign) const {
    std::vector<Score> all;
    Statement rows = state_.ask(
        fmt::format("SELECT s.attempt, s.campaign, s.rubric, s.engine, s.state, s.reason, s.state_hash, s.score, "
                    "s.max_score, s.whole_score, s.passed, s.borderline, s.result, s.worker, s.made FROM attempts t "
                    "JOIN scores s ON s.job = {} WHERE t.assignment = $1 {} ORDER BY t.id",
                    campaign.empty() ? kCountingJob
                                     : "(SELECT max(l.job) FROM scores l WHERE l.attempt = t.id AND l.campaign = $2)",
                    campaign.empty() ? "AND $2 = ''" : "")
            .c_str(),
        assignment, campaign);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2), rows.integer(3), rows.text(4), rows.text(5),
                       rows.text(6), rows.number(7), rows.number(8), rows.number(9), rows.text(10),
                       rows.integer(11) != 0, rows.text(12), rows.text(13), rows.integer(14)});
    return all;
}

std::vector<Outcome> Teaching::outcomesWhere(const char* condition, const std::string& value, bool withResults) const {
    std::vector<Outcome> all;
    Statement rows = state_.ask(
        fmt::format(
            "SELECT t.id, t.person, t.assignment, t.exercise, t.exercise_hash, t.rubric_hash, t.session_hashes, "
            "t.began, t.finished, t.received, t.device, t.motion_scale, t.score, t.max_score, t.whole_score, "
            "t.passed, t.borderline, t.worked_s, t.limit_s, coalesce(s.job, -1), coalesce(s.campaign, ''), "
            "coalesce(s.rubric, ''), coalesce(s.engine, 0), coalesce(s.state, ''), coalesce(s.reason, ''), "
            "coalesce(s.state_hash, ''), coalesce(s.score, 0), coalesce(s.max_score, 0), "
            "coalesce(s.whole_score, 0), coalesce(s.passed, ''), coalesce(s.borderline, 0), "
            "coalesce(s.made, 0), {} FROM attempts t LEFT JOIN scores s ON s.job = {} WHERE {} "
            "ORDER BY t.person, t.finished, t.id",
            withResults ? "coalesce(s.result, '')" : "''", kCountingJob, condition)
            .c_str(),
        value);
    while (rows.next()) {
        Outcome one;
        PushedAttempt& p = one.pushed;
        Attempt& a = p.attempt;
        a.id = rows.text(0), p.person = rows.text(1), p.assignment = rows.text(2);
        a.exercise = rows.text(3), a.exerciseHash = rows.text(4), a.rubricHash = rows.text(5);
        a.sessionHashes = partedLines(rows.text(6));
        a.began = rows.integer(7), a.finished = rows.integer(8), p.received = rows.integer(9);
        a.device = rows.text(10), a.motionScale = rows.number(11);
        a.score = rows.number(12), a.maxScore = rows.number(13), a.wholeScore = rows.number(14);
        a.passed = rows.text(15), a.borderline = rows.integer(16) != 0;
        a.workedS = rows.number(17), a.limitS = rows.number(18);
        if (rows.integer(19) >= 0)
            one.score = Score{a.id,
                              rows.text(20),
                              rows.text(21),
                              rows.integer(22),
                              rows.text(23),
                              rows.text(24),
                              rows.text(25),
                              rows.number(26),
                              rows.number(27),
                              rows.number(28),
                              rows.text(29),
                              rows.integer(30) != 0,
                              rows.text(32),
                              {},
                              rows.integer(31)};
        all.push_back(std::move(one));
    }
    return all;
}

std::vector<Outcome> Teaching::outcomes(const std::string& schoolClass, bool withResults) const {
    return outcomesWhere("t.assignment IN (SELECT id FROM assignments WHERE class = $1)", schoolClass, withResults);
}

std::vector<Outcome> Teaching::outcomesOf(const std::string& person, bool withResults) const {
    return outcomesWhere("t.person = $1", person, withResults);
}

// Standards.

void Teaching::setEstimates(const std::string& assignment, std::span<const AngoffEstimate> estimates, const Act& act) {
    Transaction transaction(*state_.database);
    requireAssignment(assignment);
    for (const AngoffEstimate& one : estimates) {
        if (!(one.percent >= 0.0 && one.percent <= 100.0))
            throw invalid("estimate", fmt::format("{}", one.percent), "write 0 to 100 %");
        if (one.round < 1 || one.round > 2) throw invalid("round", std::to_string(one.round), "write 1 or 2");
        state_.requirePerson(one.judge);
        state_.run(
            "INSERT INTO estimates (assignment, judge, round, criterion, percent, made) VALUES ($1, $2, $3, $4, $5, "
            "$6) ON CONFLICT (assignment, judge, round, criterion) DO UPDATE SET percent = excluded.percent, made = "
            "excluded.made",
            assignment, one.judge, one.round, one.criterion, one.percent, act.at);
    }
    state_.note(act, "set estimates", assignment, std::to_string(estimates.size()));
    transaction.commit();
}

std::vector<AngoffEstimate> Teaching::estimates(const std::string& assignment) const {
    std::vector<AngoffEstimate> all;
    Statement rows = state_.ask(
        "SELECT judge, round, criterion, percent FROM estimates WHERE assignment = $1 ORDER BY round, judge, criterion",
        assignment);
    while (rows.next())
        all.push_back({rows.text(0), rows.integer(1), rows.text(2), rows.number(3)});
    return all;
}

void Teaching::add(const KeptStandard& s, const Act& act) {
    if (s.method != "angoff" && s.method != "borderline")
        throw invalid("method", s.method, "write angoff or borderline");
    Transaction transaction(*state_.database);
    requireAssignment(s.assignment);
    if (!state_.any("INSERT INTO standards (id, assignment, method, content, who, made) VALUES ($1, $2, $3, $4, $5, "
                    "$6) ON CONFLICT DO NOTHING RETURNING id",
                    s.id, s.assignment, s.method, s.content, s.who, act.at))
        throw duplicate(*state_.database, "standard", s.id);
    state_.note(act, "keep standard", s.assignment, s.method);
    transaction.commit();
}

std::vector<KeptStandard> Teaching::standards(const std::string& assignment) const {
    std::vector<KeptStandard> all;
    Statement rows = state_.ask(
        "SELECT id, assignment, method, content, who, made FROM standards WHERE assignment = $1 ORDER BY made, id",
        assignment);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2), rows.text(3), rows.text(4), rows.integer(5)});
    return all;
}

// Exemplars.

void Teaching::set(const Exemplar& e, const Act& act) {
    Transaction transaction(*state_.database);
    if (!state_.any("SELECT 1 FROM attempts WHERE id = $1 AND assignment = $2", e.attempt, e.assignment))
        throw unknown(*state_.database, "attempt of this assignment", e.attempt);
    state_.run(
        "INSERT INTO exemplars (attempt, assignment, content, who, made) VALUES ($1, $2, $3, $4, $5) ON CONFLICT "
        "(attempt) DO UPDATE SET content = excluded.content, who = excluded.who, made = excluded.made",
        e.attempt, e.assignment, e.content, e.who, act.at);
    state_.note(act, "set exemplar", e.attempt);
    transaction.commit();
}

void Teaching::removeExemplar(const std::string& attempt, const Act& act) {
    Transaction transaction(*state_.database);
    state_.run("DELETE FROM calibrations WHERE attempt = $1", attempt);
    if (!state_.any("DELETE FROM exemplars WHERE attempt = $1 RETURNING attempt", attempt))
        throw unknown(*state_.database, "exemplar", attempt);
    state_.note(act, "remove exemplar", attempt);
    transaction.commit();
}

std::vector<Exemplar> Teaching::exemplars(const std::string& assignment) const {
    std::vector<Exemplar> all;
    Statement rows = state_.ask(
        "SELECT attempt, assignment, content, who, made FROM exemplars WHERE assignment = $1 ORDER BY attempt",
        assignment);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2), rows.text(3), rows.integer(4)});
    return all;
}

bool Teaching::add(const Calibration& c, const Act& act) {
    Transaction transaction(*state_.database);
    state_.requirePerson(c.marker);
    if (!state_.any("SELECT 1 FROM exemplars WHERE attempt = $1", c.attempt))
        throw unknown(*state_.database, "exemplar", c.attempt);
    const bool isNew = state_.any(
        "INSERT INTO calibrations (attempt, marker, content, made) VALUES ($1, $2, $3, $4) ON CONFLICT DO NOTHING "
        "RETURNING attempt",
        c.attempt, c.marker, c.content, act.at);
    if (isNew) state_.note(act, "mark exemplar", c.attempt);
    transaction.commit();
    return isNew;
}

std::vector<Calibration> Teaching::calibrations(const std::string& assignment) const {
    std::vector<Calibration> all;
    Statement rows = state_.ask(
        "SELECT c.attempt, c.marker, c.content, c.made FROM calibrations c JOIN exemplars e ON e.attempt = c.attempt "
        "WHERE e.assignment = $1 ORDER BY c.marker, c.attempt",
        assignment);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2), rows.integer(3)});
    return all;
}

}  // namespace handpiece::school
