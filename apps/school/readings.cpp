// SPDX-License-Identifier: Apache-2.0
#include "school/readings.h"

#include <fmt/format.h>

#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/sandbox/sandbox.h"
#include "school/exercise_file.h"

namespace handpiece::school_server {

template <class T>
T Readings::kept(std::map<std::string, T>& shelf, const std::string& key, std::size_t most,
                 const std::function<T()>& read) {
    {
        const std::lock_guard lock(mutex_);
        if (const auto found = shelf.find(key); found != shelf.end()) return found->second;
        if (waiting_ >= kMostWaiting)
            throw core::Error("too many look at once", "the server", "load the page again in a moment")
                .as("store-busy");
        ++waiting_;
    }
    struct Gone {
        Readings& of;
        ~Gone() {
            const std::lock_guard lock(of.mutex_);
            --of.waiting_;
        }
    } const gone{*this};
    const std::lock_guard one(reading_);
    {
        // Another was quicker.
        const std::lock_guard lock(mutex_);
        if (const auto found = shelf.find(key); found != shelf.end()) return found->second;
    }
    T made = read();
    const std::lock_guard lock(mutex_);
    if (shelf.size() >= most) shelf.clear();
    return shelf[key] = std::move(made);
}

Readings::Picture Readings::picture(const school::Books& books, const school::PushedAttempt& attempt,
                                    const std::string& exercise) {
    constexpr int kWidth = 640, kHeight = 480;
    if (!books.isWhole(attempt.attempt.id)) return {{}, "the session has not come yet"};
    try {
        return kept<Picture>(pictures_, attempt.attempt.id, 200, [&] {
            const ExerciseFile file(books, exercise);
            sandboxed::Files files{{}, file.path()};
            for (const std::string& one : attempt.files)
                files.sessions.push_back(books.files().path(one));
            Picture picture;
            try {
                picture.png = view::pngOf(sandboxed::picture(files, kWidth, kHeight));
            } catch (const core::Error& e) {
                // Without OpenGL, or a session that cannot be read: a page without a picture is still a page.
                if (!sandbox::isFault(e)) throw;
                picture.missing = e.problem();
            }
            return picture;
        });
    } catch (const core::Error& e) {
        return {{}, e.problem()};
    }
}

std::string Readings::studentReport(const school::Books& books, const std::string& exercise, const std::string& result,
                                    const std::string& rubric) {
    const std::string key = fmt::format("{} {} {} {}", exercise, school::sha256(result), school::sha256(rubric),
                                        config::words().language());
    return kept<std::string>(reports_, key, 200, [&] {
        return sandboxed::studentReport(ExerciseFile(books, exercise).path(), result, rubric);
    });
}

sandboxed::Contents Readings::contents(const std::vector<std::filesystem::path>& sessions) {
    const std::lock_guard one(counting_);
    return sandboxed::contentsOf(sessions);
}

sandboxed::Exercise Readings::exercise(const school::Books& books, const std::string& hash) {
    return kept<sandboxed::Exercise>(exercises_, hash, 200,
                                     [&] { return sandboxed::exercise(ExerciseFile(books, hash).path()); });
}

}  // namespace handpiece::school_server
