// SPDX-License-Identifier: Apache-2.0
#include "school/housekeeper.h"

#include <cstdio>

#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/error.h"
#include "handpiece/school/store/retention.h"
#include "school/lti.h"

namespace handpiece::school_server {
namespace {
constexpr auto kPause = std::chrono::seconds(30);
constexpr school::Milliseconds kDayMs = 86'400'000, kTenMinutesMs = 600'000;
}  // namespace

void Housekeeper::start() {
    thread_ = std::thread([this] {
        std::unique_lock lock(mutex_);
        while (!ends_) {
            lock.unlock();
            try {
                round();
            } catch (const std::exception& e) {
                std::fprintf(stderr, "handpiece-school: %s\n", core::asError(e).what());
            }
            lock.lock();
            wake_.wait_for(lock, kPause, [this] { return ends_; });
        }
    });
}

void Housekeeper::stop() {
    {
        const std::lock_guard lock(mutex_);
        ends_ = true;
    }
    wake_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void Housekeeper::round() {
    auto open = service_.books.take();
    const school::Milliseconds now = service_.clock();
    if (now - expired_ >= kDayMs || now < expired_) {
        (void)school::Retention(*open).expire({"server", now});
        open->sweep(now);
        service_.reviews.removeGone(*open);
        expired_ = now;
    }
    if (now - retried_ >= kTenMinutesMs || now < retried_) {
        if (const std::int64_t again = open->retry(open->sharedTime(now)); again > 0)
            std::fprintf(stderr, "handpiece-school: %lld works that were given up are tried again\n",
                         static_cast<long long>(again));
        retried_ = now;
    }
    if (school::LtiBooks(*open).platforms().empty()) return;
    (void)queueGrades(*open, now);
    (void)sendGrades(*open, RsaKey(service_.settings.data / "lti.pem"), service_.clock);
}

}  // namespace handpiece::school_server
