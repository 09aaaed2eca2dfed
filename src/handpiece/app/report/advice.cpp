// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "handpiece/app/report/assessment_words.h"
#include "handpiece/base/config/words.h"

namespace handpiece::report {
namespace {

using config::words;

/// Which sentences a measure has (advice.NAME-low and -high), and what trains it.
struct Row {
    std::string_view measure, narrowed, name, exercise;  ///< narrowed: by zone or tissue; "*": by any; empty: by none
};
// The first that fits. Whole names but for a dash at the end, which stands for all that begin so.
constexpr std::array kRows{
    Row{"floor-depth", "", "depth", "dexterity-steps"},
    Row{"floor-depth-shortest", "", "depth", "dexterity-steps"},
    Row{"axial-depth", "", "axial", "dexterity-channel"},
    Row{"floor-flatness", "", "flat", "dexterity-channel"},
    Row{"floor-tilt", "", "level", "dexterity-steps"},
    Row{"isthmus", "", "width", "dexterity-line"},
    Row{"isthmus-share", "", "width", "dexterity-line"},
    Row{"outline-extent", "", "extent", "dexterity-cross"},
    Row{"marginal-ridge-left", "", "ridge", ""},
    Row{"proximal-clearance", "", "gap", ""},
    Row{"wall-angle", "", "wall", "dexterity-channel"},
    Row{"cavosurface-angle", "", "edge", ""},
    Row{"wall-height", "", "height", ""},
    Row{"occlusal-convergence", "", "taper", ""},
    Row{"reduction", "", "reduction", ""},
    Row{"undercut-", "", "undercut", "dexterity-channel"},
    Row{"roughness", "", "rough", ""},
    Row{"margin-width", "", "margin-width", "dexterity-d-circle"},
    Row{"margin-continuity", "", "margin-round", "dexterity-d-circle"},
    Row{"margin-height", "", "margin-height", "dexterity-d-circle"},
    Row{"remaining-dentine", "", "dentine", ""},
    Row{"pulp-exposed", "", "pulp", ""},
    Row{"gouge-depth", "", "gouge", ""},
    Row{"orifices-reached", "", "orifices", ""},
    Row{"adjacent-", "", "adjacent", ""},
    Row{"caries-left", "*", "caries", "block-caries"},
    Row{"caries-left", "", "caries", "block-caries"},
    Row{"caries-left-", "*", "caries", "block-caries"},
    Row{"caries-left-", "", "caries", "block-caries"},
    Row{"unsupported-enamel", "", "enamel", ""},
    Row{"removed", "target", "target", "dexterity-line"},
    Row{"removed-share", "target", "target", "dexterity-line"},
    Row{"removed", "leeway-side", "beside", "dexterity-cross"},
    Row{"removed-share", "leeway-side", "beside", "dexterity-cross"},
    Row{"removed", "leeway-floor", "under", "dexterity-steps"},
    Row{"removed-share", "leeway-floor", "under", "dexterity-steps"},
    Row{"removed", "container", "beyond", "dexterity-cross"},
    Row{"removed-share", "container", "beyond", "dexterity-cross"},
    Row{"removed", "protected", "kept", ""},
    Row{"removed-share", "protected", "kept", ""},
    Row{"removed", "*", "sound", ""},
    Row{"removed-share", "*", "sound", ""},
    Row{"removed", "", "removed", ""},
    Row{"removed-share", "", "removed", ""},
    Row{"impulse-on-protected", "gum", "gingiva", ""},
    Row{"impulse-not-undone", "gum", "gingiva", ""},
    Row{"impulse-", "*", "pressed", ""},
    Row{"impulse-", "", "pressed", ""},
    Row{"force", "", "load", ""},
    Row{"load-over-", "", "load", ""},
    Row{"speed-under-load", "", "speed", ""},
    Row{"stalls", "", "stalls", ""},
    Row{"smoothness", "", "smooth", "dexterity-circle"},
    Row{"path-length", "", "path", "dexterity-line"},
    Row{"tilt", "", "tilt", ""},
    Row{"mirror-share", "", "mirror", "block-cross-mirror"},
    Row{"views", "", "views", ""},
    Row{"finger-rest-share", "", "rest", ""},
    Row{"depth-stop-share", "", "stop", ""},
    Row{"time", "", "time", ""},
    Row{"drill-time", "", "time", ""},
    Row{"idle-time", "", "idle", ""},
    Row{"strokes", "", "strokes", ""},
    Row{"bur-changes", "", "strokes", ""},
    Row{"undos", "", "undos", ""},
};
constexpr Row kOther{"", "", "other", ""};

const Row& rowOf(const score::CriterionScore& c) {
    const std::string& by = c.of.zone.empty() ? c.of.tissue : c.of.zone;
    const auto fits = [&](const Row& row) {
        const bool isThis = row.measure.ends_with('-') ? std::string_view(c.measure).starts_with(row.measure)
                                                       : c.measure == row.measure;
        return isThis && (row.narrowed == by || (row.narrowed == "*" && !by.empty()));
    };
    const auto* const row = std::find_if(kRows.begin(), kRows.end(), fits);
    return row == kRows.end() ? kOther : *row;
}

/// That a value was taken of many places, of which one stands out.
bool isOfMany(const measures::Evidence& e) {
    return e.text == measures::kLeastHere || e.text == measures::kMostHere || e.text == "most is still to be cut here";
}

/// " mesially", ", most of all mesially"; empty: there is nothing to be said.
std::string whereOf(const score::CriterionScore& c, const measures::Evidence* at, const Bearings& bearings) {
    if (c.measure == "outline-extent") {
        const std::string word = axisWord(bearings, c.of.side);
        return word.empty() ? word : words()("advice.where", word);
    }
    if (const std::string word = sideWord(bearings, c.of.side); !word.empty()) return words()("advice.where", word);
    // Where several are missing the first of them is no side.
    if (c.measure == "orifices-reached" && c.evidence.size() > 1) return {};
    if (at == nullptr || !at->placeMm) return {};
    const std::string word = sideWord(bearings, sideOf(bearings, *at->placeMm));
    if (word.empty()) return {};
    return words()(isOfMany(*at) ? "advice.most" : "advice.where", word);
}

/// What is wrong, without what to do about it.
std::string firstPartOf(const std::string& sentence) {
    std::size_t end = sentence.size();
    for (const char* stop : {": ", ". ", "。"})
        end = std::min(end, sentence.find(stop));
    return sentence.substr(0, end);
}

}  // namespace

const measures::Evidence* placeOf(const score::CriterionScore& score, Off off) {
    const measures::Evidence* first = nullptr;
    for (const measures::Evidence& e : score.evidence) {
        if (!e.placeMm && !e.timeS) continue;
        if ((off == Off::tooLow && e.text == measures::kLeastHere) ||
            (off == Off::tooHigh && e.text == measures::kMostHere))
            return &e;
        if (first == nullptr) first = &e;
    }
    return first;
}

Advice adviceOf(const score::CriterionScore& score, const rubric::Rubric& rubric, const Bearings& bearings) {
    Advice advice;
    const rubric::Criterion* criterion = rubric.criterion(score.id);
    if (criterion == nullptr || !score.value) return advice;
    const Wanted wanted = wantedOf(*criterion, rubric);
    advice.off = offOf(wanted, *score.value);
    advice.at = placeOf(score, advice.off);
    if (advice.off == Off::no) return advice;
    const Row& row = rowOf(score);
    const auto idOf = [&](std::string_view name) {
        return fmt::format("advice.{}-{}", name, advice.off == Off::tooLow ? "low" : "high");
    };
    // Of a few kinds only one side can be wrong; a rubric of one's own may ask for the other all the same.
    const bool hasOwn = words().has(idOf(row.name));
    advice.words = words()(config::phrase(idOf(hasOwn ? row.name : kOther.name),
                                          amountText(offBy(wanted, *score.value), score.unit),
                                          whereOf(score, advice.at, bearings)));
    advice.fault = firstPartOf(advice.words);
    if (hasOwn) advice.exercise = row.exercise;
    return advice;
}

std::string whatHappened(const rubric::Rubric& rubric, const std::string& criterion) {
    if (const rubric::Criterion* c = rubric.criterion(criterion); c != nullptr && c->critical)
        if (const auto text = cases::inLanguage(c->critical->title, words().language()); !text.empty())
            return std::string(text);
    return criterionTitle(rubric, criterion);
}

std::string whatHappened(const rubric::Rubric& rubric, const score::CriterionScore& score, const Bearings& bearings) {
    std::string what = whatHappened(rubric, score.id), how;
    const auto add = [&how](const std::string& one) {
        if (!one.empty()) how += (how.empty() ? "" : ", ") + one;
    };
    if (score.value) add(amountText(*score.value, score.unit));
    const rubric::Criterion* criterion = rubric.criterion(score.id);
    const measures::Evidence* at =
        placeOf(score, criterion && score.value ? offOf(wantedOf(*criterion, rubric), *score.value) : Off::no);
    if (at != nullptr) {
        if (at->placeMm) add(sideWord(bearings, sideOf(bearings, *at->placeMm)));
        if (at->timeS) add(words()("advice.at-second", fmt::format("{:.1f}", *at->timeS)));
    }
    return how.empty() ? what : words()("advice.happened", what, how);
}

}  // namespace handpiece::report
