// SPDX-License-Identifier: Apache-2.0
// Works for machines that cut them again: lent, renewed, handed in. Of files a machine gets those of works that it has
// in hand.
#include <fmt/format.h>

#include <algorithm>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "school/answers.h"
#include "school/lent_work.h"
#include "school/routes.h"

namespace handpiece::school_server {

using httplib::Request;
using httplib::Response;
using school::Milliseconds;

namespace {

constexpr std::int64_t kMostInHand = 64;

std::string nameOf(const school::Station& station) {
    return "worker " + station.id;
}

/// Which the address names, and this machine has in hand.
school::Job jobOf(const school::Books& books, const Request& request, const school::Station& station) {
    const std::string number = request.matches[1], turn = request.matches[2];
    if (const auto job = books.lent(nameOf(station), std::stoll(number), std::stoll(turn))) return *job;
    throw core::Error("this work is lent to another by now, or done", number, "take the next one")
        .as("work-lost", {number, turn});
}

core::Error noProof(const std::string& why) {
    return core::Error("this is no proof of this work: " + why, "message", "use programs that belong together")
        .as("message-damaged", {"proof", why});
}
/// Of this job's rubric, and of what was handed in.
sandboxed::Proof proofIn(const Request& request, const school::Job& job, const school::PushedAttempt& attempt) {
    sandboxed::Proof proof;
    try {
        proof = sandboxed::proofFrom(request.body, attempt.files.size());
    } catch (const core::Error& e) {
        throw noProof(e.problem());
    }
    if (proof.score.result.empty()) return proof;
    const score::Result result = assessment::parseResult(proof.score.result, "message");
    if (rubric::hashText(result.assessment.rubricHash) != job.rubric) throw noProof("it is by another rubric");
    if (proof.score.state == "proven" && (result.identity.exerciseHash != attempt.attempt.exerciseHash ||
                                          result.identity.sessionHashes != attempt.attempt.sessionHashes))
        throw noProof("it is of another work");
    return proof;
}

std::uint64_t sizeOf(const school::Books& books, const std::string& hash) {
    return std::filesystem::file_size(books.files().path(hash));
}

school_wire::Work toWork(const school::Books& books, const TakenJob& taken) {
    school_wire::Work work{taken.job.number, taken.job.turn, kLeaseMs, taken.question, {}, {}};
    for (const std::string& one : taken.sessions)
        work.sessions.push_back({one, sizeOf(books, one)});
    work.exercise = {taken.exercise, sizeOf(books, taken.exercise)};
    return work;
}

}  // namespace

std::vector<Entry> workerRoutes(Service* of) {
    // std::stoll() takes all of eighteen digits.
    const char* const renew = "/api/v1/works/([0-9]{1,18})/([0-9]{1,9})/renew";
    const char* const file = "/api/v1/works/([0-9]{1,18})/([0-9]{1,9})/files/([0-9a-f]{64})";
    const char* const proof = "/api/v1/works/([0-9]{1,18})/([0-9]{1,9})/proof";
    const char* const back = "/api/v1/works/([0-9]{1,18})/([0-9]{1,9})/back";
    return {
        {"POST", "/api/v1/works",
         WorkerHandler{[of](const Request& request, Response& response, const school::Station& station) {
             // Another would find other scores.
             if (const std::uint64_t engine = numberOf(request, "engine"); engine != core::kEngineRevision)
                 throw core::Error(fmt::format("this machine's program is of revision {}, the server's of {}", engine,
                                               core::kEngineRevision),
                                   station.name, "bring both to the same version; the works wait")
                     .as("engine-other", {std::to_string(engine), std::to_string(core::kEngineRevision)});
             auto open = of->books.take();
             // Who takes all there is keeps it from the others.
             if (open->countLent(nameOf(station)) >= kMostInHand)
                 throw core::Error("this machine has as much in hand as it may", station.name,
                                   "finish some of it first")
                     .as("work-enough", {std::to_string(kMostInHand)});
             const auto taken = takeJob(*open, nameOf(station), open->sharedTime(of->clock()));
             if (!taken) {
                 response.status = 204;
                 return;
             }
             answer(response, school_wire::toJson(toWork(*open, *taken)));
         }}},
        {"POST", renew, WorkerHandler{[of](const Request& request, Response& response, const school::Station& station) {
             auto open = of->books.take();
             school::Job job = jobOf(*open, request, station);
             if (!open->renew(job, open->sharedTime(of->clock()), kLeaseMs)) (void)jobOf(*open, request, station);
             answer(response, "{}");
         }}},
        {"GET", file, WorkerHandler{[of](const Request& request, Response& response, const school::Station& station) {
             const std::string hash = request.matches[3];
             auto open = of->books.take();
             const school::Job job = jobOf(*open, request, station);
             const std::vector<std::string> its = filesOf(*open, job);
             if (std::find(its.begin(), its.end(), hash) == its.end())
                 throw core::Error("this work has no such file", hash, "take the next one").as("books-unknown");
             // Who has gone is not given files for ever.
             if (job.leaseUntil <= open->sharedTime(of->clock()))
                 throw core::Error("the time that this work was lent for is over", request.matches[1], "renew it")
                     .as("work-lost", {request.matches[1], request.matches[2]});
             Page page;
             page.type = "application/octet-stream";
             page.stream = core::openFile(open->files().path(hash));
             answer(response, std::move(page), false);
         }}},
        {"POST", proof, WorkerHandler{[of](const Request& request, Response& response, const school::Station& station) {
             std::optional<sandboxed::Proof> found;
             std::vector<std::filesystem::path> sessions;
             {
                 auto open = of->books.take();
                 const school::Job job = jobOf(*open, request, station);
                 const auto attempt = open->attempt(job.attempt);
                 if (!attempt)
                     throw core::Error("the attempt is gone", job.attempt, "take the next one").as("work-lost");
                 found = proofIn(request, job, *attempt);
                 for (const std::string& one : attempt->files)
                     sessions.push_back(open->files().path(one));
             }
             // Of its work a worker may say what it likes; not whose recordings are the same.
             found->contents = of->readings.contents(sessions);
             auto open = of->books.take();
             const school::Job job = jobOf(*open, request, station);
             if (!enterProof(*open, job, std::move(*found), nameOf(station), open->sharedTime(of->clock())))
                 (void)jobOf(*open, request, station);
             answer(response, "{}");
         }}},
        {"POST", back, WorkerHandler{[of](const Request& request, Response& response, const school::Station& station) {
             constexpr std::uint64_t kLongest = 60'000;
             const std::uint64_t pause = std::min(numberOf(request, "pause_ms"), kLongest);
             auto open = of->books.take();
             (void)open->giveBack(jobOf(*open, request, station),
                                  open->sharedTime(of->clock()) + static_cast<Milliseconds>(pause),
                                  numberOf(request, "counts") != 0);
             answer(response, "{}");
         }}},
    };
}

}  // namespace handpiece::school_server
