// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Books for many threads: each has its own connection while it works.

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "handpiece/school/store/books.h"

namespace handpiece::school_server {

class BooksPool {
  public:
    BooksPool(std::filesystem::path data, std::string database)
        : data_(std::move(data)), database_(std::move(database)) {}

    /// Goes back by itself.
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

    /// Throws core::Error as Books does.
    [[nodiscard]] Lent take() {
        {
            const std::lock_guard lock(mutex_);
            if (!idle_.empty()) {
                std::unique_ptr<school::Books> books = std::move(idle_.back());
                idle_.pop_back();
                return {*this, std::move(books)};
            }
        }
        return {*this, std::make_unique<school::Books>(data_, database_)};
    }

  private:
    void takeBack(std::unique_ptr<school::Books> books) {
        const std::lock_guard lock(mutex_);
        if (idle_.size() < kMostIdle) idle_.push_back(std::move(books));
    }
    static constexpr std::size_t kMostIdle = 16;
    const std::filesystem::path data_;
    const std::string database_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<school::Books>> idle_;
};

}  // namespace handpiece::school_server
