// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/store/books_roster.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "handpiece/school/store/books_state.h"

namespace handpiece::school {
namespace {

using Kind = RosterChange::Kind;

[[noreturn]] void unfit(const std::string& where, const std::string& problem, const std::string& remedy) {
    throw core::Error(problem, where, remedy).as("list-unfit", {where, problem});
}

bool isCode(const std::string& code) {
    return !code.empty() && code.size() <= 64 && std::all_of(code.begin(), code.end(), [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_' ||
               c == '.';
    });
}

/// What the books hold of it, and become.
struct Held {
    Person person;
    bool isSuspended = false, isNew = false;
};

}  // namespace

class BooksRoster::Import {
  public:
    Import(State& state, const Roster& roster, const RosterRules& rules, const Act& act)
        : state_(state), roster_(roster), rules_(rules), act_(act) {}

    std::vector<RosterChange> run() {
        load();
        people();
        classes();
        enrolments();
        return std::move(changes_);
    }

  private:
    void load() {
        {
            Statement rows = state_.ask(
                "SELECT p.code, coalesce(i.name, ''), coalesce(i.login, ''), coalesce(i.external, ''), p.erased, "
                "CASE WHEN s.person IS NULL THEN 0 ELSE 1 END FROM people p LEFT JOIN identities i ON i.person = "
                "p.code LEFT JOIN suspensions s ON s.person = p.code ORDER BY p.code");
            while (rows.next()) {
                Held held;
                held.person.code = rows.text(0), held.person.name = rows.text(1), held.person.login = rows.text(2);
                held.person.external = rows.text(3), held.person.erased = rows.integer(4);
                held.isSuspended = rows.integer(5) != 0;
                if (!held.person.external.empty()) codeOf_[held.person.external] = held.person.code;
                people_.emplace(held.person.code, std::move(held));
            }
        }
        {
            Statement rows = state_.ask("SELECT person, role FROM roles ORDER BY person, role");
            while (rows.next())
                people_[rows.text(0)].person.roles.push_back(rows.text(1));
        }
        {
            Statement rows = state_.ask("SELECT id, name, external, closed FROM classes ORDER BY id");
            while (rows.next()) {
                SchoolClass one;
                one.id = rows.text(0), one.name = rows.text(1), one.external = rows.text(2),
                one.closed = rows.integer(3);
                classes_.emplace(one.id, std::move(one));
            }
        }
        Statement rows = state_.ask("SELECT class, person, role FROM enrolments");
        while (rows.next())
            enrolments_[{rows.text(0), rows.text(1)}] = rows.text(2);
    }

    // People.

    Held* heldBy(const std::string& key) {
        const std::string* code = &key;
        if (roster_.isExternal) {
            const auto found = codeOf_.find(key);
            if (found == codeOf_.end()) return nullptr;
            code = &found->second;
        }
        const auto found = people_.find(*code);
        return found == people_.end() ? nullptr : &found->second;
    }

    void people() {
        std::set<std::string> named;
        std::vector<std::pair<Held*, const Roster::Person*>> relogged;
        for (const Roster::Person& said : roster_.people) {
            named.insert(said.key);
            Held* held = heldBy(said.key);
            if (held && held->person.erased > 0)
                unfit(said.where, fmt::format("'{}' was erased", said.key), "give the person another code");
            if (!held && said.isGone) continue;
            if (!held) held = add(said);
            if (said.isGone) {
                suspend(*held);
                continue;
            }
            Person& person = held->person;
            if ((said.name && *said.name != person.name) || (said.login && *said.login != person.login)) {
                if (!held->isNew)
                    changes_.push_back(
                        {Kind::rename,
                         person.code,
                         {},
                         said.name.value_or(person.name),
                         fmt::format("{} ({}) > {} ({})", person.name, person.login, said.name.value_or(person.name),
                                     said.login.value_or(person.login))});
                if (said.name) person.name = *said.name;
                if (said.login) person.login = *said.login;
                relogged.emplace_back(held, &said);
            }
            giveRoles(*held, said);
            if (!said.mayLogIn)
                suspend(*held);
            else if (held->isSuspended)
                resume(*held);
        }
        if (roster_.hasAllPeople && roster_.isExternal) {
            std::vector<Held*> missing;
            std::size_t known = 0;
            for (auto& [code, held] : people_) {
                if (held.person.external.empty() || held.isSuspended || held.isNew) continue;
                ++known;
                if (named.count(held.person.external) == 0) missing.push_back(&held);
            }
            requireWhole("people", missing.size(), known);
            for (Held* held : missing)
                suspend(*held);
        }
        writeNames(relogged);
    }

    Held* add(const Roster::Person& said) {
        Held held;
        held.isNew = true;
        Person& person = held.person;
        person.code = said.key;
        if (roster_.isExternal) {
            person.external = said.key;
            do
                person.code = rules_.newCode();
            while (people_.count(person.code) > 0);
        } else if (!isCode(person.code)) {
            unfit(said.where, fmt::format("'{}' is no code of a person", person.code.substr(0, 80)),
                  "use 1 to 64 letters, digits, '-', '_' and '.'");
        }
        state_.run("INSERT INTO people (code, made, erased) VALUES ($1, $2, 0)", person.code, act_.at);
        state_.run("INSERT INTO identities (person, name, login, external, password) VALUES ($1, '', '', $2, '')",
                   person.code, person.external);
        state_.note(act_, "add person", person.code);
        changes_.push_back({Kind::addPerson,
                            rules_.isDryRun ? said.key : person.code,
                            {},
                            said.name.value_or(""),
                            said.login.value_or("")});
        if (roster_.isExternal) codeOf_[said.key] = person.code;
        return &people_.emplace(person.code, std::move(held)).first->second;
    }

    /// Logins are one person's each: first those that change are free, then they are given.
    void writeNames(const std::vector<std::pair<Held*, const Roster::Person*>>& relogged) {
        std::map<std::string, std::string> ofLogin;
        for (const auto& [held, said] : relogged)
            state_.run("UPDATE identities SET login = '' WHERE person = $1", held->person.code);
        {
            Statement rows = state_.ask("SELECT login, person FROM identities WHERE login <> ''");
            while (rows.next())
                ofLogin[rows.text(0)] = rows.text(1);
        }
        for (const auto& [held, said] : relogged) {
            const Person& person = held->person;
            if (!person.login.empty() && !ofLogin.emplace(person.login, person.code).second)
                unfit(said->where, fmt::format("the login '{}' is another person's", person.login),
                      fmt::format("give another one; {} has it", ofLogin[person.login]));
            state_.run("UPDATE identities SET name = $1, login = $2 WHERE person = $3", person.name, person.login,
                       person.code);
            if (!held->isNew) state_.note(act_, "rename", person.code);
        }
    }

    void giveRoles(Held& held, const Roster::Person& said) {
        if (!said.roles && !held.isNew) return;
        std::set<std::string> wanted;
        for (const std::string& role : said.roles.value_or(std::vector<std::string>{"student"}))
            if (role != "administrator" || rules_.makesAdministrators) wanted.insert(role);
        for (const std::string& role : held.person.roles)
            if (role == "administrator" || (role == "examiner" && roster_.isExternal)) wanted.insert(role);
        const std::vector<std::string> roles(wanted.begin(), wanted.end());
        if (roles == held.person.roles) return;
        const std::string& code = held.person.code;
        state_.run("DELETE FROM roles WHERE person = $1", code);
        for (const std::string& role : roles)
            state_.run("INSERT INTO roles (person, role) VALUES ($1, $2)", code, role);
        state_.run("DELETE FROM logins WHERE person = $1", code);
        state_.note(act_, "set roles", code, fmt::format("{}", fmt::join(roles, " ")));
        changes_.push_back({Kind::setRoles,
                            rules_.isDryRun && held.isNew ? said.key : code,
                            {},
                            held.person.name,
                            fmt::format("{} > {}", fmt::join(held.person.roles, " "), fmt::join(roles, " "))});
        held.person.roles = roles;
    }

    void suspend(Held& held) {
        const std::string& code = held.person.code;
        if (!held.isSuspended) {
            state_.run("INSERT INTO suspensions (person, made) VALUES ($1, $2)", code, act_.at);
            state_.run("DELETE FROM logins WHERE person = $1", code);
            state_.note(act_, "suspend", code);
            changes_.push_back({Kind::suspend, code, {}, held.person.name, {}});
            held.isSuspended = true;
        }
        gone_.insert(code);
    }
    void resume(Held& held) {
        state_.run("DELETE FROM suspensions WHERE person = $1", held.person.code);
        state_.note(act_, "resume", held.person.code);
        changes_.push_back({Kind::resume, held.person.code, {}, held.person.name, {}});
        held.isSuspended = false;
    }

    // Classes.

    SchoolClass* classBy(const std::string& key, const std::string& where) {
        if (roster_.isExternal) {
            for (auto& [id, one] : classes_)
                if (one.external == key) return &one;
            return nullptr;
        }
        if (const auto found = classes_.find(key); found != classes_.end()) {
            if (found->second.closed > 0)
                unfit(where, fmt::format("the class '{}' is closed", found->second.name), "name another one");
            return &found->second;
        }
        SchoolClass* named = nullptr;
        for (auto& [id, one] : classes_) {
            if (one.name != key || one.closed > 0) continue;
            if (named)
                unfit(where, fmt::format("there are two classes '{}'", key),
                      fmt::format("write the id: {} or {}", named->id, id));
            named = &one;
        }
        return named;
    }

    void classes() {
        std::set<std::string> named;
        for (const Roster::Class& said : roster_.classes) {
            named.insert(said.key);
            SchoolClass* one = classBy(said.key, said.where);
            if (said.isGone) {
                if (one) close(*one);
                continue;
            }
            if (!one) {
                SchoolClass made;
                made.id = newId(), made.name = said.name, made.external = roster_.isExternal ? said.key : "";
                state_.run(
                    "INSERT INTO classes (id, name, external, retention_days, made, closed) "
                    "VALUES ($1, $2, $3, 0, $4, 0)",
                    made.id, made.name, made.external, act_.at);
                state_.note(act_, "add class", made.id);
                changes_.push_back({Kind::addClass, {}, rules_.isDryRun ? said.key : made.id, made.name, {}});
                classes_.emplace(made.id, std::move(made));
                continue;
            }
            if (!roster_.isExternal) continue;
            if (one->name != said.name) {
                state_.run("UPDATE classes SET name = $1 WHERE id = $2", said.name, one->id);
                state_.note(act_, "rename class", one->id);
                changes_.push_back(
                    {Kind::renameClass, {}, one->id, said.name, fmt::format("{} > {}", one->name, said.name)});
                one->name = said.name;
            }
            if (one->closed > 0) {
                state_.run("UPDATE classes SET closed = 0 WHERE id = $1", one->id);
                state_.note(act_, "open class", one->id);
                changes_.push_back({Kind::openClass, {}, one->id, one->name, {}});
                one->closed = 0;
            }
        }
        if (!roster_.hasAllClasses || !roster_.isExternal) return;
        std::vector<SchoolClass*> missing;
        std::size_t known = 0;
        for (auto& [id, one] : classes_) {
            if (one.external.empty() || one.closed > 0) continue;
            ++known;
            if (named.count(one.external) == 0) missing.push_back(&one);
        }
        requireWhole("classes", missing.size(), known);
        for (SchoolClass* one : missing)
            close(*one);
    }
    void close(SchoolClass& one) {
        if (one.closed > 0) return;
        state_.run("UPDATE classes SET closed = $1 WHERE id = $2", act_.at, one.id);
        state_.note(act_, "close class", one.id);
        changes_.push_back({Kind::closeClass, {}, one.id, one.name, {}});
        one.closed = act_.at;
    }

    // Who is in which class.

    static std::string roleFor(const Person& person) {
        for (const char* role : {"teacher", "examiner"})
            if (std::find(person.roles.begin(), person.roles.end(), role) != person.roles.end()) return role;
        return "student";
    }

    void enrolments() {
        std::map<std::pair<std::string, std::string>, std::string> wanted;
        std::set<std::pair<std::string, std::string>> ended;
        std::set<std::string> named;
        for (const Roster::Enrolment& said : roster_.enrolments) {
            const SchoolClass* one = classBy(said.schoolClass, said.where);
            Held* held = heldBy(said.person);
            if (!one || !held) {
                if (said.isGone) continue;
                unfit(said.where,
                      fmt::format("there is no {} '{}'", one ? "person" : "class",
                                  (one ? said.person : said.schoolClass).substr(0, 80)),
                      "add it to the list, or take out the line");
            }
            named.insert(one->id);
            const std::pair<std::string, std::string> key{one->id, held->person.code};
            if (said.isGone) {
                ended.insert(key);
                continue;
            }
            if (gone_.count(held->person.code) > 0) continue;
            std::string role = said.role.empty() ? roleFor(held->person) : said.role;
            // One person in one class twice: as the teacher.
            if (const auto [place, isNew] = wanted.emplace(key, role); !isNew && role == "teacher")
                place->second = role;
        }
        for (const auto& [key, role] : wanted) {
            const auto found = enrolments_.find(key);
            if (found != enrolments_.end() && found->second == role) continue;
            // What somebody set by hand stays: an examiner.
            if (found != enrolments_.end() && found->second == "examiner" && roster_.isExternal) continue;
            state_.run(
                "INSERT INTO enrolments (class, person, role) VALUES ($1, $2, $3) "
                "ON CONFLICT (class, person) DO UPDATE SET role = excluded.role",
                key.first, key.second, role);
            state_.note(act_, "enrol", key.second, fmt::format("{} as {}", key.first, role));
            tell(Kind::enrol, key, role);
        }
        std::vector<std::pair<std::string, std::string>> missing;
        std::size_t known = 0;
        for (const auto& [key, role] : enrolments_) {
            const SchoolClass& one = classes_.at(key.first);
            const Person& person = people_.at(key.second).person;
            if (gone_.count(person.code) > 0 && one.closed == 0) {
                ended.insert(key);
                continue;
            }
            const bool isOfList = roster_.isExternal ? !one.external.empty() && !person.external.empty() &&
                                                           role != "examiner" && one.closed == 0
                                                     : named.count(one.id) > 0 && role == "student";
            if (!roster_.hasAllEnrolments || !isOfList) continue;
            ++known;
            if (wanted.count(key) == 0 && ended.count(key) == 0) missing.push_back(key);
        }
        requireWhole("enrolments", missing.size(), known);
        ended.insert(missing.begin(), missing.end());
        for (const auto& key : ended)
            if (enrolments_.count(key) > 0 && wanted.count(key) == 0) {
                state_.run("DELETE FROM enrolments WHERE class = $1 AND person = $2", key.first, key.second);
                state_.note(act_, "leave", key.second, key.first);
                tell(Kind::leave, key, enrolments_.at(key));
            }
    }
    void tell(Kind kind, const std::pair<std::string, std::string>& key, const std::string& role) {
        const Held& held = people_.at(key.second);
        const SchoolClass& one = classes_.at(key.first);
        const bool isNamed = rules_.isDryRun && held.isNew && roster_.isExternal;
        changes_.push_back({kind, isNamed ? held.person.external : key.second, key.first, held.person.name,
                            fmt::format("{}, {}", one.name, role)});
    }

    void requireWhole(const char* what, std::size_t missing, std::size_t known) const {
        constexpr std::size_t kFew = 10;
        if (rules_.endsMany || missing <= kFew || missing * 4 <= known) return;
        throw core::Error(fmt::format("{} of {} {} that are known are not in the list", missing, known, what), "",
                          "see whether it is whole; if it is, say so: --ends-many")
            .as("list-short", {std::to_string(missing), std::to_string(known), what});
    }

    State& state_;
    const Roster& roster_;
    const RosterRules& rules_;
    const Act& act_;
    std::map<std::string, Held> people_;         ///< by code
    std::map<std::string, std::string> codeOf_;  ///< by the other system's id
    std::map<std::string, SchoolClass> classes_;
    std::map<std::pair<std::string, std::string>, std::string> enrolments_;  ///< class, person: role
    std::set<std::string> gone_;
    std::vector<RosterChange> changes_;
};

std::vector<RosterChange> BooksRoster::import(const Roster& roster, const RosterRules& rules, const Act& act) {
    Transaction transaction(*state_.database);
    std::vector<RosterChange> changes = Import(state_, roster, rules, act).run();
    if (!rules.isDryRun) transaction.commit();
    return changes;
}

}  // namespace handpiece::school
