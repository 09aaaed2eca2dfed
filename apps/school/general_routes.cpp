// SPDX-License-Identifier: Apache-2.0
// What anybody may ask: whether the server is well.
#include <fmt/format.h>

#include "school/answers.h"
#include "school/routes.h"

namespace handpiece::school_server {

/// The window's.
extern const char* const kIcon;

using httplib::Request;
using httplib::Response;

std::vector<Entry> generalRoutes(Service* of) {
    return {
        {"GET", "/healthz", Handler([of](const Request&, Response& response) {
             (void)of->books.take()->progress("arrival");
             response.set_content("well\n", "text/plain");
         })},
        // Browsers ask for it by themselves.
        {"GET", "/favicon.ico", Handler([](const Request&, Response& response) {
             response.set_header("Cache-Control", "max-age=86400");
             response.set_content(kIcon, "image/svg+xml");
         })},
        {"GET", "/metrics", Handler([of](const Request&, Response& response) {
             const school::Progress work = of->books.take()->progress("arrival");
             response.set_content(
                 fmt::format("# TYPE handpiece_requests_total counter\nhandpiece_requests_total {}\n"
                             "# TYPE handpiece_failed_total counter\nhandpiece_failed_total {}\n"
                             "# TYPE handpiece_attempts_total counter\nhandpiece_attempts_total {}\n"
                             "# TYPE handpiece_uploaded_bytes_total counter\nhandpiece_uploaded_bytes_total {}\n"
                             "# TYPE handpiece_jobs gauge\nhandpiece_jobs{{state=\"waiting\"}} {}\n"
                             "handpiece_jobs{{state=\"taken\"}} {}\nhandpiece_jobs{{state=\"done\"}} {}\n"
                             "handpiece_jobs{{state=\"failed\"}} {}\n",
                             of->asked.load(), of->failed.load(), of->attempts.load(), of->bytes.load(), work.waiting,
                             work.taken, work.done, work.failed),
                 "text/plain; version=0.0.4");
         })},
    };
}

}  // namespace handpiece::school_server
