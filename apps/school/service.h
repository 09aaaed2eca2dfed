// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What all routes of a server use.

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>

#include "handpiece/school/people/secret.h"
#include "handpiece/school/people/throttle.h"
#include "school/books_pool.h"
#include "school/live_board.h"
#include "school/readings.h"
#include "school/review_shelf.h"
#include "school/server.h"

namespace handpiece::school_server {

struct Service {
    Service(const Settings& s, Clock c)
        : settings(s),
          clock(std::move(c)),
          books({s.data, s.database, s.connections}),
          reviews(s.data / "reviews", books) {}

    /// Before a guess at a login's secret, which counts at once: a hundred at a time are a hundred. How long it has to
    /// wait [ms]; 0: it may.
    [[nodiscard]] std::int64_t waitToGuess(const std::string& client, const std::string& login) {
        const school::Milliseconds now = clock();
        const std::string from = "from " + client, as = "login " + login;
        const std::lock_guard lock(guessing);
        const std::int64_t wait =
            std::max(throttle.waitMs(from, now, school::kFreeOfAddress), throttle.waitMs(as, now));
        if (wait <= 0) throttle.failed(from, now), throttle.failed(as, now);
        return wait;
    }
    void guessedRight(const std::string& client, const std::string& login) {
        const std::lock_guard lock(guessing);
        throttle.takenBack("from " + client), throttle.succeeded("login " + login);
    }

    const Settings settings;
    const Clock clock;
    const std::string launchKey = school::newSecret();  ///< of log-ins under way; anew with each start
    BooksPool books;
    LiveBoard live;
    ReviewShelf reviews;
    Readings readings;
    std::mutex guessing;
    school::Throttle throttle;  ///< guarded by `guessing`
    std::atomic<std::uint64_t> asked{0}, failed{0}, attempts{0}, bytes{0};
};

}  // namespace handpiece::school_server
