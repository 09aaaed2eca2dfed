// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How long work is kept, and what goes when that time is over. docs/school-lti.md#what-is-kept-and-how-long.

#include <cstdint>
#include <string>
#include <vector>

#include "handpiece/school/store/books_room.h"

namespace handpiece::school {

/// What is kept so long [days]; 0: it stays.
struct RetentionRules {
    /// Of a class: practice that it was given to do, from when it came on, also while the class goes on.
    std::int64_t practiceDays = 0;
    /// Of a class: all of its attempts, after it was closed (SchoolClass::retentionDays).
    std::int64_t closedDays = 0;
};
/// What would go.
struct Expiring {
    std::string attempt{}, person{}, assignment{}, why{};
    Milliseconds finished = 0;
    std::uint64_t bytes = 0;  ///< of its recordings, where nobody else has them
};

/// All members throw core::Error as Books'.
class Retention : public BooksRoom {
  public:
    explicit Retention(Books& books) : BooksRoom(books), books_(books) {}

    /// Throws "books-invalid" for more than a hundred years.
    void setForClass(const std::string& schoolClass, const RetentionRules& rules, const Act& act);
    [[nodiscard]] RetentionRules ofClass(const std::string& schoolClass) const;
    /// Practice of nobody's class.
    void setForPersonal(std::int64_t days, const Act& act);
    [[nodiscard]] std::int64_t ofPersonal() const;

    /// By their ids. Exams, and work that is an exemplar, stay until their class is closed and its time is over.
    [[nodiscard]] std::vector<Expiring> expiring(Milliseconds now) const;
    /// They go, with all that hangs on them and the files that nobody else has, each with its line in the audit.
    /// Returns how many.
    std::int64_t expire(const Act& act);

  private:
    Books& books_;
};

}  // namespace handpiece::school
