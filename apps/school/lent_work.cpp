// SPDX-License-Identifier: Apache-2.0
#include "school/lent_work.h"

#include <fmt/format.h>

#include "handpiece/base/core/engine_revision.h"
#include "school/exam_arrival.h"
#include "school/exercise_file.h"

namespace handpiece::school_server {

using school::Books;
using school::ExamBooks;
using school::Job;
using school::Milliseconds;

namespace {

school::Score refused(std::string why) {
    school::Score score;
    score.engine = core::kEngineRevision;
    score.state = "refused", score.passed = "teacher";
    score.reason = std::move(why);
    return score;
}

/// `score` of this job, and its end.
bool finish(Books& books, const Job& job, school::Score score, const std::string& worker, Milliseconds now) {
    score.attempt = job.attempt, score.rubric = job.rubric, score.campaign = job.campaign;
    score.worker = worker, score.made = now;
    return books.finish(job, score);
}

struct FoundWork {
    std::optional<school::PushedAttempt> attempt{};
    std::optional<school::Pack> pack{};
    std::optional<school::RubricVersion> rubric{};
    std::string lacks{};  ///< why it cannot be done; empty: all of them are there
};
FoundWork foundOf(const Books& books, const Job& job) {
    FoundWork found{books.attempt(job.attempt)};
    if (!found.attempt) {
        found.lacks = "the attempt is gone";
        return found;
    }
    std::string hash = found.attempt->attempt.exerciseHash;
    if (!found.attempt->assignment.empty())
        if (const auto assigned = books.assignment(found.attempt->assignment)) hash = assigned->pack;
    found.pack = books.pack(hash);
    found.rubric = books.rubric(job.rubric);
    if (!found.pack)
        found.lacks = fmt::format("the school has no exercise {}", hash);
    else if (!found.rubric)
        found.lacks = fmt::format("the school has no rubric {}", job.rubric);
    return found;
}

class WorkOfBooks final : public LentWork {
  public:
    WorkOfBooks(std::unique_ptr<Books> books, TakenJob taken, std::string worker, std::function<Milliseconds()> clock)
        : books_(std::move(books)), taken_(std::move(taken)), worker_(std::move(worker)), clock_(std::move(clock)) {}
    [[nodiscard]] std::int64_t turn() const override { return taken_.job.turn; }
    [[nodiscard]] const std::string& question() const override { return taken_.question; }
    [[nodiscard]] sandboxed::Files files(const core::Progress& /*progress*/) override {
        sandboxed::Files files;
        for (const std::string& one : taken_.sessions)
            files.sessions.push_back(books_->files().path(one));
        files.exercise = exercise_.emplace(books_->files().path(taken_.exercise)).path();
        return files;
    }
    [[nodiscard]] bool renew() override { return books_->renew(taken_.job, now(), kLeaseMs); }
    void enter(sandboxed::Proof proof, const core::Progress& /*progress*/) override {
        (void)enterProof(*books_, taken_.job, std::move(proof), worker_, now());
    }
    void giveBack(Milliseconds pause, bool counts) override {
        (void)books_->giveBack(taken_.job, now() + pause, counts);
    }

  private:
    [[nodiscard]] Milliseconds now() const { return books_->sharedTime(clock_()); }
    const std::unique_ptr<Books> books_;
    TakenJob taken_;
    const std::string worker_;
    const std::function<Milliseconds()> clock_;
    std::optional<ExerciseFile> exercise_;
};

class BooksSource final : public WorkSource {
  public:
    BooksSource(BooksPlace place, std::function<Milliseconds()> clock)
        : place_(std::move(place)), clock_(std::move(clock)) {}
    [[nodiscard]] std::unique_ptr<LentWork> take() override {
        auto books = std::make_unique<Books>(place_.data, place_.database);
        std::optional<TakenJob> taken = takeJob(*books, worker_, books->sharedTime(clock_()));
        if (!taken) return {};
        return std::make_unique<WorkOfBooks>(std::move(books), std::move(*taken), worker_, clock_);
    }

  private:
    const BooksPlace place_;
    const std::function<Milliseconds()> clock_;
    const std::string worker_ = "worker " + school::newId();
};

}  // namespace

std::unique_ptr<WorkSource> worksOf(BooksPlace place, std::function<Milliseconds()> clock) {
    return std::make_unique<BooksSource>(std::move(place), std::move(clock));
}

std::optional<TakenJob> takeJob(Books& books, const std::string& worker, Milliseconds now) {
    while (const std::optional<Job> job = books.takeJob(worker, now, kLeaseMs)) {
        const FoundWork found = foundOf(books, *job);
        if (found.lacks.empty())
            return TakenJob{*job,
                            sandboxed::questionOf(*found.attempt, found.rubric->text, examNotes(books, *found.attempt)),
                            found.attempt->files, found.pack->file};
        (void)finish(books, *job, refused(found.lacks), worker, now);
    }
    return {};
}

std::vector<std::string> filesOf(const Books& books, const Job& job) {
    FoundWork found = foundOf(books, job);
    if (!found.lacks.empty()) return {};
    found.attempt->files.push_back(found.pack->file);
    return found.attempt->files;
}

bool enterProof(Books& books, const Job& job, sandboxed::Proof proof, const std::string& worker, Milliseconds now) {
    const std::optional<school::PushedAttempt> attempt = books.attempt(job.attempt);
    if (!attempt) return finish(books, job, refused("the attempt is gone"), worker, now);
    for (std::size_t i = 0; i < attempt->files.size(); ++i)
        if (!proof.contents.inputs.at(i).empty()) {
            books.keepContent(attempt->files[i], proof.contents.inputs[i]);
            books.keepSketch(attempt->files[i], proof.contents.sketches.at(i));
        }
    if (ExamBooks(books).sitting(job.attempt)) ExamBooks(books).setDoubts(job.attempt, proof.doubts, now);
    if (books.otherPersonWith(job.attempt))
        return finish(books, job, refused("the same session came as another person's work, too"), worker, now);
    return finish(books, job, std::move(proof.score), worker, now);
}

}  // namespace handpiece::school_server
