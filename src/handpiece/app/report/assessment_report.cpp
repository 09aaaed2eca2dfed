// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/assessment_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "handpiece/app/report/advice.h"
#include "handpiece/app/report/assessment_words.h"
#include "handpiece/app/report/report_html.h"
#include "handpiece/base/config/words.h"
#include "handpiece/senses/view/look.h"

namespace handpiece::report {
namespace {

using Tone = HtmlReport::Tone;
using Group = HtmlReport::Group;
using config::words;
using Facts = std::vector<std::pair<std::string, std::string>>;

/// Of its own: what is lost because the work is not done is told apart.
double lossOf(const score::CriterionScore& c) {
    return c.points ? c.maxPoints - c.ownPoints : 0.0;
}

class Page {
  public:
    Page(const score::Result& result, const tasks::Task& task, const rubric::Rubric& rubric,
         const AssessmentPictures& pictures, const ReviewMaker& review)
        : result_(result),
          a_(result.assessment),
          task_(task),
          rubric_(rubric),
          pictures_(pictures),
          review_(review),
          bearings_(bearingsOf(task)),
          page_(words()("assessment.title", titleOf(task))) {}

    std::string text() {
        addVerdict();
        addScan();
        addCritical();
        page_.reviewHere();
        addFirstErrors();
        addCriteria();
        addViews();
        addRules();
        addOrigin();
        if (review_) page_.review(review_(page_.roomForReview()));
        return page_.text();
    }

  private:
    static std::string titleOf(const tasks::Task& task) {
        const auto& exercise = task.toothCase.exercise;
        const std::string title =
            exercise ? std::string(cases::inLanguage(exercise->title, words().language())) : std::string();
        return title.empty() ? task.id : title;
    }
    [[nodiscard]] const rubric::Criterion* criterion(const std::string& id) const { return rubric_.criterion(id); }
    [[nodiscard]] std::string titleOf(const std::string& id) const { return criterionTitle(rubric_, id); }
    [[nodiscard]] std::string bandTitle(const std::string& id) const { return report::bandTitle(rubric_, id); }

    void addVerdict() {
        page_.paragraph(words()("assessment.about", task_.toothCase.name,
                                std::string(cases::inLanguage(rubric_.title, words().language())), a_.rubricVersion),
                        Tone::note);
        page_.begin(Group::frame);
        page_.subheading(words()("assessment.score-line", fmt::format("{:.1f}", a_.score),
                                 fmt::format("{:.1f}", a_.maxScore), fmt::format("{:.1f}", a_.leastScore),
                                 fmt::format("{:.1f}", a_.mostScore)));
        page_.paragraph(words()("assessment.verdict-because", verdictOf(a_.passed), whyOf(a_, rubric_)),
                        a_.passed == score::Passed::yes  ? Tone::good
                        : a_.passed == score::Passed::no ? Tone::bad
                                                         : Tone::note);
        if (const std::string undone = undoneWords(a_); !undone.empty()) page_.paragraph(undone, Tone::bad);
        if (a_.wholeScore != a_.maxScore)
            page_.paragraph(words()("assessment.not-all-measured", fmt::format("{:.1f}", a_.maxScore),
                                    fmt::format("{:.1f}", a_.wholeScore)),
                            Tone::note);
        page_.end();
    }

    void addScan() {
        if (!result_.identity.scan) return;
        const score::ScanFit& fit = *result_.identity.scan;
        page_.heading(words()("assessment.scan"));
        page_.paragraph(words()("assessment.scan-says"));
        const auto mm = [](double value) { return fmt::format("{:.3f} mm", value); };
        page_.facts({}, {{words()("assessment.scan-on"),
                          words()(fmt::format("assessment.scan-on-{}", score::nameOf(fit.registeredOn)),
                                  fmt::format("{:.0f}", fit.uncutMm2))},
                         {words()("assessment.scan-rms"), mm(fit.rmsMm)},
                         {words()("assessment.scan-noise"), mm(fit.noiseMm)},
                         {words()("assessment.scan-lies"),
                          fmt::format("± {}, ± {:.2f}°", mm(2.0 * fit.liesMm), 2.0 * fit.turnsDeg)},
                         {words()("assessment.scan-cut"), fit.cutMm2 > 0.0 ? fmt::format("{:.1f} mm²", fit.cutMm2)
                                                                           : words()("assessment.scan-nothing-cut")}});
    }

    void addCritical() {
        page_.heading(words()("assessment.critical"));
        if (a_.critical.empty()) return page_.paragraph(words()("assessment.no-critical"), Tone::good);
        page_.paragraph(words()("assessment.critical-apart"), Tone::note);
        for (const score::CriticalError& e : a_.critical) {
            std::string line = whatHappened(rubric_, e.criterion);
            for (const score::CriterionScore& s : a_.criteria)
                if (s.id == e.criterion) line = whatHappened(rubric_, s, bearings_);
            page_.paragraph(e.borderline ? words()("assessment.may-be-critical", line) : line,
                            e.borderline ? Tone::note : Tone::bad);
        }
    }

    void addFirstErrors() {
        const std::vector<std::size_t> dear = costliest(a_);
        page_.heading(words()("assessment.first-errors"));
        const bool isUndone = costsUndone(a_);
        if (dear.empty() && !isUndone) return page_.paragraph(words()("assessment.nothing-lost"), Tone::good);
        if (isUndone) addUndone();
        for (std::size_t n = 0; n < std::min(dear.size(), kFirstErrors); ++n) {
            const score::CriterionScore& s = a_.criteria[dear[n]];
            const rubric::Criterion* c = criterion(s.id);
            page_.begin(Group::frame);
            page_.subheading(words()("assessment.error-line", n + (isUndone ? 2 : 1), titleOf(s.id),
                                     s.critical == score::Verdict::yes
                                         ? words()("rubric.critical")
                                         : words()("assessment.points-lost", fmt::format("{:.1f}", lossOf(s)))));
            const auto picture = pictures_.places.find(s.id);
            const bool isShown = picture != pictures_.places.end() && !picture->second.empty();
            if (isShown) page_.begin(Group::columns);
            Facts facts{{words()("assessment.measured"), s.value ? valueOf(s) : said(s.reason)}};
            if (c != nullptr)
                if (const std::string wanted = wantedText(wantedOf(*c, rubric_), c->unit); !wanted.empty())
                    facts.emplace_back(c->isGraded() || !c->bands.empty() ? words()("assessment.wanted")
                                                                          : words()("assessment.allowed"),
                                       wanted);
            // The first that says each of them.
            const auto add = [&](const char* name, const auto& read) {
                for (const measures::Evidence& e : s.evidence)
                    if (const std::string text = read(e); !text.empty()) {
                        facts.emplace_back(words().text(name), text);
                        return;
                    }
                facts.emplace_back(words().text(name), words()("assessment.not-known"));
            };
            add("assessment.place",
                [](const measures::Evidence& e) { return e.placeMm ? placeText(e) : std::string(); });
            add("assessment.when", [](const measures::Evidence& e) {
                return e.timeS ? fmt::format("{:.1f} s", *e.timeS) : std::string();
            });
            add("assessment.force", [](const measures::Evidence& e) {
                return e.forceN ? fmt::format("{:.2f} N", *e.forceN) : std::string();
            });
            page_.facts({}, facts);
            if (isShown) {
                page_.picture(picture->second, words()("assessment.place-shown"));
                page_.end();
            }
            if (c != nullptr)
                if (const auto text = cases::inLanguage(c->words, words().language()); !text.empty())
                    page_.paragraph(text);
            if (const Advice advice = adviceOf(s, rubric_, bearings_); !advice.words.empty())
                page_.paragraph(words()("assessment.advice", advice.words));
            page_.end();
        }
    }

    /// What is lost because the work is not done, and where most of it still stands.
    void addUndone() {
        const score::Completeness& c = *a_.completeness;
        page_.begin(Group::frame);
        page_.subheading(words()("assessment.error-line", 1, words()("assessment.not-finished"),
                                 words()("assessment.points-lost", fmt::format("{:.1f}", a_.lostUndone()))));
        const bool isShown = !pictures_.undone.empty();
        if (isShown) page_.begin(Group::columns);
        Facts facts{
            {words()("assessment.measured"), fmt::format("{:.1f} ± {:.1f} {}", *c.value, c.uncertainty, c.unit)},
            {words()("assessment.points-count"), fmt::format("{:.0f} %", 100.0 * c.factor)}};
        for (const measures::Evidence& e : c.evidence)
            if (e.placeMm) {
                facts.emplace_back(words()("assessment.place"), placeText(e));
                break;
            }
        page_.facts({}, facts);
        if (isShown) {
            page_.picture(pictures_.undone, words()("assessment.place-shown"));
            page_.end();
        }
        if (rubric_.completeness)
            if (const auto text = cases::inLanguage(rubric_.completeness->words, words().language()); !text.empty())
                page_.paragraph(text);
        page_.end();
    }

    void addCriteria() {
        page_.heading(words()("assessment.criteria"));
        if (costsUndone(a_))
            page_.paragraph(words()("assessment.points-are-times", fmt::format("{:.2f}", a_.completeness->factor)),
                            Tone::note);
        std::vector<std::vector<std::string>> rows;
        for (const score::CriterionScore& s : a_.criteria) {
            std::string note;
            const auto say = [&](const std::string& text) { note += (note.empty() ? "" : "; ") + text; };
            if (s.critical == score::Verdict::yes) say(words()("rubric.critical"));
            if (s.borderline) {
                std::string bands;
                for (const std::string& id : s.possibleBands)
                    bands += (bands.empty() ? "" : " / ") + bandTitle(id);
                say(s.possibleBands.size() > 1 ? words()("assessment.borderline-between", bands)
                                               : words()("assessment.borderline"));
            }
            if (s.standing != score::Standing::judged) say(said(s.reason));
            if (s.standing == score::Standing::judged && !s.points) say(words()("rubric.shown"));
            rows.push_back({titleOf(s.id), s.value ? fmt::format("{:.3f}", *s.value) : std::string(),
                            s.value ? fmt::format("± {:.3f}", s.uncertainty) : std::string(), s.unit,
                            s.band.empty() ? std::string() : bandTitle(s.band),
                            s.points ? fmt::format("{:.1f}", *s.points) : std::string(),
                            s.maxPoints > 0.0 ? fmt::format("{:.1f}", s.maxPoints) : std::string(), note});
        }
        page_.table({words()("assessment.criterion"), words()("assessment.value"), words()("assessment.uncertainty"),
                     "", words()("assessment.band"), words()("assessment.points"), words()("assessment.of"), ""},
                    rows, words()("assessment.interval"));
    }

    void addViews() {
        page_.heading(words()("assessment.own-and-ideal"));
        if (!pictures_.missing.empty()) page_.paragraph(pictures_.missing, Tone::missing);
        if (pictures_.views.empty() && pictures_.missing.empty())
            page_.paragraph(words()("report.no-pictures-asked"), Tone::missing);
        bool isColoured = false, isOutlined = false;
        for (const AssessmentPictures::View& v : pictures_.views) {
            if (v.own.empty() && v.ideal.empty() && v.deviation.empty() && v.outlines.empty()) continue;
            page_.subheading(viewTitle(v.name));
            page_.begin(Group::thirds);
            if (!v.own.empty()) page_.picture(v.own, words()("assessment.own"));
            if (!v.ideal.empty()) page_.picture(v.ideal, words()("assessment.ideal"));
            if (!v.deviation.empty()) page_.picture(v.deviation, words()("assessment.deviation"));
            if (!v.outlines.empty()) page_.figure(v.outlines, words()("assessment.outlines"));
            page_.end();
            isColoured |= !v.deviation.empty();
            isOutlined |= !v.outlines.empty();
        }
        if (isColoured) {
            std::vector<HtmlReport::Chip> chips;
            for (const double share : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
                const double mm = share * kDeviationMostMm;
                chips.push_back({view::deviationColour(mm, kDeviationMostMm),
                                 share == 0.0 ? words()("assessment.as-ideal")
                                 : mm < 0.0   ? words()("assessment.too-much", fmt::format("{:.2f}", -mm))
                                              : words()("assessment.too-little", fmt::format("{:.2f}", mm))});
            }
            page_.legend(chips);
        }
        if (isOutlined) page_.paragraph(words()("assessment.outlines-legend"), Tone::note);
    }

    void addRules() {
        if (a_.rules.empty()) return;
        page_.heading(words()("assessment.rules"));
        std::vector<std::vector<std::string>> rows;
        for (const score::RuleResult& r : a_.rules)
            rows.push_back({ruleTitle(rubric_, r.id), !r.holds   ? words()("assessment.hangs")
                                                      : *r.holds ? words()("assessment.holds")
                                                                 : words()("assessment.holds-not")});
        page_.table({words()("rubric.rule"), ""}, rows);
    }

    void addOrigin() {
        const score::Identity& of = result_.identity;
        page_.heading(words()("assessment.origin"));
        Facts facts{{words()("assessment.proven"),
                     (of.proven ? words()("assessment.is-proven") : words()("assessment.not-proven")) + ": " +
                         said(result_.proof)},
                    {words()("assessment.device"),
                     a_.context.device.empty() ? words()("assessment.not-known") : a_.context.device},
                    {words()("assessment.exercise"), fmt::format("{} ({})", of.exercise, of.exerciseHash)},
                    {words()("assessment.rubric"),
                     fmt::format("{} {} ({})", a_.rubric, a_.rubricVersion, rubric::hashText(a_.rubricHash))},
                    {words()("assessment.state"), of.stateHash},
                    {words()("assessment.engine"), fmt::format("{}", of.engineRevision)}};
        for (const std::string& hash : of.sessionHashes)
            facts.emplace_back(words()("assessment.session"), hash);
        page_.facts({}, facts);
        if (!rubric_.source.empty()) page_.paragraph(words()("assessment.source", rubric_.source), Tone::note);
        page_.paragraph(words().text(fmt::format("rubric.status.{}", rubric::nameOf(rubric_.status))), Tone::note);
    }

    const score::Result& result_;
    const score::Assessment& a_;
    const tasks::Task& task_;
    const rubric::Rubric& rubric_;
    const AssessmentPictures& pictures_;
    const ReviewMaker& review_;
    const Bearings bearings_;
    HtmlReport page_;
};

}  // namespace

std::vector<std::size_t> costliest(const score::Assessment& a) {
    std::vector<std::size_t> dear;
    const auto isCritical = [&](std::size_t i) { return a.criteria[i].critical == score::Verdict::yes; };
    for (std::size_t i = 0; i < a.criteria.size(); ++i) {
        const score::CriterionScore& c = a.criteria[i];
        // A tenth of a point is no error to work on.
        if (isCritical(i) || (c.standing == score::Standing::judged && lossOf(c) >= 0.1)) dear.push_back(i);
    }
    std::stable_sort(dear.begin(), dear.end(), [&](std::size_t x, std::size_t y) {
        if (isCritical(x) != isCritical(y)) return isCritical(x);
        return lossOf(a.criteria[x]) > lossOf(a.criteria[y]);
    });
    return dear;
}

bool costsUndone(const score::Assessment& a) {
    return a.completeness && a.lostUndone() >= 0.1;
}

std::string undoneWords(const score::Assessment& a) {
    if (!a.completeness) return {};
    const score::Completeness& c = *a.completeness;
    if (!c.value) return words()("assessment.completeness-unknown", said(c.reason));
    if (c.factor >= 1.0) return {};
    return words()("assessment.undone", fmt::format("{:.0f}", *c.value), c.unit,
                   fmt::format("{:.0f}", 100.0 * c.factor));
}

std::string studentReport(const score::Result& result, const tasks::Task& task, const rubric::Rubric& rubric,
                          const AssessmentPictures& pictures, const ReviewMaker& review) {
    return Page(result, task, rubric, pictures, review).text();
}

}  // namespace handpiece::report
