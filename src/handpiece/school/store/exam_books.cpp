// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/store/exam_books.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "handpiece/school/store/books_state.h"

namespace handpiece::school {
namespace {

constexpr Milliseconds kLateWorkMs = 90 * std::int64_t{86'400'000};

void requireCount(const char* field, std::int64_t value, std::int64_t most) {
    if (value < 0 || value > most) throw invalid(field, std::to_string(value), fmt::format("write 0 to {}", most));
}

constexpr const char* kSittingColumns =
    "SELECT id, exam, station, person, candidate, pack, invigilator, began, number, state, ended, confirmation FROM "
    "exam_sittings";
ExamSitting sittingOf(const Statement& row) {
    return {row.text(0), row.text(1),    row.text(2),    row.text(3), row.text(4),     row.text(5),
            row.text(6), row.integer(7), row.integer(8), row.text(9), row.integer(10), row.integer(11)};
}
constexpr const char* kEntryColumns =
    "SELECT station, number, hash, kind, sitting, text, key, signature, at, received FROM exam_entries";
ExamEntry entryOf(const Statement& row) {
    return {row.text(0), row.integer(1), row.text(2), row.text(3),    row.text(4),
            row.text(5), row.text(6),    row.text(7), row.integer(8), row.integer(9)};
}
constexpr const char* kPackColumns = "SELECT exam, version, hash, text, key, signature, made FROM exam_packs";
ExamPack packOf(const Statement& row) {
    return {row.text(0), row.integer(1), row.text(2), row.text(3), row.text(4), row.text(5), row.integer(6)};
}

void requireExam(Statement row, const Database& database, const std::string& exam) {
    if (!row.next()) throw unknown(database, "exam", exam);
}

}  // namespace

void ExamBooks::addKey(const std::string& station, const std::string& key, Milliseconds now) {
    if (!isHex(key, 64)) throw invalid("key of a station", key, "send 64 hexadecimal digits");
    Transaction transaction(*state_.database);
    if (!state_.any("SELECT 1 FROM stations WHERE id = $1 AND kind = 'exam'", station))
        throw unknown(*state_.database, "station for exams", station);
    if (state_.any("INSERT INTO exam_stations (station, key, made) VALUES ($1, $2, $3) ON CONFLICT DO NOTHING "
                   "RETURNING station",
                   station, key, now))
        state_.note({"station " + station, now}, "station's exam key", station);
    else if (!state_.any("SELECT 1 FROM exam_stations WHERE station = $1 AND key = $2", station, key))
        throw changed(*state_.database, "key of the station", station);
    transaction.commit();
}

std::string ExamBooks::keyOf(const std::string& station) const {
    Statement row = state_.ask("SELECT key FROM exam_stations WHERE station = $1", station);
    if (!row.next()) throw unknown(*state_.database, "station for exams", station);
    return row.text(0);
}

void ExamBooks::set(const ExamSettings& s, const Act& act) {
    requireCount("number of minutes", s.minutes, 1440);
    if (s.minutes == 0) throw invalid("number of minutes", "0", "write 1 to 1440");
    Transaction transaction(*state_.database);
    requireExam(state_.ask("SELECT 1 FROM assignments WHERE id = $1 AND kind = 'exam'", s.exam), *state_.database,
                s.exam);
    state_.run(
        "INSERT INTO exam_settings (exam, minutes, locked) VALUES ($1, $2, $3) ON CONFLICT (exam) DO UPDATE SET "
        "minutes = excluded.minutes, locked = excluded.locked",
        s.exam, s.minutes, s.locked);
    state_.note(act, "set exam", s.exam, fmt::format("{} minutes, locked: {}", s.minutes, s.locked));
    transaction.commit();
}

std::optional<ExamSettings> ExamBooks::settings(const std::string& exam) const {
    Statement row = state_.ask("SELECT exam, minutes, locked FROM exam_settings WHERE exam = $1", exam);
    if (!row.next()) return {};
    return ExamSettings{row.text(0), row.integer(1), row.text(2)};
}

void ExamBooks::set(const ExamCandidate& c, const Act& act) {
    if (!isHex(c.code, 64)) throw invalid("code of a candidate", "", "give its hash");
    requireCount("percentage of more time", c.extraPercent, 300),
        requireCount("number of minutes", c.pauseMinutes, 600);
    Transaction transaction(*state_.database);
    requireExam(state_.ask("SELECT 1 FROM exam_settings WHERE exam = $1", c.exam), *state_.database, c.exam);
    if (!state_.any("SELECT 1 FROM people WHERE code = $1 AND erased = 0", c.person))
        throw unknown(*state_.database, "person", c.person);
    if (state_.any("SELECT 1 FROM exam_invigilators WHERE exam = $1 AND person = $2", c.exam, c.person))
        throw invalid("candidate", c.person, "nobody confirms themselves: this one is an invigilator of this exam");
    if (state_.any("SELECT 1 FROM exam_codes WHERE exam = $1 AND code = $2 AND person <> $3", c.exam, c.code, c.person))
        throw duplicate(*state_.database, "candidate's code in exam", c.exam);
    state_.run("INSERT INTO exam_codes (exam, code, person) VALUES ($1, $2, $3) ON CONFLICT DO NOTHING", c.exam, c.code,
               c.person);
    state_.run(
        "INSERT INTO exam_candidates (exam, person, code, extra_percent, pause_minutes, helps) VALUES ($1, $2, $3, $4, "
        "$5, $6) ON CONFLICT (exam, person) DO UPDATE SET code = excluded.code, extra_percent = "
        "excluded.extra_percent, pause_minutes = excluded.pause_minutes, helps = excluded.helps",
        c.exam, c.person, c.code, c.extraPercent, c.pauseMinutes, c.helps);
    state_.note(act, "set candidate", c.person,
                fmt::format("{}: {} % and {} min more, helps: {}", c.exam, c.extraPercent, c.pauseMinutes, c.helps));
    transaction.commit();
}

void ExamBooks::set(const ExamInvigilator& i, const Act& act) {
    if (i.pin.empty()) throw invalid("confirmation code", "", "give its hash");
    Transaction transaction(*state_.database);
    requireExam(state_.ask("SELECT 1 FROM exam_settings WHERE exam = $1", i.exam), *state_.database, i.exam);
    state_.requirePerson(i.person);
    if (state_.any("SELECT 1 FROM exam_candidates WHERE exam = $1 AND person = $2", i.exam, i.person))
        throw invalid("invigilator", i.person, "nobody confirms themselves: this one is a candidate of this exam");
    state_.run(
        "INSERT INTO exam_invigilators (exam, person, pin) VALUES ($1, $2, $3) ON CONFLICT (exam, person) DO UPDATE "
        "SET pin = excluded.pin",
        i.exam, i.person, i.pin);
    state_.note(act, "set invigilator", i.person, i.exam);
    transaction.commit();
}

void ExamBooks::add(const ExamConfirmation& c, const Act& act) {
    if (c.hash.empty()) throw invalid("confirmation code", "", "give its hash");
    Transaction transaction(*state_.database);
    requireExam(state_.ask("SELECT 1 FROM exam_candidates WHERE exam = $1 AND person = $2", c.exam, c.person),
                *state_.database, c.exam);
    state_.run(
        "INSERT INTO exam_confirmations (exam, person, number, hash) SELECT $1, $2, coalesce(max(number), 0) + 1, $3 "
        "FROM exam_confirmations WHERE exam = $1 AND person = $2",
        c.exam, c.person, c.hash);
    state_.note(act, "set confirmation", c.person, c.exam);
    transaction.commit();
}

std::vector<ExamConfirmation> ExamBooks::confirmations(const std::string& exam) const {
    std::vector<ExamConfirmation> all;
    Statement rows = state_.ask(
        "SELECT exam, person, number, hash FROM exam_confirmations WHERE exam = $1 ORDER BY person, number", exam);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.integer(2), rows.text(3)});
    return all;
}

std::string ExamBooks::openingCode(const std::string& exam, const std::string& fresh, const Act& act) {
    if (const auto there = openingCode(exam)) return *there;
    Transaction transaction(*state_.database);
    requireExam(state_.ask("SELECT 1 FROM exam_settings WHERE exam = $1", exam), *state_.database, exam);
    state_.run("INSERT INTO exam_openings (exam, code, made) VALUES ($1, $2, $3) ON CONFLICT DO NOTHING", exam, fresh,
               act.at);
    state_.note(act, "seal exam", exam);
    transaction.commit();
    return openingCode(exam).value();
}

std::optional<std::string> ExamBooks::openingCode(const std::string& exam) const {
    Statement row = state_.ask("SELECT code FROM exam_openings WHERE exam = $1", exam);
    if (!row.next()) return {};
    return row.text(0);
}

std::vector<ExamCandidate> ExamBooks::candidates(const std::string& exam) const {
    std::vector<ExamCandidate> all;
    Statement rows = state_.ask(
        "SELECT exam, person, code, extra_percent, pause_minutes, helps FROM exam_candidates WHERE exam = $1 ORDER BY "
        "person",
        exam);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2), rows.integer(3), rows.integer(4), rows.text(5)});
    return all;
}

std::vector<ExamInvigilator> ExamBooks::invigilators(const std::string& exam) const {
    std::vector<ExamInvigilator> all;
    Statement rows =
        state_.ask("SELECT exam, person, pin FROM exam_invigilators WHERE exam = $1 ORDER BY person", exam);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2)});
    return all;
}

std::optional<std::string> ExamBooks::personOfCode(const std::string& exam, const std::string& code) const {
    Statement row = state_.ask("SELECT person FROM exam_codes WHERE exam = $1 AND code = $2", exam, code);
    if (!row.next()) return {};
    return row.text(0);
}

bool ExamBooks::add(const ExamPack& p, const Act& act) {
    Transaction transaction(*state_.database);
    requireExam(state_.ask("SELECT 1 FROM exam_settings WHERE exam = $1", p.exam), *state_.database, p.exam);
    const bool isNew = state_.any(
        "INSERT INTO exam_packs (exam, version, hash, text, key, signature, made) VALUES ($1, $2, $3, $4, $5, $6, $7) "
        "ON CONFLICT DO NOTHING RETURNING exam",
        p.exam, p.version, p.hash, p.text, p.key, p.signature, act.at);
    if (isNew)
        state_.note(act, "sign exam", p.exam, fmt::format("version {}, {}", p.version, p.hash));
    else if (!state_.any("SELECT 1 FROM exam_packs WHERE exam = $1 AND version = $2 AND text = $3", p.exam, p.version,
                         p.text))
        throw changed(*state_.database, "exam's pack", fmt::format("{} version {}", p.exam, p.version));
    transaction.commit();
    return isNew;
}

std::optional<ExamPack> ExamBooks::newestPack(const std::string& exam) const {
    Statement row =
        state_.ask(fmt::format("{} WHERE exam = $1 ORDER BY version DESC LIMIT 1", kPackColumns).c_str(), exam);
    if (!row.next()) return {};
    return packOf(row);
}

std::optional<ExamPack> ExamBooks::packByHash(const std::string& hash) const {
    Statement row = state_.ask(fmt::format("{} WHERE hash = $1", kPackColumns).c_str(), hash);
    if (!row.next()) return {};
    return packOf(row);
}

std::vector<std::string> ExamBooks::examsOpenAt(Milliseconds now) const {
    std::vector<std::string> all;
    Statement rows = state_.ask(
        "SELECT a.id FROM assignments a WHERE a.kind = 'exam' AND a.closes > $1 AND EXISTS (SELECT 1 FROM exam_packs p "
        "WHERE p.exam = a.id) ORDER BY a.opens, a.id",
        now);
    while (rows.next())
        all.push_back(rows.text(0));
    return all;
}

ExamBooks::End ExamBooks::endOf(const std::string& station) const {
    Statement row =
        state_.ask("SELECT number, hash FROM exam_entries WHERE station = $1 ORDER BY number DESC LIMIT 1", station);
    if (!row.next()) return {};
    return {row.integer(0), row.text(1)};
}

bool ExamBooks::add(const ExamEntry& e, const ExamSitting* begins, const PushedAttempt* attempt) {
    bool isThere = false;
    std::vector<std::string> orphans;
    {
        Transaction transaction(*state_.database);
        {
            Statement row =
                state_.ask("SELECT hash FROM exam_entries WHERE station = $1 AND number = $2", e.station, e.number);
            isThere = row.next();
            if (isThere && row.text(0) != e.hash)
                throw changed(*state_.database, "exam's entry", fmt::format("{} of station {}", e.number, e.station));
        }
        // A sitting's id is chance: work of that id that is there before the sitting is was named so to be in its way.
        if (!isThere && begins && state_.any("SELECT 1 FROM attempts WHERE id = $1", begins->id)) {
            const Act act{"station " + e.station, e.received};
            state_.note(act, "work with an exam's id", begins->id);
            orphans = state_.removeAttempts({begins->id}, act);
        }
        if (!isThere) follow(e, begins);
        transaction.commit();
    }
    for (const std::string& file : orphans)
        state_.removeFile(file);
    // Also of one that is there: a server may have been killed before it wrote this down.
    if (attempt) (void)books_.push(*attempt);
    return !isThere;
}

/// In a transaction that writes.
void ExamBooks::follow(const ExamEntry& e, const ExamSitting* begins) {
    if (endOf(e.station).number + 1 != e.number)
        throw unknown(*state_.database, "exam's entry before", std::to_string(e.number));
    if (begins) {
        if (!state_.any("INSERT INTO exam_sittings (id, exam, station, person, candidate, pack, invigilator, began, "
                        "number, state, ended, confirmation) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, 'begun', 0, "
                        "$10) ON CONFLICT DO NOTHING RETURNING id",
                        begins->id, begins->exam, e.station, begins->person, begins->candidate, begins->pack,
                        begins->invigilator, begins->began, e.number, begins->confirmation))
            throw changed(*state_.database, "sitting", begins->id);
    } else if (!e.sitting.empty() &&
               !state_.any("SELECT 1 FROM exam_sittings WHERE id = $1 AND station = $2 AND state = 'begun'", e.sitting,
                           e.station)) {
        throw unknown(*state_.database, "sitting that is going on", e.sitting);
    }
    const bool isEnd = e.kind == "finished" || e.kind == "given-up";
    if (isEnd) state_.run("UPDATE exam_sittings SET state = $1, ended = $2 WHERE id = $3", e.kind, e.at, e.sitting);
    state_.run(
        "INSERT INTO exam_entries (station, number, hash, kind, sitting, text, key, signature, at, received) "
        "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10)",
        e.station, e.number, e.hash, e.kind, e.sitting, e.text, e.key, e.signature, e.at, e.received);
    if (begins || isEnd) state_.note({"station " + e.station, e.received}, "exam " + e.kind, e.sitting);
}

std::vector<ExamEntry> ExamBooks::entriesOf(const std::string& id) const {
    std::vector<ExamEntry> all;
    const auto of = sitting(id);
    if (!of) return all;
    Statement rows = state_.ask(
        fmt::format("{} WHERE station = $1 AND number >= $2 AND (sitting = $3 OR kind = 'started') ORDER BY number",
                    kEntryColumns)
            .c_str(),
        of->station, of->number, id);
    while (rows.next()) {
        all.push_back(entryOf(rows));
        if (all.back().kind == "finished" || all.back().kind == "given-up") break;
    }
    return all;
}

std::optional<ExamSitting> ExamBooks::sitting(const std::string& id) const {
    Statement row = state_.ask(fmt::format("{} WHERE id = $1", kSittingColumns).c_str(), id);
    if (!row.next()) return {};
    return sittingOf(row);
}

std::vector<ExamSitting> ExamBooks::sittingsOf(const std::string& exam) const {
    std::vector<ExamSitting> all;
    Statement rows = state_.ask(fmt::format("{} WHERE exam = $1 ORDER BY began, id", kSittingColumns).c_str(), exam);
    while (rows.next())
        all.push_back(sittingOf(rows));
    return all;
}

void ExamBooks::setDoubts(const std::string& sitting, const std::vector<std::string>& doubts, Milliseconds now) {
    Transaction transaction(*state_.database);
    state_.run(
        "INSERT INTO exam_doubts (sitting, doubts, made) VALUES ($1, $2, $3) ON CONFLICT (sitting) DO UPDATE SET "
        "doubts = excluded.doubts, made = excluded.made",
        sitting, joinedLines(doubts), now);
    transaction.commit();
}

std::vector<std::string> ExamBooks::doubtsOf(const std::string& sitting) const {
    Statement row = state_.ask("SELECT doubts FROM exam_doubts WHERE sitting = $1", sitting);
    if (!row.next()) return {};
    return partedLines(row.text(0));
}

void ExamBooks::add(const ExamDecision& d, const Act& act) {
    constexpr std::array kKinds = {"confirm", "appeal", "remark", "decide"};
    constexpr std::array kVerdicts = {"pass", "fail", "void"};
    const auto isIn = [](const auto& all, const std::string& one) {
        return std::find(all.begin(), all.end(), one) != all.end();
    };
    if (!isHex(d.id, 32)) throw invalid("id of a decision", d.id, "send 32 hexadecimal digits");
    if (!isIn(kKinds, d.kind)) throw invalid("kind of decision", d.kind, "confirm, appeal, remark or decide");
    if (d.kind == "appeal" ? !d.verdict.empty() : !isIn(kVerdicts, d.verdict))
        throw invalid("verdict", d.verdict, "say pass, fail or void");
    if (d.words.size() > 4000) throw invalid("reason", d.words.substr(0, 40), "say it in 4,000 characters");
    if (d.words.empty() && d.kind != "confirm") throw invalid("reason", "", "say why");
    Transaction transaction(*state_.database);
    if (!state_.any("SELECT 1 FROM exam_sittings WHERE id = $1", d.sitting))
        throw unknown(*state_.database, "sitting", d.sitting);
    state_.requirePerson(d.person);
    const std::vector<ExamDecision> before = decisionsOf(d.sitting);
    const bool isOpen = hasOpenAppeal(before);
    const auto wrongNow = [&](const char* why, const char* remedy) {
        return core::Error(why, d.sitting, remedy).as("books-invalid", {"decision"});
    };
    if (d.kind == "confirm" && isOpen) throw wrongNow("an appeal is open", "decide it");
    if (d.kind == "appeal" && (before.empty() || isOpen))
        throw wrongNow(before.empty() ? "nothing was decided yet" : "an appeal is open already",
                       "wait for the decision");
    if ((d.kind == "remark" || d.kind == "decide") && !isOpen)
        throw wrongNow("no appeal is open", "there is nothing to decide");
    if (d.kind == "decide" && (before.back().kind != "remark"))
        throw wrongNow("nobody has marked it again yet", "an examiner does, without knowing what was said");
    // Who marks it again has not judged it before, nor sees what was said.
    if (d.kind == "remark" && std::any_of(before.begin(), before.end(), [&](const ExamDecision& one) {
            return one.person == d.person && one.kind != "appeal";
        }))
        throw wrongNow("who judged it before does not mark it again", "another examiner does");
    state_.run(
        "INSERT INTO exam_decisions (id, sitting, person, kind, verdict, points, max_points, words, made, place) "
        "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10)",
        d.id, d.sitting, d.person, d.kind, d.verdict, d.points, d.maxPoints, d.words, d.made, before.size());
    state_.note(act, "exam " + d.kind, d.sitting, d.verdict);
    transaction.commit();
}

std::vector<ExamDecision> ExamBooks::decisionsOf(const std::string& sitting) const {
    std::vector<ExamDecision> all;
    Statement rows = state_.ask(
        "SELECT id, sitting, person, kind, verdict, points, max_points, words, made FROM exam_decisions WHERE sitting "
        "= $1 ORDER BY place",
        sitting);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2), rows.text(3), rows.text(4), rows.number(5),
                       rows.number(6), rows.text(7), rows.integer(8)});
    return all;
}

bool hasOpenAppeal(const std::vector<ExamDecision>& decisions) {
    bool isOpen = false;
    for (const ExamDecision& d : decisions)
        isOpen = d.kind == "appeal" || (isOpen && d.kind != "decide");
    return isOpen;
}

std::string verdictOf(const std::vector<ExamDecision>& decisions) {
    std::string verdict = kUnconfirmed;
    for (const ExamDecision& d : decisions)
        if (d.kind == "confirm" || d.kind == "decide") verdict = d.verdict;
    return hasOpenAppeal(decisions) ? kUnconfirmed : verdict;
}

}  // namespace handpiece::school
