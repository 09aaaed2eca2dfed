// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Exercises of the books, read once.

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "handpiece/assess/task/task.h"
#include "handpiece/school/store/books.h"

namespace handpiece::school_server {

/// Any thread.
class TaskShelf {
  public:
    /// By the exercise's hash; null where the books have none. Throws core::Error for one that cannot be read.
    [[nodiscard]] std::shared_ptr<const tasks::Task> of(const school::Books& books, const std::string& hash);

  private:
    std::mutex mutex_;
    std::map<std::string, std::shared_ptr<const tasks::Task>> tasks_;
};

}  // namespace handpiece::school_server
