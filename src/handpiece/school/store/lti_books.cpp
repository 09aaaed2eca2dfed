// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/store/lti_books.h"

#include <fmt/format.h>

#include "handpiece/school/store/books_state.h"
#include "handpiece/school/store/exam_books.h"
#include "handpiece/school/store/visible.h"

namespace handpiece::school {
namespace {

constexpr const char* kPlatformColumns =
    "SELECT id, issuer, client, auth_address, token_address, keys_address, deployments, lists FROM "
    "lti_platforms";

LtiPlatform platformOf(const Statement& row) {
    return {
        row.text(0),        row.text(1), row.text(2), row.text(3), row.text(4), row.text(5), partedLines(row.text(6)),
        row.integer(7) != 0};
}
constexpr const char* kGradeColumns =
    "SELECT g.number, g.assignment, g.person, g.platform, g.subject, g.address, g.body, g.tries, g.made, g.next, "
    "g.sent, g.problem FROM lti_grades g";
LtiGrade gradeOf(const Statement& row) {
    return {row.integer(0),  {row.text(1), row.text(2), row.text(3), row.text(4), row.text(5)},
            row.text(6),     row.integer(7),
            row.integer(8),  row.integer(9),
            row.integer(10), row.text(11)};
}

}  // namespace

std::string LtiBooks::set(const LtiPlatform& p, const Act& act) {
    for (const std::string* text : {&p.issuer, &p.client, &p.authAddress, &p.tokenAddress, &p.keysAddress})
        if (text->empty() || text->size() > 1000) throw invalid("platform", *text, "give all of it");
    if (p.deployments.empty()) throw invalid("list of deployments", "", "name one at least");
    Transaction transaction(*state_.database);
    std::string id;
    {
        Statement row = state_.ask(
            "INSERT INTO lti_platforms (id, issuer, client, auth_address, token_address, keys_address, deployments, "
            "made, lists) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9) ON CONFLICT (issuer, client) DO UPDATE SET "
            "auth_address = "
            "excluded.auth_address, token_address = excluded.token_address, keys_address = excluded.keys_address, "
            "deployments = excluded.deployments, lists = excluded.lists RETURNING id",
            newId(), p.issuer, p.client, p.authAddress, p.tokenAddress, p.keysAddress, joinedLines(p.deployments),
            act.at, std::int64_t{p.hasLists});
        while (row.next())
            id = row.text(0);
    }
    state_.note(act, "set platform", id, p.issuer);
    transaction.commit();
    return id;
}

std::vector<LtiPlatform> LtiBooks::platforms() const {
    std::vector<LtiPlatform> all;
    Statement rows = state_.ask(fmt::format("{} ORDER BY issuer, client", kPlatformColumns).c_str());
    while (rows.next())
        all.push_back(platformOf(rows));
    return all;
}

std::optional<LtiPlatform> LtiBooks::platform(const std::string& issuer, const std::string& client) const {
    // A platform that has one client here need not name it.
    std::optional<LtiPlatform> found;
    for (LtiPlatform& one : platforms()) {
        if (one.issuer != issuer || (!client.empty() && one.client != client)) continue;
        if (found) return {};
        found = std::move(one);
    }
    return found;
}

std::optional<LtiPlatform> LtiBooks::platform(const std::string& id) const {
    Statement row = state_.ask(fmt::format("{} WHERE id = $1", kPlatformColumns).c_str(), id);
    if (!row.next()) return {};
    return platformOf(row);
}

bool LtiBooks::isFirst(const std::string& state, const std::string& platform, Milliseconds expires, Milliseconds now) {
    Transaction transaction(*state_.database);
    state_.run("DELETE FROM lti_states WHERE expires <= $1", now);
    const bool isNew = state_.any(
        "INSERT INTO lti_states (hash, platform, nonce_hash, expires) VALUES ($1, $2, '', $3) ON CONFLICT DO NOTHING "
        "RETURNING hash",
        sha256(state), platform, expires);
    transaction.commit();
    return isNew;
}

std::optional<Person> LtiBooks::personOn(const LtiPlatform& p, const std::string& subject) const {
    std::string code;
    {
        Statement row = state_.ask("SELECT person FROM lti_people WHERE platform = $1 AND subject = $2", p.id, subject);
        if (row.next()) code = row.text(0);
    }
    if (!code.empty()) return books_.person(code);
    return p.hasLists ? personByExternal(subject) : std::nullopt;
}

void LtiBooks::setPerson(const LtiPlatform& p, const std::string& subject, const std::string& person, const Act& act) {
    if (subject.empty() || subject.size() > 255) throw invalid("id on a platform", subject, "give 1 to 255 characters");
    Transaction transaction(*state_.database);
    state_.requirePerson(person);
    if (state_.any("INSERT INTO lti_people (platform, subject, person) VALUES ($1, $2, $3) ON CONFLICT DO NOTHING "
                   "RETURNING person",
                   p.id, subject, person))
        state_.note(act, "set id on a platform", person, p.issuer);
    else if (!state_.any("SELECT 1 FROM lti_people WHERE platform = $1 AND subject = $2 AND person = $3", p.id, subject,
                         person))
        throw duplicate(*state_.database, "id on this platform", subject);
    transaction.commit();
}

std::optional<Person> LtiBooks::personByExternal(const std::string& external) const {
    std::string code;
    {
        Statement row = state_.ask("SELECT person FROM identities WHERE external = $1 AND external <> ''", external);
        if (!row.next()) return {};
        code = row.text(0);
    }
    return books_.person(code);
}

void LtiBooks::setExternal(const std::string& person, const std::string& external, const Act& act) {
    if (external.size() > 255) throw invalid("external id", external, "255 characters are the most");
    Transaction transaction(*state_.database);
    if (state_.any("SELECT 1 FROM identities WHERE external = $1 AND external <> '' AND person <> $2", external,
                   person))
        throw duplicate(*state_.database, "external id", external);
    if (!state_.any("UPDATE identities SET external = $1 WHERE person = $2 RETURNING person", external, person))
        throw unknown(*state_.database, "person", person);
    state_.note(act, "set external id", person);
    transaction.commit();
}

void LtiBooks::set(const LtiLine& l) {
    Transaction transaction(*state_.database);
    state_.run(
        "INSERT INTO lti_lines (assignment, person, platform, subject, address) VALUES ($1, $2, $3, $4, $5) "
        "ON CONFLICT (assignment, person) DO UPDATE SET platform = excluded.platform, subject = excluded.subject, "
        "address = excluded.address",
        l.assignment, l.person, l.platform, l.subject, l.address);
    transaction.commit();
}

std::vector<LtiLine> LtiBooks::lines() const {
    std::vector<LtiLine> all;
    Statement rows =
        state_.ask("SELECT assignment, person, platform, subject, address FROM lti_lines ORDER BY assignment, person");
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2), rows.text(3), rows.text(4)});
    return all;
}

Worth LtiBooks::worthOf(const std::string& assignment, const std::string& person) const {
    Worth worth;
    const auto its = books_.assignment(assignment);
    if (!its) return worth;
    worth.kind = its->kind;
    for (const PushedAttempt& attempt : books_.attemptsOf(person, assignment)) {
        worth.came = attempt.received;
        worth.points.reset(), worth.maxPoints.reset(), worth.verdict.clear();
        const std::string& id = attempt.attempt.id;
        // A platform hears what its student may see.
        const Visible seen = visibleToItsStudent(standingOf(books_, id));
        if (its->kind == "exam") {
            const std::vector<ExamDecision> decisions = ExamBooks(books_).decisionsOf(id);
            worth.verdict = verdictOf(decisions);
            if (!decisions.empty()) worth.decided = decisions.back().made;
            const std::vector<Score> scores = books_.scoresOf(id);
            if (seen.worth && (worth.verdict == "pass" || worth.verdict == "fail") && !scores.empty() &&
                scores.back().maxScore > 0.0)
                worth.points = scores.back().score, worth.maxPoints = scores.back().maxScore;
        } else {
            // What a teacher has said of it and given back, not what a machine has.
            if (!seen.marks) continue;
            for (const Mark& mark : books_.marksOf(id))
                if ((mark.kind == "teacher" || mark.kind == "adjudication") && mark.maxPoints > 0.0)
                    worth.points = mark.points, worth.maxPoints = mark.maxPoints, worth.decided = mark.made;
        }
    }
    return worth;
}

bool LtiBooks::queue(const LtiLine& l, const std::string& body, Milliseconds now) {
    bool isNew = false;
    Transaction transaction(*state_.database);
    {
        Statement row =
            state_.ask("SELECT body FROM lti_grades WHERE assignment = $1 AND person = $2 ORDER BY number DESC LIMIT 1",
                       l.assignment, l.person);
        isNew = !row.next() || row.text(0) != body;
    }
    if (isNew) {
        state_.run("DELETE FROM lti_grades WHERE assignment = $1 AND person = $2 AND sent = 0", l.assignment, l.person);
        state_.run(
            "INSERT INTO lti_grades (number, assignment, person, platform, subject, address, body, tries, made, next, "
            "sent, problem) SELECT coalesce(max(number), 0) + 1, $1, $2, $3, $4, $5, $6, 0, CAST($7 AS INT8), CAST($7 "
            "AS INT8), 0, '' FROM lti_grades",
            l.assignment, l.person, l.platform, l.subject, l.address, body, now);
    }
    transaction.commit();
    return isNew;
}

std::optional<LtiGrade> LtiBooks::nextGrade(Milliseconds now) const {
    Statement row = state_.ask(
        fmt::format("{} WHERE g.sent = 0 AND g.next <= $1 ORDER BY g.next, g.number LIMIT 1", kGradeColumns).c_str(),
        now);
    if (!row.next()) return {};
    return gradeOf(row);
}

void LtiBooks::sent(std::int64_t number, Milliseconds now) {
    Transaction transaction(*state_.database);
    state_.run("UPDATE lti_grades SET sent = $1, problem = '' WHERE number = $2", now, number);
    Statement row = state_.ask("SELECT person, assignment FROM lti_grades WHERE number = $1", number);
    if (row.next()) state_.note({"server", now}, "grade sent", row.text(0), row.text(1));
    transaction.commit();
}

void LtiBooks::failed(std::int64_t number, const std::string& problem, Milliseconds next) {
    Transaction transaction(*state_.database);
    state_.run("UPDATE lti_grades SET tries = tries + 1, problem = $1, next = $2 WHERE number = $3", problem, next,
               number);
    transaction.commit();
}

std::vector<LtiGrade> LtiBooks::grades() const {
    std::vector<LtiGrade> all;
    Statement rows = state_.ask(fmt::format("{} ORDER BY g.number", kGradeColumns).c_str());
    while (rows.next())
        all.push_back(gradeOf(rows));
    return all;
}

}  // namespace handpiece::school
