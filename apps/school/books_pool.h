// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Books for many threads: each has its own connection while it works, and there are no more than so many.

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/school/store/books.h"

namespace handpiece::school_server {

class BooksPool {
  public:
    static constexpr std::chrono::milliseconds kPatience{5000};

    /// @param most      connections at once; who comes beyond waits
    /// @param patience  for so long, and is told that the server is busy
    BooksPool(std::filesystem::path data, std::string database, std::size_t most,
              std::chrono::milliseconds patience = kPatience)
        : data_(std::move(data)), database_(std::move(database)), most_(most), patience_(patience) {}

    /// Goes back by itself. A thread has one at a time: who waited for a second would hold up who waits for the first.
    class Lent {
      public:
        Lent(BooksPool& pool, std::unique_ptr<school::Books> books) : pool_(&pool), books_(std::move(books)) {}
        Lent(Lent&&) noexcept = default;
        ~Lent() {
            if (books_) pool_->takeBack(std::move(books_));
        }
        school::Books* operator->() const { return books_.get(); }
        school::Books& operator*() const { return *books_; }

      private:
        BooksPool* pool_;
        std::unique_ptr<school::Books> books_;
    };

    /// Throws core::Error as Books does, and "store-busy".
    [[nodiscard]] Lent take() {
        const auto until = std::chrono::steady_clock::now() + patience_;
        std::unique_lock lock(mutex_);
        for (;;) {
            if (!back_.wait_until(lock, until, [this] { return !idle_.empty() || lent_ < most_; })) throw busy();
            ++lent_;
            if (!idle_.empty()) {
                std::unique_ptr<school::Books> books = std::move(idle_.back());
                idle_.pop_back();
                return {*this, std::move(books)};
            }
            lock.unlock();
            try {
                return {*this, std::make_unique<school::Books>(data_, database_)};
            } catch (const core::Error& e) {
                lock.lock();
                --lent_;
                if (e.id() != "store-full") throw;
                // Other programs have the rest: one of ours that comes back will do, and if there is none the next try.
                constexpr std::chrono::milliseconds kAgain{200};
                if (std::chrono::steady_clock::now() + kAgain > until) throw busy();
                back_.wait_for(lock, kAgain, [this] { return !idle_.empty(); });
            } catch (...) {
                lock.lock();
                --lent_;
                throw;
            }
        }
    }

  private:
    void takeBack(std::unique_ptr<school::Books> books) {
        {
            const std::lock_guard lock(mutex_);
            --lent_;
            if (idle_.size() < kMostIdle) idle_.push_back(std::move(books));
        }
        back_.notify_one();
    }
    [[nodiscard]] core::Error busy() const {
        return core::Error("too many ask at once, and the database takes no more", "", "try again in a few seconds")
            .as("store-busy");
    }
    static constexpr std::size_t kMostIdle = 16;
    const std::filesystem::path data_;
    const std::string database_;
    const std::size_t most_;
    const std::chrono::milliseconds patience_;
    std::mutex mutex_;
    std::condition_variable back_;
    std::vector<std::unique_ptr<school::Books>> idle_;
    std::size_t lent_ = 0;
};

}  // namespace handpiece::school_server
