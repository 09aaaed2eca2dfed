// SPDX-License-Identifier: Apache-2.0
#include "desktop/work/zone_glass.h"

#include <algorithm>

#include "handpiece/base/rt/realtime_thread.h"

namespace handpiece::desktop {

using preparation::SeenZone;

QColor ZoneGlass::colourOf(SeenZone zone) {
    // Of Okabe & Ito, told apart with any colour vision.
    switch (zone) {
        case SeenZone::target:
            return {0, 158, 115};
        case SeenZone::leeway:
            return {240, 228, 66};
        case SeenZone::protectedZone:
            return {213, 94, 0};
        case SeenZone::container:
            break;
    }
    return {86, 180, 233};
}

void ZoneGlass::show(std::shared_ptr<const cases::Case> toothCase, const preparation::Recipe& recipe) {
    wish_ = Wish{std::move(toothCase), recipe};
    make();
}

void ZoneGlass::hide() {
    wish_.reset();
    isStale_ = false;
    if (job_) job_->cancel();
    laid_.reset();
    surfaces_.clear();
    emit changed();
}

void ZoneGlass::setZones(std::set<SeenZone> zones) {
    if (zones == zones_) return;
    zones_ = std::move(zones);
    if (wish_) make();
}

void ZoneGlass::make() {
    if (job_) {
        isStale_ = true;
        if (!isCoarse_) job_->cancel();
        return;
    }
    isStale_ = false;
    struct Made {
        std::shared_ptr<const preparation::Laid> laid;
        std::vector<view::GlassSurface> surfaces;
    };
    const auto made = std::make_shared<Made>();
    const double finestMm = isCoarse_ ? 0.2 : 0.1;
    job_ = std::make_unique<Job>(QString(), [made, wish = *wish_, zones = zones_, finestMm,
                                             whole = isLaidTooth() ? whole_ : nullptr](const core::Progress& progress) {
        rt::stepBack();
        made->laid = std::make_shared<const preparation::Laid>(preparation::layOn(*wish.toothCase, wish.recipe, whole));
        double done = 0.0;
        const double share = 1.0 / static_cast<double>(std::max<std::size_t>(1, zones.size()));
        // The innermost first: glass lies over what is drawn before it.
        for (const SeenZone zone : {SeenZone::protectedZone, SeenZone::target, SeenZone::leeway, SeenZone::container}) {
            if (!zones.contains(zone)) continue;
            auto mesh = std::make_shared<const geometry::TriangleMesh>(preparation::zoneSurface(
                zone, *wish.toothCase, wish.recipe, *made->laid, core::part(progress, done, done + share), finestMm));
            done += share;
            if (mesh->triangles.empty()) continue;
            const QColor colour = colourOf(zone);
            made->surfaces.push_back({std::move(mesh),
                                      {static_cast<float>(colour.redF()), static_cast<float>(colour.greenF()),
                                       static_cast<float>(colour.blueF())},
                                      zone == SeenZone::target   ? 0.34f
                                      : zone == SeenZone::leeway ? 0.16f
                                                                 : 0.2f});
        }
    });
    // Of one that is out of date nothing is heard but that it is over; while numbers are dragged it is better than
    // none.
    const auto end = [this, wasCoarse = isCoarse_] {
        job_.release()->deleteLater();
        if (isStale_ && wish_) {
            make();
            return !wasCoarse;
        }
        isStale_ = false;
        return !wish_.has_value();
    };
    connect(job_.get(), &Job::cancelled, this, [end] { end(); });
    connect(job_.get(), &Job::failed, this, [this, end](const Problem& problem) {
        if (end()) return;
        laid_.reset();
        surfaces_.clear();
        emit changed();
        emit refused(problem);
    });
    connect(job_.get(), &Job::done, this, [this, end, made, of = *wish_] {
        laidCase_ = of.toothCase;
        whole_ = made->laid->whole;
        if (end()) return;
        laid_ = made->laid;
        laidRecipe_ = of.recipe;
        surfaces_ = made->surfaces;
        emit changed();
    });
    job_->start();
}

}  // namespace handpiece::desktop
