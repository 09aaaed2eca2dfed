// SPDX-License-Identifier: Apache-2.0
// A teacher's work in the browser.
#include "school/answers.h"
#include "school/library.h"
#include "school/routes.h"
#include "school/teaching.h"

namespace handpiece::school_server {

/// The address that this was asked at.
static std::string homeOf(const Service& of, const httplib::Request& request) {
    return (isSecure(request, of.settings) ? "https://" : "http://") + request.get_header_value("Host");
}

/// What a form puts around a file.
constexpr std::size_t kAroundFiles = 64u << 10;

std::vector<Entry> teachingRoutes(Service* of) {
    using httplib::Request;
    return {
        {"GET", "/marking", Shown([](const Request&, const Visit& visit) { return markingOf(visit); })},
        {"GET", "/classes/([0-9A-Za-z._-]{1,64})/marking",
         Shown([](const Request& request, const Visit& visit) { return markingOfClass(visit, request.matches[1]); })},
        {"GET", "/assignments/([0-9A-Za-z._-]{1,64})/marking",
         Shown([](const Request& request, const Visit& visit) { return deskOf(visit, request.matches[1]); })},
        {"POST", "/assignments/([0-9A-Za-z._-]{1,64})/marking",
         Shown([](const Request& request, const Visit& visit) { return takeWorks(visit, request.matches[1]); })},
        {"GET", "/assignments/([0-9A-Za-z._-]{1,64})/marking/([0-9a-z]{4})",
         Shown([of](const Request& request, const Visit& visit) {
             return workOf(visit, request.matches[1], request.matches[2], of->readings);
         })},
        {"POST", "/assignments/([0-9A-Za-z._-]{1,64})/marking/([0-9a-z]{4})",
         Shown([of](const Request& request, const Visit& visit) {
             return markWork(visit, request.matches[1], request.matches[2], request.params, of->readings);
         })},
        {"GET", "/assignments/([0-9A-Za-z._-]{1,64})/marks",
         Shown([](const Request& request, const Visit& visit) { return marksOf(visit, request.matches[1]); })},
        {"POST", "/assignments/([0-9A-Za-z._-]{1,64})/marks", Shown([](const Request& request, const Visit& visit) {
             return changeMarks(visit, request.matches[1], request.params);
         })},
        {"GET", "/attempts/([0-9a-f]{32})/adjudication", Shown([of](const Request& request, const Visit& visit) {
             return adjudicationOf(visit, request.matches[1], of->readings);
         })},
        {"POST", "/attempts/([0-9a-f]{32})/adjudication", Shown([of](const Request& request, const Visit& visit) {
             return adjudicate(visit, request.matches[1], request.params, of->readings);
         })},
        {"GET", "/assignments/([0-9A-Za-z._-]{1,64})/agreement",
         Shown([](const Request& request, const Visit& visit) { return agreementOf(visit, request.matches[1]); })},
        {"GET", "/rubrics", Shown([](const Request&, const Visit& visit) { return rubricsOf(visit); })},
        {"GET", "/rubrics/([0-9a-f]{16})",
         Shown([](const Request& request, const Visit& visit) { return rubricOf(visit, request.matches[1]); })},
        {"GET", "/rubrics/([0-9a-f]{16})/edit",
         Shown([](const Request& request, const Visit& visit) { return editRubric(visit, request.matches[1]); })},
        {"POST", "/rubrics/check", Shown([](const Request& request, const Visit& visit) {
             return checkRubric(visit, request.params, sentBy(request, request.has_file("file") ? "file" : "text"));
         })},
        {"POST", "/rubrics",
         Shown([](const Request& request, const Visit& visit) { return saveRubric(visit, request.params); })},
        {"GET", "/assignments/([0-9A-Za-z._-]{1,64})/rescore", Shown([](const Request& request, const Visit& visit) {
             return request.has_param("progress") ? rescoreProgressOf(visit, request.matches[1])
                                                  : rescoreOf(visit, request.matches[1]);
         })},
        {"POST", "/assignments/([0-9A-Za-z._-]{1,64})/rescore", Shown([](const Request& request, const Visit& visit) {
             return changeScores(visit, request.matches[1], request.params);
         })},
        {"GET", "/classes/([0-9A-Za-z._-]{1,64})/results", Shown([of](const Request& request, const Visit& visit) {
             return resultsOfClass(visit, request.matches[1], homeOf(*of, request));
         })},
        {"GET",
         "/classes/([0-9A-Za-z._-]{1,64})/export/"
         "(attempts\\.csv|criteria\\.csv|results\\.zip|statements\\.json|report)",
         Shown([](const Request& request, const Visit& visit) {
             return exportOfClass(visit, request.matches[1], request.matches[2], request.get_param_value("home"));
         })},
        {"GET", "/people/([0-9A-Za-z._-]{1,64})/curves", Shown([of](const Request& request, const Visit& visit) {
             return curvesOf(visit, request.matches[1], homeOf(*of, request));
         })},
        {"GET", "/people/([0-9A-Za-z._-]{1,64})/export/(attempts\\.csv|criteria\\.csv|results\\.zip|statements\\.json)",
         Shown([](const Request& request, const Visit& visit) {
             return exportOfPerson(visit, request.matches[1], request.matches[2], request.get_param_value("home"));
         })},
        {"GET", "/assignments/([0-9A-Za-z._-]{1,64})/standard", Shown([](const Request& request, const Visit& visit) {
             return standardOf(visit, request.matches[1], request.has_param("all"));
         })},
        {"POST", "/assignments/([0-9A-Za-z._-]{1,64})/standard", Shown([](const Request& request, const Visit& visit) {
             return changeStandard(visit, request.matches[1], request.params);
         })},
        {"GET", "/assignments/([0-9A-Za-z._-]{1,64})/exemplars",
         Shown([](const Request& request, const Visit& visit) { return exemplarsOf(visit, request.matches[1]); })},
        {"GET", "/assignments/([0-9A-Za-z._-]{1,64})/exemplars/([0-9]{1,3})",
         Shown([of](const Request& request, const Visit& visit) {
             return calibrationOf(visit, request.matches[1], std::stoul(request.matches[2]), of->readings);
         })},
        {"POST", "/assignments/([0-9A-Za-z._-]{1,64})/exemplars/([0-9]{1,3})",
         Shown([of](const Request& request, const Visit& visit) {
             return calibrate(visit, request.matches[1], std::stoul(request.matches[2]), request.params, of->readings);
         })},
        {"GET", "/attempts/([0-9a-f]{32})/exemplar", Shown([of](const Request& request, const Visit& visit) {
             return exemplarOf(visit, request.matches[1], of->readings);
         })},
        {"POST", "/attempts/([0-9a-f]{32})/exemplar", Shown([of](const Request& request, const Visit& visit) {
             return setExemplar(visit, request.matches[1], request.params, of->readings);
         })},
        {"GET", "/exercises", Shown([](const Request&, const Visit& visit) { return exercisesOf(visit); })},
        {"POST", "/exercises",
         Shown([](const Request& request, const Visit& visit) { return addExercise(visit, sentBy(request, "file")); }),
         kMostExercise + kAroundFiles},
        {"GET", "/exercises/([0-9a-f]{16})", Shown([of](const Request& request, const Visit& visit) {
             return exerciseOf(visit, request.matches[1], of->readings);
         })},
        {"GET", "/assignments/([0-9A-Za-z._-]{1,64})",
         Shown([](const Request& request, const Visit& visit) { return assignmentOf(visit, request.matches[1]); })},
        {"POST", "/assignments/([0-9A-Za-z._-]{1,64})", Shown([](const Request& request, const Visit& visit) {
             return setTimes(visit, request.matches[1], request.params);
         })},
        {"GET", "/classes/([0-9A-Za-z._-]{1,64})/assignments",
         Shown([](const Request& request, const Visit& visit) { return assignmentsOf(visit, request.matches[1]); })},
        {"POST", "/classes/([0-9A-Za-z._-]{1,64})/assignments", Shown([](const Request& request, const Visit& visit) {
             return assign(visit, request.matches[1], request.params);
         })},
    };
}

}  // namespace handpiece::school_server
