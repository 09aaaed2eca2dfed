// SPDX-License-Identifier: Apache-2.0
#include "school/review_shelf.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <span>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/report/review_page.h"
#include "handpiece/app/report/school_pages.h"
#include "handpiece/app/sandboxed/sandboxed.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/sandbox/sandbox.h"
#include "school/exercise_file.h"

namespace handpiece::school_server {

namespace fs = std::filesystem;

namespace {
/// Beside the page that a recording is at fault for not being: a look at a page does not try it again.
constexpr const char* kWhy = ".why";
}  // namespace

ReviewShelf::ReviewShelf(fs::path folder, BooksPool& books, std::uintmax_t mostBytes)
    : folder_(std::move(folder)), books_(books), mostBytes_(mostBytes) {}

ReviewShelf::~ReviewShelf() {
    {
        const std::lock_guard lock(mutex_);
        ends_ = true;
    }
    wake_.notify_all();
    if (thread_.joinable()) thread_.join();
}

ReviewShelf::Answer ReviewShelf::ask(const school::PushedAttempt& attempt, const std::vector<school::Score>& scores) {
    // Of another score, or by another program, it is another page.
    const std::string language = config::words().language();
    const std::string file =
        fmt::format("{}-{}-{}-{}-{}.html", attempt.attempt.id, scores.empty() ? 0 : scores.back().made,
                    scores.empty() ? "" : scores.back().rubric, language, HANDPIECE_VERSION);
    const fs::path path = folder_ / file;
    std::error_code ec;
    if (fs::is_regular_file(path, ec)) {
        const std::vector<std::byte> bytes = core::readFile(path);
        fs::last_write_time(path, fs::file_time_type::clock::now(), ec);  // asked for last
        return {std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size())};
    }
    if (const fs::path why = path.string() + kWhy; fs::is_regular_file(why, ec)) {
        const std::vector<std::byte> bytes = core::readFile(why);
        return {{}, 0.0, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size())};
    }
    const std::lock_guard lock(mutex_);
    if (const auto trouble = troubles_.extract(attempt.attempt.id)) return {{}, 0.0, trouble.mapped()};
    for (std::size_t i = 0; i < waiting_.size(); ++i)
        if (waiting_[i].file == path) return {{}, i == 0 ? progress_.load() : 0.0};
    if (waiting_.size() >= kMostWaiting) return {{}, 0.0, {}, true};
    waiting_.push_back({attempt.attempt.id, language, path});
    if (!thread_.joinable()) thread_ = std::thread([this] { loop(); });
    wake_.notify_all();
    return {};
}

void ReviewShelf::loop() {
    for (;;) {
        Work work;
        {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [this] { return ends_ || !waiting_.empty(); });
            if (ends_) return;
            work = waiting_.front();
            progress_ = 0.0;
        }
        std::string trouble;
        try {
            const config::LanguageHere here(work.language);
            const std::string page = made(work.attempt, [this](double fraction) {
                progress_ = fraction;
                return !ends_;
            });
            fs::create_directories(folder_);
            core::writeFile(work.file, page, {.ownerOnly = true});
            sweep(work.file);
        } catch (const core::Error& e) {
            trouble = e.problem();  // where it lies here is nobody's business
            keepTrouble(work.file, e);
        } catch (const std::exception& e) {
            std::fprintf(stderr, "handpiece-school: review of %s: %s\n", work.attempt.c_str(), core::asError(e).what());
            trouble = "something went wrong there";
        }
        const std::lock_guard lock(mutex_);
        waiting_.pop_front();
        if (troubles_.size() >= kMostWaiting) troubles_.clear();
        if (!trouble.empty()) troubles_[work.attempt] = trouble;
    }
}

void ReviewShelf::keepTrouble(const fs::path& page, const core::Error& e) {
    if (!e.id().starts_with("sandbox-") || !sandbox::isFault(e)) return;
    try {
        fs::create_directories(folder_);
        core::writeFile(page.string() + kWhy, e.problem(), {.ownerOnly = true});
    } catch (const std::exception& full) {
        std::fprintf(stderr, "handpiece-school: %s\n", core::asError(full).what());
    }
}

std::string ReviewShelf::made(const std::string& id, const core::Progress& progress) {
    report::ReviewedAttempt of;
    sandboxed::Files files;
    std::optional<ExerciseFile> exercise;
    std::string result, rubric;
    {
        const BooksPool::Lent books = books_.take();
        const auto attempt = books->attempt(id);
        if (!attempt || attempt->files.empty())
            throw core::Error("it came without a session", "", "push it from its station");
        of = {id, attempt->attempt.exercise, attempt->attempt.finished};
        for (const std::string& file : attempt->files)
            files.sessions.push_back(books->files().path(file));
        // Against what its score was made; where there is none the work is shown alone.
        if (const auto scores = books->scoresOf(id); !scores.empty() && !scores.back().result.empty()) {
            result = scores.back().result;
            exercise.emplace(*books, assessment::parseResult(result, "the books").identity.exerciseHash);
            files.exercise = exercise->path();
            if (const auto text = books->rubric(scores.back().rubric)) rubric = text->text;
        }
    }
    return report::reviewPage(
        sandboxed::review(files, of.exercise, result, rubric, report::roomForReview(of), progress), of);
}

void ReviewShelf::removeGone(const school::Books& books) {
    std::error_code ec;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_, ec))
        if (!books.attempt(entry.path().filename().string().substr(0, 32))) fs::remove(entry.path(), ec);
}

void ReviewShelf::sweep(const fs::path& keep) {
    removeGone(*books_.take());
    struct Kept {
        fs::file_time_type at;
        fs::path path;
        std::uintmax_t bytes;
    };
    std::vector<Kept> all;
    std::uintmax_t bytes = 0;
    // What was of another score goes as what nobody asks for.
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
        std::error_code ec;
        const std::uintmax_t size = entry.file_size(ec);
        if (ec) continue;
        all.push_back({entry.last_write_time(ec), entry.path(), size});
        bytes += size;
    }
    std::sort(all.begin(), all.end(), [](const Kept& a, const Kept& b) { return a.at < b.at; });
    for (const Kept& one : all) {
        if (bytes <= mostBytes_) break;
        if (one.path == keep) continue;
        std::error_code ec;
        if (fs::remove(one.path, ec)) bytes -= one.bytes;
    }
}

}  // namespace handpiece::school_server
