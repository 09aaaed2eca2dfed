// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Pages with the review of a session, made when somebody first asks for one and kept as files that may be made again:
/// a year's reviews would be twenty times its sessions, and few are ever looked at.

#include <atomic>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "handpiece/base/core/progress.h"
#include "handpiece/school/store/books.h"
#include "school/books_pool.h"

namespace handpiece::school_server {

/// Any thread. One review is made at a time, in a thread that is there once the first is asked for.
class ReviewShelf {
  public:
    /// Pages lie in `folder`, `mostBytes` at most: those that nobody asked for longest go.
    ReviewShelf(std::filesystem::path folder, BooksPool& books, std::uintmax_t mostBytes = 2'000'000'000);
    ~ReviewShelf();
    ReviewShelf(const ReviewShelf&) = delete;
    ReviewShelf& operator=(const ReviewShelf&) = delete;

    struct Answer {
        std::string page{};     ///< empty: it is not there yet
        double progress = 0.0;  ///< of making it, 0 to 1
        std::string
            trouble{};  ///< why it cannot be made; where it is not the recording's fault, tried again when asked again
        bool isBusy = false;  ///< too many wait: nothing was begun
    };
    /// The page, or how far it is. `attempt` has all its files.
    [[nodiscard]] Answer ask(const school::PushedAttempt& attempt, const std::vector<school::Score>& scores);

    /// Pages of attempts that the books no longer have go.
    void removeGone(const school::Books& books);

  private:
    void loop();
    [[nodiscard]] std::string made(const std::string& attempt, const core::Progress& progress);
    void keepTrouble(const std::filesystem::path& page, const core::Error& error);
    void sweep(const std::filesystem::path& keep);

    static constexpr std::size_t kMostWaiting = 20;
    const std::filesystem::path folder_;
    BooksPool& books_;
    const std::uintmax_t mostBytes_;
    struct Work {
        std::string attempt, language;
        std::filesystem::path file;
    };
    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<Work> waiting_;  ///< the first is in hand
    std::map<std::string, std::string> troubles_;
    std::atomic<double> progress_{0.0};
    std::atomic<bool> ends_{false};
    std::thread thread_;
};

}  // namespace handpiece::school_server
