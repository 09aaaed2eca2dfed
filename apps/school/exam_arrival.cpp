// SPDX-License-Identifier: Apache-2.0
#include "school/exam_arrival.h"

#include <fmt/format.h>

#include <algorithm>

#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/error.h"
#include "handpiece/school/exam/lines.h"
#include "handpiece/school/people/secret.h"

namespace handpiece::school_server {
namespace {

using school::Books;
using school::ExamBooks;
using school::Milliseconds;

/// A station says nothing of a score: this rubric is none.
constexpr const char* kNoRubric = "0000000000000000";

core::Error notHere(const std::string& what, const std::string& which) {
    return core::Error(fmt::format("there is no {} '{}'", what, which), "the school's books",
                       "this work belongs to another school, or its books were put back from a backup")
        .as("books-unknown", {what, which});
}

std::vector<exam::Entry> parsed(const std::vector<school::ExamEntry>& entries) {
    std::vector<exam::Entry> all;
    for (const school::ExamEntry& one : entries)
        all.push_back(exam::entryFrom(one.text, "the books"));
    return all;
}

exam::Pack packOf(ExamBooks& exams, const school::ExamSitting& sitting) {
    const auto pack = exams.packByHash(sitting.pack);
    if (!pack) throw notHere("exam's pack", sitting.pack);
    return exam::packFrom(pack->text, "the books");
}

school::PushedAttempt attemptOf(const Books& books, const school::ExamSitting& sitting, const exam::Pack& pack,
                                const exam::Entry& finished, Milliseconds now) {
    school::PushedAttempt p;
    school::Attempt& a = p.attempt;
    a.id = sitting.id;
    const auto exercise = books.pack(pack.exercise);
    a.exercise = exercise ? exercise->exercise : pack.exercise;
    a.exerciseHash = pack.exercise, a.rubricHash = kNoRubric;
    for (const exam::HandedOver& one : finished.files)
        a.sessionHashes.push_back(one.work), p.files.push_back(one.file);
    a.began = sitting.began, a.finished = finished.at;
    a.workedS = 1e-3 * static_cast<double>(finished.at - sitting.began);
    a.limitS = 60.0 * static_cast<double>(pack.minutes);
    a.passed = "teacher", a.result = "{}";
    p.station = sitting.station, p.person = sitting.person, p.assignment = sitting.exam;
    p.received = now;
    return p;
}

}  // namespace

exam::SigningKey examKey(const std::filesystem::path& data) {
    return exam::keptSigningKey(data / "exam.key");
}

school::ExamPack signExam(Books& books, const std::string& id, const exam::SigningKey& key, const school::Act& act) {
    ExamBooks exams(books);
    const auto assignment = books.assignment(id);
    const auto settings = exams.settings(id);
    if (!assignment || !settings) throw notHere("exam", id);
    const auto exercise = books.pack(assignment->pack);
    if (!exercise) throw notHere("exercise", assignment->pack);
    exam::Pack p;
    p.exam = id, p.title = assignment->title, p.exercise = exercise->hash, p.file = exercise->file;
    p.bytes = static_cast<std::int64_t>(std::filesystem::file_size(books.files().path(exercise->file)));
    p.rubric = assignment->rubric, p.rubricFormat = exam::kRubricFormat, p.engine = core::kEngineRevision;
    p.opens = assignment->opens, p.closes = assignment->closes, p.minutes = settings->minutes;
    p.locked = exam::partsOf(settings->locked, ' ');
    const std::vector<school::ExamConfirmation> confirmations = exams.confirmations(id);
    for (const school::ExamCandidate& c : exams.candidates(id)) {
        exam::Candidate one{c.code, c.extraPercent, c.pauseMinutes, exam::partsOf(c.helps, ' ')};
        for (const school::ExamConfirmation& code : confirmations)
            if (code.person == c.person) one.confirmations.push_back(code.hash);
        // The newest sheet holds.
        if (one.confirmations.size() > exam::kConfirmations)
            one.confirmations.erase(one.confirmations.begin(), one.confirmations.end() - exam::kConfirmations);
        if (one.confirmations.empty())
            throw core::Error("there are no confirmation codes for candidate " + c.person, id,
                              "make the invigilators' sheet: handpiece school exam sheet")
                .as("exam-empty", {id});
        p.candidates.push_back(std::move(one));
    }
    for (const school::ExamInvigilator& i : exams.invigilators(id))
        p.invigilators.push_back({i.person});
    if (p.candidates.empty() || p.invigilators.empty())
        throw core::Error(p.candidates.empty() ? "this exam has no candidates" : "this exam has no invigilator", id,
                          "add them: handpiece school exam candidates, handpiece school exam invigilator")
            .as("exam-empty", {id});
    const std::string opening = exams.openingCode(id, school::newStationCode(), act);
    const auto newest = exams.newestPack(id);
    if (newest) {
        p.version = newest->version;
        // Its hash is another each time: of the same code it stays as it was.
        if (const exam::Pack before = exam::packFrom(newest->text, "the books");
            school::isPassword(before.seal, opening))
            p.seal = before.seal;
        if (exam::toText(p) == newest->text && newest->key == key.open) return *newest;
        ++p.version;
    }
    if (p.seal.empty()) p.seal = school::hashOfPassword(opening);
    school::ExamPack made;
    made.exam = id, made.version = p.version, made.text = exam::toText(p), made.hash = school::sha256(made.text);
    const exam::Signature signature = exam::signatureOf(made.text, key);
    made.key = signature.key, made.signature = signature.value, made.made = act.at;
    (void)exams.add(made, act);
    return made;
}

namespace {
constexpr const char* kBroken = "exam chain broken";

/// The number of the code that an invigilator typed; negative where another station had it before. Whoever has the
/// station's key has none that is good.
std::int64_t confirmationOf(ExamBooks& exams, const exam::Entry& e, const std::string& person) {
    bool isUsedHere = false, isUsedThere = false;
    for (const school::ExamSitting& one : exams.sittingsOf(e.exam))
        if (one.person == person)
            for (const school::ExamEntry& kept : exams.entriesOf(one.id)) {
                if (kept.kind != "begun" && kept.kind != "given-up") continue;
                if (exam::entryFrom(kept.text, "the books").confirmation != e.confirmation) continue;
                // The entry itself may have come before.
                if (kept.station == e.station && kept.number == e.number) continue;
                (kept.station == e.station ? isUsedHere : isUsedThere) = true;
            }
    for (const school::ExamConfirmation& one : exams.confirmations(e.exam))
        if (!isUsedHere && one.person == person && school::isPassword(one.hash, e.confirmation))
            return isUsedThere ? -one.number : one.number;
    throw core::Error("no invigilator of this exam has confirmed this candidate", "station " + e.station,
                      "an invigilator types a code of their sheet at the station")
        .as("exam-invigilator", {e.invigilator});
}
bool takeSigned(Books& books, const std::string& station, std::string_view joined, Milliseconds now) {
    ExamBooks exams(books);
    const exam::Signed entry = exam::parted(joined, "station " + station);
    const std::string key = exams.keyOf(station);
    const ExamBooks::End end = exams.endOf(station);
    exam::requireSigned(entry.text, entry.signature, key, "the entry", "station " + station);
    exam::Entry e = exam::entryFrom(entry.text, "station " + station);
    // One that is there already is held against it by the books.
    if (e.number > end.number)
        e = exam::nextOf({end.number, end.hash.empty() ? exam::kNoEntry : end.hash}, entry, station, key);
    school::ExamEntry kept{station,   e.number,   exam::hashOfEntry(entry.text), e.kind,
                           e.sitting, entry.text, entry.signature.key,           entry.signature.value,
                           e.at,      now};
    if (e.kind == "begun") {
        const auto pack = exams.packByHash(e.pack);
        if (!pack || pack->exam != e.exam) throw notHere("exam's pack", e.pack);
        const auto person = exams.personOfCode(e.exam, e.candidate);
        if (!person) throw notHere("candidate", e.candidate);
        const std::int64_t confirmation =
            exam::packFrom(pack->text, "the books").format == 1 ? 0 : confirmationOf(exams, e, *person);
        const school::ExamSitting begins{e.sitting,     e.exam, station,  *person, e.candidate, e.pack,
                                         e.invigilator, e.at,   e.number, "begun", 0,           confirmation};
        return exams.add(kept, &begins, nullptr);
    }
    if (e.kind == "finished") {
        const auto sitting = exams.sitting(e.sitting);
        if (!sitting || sitting->station != station) throw notHere("sitting", e.sitting);
        const school::PushedAttempt attempt = attemptOf(books, *sitting, packOf(exams, *sitting), e, now);
        return exams.add(kept, nullptr, &attempt);
    }
    if (e.kind == "given-up") {
        const auto sitting = exams.sitting(e.sitting);
        if (!sitting || sitting->station != station) throw notHere("sitting", e.sitting);
        e.exam = sitting->exam;
        if (packOf(exams, *sitting).format != 1) (void)confirmationOf(exams, e, sitting->person);
    }
    return exams.add(kept, nullptr, nullptr);
}
}  // namespace

bool takeEntry(Books& books, const std::string& station, std::string_view joined, Milliseconds now) {
    try {
        return takeSigned(books, station, joined, now);
    } catch (const core::Error& e) {
        // Signed by the station, and not what it said before: stays for whoever looks at its exams. Once an hour.
        if (e.id() == "exam-chain" || e.id() == "books-changed") {
            Milliseconds last = 0;
            for (const school::AuditLine& line : books.audit(0, 10'000, station))
                if (line.what == kBroken) last = line.at;
            if (now - last > 3'600'000) books.note({"station " + station, now}, kBroken, station);
        }
        throw;
    }
}

std::optional<sandboxed::ExamNotes> examNotes(Books& books, const school::PushedAttempt& attempt) {
    ExamBooks exams(books);
    const auto sitting = exams.sitting(attempt.attempt.id);
    if (!sitting) return {};
    const exam::Pack pack = packOf(exams, *sitting);
    sandboxed::ExamNotes notes{pack.locked, {}};
    for (const exam::Candidate& one : pack.candidates)
        if (one.code == sitting->candidate) notes.locked = exam::lockedFor(pack, one, {});
    for (school::ExamEntry& one : exams.entriesOf(sitting->id))
        notes.entries.push_back(std::move(one.text));
    return notes;
}

std::vector<std::string> doubtsOf(Books& books, const school::ExamSitting& sitting) {
    ExamBooks exams(books);
    const std::vector<school::ExamEntry> entries = exams.entriesOf(sitting.id);
    std::vector<Milliseconds> received;
    for (const school::ExamEntry& one : entries)
        received.push_back(one.received);
    std::vector<std::string> doubts = exam::doubtsOf(packOf(exams, sitting), parsed(entries), received);
    if (sitting.confirmation == 0)
        doubts.push_back("that an invigilator confirmed the identity is its station's word: its pack is of before");
    if (sitting.confirmation < 0)
        doubts.push_back("the code that confirmed the identity had been used for another beginning");
    for (const Books::Alike& one : books.alike(sitting.id))
        doubts.push_back(fmt::format("{} % of its motion is that of {}'s work, {}", one.percent, one.person,
                                     one.attempt.substr(0, 8)));
    for (std::string& one : exams.doubtsOf(sitting.id))
        doubts.push_back(std::move(one));
    for (const school::AuditLine& line : books.audit(0, 10'000, sitting.station))
        if (line.what == kBroken)
            doubts.push_back("what its station noted was changed or put back from a copy, " + exam::clockOf(line.at));
    std::size_t others = 0;
    for (const school::ExamSitting& one : exams.sittingsOf(sitting.exam))
        others += one.person == sitting.person && one.station != sitting.station ? 1 : 0;
    if (others > 0) doubts.push_back(fmt::format("this candidate has begun {} times at other stations, too", others));
    return doubts;
}

exam::Signed receiptOf(Books& books, const school::ExamSitting& sitting, const exam::SigningKey& key,
                       Milliseconds now) {
    exam::Receipt r;
    r.sitting = sitting.id, r.exam = sitting.exam, r.candidate = sitting.candidate, r.station = sitting.station;
    r.began = sitting.began, r.finished = sitting.ended, r.made = now, r.state = "waiting";
    if (const auto attempt = books.attempt(sitting.id)) {
        r.received = attempt->received, r.files = attempt->files;
        if (const auto scores = books.scoresOf(sitting.id); !scores.empty()) {
            r.state = scores.back().state;
            r.stateHash = scores.back().stateHash;
        }
    }
    r.verdict = school::verdictOf(ExamBooks(books).decisionsOf(sitting.id));
    const std::string text = exam::toText(r);
    return {text, exam::signatureOf(text, key)};
}

std::string receiptFor(Books& books, const std::string& station, const std::string& id, const exam::SigningKey& key,
                       Milliseconds now) {
    const auto sitting = ExamBooks(books).sitting(id);
    const auto attempt = sitting && sitting->station == station ? books.attempt(id) : std::nullopt;
    if (!attempt) throw notHere("work of sitting", id);
    for (const std::string& missing : books.missingFiles(station))
        if (std::find(attempt->files.begin(), attempt->files.end(), missing) != attempt->files.end())
            throw notHere("recording of sitting", id);
    return exam::joined(receiptOf(books, *sitting, key, now));
}

}  // namespace handpiece::school_server
