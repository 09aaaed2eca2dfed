// SPDX-License-Identifier: Apache-2.0
#include "desktop/work/live_zones.h"

#include <utility>

#include "handpiece/base/core/alone.h"

namespace handpiece::desktop {
struct LiveZones::Watched {
    std::shared_ptr<const tasks::Task> task;
    std::shared_ptr<simulation::LiveTooth> tooth;
    std::shared_ptr<const preparation::Laid> laid;  ///< made by the first count, as the next
    zones::WholeVolumes whole{};
    std::shared_ptr<const rubric::Rubric> rubric;  ///< null: no values are taken
};

LiveZones::LiveZones(QObject* parent) : QObject(parent) {
    connect(&count_, &PacedCount::due, this, &LiveZones::count);
}

void LiveZones::watch(std::shared_ptr<const tasks::Task> task, std::shared_ptr<simulation::LiveTooth> tooth,
                      std::shared_ptr<const rubric::Rubric> rubric) {
    stop();
    if (!task || !task->preparation || !tooth) return;
    watched_ = std::make_shared<Watched>(Watched{std::move(task), std::move(tooth), nullptr, {}, std::move(rubric)});
    removedMm3_ = 0.0;
    countedMm3_ = -1.0;
    count_.start();
}

void LiveZones::stop() {
    count_.stop();
    watched_.reset();
}

void LiveZones::count() {
    if (!watched_ || count_.isBusy() || (removedMm3_ == countedMm3_ && isSure_)) return;
    isSure_ = removedMm3_ == countedMm3_;
    countedMm3_ = removedMm3_;
    const auto shares = std::make_shared<LiveShares>();
    run(
        [shares](Watched& watched, const core::Progress& progress) {
            if (!watched.laid) {
                const core::Alone alone;
                const auto laid = std::make_shared<const preparation::Laid>(
                    preparation::layOn(watched.task->toothCase, *watched.task->preparation));
                core::report(progress, 0.3);
                watched.whole = zones::wholeVolumes(*laid->zones, watched.tooth->model());
                watched.laid = laid;
                core::report(progress, 0.8);
            }
            *shares = course::liveShares(*watched.laid->zones, watched.whole, *watched.tooth);
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
        [values](Watched& watched, const core::Progress&) {
            *values = course::liveValues(*watched.task, *watched.rubric, *watched.laid, *watched.tooth);
        },
        [this, values] { emit valued(*values); });
}

void LiveZones::run(std::function<void(Watched&, const core::Progress&)> work, std::function<void()> done) {
    count_.run(
        [work = std::move(work), watched = watched_](const core::Progress& progress) { work(*watched, progress); },
        std::move(done));
}

}  // namespace handpiece::desktop
