// SPDX-License-Identifier: Apache-2.0
// Exams: what stations fetch and tell, and the pages of those who decide.
#include <fmt/format.h>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/exam/seal.h"
#include "school/answers.h"
#include "school/exam_arrival.h"
#include "school/exam_pages.h"
#include "school/routes.h"

namespace handpiece::school_server {

using httplib::Request;
using httplib::Response;

namespace {
core::Error notForExams(const school::Station& station, const char* what) {
    return core::Error("this station may hold no exams", station.name, what).as("exam-station", {station.name});
}
core::Error noExam(const std::string& id) {
    return core::Error("there is no such exam", id, "ask which there are").as("books-unknown");
}
std::string openingOf(school::Books& books, const std::string& exam) {
    const auto code = school::ExamBooks(books).openingCode(exam);
    if (!code) throw noExam(exam);
    return *code;
}
/// A practice station's key opens nothing of an exam.
StationHandler released(StationHandler handler) {
    return [handler = std::move(handler)](const Request& request, Response& response, const school::Station& station) {
        if (!station.mayHoldExams())
            throw notForExams(station, "an administrator releases it: handpiece school exam release");
        handler(request, response, station);
    };
}
}  // namespace

std::vector<Entry> examRoutes(Service* of) {
    const auto page = [of](Page (*shown)(const Visit&, const std::string&, const std::filesystem::path&)) {
        return Shown([of, shown](const Request& request, const Visit& visit) {
            return shown(visit, request.matches[1], of->settings.data);
        });
    };
    const auto decision = [](const char* kind) {
        return Shown([kind](const Request& request, const Visit& visit) {
            return decide(visit, request.matches[1], kind, request.get_param_value("verdict"),
                          request.get_param_value("words"));
        });
    };
    return {
        {"GET", "/exam-key", Handler([of](const Request&, Response& response) {
             response.set_content(examKey(of->settings.data).open + "\n", "text/plain");
         })},
        {"POST", "/api/v1/exams/station",
         StationHandler([of](const Request& request, Response& response, const school::Station& station) {
             if (station.kind != "exam")
                 throw notForExams(station, "enrol it by a code for exams: handpiece school code --exam");
             auto open = of->books.take();
             school::ExamBooks(*open).addKey(station.id, request.body.substr(0, 100), of->clock());
             response.set_content(examKey(of->settings.data).open, "text/plain");
         })},
        {"GET", "/api/v1/exams", released([of](const Request&, Response& response, const school::Station&) {
             auto open = of->books.take();
             school::ExamBooks exams(*open);
             std::string all;
             for (const std::string& id : exams.examsOpenAt(of->clock()))
                 if (const auto pack = exams.newestPack(id)) all += fmt::format("{} {}\n", pack->version, id);
             response.set_content(all, "text/plain");
         })},
        {"GET", "/api/v1/exams/([0-9A-Za-z._-]{1,64})/pack",
         released([of](const Request& request, Response& response, const school::Station&) {
             auto open = of->books.take();
             const auto pack = school::ExamBooks(*open).newestPack(request.matches[1]);
             if (!pack) throw noExam(request.matches[1]);
             response.set_content(exam::joined({pack->text, {pack->key, pack->signature}}), "text/plain");
         })},
        {"GET", "/api/v1/exams/([0-9A-Za-z._-]{1,64})/exercise",
         released([of](const Request& request, Response& response, const school::Station&) {
             auto open = of->books.take();
             const auto pack = school::ExamBooks(*open).newestPack(request.matches[1]);
             if (!pack) throw noExam(request.matches[1]);
             const exam::Pack its = exam::packFrom(pack->text, "the books");
             std::vector<std::byte> bytes = core::readFile(open->files().path(its.file));
             if (its.format != 1) bytes = exam::sealed(bytes, its.exam, openingOf(*open, its.exam));
             response.set_content(reinterpret_cast<const char*>(bytes.data()), bytes.size(),
                                  "application/octet-stream");
         })},
        {"GET", "/api/v1/exams/([0-9A-Za-z._-]{1,64})/opening",
         released([of](const Request& request, Response& response, const school::Station&) {
             auto open = of->books.take();
             const auto assignment = open->assignment(request.matches[1]);
             if (!assignment) throw noExam(request.matches[1]);
             if (of->clock() < assignment->opens)
                 throw core::Error("this exam has not opened", assignment->id, "ask again when it has")
                     .as("exam-early", {exam::clockOf(assignment->opens), exam::clockOf(of->clock())});
             response.set_content(openingOf(*open, assignment->id), "text/plain");
         })},
        {"GET", "/api/v1/exams/chain",
         released([of](const Request&, Response& response, const school::Station& station) {
             auto open = of->books.take();
             const school::ExamBooks::End end = school::ExamBooks(*open).endOf(station.id);
             response.set_content(fmt::format("{} {}\n", end.number, end.hash.empty() ? "-" : end.hash), "text/plain");
         })},
        {"POST", "/api/v1/exams/chain",
         released([of](const Request& request, Response& response, const school::Station& station) {
             auto open = of->books.take();
             const bool isNew = takeEntry(*open, station.id, request.body, of->clock());
             answer(response, "{}", isNew ? 201 : 200);
         })},
        {"GET", "/api/v1/exams/sittings/([0-9a-f]{32})/receipt",
         released([of](const Request& request, Response& response, const school::Station& station) {
             auto open = of->books.take();
             response.set_content(
                 receiptFor(*open, station.id, request.matches[1], examKey(of->settings.data), of->clock()),
                 "text/plain");
         })},
        {"GET", "/exams/([0-9A-Za-z._-]{1,64})", page(examOf)},
        {"GET", "/sittings/([0-9a-f]{32})", page(sittingOf)},
        {"GET", "/sittings/([0-9a-f]{32})/receipt", page(receiptOf)},
        {"POST", "/sittings/([0-9a-f]{32})/confirm", decision("confirm")},
        {"POST", "/sittings/([0-9a-f]{32})/appeal", decision("appeal")},
        {"POST", "/sittings/([0-9a-f]{32})/remark", decision("remark")},
        {"POST", "/sittings/([0-9a-f]{32})/decide", decision("decide")},
    };
}

}  // namespace handpiece::school_server
