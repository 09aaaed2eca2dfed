// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/store/retention.h"

#include "handpiece/school/store/books_state.h"

namespace handpiece::school {
namespace {

constexpr std::int64_t kMostDays = 36'500;
constexpr const char* kPersonal = "personal";

void requireDays(std::int64_t days) {
    if (days < 0 || days > kMostDays) throw invalid("retention in days", std::to_string(days), "write 0 to 36500");
}
std::string scopeOf(const std::string& schoolClass) {
    return "class " + schoolClass;
}

}  // namespace

void Retention::setForClass(const std::string& schoolClass, const RetentionRules& rules, const Act& act) {
    requireDays(rules.practiceDays), requireDays(rules.closedDays);
    Transaction transaction(*state_.database);
    state_.requireClass(schoolClass);
    state_.run("UPDATE classes SET retention_days = $1 WHERE id = $2", rules.closedDays, schoolClass);
    state_.run(
        "INSERT INTO retention (scope, days) VALUES ($1, $2) ON CONFLICT (scope) DO UPDATE SET days = "
        "excluded.days",
        scopeOf(schoolClass), rules.practiceDays);
    state_.note(act, "set retention", schoolClass,
                "practice " + std::to_string(rules.practiceDays) + " days, after it was closed " +
                    std::to_string(rules.closedDays) + " days");
    transaction.commit();
}

RetentionRules Retention::ofClass(const std::string& schoolClass) const {
    RetentionRules rules;
    {
        Statement row = state_.ask("SELECT retention_days FROM classes WHERE id = $1", schoolClass);
        if (!row.next()) throw unknown(*state_.database, "class", schoolClass);
        rules.closedDays = row.integer(0);
    }
    Statement row = state_.ask("SELECT days FROM retention WHERE scope = $1", scopeOf(schoolClass));
    if (row.next()) rules.practiceDays = row.integer(0);
    return rules;
}

void Retention::setForPersonal(std::int64_t days, const Act& act) {
    requireDays(days);
    Transaction transaction(*state_.database);
    state_.run(
        "INSERT INTO retention (scope, days) VALUES ($1, $2) ON CONFLICT (scope) DO UPDATE SET days = "
        "excluded.days",
        kPersonal, days);
    state_.note(act, "set retention", "", "practice of nobody's class " + std::to_string(days) + " days");
    transaction.commit();
}

std::int64_t Retention::ofPersonal() const {
    Statement row = state_.ask("SELECT days FROM retention WHERE scope = $1", kPersonal);
    return row.next() ? row.integer(0) : 0;
}

std::vector<Expiring> Retention::expiring(Milliseconds now) const {
    std::vector<Expiring> all;
    // By when it came: a station's clock may be wrong by years.
    Statement rows = state_.ask(
        "SELECT t.id, t.person, t.assignment, t.finished, CASE WHEN c.closed > 0 AND c.retention_days > 0 AND c.closed "
        "+ "
        "c.retention_days * 86400000 <= CAST($1 AS INT8) THEN 'class closed' WHEN t.assignment = '' THEN 'practice of "
        "nobody''s class' ELSE 'practice of a class' END, coalesce((SELECT sum(f.bytes) FROM files f WHERE f.hash IN "
        "(SELECT x.file FROM attempt_files x WHERE x.attempt = t.id) AND NOT EXISTS (SELECT 1 FROM attempt_files y "
        "WHERE y.file = f.hash AND y.attempt <> t.id) AND NOT EXISTS (SELECT 1 FROM packs p WHERE p.file = f.hash)), "
        "0) "
        "FROM attempts t LEFT JOIN assignments a ON a.id = t.assignment LEFT JOIN classes c ON c.id = a.class "
        "LEFT JOIN retention r ON r.scope = CASE WHEN t.assignment = '' THEN 'personal' ELSE 'class ' || a.class END "
        "WHERE (c.closed > 0 AND c.retention_days > 0 AND c.closed + c.retention_days * 86400000 <= CAST($1 AS INT8)) "
        "OR (r.days > 0 AND (t.assignment = '' OR a.kind = 'practice') AND t.received + r.days * 86400000 <= "
        "CAST($1 AS INT8) AND NOT EXISTS (SELECT 1 FROM exemplars e WHERE e.attempt = t.id)) ORDER BY t.id",
        now);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2), rows.text(4), rows.integer(3),
                       static_cast<std::uint64_t>(rows.integer(5))});
    return all;
}

std::int64_t Retention::expire(const Act& act) {
    std::vector<std::string> attempts, orphans;
    {
        Transaction transaction(*state_.database);
        for (const Expiring& one : expiring(act.at))
            attempts.push_back(one.attempt);
        orphans = state_.removeAttempts(attempts, act);
        transaction.commit();
    }
    for (const std::string& file : orphans)
        state_.removeFile(file);
    return static_cast<std::int64_t>(attempts.size());
}

}  // namespace handpiece::school
