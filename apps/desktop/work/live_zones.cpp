// SPDX-License-Identifier: Apache-2.0
#include "desktop/work/live_zones.h"

#include <QElapsedTimer>
#include <algorithm>

#include "handpiece/base/rt/realtime_thread.h"

namespace handpiece::desktop {
namespace {

constexpr int kPauseMs = 400;

}  // namespace

struct LiveZones::Watched {
    std::shared_ptr<const tasks::Task> task;
    std::shared_ptr<simulation::LiveTooth> tooth;
    std::shared_ptr<const preparation::Laid> laid;  ///< made by the first count
    std::shared_ptr<const rubric::Rubric> rubric;   ///< null: no values are taken
};

LiveZones::LiveZones(QObject* parent) : QObject(parent) {
    timer_.setInterval(kPauseMs);
    connect(&timer_, &QTimer::timeout, this, &LiveZones::count);
}

void LiveZones::watch(std::shared_ptr<const tasks::Task> task, std::shared_ptr<simulation::LiveTooth> tooth,
                      std::shared_ptr<const rubric::Rubric> rubric) {
    stop();
    if (!task || !task->preparation || !tooth) return;
    watched_ = std::make_shared<Watched>(Watched{std::move(task), std::move(tooth), nullptr, std::move(rubric)});
    removedMm3_ = 0.0;
    countedMm3_ = -1.0;
    timer_.start(kPauseMs);
}

void LiveZones::stop() {
    timer_.stop();
    watched_.reset();
    if (job_) job_.release()->abandon(this);
}

void LiveZones::count() {
    if (!watched_ || job_ || (removedMm3_ == countedMm3_ && isSure_)) return;
    isSure_ = removedMm3_ == countedMm3_;
    countedMm3_ = removedMm3_;
    const auto shares = std::make_shared<LiveShares>();
    run(
        [shares](Watched& watched) {
            if (!watched.laid)
                watched.laid = std::make_shared<const preparation::Laid>(
                    preparation::layOn(watched.task->toothCase, *watched.task->preparation));
            *shares = course::liveShares(*watched.laid->zones, *watched.tooth);
        },
        [this, shares] {
            emit counted(*shares);
            if (watched_ && watched_->rubric) value();
        });
}

/// The numbers take longer than the shares, which do not wait for them.
void LiveZones::value() {
    const auto values = std::make_shared<std::vector<course::LiveValue>>();
    run(
        [values](Watched& watched) {
            *values = course::liveValues(*watched.task, *watched.rubric, *watched.laid, *watched.tooth);
        },
        [this, values] { emit valued(*values); });
}

void LiveZones::run(std::function<void(Watched&)> work, std::function<void()> done) {
    const auto tookMs = std::make_shared<qint64>(0);
    job_ =
        std::make_unique<Job>(QString(), [work = std::move(work), tookMs, watched = watched_](const core::Progress&) {
            rt::stepBack();
            QElapsedTimer clock;
            clock.start();
            work(*watched);
            *tookMs = clock.elapsed();
        });
    const auto end = [this] { job_.release()->deleteLater(); };
    connect(job_.get(), &Job::done, this, [this, end, tookMs, done = std::move(done)] {
        end();
        // At most half of the time.
        timer_.setInterval(std::max<int>(kPauseMs, static_cast<int>(*tookMs)));
        done();
    });
    connect(job_.get(), &Job::cancelled, this, end);
    // The preparation does not lie on this tooth, which finishing tells: there is nothing to count.
    connect(job_.get(), &Job::failed, this, [this, end] {
        end();
        timer_.stop();
    });
    job_->start();
}

}  // namespace handpiece::desktop
