// SPDX-License-Identifier: Apache-2.0
#include "desktop/work/work_glass.h"

#include <QColor>
#include <algorithm>

#include "desktop/work/zone_glass.h"
#include "handpiece/app/course/live_glass.h"
#include "handpiece/base/rt/realtime_thread.h"

namespace handpiece::desktop {
namespace {

constexpr int kPauseMs = 500;
constexpr float kLeftOpacity = 0.34f, kOverOpacity = 0.9f;

view::GlassSurface glassOf(geometry::TriangleMesh&& mesh, const QColor& colour, float opacity) {
    return {
        std::make_shared<const geometry::TriangleMesh>(std::move(mesh)),
        {static_cast<float>(colour.redF()), static_cast<float>(colour.greenF()), static_cast<float>(colour.blueF())},
        opacity};
}

}  // namespace

struct WorkGlass::Watched {
    std::shared_ptr<const tasks::Task> task;
    std::shared_ptr<simulation::LiveTooth> tooth;
    std::shared_ptr<const preparation::Laid> laid;  ///< made by the first
};

WorkGlass::WorkGlass(QObject* parent) : QObject(parent) {
    timer_.setInterval(kPauseMs);
    connect(&timer_, &QTimer::timeout, this, &WorkGlass::make);
}

void WorkGlass::watch(std::shared_ptr<const tasks::Task> task, std::shared_ptr<simulation::LiveTooth> tooth) {
    if (watched_ && watched_->task == task && watched_->tooth == tooth) return;
    stop();
    if (!task || !task->preparation || !tooth) return;
    watched_ = std::make_shared<Watched>(Watched{std::move(task), std::move(tooth), nullptr});
    removedMm3_ = 0.0;
    madeMm3_ = -1.0;
    make();
    timer_.start(kPauseMs);
}

void WorkGlass::stop() {
    timer_.stop();
    watched_.reset();
    if (job_) job_.release()->abandon(this);
    if (surfaces_.empty()) return;
    surfaces_.clear();
    emit changed();
}

void WorkGlass::make() {
    if (!watched_ || job_ || (removedMm3_ == madeMm3_ && isSure_)) return;
    isSure_ = removedMm3_ == madeMm3_;
    madeMm3_ = removedMm3_;
    struct Made {
        std::vector<view::GlassSurface> surfaces;
        qint64 tookMs = 0;
    };
    const auto made = std::make_shared<Made>();
    job_ = std::make_unique<Job>(QString(), [made, watched = watched_](const core::Progress&) {
        rt::stepBack();
        QElapsedTimer clock;
        clock.start();
        if (!watched->laid)
            watched->laid = std::make_shared<const preparation::Laid>(
                preparation::layOn(watched->task->toothCase, *watched->task->preparation));
        course::LiveGlass glass = course::liveGlass(*watched->laid, *watched->tooth);
        if (!glass.left.triangles.empty())
            made->surfaces.push_back(
                glassOf(std::move(glass.left), ZoneGlass::colourOf(preparation::SeenZone::target), kLeftOpacity));
        // Reddish purple of Okabe & Ito; the stripes tell it from all else without any colour.
        if (!glass.over.triangles.empty())
            made->surfaces.push_back(glassOf(std::move(glass.over), QColor(204, 121, 167), kOverOpacity));
        made->tookMs = clock.elapsed();
    });
    const auto end = [this] { job_.release()->deleteLater(); };
    connect(job_.get(), &Job::done, this, [this, end, made] {
        end();
        timer_.setInterval(std::max<int>(kPauseMs, static_cast<int>(made->tookMs)));
        surfaces_ = std::move(made->surfaces);
        emit changed();
    });
    connect(job_.get(), &Job::cancelled, this, end);
    // The preparation does not lie on this tooth, which finishing tells.
    connect(job_.get(), &Job::failed, this, [this, end] {
        end();
        timer_.stop();
    });
    job_->start();
}

}  // namespace handpiece::desktop
