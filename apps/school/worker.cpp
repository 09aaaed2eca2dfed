// SPDX-License-Identifier: Apache-2.0
#include "school/worker.h"

#include <fmt/format.h>

#include <cstdio>

#include "handpiece/app/sandboxed/sandboxed.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/error.h"
#include "school/exam_arrival.h"
#include "school/exercise_file.h"

namespace handpiece::school_server {

using school::ExamBooks;

namespace {

school::Score refused(const school::Job& job, std::string why) {
    school::Score score;
    score.attempt = job.attempt, score.rubric = job.rubric;
    score.engine = core::kEngineRevision;
    score.state = "refused", score.passed = "teacher";
    score.reason = std::move(why);
    return score;
}

}  // namespace

Worker::Worker(WorkerSettings settings, std::function<school::Milliseconds()> clock)
    : settings_(std::move(settings)), clock_(std::move(clock)), name_("worker " + school::newId()) {}
Worker::~Worker() {
    stop();
}

void Worker::start() {
    thread_ = std::thread([this] { loop(); });
}
void Worker::stop() {
    {
        const std::lock_guard lock(mutex_);
        ends_ = true;
    }
    wake_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void Worker::loop() {
    while (!ends_) {
        bool worked = false;
        try {
            worked = workOnce();
        } catch (const std::exception& e) {
            std::fprintf(stderr, "handpiece-school: %s: %s\n", name_.c_str(), core::asError(e).what());
        }
        std::unique_lock lock(mutex_);
        if (!worked) wake_.wait_for(lock, settings_.pause, [this] { return ends_.load(); });
    }
}

bool Worker::workOnce() {
    school::Books books(settings_.data, settings_.database);
    std::optional<school::Job> job = books.takeJob(name_, books.sharedTime(clock_()), settings_.leaseMs);
    if (!job) return false;
    bool isLost = false;
    try {
        school::Score score = heard(books, *job, isLost);
        score.campaign = job->campaign;
        score.worker = name_;
        score.made = books.sharedTime(clock_());
        // Another was quicker: then it is there.
        (void)books.finish(*job, score);
    } catch (const core::Error& e) {
        // No reader can start here: that costs the work nothing. One was killed: not at once again.
        constexpr school::Milliseconds kPause = 10'000;
        const bool isHere = e.id() == "sandbox-start";
        const school::Milliseconds pause = isHere ? 3 * kPause : e.id() == "sandbox-killed" ? job->turn * kPause : 0;
        if (!isLost) (void)books.giveBack(*job, books.sharedTime(clock_()) + pause, !isHere);
        if (e.problem() != "cancelled") throw;
    }
    return true;
}

school::Score Worker::heard(school::Books& books, school::Job& job, bool& isLost) {
    const std::optional<school::PushedAttempt> attempt = books.attempt(job.attempt);
    if (!attempt) return refused(job, "the attempt is gone");
    std::string pack = attempt->attempt.exerciseHash;
    if (!attempt->assignment.empty())
        if (const auto assigned = books.assignment(attempt->assignment)) pack = assigned->pack;
    const ExerciseFile exercise(books, pack);
    if (exercise.path().empty()) return refused(job, fmt::format("the school has no exercise {}", pack));
    const std::optional<school::RubricVersion> text = books.rubric(job.rubric);
    if (!text) return refused(job, fmt::format("the school has no rubric {}", job.rubric));
    sandboxed::Files files{{}, exercise.path()};
    for (const std::string& file : attempt->files)
        files.sessions.push_back(books.files().path(file));
    school::Milliseconds renewed = clock_();
    const core::Progress progress = [&](double) {
        if (ends_) return false;
        if (const school::Milliseconds now = clock_(); now - renewed > settings_.leaseMs / 4) {
            if ((isLost = !books.renew(job, books.sharedTime(now), settings_.leaseMs))) return false;
            renewed = now;
        }
        return true;
    };
    sandboxed::Proof proof = sandboxed::prove(*attempt, files, text->text, examNotes(books, *attempt), progress);
    for (std::size_t i = 0; i < attempt->files.size(); ++i)
        if (!proof.contents[i].empty()) {
            books.keepContent(attempt->files[i], proof.contents[i]);
            books.keepSketch(attempt->files[i], proof.sketches[i]);
        }
    if (ExamBooks(books).sitting(attempt->attempt.id))
        ExamBooks(books).setDoubts(attempt->attempt.id, proof.doubts, books.sharedTime(clock_()));
    if (const auto other = books.otherPersonWith(job.attempt))
        return refused(job, "the same session came as another person's work, too");
    proof.score.rubric = job.rubric;
    return std::move(proof.score);
}

}  // namespace handpiece::school_server
