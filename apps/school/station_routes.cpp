// SPDX-License-Identifier: Apache-2.0
// What stations push and ask.
#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/error.h"
#include "handpiece/school/people/secret.h"
#include "handpiece/school/store/books_accounts.h"
#include "school/answers.h"
#include "school/routes.h"
#include "school/wire.h"

namespace handpiece::school_server {

using httplib::Request;
using httplib::Response;

namespace {
bool isStudentIn(const school::Books& books, const std::string& schoolClass, const std::string& person) {
    const std::vector<school::Enrolment> in = books.enrolments(schoolClass);
    return std::any_of(in.begin(), in.end(),
                       [&](const school::Enrolment& one) { return one.person == person && one.role == "student"; });
}

/// A code that is not what is meant is not spent.
void requireMeant(const school::Books& books, const school_wire::Enrol& enrol, school::Milliseconds now) {
    const auto code = books.offered(school::typedStationCode(enrol.code), now);
    if (!code) return;  // whoever spends it says so
    if (enrol.kind && *enrol.kind != code->kind) {
        const bool isExam = code->kind == "exam", isWorker = code->kind == "worker";
        throw core::Error(isExam     ? "this code is of a station for exams"
                          : isWorker ? "this code is of a machine that cuts works again"
                                     : "this code is of a station for practice",
                          code->name,
                          isExam                  ? "as the service's user: handpiece school exam enrol"
                          : isWorker              ? "there: handpiece school worker enrol"
                          : *enrol.kind == "exam" ? "have one for exams made: handpiece school code --exam"
                                                  : "have one of its kind made: handpiece school code --worker")
            .as("code-other", {code->kind});
    }
    // An older program's, that does not say what it enrols, is of a station for practice or exams.
    if (!enrol.kind && code->kind == "worker")
        throw core::Error("this code is of a machine that cuts works again", code->name,
                          "there: handpiece school worker enrol")
            .as("code-other", {code->kind});
    if (!enrol.person || code->kind != "practice") return;
    if (enrol.person->empty() && code->person.empty())
        throw core::Error("whose work is it?", code->name, "give --person with the school's code of who works here")
            .as("code-other", {"person"});
    if (!enrol.person->empty() && !code->person.empty() && *enrol.person != code->person)
        throw core::Error("this code is another person's", code->name, "make one on your own account's page")
            .as("code-other", {"person"});
}
}  // namespace

void requireActsFor(const school::Station& station, const std::string& person) {
    if (station.person.empty() || station.person == person) return;
    throw core::Error("this station is another person's", station.name,
                      "work in your own account of that computer, enrolled by a code of your own account's page")
        .as("station-anothers", {station.name});
}

std::vector<Entry> stationRoutes(Service* of) {
    using school_wire::toJson;
    const auto upload = [](const Request& request, const school::Station& station) {
        return school::Upload{station.id, request.matches[1].str(), numberOf(request, "bytes")};
    };
    return {
        {"POST", "/api/v1/enrol", Handler([of](const Request& request, Response& response) {
             const school_wire::Enrol enrol = school_wire::enrolFrom(request.body);
             // A key of 256 bits out of the system's randomness.
             school_wire::Enrolled made{school::newId(), school::newSecret(), {}};
             requireMeant(*of->books.take(), enrol, of->clock());
             const auto station = of->books.take()->enrolStation(school::typedStationCode(enrol.code), made.station,
                                                                 made.key, of->clock());
             if (!station)
                 throw core::Error(
                     "this code is not known, was used, or is too old", "",
                     "have a new one made: handpiece school code" + std::string(enrol.kind == "worker" ? " --worker"
                                                                                : enrol.kind == "exam" ? " --exam"
                                                                                                       : ""))
                     .as("code-unknown");
             made.person = station->person;
             answer(response, toJson(made), 201);
         })},
        {"GET", "/api/v1/status",
         StationHandler([of](const Request&, Response& response, const school::Station& station) {
             const auto open = of->books.take();
             school_wire::Status status{HANDPIECE_VERSION,
                                        school_wire::kProtocol,
                                        core::kEngineRevision,
                                        station.id,
                                        school::BooksAccounts(*open).incarnation(),
                                        of->clock(),
                                        open->missingFiles(station.id)};
             if (status.missing.size() > 200) status.missing.resize(200);
             answer(response, toJson(status));
         })},
        {"GET", "/api/v1/tasks/([0-9A-Za-z._-]{1,64})",
         StationHandler([of](const Request& request, Response& response, const school::Station& station) {
             const std::string person = request.matches[1];
             requireActsFor(station, person);
             auto open = of->books.take();
             std::vector<school_wire::Task> tasks;
             for (const school::SchoolClass& one : open->classes()) {
                 if (!isStudentIn(*open, one.id, person)) continue;
                 for (const school::Assignment& a : open->assignments(one.id))
                     if (a.kind != "exam") tasks.push_back({a.id, a.pack, a.title, a.opens, a.closes});
             }
             answer(response, toJson(tasks));
         })},
        {"POST", "/api/v1/attempts",
         StationHandler([of](const Request& request, Response& response, const school::Station& station) {
             school::PushedAttempt pushed = school_wire::attemptFrom(request.body);
             pushed.station = station.id;
             pushed.received = of->clock();
             requireActsFor(station, pushed.person);
             auto open = of->books.take();
             if (const auto assignment = open->assignment(pushed.assignment)) {
                 if (of->settings.ownStationsOnly && station.person.empty())
                     throw core::Error("this school takes class work of a person's own station alone", station.name,
                                       "make a code for this computer on your account's page, and enrol it again; the "
                                       "work waits")
                         .as("station-anybodys", {station.name});
                 if (assignment->kind == "exam")
                     throw core::Error("an exam's work is told by the service of its station alone", pushed.assignment,
                                       "hand it over there: handpiece school exam finish")
                         .as("books-invalid", {"assignment"});
                 if (!isStudentIn(*open, assignment->schoolClass, pushed.person))
                     throw core::Error("this person is no student of the class that has to do it", pushed.assignment,
                                       "ask who keeps the class's list; the work stays at the station")
                         .as("books-invalid", {"assignment"});
             }
             const bool isNew = open->push(pushed);
             if (isNew) ++of->attempts;
             answer(response, "{}", isNew ? 201 : 200);
         })},
        {"POST", "/api/v1/judgements",
         StationHandler([of](const Request& request, Response& response, const school::Station& station) {
             const school::Judgement judgement = school_wire::judgementFrom(request.body);
             auto open = of->books.take();
             // Of its own attempts only.
             const auto attempt = open->attempt(judgement.attempt);
             if (attempt && attempt->station != station.id)
                 throw core::Error("this attempt is another station's", "", "enrol the station anew")
                     .as("books-unknown", {"attempt", judgement.attempt});
             answer(response, "{}", open->push(judgement) ? 201 : 200);
         })},
        {"GET", "/api/v1/files/([0-9a-f]{64})",
         StationHandler([of, upload](const Request& request, Response& response, const school::Station& station) {
             const school::Upload file = upload(request, station);
             const auto open = of->books.take();
             const std::uint64_t there = open->received(file, of->clock());
             answer(response, toJson(school_wire::Received{there, open->hasDelivered(file)}));
         })},
        {"PUT", "/api/v1/files/([0-9a-f]{64})",
         StationHandler([of, upload](const Request& request, Response& response, const school::Station& station) {
             const school::Upload file = upload(request, station);
             const std::uint64_t offset = numberOf(request, "offset");
             const bool isWhole =
                 of->books.take()->append(file, offset, std::as_bytes(std::span(request.body)), of->clock());
             of->bytes += request.body.size();
             answer(response, toJson(school_wire::Received{offset + request.body.size(), isWhole}));
         })},
    };
}

}  // namespace handpiece::school_server
