// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What all routes of a server use.

#include <atomic>
#include <cstdint>
#include <mutex>

#include "handpiece/school/people/throttle.h"
#include "school/books_pool.h"
#include "school/live_board.h"
#include "school/picture_shelf.h"
#include "school/review_shelf.h"
#include "school/server.h"
#include "school/task_shelf.h"

namespace handpiece::school_server {

struct Service {
    Service(const Settings& s, Clock c)
        : settings(s),
          clock(std::move(c)),
          books({s.data, s.database, s.connections}),
          reviews(s.data / "reviews", books, tasks) {}

    [[nodiscard]] bool isSecure() const { return !settings.certificate.empty(); }

    const Settings settings;
    const Clock clock;
    BooksPool books;
    TaskShelf tasks;
    LiveBoard live;
    ReviewShelf reviews;
    PictureShelf pictures;
    std::mutex guessing;
    school::Throttle throttle;  ///< guarded by `guessing`
    std::atomic<std::uint64_t> asked{0}, failed{0}, attempts{0}, bytes{0};
};

}  // namespace handpiece::school_server
