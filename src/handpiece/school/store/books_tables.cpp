// SPDX-License-Identifier: Apache-2.0
// The books as tables of text: whole, or what is held of one person.
#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>

#include "handpiece/school/store/books_state.h"

namespace handpiece::school {
namespace {

/// A column's kind stands before its name: t text, i whole number, r number. No passwords, keys, codes.
struct Listed {
    const char* table;
    const char* columns;
    const char* order;
    const char* ofPerson;  ///< nullptr: nothing in it is of one person
    /// In what a person is given, where that is less: visibleOf() in the words of the tables, which a test holds to it.
    /// No table tells a marker whose work it is, nor a student who marked it.
    const char* ownColumns = nullptr;
};
#define HANDPIECE_OF_SITTINGS "sitting IN (SELECT id FROM exam_sittings WHERE person = $1)"
#define HANDPIECE_OF_ATTEMPTS "attempt IN (SELECT id FROM attempts WHERE person = $1)"
#define HANDPIECE_DECIDED "sitting IN (SELECT sitting FROM exam_decisions) AND " HANDPIECE_OF_SITTINGS
#define HANDPIECE_DECIDED_ATTEMPTS \
    HANDPIECE_OF_ATTEMPTS          \
    " AND attempt NOT IN (SELECT id FROM exam_sittings WHERE id NOT IN (SELECT sitting FROM exam_decisions))"
#define HANDPIECE_RELEASED_ATTEMPTS HANDPIECE_DECIDED_ATTEMPTS " AND attempt IN (SELECT attempt FROM releases)"
#define HANDPIECE_IS_BLIND "marker = $1 AND kind = 'blind' AND attempt NOT IN (SELECT attempt FROM releases)"
constexpr std::array kListed = {
    Listed{"people", "t code, i made, i erased", "code", "code = $1"},
    Listed{"identities", "t person, t name, t login, t external", "person", "person = $1"},
    Listed{"roles", "t person, t role", "person, role", "person = $1"},
    Listed{"logins", "t person, i made, i expires", "person, made, expires", "person = $1"},
    Listed{"suspensions", "t person, i made", "person", "person = $1"},
    Listed{"password_codes", "t person, i expires", "person", "person = $1"},
    Listed{"classes", "t id, t name, t external, i retention_days, i made, i closed", "id", nullptr},
    Listed{"enrolments", "t class, t person, t role", "class, person", "person = $1"},
    Listed{"files", "t hash, i bytes, i made", "hash", nullptr},
    Listed{"rubrics", "t hash, t id, i version, t text, i made", "hash", nullptr},
    Listed{"packs", "t hash, t file, t exercise, t title, t rubric, i made", "hash", nullptr},
    Listed{"assignments", "t id, t class, t pack, t rubric, t title, t kind, t helps, i opens, i closes", "id",
           nullptr},
    Listed{"stations", "t id, t name, i enrolled, i revoked, t kind, i released, t person, i ends", "id",
           "person = $1"},
    Listed{"attempts",
           "t id, t station, t person, t assignment, t exercise, t exercise_hash, t rubric_hash, t session_hashes, "
           "i began, i finished, i received, t device, r motion_scale, r score, r max_score, r whole_score, t passed, "
           "i borderline, r worked_s, r limit_s, t content, t result",
           "id", "person = $1"},
    Listed{"attempt_files", "t attempt, i place, t file", "attempt, place", HANDPIECE_OF_ATTEMPTS},
    Listed{"contents", "t file, t inputs", "file", nullptr},
    Listed{"sketches", "t file, t hash", "file, hash", nullptr},
    Listed{"deliveries", "t file, t station, i made", "file, station", nullptr},
    Listed{"judgements", "t attempt, r percent, t words, i made", "attempt", HANDPIECE_OF_ATTEMPTS},
    Listed{"comments", "t id, t attempt, t author, t words, r x_mm, r y_mm, r z_mm, r t_s, i made", "id",
           "author = $1 OR " HANDPIECE_OF_ATTEMPTS},
    Listed{"shares", "t attempt, i made", "attempt", HANDPIECE_OF_ATTEMPTS},
    Listed{"marks", "t id, t attempt, t marker, t kind, t verdict, r points, r max_points, t marks, i made", "id",
           "marker = $1 OR (" HANDPIECE_RELEASED_ATTEMPTS ")",
           // What a marker said has hashes of the work in it, and their code.
           "t id, t CASE WHEN " HANDPIECE_IS_BLIND
           " THEN '' ELSE attempt END AS attempt, t CASE WHEN marker = $1 THEN marker ELSE '' END AS marker, t kind, "
           "t verdict, r points, r max_points, t CASE WHEN " HANDPIECE_IS_BLIND
           " THEN '' WHEN marker = $1 THEN marks ELSE replace(marks, '\"marker\": \"' || substr(marker, 1, 60) || "
           "'\"', '\"marker\": \"\"') END AS marks, i made"},
    Listed{"jobs", "i number, t campaign, t attempt, t rubric, i made, t state, t worker, i lease_until, i turn",
           "number", nullptr},
    Listed{"scores",
           "i job, t attempt, t campaign, t rubric, i engine, t state, t reason, t state_hash, r score, r max_score, "
           "r whole_score, t passed, i borderline, t worker, i made, t result",
           "job", HANDPIECE_DECIDED_ATTEMPTS},
    Listed{"exam_stations", "t station, t key, i made", "station", nullptr},
    Listed{"exam_settings", "t exam, i minutes, t locked", "exam", nullptr},
    Listed{"exam_candidates", "t exam, t person, i extra_percent, i pause_minutes, t helps", "exam, person",
           "person = $1"},
    Listed{"exam_codes", "t exam, t code, t person", "exam, code", "person = $1"},
    Listed{"exam_invigilators", "t exam, t person", "exam, person", "person = $1"},
    Listed{"exam_confirmations", "t exam, t person, i number", "exam, person, number", "person = $1"},
    Listed{"exam_openings", "t exam, i made", "exam", nullptr},
    Listed{"exam_packs", "t exam, i version, t hash, t key, t signature, i made", "exam, version", nullptr},
    Listed{
        "exam_sittings",
        "t id, t exam, t station, t person, t candidate, t pack, t invigilator, i began, i number, t state, i ended, "
        "i confirmation",
        "id", "person = $1 OR invigilator = $1"},
    Listed{"exam_entries",
           "t station, i number, t hash, t kind, t sitting, t text, t key, t signature, i at, i received",
           "station, number", HANDPIECE_OF_SITTINGS},
    Listed{"exam_doubts", "t sitting, t doubts, i made", "sitting", HANDPIECE_DECIDED},
    Listed{"exam_decisions",
           "t id, t sitting, t person, t kind, t verdict, r points, r max_points, t words, i made, i place",
           "sitting, place", "person = $1 OR " HANDPIECE_OF_SITTINGS},
    Listed{"retention", "t scope, i days", "scope", nullptr},
    Listed{"lti_platforms",
           "t id, t issuer, t client, t auth_address, t token_address, t keys_address, t deployments, i lists", "id",
           nullptr},
    Listed{"lti_people", "t platform, t subject, t person", "platform, subject", "person = $1"},
    Listed{"lti_lines", "t assignment, t person, t platform, t subject, t address", "assignment, person",
           "person = $1"},
    Listed{"lti_grades",
           "i number, t assignment, t person, t platform, t subject, t address, t body, i tries, i made, i sent, "
           "t problem",
           "number", "person = $1"},
    Listed{"desks", "t assignment, t marker, t seed, i made", "assignment, marker", "marker = $1"},
    Listed{"desk_works", "t assignment, t marker, i batch, i place, t attempt", "assignment, marker, batch, place",
           "marker = $1", "t assignment, t marker, i batch, i place"},
    Listed{"sheets", "t assignment, t marker, t code, t attempt, t content, i is_in, i changed",
           "assignment, marker, code", "marker = $1", "t assignment, t marker, t code, t content, i is_in, i changed"},
    Listed{"marking_rules", "t assignment, r differ_percent, i made", "assignment", nullptr},
    Listed{"releases", "t attempt, i made", "attempt", HANDPIECE_OF_ATTEMPTS},
    Listed{"campaigns", "t id, t assignment, t rubric, t who, i made", "id", "who = $1"},
    Listed{"counting", "t assignment, t campaign, t first_rubric, i made", "assignment", nullptr},
    Listed{"estimates", "t assignment, t judge, i round, t criterion, r percent, i made",
           "assignment, judge, round, criterion", "judge = $1"},
    Listed{"standards", "t id, t assignment, t method, t content, t who, i made", "id", "who = $1"},
    Listed{"exemplars", "t attempt, t assignment, t content, t who, i made", "attempt",
           "who = $1 OR (" HANDPIECE_RELEASED_ATTEMPTS ")",
           "t attempt, t assignment, t content, t CASE WHEN who = $1 THEN who ELSE '' END AS who, i made"},
    Listed{"calibrations", "t attempt, t marker, t content, i made", "attempt, marker", "marker = $1"},
    Listed{"audit", "i number, i at, t who, t what, t about, t detail", "number",
           "who = $1 OR about = $1 OR about IN (SELECT id FROM attempts WHERE person = $1)",
           "i number, i at, t CASE WHEN who <> $1 AND (what = 'mark' OR what = 'give in marks' OR what = 'work seen "
           "blind' OR what = 'set exemplar') THEN '' ELSE who END AS who, t what, t CASE WHEN " HANDPIECE_TELLS_BLIND
           " THEN '' ELSE about END AS about, t detail"},
};
#undef HANDPIECE_IS_BLIND
#undef HANDPIECE_RELEASED_ATTEMPTS
#undef HANDPIECE_DECIDED_ATTEMPTS
#undef HANDPIECE_DECIDED
#undef HANDPIECE_OF_ATTEMPTS
#undef HANDPIECE_OF_SITTINGS

BookTable read(Database& database, const Listed& listed, const std::string* person) {
    BookTable table{listed.table, {}, {}};
    std::string kinds, columns;
    for (std::string_view rest = person && listed.ownColumns ? listed.ownColumns : listed.columns; !rest.empty();) {
        // Up to a comma that stands in no brackets.
        std::size_t end = 0;
        for (int open = 0; end < rest.size() && (open > 0 || rest[end] != ','); ++end)
            open += rest[end] == '(' ? 1 : rest[end] == ')' ? -1 : 0;
        const std::string_view one = rest.substr(0, end);
        rest.remove_prefix(std::min(rest.size(), one.size() + 2));
        kinds += one[0];
        const std::size_t name = one.rfind(' ') + 1;  // the kind stands before it, or AS
        table.columns.emplace_back(one.substr(name));
        columns += fmt::format("{}{}", columns.empty() ? "" : ", ", one.substr(2));
    }
    Statement rows(database, fmt::format("SELECT {} FROM {} {} ORDER BY {}", columns, listed.table,
                                         person ? fmt::format("WHERE {}", listed.ofPerson) : "", listed.order)
                                 .c_str());
    if (person) rows.with(*person);
    while (rows.next()) {
        std::vector<std::string> row;
        for (std::size_t i = 0; i < kinds.size(); ++i) {
            const int column = static_cast<int>(i);
            const std::optional<double> number = kinds[i] == 'r' ? rows.optional(column) : std::nullopt;
            row.push_back(kinds[i] == 't'   ? rows.text(column)
                          : kinds[i] == 'i' ? std::to_string(rows.integer(column))
                          : number          ? fmt::format("{}", *number)
                                            : std::string());
        }
        table.rows.push_back(std::move(row));
    }
    return table;
}

}  // namespace

void addEscaped(std::string& all, std::string_view text) {
    for (const char c : text)
        switch (c) {
            case '\t':
                all += "\\t";
                break;
            case '\n':
                all += "\\n";
                break;
            case '\r':
                all += "\\r";
                break;
            case '\\':
                all += "\\\\";
                break;
            default:
                all += c;
        }
}

std::string asText(const std::vector<BookTable>& tables) {
    std::string all;
    const auto add = [&all](const std::vector<std::string>& row) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (i > 0) all += '\t';
            addEscaped(all, row[i]);
        }
        all += '\n';
    };
    for (const BookTable& table : tables) {
        all += "# " + table.name + "\n";
        add(table.columns);
        for (const std::vector<std::string>& row : table.rows)
            add(row);
    }
    return all;
}

std::vector<BookTable> Books::everything() const {
    std::vector<BookTable> all;
    Transaction transaction(*state_->database, Database::Access::read);
    for (const Listed& listed : kListed)
        all.push_back(read(*state_->database, listed, nullptr));
    transaction.commit();
    return all;
}

std::vector<BookTable> Books::about(const std::string& code, const Act& act) {
    std::vector<BookTable> all;
    requireText(code);
    Transaction transaction(*state_->database);
    state_->requirePerson(code);
    state_->note(act, "export", code);
    for (const Listed& listed : kListed)
        if (listed.ofPerson) all.push_back(read(*state_->database, listed, &code));
    transaction.commit();
    return all;
}

}  // namespace handpiece::school
