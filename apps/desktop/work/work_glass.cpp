// SPDX-License-Identifier: Apache-2.0
#include "desktop/work/work_glass.h"

#include <QColor>
#include <utility>

#include "desktop/work/zone_glass.h"
#include "handpiece/app/course/live_glass.h"

namespace handpiece::desktop {
namespace {

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
    connect(&count_, &PacedCount::due, this, &WorkGlass::make);
}

void WorkGlass::watch(std::shared_ptr<const tasks::Task> task, std::shared_ptr<simulation::LiveTooth> tooth) {
    if (watched_ && watched_->task == task && watched_->tooth == tooth) return;
    stop();
    if (!task || !task->preparation || !tooth) return;
    watched_ = std::make_shared<Watched>(Watched{std::move(task), std::move(tooth), nullptr});
    removedMm3_ = 0.0;
    madeMm3_ = -1.0;
    make();
    count_.start();
}

void WorkGlass::stop() {
    count_.stop();
    watched_.reset();
    if (surfaces_.empty()) return;
    surfaces_.clear();
    emit changed();
}

void WorkGlass::make() {
    if (!watched_ || count_.isBusy() || (removedMm3_ == madeMm3_ && isSure_)) return;
    isSure_ = removedMm3_ == madeMm3_;
    madeMm3_ = removedMm3_;
    const auto made = std::make_shared<std::vector<view::GlassSurface>>();
    const auto work = [made, watched = watched_](const core::Progress& progress) {
        if (!watched->laid)
            watched->laid = std::make_shared<const preparation::Laid>(
                preparation::layOn(watched->task->toothCase, *watched->task->preparation));
        core::report(progress, 0.3);
        course::LiveGlass glass = course::liveGlass(*watched->laid, *watched->tooth);
        if (!glass.left.triangles.empty())
            made->push_back(
                glassOf(std::move(glass.left), ZoneGlass::colourOf(preparation::SeenZone::target), kLeftOpacity));
        // Reddish purple of Okabe & Ito; the stripes tell it from all else without any colour.
        if (!glass.over.triangles.empty())
            made->push_back(glassOf(std::move(glass.over), QColor(204, 121, 167), kOverOpacity));
    };
    count_.run(work, [this, made] {
        surfaces_ = std::move(*made);
        emit changed();
    });
}

}  // namespace handpiece::desktop
