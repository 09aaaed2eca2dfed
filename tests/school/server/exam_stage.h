// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// An exam that some have sat, without stations: what their services would have told.

#include <string>
#include <utility>
#include <vector>

#include "handpiece/school/people/secret.h"
#include "school/exam_arrival.h"
#include "school/server/school_fixture.h"

namespace handpiece::school_server {

/// Exam "ex1" of class c1 with t1 as invigilator; `sat`: who, and what they handed over. Returns their sittings.
inline std::vector<std::string> holdExam(Books& books, const fs::path& data,
                                         const std::vector<std::pair<std::string, fs::path>>& sat) {
    const Act act{"server", 1};
    const school::Milliseconds now = systemClock()();
    const std::string exercise = rubric::hashText(tasks::contentHash(blockTask()));
    books.add(school::Assignment{"ex1", "c1", exercise, books.pack(exercise)->rubric, "Block, the exam", "exam", "",
                                 now - 3'600'000, now + 3'600'000},
              act);
    school::ExamBooks exams(books);
    exams.set(school::ExamSettings{"ex1", 30, "undo guide"}, act);
    for (const school::Enrolment& one : books.enrolments("c1"))
        if (one.role == "student")
            exams.set(school::ExamCandidate{"ex1", one.person, exam::candidateHash("ex1", one.person),
                                            one.person == "s017" ? 25 : 0, 0, one.person == "s017" ? "guide" : ""},
                      act);
    exams.set(school::ExamInvigilator{"ex1", "t1", "-"}, act);
    const std::string confirmation = "PPP-QQQ-RRR-SSS", hash = school::hashOfPassword(confirmation);
    for (const school::ExamCandidate& one : exams.candidates("ex1"))
        exams.add(school::ExamConfirmation{"ex1", one.person, 0, hash}, act);
    const school::ExamPack pack = signExam(books, "ex1", examKey(data), act);
    const std::string station(32, 'e');
    books.offerCode("exam-room-1-code", "exam room, 1", now + 1'000'000, act, "exam");
    (void)books.enrolStation("exam-room-1-code", station, std::string(64, 'f'), now);
    books.releaseForExams(station, act);
    const exam::SigningKey key = exam::newSigningKey();
    exams.addKey(station, key.open, now);
    exam::ChainEnd end;
    const auto tell = [&](exam::Entry e) {
        e.station = station, e.number = end.number + 1, e.previous = end.hash;
        const std::string text = exam::toText(e);
        (void)takeEntry(books, station, exam::joined({text, exam::signatureOf(text, key)}), now);
        end = {e.number, exam::hashOfEntry(text)};
    };
    std::vector<std::string> sittings;
    for (const auto& [person, file] : sat) {
        exam::Entry begun;
        begun.kind = "begun", begun.at = now - 600'000, begun.sitting = school::newId(), begun.exam = "ex1";
        begun.pack = pack.hash, begun.candidate = exam::candidateHash("ex1", person), begun.invigilator = "t1";
        begun.confirmation = confirmation;
        tell(begun);
        exam::Entry finished;
        finished.kind = "finished", finished.at = now - 60'000, finished.sitting = begun.sitting;
        const std::vector<std::byte> bytes = core::readFile(file);
        const std::string sha256 = school::sha256Of(file);
        finished.files = {{sha256, assessment::workHash(file), static_cast<std::int64_t>(bytes.size())}};
        tell(finished);
        const school::Upload upload{station, sha256, bytes.size()};
        if (const std::uint64_t have = books.received(upload, now); have < bytes.size())
            (void)books.append(upload, have, std::span(bytes).subspan(have), now);
        sittings.push_back(begun.sitting);
    }
    return sittings;
}

inline void decideExam(Books& books, const std::string& sitting, const char* kind, const char* person,
                       const char* verdict, const char* words) {
    school::ExamBooks(books).add(
        school::ExamDecision{school::newId(), sitting, person, kind, verdict, 0, 0, words, systemClock()()},
        {person, systemClock()()});
}

}  // namespace handpiece::school_server
