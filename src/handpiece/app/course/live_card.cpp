// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/course/live_card.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "handpiece/assess/measures/preparation.h"
#include "handpiece/base/core/alone.h"

namespace handpiece::course {
namespace {

constexpr std::array<std::string_view, 13> kShown{
    "axial-depth",   "cavosurface-angle",   "floor-depth",  "floor-depth-shortest", "isthmus",
    "isthmus-share", "marginal-ridge-left", "margin-width", "occlusal-convergence", "outline-extent",
    "reduction",     "wall-angle",          "wall-height"};

}  // namespace

std::vector<LiveValue> liveValues(const tasks::Task& task, const rubric::Rubric& rubric, const preparation::Laid& laid,
                                  const simulation::LiveTooth& tooth) {
    const core::Alone alone;
    std::vector<LiveValue> values;
    std::vector<measures::Request> requests;
    for (const rubric::Criterion& c : rubric.criteria) {
        if (std::find(kShown.begin(), kShown.end(), c.measure) == kShown.end()) continue;
        const report::Wanted wanted = report::wantedOf(c, rubric);
        if (!wanted.isAnything()) continue;
        values.push_back({c.id, c.unit, {}, wanted});
        requests.push_back({c.measure, c.of});
    }
    tooth::ToothMirror mirror(tooth.modelShared());
    mirror.apply(tooth.state({}));
    measures::Preparation preparation;
    preparation.whole = tooth.modelShared();
    preparation.cut = &mirror;
    preparation.landmarks = task.toothCase.landmarks;
    preparation.axes = measures::axesOf(task.toothCase.landmarks, task.toothCase.buccalSign);
    preparation.axes.draw = laid.draw;
    preparation.zones = laid.zones.get();
    if (task.preparation->kind() == "crown") preparation.form = measures::Form::crown;
    if (task.preparation->kind() == "onlay") preparation.form = measures::Form::cavity, preparation.isCapped = true;
    const std::vector<measures::Measured> measured = measures::measure(preparation, requests);
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i].value = measured[i].value;
        if (values[i].value) values[i].off = report::offOf(values[i].wanted, *values[i].value);
    }
    return values;
}

}  // namespace handpiece::course
