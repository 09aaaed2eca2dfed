// SPDX-License-Identifier: Apache-2.0
// Where the pass mark is put: by judges, and by examiners' impressions.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "handpiece/app/marking/desk.h"
#include "handpiece/app/report/assessment_words.h"
#include "handpiece/app/report/plot.h"
#include "handpiece/app/report/report_html.h"
#include "handpiece/assess/standard/standard.h"
#include "handpiece/base/config/outside_json.h"
#include "handpiece/base/config/words.h"
#include "handpiece/school/store/teaching.h"
#include "school/teaching.h"

namespace handpiece::school_server {
namespace {

using config::words;
using report::FormField;
using report::HtmlReport;
using school::Action;
using school::Teaching;
using Tone = HtmlReport::Tone;

/// The bootstrap's draws hang on this alone.
constexpr std::uint64_t kSeed = 20261126;

std::vector<const rubric::Criterion*> gradedOf(const rubric::Rubric& rubric) {
    std::vector<const rubric::Criterion*> all;
    for (const rubric::Criterion& c : rubric.criteria)
        if (c.isGraded()) all.push_back(&c);
    return all;
}

std::vector<standard::JudgeEstimates> judgesOf(const std::vector<school::AngoffEstimate>& estimates,
                                               const rubric::Rubric& rubric, std::int64_t round) {
    const auto graded = gradedOf(rubric);
    std::map<std::string, standard::JudgeEstimates> byJudge;
    for (const school::AngoffEstimate& one : estimates) {
        if (one.round != round) continue;
        standard::JudgeEstimates& judge = byJudge[one.judge];
        judge.judge = one.judge;
        judge.percents.resize(graded.size());
        for (std::size_t i = 0; i < graded.size(); ++i)
            if (graded[i]->id == one.criterion) judge.percents[i] = one.percent;
    }
    std::vector<standard::JudgeEstimates> all;
    for (auto& [judge, one] : byJudge)
        all.push_back(std::move(one));
    return all;
}

standard::Angoff angoffOf(const std::vector<school::AngoffEstimate>& estimates, const rubric::Rubric& rubric,
                          std::int64_t round) {
    std::vector<double> weights;
    for (const rubric::Criterion* c : gradedOf(rubric))
        weights.push_back(c->weight);
    if (weights.empty()) return {};
    return standard::angoff(weights, judgesOf(estimates, rubric, round));
}

/// Works with the mean impression of their markers and the score that counts. What comes twice is told once.
std::vector<standard::RatedWork> ratedOf(const Teaching& teaching, const Assigned& of) {
    std::map<std::string, std::map<std::string, double>> ratings;  // by work and marker
    for (const school::MarkingSheet& sheet : teaching.sheets(of.assignment.id)) {
        if (!sheet.isIn) continue;
        const int rating = readSheet(of.rubric, parseSheet(sheet.content)).rating;
        if (rating > 0) ratings[sheet.attempt].emplace(sheet.marker, rating);
    }
    std::vector<standard::RatedWork> works;
    for (const school::Score& score : teaching.scores(of.assignment.id)) {
        const auto rated = ratings.find(score.attempt);
        if (rated == ratings.end() || score.state != "proven" || !(score.maxScore > 0.0)) continue;
        double sum = 0.0;
        for (const auto& [marker, rating] : rated->second)
            sum += rating;
        works.push_back({sum / static_cast<double>(rated->second.size()), 100.0 * score.score / score.maxScore});
    }
    return works;
}

std::string percentText(const std::optional<double>& value) {
    return value ? fmt::format("{:.1f} %", *value) : "";
}
std::string intervalText(const std::optional<agreement::Interval>& interval) {
    return interval ? fmt::format("{:.1f} \u2013 {:.1f} %", interval->low, interval->high) : "";
}

report::Form estimateForm(const Visit& v, const Assigned& of, std::int64_t round, const Fields& typed,
                          const std::map<std::string, std::string>& wrong) {
    report::Form form{"/assignments/" + of.assignment.id + "/standard",
                      {report::tokenField(lookerOf(v)), {"round", {}, "hidden", std::to_string(round)}},
                      {{words()("school-teaching.give-estimates", round), "do", "estimate"}}};
    for (const rubric::Criterion* c : gradedOf(of.rubric)) {
        FormField field{"e." + c->id, report::criterionTitle(of.rubric, c->id), "text", fieldOf(typed, "e." + c->id),
                        words()("school-teaching.estimate-hint", c->weight)};
        if (const auto found = wrong.find(field.name); found != wrong.end()) field.wrong = found->second;
        form.fields.push_back(std::move(field));
    }
    return form;
}

void addAngoff(HtmlReport& page, const Visit& v, const Assigned& of, bool showsAll, const Fields& typed,
               const std::map<std::string, std::string>& wrong, std::int64_t wrongRound) {
    const Teaching teaching(v.books);
    const std::vector<school::AngoffEstimate> estimates = teaching.estimates(of.assignment.id);
    const auto graded = gradedOf(of.rubric);
    page.heading(words()("school-teaching.angoff"));
    if (graded.empty()) return page.paragraph(words()("school-teaching.nothing-graded"), Tone::missing);
    page.paragraph(words()("school-teaching.angoff-about"), Tone::note);
    bool hasOwn = false;
    for (const school::AngoffEstimate& one : estimates)
        hasOwn = hasOwn || (one.judge == v.person.code && one.round == 1);
    for (std::int64_t round = 1; round <= (hasOwn ? 2 : 1); ++round) {
        Fields shown;
        for (const school::AngoffEstimate& one : estimates)
            // A second round begins with what one said in the first.
            if (one.judge == v.person.code && one.round <= round) {
                shown.erase("e." + one.criterion);
                shown.emplace("e." + one.criterion, fmt::format("{:g}", one.percent));
            }
        page.subheading(words()("school-teaching.round", round));
        const bool isWrong = wrongRound == round;
        page.form(estimateForm(v, of, round, isWrong ? typed : shown,
                               isWrong ? wrong : std::map<std::string, std::string>{}));
    }
    if (!hasOwn && !showsAll) {
        page.paragraph(words()("school-teaching.estimate-first"), Tone::note);
        if (may(v, Action::mark, of.relation))
            page.link("/assignments/" + of.assignment.id + "/standard?all=1", words()("school-teaching.no-judge"));
        return;
    }
    std::vector<std::vector<std::string>> rows;
    for (std::int64_t round = 1; round <= 2; ++round) {
        const standard::Angoff result = angoffOf(estimates, of.rubric, round);
        rows.push_back({words()("school-teaching.round", round), fmt::format("{}", result.judges.size()),
                        percentText(result.cutPercent), percentText(result.spreadPercent),
                        percentText(result.standardErrorPercent), intervalText(result.interval)});
    }
    page.table(
        {"", words()("school-teaching.judges"), words()("school-teaching.cut"), words()("school-teaching.spread"),
         words()("school-teaching.standard-error"), words()("school-teaching.interval-95")},
        rows, words()("school-teaching.angoff-result"));
    rows.clear();
    for (std::size_t i = 0; i < graded.size(); ++i) {
        std::vector<std::string> row{report::criterionTitle(of.rubric, graded[i]->id)};
        for (std::int64_t round = 1; round <= 2; ++round) {
            const standard::Angoff result = angoffOf(estimates, of.rubric, round);
            row.push_back(percentText(result.means[i]));
            row.push_back(percentText(result.spreads[i]));
        }
        rows.push_back(std::move(row));
    }
    page.table({words()("assessment.criterion"), words()("school-teaching.mean-of", 1),
                words()("school-teaching.spread-of", 1), words()("school-teaching.mean-of", 2),
                words()("school-teaching.spread-of", 2)},
               rows, words()("school-teaching.by-criterion"));
}

void addBorderline(HtmlReport& page, const Visit& v, const Assigned& of) {
    const Teaching teaching(v.books);
    page.heading(words()("school-teaching.borderline"));
    page.paragraph(words()("school-teaching.borderline-about"), Tone::note);
    if (marksBlindStill(v, of.assignment.id))
        return page.paragraph(words()("school-teaching.give-in-first"), Tone::missing);
    const std::vector<standard::RatedWork> works = ratedOf(teaching, of);
    const standard::Borderline result = standard::borderlineRegression(works, kBorderlineRating, kSeed);
    if (!result.cutPercent)
        return page.paragraph(
            words()(result.works < 3                                               ? "school-teaching.too-few-rated"
                    : result.slopePercent == 0.0 && result.interceptPercent == 0.0 ? "school-teaching.one-rating"
                                                                                   : "school-teaching.no-rise"),
            Tone::missing);
    report::Plot plot;
    plot.title = words()("school-teaching.borderline");
    plot.xLabel = words()("school-teaching.rating-axis"), plot.yLabel = words()("class.curve-axis");
    report::Series dots{words()("school-teaching.works"), {}, {}}, line{words()("school-teaching.line"), {}, {}};
    dots.line = false, dots.markers = true;
    for (const standard::RatedWork& one : works)
        dots.x.push_back(one.rating), dots.y.push_back(one.percent);
    for (const double x : {1.0, static_cast<double>(kMostRating)})
        line.x.push_back(x), line.y.push_back(result.interceptPercent + result.slopePercent * x);
    plot.series = {dots, line};
    plot.limits = {{*result.cutPercent, words()("school-teaching.cut")}};
    page.figure(report::toSvg(plot, false), words()("school-teaching.borderline-caption", works.size()));
    page.facts(words()("school-teaching.borderline-result"),
               {{words()("school-teaching.cut"), percentText(result.cutPercent)},
                {words()("school-teaching.interval-bootstrap", standard::kDraws, kSeed),
                 intervalText(result.bootstrap.interval)},
                {words()("school-teaching.standard-error"), percentText(result.standardErrorPercent)},
                {words()("school-teaching.r-squared"), fmt::format("{:.2f}", result.rSquared)},
                {words()("school-teaching.slope"), percentText(result.slopePercent)},
                {words()("school-teaching.works"), fmt::format("{}", result.works)}});
}

Page standardPage(const Visit& v, const Assigned& of, bool showsAll, const Told& told, const Fields& typed,
                  const std::map<std::string, std::string>& wrong, std::int64_t wrongRound) {
    HtmlReport page = report::sitePage(words()("school-teaching.standard-of", of.assignment.title), lookerOf(v));
    page.link("/assignments/" + of.assignment.id, words()("school-teaching.back-to-assignment", of.assignment.title));
    if (!told.text.empty()) page.paragraph(told.text, told.isWrong ? Tone::bad : Tone::good);
    if (!wrong.empty()) page.paragraph(words()("school-teaching.wrong", wrong.size()), Tone::bad);
    std::vector<std::pair<std::string, std::string>> facts{
        {words()("school-teaching.pass-mark"),
         of.rubric.passMark ? fmt::format("{:g} %", *of.rubric.passMark) : words()("assessment.teacher")}};
    for (auto& line : keptStandards(v, of.assignment.id))
        facts.push_back(std::move(line));
    page.facts(words()("school-teaching.pass-mark-beside"), facts);
    addAngoff(page, v, of, showsAll, typed, wrong, wrongRound);
    addBorderline(page, v, of);
    if (may(v, Action::rescore, of.relation)) {
        page.heading(words()("school-teaching.keep-standard"));
        page.paragraph(words()("school-teaching.keep-standard-about"), Tone::note);
        const FormField token = report::tokenField(lookerOf(v));
        page.form(
            {"/assignments/" + of.assignment.id + "/standard",
             {token,
              {"method",
               words()("school-teaching.method"),
               "select",
               "angoff",
               {},
               {},
               {{"angoff", words()("school-teaching.angoff")}, {"borderline", words()("school-teaching.borderline")}}}},
             {{words()("school-teaching.keep-standard"), "do", "keep"}}});
    }
    return {wrong.empty() && !told.isWrong ? 200 : 422, page.text()};
}

}  // namespace

std::vector<std::pair<std::string, std::string>> keptStandards(const Visit& v, const std::string& assignment) {
    std::vector<std::pair<std::string, std::string>> lines;
    for (const school::KeptStandard& one : Teaching(v.books).standards(assignment)) {
        const nlohmann::json json = config::outsideJson<nlohmann::json>(one.content);
        if (!json.is_object() || !json.value("cut_percent", nlohmann::json()).is_number()) continue;
        std::string text = fmt::format("{:.1f} %", json["cut_percent"].get<double>());
        if (const auto interval = json.find("interval_percent");
            interval != json.end() && interval->is_array() && interval->size() == 2)
            text +=
                fmt::format(" ({:.1f} \u2013 {:.1f} %)", interval->at(0).get<double>(), interval->at(1).get<double>());
        lines.emplace_back(
            fmt::format("{}, {}",
                        words()(one.method == "angoff" ? "school-teaching.angoff" : "school-teaching.borderline"),
                        report::momentOf(one.made)),
            text);
    }
    return lines;
}

Page standardOf(const Visit& v, const std::string& assignment, bool showsAll, const Told& told) {
    const auto of = assignedFor(v, assignment, Action::markBlind);
    if (!of) return notYours();
    noteLook(v, "standard seen", "", assignment);
    return standardPage(v, *of, showsAll && may(v, Action::mark, of->relation), told, {}, {}, 0);
}

Page changeStandard(const Visit& v, const std::string& assignment, const Fields& fields) {
    const auto of = assignedFor(v, assignment, Action::markBlind);
    if (!of) return notYours();
    Teaching teaching(v.books);
    const std::string what = fieldOf(fields, "do");
    const school::Act act{v.person.code, v.now};
    if (what == "estimate") {
        const std::int64_t round = fieldOf(fields, "round") == "2" ? 2 : 1;
        std::vector<school::AngoffEstimate> estimates;
        std::map<std::string, std::string> wrong;
        for (const rubric::Criterion* c : gradedOf(of->rubric)) {
            const std::optional<double> percent = numberIn(fieldOf(fields, "e." + c->id));
            if (percent && *percent >= 0.0 && *percent <= 100.0)
                estimates.push_back({v.person.code, round, c->id, *percent});
            else
                wrong.emplace("e." + c->id, words()("school-teaching.give-percent"));
        }
        bool hasFirst = round == 1;
        for (const school::AngoffEstimate& one : teaching.estimates(assignment))
            hasFirst = hasFirst || (one.judge == v.person.code && one.round == 1);
        if (!hasFirst) return standardPage(v, *of, false, {words()("school-teaching.round-first"), true}, {}, {}, 0);
        if (!wrong.empty()) return standardPage(v, *of, false, {}, fields, wrong, round);
        teaching.setEstimates(assignment, estimates, act);
        return {303, {}, "/assignments/" + assignment + "/standard"};
    }
    if (what != "keep" || !may(v, Action::rescore, of->relation)) return notYours();
    nlohmann::json content = {{"rubric", of->rubric.id}, {"rubric_hash", of->rubricHash}};
    if (of->rubric.passMark) content["pass_mark_percent"] = *of->rubric.passMark;
    const std::string method = fieldOf(fields, "method");
    if (method == "angoff") {
        const std::vector<school::AngoffEstimate> estimates = teaching.estimates(assignment);
        // The last round that anybody finished.
        std::int64_t round = 2;
        standard::Angoff result = angoffOf(estimates, of->rubric, round);
        if (!result.cutPercent) result = angoffOf(estimates, of->rubric, round = 1);
        if (!result.cutPercent)
            return standardPage(v, *of, true, {words()("school-teaching.no-standard"), true}, {}, {}, 0);
        content["round"] = round, content["judges"] = result.judges.size(), content["cut_percent"] = *result.cutPercent;
        if (result.spreadPercent) content["spread_percent"] = *result.spreadPercent;
        if (result.interval) content["interval_percent"] = {result.interval->low, result.interval->high};
    } else if (method == "borderline" && seesMarks(v, *of)) {
        const standard::Borderline result =
            standard::borderlineRegression(ratedOf(teaching, *of), kBorderlineRating, kSeed);
        if (!result.cutPercent)
            return standardPage(v, *of, true, {words()("school-teaching.no-standard"), true}, {}, {}, 0);
        content["works"] = result.works, content["cut_percent"] = *result.cutPercent;
        content["intercept_percent"] = result.interceptPercent, content["slope_percent"] = result.slopePercent;
        content["r_squared"] = result.rSquared, content["seed"] = kSeed, content["draws"] = standard::kDraws;
        if (result.bootstrap.interval)
            content["interval_percent"] = {result.bootstrap.interval->low, result.bootstrap.interval->high};
    } else {
        return standardPage(v, *of, true, {words()("school-teaching.no-standard"), true}, {}, {}, 0);
    }
    teaching.add(school::KeptStandard{school::newId(), assignment, method, content.dump(), v.person.code}, act);
    return {303, {}, "/assignments/" + assignment + "/standard?all=1"};
}

}  // namespace handpiece::school_server
