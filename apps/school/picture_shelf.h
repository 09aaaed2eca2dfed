// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Pictures of work, drawn once.

#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "handpiece/assess/task/task.h"
#include "handpiece/school/store/books.h"

namespace handpiece::school_server {

/// Any thread; one draws at a time.
class PictureShelf {
  public:
    struct Drawn {
        std::vector<std::byte> png;  ///< empty: there is none
        std::string missing;         ///< why
    };
    /// The tooth as this attempt leaves it, from occlusal.
    [[nodiscard]] Drawn of(const school::Books& books, const school::PushedAttempt& attempt, const tasks::Task& task);

  private:
    std::mutex mutex_;
    std::map<std::string, Drawn> drawn_;
};

}  // namespace handpiece::school_server
