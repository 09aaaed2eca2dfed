// SPDX-License-Identifier: Apache-2.0
// What may be seen of an attempt: the rule in plain sentences, and the tables that a person is given held to it.
#include "handpiece/school/store/visible.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "handpiece/school/store/books_accounts.h"
#include "handpiece/school/store/exam_books.h"
#include "handpiece/school/store/teaching.h"
#include "school/store/books_fixture.h"

namespace handpiece::school::visible_test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// All states that there are.
std::vector<Standing> allStandings() {
    return {{false, false, false}, {false, false, true}, {true, false, false},
            {true, false, true},   {true, true, false},  {true, true, true}};
}

TEST(Visible, IsNoMoreThanTheSentencesSay) {
    for (const Standing& standing : allStandings())
        for (const std::optional<Role> inClass : {std::optional<Role>(), std::optional(Role::student),
                                                  std::optional(Role::teacher), std::optional(Role::examiner)})
            for (const Role role : {Role::student, Role::teacher, Role::examiner, Role::administrator})
                for (const bool isOwn : {false, true})
                    for (const bool isPrivate : {false, true})
                        for (const bool marksBlind : {false, true}) {
                            const Visible v = visibleOf({{role}, {isOwn, isPrivate, inClass}, marksBlind}, standing);
                            const bool isOfClass = inClass == role && !isPrivate && role != Role::student;
                            if (!isOwn || role == Role::administrator) {
                                EXPECT_EQ(v.exists, isOfClass && role != Role::administrator);
                            }
                            // Nothing of what is not there.
                            EXPECT_FALSE(!v.exists && (v.worth || v.reason || v.recording || v.comments || v.marks ||
                                                       v.markers || v.decisions || v.doubts));
                            // An exam's student waits for a teacher.
                            EXPECT_FALSE(isOwn && standing.isExam && !standing.isDecided &&
                                         (v.worth || v.reason || v.marks || v.doubts));
                            EXPECT_FALSE(isOwn && v.markers) << "no student has a marker's name";
                            EXPECT_FALSE(isOwn && !standing.isReleased && v.marks);
                            EXPECT_FALSE(!isOwn && marksBlind && (v.marks || v.markers));
                            EXPECT_FALSE(!isOwn && role == Role::examiner &&
                                         (v.whose || v.marks || v.decisions || v.doubts));
                            EXPECT_FALSE(!standing.isExam && v.doubts);
                            EXPECT_EQ(v.behindCode, standing.isReleased);
                        }
    // And all of it to those whom it is for.
    const Visible own = visibleToItsStudent({true, true, true});
    EXPECT_TRUE(own.worth && own.reason && own.recording && own.marks && own.decisions && own.doubts);
    const Visible teacher = visibleOf({{Role::teacher}, {false, false, Role::teacher}, false}, {true, false, false});
    EXPECT_TRUE(teacher.worth && teacher.marks && teacher.markers && teacher.whose && teacher.doubts);
}

constexpr std::array kMarking = {"mark", "give in marks", "work seen blind"};
bool isMarking(const std::string& what) {
    return std::find(kMarking.begin(), kMarking.end(), what) != kMarking.end();
}

using Row = std::map<std::string, std::string>;
std::vector<Row> rowsOf(const std::vector<BookTable>& tables, const std::string& name) {
    std::vector<Row> all;
    for (const BookTable& table : tables) {
        if (table.name != name) continue;
        for (const std::vector<std::string>& cells : table.rows) {
            Row row;
            for (std::size_t i = 0; i < cells.size(); ++i)
                row[table.columns.at(i)] = cells[i];
            all.push_back(std::move(row));
        }
    }
    return all;
}
std::vector<Row> rowsOf(const std::vector<BookTable>& tables, const std::string& name, const std::string& key,
                        const std::string& value) {
    std::vector<Row> all = rowsOf(tables, name);
    std::erase_if(all, [&](const Row& row) { return row.at(key) != value; });
    return all;
}

/// An attempt of s1 in each state, id(1) on, scored, with a comment, marked blind by m1 and an exemplar of t1's.
void makeEach(Books& books) {
    const Act act{"m1", kNow};
    books.add(std::vector<Person>{{"m1", "Marker", "marker", "", "", {"examiner"}}}, kAdmin);
    books.enrol(std::vector<Enrolment>{{"c1", "m1", "examiner"}}, kAdmin);
    books.add(Assignment{"ex1", "c1", shortHash(0xe0), shortHash(0xab), "Exam", "exam", "", kNow, kNow + kDay}, kAdmin);
    ExamBooks exams(books);
    Teaching teaching(books);
    exams.addKey(kStation, sha256("key"), kNow);
    exams.set(ExamSettings{"ex1", 30, ""}, kAdmin);
    exams.set(ExamCandidate{"ex1", "s1", sha256("candidate"), 0, 0, ""}, kAdmin);
    std::int64_t number = 0;
    const auto entry = [&](const char* kind, const std::string& sitting) {
        ++number;
        return ExamEntry{kStation, number, sha256(std::to_string(number)), kind, sitting, "text", sha256("key"), "sig",
                         kNow,     kNow};
    };
    std::uint64_t n = 0;
    for (const Standing& standing : allStandings()) {
        PushedAttempt work = attempt(++n);
        const std::string& which = work.attempt.id;
        if (standing.isExam) {
            work.assignment = "ex1";
            const ExamSitting sitting{which, "ex1", kStation, "s1", sha256("candidate"), sha256("pack"), "t1",
                                      kNow,  0,     "begun",  0};
            EXPECT_TRUE(exams.add(entry("begun", which), &sitting, nullptr));
            EXPECT_TRUE(exams.add(entry("finished", which), nullptr, &work));
            exams.setDoubts(which, {"doubted"}, kNow);
        } else {
            EXPECT_TRUE(books.push(work));
        }
        const std::optional<Job> job = books.takeJob("w", kNow, 1000);
        ASSERT_TRUE(job);
        EXPECT_TRUE(books.finish(*job, scoreOf(*job, "w")));
        EXPECT_TRUE(books.push(Comment{id(300 + n), which, "t1", "well", {}, {}, kNow}));
        books.note(act, "work seen blind", which, work.assignment);
        books.note(act, "give in marks", which, work.assignment);
        EXPECT_TRUE(books.push(Mark{id(400 + n), which, "m1", "blind", "yes", 8.0, 10.0,
                                    "{\n \"marker\": \"m1\",\n \"state_hash\": \"5555\"\n}\n", kNow},
                               act));
        teaching.set(Exemplar{which, work.assignment, "{}", "t1"}, {"t1", kNow});
        if (standing.isDecided)
            exams.add(ExamDecision{id(500 + n), which, "t1", "confirm", "fail", 0, 0, "why", kNow}, {"t1", kNow});
        if (standing.isReleased) teaching.release(std::vector<std::string>{which}, true, {"t1", kNow});
    }
}

TEST_P(BooksTest, WhatAPersonIsGivenIsWhatTheyMaySee) {
    auto books = filled();
    makeEach(*books);
    const std::vector<BookTable> own = books->about("s1", kAdmin), marker = books->about("m1", kAdmin);
    const std::vector<AuditLine> audit = BooksAccounts(*books).auditBefore(0, 1000);
    std::uint64_t n = 0;
    for (const Standing& standing : allStandings()) {
        const std::string which = id(++n);
        SCOPED_TRACE(
            fmt::format("exam {} decided {} released {}", standing.isExam, standing.isDecided, standing.isReleased));
        const Standing found = standingOf(*books, which);
        EXPECT_EQ(found.isExam, standing.isExam);
        EXPECT_EQ(found.isDecided, standing.isDecided);
        EXPECT_EQ(found.isReleased, standing.isReleased);
        const Visible seen = visibleToItsStudent(standing);
        const auto has = [&](const char* table, const char* key = "attempt") {
            return !rowsOf(own, table, key, which).empty();
        };
        EXPECT_EQ(has("attempts", "id"), seen.exists);
        EXPECT_EQ(has("scores"), seen.worth);
        EXPECT_EQ(has("scores"), seen.reason);
        EXPECT_EQ(has("comments"), seen.comments);
        EXPECT_EQ(has("marks"), seen.marks);
        EXPECT_EQ(has("exemplars"), seen.marks);
        EXPECT_EQ(has("exam_doubts", "sitting"), seen.doubts);
        EXPECT_EQ(has("exam_decisions", "sitting"), seen.decisions && standing.isDecided);
        for (const Row& row : rowsOf(own, "marks", "attempt", which)) {
            EXPECT_EQ(row.at("marker") == "m1", seen.markers);
            EXPECT_EQ(row.at("marks").find("m1") != std::string::npos, seen.markers) << row.at("marks");
            EXPECT_THAT(row.at("marks"), HasSubstr("\"state_hash\": \"5555\"")) << "and all else of it";
        }
        for (const Row& row : rowsOf(own, "exemplars", "attempt", which))
            EXPECT_EQ(row.at("who") == "t1", seen.markers);
        // The marker's own.
        const std::vector<Row> marks = rowsOf(marker, "marks", "id", id(400 + n));
        ASSERT_EQ(marks.size(), 1u);
        EXPECT_EQ(marks[0].at("attempt") == which, seen.behindCode);
        EXPECT_EQ(!marks[0].at("marks").empty(), seen.behindCode) << "it has hashes of the work";
        EXPECT_THAT(marks[0].at("points"), testing::StartsWith("8"));
        EXPECT_EQ(rowsOf(marker, "audit", "about", which).size(), seen.behindCode ? kMarking.size() : 0u);
        // The audit, whole and looked through for the attempt.
        const auto told = [&](const std::vector<AuditLine>& lines) {
            return std::count_if(lines.begin(), lines.end(), [&](const AuditLine& line) {
                return line.who == "m1" && isMarking(line.what) && line.about == which;
            });
        };
        const auto all = static_cast<std::ptrdiff_t>(seen.behindCode ? kMarking.size() : 0u);
        EXPECT_EQ(told(audit), all);
        const std::vector<AuditLine> ofIt = BooksAccounts(*books).auditBefore(0, 1000, which);
        EXPECT_EQ(told(ofIt), all);
        EXPECT_EQ(std::count_if(ofIt.begin(), ofIt.end(), [](const AuditLine& line) { return line.who == "m1"; }), all);
    }
    // Whichever attempt it is about: no student learns who marked.
    std::size_t marking = 0;
    for (const Row& row : rowsOf(own, "audit")) {
        if (!isMarking(row.at("what")) && row.at("what") != "set exemplar") continue;
        ++marking;
        EXPECT_EQ(row.at("who"), "") << row.at("what");
    }
    EXPECT_EQ(marking, (kMarking.size() + 1) * allStandings().size());
    EXPECT_THAT(asText(books->about("s1", kAdmin)), Not(HasSubstr("m1")));
}

}  // namespace
}  // namespace handpiece::school::visible_test
