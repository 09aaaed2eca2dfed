// SPDX-License-Identifier: Apache-2.0
// A teacher's work in the browser.
#include "school/routes.h"
#include "school/teaching.h"

namespace handpiece::school_server {

std::vector<Entry> teachingRoutes(Service* of) {
    using httplib::Request;
    const TaskOf taskOf = [of](const school::Books& books, const std::string& hash) {
        return of->tasks.of(books, hash);
    };
    return {
        {"GET", "/marking", Shown([](const Request&, const Visit& visit) { return markingOf(visit); })},
        {"GET", "/classes/([0-9A-Za-z._-]{1,64})/marking",
         Shown([](const Request& request, const Visit& visit) { return markingOfClass(visit, request.matches[1]); })},
        {"GET", "/assignments/([0-9A-Za-z._-]{1,64})/marking",
         Shown([](const Request& request, const Visit& visit) { return deskOf(visit, request.matches[1]); })},
        {"POST", "/assignments/([0-9A-Za-z._-]{1,64})/marking",
         Shown([](const Request& request, const Visit& visit) { return takeWorks(visit, request.matches[1]); })},
        {"GET", "/assignments/([0-9A-Za-z._-]{1,64})/marking/([0-9a-z]{4})",
         Shown([of, taskOf](const Request& request, const Visit& visit) {
             return workOf(visit, request.matches[1], request.matches[2], taskOf, of->pictures);
         })},
        {"POST", "/assignments/([0-9A-Za-z._-]{1,64})/marking/([0-9a-z]{4})",
         Shown([of, taskOf](const Request& request, const Visit& visit) {
             return markWork(visit, request.matches[1], request.matches[2], request.params, taskOf, of->pictures);
         })},
        {"GET", "/assignments/([0-9A-Za-z._-]{1,64})/marks",
         Shown([](const Request& request, const Visit& visit) { return marksOf(visit, request.matches[1]); })},
        {"POST", "/assignments/([0-9A-Za-z._-]{1,64})/marks", Shown([](const Request& request, const Visit& visit) {
             return changeMarks(visit, request.matches[1], request.params);
         })},
        {"GET", "/attempts/([0-9a-f]{32})/adjudication",
         Shown([of, taskOf](const Request& request, const Visit& visit) {
             return adjudicationOf(visit, request.matches[1], taskOf, of->pictures);
         })},
        {"POST", "/attempts/([0-9a-f]{32})/adjudication",
         Shown([of, taskOf](const Request& request, const Visit& visit) {
             return adjudicate(visit, request.matches[1], request.params, taskOf, of->pictures);
         })},
        {"GET", "/assignments/([0-9A-Za-z._-]{1,64})/agreement",
         Shown([](const Request& request, const Visit& visit) { return agreementOf(visit, request.matches[1]); })},
    };
}

}  // namespace handpiece::school_server
