// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/store/books_accounts.h"

#include <fmt/format.h>

#include <limits>

#include "handpiece/school/store/books_state.h"

namespace handpiece::school {

void BooksAccounts::suspend(const std::string& person, const Act& act) {
    Transaction transaction(*state_.database);
    state_.requirePerson(person);
    if (state_.any("INSERT INTO suspensions (person, made) VALUES ($1, $2) ON CONFLICT DO NOTHING RETURNING person",
                   person, act.at)) {
        state_.run("DELETE FROM logins WHERE person = $1", person);
        state_.note(act, "suspend", person);
    }
    transaction.commit();
}

void BooksAccounts::resume(const std::string& person, const Act& act) {
    Transaction transaction(*state_.database);
    state_.requirePerson(person);
    if (state_.any("DELETE FROM suspensions WHERE person = $1 RETURNING person", person))
        state_.note(act, "resume", person);
    transaction.commit();
}

bool BooksAccounts::isSuspended(const std::string& person) const {
    return state_.any("SELECT 1 FROM suspensions WHERE person = $1", person);
}

std::set<std::string> BooksAccounts::suspended() const {
    std::set<std::string> all;
    Statement rows = state_.ask("SELECT person FROM suspensions");
    while (rows.next())
        all.insert(rows.text(0));
    return all;
}

void BooksAccounts::offerPasswordCode(const std::string& person, const std::string& code, Milliseconds expires,
                                      const Act& act) {
    if (code.size() < 8) throw invalid("code for a password", "", "use 8 characters or more, by chance");
    Transaction transaction(*state_.database);
    if (!state_.any("SELECT 1 FROM identities WHERE person = $1", person))
        throw unknown(*state_.database, "person", person);
    state_.run(
        "INSERT INTO password_codes (person, hash, expires) VALUES ($1, $2, $3) "
        "ON CONFLICT (person) DO UPDATE SET hash = excluded.hash, expires = excluded.expires",
        person, sha256(code), expires);
    state_.note(act, "offer password code", person);
    transaction.commit();
}

bool BooksAccounts::setPasswordByCode(const std::string& login, const std::string& code,
                                      const std::string& passwordHash, Milliseconds now) {
    Transaction transaction(*state_.database);
    std::string person;
    {
        Statement row = state_.ask(
            "SELECT i.person FROM identities i JOIN password_codes c ON c.person = i.person WHERE i.login = $1 AND "
            "i.login <> '' AND c.hash = $2 AND c.expires > $3",
            login, sha256(code), now);
        if (!row.next()) return false;
        person = row.text(0);
    }
    state_.run("DELETE FROM password_codes WHERE person = $1", person);
    state_.run("UPDATE identities SET password = $1 WHERE person = $2", passwordHash, person);
    state_.run("DELETE FROM logins WHERE person = $1", person);
    state_.note({person, now}, "set password", person, "by code");
    transaction.commit();
    return true;
}

void BooksAccounts::renewHash(const std::string& person, const std::string& from, const std::string& to) {
    Transaction transaction(*state_.database);
    state_.run("UPDATE identities SET password = $1 WHERE person = $2 AND password = $3", to, person, from);
    transaction.commit();
}

std::vector<Enrolment> BooksAccounts::enrolmentsOf(const std::string& person) const {
    std::vector<Enrolment> all;
    Statement rows = state_.ask("SELECT class, person, role FROM enrolments WHERE person = $1 ORDER BY class", person);
    while (rows.next())
        all.push_back({rows.text(0), rows.text(1), rows.text(2)});
    return all;
}

std::vector<Station> BooksAccounts::stations() const {
    std::vector<Station> all;
    Statement rows = state_.ask(fmt::format("{} ORDER BY name, enrolled, id", kStationColumns).c_str());
    while (rows.next())
        all.push_back(stationOf(rows));
    return all;
}

std::vector<AuditLine> BooksAccounts::auditBefore(std::int64_t number, std::size_t most,
                                                  const std::string& about) const {
    std::vector<AuditLine> all;
    Statement rows = state_.ask(
        fmt::format("SELECT number, at, who, what, CASE WHEN " HANDPIECE_TELLS_BLIND " THEN '' ELSE about END, detail "
                    "FROM audit WHERE number < $1 {} ORDER BY number DESC LIMIT $2",
                    about.empty() ? "AND $3 = ''" : "AND about = $3 AND NOT (" HANDPIECE_TELLS_BLIND ")")
            .c_str(),
        number > 0 ? number : std::numeric_limits<std::int64_t>::max(), most, about);
    while (rows.next())
        all.push_back({rows.integer(0), rows.integer(1), rows.text(2), rows.text(3), rows.text(4), rows.text(5)});
    return all;
}

std::string BooksAccounts::incarnation() const {
    return state_.database->text("SELECT id FROM incarnation");
}

std::vector<std::string> BooksAccounts::filesOf(const std::string& person) const {
    std::vector<std::string> all;
    Statement rows = state_.ask(
        "SELECT DISTINCT f.file FROM attempts a JOIN attempt_files f ON f.attempt = a.id JOIN files w ON w.hash = "
        "f.file JOIN deliveries d ON d.file = f.file AND d.station = a.station WHERE a.person = $1 ORDER BY f.file",
        person);
    while (rows.next())
        all.push_back(rows.text(0));
    return all;
}

}  // namespace handpiece::school
