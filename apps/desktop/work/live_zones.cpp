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
    struct Counted {
        LiveShares shares;
        std::vector<course::LiveValue> values;
        qint64 tookMs = 0;
    };
    const auto now = std::make_shared<Counted>();
    job_ = std::make_unique<Job>(QString(), [now, watched = watched_](const core::Progress&) {
        rt::stepBack();
        QElapsedTimer clock;
        clock.start();
        if (!watched->laid)
            watched->laid = std::make_shared<const preparation::Laid>(
                preparation::layOn(watched->task->toothCase, *watched->task->preparation));
        now->shares = course::liveShares(*watched->laid->zones, *watched->tooth);
        if (watched->rubric)
            now->values = course::liveValues(*watched->task, *watched->rubric, *watched->laid, *watched->tooth);
        now->tookMs = clock.elapsed();
    });
    const auto end = [this] { job_.release()->deleteLater(); };
    connect(job_.get(), &Job::done, this, [this, end, now, hasValues = watched_->rubric != nullptr] {
        end();
        // At most half of the time.
        timer_.setInterval(std::max<int>(kPauseMs, static_cast<int>(now->tookMs)));
        emit counted(now->shares);
        if (hasValues) emit valued(now->values);
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
