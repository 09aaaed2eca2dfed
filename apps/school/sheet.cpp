// SPDX-License-Identifier: Apache-2.0
#include "school/sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "handpiece/app/marking/returned_marks.h"
#include "handpiece/app/report/assessment_words.h"
#include "handpiece/base/config/outside_json.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"

namespace handpiece::school_server {
namespace {

using config::words;
using marking::kTotal;

constexpr const char* kCannotTell = "?";
constexpr std::size_t kMostTyped = 4000;

std::string trimmed(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n"), last = text.find_last_not_of(" \t\r\n");
    return first == std::string::npos ? std::string() : text.substr(first, last - first + 1);
}
std::string titleOf(const rubric::Rubric& rubric, const std::string& id) {
    return id == kTotal ? words()("agreement.all-points") : report::criterionTitle(rubric, id);
}
bool takesBand(const rubric::Rubric& rubric, const std::string& id) {
    const rubric::Criterion* c = rubric.criterion(id);
    return c != nullptr && !c->bands.empty();
}
/// The points of a band that has a number of its own.
std::optional<double> pointsOf(const rubric::Criterion& c, const marking::Mark& mark) {
    if (mark.points) return mark.points;
    for (const rubric::Band& band : c.bands)
        if (band.id == mark.band && band.points) return *band.points * c.weight / 100.0;
    return {};
}
/// Of all that is graded; none where one has none.
std::optional<double> sumOf(const rubric::Rubric& rubric, const std::map<std::string, marking::Mark>& marks) {
    double sum = 0.0;
    for (const rubric::Criterion& c : rubric.criteria) {
        if (!c.isGraded()) continue;
        const auto mark = marks.find(c.id);
        const std::optional<double> points = mark == marks.end() ? std::nullopt : pointsOf(c, mark->second);
        if (!points) return {};
        sum += *points;
    }
    return sum;
}

}  // namespace

std::string fieldOf(const Fields& fields, const std::string& name) {
    const auto found = fields.find(name);
    return found == fields.end() ? std::string() : found->second;
}

std::optional<double> numberIn(std::string text) {
    text = trimmed(text);
    std::replace(text.begin(), text.end(), ',', '.');
    double value = 0.0;
    const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || ec != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
    return value;
}

std::string ratingWord(int rating) {
    constexpr std::array kWords = {"school-teaching.rating-1", "school-teaching.rating-2", "school-teaching.rating-3",
                                   "school-teaching.rating-4", "school-teaching.rating-5"};
    static_assert(kWords.size() == static_cast<std::size_t>(kMostRating));
    return words()(kWords.at(static_cast<std::size_t>(rating - 1)));
}

Sheet readSheet(const rubric::Rubric& rubric, const Fields& fields) {
    Sheet sheet;
    const auto wrong = [&](const std::string& field, std::string what) { sheet.wrong.emplace(field, std::move(what)); };
    for (const std::string& id : marking::askedOf(rubric)) {
        const std::string field = "m." + id, typed = trimmed(fieldOf(fields, field));
        marking::Mark mark;
        if (typed == kCannotTell) {
            mark.cannotTell = true;
        } else if (typed.empty()) {
            const std::optional<double> sum = id == kTotal ? sumOf(rubric, sheet.marks) : std::nullopt;
            if (!sum) {
                wrong(field, takesBand(rubric, id)
                                 ? words()("school-teaching.choose-one")
                                 : words()("school-teaching.give-points", marking::mostOf(rubric, id)));
                continue;
            }
            mark.points = std::min(*sum, marking::mostOf(rubric, id));
        } else if (takesBand(rubric, id)) {
            mark.band = typed;
        } else if (!(mark.points = numberIn(typed))) {
            wrong(field, words()("school-teaching.give-points", marking::mostOf(rubric, id)));
            continue;
        }
        try {
            marking::requireMark(rubric, id, mark, id);
            sheet.marks.emplace(id, mark);
        } catch (const core::Error&) {
            wrong(field, takesBand(rubric, id) ? words()("school-teaching.choose-one")
                                               : words()("school-teaching.give-points", marking::mostOf(rubric, id)));
        }
    }
    sheet.verdict = fieldOf(fields, "verdict");
    if (sheet.verdict != "yes" && sheet.verdict != "no" && sheet.verdict != "teacher")
        wrong("verdict", words()("school-teaching.choose-one"));
    if (const std::string typed = fieldOf(fields, "rating"); !typed.empty()) {
        const std::optional<double> rating = numberIn(typed);
        if (rating && *rating >= 1.0 && *rating <= kMostRating && *rating == std::floor(*rating))
            sheet.rating = static_cast<int>(*rating);
        else
            wrong("rating", words()("school-teaching.choose-one"));
    } else {
        wrong("rating", words()("school-teaching.choose-one"));
    }
    const auto comment = [&](const std::string& field, const std::string& criterion) {
        const std::string text = trimmed(fieldOf(fields, field));
        if (text.size() > kMostTyped) return wrong(field, words()("school-teaching.too-long", kMostTyped));
        if (!text.empty()) sheet.comments.push_back({0, criterion, text, {}, {}, {}});
    };
    for (const rubric::Criterion& c : rubric.criteria)
        comment("c." + c.id, c.id);
    comment("comment", {});
    return sheet;
}

std::vector<report::FormField> sheetFields(const rubric::Rubric& rubric, const Fields& typed,
                                           const std::map<std::string, std::string>& wrong) {
    std::vector<report::FormField> all;
    const auto field = [&](const std::string& name, std::string label, const char* kind) -> report::FormField& {
        report::FormField one{name, std::move(label), kind, fieldOf(typed, name)};
        if (const auto found = wrong.find(name); found != wrong.end()) one.wrong = found->second;
        all.push_back(std::move(one));
        return all.back();
    };
    for (const std::string& id : marking::askedOf(rubric)) {
        field({}, titleOf(rubric, id), "group");
        const rubric::Criterion* c = rubric.criterion(id);
        if (c != nullptr && !c->bands.empty()) {
            report::FormField& one = field("m." + id, words()("assessment.band"), "radio");
            // Each once, in the rubric's order of bands.
            for (const rubric::BandName& name : rubric.bands)
                if (std::any_of(c->bands.begin(), c->bands.end(),
                                [&](const rubric::Band& band) { return band.id == name.id; }))
                    one.choices.push_back({name.id, report::bandTitle(rubric, name.id)});
            one.choices.push_back({kCannotTell, words()("school-teaching.cannot-tell")});
        } else {
            report::FormField& one = field("m." + id, words()("assessment.points"), "text");
            one.hint = words()(id == kTotal ? "school-teaching.total-hint" : "school-teaching.points-hint",
                               marking::mostOf(rubric, id));
        }
        if (c != nullptr) field("c." + id, words()("school-teaching.comment"), "text");
        field({}, {}, "end");
    }
    field({}, words()("school-teaching.whole-work"), "group");
    field("verdict", words()("class.verdict"), "radio").choices = {{"yes", words()("assessment.passed")},
                                                                   {"no", words()("assessment.not-passed")},
                                                                   {"teacher", words()("school-teaching.cannot-tell")}};
    report::FormField& rating = field("rating", words()("school-teaching.rating"), "radio");
    rating.hint = words()("school-teaching.rating-hint");
    for (int i = 1; i <= kMostRating; ++i)
        rating.choices.push_back({std::to_string(i), ratingWord(i)});
    field("comment", words()("school-teaching.comment-whole"), "textarea");
    field({}, {}, "end");
    return all;
}

std::string markText(const rubric::Rubric& rubric, const Sheet& sheet, const std::string& id) {
    const auto mark = sheet.marks.find(id);
    if (mark == sheet.marks.end()) return "\u2013";
    if (mark->second.cannotTell) return words()("school-teaching.cannot-tell");
    if (mark->second.points) return fmt::format("{:g}", *mark->second.points);
    return report::bandTitle(rubric, mark->second.band);
}

std::string sheetJson(const Fields& fields) {
    nlohmann::json json = nlohmann::json::object();
    for (const auto& [name, value] : fields)
        if (name.starts_with("m.") || name.starts_with("c.") || name == "verdict" || name == "rating" ||
            name == "comment")
            if (!value.empty()) json[name] = value;
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Fields parseSheet(const std::string& json) {
    Fields fields;
    const nlohmann::json read = config::outsideJson<nlohmann::json>(json);
    if (!read.is_object()) return fields;
    for (const auto& [name, value] : read.items())
        if (value.is_string()) fields.emplace(name, value.get<std::string>());
    return fields;
}

school::Mark markOf(const Sheet& sheet, const rubric::Rubric& rubric, const std::string& rubricHash,
                    const school::PushedAttempt& attempt, const std::optional<school::Score>& score,
                    const std::string& id, const std::string& marker, const std::string& kind,
                    school::Milliseconds now) {
    constexpr std::size_t kMostMarker = 60;
    const std::string noHash(16, '0');
    const auto total = sheet.marks.find(kTotal);
    const bool hasTotal = total != sheet.marks.end() && total->second.points.has_value();
    marking::ReturnedMarks told;
    told.marker = marker.substr(0, kMostMarker);
    told.exercise = attempt.attempt.exercise, told.exerciseHash = attempt.attempt.exerciseHash;
    told.stateHash = score && score->stateHash.size() == noHash.size() ? score->stateHash : noHash;
    told.sessionHashes = attempt.attempt.sessionHashes;
    told.rubric = rubric.id, told.rubricHash = rubricHash;
    told.score = hasTotal ? *total->second.points : 0.0;
    told.maxScore = hasTotal ? marking::mostOf(rubric, kTotal) : 0.0;
    told.passed = sheet.verdict == "yes"  ? score::Passed::yes
                  : sheet.verdict == "no" ? score::Passed::no
                                          : score::Passed::teacher;
    for (const rubric::Criterion& c : rubric.criteria)
        if (const auto mark = sheet.marks.find(c.id); mark != sheet.marks.end() && !mark->second.cannotTell)
            told.changes.push_back({c.id, mark->second.band, pointsOf(c, mark->second), c.weight, false, {}});
    told.comments = sheet.comments;
    return {id, attempt.attempt.id, marker, kind, sheet.verdict, told.score, told.maxScore, marking::returnedJson(told),
            now};
}

Settled settle(std::span<const school::Mark> marks, double allowedPercent) {
    Settled settled;
    std::map<std::string, const school::Mark*> newest;
    for (const school::Mark& mark : marks) {
        if (mark.kind == "adjudication") {
            if (!settled.adjudication || mark.made >= settled.adjudication->made) settled.adjudication = mark;
        } else if (const school::Mark*& at = newest[mark.marker]; at == nullptr || mark.made >= at->made) {
            at = &mark;
        }
    }
    double low = 0.0, high = 0.0, most = 0.0, sum = 0.0, sumOfMost = 0.0;
    bool passes = false, fails = false, isFirst = true;
    for (const auto& [marker, mark] : newest) {
        settled.markers.push_back(*mark);
        passes |= mark->verdict == "yes", fails |= mark->verdict == "no";
        if (!(mark->maxPoints > 0.0)) continue;
        low = isFirst ? mark->points : std::min(low, mark->points);
        high = isFirst ? mark->points : std::max(high, mark->points);
        most = std::max(most, mark->maxPoints);
        sum += mark->points, sumOfMost += mark->maxPoints;
        isFirst = false;
    }
    if (most > 0.0) settled.differencePercent = 100.0 * (high - low) / most;
    settled.needsAdjudication =
        !settled.adjudication && (settled.differencePercent > allowedPercent || (passes && fails));
    if (settled.adjudication) {
        settled.final = settled.adjudication;
    } else if (!settled.markers.empty() && !settled.needsAdjudication) {
        settled.final = settled.markers.front();
        settled.final->marker.clear();
        settled.final->points = sumOfMost > 0.0 ? most * sum / sumOfMost : 0.0;
        settled.final->maxPoints = most;
        settled.final->verdict = passes ? "yes" : fails ? "no" : "teacher";
        for (const school::Mark& mark : settled.markers)
            if (mark.verdict == "teacher") settled.final->verdict = "teacher";
    }
    return settled;
}

}  // namespace handpiece::school_server
