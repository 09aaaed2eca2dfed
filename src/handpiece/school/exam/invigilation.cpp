// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/exam/invigilation.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/exam/lines.h"
#include "handpiece/school/exam/seal.h"
#include "handpiece/school/people/secret.h"
#include "handpiece/school/store/content_files.h"

namespace handpiece::exam {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kStationKind = "handpiece exam station 1";
constexpr std::size_t kMostPackBytes = 1 << 20, kMostEntryBytes = 1 << 16;

std::string textOf(const fs::path& file, std::size_t most) {
    const std::vector<std::byte> bytes = core::readFile(file, most);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

fs::path packFolder(const fs::path& folder, const std::string& exam) {
    return folder / "packs" / exam;
}
fs::path exerciseFile(const fs::path& folder, const std::string& sha256) {
    return folder / "exercises" / (sha256 + ".handpiece");
}
/// Each exam's own: two of one exercise have two codes.
fs::path sealedFile(const fs::path& folder, const Pack& pack) {
    return folder / "exercises" / (pack.exam + "-" + pack.file + ".sealed");
}
fs::path entryFile(const fs::path& folder, std::int64_t number) {
    return folder / "chain" / fmt::format("{:010}.txt", number);
}

core::Error otherExercise(const std::string& where) {
    return core::Error("the exam's exercise is not the one that its pack names", where,
                       "fetch it again from the school's server")
        .as("exam-exercise-other");
}
/// Wrong codes are counted for each who types them, and for each account that they come from.
std::string guesserOf(const std::string& what, const std::string& from) {
    return from.empty() ? what : what + " at " + from;
}

}  // namespace

StationIdentity stationIn(const fs::path& folder) {
    const fs::path file = folder / "station.txt";
    if (!core::isThere(file))
        throw core::Error("exams are not set up at this station", file.string(),
                          "as the service's user: handpiece school exam enrol SERVER CODE --service FOLDER")
            .as("not-enrolled");
    const std::string text = textOf(file, 4096);
    LineReader lines(text, kStationKind, file.string());
    StationIdentity identity;
    identity.server = lines.text("server", 1000), identity.station = lines.hex("station", 32);
    identity.key = lines.hex("key", 64), identity.serverKey = lines.hex("server_key", 64);
    lines.end();
    return identity;
}

void keepStation(const StationIdentity& s, const fs::path& folder) {
    LineWriter lines(kStationKind);
    lines.add("server", s.server).add("station", s.station).add("key", s.key).add("server_key", s.serverKey);
    core::prepareOutputFolder(folder, true);
    core::writeFile(folder / "station.txt", lines.text(), {.ownerOnly = true});
}

bool hasExercise(const fs::path& folder, const Pack& pack) {
    return core::isThere(exerciseFile(folder, pack.file)) || core::isThere(sealedFile(folder, pack));
}

void openExercise(const fs::path& folder, const Pack& pack, const std::string& typedCode) {
    const std::vector<std::byte> bytes = unsealed(core::readFile(sealedFile(folder, pack)), pack.exam, typedCode);
    if (school::sha256({reinterpret_cast<const char*>(bytes.data()), bytes.size()}) != pack.file)
        throw otherExercise(pack.exam);
    core::writeFile(exerciseFile(folder, pack.file), bytes, {.ownerOnly = true});
}

Pack installPack(const fs::path& folder, const Signed& signedPack, const fs::path& exercise) {
    const StationIdentity station = stationIn(folder);
    Pack pack = openedPack(signedPack, station.serverKey, "the exam's pack");
    const fs::path in = packFolder(folder, pack.exam);
    if (core::isThere(in / "pack.txt")) {
        const Pack there = packFrom(textOf(in / "pack.txt", kMostPackBytes), in.string());
        if (there.version > pack.version)
            throw core::Error(
                fmt::format("this pack is of version {}, and version {} is here already", pack.version, there.version),
                pack.exam, "nothing is to be done: the newer one holds")
                .as("exam-older", {std::to_string(pack.version), std::to_string(there.version)});
    }
    if (!exercise.empty()) {
        const bool isSealed = pack.format != 1;
        // What is sealed is looked at when it is opened.
        if (!isSealed && school::sha256Of(exercise) != pack.file) throw otherExercise(exercise.string());
        core::prepareOutputFolder(folder / "exercises", true);
        fs::rename(exercise, isSealed ? sealedFile(folder, pack) : exerciseFile(folder, pack.file));
    } else if (!hasExercise(folder, pack)) {
        throw core::Error("the exam's exercise is not here", pack.exam, "fetch it from the school's server")
            .as("exam-exercise-other");
    }
    core::prepareOutputFolder(folder / "packs", true);
    core::prepareOutputFolder(in, true);
    // The text last: a pack whose signature is that of another text is none, and is fetched again.
    core::writeFile(in / "pack.sig", toText(signedPack.signature), {.ownerOnly = true});
    core::writeFile(in / "pack.txt", signedPack.text, {.ownerOnly = true});
    return pack;
}

std::vector<Installed> packsIn(const fs::path& folder, std::vector<std::string>& problems) {
    const StationIdentity station = stationIn(folder);
    std::vector<fs::path> folders;
    std::error_code none;
    for (fs::directory_iterator entry(folder / "packs", none), end; !none && entry != end; entry.increment(none))
        folders.push_back(entry->path());
    std::sort(folders.begin(), folders.end());
    std::vector<Installed> all;
    for (const fs::path& in : folders)
        try {
            Installed one;
            one.text.text = textOf(in / "pack.txt", kMostPackBytes);
            one.text.signature = signatureFrom(textOf(in / "pack.sig", 4096), (in / "pack.sig").string());
            one.pack = openedPack(one.text, station.serverKey, (in / "pack.txt").string());
            one.exercise = exerciseFile(folder, one.pack.file);
            one.isSealed =
                one.pack.format != 1 && !core::isThere(one.exercise) && core::isThere(sealedFile(folder, one.pack));
            // What was written there since is no exam's exercise.
            if (!one.isSealed && (!core::isThere(one.exercise) || school::sha256Of(one.exercise) != one.pack.file))
                throw otherExercise(one.exercise.string());
            all.push_back(std::move(one));
        } catch (const core::Error& e) {
            problems.emplace_back(e.what());
        }
    return all;
}

Invigilation::Invigilation(fs::path folder, Milliseconds now)
    : folder_(std::move(folder)), identity_(stationIn(folder_)) {
    key_ = keptSigningKey(folder_ / "station.key");
    core::prepareOutputFolder(folder_ / "chain", true);
    for (std::int64_t next = 1; core::isThere(entryFile(folder_, next)); ++next) {
        const fs::path file = entryFile(folder_, next);
        const Signed entry = parted(textOf(file, kMostEntryBytes), file.string());
        const Entry read = nextOf(end_, entry, identity_.station, key_.open);
        end_ = {next, hashOfEntry(entry.text)};
        follow(read);
    }
    Entry started;
    started.at = now, started.kind = "started";
    (void)add(std::move(started));
}

Signed Invigilation::add(Entry entry) {
    entry.station = identity_.station, entry.number = end_.number + 1, entry.previous = end_.hash;
    const std::string text = toText(entry);
    Signed made{text, signatureOf(text, key_)};
    if (core::isThere(entryFile(folder_, entry.number)))
        throw core::Error("another service works with these exams", folder_.string(), "one is enough: end this one")
            .as("exam-busy");
    core::writeFile(entryFile(folder_, entry.number), joined(made), {.ownerOnly = true});
    end_ = {entry.number, hashOfEntry(text)};
    follow(entry);
    return made;
}

void Invigilation::follow(const Entry& e) {
    if (e.kind == "begun") {
        begun_.emplace_back(e.exam, e.candidate);
        if (!e.confirmation.empty()) spent_.emplace(e.candidate, e.confirmation);
        Sitting sitting;
        sitting.id = e.sitting, sitting.began = e.at, sitting.again = e.again;
        std::vector<std::string> problems;
        for (Installed& one : packsIn(folder_, problems))
            if (one.pack.exam == e.exam) {
                for (const Candidate& c : one.pack.candidates)
                    if (c.code == e.candidate) sitting.candidate = c;
                sitting.deadline = deadlineOf(one.pack, sitting.candidate, e.at);
                sitting.exam = std::move(one);
            }
        sitting_ = std::move(sitting);
    } else if (e.kind == "finished" || e.kind == "given-up") {
        if (!e.confirmation.empty() && sitting_) spent_.emplace(sitting_->candidate.code, e.confirmation);
        sitting_.reset();
    }
}

void Invigilation::requirePatience(const std::string& who, Milliseconds now) {
    if (const std::int64_t wait = guesses_.waitMs(who, now); wait > 0)
        throw core::Error(fmt::format("too many wrong confirmation codes: wait {} s", (wait + 999) / 1000), who,
                          "then try again")
            .as("exam-wait", {std::to_string((wait + 999) / 1000)});
    guesses_.failed(who, now);
}

std::string Invigilation::requireInvigilator(const Pack& pack, const Candidate& candidate, const std::string& person,
                                             const std::string& code, Milliseconds now, const std::string& from) {
    const std::string guesser = guesserOf(person, from);
    requirePatience(guesser, now);
    const std::string typed = school::typedStationCode(code);
    const auto found = std::find_if(pack.invigilators.begin(), pack.invigilators.end(),
                                    [&](const Invigilator& one) { return one.person == person; });
    const auto is = [&](const std::string& hash) { return school::isPassword(hash, typed); };
    const bool isOfPack =
        found != pack.invigilators.end() &&
        (pack.format == 1 ? is(found->pin)
                          : std::any_of(candidate.confirmations.begin(), candidate.confirmations.end(), is));
    if (!isOfPack)
        throw core::Error("nobody who may confirm this candidate's identity has this code", person,
                          "an invigilator of this exam types their own code, and a confirmation code that stands "
                          "beside this candidate on their sheet")
            .as("exam-invigilator", {person});
    guesses_.succeeded(guesser);
    if (pack.format == 1) return {};
    if (spent_.contains({candidate.code, typed}))
        throw core::Error("this confirmation code has been used", person,
                          "type the next one that stands beside this candidate on the sheet")
            .as("exam-confirmation-used");
    return typed;
}

void Invigilation::open(const std::string& typedCode, Milliseconds now, const std::string& from) {
    const std::string guesser = guesserOf("the exercise's seal", from);
    requirePatience(guesser, now);
    const std::string typed = school::typedStationCode(typedCode);
    std::vector<std::string> problems;
    for (const Installed& one : packsIn(folder_, problems))
        if (one.pack.format != 1 && school::isPassword(one.pack.seal, typed)) {
            guesses_.succeeded(guesser);
            if (one.isSealed) openExercise(folder_, one.pack, typed);
            return;
        }
    throw core::Error("this code opens none of the exams at this station", folder_.string(),
                      "type it as it stands on the invigilator's sheet of this exam")
        .as("exam-seal");
}

Sitting Invigilation::look(const std::string& candidateCode, std::int64_t rubricFormat, Milliseconds now) const {
    if (sitting_)
        throw core::Error("somebody is at an exam at this station", sitting_->id,
                          "hand that work over first, or let an invigilator give it up")
            .as("exam-running", {sitting_->id});
    std::vector<std::string> problems;
    std::vector<Installed> all = packsIn(folder_, problems);
    Sitting sitting;
    bool isKnown = false;
    for (Installed& one : all)
        for (const Candidate& c : one.pack.candidates)
            if (c.code == candidateHash(one.pack.exam, candidateCode)) {
                sitting.candidate = c, isKnown = true;
                sitting.exam = one;
            }
    if (!isKnown)
        throw core::Error(all.empty() && !problems.empty()
                              ? "none of the exams at this station can be used: " + problems.front()
                              : std::string("no exam at this station knows a candidate of this code"),
                          folder_.string(),
                          "type it as it stands on the slip; who came later needs a newer pack: handpiece school exam "
                          "fetch")
            .as("exam-candidate-unknown", {""});
    const Pack& pack = sitting.exam.pack;
    requireFitting(pack, rubricFormat, core::kEngineRevision);
    requireOpen(pack, now);
    if (sitting.exam.isSealed)
        throw core::Error("this exam's exercise is sealed still", pack.exam,
                          "it opens by itself where the school's server can be reached; else by the opening code on "
                          "the invigilator's sheet")
            .as("exam-sealed");
    sitting.began = now, sitting.deadline = deadlineOf(pack, sitting.candidate, now);
    sitting.again = std::count(begun_.begin(), begun_.end(), std::pair(pack.exam, sitting.candidate.code));
    return sitting;
}

const Sitting& Invigilation::begin(const std::string& candidateCode, const std::string& invigilator,
                                   const std::string& code, std::int64_t rubricFormat, Milliseconds now,
                                   const std::string& from) {
    const Sitting sitting = look(candidateCode, rubricFormat, now);
    Entry e;
    e.confirmation = requireInvigilator(sitting.exam.pack, sitting.candidate, invigilator, code, now, from);
    e.at = now, e.kind = "begun", e.sitting = school::newId();
    e.exam = sitting.exam.pack.exam, e.pack = school::sha256(sitting.exam.text.text);
    e.candidate = sitting.candidate.code, e.invigilator = invigilator, e.again = sitting.again;
    (void)add(std::move(e));
    return *sitting_;
}

const Sitting& Invigilation::current(const std::string& id) const {
    if (!sitting_ || sitting_->id != id)
        throw core::Error("nobody is at this exam at this station now", id.substr(0, 40),
                          "begin it: handpiece school exam begin")
            .as("exam-none", {id.substr(0, 40)});
    return *sitting_;
}

void Invigilation::checkpoint(const std::string& id, std::int64_t part, std::int64_t ticks, const std::string& inputs,
                              Milliseconds now) {
    (void)current(id);
    Entry e;
    e.at = now, e.kind = "checkpoint", e.sitting = id, e.part = part, e.ticks = ticks, e.inputs = inputs;
    // Only what can be read is signed.
    e.station = identity_.station, e.number = 1, e.previous = kNoEntry;
    (void)entryFrom(toText(e), "checkpoint");
    (void)add(std::move(e));
}

fs::path Invigilation::placeFor(const std::string& id, std::int64_t part) const {
    (void)current(id);
    if (part < 1 || part > 100)
        throw core::Error("there is no such recording", std::to_string(part), "count them from 1")
            .as("exam-damaged", {"part", ""});
    core::prepareOutputFolder(folder_ / "sessions", true);
    core::prepareOutputFolder(folder_ / "sessions" / id, true);
    return folder_ / "sessions" / id / fmt::format("{:03}.h5", part);
}

Signed Invigilation::finish(const std::string& id, const std::vector<std::string>& works, Milliseconds now) {
    (void)current(id);
    Entry e;
    e.at = now, e.kind = "finished", e.sitting = id;
    for (std::size_t i = 0; i < works.size(); ++i) {
        const fs::path file = placeFor(id, static_cast<std::int64_t>(i + 1));
        if (!core::isThere(file))
            throw core::Error(fmt::format("recording {} has not been handed over", i + 1), file.string(),
                              "hand all of them over, in their order")
                .as("exam-damaged", {"file", ""});
        e.files.push_back({school::sha256Of(file), works[i], static_cast<std::int64_t>(fs::file_size(file))});
    }
    e.station = identity_.station, e.number = 1, e.previous = kNoEntry;
    (void)entryFrom(toText(e), "finished");
    return add(std::move(e));
}

void Invigilation::giveUp(const std::string& id, const std::string& invigilator, const std::string& code,
                          Milliseconds now, const std::string& from) {
    Entry e;
    e.confirmation = requireInvigilator(current(id).exam.pack, current(id).candidate, invigilator, code, now, from);
    e.at = now, e.kind = "given-up", e.sitting = id, e.invigilator = invigilator;
    (void)add(std::move(e));
}

std::vector<Signed> Invigilation::entriesAfter(std::int64_t number, std::size_t most) const {
    std::vector<Signed> all;
    for (std::int64_t next = number + 1; next <= end_.number && all.size() < most; ++next)
        all.push_back(parted(textOf(entryFile(folder_, next), kMostEntryBytes), entryFile(folder_, next).string()));
    return all;
}

Signed Invigilation::endOf(const std::string& sitting) const {
    for (std::int64_t number = end_.number; number > 0; --number) {
        const fs::path file = entryFile(folder_, number);
        Signed entry = parted(textOf(file, kMostEntryBytes), file.string());
        const Entry read = entryFrom(entry.text, file.string());
        if (read.sitting != sitting) continue;
        if (read.kind != "finished" && read.kind != "given-up") break;
        return entry;
    }
    throw core::Error("no such exam has ended at this station", sitting.substr(0, 40),
                      "ask at the station that held it")
        .as("exam-none", {sitting.substr(0, 40)});
}

fs::path Invigilation::fileOf(const std::string& sitting, const std::string& sha256) const {
    if (!school::isHex(sitting, 32)) return {};
    std::error_code none;
    for (fs::directory_iterator entry(folder_ / "sessions" / sitting, none), end; !none && entry != end;
         entry.increment(none))
        if (entry->path().extension() == ".h5" && school::sha256Of(entry->path()) == sha256) return entry->path();
    return {};
}

}  // namespace handpiece::exam
