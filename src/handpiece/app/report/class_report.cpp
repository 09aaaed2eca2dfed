// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "handpiece/app/report/assessment_report.h"
#include "handpiece/app/report/assessment_words.h"
#include "handpiece/app/report/plot.h"
#include "handpiece/app/report/report_html.h"
#include "handpiece/base/config/words.h"

namespace handpiece::report {
namespace {

using Tone = HtmlReport::Tone;
using config::words;
using Rows = std::vector<std::vector<std::string>>;

constexpr std::size_t kCurvesEach = 8;  // there are so many colours

/// One that counts, with the attempt it is.
struct Member {
    const ClassEntry* entry;
    std::size_t attempt;
};
using Results = std::vector<Member>;

/// What may be compared: exercise and rubric by hash, device, motion scale.
using Key = std::tuple<std::string, std::string, std::uint64_t, std::string, double>;

/// The rubric where it comes with the program; else one without titles.
rubric::Rubric rubricOf(const score::Assessment& a) {
    for (const std::string& name : rubric::shippedRubrics()) {
        rubric::Rubric shipped = rubric::shippedRubric(name);
        if (shipped.id == a.rubric && rubric::hashOf(shipped) == a.rubricHash) return shipped;
    }
    return {};
}

/// Of values in rising order; between two the line that joins them.
double quantile(const std::vector<double>& sorted, double q) {
    const double place = q * static_cast<double>(sorted.size() - 1);
    const auto i = static_cast<std::size_t>(place);
    const double t = place - static_cast<double>(i);
    return i + 1 < sorted.size() ? (1.0 - t) * sorted[i] + t * sorted[i + 1] : sorted[i];
}

/// What became of one criterion.
struct Column {
    std::string id, unit;
    double maxPoints = 0.0, lost = 0.0;
    std::size_t judged = 0, critical = 0, borderline = 0;  ///< judged: has points
    std::vector<double> values, shares;                    ///< rising; points of the greatest [%]
};

std::vector<Column> columnsOf(const Results& group) {
    std::vector<Column> columns;
    for (const Member& m : group)
        for (const score::CriterionScore& c : m.entry->result.assessment.criteria) {
            auto at = std::find_if(columns.begin(), columns.end(), [&](const Column& one) { return one.id == c.id; });
            if (at == columns.end())
                at = columns.insert(columns.end(), {c.id, c.unit, c.maxPoints, 0.0, 0, 0, 0, {}, {}});
            at->critical += c.critical == score::Verdict::yes;
            at->borderline += c.borderline;
            if (c.value) at->values.push_back(*c.value);
            if (!c.points || !(c.maxPoints > 0.0)) continue;
            ++at->judged;
            // What was lost because the work is not done is no criterion's.
            at->lost += c.maxPoints - c.ownPoints;
            at->shares.push_back(100.0 * c.ownPoints / c.maxPoints);
        }
    for (Column& c : columns) {
        std::sort(c.values.begin(), c.values.end());
        std::sort(c.shares.begin(), c.shares.end());
    }
    return columns;
}

/// What was lost because works are not done, as a criterion without a name.
Column undoneOf(const Results& group) {
    Column undone;
    for (const Member& m : group) {
        const score::Assessment& a = m.entry->result.assessment;
        if (!a.completeness || !a.completeness->value || !(a.maxScore > 0.0)) continue;
        ++undone.judged;
        undone.lost += a.lostUndone();
        undone.maxPoints = a.maxScore;
    }
    return undone;
}

/// A row of dots a criterion: points reached, equal ones stacked.
std::string dotsSvg(const std::vector<Column>& columns, const rubric::Rubric& rubric) {
    constexpr double kLeft = 250.0, kWidth = 760.0, kRow = 34.0, kTop = 8.0, kDot = 3.2;
    std::vector<const Column*> graded;
    for (const Column& c : columns)
        if (!c.shares.empty()) graded.push_back(&c);
    if (graded.empty()) return {};
    const double plot = kWidth - kLeft - 20.0, high = kTop + kRow * static_cast<double>(graded.size());
    const auto x = [&](double share) { return kLeft + plot * share / 100.0; };
    std::string s =
        fmt::format("<svg class=\"hp\" viewBox=\"0 0 {} {}\" role=\"img\" xmlns=\"http://www.w3.org/2000/svg\">",
                    kWidth, high + 38.0);
    for (int share = 0; share <= 100; share += 20)
        s += fmt::format(
            "<line class=\"hp-grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/><text "
            "x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4}</text>",
            x(share), kTop, high, high + 15.0, share);
    s += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>", x(50.0), high + 32.0,
                     escaped(words()("class.points-share")));
    for (std::size_t row = 0; row < graded.size(); ++row) {
        const Column& c = *graded[row];
        const double base = kTop + kRow * (static_cast<double>(row) + 1.0) - 6.0;
        s += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", kLeft - 10.0, base,
                         escaped(criterionTitle(rubric, c.id)));
        std::map<long, int> stacked;
        for (const double share : c.shares) {
            const int n = stacked[std::lround(share)]++;
            // More than the row holds lie on one another.
            s += fmt::format("<circle class=\"hp-dot hp-c0\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"/>", x(share),
                             base - std::min(n, 5) * 4.0, kDot);
        }
        s += fmt::format("<line class=\"hp-limit\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>",
                         x(quantile(c.shares, 0.5)), base - 22.0, base + 5.0);
    }
    return s + "</svg>";
}

void addTable(HtmlReport& page, const Results& group, const rubric::Rubric& rubric) {
    Rows rows;
    std::vector<double> percents;
    std::size_t passed = 0, failed = 0;
    for (const Member& m : group) {
        const score::Assessment& a = m.entry->result.assessment;
        std::string critical, missing;
        for (const score::CriticalError& e : a.critical)
            critical +=
                (critical.empty() ? "" : ", ") + criterionTitle(rubric, e.criterion) + (e.borderline ? " ?" : "");
        for (const score::CriterionScore& c : a.criteria)
            if (c.standing == score::Standing::notMeasured && c.maxPoints > 0.0)
                missing += (missing.empty() ? "" : ", ") + criterionTitle(rubric, c.id);
        // Where points hang on it, how far each is done stands first.
        std::string undone;
        if (a.completeness)
            undone = a.completeness->value ? fmt::format("{:.0f}", *a.completeness->value) : std::string("?");
        passed += a.passed == score::Passed::yes;
        failed += a.passed == score::Passed::no;
        if (a.maxScore > 0.0) percents.push_back(a.percent());
        rows.push_back({m.entry->student, fmt::format("{}", m.attempt),
                        fmt::format("{:.1f} / {:.1f}", a.score, a.maxScore),
                        a.maxScore > 0.0 ? fmt::format("{:.1f}", a.percent()) : "", undone, verdictOf(a.passed),
                        critical, missing});
    }
    if (!percents.empty()) {
        const double n = static_cast<double>(percents.size());
        const double mean = std::accumulate(percents.begin(), percents.end(), 0.0) / n;
        double squares = 0.0;
        for (const double p : percents)
            squares += (p - mean) * (p - mean);
        const auto [least, most] = std::minmax_element(percents.begin(), percents.end());
        page.paragraph(words()("class.summary", group.size(), fmt::format("{:.1f}", mean),
                               percents.size() > 1 ? fmt::format("{:.1f}", std::sqrt(squares / (n - 1.0))) : "-",
                               fmt::format("{:.1f}", *least), fmt::format("{:.1f}", *most), passed, failed,
                               group.size() - passed - failed));
    }
    page.table(
        {words()("class.student"), words()("class.attempt"), words()("class.score"), words()("class.percent"),
         words()("class.done"), words()("class.verdict"), words()("class.critical"), words()("class.not-judged")},
        rows);
}

void addCostly(HtmlReport& page, std::vector<Column> columns, const rubric::Rubric& rubric) {
    std::erase_if(columns, [](const Column& c) { return c.judged == 0 && c.critical == 0; });
    const auto titleOf = [&](const Column& c) {
        return c.id.empty() ? words()("assessment.not-finished") : criterionTitle(rubric, c.id);
    };
    const auto mean = [](const Column& c) { return c.judged > 0 ? c.lost / static_cast<double>(c.judged) : 0.0; };
    std::stable_sort(columns.begin(), columns.end(),
                     [&](const Column& a, const Column& b) { return mean(a) > mean(b); });
    Rows rows;
    for (const Column& c : columns)
        rows.push_back({titleOf(c), c.judged > 0 ? fmt::format("{:.2f}", mean(c)) : "",
                        c.judged > 0 && c.maxPoints > 0.0 ? fmt::format("{:.0f}", 100.0 * mean(c) / c.maxPoints) : "",
                        fmt::format("{}", c.critical), fmt::format("{}", c.borderline)});
    page.subheading(words()("class.costly"));
    page.table({words()("assessment.criterion"), words()("class.mean-lost"), words()("class.share-lost"),
                words()("class.how-often-critical"), words()("class.how-often-borderline")},
               rows);
}

void addDistribution(HtmlReport& page, const std::vector<Column>& columns, const rubric::Rubric& rubric) {
    page.subheading(words()("class.distribution"));
    if (const std::string svg = dotsSvg(columns, rubric); !svg.empty()) page.figure(svg, words()("class.dots"));
    Rows rows;
    for (const Column& c : columns) {
        std::vector<std::string> row{criterionTitle(rubric, c.id), fmt::format("{}", c.values.size())};
        for (const double q : {0.0, 0.25, 0.5, 0.75, 1.0})
            row.push_back(c.values.empty() ? "" : fmt::format("{:.3f}", quantile(c.values, q)));
        row.push_back(c.unit);
        rows.push_back(std::move(row));
    }
    page.table(
        {words()("assessment.criterion"), words()("class.count"), words()("class.least"), words()("class.quartile-1"),
         words()("class.median"), words()("class.quartile-3"), words()("class.greatest"), ""},
        rows);
}

void addCurves(HtmlReport& page, const Results& group) {
    page.subheading(words()("class.curve"));
    std::map<std::string, Series> curves;
    for (const Member& m : group) {
        const score::Assessment& a = m.entry->result.assessment;
        if (!(a.maxScore > 0.0)) continue;
        Series& s = curves[m.entry->student];
        s.name = m.entry->student;
        s.markers = true;
        s.x.push_back(static_cast<double>(m.attempt));
        s.y.push_back(a.percent());
    }
    std::erase_if(curves, [](const auto& one) { return one.second.x.size() < 2; });
    if (curves.empty()) return page.paragraph(words()("class.no-curve"), Tone::note);
    Plot plot{{}, words()("class.attempt-axis"), words()("class.curve-axis"), {}, {}, {}};
    plot.height = 260;
    for (auto& [student, series] : curves) {
        plot.series.push_back(std::move(series));
        if (plot.series.size() < kCurvesEach) continue;
        page.figure(toSvg(plot, false), {});
        plot.series.clear();
    }
    if (!plot.series.empty()) page.figure(toSvg(plot, false), {});
}

}  // namespace

std::string classReport(const std::vector<ClassEntry>& entries) {
    HtmlReport page(words()("class.title"));
    std::set<std::string> students;
    std::map<Key, Results> groups;
    std::map<std::pair<Key, std::string>, std::size_t> attempts;
    for (const ClassEntry& entry : entries) {
        students.insert(entry.student);
        const score::Assessment& a = entry.result.assessment;
        const score::Identity& of = entry.result.identity;
        const Key key{of.exercise, of.exerciseHash, a.rubricHash, a.context.device, a.context.motionScale};
        std::size_t& last = attempts[{key, entry.student}];
        last = entry.attempt.value_or(last + 1);
        groups[key].push_back({&entry, last});
    }
    if (entries.empty())
        page.paragraph(words()("class.no-results"), Tone::missing);
    else
        page.paragraph(words()("class.read", entries.size(), students.size()), Tone::note);
    for (auto& [key, group] : groups) {
        std::stable_sort(group.begin(), group.end(), [](const Member& a, const Member& b) {
            return std::tie(a.entry->student, a.attempt) < std::tie(b.entry->student, b.attempt);
        });
        const score::Assessment& first = group.front().entry->result.assessment;
        const rubric::Rubric rubric = rubricOf(first);
        const std::vector<Column> columns = columnsOf(group);
        page.heading(words()("class.group", std::get<0>(key), first.rubric, first.rubricVersion));
        page.paragraph(words()("class.group-about",
                               first.context.device.empty() ? words()("assessment.not-known") : first.context.device,
                               fmt::format("{:g}", first.context.motionScale)),
                       Tone::note);
        addTable(page, group, rubric);
        std::vector<Column> costly = columns;
        if (first.completeness) costly.push_back(undoneOf(group));
        addCostly(page, std::move(costly), rubric);
        addDistribution(page, columns, rubric);
        addCurves(page, group);
    }
    return page.text();
}

}  // namespace handpiece::report
