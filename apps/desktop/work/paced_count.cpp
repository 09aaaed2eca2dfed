// SPDX-License-Identifier: Apache-2.0
#include "desktop/work/paced_count.h"

#include <QElapsedTimer>
#include <algorithm>
#include <utility>

#include "handpiece/base/rt/realtime_thread.h"

namespace handpiece::desktop {

PacedCount::PacedCount(int pauseMs, QObject* parent) : QObject(parent), pauseMs_(pauseMs) {
    timer_.setInterval(pauseMs_);
    connect(&timer_, &QTimer::timeout, this, &PacedCount::due);
}

void PacedCount::start() {
    timer_.start(pauseMs_);
}

void PacedCount::stop() {
    timer_.stop();
    if (job_) job_.release()->abandon(this);
}

void PacedCount::run(std::function<void(const core::Progress&)> work, std::function<void()> done) {
    const auto tookMs = std::make_shared<qint64>(0);
    job_ = std::make_unique<Job>(QString(), [work = std::move(work), tookMs](const core::Progress& progress) {
        rt::stepBack();
        QElapsedTimer clock;
        clock.start();
        work(progress);
        *tookMs = clock.elapsed();
    });
    const auto end = [this] { job_.release()->deleteLater(); };
    connect(job_.get(), &Job::done, this, [this, end, tookMs, done = std::move(done)] {
        end();
        timer_.setInterval(std::max<int>(pauseMs_, static_cast<int>(*tookMs)));
        done();
    });
    connect(job_.get(), &Job::cancelled, this, end);
    connect(job_.get(), &Job::failed, this, [this, end] {
        end();
        timer_.stop();
    });
    job_->start();
}

}  // namespace handpiece::desktop
