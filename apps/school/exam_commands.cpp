// SPDX-License-Identifier: Apache-2.0
// handpiece school exam: made and signed on the server's machine, held by a station's service, sat by a student.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <atomic>
#include <cstdio>
#include <ctime>
#include <memory>
#include <thread>

#include "handpiece/app/proving/exam_check.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/exercise.h"
#include "handpiece/school/exam/lines.h"
#include "handpiece/school/people/secret.h"
#include "handpiece/school/store/books_accounts.h"
#include "school/commands.h"
#include "school/exam_arrival.h"
#include "school/exam_desk.h"
#include "school/exam_line.h"
#include "school/exam_service.h"
#include "school/exam_station.h"
#include "school/line.h"
#include "school/school_settings.h"
#include "school/server.h"
#include "school/service_manager.h"
#include "school/typed_secret.h"
#include "studies/progress_bar.h"

namespace handpiece::school_cli {
namespace {

namespace fs = std::filesystem;
using school::Books;
using school::ExamBooks;
using school::Milliseconds;

struct ExamOptions {
    std::string data, database, schoolClass, exercise, title, opens, exam, person, station;
    double hours = 2.0;
    int minutes = 30, extra = 0, pause = 0;
    std::vector<std::string> locked, allowed, recordings;
    std::string server, code, service = "/var/lib/handpiece-exam", socket = school_exam::kSocket;
    std::string candidate, invigilator, out, receipt, key;
    double everyS = 30.0;
    bool isNew = false;
};

Milliseconds momentIn(const std::string& text) {
    std::tm time{};
    char zone = 0, rest = 0;
    const int read = std::sscanf(text.c_str(), "%4d-%2d-%2dT%2d:%2d%c%c", &time.tm_year, &time.tm_mon, &time.tm_mday,
                                 &time.tm_hour, &time.tm_min, &zone, &rest);
    if (read != 6 || zone != 'Z' || time.tm_year < 1970 || time.tm_mon < 1 || time.tm_mon > 12 || time.tm_mday < 1 ||
        time.tm_mday > 31 || time.tm_hour > 23 || time.tm_min > 59)
        throw core::Error(fmt::format("\"{}\" is no time", text), "--opens", "write it in UTC, as 2026-12-01T09:00Z");
    time.tm_year -= 1900, time.tm_mon -= 1;
    return 1000 * static_cast<Milliseconds>(timegm(&time));
}

void makeNew(const ExamOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    const school::Act act = now();
    const auto pack = books.pack(o.exercise);
    if (!pack) throw core::Error("the school has no such exercise", o.exercise, "add it: handpiece school exercise");
    school::Assignment made;
    made.id = school::newId(), made.schoolClass = o.schoolClass, made.pack = pack->hash, made.rubric = pack->rubric;
    made.title = o.title.empty() ? pack->title : o.title, made.kind = "exam";
    made.opens = momentIn(o.opens), made.closes = made.opens + static_cast<Milliseconds>(o.hours * 3.6e6);
    books.add(made, act);
    ExamBooks(books).set(school::ExamSettings{made.id, o.minutes, fmt::format("{}", fmt::join(o.locked, " "))}, act);
    fmt::print("{}\n", made.id);
}

/// Their codes are told once: the books keep hashes.
void setCandidates(const ExamOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    ExamBooks exams(books);
    const auto exam = books.assignment(o.exam);
    if (!exam) throw core::Error("there is no such exam", o.exam, "make it: handpiece school exam new");
    const std::vector<school::ExamCandidate> there = exams.candidates(o.exam);
    const auto set = [&](const std::string& person, const std::string& code, std::string hash) {
        exams.set(school::ExamCandidate{o.exam, person, std::move(hash), o.extra, o.pause,
                                        fmt::format("{}", fmt::join(o.allowed, " "))},
                  now());
        fmt::print("{} {}\n", person, code);
    };
    const auto known = [&](const std::string& person) {
        return std::find_if(there.begin(), there.end(), [&](const auto& c) { return c.person == person; });
    };
    if (!o.person.empty()) {
        if (const auto found = known(o.person); found != there.end() && !o.isNew)
            return set(o.person, "(the code of before)", found->code);
        const std::string code = school::newStationCode();
        return set(o.person, code, exam::candidateHash(o.exam, code));
    }
    for (const school::Enrolment& one : books.enrolments(exam->schoolClass))
        if (const auto person = books.person(one.person);
            person && person->erased == 0 && one.role == "student" && known(one.person) == there.end()) {
            const std::string code = school::newStationCode();
            set(one.person, code, exam::candidateHash(o.exam, code));
        }
}

/// Since sheets there are codes for each candidate, and none of an invigilator's own.
constexpr const char* kNoPin = "-";

void setInvigilator(const ExamOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    ExamBooks(books).set(school::ExamInvigilator{o.exam, o.person, kNoPin}, now());
    fmt::print("{} may confirm who sits there\n", o.person);
}

/// On paper, for invigilators' eyes: the books keep hashes.
void printSheet(const ExamOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    ExamBooks exams(books);
    if (!exams.settings(o.exam))
        throw core::Error("there is no such exam", o.exam, "make it: handpiece school exam new");
    const std::vector<school::ExamConfirmation> there = exams.confirmations(o.exam);
    for (const school::ExamCandidate& one : exams.candidates(o.exam)) {
        if (!o.person.empty() && one.person != o.person) continue;
        const bool isThere =
            std::any_of(there.begin(), there.end(), [&](const auto& c) { return c.person == one.person; });
        if (isThere && o.person.empty()) {
            fmt::print("{} (the codes of before)\n", one.person);
            continue;
        }
        std::string line = one.person;
        for (std::size_t i = 0; i < exam::kConfirmations; ++i) {
            const std::string code = school::newStationCode();
            exams.add(school::ExamConfirmation{o.exam, one.person, 0, school::hashOfPassword(code)}, now());
            line += " " + code;
        }
        fmt::print("{}\n", line);
    }
    fmt::print("opening {}\n", exams.openingCode(o.exam, school::newStationCode(), now()));
}

void openHere(const ExamOptions& o) {
    school_exam::ExamClient(o.socket).open(typedSecret("opening code"));
    fmt::print("open\n");
}

void releaseStation(const ExamOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    std::vector<school::Station> found;
    for (school::Station& one : school::BooksAccounts(books).stations())
        if (one.kind == "exam" && one.revoked == 0 && (one.id == o.station || one.name == o.station))
            found.push_back(std::move(one));
    if (found.size() != 1)
        throw core::Error(found.empty() ? "no station is enrolled for exams by that id or name"
                                        : "several stations for exams have that name",
                          o.station, "see the office's page of stations, and give its id");
    books.releaseForExams(found.front().id, now());
    fmt::print("{} may hold exams\n", found.front().name);
}

void sign(const ExamOptions& o) {
    const SchoolSettings place = placeOfBooks(o.data, o.database);
    Books books(place.data, place.database);
    const school::ExamPack pack = school_server::signExam(books, o.exam, school_server::examKey(place.data), now());
    fmt::print("version {}, signed by {}\n", pack.version, pack.key);
}

void serve(const ExamOptions& o) {
    school_exam::ExamServiceSettings settings{o.service, o.socket};
    school_exam::ExamService service(settings);
    listenForEnd();
    tellManager("READY=1");
    fmt::print("{} (Ctrl-C ends it)\n", o.socket);
    (void)std::fflush(stdout);
    std::atomic<bool> ended{false};
    std::thread ending([&] {
        waitForEnd(ended);
        tellManager("STOPPING=1");
        service.stop();
    });
    service.run();
    ended = true;
    ending.join();
}

void fetch(const ExamOptions& o) {
    const school_exam::Fetched fetched = school_exam::fetchExams(o.service);
    for (const exam::Pack& one : fetched.packs)
        fmt::print("{} version {}: {}, {} to {}, {} candidates\n", one.exam, one.version, one.title,
                   exam::clockOf(one.opens), exam::clockOf(one.closes), one.candidates.size());
    for (const std::string& problem : fetched.problems)
        std::fprintf(stderr, "%s\n", problem.c_str());
    if (!fetched.problems.empty())
        throw core::Error(fmt::format("{} exams could not be fetched", fetched.problems.size()), o.service);
}

void tell(const school_exam::Desk& d) {
    if (d.sitting.empty()) {
        fmt::print("nobody is at an exam here\n");
    } else {
        fmt::print("{}: {}\nbegun {}, to be handed over by {} ({} min left)\nlocked: {}\n", d.title, d.sitting,
                   exam::clockOf(d.began), exam::clockOf(d.deadline),
                   std::max<Milliseconds>(0, (d.deadline - d.now) / 60'000),
                   d.locked.empty() ? "nothing" : fmt::format("{}", fmt::join(d.locked, ", ")));
        if (d.again > 0) fmt::print("begun {} times before here\n", d.again);
    }
    if (!d.trouble.empty()) fmt::print("the school's server: {}\n", d.trouble);
}

void begin(const ExamOptions& o) {
    if (!o.out.ends_with(".handpiece"))
        throw core::Error("an exercise's file ends in .handpiece", o.out, "name one, so: --out exercise.handpiece");
    const school_exam::ExamClient client(o.socket);
    const school_exam::Desk desk = client.begin(o.candidate, o.invigilator, typedSecret("confirmation code"));
    client.keepExercise(o.out);
    tell(desk);
}

std::string sittingAt(const school_exam::ExamClient& client) {
    const school_exam::Desk desk = client.desk();
    if (desk.sitting.empty())
        throw core::Error("nobody is at an exam here", "", "begin it: handpiece school exam begin").as("exam-none");
    return desk.sitting;
}

/// Beside the work: says how far it is until it is handed over.
void watch(const ExamOptions& o) {
    const school_exam::ExamClient client(o.socket);
    const std::string sitting = sittingAt(client);
    std::vector<proving::RecordedInputs> parts;
    for (const std::string& file : o.recordings)
        parts.emplace_back(file);
    std::vector<std::int64_t> told(parts.size(), -1);
    // The service may be started again in the meantime: it goes on with the same sitting.
    const auto round = [&] {
        if (client.desk().sitting != sitting) return false;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            if (!core::isThere(o.recordings[i])) continue;
            parts[i].goOn();
            if (parts[i].ticks() == told[i]) continue;
            client.checkpoint(sitting, static_cast<std::int64_t>(i + 1), parts[i].ticks(), parts[i].hash());
            told[i] = parts[i].ticks();
        }
        return true;
    };
    bool isSilent = false;
    while (!studies::cancelled()) {
        try {
            if (!round()) return;
            isSilent = false;
        } catch (const core::Error& e) {
            if (e.id() != "exam-service") throw;
            if (!isSilent) std::fprintf(stderr, "handpiece-school: %s\n", e.what());
            isSilent = true;
        }
        for (double left = o.everyS; left > 0.0 && !studies::cancelled(); left -= 0.1)
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
}

void finish(const ExamOptions& o) {
    const school_exam::ExamClient client(o.socket);
    const std::vector<fs::path> recordings(o.recordings.begin(), o.recordings.end());
    const std::string entry = client.finish(sittingAt(client), recordings);
    if (!o.out.empty()) core::writeFile(o.out, entry);
    fmt::print("handed over\n");
}

void verifyReceipt(const ExamOptions& o) {
    std::string key = o.key;
    if (key.empty() && o.server.empty())
        throw core::Error("by whose key?", "--key", "give the school's key, or --server to ask it there");
    if (key.empty()) key = school_station::Line(o.server, "").get("/exam-key");
    while (!key.empty() && key.back() == '\n')
        key.pop_back();
    const std::vector<std::byte> bytes = core::readFile(o.receipt, 1 << 20);
    const exam::Receipt r =
        exam::openedReceipt({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, key, o.receipt);
    fmt::print("signed by {}...\nexam {}, candidate {}...\nbegun {}, handed over {}, at the server {}\n",
               key.substr(0, 16), r.exam, r.candidate.substr(0, 16), exam::clockOf(r.began), exam::clockOf(r.finished),
               r.received > 0 ? exam::clockOf(r.received) : "not yet");
    for (const std::string& file : r.files)
        fmt::print("recording {}\n", file);
    fmt::print("{}, verdict: {}\n", r.state, r.verdict);
}

void addServersExams(cli::Command& top, const std::shared_ptr<ExamOptions>& options) {
    ExamOptions& o = *options;
    const std::string where = " (on the server's machine)";
    const auto books = [&o](cli::Command& command) {
        command.option("--data", o.data, "the server's folder (school)");
        command.option("--database", o.database, "postgresql://... instead of SQLite in the folder");
    };
    const std::vector<std::string> helps(cases::kHelps.begin(), cases::kHelps.end());
    cli::Command made = top.subcommand("new", "Makes an exam of a class, and tells its id" + where);
    books(made);
    made.option("CLASS", o.schoolClass, "its id").required();
    made.option("EXERCISE", o.exercise, "hash of the exercise, as handpiece school exercise told it").required();
    made.option("--title", o.title, "as the class reads it");
    made.option("--opens", o.opens, "from when on it may be begun, in UTC: 2026-12-01T09:00Z").required();
    made.option("--hours", o.hours, "how long it may be begun").check(cli::range(0.1, 720.0)).showDefault();
    made.option("--minutes", o.minutes, "that one has").check(cli::range(1, 1440)).showDefault();
    made.option("--lock", o.locked, "a help that is locked, besides the exercise's own; several times")
        .check(cli::oneOf(helps))
        .takeAll();
    made.callback([options] { makeNew(*options); });

    cli::Command candidates =
        top.subcommand("candidates", "Who may sit it, with codes that are told once: the whole class, or one" + where);
    books(candidates);
    candidates.option("EXAM", o.exam, "its id").required();
    candidates.option("--person", o.person, "only this one, with what follows");
    candidates.option("--extra", o.extra, "more time [%]").check(cli::range(0, 300)).showDefault();
    candidates.option("--pause", o.pause, "for pauses [min]").check(cli::range(0, 600)).showDefault();
    candidates.option("--allow", o.allowed, "a locked help that this one has; several times")
        .check(cli::oneOf(helps))
        .takeAll();
    candidates.flag("--new-code", o.isNew, "another code, where the slip is lost; then: handpiece school exam sign");
    candidates.callback([options] { setCandidates(*options); });

    cli::Command invigilator =
        top.subcommand("invigilator", "Who may confirm a candidate's identity, by codes of the sheet" + where);
    books(invigilator);
    invigilator.option("EXAM", o.exam, "its id").required();
    invigilator.option("PERSON", o.person, "their code").required();
    invigilator.callback([options] { setInvigilator(*options); });

    cli::Command sheet = top.subcommand(
        "sheet",
        "Codes on paper for invigilators, told once: three for each candidate who has none, and what opens it" + where);
    books(sheet);
    sheet.option("EXAM", o.exam, "its id").required();
    sheet.option("--person", o.person, "three new ones for this candidate, instead of those of before");
    sheet.callback([options] { printSheet(*options); });

    cli::Command releases = top.subcommand("release", "From now on an enrolled station may hold exams" + where);
    books(releases);
    releases.option("STATION", o.station, "its id or its name").required();
    releases.callback([options] { releaseStation(*options); });

    cli::Command signs = top.subcommand("sign", "Signs it as it is now: stations fetch it" + where);
    books(signs);
    signs.option("EXAM", o.exam, "its id").required();
    signs.callback([options] { sign(*options); });
}

void addServicesExams(cli::Command& top, const std::shared_ptr<ExamOptions>& options) {
    ExamOptions& o = *options;
    const std::string where = " (as the service's user)";
    const auto service = [&o](cli::Command& command) {
        command.option("--service", o.service, "its folder, which no student can read").showDefault();
    };
    cli::Command enrol = top.subcommand("enrol", "This station may hold exams of a school" + where);
    service(enrol);
    enrol.option("SERVER", o.server, "its address, as https://school.example:8620").required();
    enrol.option("CODE", o.code, "a one-time code: handpiece school code --exam").required();
    enrol.callback([options] {
        school_exam::enrolForExams(options->server, options->code, options->service);
        fmt::print("enrolled; it holds exams when an administrator has released it (the office's page of stations)\n");
    });
    cli::Command fetches = top.subcommand("fetch", "Fetches the exams that can still be begun" + where);
    service(fetches);
    fetches.callback([options] { fetch(*options); });
    cli::Command serves = top.subcommand("serve", "Holds the exams of this station" + where);
    service(serves);
    serves.option("--socket", o.socket, "where students' programs find it").showDefault();
    serves.callback([options] { serve(*options); });
}

void addStudentsExams(cli::Command& top, const std::shared_ptr<ExamOptions>& options) {
    ExamOptions& o = *options;
    const auto socket = [&o](cli::Command& command) {
        command.option("--socket", o.socket, "of the station's service").showDefault();
    };
    cli::Command begins = top.subcommand(
        "begin", "Begins an exam by candidate's code; the invigilator's confirmation code is read from standard input");
    socket(begins);
    begins.option("--candidate", o.candidate, "the code on the slip").required();
    begins.option("--invigilator", o.invigilator, "code of who confirms the candidate's identity").required();
    begins.option("--out", o.out, "where to put the exercise: a file that ends in .handpiece").required();
    begins.callback([options] { begin(*options); });
    cli::Command opens = top.subcommand(
        "open",
        "Opens a sealed exam where the server is out of reach; the sheet's opening code is read from standard input");
    socket(opens);
    opens.callback([options] { openHere(*options); });
    cli::Command watches = top.subcommand("watch", "Notes how far the recordings are, until they are handed over");
    socket(watches);
    watches.option("RECORDING", o.recordings, "session.h5, in the order of the work").required();
    watches.option("--every", o.everyS, "[s]").check(cli::range(0.1, 120.0)).showDefault();
    watches.callback([options] { watch(*options); });
    cli::Command line = top.subcommand("line", "A window's line to this station's exams, fed by it over a pipe");
    socket(line);
    line.option("--every", o.everyS, "how often recordings are noted [s]").check(cli::range(0.1, 120.0)).showDefault();
    line.callback([options] { runExamLine({options->socket, options->everyS}); });
    cli::Command finishes = top.subcommand("finish", "Hands the recordings over, and ends the exam");
    socket(finishes);
    finishes.option("RECORDING", o.recordings, "session.h5, in the order of the work").required();
    finishes.option("--out", o.out, "keeps what the station signed");
    finishes.callback([options] { finish(*options); });
    cli::Command gives = top.subcommand(
        "give-up", "Ends an exam without work; the invigilator's confirmation code is read from standard input");
    socket(gives);
    gives.option("--invigilator", o.invigilator, "their code").required();
    gives.callback([options] {
        const school_exam::ExamClient client(options->socket);
        client.giveUp(sittingAt(client), options->invigilator, typedSecret("confirmation code"));
        fmt::print("given up\n");
    });
    cli::Command says = top.subcommand("status", "Who is at an exam here, and until when");
    socket(says);
    says.callback([options] { tell(school_exam::ExamClient(options->socket).desk()); });
}

}  // namespace

void addExamCommands(cli::Command& app) {
    const auto options = std::make_shared<ExamOptions>();
    cli::Command top = app.subcommand("exam", "Exams: made, signed, held at a station, sat, handed over");
    top.requireSubcommand();
    addServersExams(top, options);
    addServicesExams(top, options);
    addStudentsExams(top, options);

    ExamOptions& o = *options;
    cli::Command verify = app.subcommand("verify-receipt", "Whether a school's server signed this receipt");
    verify.option("FILE", o.receipt, "the receipt").required();
    verify.option("--key", o.key, "the school's key, 64 digits, as it tells everybody");
    verify.option("--server", o.server, "or its address, to ask it there");
    verify.callback([options] { verifyReceipt(*options); });
}

}  // namespace handpiece::school_cli
