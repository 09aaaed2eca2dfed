// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the books know of learning platforms: who they are, which launches came, whose grades go where, and those that
/// wait to go. docs/school-lti.md.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/school/store/books_room.h"

namespace handpiece::school {

/// As its administrator tells it.
struct LtiPlatform {
    std::string id{};
    std::string issuer{}, client{};
    std::string authAddress{}, tokenAddress{}, keysAddress{};
    std::vector<std::string> deployments{};
    bool hasLists = false;  ///< what it calls people are the external ids of the school's class lists
};
/// Where a person's grade for an assignment goes.
struct LtiLine {
    std::string assignment{}, person{}, platform{};
    std::string subject{};  ///< the person, as the platform calls them
    std::string address{};  ///< of the line item
};
struct LtiGrade {
    std::int64_t number = 0;
    LtiLine line{};
    std::string body{};  ///< JSON
    std::int64_t tries = 0;
    Milliseconds made = 0, next = 0, sent = 0;  ///< `next`: not before; `sent` 0: it waits
    std::string problem{};                      ///< of the last try
};
/// What is known of an assignment's worth for a person.
struct Worth {
    std::string kind{};                           ///< of the assignment
    std::string verdict{};                        ///< of an exam
    std::optional<double> points{}, maxPoints{};  ///< confirmed by a teacher
    Milliseconds decided = 0;
    Milliseconds came = 0;  ///< when the last attempt came; 0: none
};

/// All members throw core::Error as Books'.
class LtiBooks : public BooksRoom {
  public:
    explicit LtiBooks(Books& books) : BooksRoom(books), books_(books) {}

    /// Again, of the same issuer and client: with the addresses of now. Returns its id.
    std::string set(const LtiPlatform& platform, const Act& act);
    [[nodiscard]] std::vector<LtiPlatform> platforms() const;
    [[nodiscard]] std::optional<LtiPlatform> platform(const std::string& issuer, const std::string& client) const;
    [[nodiscard]] std::optional<LtiPlatform> platform(const std::string& id) const;

    /// A launch that the platform vouches for, by its state, which is kept as a hash until it is worth nothing any
    /// more. False: it came before.
    bool isFirst(const std::string& state, const std::string& platform, Milliseconds expires, Milliseconds now);

    /// Whom this platform calls so: by its own table, else, where it has the school's lists, by the external id.
    [[nodiscard]] std::optional<Person> personOn(const LtiPlatform& platform, const std::string& subject) const;
    /// Throws "books-duplicate" where another one has that id there.
    void setPerson(const LtiPlatform& platform, const std::string& subject, const std::string& person, const Act& act);
    /// Of the school's class lists and single sign-on; no platform's.
    [[nodiscard]] std::optional<Person> personByExternal(const std::string& external) const;
    /// What class lists and single sign-on call this person; empty: nothing. Throws "books-duplicate".
    void setExternal(const std::string& person, const std::string& external, const Act& act);

    void set(const LtiLine& line);
    [[nodiscard]] std::vector<LtiLine> lines() const;
    [[nodiscard]] Worth worthOf(const std::string& assignment, const std::string& person) const;

    /// Unless the last one of this line says the same. True: it waits now; an older one that still waited is dropped.
    bool queue(const LtiLine& line, const std::string& body, Milliseconds now);
    /// The oldest that may go now.
    [[nodiscard]] std::optional<LtiGrade> nextGrade(Milliseconds now) const;
    void sent(std::int64_t number, Milliseconds now);
    void failed(std::int64_t number, const std::string& problem, Milliseconds next);
    [[nodiscard]] std::vector<LtiGrade> grades() const;

  private:
    Books& books_;
};

}  // namespace handpiece::school
