// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Lists of people of another system: what one would change in the books, and doing it. docs/school-office.md.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/school/store/books_room.h"

namespace handpiece::school {

/// People, classes, and who is in which, as a list has them. What a list does not say stays as it is.
struct Roster {
    struct Person {
        std::string key{};  ///< code, or id in the other system
        std::optional<std::string> name{}, login{};
        std::optional<std::vector<std::string>> roles{};  ///< of a new person: student
        bool mayLogIn = true;
        bool isGone = false;
        std::string where{};  ///< for messages: file, line, column
    };
    struct Class {
        std::string key{};  ///< id or name, or id in the other system
        std::string name{};
        bool isGone = false;
        std::string where{};
    };
    struct Enrolment {
        std::string schoolClass{}, person{};  ///< keys
        std::string role{};                   ///< empty: as the person's roles say
        bool isGone = false;
        std::string where{};
    };
    std::vector<Person> people{};
    std::vector<Class> classes{};
    std::vector<Enrolment> enrolments{};
    /// Keys are ids of another system (`external` of the books), else codes, and ids or names of classes.
    bool isExternal = false;
    /// Whoever of that system is not in it is gone; of a list with codes: who studies in one of its classes.
    bool hasAllPeople = false, hasAllClasses = false, hasAllEnrolments = false;
    std::vector<std::string> notices{};  ///< what was not read, a sentence each
};

struct RosterRules {
    bool isDryRun = false;
    /// Else a list makes nobody an administrator.
    bool makesAdministrators = false;
    /// Else a list in which more than ten and a quarter of those known are missing is taken for a part of one.
    bool endsMany = false;
    std::function<std::string()> newCode = newId;  ///< of people who come with an id of another system
};

struct RosterChange {
    enum class Kind {
        addPerson,
        rename,
        setRoles,
        suspend,
        resume,
        addClass,
        renameClass,
        closeClass,
        openClass,
        enrol,
        leave
    };
    Kind kind{};
    std::string person{}, schoolClass{};  ///< codes and ids; of what a dry run would add: the list's keys
    std::string name{};                   ///< of the person, else of the class
    std::string detail{};                 ///< "from > to", or a role
};

class BooksRoster : BooksRoom {
  public:
    explicit BooksRoster(Books& books) : BooksRoom(books) {}
    /// All or nothing, and each change in the audit; the same list again changes nothing. Roles that somebody gave by
    /// hand stay: examiner, administrator. Nobody is erased: who is gone cannot log in and leaves the classes.
    /// Throws core::Error "list-unfit" with the list's place, "list-short", and as Books.
    std::vector<RosterChange> import(const Roster& roster, const RosterRules& rules, const Act& act);

  private:
    class Import;
};

}  // namespace handpiece::school
