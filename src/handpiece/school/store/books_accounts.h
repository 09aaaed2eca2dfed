// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What an administrator keeps: accounts, stations, the audit.

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "handpiece/school/store/books_room.h"

namespace handpiece::school {

class BooksAccounts : BooksRoom {
  public:
    explicit BooksAccounts(Books& books) : BooksRoom(books) {}

    /// Whoever is suspended cannot log in; what they did stays.
    void suspend(const std::string& person, const Act& act);
    void resume(const std::string& person, const Act& act);
    [[nodiscard]] bool isSuspended(const std::string& person) const;
    [[nodiscard]] std::set<std::string> suspended() const;

    /// A code with which this person sets a password, once; the one before holds no more. Kept as a hash.
    void offerPasswordCode(const std::string& person, const std::string& code, Milliseconds expires, const Act& act);
    /// False, and nothing changed, for a login or code that is unknown, used, or too old.
    bool setPasswordByCode(const std::string& login, const std::string& code, const std::string& passwordHash,
                           Milliseconds now);

    /// The same password, hashed anew: log-ins go on. Nothing where it has another one meanwhile.
    void renewHash(const std::string& person, const std::string& from, const std::string& to);

    [[nodiscard]] std::vector<Enrolment> enrolmentsOf(const std::string& person) const;
    [[nodiscard]] std::vector<Station> stations() const;
    /// Before `number`, the newest first; `number` 0: from the newest on; empty `about`: all. Which work a marker had
    /// under a code is left out, and not found by, until its marks are released.
    [[nodiscard]] std::vector<AuditLine> auditBefore(std::int64_t number, std::size_t most,
                                                     const std::string& about = {}) const;
    /// Of these books from their beginning, or from when they were restored: then stations send again what they sent.
    [[nodiscard]] std::string incarnation() const;
    /// Hashes of the files of a person's sessions that are there.
    [[nodiscard]] std::vector<std::string> filesOf(const std::string& person) const;
};

}  // namespace handpiece::school
