// SPDX-License-Identifier: Apache-2.0
#include "school/worker.h"

#include <fmt/format.h>

#include <cstdio>

#include "handpiece/app/proving/exam_check.h"
#include "handpiece/app/proving/proving.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/error.h"
#include "school/exam_arrival.h"

namespace handpiece::school_server {
namespace {

school::Score refused(const school::Job& job, std::string why) {
    school::Score score;
    score.attempt = job.attempt, score.rubric = job.rubric;
    score.engine = core::kEngineRevision;
    score.state = "refused", score.passed = "teacher";
    score.reason = std::move(why);
    return score;
}

/// One byte more, and it is another file; not another work.
void keepContents(school::Books& books, const school::PushedAttempt& attempt) {
    for (const std::string& file : attempt.files)
        try {
            proving::RecordedInputs inputs(books.files().path(file));
            inputs.goOn();
            if (inputs.hasMoved()) books.keepContent(file, inputs.hash());
        } catch (const core::Error&) {
            // What cannot be read is refused when it is to be proven, with its reason.
        }
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
        if (!isLost) (void)books.giveBack(*job);
        if (e.problem() != "cancelled") throw;
    }
    return true;
}

school::Score Worker::heard(school::Books& books, school::Job& job, bool& isLost) {
    const std::optional<school::PushedAttempt> attempt = books.attempt(job.attempt);
    if (!attempt) return refused(job, "the attempt is gone");
    keepContents(books, *attempt);
    if (const auto other = books.otherPersonWith(job.attempt))
        return refused(job, "the same session came as another person's work, too");
    std::string exercise = attempt->attempt.exerciseHash;
    if (!attempt->assignment.empty())
        if (const auto assigned = books.assignment(attempt->assignment)) exercise = assigned->pack;
    const std::shared_ptr<const tasks::Task> task = tasks_.of(books, exercise);
    if (!task) return refused(job, fmt::format("the school has no exercise {}", exercise));
    const std::optional<school::RubricVersion> text = books.rubric(job.rubric);
    if (!text) return refused(job, fmt::format("the school has no rubric {}", job.rubric));
    const rubric::Rubric rubric = rubric::parseRubric(text->text, "rubric " + text->id);
    std::vector<std::filesystem::path> sessions;
    for (const std::string& file : attempt->files)
        sessions.push_back(books.files().path(file));
    school::Milliseconds renewed = clock_();
    const core::Progress progress = [&](double) {
        if (ends_) return false;
        if (const school::Milliseconds now = clock_(); now - renewed > settings_.leaseMs / 4) {
            if ((isLost = !books.renew(job, books.sharedTime(now), settings_.leaseMs))) return false;
            renewed = now;
        }
        return true;
    };
    school::Score score = proving::prove(*attempt, sessions, *task, rubric, progress);
    checkExam(books, *attempt, sessions, books.sharedTime(clock_()));
    return score;
}

}  // namespace handpiece::school_server
