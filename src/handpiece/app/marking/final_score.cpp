// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/app/marking/desk.h"
#include "handpiece/base/core/error.h"

namespace handpiece::marking {
namespace {

using rubric::Band;
using rubric::Criterion;
using score::CriterionScore;

/// A measure that takes any number as its limit: each criterion that was overridden stands on one of its own, so that
/// another criterion on the same measure as before keeps what was measured.
constexpr const char* kCarrier = "load-over-limit";

/// Points (0 to 100) of the place in a band that is nearest to what was measured.
std::optional<double> pointsOfBand(const Criterion& c, const std::string& band, const std::optional<double>& value) {
    std::optional<double> best;
    double bestWay = 0.0;
    for (const Band& one : c.bands) {
        if (one.id != band) continue;
        if (one.points && c.knots.empty()) return one.points;
        if (!value) continue;
        const double nearest = std::clamp(*value, one.from.value_or(std::min(*value, one.to.value_or(*value))),
                                          one.to.value_or(std::max(*value, one.from.value_or(*value))));
        const double way = std::abs(nearest - *value);
        if (best && way >= bestWay) continue;
        best = rubric::pointsOf(c, nearest);
        bestWay = way;
    }
    return best;
}

[[noreturn]] void refuse(const Criterion& c, const std::string& problem, const std::string& remedy) {
    throw core::Error(problem, "criterion " + c.id, remedy);
}

}  // namespace

score::Assessment withOverrides(const rubric::Rubric& rubric, const score::Assessment& machine, const Sheet& sheet) {
    rubric::Rubric judged = rubric;
    std::vector<measures::Measured> measured;
    std::vector<std::string> given;
    const auto add = [&](const auto& asks, const auto& was) {
        measured.push_back(
            {asks.measure, asks.of, was.value, was.uncertainty, was.value ? std::string() : was.reason, was.evidence});
    };
    for (std::size_t i = 0; i < judged.criteria.size(); ++i) {
        Criterion& c = judged.criteria[i];
        const auto at = std::find_if(machine.criteria.begin(), machine.criteria.end(),
                                     [&](const CriterionScore& s) { return s.id == c.id; });
        if (at == machine.criteria.end()) refuse(c, "the score has no such criterion", "score it again");
        const CriterionScore& was = *at;
        const auto said = sheet.overrides.find(c.id);
        if (said == sheet.overrides.end()) {
            add(c, was);
            continue;
        }
        const Override& o = said->second;
        if (o.points && !c.isGraded()) refuse(c, "it gives no points", "choose a band, or whether it is critical");
        if (o.points && !(*o.points >= 0.0 && *o.points <= c.weight))
            refuse(c, fmt::format("{} points", *o.points), fmt::format("give 0 to {:g}", c.weight));
        const bool hasBand = std::any_of(c.bands.begin(), c.bands.end(), [&](const Band& b) { return b.id == o.band; });
        if (!o.band.empty() && !hasBand)
            refuse(c, fmt::format("it has no band \"{}\"", o.band), "choose one of its own");
        const std::string band = o.band.empty() ? was.band : o.band;
        if (!c.bands.empty() && band.empty())
            refuse(c, "nothing was measured, so no band stands", "choose a band as well");
        std::optional<double> share;  // 0 to 100
        if (c.isGraded()) {
            if (o.points) given.push_back(c.id);
            if (o.points)
                share = *o.points == c.weight ? 100.0 : 100.0 * *o.points / c.weight;
            else if (!o.band.empty())
                share = pointsOfBand(c, o.band, was.value);
            else if (was.points)
                share = was.ownPoints == c.weight ? 100.0 : 100.0 * was.ownPoints / c.weight;
            if (!share) refuse(c, "nothing was measured, so the band alone gives no points", "give points as well");
        }
        // Whatever it was measured at, it comes to this.
        c.measure = kCarrier;
        c.unit = "s";
        c.of = {};
        c.of.limit = 1.0 + static_cast<double>(i);
        c.devices.clear();
        c.bands.clear();
        c.knots.clear();
        if (!band.empty()) c.bands.push_back({band, {}, {}, share, 0});
        if (share && band.empty()) c.knots = {{0.0, *share}, {2.0, *share}};
        measures::Measured one{c.measure, c.of, 1.0, 0.0, {}, {}};
        const score::Verdict critical = o.critical   ? (*o.critical ? score::Verdict::yes : score::Verdict::no)
                                        : c.critical ? was.critical
                                                     : score::Verdict::no;
        if (critical == score::Verdict::no) {
            c.critical.reset();
        } else {
            c.critical.emplace();
            c.critical->below = critical == score::Verdict::yes ? 2.0 : 1.2;
            if (critical == score::Verdict::borderline) one.uncertainty = 0.5;
        }
        measured.push_back(std::move(one));
    }
    // How far the work is done is told after the criteria: one that measures the same finds what is its own.
    if (judged.completeness && machine.completeness) add(*judged.completeness, *machine.completeness);
    score::Assessment result = score::evaluate(judged, measured, machine.context, given);
    result.rubricHash = machine.rubricHash;
    for (std::size_t i = 0; i < result.criteria.size(); ++i) {
        CriterionScore& c = result.criteria[i];
        if (!sheet.overrides.contains(c.id)) continue;
        const auto was = std::find_if(machine.criteria.begin(), machine.criteria.end(),
                                      [&](const CriterionScore& s) { return s.id == c.id; });
        c.measure = was->measure;
        c.unit = was->unit;
        c.of = was->of;
        c.value = was->value;
        c.uncertainty = was->uncertainty;
        c.evidence = was->evidence;
    }
    return result;
}

}  // namespace handpiece::marking
