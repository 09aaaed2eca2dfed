// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/assessment_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "handpiece/app/report/advice.h"
#include "handpiece/app/report/assessment_report.h"
#include "handpiece/app/report/sentence_places.h"
#include "handpiece/base/config/words.h"

namespace handpiece::report {
namespace {

using config::words;

template <class List>
std::string titleIn(const List& list, const std::string& id) {
    for (const auto& one : list)
        if (one.id == id)
            if (const auto said = cases::inLanguage(one.title, words().language()); !said.empty())
                return std::string(said);
    return id;
}

/// What measures say in English, under names that other languages have too. What is not among them stays as it is.
constexpr const char* kSaid[] = {
    "said.axial-wall",
    "said.margin",
    "said.floor-depth",
    "said.deepest-floor",
    "said.deepest-undercut",
    "said.finish-line",
    "said.margin-over-gingiva",
    "said.margin-over-foot",
    "said.middle-of-floor",
    "said.middle-of-isthmus",
    "said.open-pulp",
    "said.reduced",
    "said.section-here",
    "said.shortest-way",
    "said.thinnest-over-pulp",
    "said.thinnest-ridge",
    "said.still-to-cut",
    "said.this-surface",
    "said.wall",
    "said.nothing-cut",
    "said.nothing-cut-there",
    "said.no-pulp",
    "said.no-gingiva",
    "said.no-caries",
    "said.no-tooth-beside",
    "said.no-hand-in-scan",
    "said.too-shallow-for-pulp",
    "said.no-wall-over-margin",
    "said.no-axial-wall",
    "said.no-wall-to-surface",
    "said.no-cut-edge",
    "said.contact-not-opened",
    "said.no-margin-beside",
    "said.no-tooth-there",
    "said.too-little-surface",
    "said.not-under-roof",
    "said.few-sections",
    "said.no-section",
    "said.no-margin-under-wall",
    "said.no-finish-line-found",
    "said.no-margin-over-gingiva",
    "said.no-wall-out-of-tooth",
    "said.no-wall-out-of-cavity",
    "said.no-wall-that-side",
    "said.no-moving-stroke",
    "said.touched-nothing",
    "said.no-samples-found",
    "said.no-way-told",
    "said.no-clock",
    "said.hand-not-yet",
    "said.attempt",
    "said.cut-again",
    "said.not-cut-again",
    "said.ratios-of-negative",
    "said.too-many-marks",
    "said.none-by-two",
    "said.all-the-same",
    "said.items-alike",
    "said.cancels-out",
    "said.two-items",
    "said.no-samples",
    "said.no-facing-walls",
    "said.no-floor-faces",
    "said.no-lower-floor",
    "said.two-and-two",
    "said.one-category",
    "said.none-by-both",
    "said.one-mark-each",
    "said.mean-of-both",
    "said.difference",
    "said.bias",
    "said.bias-and-limits",
    "said.kappa-linear",
    "said.as-one",
    "said.by-chance",
    "said.least-here",
    "said.most-here",
    "said.first",
    "said.most-load",
    "said.least-smooth",
    "said.chamber-cut",
    "said.caries-here",
    "said.no-finish-line",
    "said.stalled",
    "said.most-tilted",
    "said.slowest",
    "said.taken-back",
    "said.over-limit",
    "said.nearest-beside",
};

/// Why work was refused, or another score was found, as the books keep it: {} stands for what differs.
constexpr const char* kReasons[] = {
    "reason.no-session",     "reason.other-exercise",
    "reason.other-number",   "reason.other-session",
    "reason.station-said",   "reason.other-device",
    "reason.attempt-gone",   "reason.another-person",
    "reason.no-exercise",    "reason.no-rubric",
    "reason.of-session",     "reason.full-removal",
    "reason.as-hull",        "reason.other-surroundings",
    "reason.foreign-bur",    "reason.unknown-bur",
    "reason.other-tissue",   "reason.bur-shape",
    "reason.bur-cuts",       "reason.unknown-drive",
    "reason.strong-drive",   "reason.other-engine",
    "reason.cut-off",        "reason.broken-pause",
    "reason.other-tooth",    "reason.goes-on",
    "reason.from-elsewhere", "reason.none-leaves",
    "reason.not-along",      "reason.than-its-sessions",
    "reason.went-wrong",
};

/// What it says of a session may be several sentences.
constexpr std::string_view kOfSession = "reason.of-session";

/// Of a place: what has a word of its own.
std::string placeSaid(const std::string& id, const std::string& place) {
    if (id == "reason.station-said" && (place == "yes" || place == "no" || place == "teacher"))
        return words().text(place == "yes"  ? "assessment.passed"
                            : place == "no" ? "assessment.not-passed"
                                            : "assessment.teacher");
    if (id == "reason.other-tissue" && words().has("tissue." + place)) return words().text("tissue." + place);
    return id == kOfSession ? reasonOf(place) : place;
}

bool isSeveral(const std::string& place) {
    return place.find("; ") != place.npos;
}

}  // namespace

std::string reasonOf(const std::string& english) {
    const config::Words& source = config::Words::in("en");
    for (const char* id : kReasons)
        if (auto places = placesIn(english, source.text(id));
            places && std::none_of(places->begin(), places->end() - (id == kOfSession ? 1 : 0), isSeveral)) {
            for (std::string& place : *places)
                place = placeSaid(id, place);
            return words()(config::Phrase{id, std::move(*places)});
        }
    // Several in one sentence.
    if (!isSeveral(english)) return said(english);
    const std::size_t next = english.find("; ");
    return reasonOf(english.substr(0, next)) + "; " + reasonOf(english.substr(next + 2));
}

std::string said(const std::string& english) {
    const config::Words& source = config::Words::in("en");
    for (const char* id : kSaid)
        if (source.text(id) == english) return words().text(id);
    return english;
}

std::string criterionTitle(const rubric::Rubric& rubric, const std::string& id) {
    return titleIn(rubric.criteria, id);
}

std::string bandTitle(const rubric::Rubric& rubric, const std::string& id) {
    return titleIn(rubric.bands, id);
}

std::string ruleTitle(const rubric::Rubric& rubric, const std::string& id) {
    return titleIn(rubric.rules, id);
}

std::string verdictOf(score::Passed passed) {
    return passed == score::Passed::yes  ? words()("assessment.passed")
           : passed == score::Passed::no ? words()("assessment.not-passed")
                                         : words()("assessment.teacher");
}

std::string whyOf(const score::Assessment& a, const rubric::Rubric& rubric) {
    const auto critical =
        std::find_if(a.critical.begin(), a.critical.end(), [](const auto& error) { return !error.borderline; });
    if (critical != a.critical.end())
        return words()("assessment.why-critical", whatHappened(rubric, critical->criterion));
    if (a.passed == score::Passed::yes) return words()("assessment.why-met");
    if (a.passed == score::Passed::no) {
        for (const score::RuleResult& r : a.rules)
            for (const rubric::Rule& rule : rubric.rules)
                if (rule.id == r.id && rule.required && r.holds == std::optional(false))
                    return words()("assessment.why-rule", ruleTitle(rubric, r.id));
        return words()("assessment.why-under-mark");
    }
    if (a.borderline) return words()("assessment.why-borderline");
    std::string missing;
    if (a.completeness && !a.completeness->value) missing = words()("rubric.completeness");
    for (const score::CriterionScore& c : a.criteria)
        if (c.standing == score::Standing::notMeasured && (c.maxPoints > 0.0 || !c.possibleBands.empty()))
            missing += (missing.empty() ? "" : ", ") + criterionTitle(rubric, c.id);
    return missing.empty() ? words()("assessment.why-unsaid") : words()("assessment.why-missing", missing);
}

std::string valueOf(const score::CriterionScore& s) {
    if (!s.value) return {};
    return fmt::format("{:.3g} ± {:.2g}{}{}", *s.value, s.uncertainty, s.unit.empty() ? "" : " ", s.unit);
}

std::string placeText(const measures::Evidence& e) {
    return fmt::format("{}{}x {:.2f}, y {:.2f}, z {:.2f} mm", said(e.text), e.text.empty() ? "" : ": ", e.placeMm->x(),
                       e.placeMm->y(), e.placeMm->z());
}

std::string viewTitle(const std::string& name) {
    return words().text("view." + name);
}

}  // namespace handpiece::report
