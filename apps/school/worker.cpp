// SPDX-License-Identifier: Apache-2.0
#include "school/worker.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include "handpiece/base/core/any_error.h"
#include "handpiece/base/core/error.h"

namespace handpiece::school_server {

Worker::Worker(std::unique_ptr<WorkSource> source, std::chrono::milliseconds pause)
    : source_(std::move(source)), pause_(pause) {}
Worker::~Worker() {
    stop();
}

void Worker::start() {
    thread_ = std::thread([this] { loop(); });
}
void Worker::stop() {
    {
        const std::lock_guard lock(mutex_);
        ends_ = true;
    }
    wake_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void Worker::loop() {
    constexpr std::chrono::milliseconds kLongest = std::chrono::minutes(1);
    std::chrono::milliseconds pause = pause_;
    std::string told;
    while (!ends_) {
        bool worked = false;
        try {
            worked = workOnce();
            pause = pause_;
            told.clear();
        } catch (const std::exception& e) {
            // The same is told once.
            const core::Error error = core::asError(e);
            const std::string what = error.what();
            if (refused_ && (error.id() == "not-enrolled" || error.id() == "code-other")) return refused_(error);
            if (told != what) std::fprintf(stderr, "handpiece-school: worker: %s\n", what.c_str());
            told = what;
            pause = std::min(2 * pause, kLongest);
        }
        std::unique_lock lock(mutex_);
        if (!worked) wake_.wait_for(lock, pause, [this] { return ends_.load(); });
    }
}

bool Worker::workOnce() {
    const std::unique_ptr<LentWork> work = source_->take();
    if (!work) return false;
    constexpr std::chrono::milliseconds kRenewal(kLeaseMs / 4);
    bool isLost = false;
    auto renewed = std::chrono::steady_clock::now();
    const core::Progress progress = [&](double) {
        if (ends_) return false;
        const auto now = std::chrono::steady_clock::now();
        if (now - renewed < kRenewal) return true;
        renewed = now;
        isLost = !work->renew();
        return !isLost;
    };
    try {
        const sandboxed::Files files = work->files(progress);
        work->enter(sandboxed::prove(work->question(), files, progress), progress);
    } catch (const core::Error& e) {
        // What is wrong here, or on the way, costs the work nothing. A reader was killed: not at once again.
        constexpr school::Milliseconds kPause = 10'000;
        const bool isHere = e.id() == "sandbox-start" || e.id() == "server-silent" || e.id() == "no-space" ||
                            e.id() == "not-writable" || e.problem() == "cancelled";
        const school::Milliseconds pause = e.id() == "sandbox-start"    ? 3 * kPause
                                           : e.id() == "sandbox-killed" ? work->turn() * kPause
                                                                        : 0;
        if (!isLost) work->giveBack(pause, !isHere);
        if (e.problem() != "cancelled") throw;
    }
    return true;
}

}  // namespace handpiece::school_server
