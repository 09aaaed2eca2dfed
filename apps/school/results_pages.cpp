// SPDX-License-Identifier: Apache-2.0
// How work goes on, and results for other programs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/report/assessment_report.h"
#include "handpiece/app/report/plot.h"
#include "handpiece/app/report/report_html.h"
#include "handpiece/app/statements/statements.h"
#include "handpiece/app/tables/tables.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/school/store/teaching.h"
#include "school/teaching.h"

namespace handpiece::school_server {
namespace {

using config::words;
using report::FormField;
using report::HtmlReport;
using school::Action;
using school::Outcome;
using school::Teaching;
using Tone = HtmlReport::Tone;

/// Of what somebody may see what it is worth, and whose it is: an examiner has no curve of a person.
struct Seen : Outcome {
    school::Visible visible;
};
std::vector<Seen> seenOf(const Visit& v, std::vector<Outcome> outcomes) {
    std::vector<Seen> seen;
    Sight sight(v);
    for (Outcome& one : outcomes)
        if (const school::Visible visible = sight.of(one.pushed); visible.worth && visible.whose)
            seen.push_back({std::move(one), visible});
    return seen;
}

/// What may be compared: exercise and rubric by hash, device, motion scale.
using GroupKey = std::tuple<std::string, std::string, std::string, double>;
struct Group {
    std::string exercise, device;
    std::map<std::string, std::vector<double>> percents;  ///< by person, in the order of the attempts
};

/// Of work that the server scored whole.
std::map<GroupKey, Group> groupsOf(const std::vector<Seen>& outcomes) {
    std::map<GroupKey, Group> groups;
    for (const Seen& one : outcomes) {
        if (!one.score || one.score->state != "proven" || !(one.score->maxScore > 0.0)) continue;
        const school::Attempt& a = one.pushed.attempt;
        Group& group = groups[{a.exerciseHash, one.score->rubric, a.device, a.motionScale}];
        group.exercise = a.exercise;
        group.device = a.device.empty() ? words()("assessment.not-known") : a.device;
        group.percents[one.pushed.person].push_back(100.0 * one.score->score / one.score->maxScore);
    }
    return groups;
}

double quantile(const std::vector<double>& sorted, double share) {
    const double place = share * static_cast<double>(sorted.size() - 1);
    const auto low = static_cast<std::size_t>(place);
    const std::size_t high = std::min(low + 1, sorted.size() - 1);
    return sorted[low] + (sorted[high] - sorted[low]) * (place - static_cast<double>(low));
}

report::Plot curvePlot() {
    report::Plot plot{{}, words()("class.attempt-axis"), words()("class.curve-axis"), {}, {}, {}};
    plot.height = 280;
    return plot;
}

void addClassCurve(HtmlReport& page, const Group& group) {
    report::Plot plot = curvePlot();
    report::Series middle{words()("class.median"), {}, {}}, low{words()("class.quartile-1"), {}, {}},
        high{words()("class.quartile-3"), {}, {}};
    middle.markers = true, low.dashed = high.dashed = true;
    std::vector<std::vector<std::string>> rows;
    for (std::size_t attempt = 0;; ++attempt) {
        std::vector<double> all;
        for (const auto& [person, percents] : group.percents)
            if (attempt < percents.size()) all.push_back(percents[attempt]);
        if (all.empty()) break;
        std::sort(all.begin(), all.end());
        const double x = static_cast<double>(attempt + 1);
        for (const auto& [series, share] : {std::pair(&middle, 0.5), std::pair(&low, 0.25), std::pair(&high, 0.75)})
            series->x.push_back(x), series->y.push_back(quantile(all, share));
        rows.push_back({fmt::format("{}", attempt + 1), fmt::format("{}", all.size()),
                        fmt::format("{:.1f}", low.y.back()), fmt::format("{:.1f}", middle.y.back()),
                        fmt::format("{:.1f}", high.y.back())});
    }
    plot.series = {middle, low, high};
    page.figure(report::toSvg(plot, false), words()("school-teaching.class-curve", group.exercise, group.device));
    page.table({words()("class.attempt"), words()("class.count"), words()("class.quartile-1"), words()("class.median"),
                words()("class.quartile-3")},
               rows, words()("school-teaching.class-curve", group.exercise, group.device));
}

void addWays(HtmlReport& page, const std::string& at, const std::string& home, bool isClass) {
    page.heading(words()("school-teaching.take-along"));
    page.paragraph(words()("school-teaching.take-along-about"), Tone::note);
    if (isClass) page.link(at + "/export/report", words()("school-teaching.page-of-class"));
    page.link(at + "/export/attempts.csv", words()("school-teaching.attempts-csv"));
    page.link(at + "/export/criteria.csv", words()("school-teaching.criteria-csv"));
    page.link(at + "/export/results.zip", words()("school-teaching.results-zip"));
    FormField address{"home", words()("school-teaching.home-page"), "text", home, words()("school-teaching.home-hint")};
    report::Form form{at + "/export/statements.json", {address}, {{words()("school-teaching.statements")}}, true};
    page.form(form);
}

std::string rubricNameOf(const school::Books& books, std::map<std::string, std::string>& known,
                         const std::string& hash) {
    const auto found = known.find(hash);
    if (found != known.end()) return found->second;
    const auto version = books.rubric(hash);
    return known[hash] = version ? fmt::format("{} {}", version->id, version->version) : std::string();
}

/// One row an attempt, and one a criterion of each: docs/formats/results-table.md.
std::vector<tables::Table> tablesOf(const Visit& v, const std::vector<Seen>& outcomes) {
    const Teaching teaching(v.books);
    tables::Texts attempt, person, assignment, exercise, exerciseHash, rubricHash, rubricName, device, state, passed,
        reason, markVerdict;
    tables::Whole number, began, finished, received, borderline, released;
    tables::Numbers scale, worked, limit, score, most, whole, percent, mark, markMost;
    tables::Texts cAttempt, cPerson, cId, cMeasure, cUnit, cStanding, cBand, cCritical;
    tables::Numbers cValue, cUncertainty, cPoints, cMost;
    std::map<std::string, std::string> rubrics;
    std::map<std::string, double> allowed;
    std::map<std::pair<std::string, std::string>, std::int64_t> counted;
    for (const Seen& one : outcomes) {
        const school::Attempt& a = one.pushed.attempt;
        attempt.push_back(a.id), person.push_back(one.pushed.person), assignment.push_back(one.pushed.assignment);
        exercise.push_back(a.exercise), exerciseHash.push_back(a.exerciseHash), device.push_back(a.device);
        number.push_back(++counted[{one.pushed.person, a.exerciseHash}]);
        began.push_back(a.began), finished.push_back(a.finished), received.push_back(one.pushed.received);
        scale.push_back(a.motionScale), worked.push_back(a.workedS), limit.push_back(a.limitS);
        const bool isScored = one.score && one.score->maxScore > 0.0;
        state.push_back(one.score ? one.score->state : "provisional");
        reason.push_back(one.score && one.visible.reason ? one.score->reason : "");
        rubricHash.push_back(one.score ? one.score->rubric : a.rubricHash);
        rubricName.push_back(rubricNameOf(v.books, rubrics, rubricHash.back()));
        const auto said = [&](tables::Numbers& into, double value) {
            into.push_back(isScored ? std::optional(value) : std::nullopt);
        };
        said(score, one.score ? one.score->score : 0.0), said(most, one.score ? one.score->maxScore : 0.0);
        said(whole, one.score ? one.score->wholeScore : 0.0);
        said(percent, isScored ? 100.0 * one.score->score / one.score->maxScore : 0.0);
        passed.push_back(one.score ? one.score->passed : "");
        borderline.push_back(one.score && one.score->borderline ? 1 : 0);
        const std::string& of = one.pushed.assignment;
        if (!allowed.contains(of)) allowed[of] = teaching.differenceAllowed(of);
        const Settled settled = settle(v.books.marksOf(a.id), allowed[of]);
        const bool isReleased = teaching.isReleased(a.id);
        // Who is told of marks before they are out: nobody by this way.
        const bool isTold = settled.final && isReleased && one.visible.marks,
                   hasPoints = isTold && settled.final->maxPoints > 0.0;
        mark.push_back(hasPoints ? std::optional(settled.final->points) : std::nullopt);
        markMost.push_back(hasPoints ? std::optional(settled.final->maxPoints) : std::nullopt);
        markVerdict.push_back(isTold ? settled.final->verdict : "");
        released.push_back(isReleased ? 1 : 0);
        if (!one.score || one.score->result.empty()) continue;
        for (const score::CriterionScore& c :
             assessment::parseResult(one.score->result, "the books").assessment.criteria) {
            cAttempt.push_back(a.id), cPerson.push_back(one.pushed.person), cId.push_back(c.id);
            cMeasure.push_back(c.measure), cUnit.push_back(c.unit), cBand.push_back(c.band);
            cStanding.emplace_back(score::nameOf(c.standing));
            cCritical.push_back(c.critical == score::Verdict::yes  ? "yes"
                                : c.critical == score::Verdict::no ? "no"
                                                                   : "borderline");
            cValue.push_back(c.value), cPoints.push_back(c.points), cMost.push_back(c.maxPoints);
            cUncertainty.push_back(c.value ? std::optional(c.uncertainty) : std::nullopt);
        }
    }
    return {{"attempts",
             {{"attempt", "", attempt},
              {"person", "", person},
              {"assignment", "", assignment},
              {"exercise", "", exercise},
              {"exercise_hash", "", exerciseHash},
              {"number", "", number},
              {"rubric", "", rubricName},
              {"rubric_hash", "", rubricHash},
              {"device", "", device},
              {"motion_scale", "", scale},
              {"began_ms", "ms since 1970", began},
              {"finished_ms", "ms since 1970", finished},
              {"received_ms", "ms since 1970", received},
              {"worked_s", "s", worked},
              {"limit_s", "s", limit},
              {"state", "", state},
              {"reason", "", reason},
              {"score", "points", score},
              {"max_score", "points", most},
              {"whole_score", "points", whole},
              {"percent", "%", percent},
              {"passed", "", passed},
              {"borderline", "", borderline},
              {"mark", "points", mark},
              {"max_mark", "points", markMost},
              {"mark_passed", "", markVerdict},
              {"released", "", released}}},
            {"criteria",
             {{"attempt", "", cAttempt},
              {"person", "", cPerson},
              {"criterion", "", cId},
              {"measure", "", cMeasure},
              {"unit", "", cUnit},
              {"standing", "", cStanding},
              {"value", "as unit says", cValue},
              {"uncertainty", "as unit says", cUncertainty},
              {"points", "points", cPoints},
              {"max_points", "points", cMost},
              {"band", "", cBand},
              {"critical", "", cCritical}}}};
}

std::string statementsFor(const Visit& v, const std::vector<Seen>& outcomes, const std::string& home) {
    const Teaching teaching(v.books);
    std::map<std::string, std::vector<statements::Work>> byPerson;
    std::map<std::string, std::string> titles;
    for (const Seen& one : outcomes) {
        // What the server has not proven is nobody's result.
        if (!one.score || one.score->state != "proven") continue;
        statements::Work work{one.pushed.attempt, {}, {}};
        const school::Score& s = *one.score;
        work.attempt.score = s.score, work.attempt.maxScore = s.maxScore, work.attempt.wholeScore = s.wholeScore;
        work.attempt.passed = s.passed, work.attempt.borderline = s.borderline, work.attempt.proven = true;
        work.attempt.rubricHash = s.rubric;
        if (!titles.contains(work.attempt.exerciseHash)) {
            const auto pack = v.books.pack(work.attempt.exerciseHash);
            titles[work.attempt.exerciseHash] = pack ? pack->title : std::string();
        }
        work.title = titles[work.attempt.exerciseHash];
        work.tellsMarkers = one.visible.markers;
        if (one.visible.marks && teaching.isReleased(work.attempt.id)) {
            const Settled settled =
                settle(v.books.marksOf(work.attempt.id), teaching.differenceAllowed(one.pushed.assignment));
            const std::vector<school::Mark> given =
                settled.adjudication ? std::vector{*settled.adjudication} : settled.markers;
            if (settled.final)
                for (const school::Mark& mark : given)
                    work.returned.push_back({work.attempt.id, mark.marker, mark.marks, mark.made});
        }
        byPerson[one.pushed.person].push_back(std::move(work));
    }
    std::string all = "[";
    for (const auto& [person, works] : byPerson) {
        const std::string some = statements::statementsOf(works, {home, person});
        // An array each: their inside.
        const std::size_t first = some.find('[') + 1, last = some.rfind(']');
        const std::string inside = some.substr(first, last - first);
        if (inside.find('{') == std::string::npos) continue;
        all += (all.size() > 1 ? "," : "") + inside;
    }
    return all + "]\n";
}

Page exportOf(const Visit& v, const std::vector<Seen>& outcomes, const std::string& what, const std::string& home,
              const std::string& name) {
    Page page;
    page.fileName = fmt::format("{}-{}", name, what);
    if (what == "attempts.csv" || what == "criteria.csv") {
        page.type = "text/csv; charset=utf-8";
        page.body = tables::toCsv(tablesOf(v, outcomes)[what == "attempts.csv" ? 0 : 1]);
    } else if (what == "results.zip") {
        page.type = "application/zip";
        page.body = tables::toZip(tablesOf(v, outcomes));
    } else if (what == "statements.json") {
        page.type = "application/json";
        try {
            page.body = statementsFor(v, outcomes, home);
        } catch (const core::Error& error) {
            return refused(fmt::format("{} ({})", error.problem(), error.remedy()), 422);
        }
    } else {
        std::vector<report::ClassEntry> entries;
        for (const Seen& one : outcomes)
            if (one.score && !one.score->result.empty())
                entries.push_back({one.pushed.person, one.pushed.attempt.id, std::nullopt,
                                   assessment::parseResult(one.score->result, "the books")});
        page.fileName.clear();
        page.body = report::classReport(entries);
    }
    return page;
}

/// Of a person's work; none: nothing of it is theirs to see.
std::optional<std::vector<Seen>> seenOfPerson(const Visit& v, const std::string& person, bool withResults) {
    std::vector<Seen> seen = seenOf(v, Teaching(v.books).outcomesOf(person, withResults));
    if (seen.empty() && person != v.person.code) return {};
    return seen;
}

}  // namespace

Page resultsOfClass(const Visit& v, const std::string& schoolClass, const std::string& home) {
    const school::Relation relation = relationToClass(v, schoolClass);
    if (!may(v, Action::seeClass, relation)) return notYours();
    std::string name = schoolClass;
    for (const school::SchoolClass& one : v.books.classes())
        if (one.id == schoolClass) name = one.name;
    HtmlReport page = report::sitePage(words()("school-teaching.results-of", name), lookerOf(v));
    page.link("/classes/" + schoolClass, words()("school-teaching.back-to-class"));
    const std::map<GroupKey, Group> groups = groupsOf(seenOf(v, Teaching(v.books).outcomes(schoolClass, false)));
    if (groups.empty()) page.paragraph(words()("class.no-results"), Tone::missing);
    for (const auto& [key, group] : groups) {
        page.heading(words()("school-teaching.curve-of", group.exercise));
        addClassCurve(page, group);
        std::vector<std::vector<HtmlReport::Cell>> rows;
        for (const auto& [person, percents] : group.percents) {
            std::string shown = person;
            if (visibleIn(v, relation).whose)
                if (const auto one = v.books.person(person); one && !one->name.empty()) shown = one->name;
            rows.push_back({{shown, "/people/" + person + "/curves"},
                            {fmt::format("{}", percents.size())},
                            {fmt::format("{:.1f}", percents.front())},
                            {fmt::format("{:.1f}", percents.back())},
                            {fmt::format("{:+.1f}", percents.back() - percents.front())}});
        }
        page.linkedTable(
            {words()("class.student"), words()("school-teaching.attempts-count"), words()("school-teaching.first"),
             words()("school-teaching.last"), words()("school-teaching.difference")},
            rows, words()("school-teaching.students-about", group.exercise));
    }
    addWays(page, "/classes/" + schoolClass, home, true);
    noteLook(v, "results seen", "", schoolClass);
    return {200, page.text()};
}

Page curvesOf(const Visit& v, const std::string& person, const std::string& home) {
    const auto seen = seenOfPerson(v, person, false);
    if (!seen) return notYours();
    const auto one = v.books.person(person);
    const std::string shown = one && !one->name.empty() ? one->name : person;
    HtmlReport page = report::sitePage(words()("school-teaching.curves", shown), lookerOf(v));
    page.link("/people/" + person, words()("school-teaching.back-to-work"));
    const std::map<GroupKey, Group> groups = groupsOf(*seen);
    if (groups.empty()) page.paragraph(words()("class.no-results"), Tone::missing);
    for (const auto& [key, group] : groups) {
        page.heading(group.exercise);
        report::Series series;
        std::vector<std::vector<std::string>> rows;
        for (const double percent : group.percents.begin()->second) {
            series.x.push_back(static_cast<double>(series.x.size() + 1));
            series.y.push_back(percent);
            rows.push_back({fmt::format("{}", series.x.size()), fmt::format("{:.1f}", percent)});
        }
        series.markers = true;
        report::Plot plot = curvePlot();
        plot.series = {series};
        const std::string about = words()("school-teaching.person-curve", group.exercise, group.device);
        page.figure(report::toSvg(plot, false), about);
        page.table({words()("class.attempt"), words()("class.curve-axis")}, rows, about);
    }
    addWays(page, "/people/" + person, home, false);
    if (person != v.person.code) noteLook(v, "curves seen", person);
    return {200, page.text()};
}

Page exportOfClass(const Visit& v, const std::string& schoolClass, const std::string& what, const std::string& home) {
    if (!may(v, Action::seeClass, relationToClass(v, schoolClass))) return notYours();
    noteLook(v, "results exported", "", fmt::format("{} {}", schoolClass, what));
    return exportOf(v, seenOf(v, Teaching(v.books).outcomes(schoolClass, what != "statements.json")), what, home,
                    schoolClass);
}

Page exportOfPerson(const Visit& v, const std::string& person, const std::string& what, const std::string& home) {
    const auto seen = seenOfPerson(v, person, what != "statements.json");
    if (!seen) return notYours();
    if (person != v.person.code) noteLook(v, "results exported", person, what);
    return exportOf(v, *seen, what, home, person);
}

}  // namespace handpiece::school_server
