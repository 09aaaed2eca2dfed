// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "handpiece/assess/measures/cusps.h"
#include "handpiece/assess/rubric/lint.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/case/tissue.h"

namespace handpiece::rubric {
namespace {

using measures::MeasureKind;
using measures::Selector;

using config::Phrase;

template <class... Parts>
Phrase say(const char* id, Parts&&... parts) {
    return {id, {fmt::format("{}", std::forward<Parts>(parts))...}};
}

/// The nearest of the names by insertions, deletions and changes; for "did you mean".
std::string_view nearest(std::string_view name, std::span<const MeasureKind> kinds) {
    std::string_view best;
    std::size_t least = ~std::size_t{0};
    for (const MeasureKind& kind : kinds) {
        std::vector<std::size_t> row(kind.id.size() + 1);
        for (std::size_t j = 0; j < row.size(); ++j)
            row[j] = j;
        for (std::size_t i = 0; i < name.size(); ++i) {
            std::size_t diagonal = row[0];
            row[0] = i + 1;
            for (std::size_t j = 1; j < row.size(); ++j) {
                const std::size_t change = diagonal + (name[i] != kind.id[j - 1] ? 1 : 0);
                diagonal = row[j];
                row[j] = std::min({change, row[j] + 1, row[j - 1] + 1});
            }
        }
        if (row.back() < least) least = row.back(), best = kind.id;
    }
    return best;
}

std::vector<std::string_view> tissues() {
    std::vector<std::string_view> names;
    for (std::size_t i = 1; i < cases::kTissueCount; ++i)
        names.push_back(cases::properties(static_cast<cases::Tissue>(i)).name);
    return names;
}

std::vector<std::string_view> sidesAndCusps() {
    std::vector<std::string_view> all(std::begin(measures::kSides), std::end(measures::kSides));
    all.insert(all.end(), std::begin(measures::kCusps), std::end(measures::kCusps));
    return all;
}
template <class List>
bool has(const List& list, std::string_view name) {
    return std::find(std::begin(list), std::end(list), name) != std::end(list);
}

/// Names on a way that comes back to where it began, by what each refers to; empty when there is none.
std::vector<std::string> circleIn(const std::map<std::string, std::vector<std::string>>& refers) {
    std::map<std::string, int> state;  // 1: on the way, 2: done
    std::vector<std::string> way, circle;
    const std::function<bool(const std::string&)> visit = [&](const std::string& name) {
        if (state[name] == 2) return false;
        way.push_back(name);
        if (state[name] == 1) {
            circle.assign(std::find(way.begin(), way.end(), name), way.end());
            return true;
        }
        state[name] = 1;
        if (const auto at = refers.find(name); at != refers.end())
            for (const std::string& other : at->second)
                if (visit(other)) return true;
        state[name] = 2;
        way.pop_back();
        return false;
    };
    for (const auto& [name, others] : refers)
        if (visit(name)) break;
    return circle;
}

class Linter {
  public:
    explicit Linter(const Rubric& rubric) : rubric_(rubric) {}

    std::vector<SaidFinding> findings() {
        whole();
        if (rubric_.completeness) completeness();
        for (const Criterion& c : rubric_.criteria)
            criterion(c);
        references();
        languages();
        return std::move(findings_);
    }

  private:
    void tell(Severity severity, int line, const Phrase& of, Phrase said, Phrase advice = {},
              std::string criterion = {}) {
        static const config::Words& english = config::Words::in("en");
        std::string where = line > 0 ? fmt::format("{}:{}", rubric_.where, line) : rubric_.where;
        if (!of.empty()) where += ": " + english(of);
        findings_.push_back({{severity, std::move(where), english(said), english(advice), std::move(criterion)},
                             of,
                             std::move(said),
                             std::move(advice)});
    }
    void tell(Severity severity, const Criterion& c, Phrase said, Phrase advice = {}, int line = 0) {
        const bool isCriterion = &c != &completeness_;
        tell(severity, line > 0 ? line : c.line,
             isCriterion ? say("lint.of-criterion", c.id) : say("lint.of-completeness"), std::move(said),
             std::move(advice), isCriterion ? c.id : std::string());
    }

    void whole();
    void completeness();
    const MeasureKind* kindOf(const Criterion& c);
    void criterion(const Criterion& c);
    void selection(const Criterion& c, const MeasureKind& kind);
    void knots(const Criterion& c, const MeasureKind* kind);
    void bands(const Criterion& c, const MeasureKind* kind);
    void critical(const Criterion& c, const MeasureKind* kind);
    void value(const Criterion& c, const MeasureKind* kind, double v, const char* what, int line = 0);
    void references();
    void rule(const Rule& r);
    void languages();
    template <class List>
    void once(const List& list, const char* what);

    const Rubric& rubric_;
    Criterion completeness_;  ///< what both have, so that both are checked alike
    std::vector<SaidFinding> findings_;
};

template <class List>
void Linter::once(const List& list, const char* what) {
    std::set<std::string> seen;
    for (const auto& entry : list)
        if (!seen.insert(entry.id).second) tell(Severity::error, 0, {}, say(what, entry.id), say("lint.rename"));
}

void Linter::whole() {
    if (rubric_.criteria.empty()) tell(Severity::error, 0, {}, say("lint.no-criterion"), say("lint.add-criterion"));
    if (rubric_.title.empty()) tell(Severity::warning, 0, {}, say("lint.no-title"), say("lint.give-title"));
    once(rubric_.criteria, "lint.two-criteria");
    once(rubric_.bands, "lint.two-bands");
    once(rubric_.steps, "lint.two-steps");
    once(rubric_.rules, "lint.two-rules");
    double sum = 0.0;
    for (const Criterion& c : rubric_.criteria)
        sum += c.weight;
    if (rubric_.totalWeight && std::abs(sum - *rubric_.totalWeight) > 1e-9 * std::max(1.0, sum))
        tell(Severity::error, 0, {}, say("lint.sum", sum, *rubric_.totalWeight), say("lint.mend-sum"));
    if (rubric_.passMark && !(*rubric_.passMark > 0.0 && *rubric_.passMark <= 100.0))
        tell(Severity::error, 0, {}, say("lint.pass-mark", *rubric_.passMark), say("lint.pass-mark-range"));
    if (rubric_.passMark && sum == 0.0)
        tell(Severity::error, 0, {}, say("lint.pass-mark-alone"), say("lint.give-weights"));
    if (rubric_.status != Status::proposal && rubric_.source.empty())
        tell(Severity::error, 0, {}, say("lint.no-source", nameOf(rubric_.status)),
             say("lint.give-source-or-proposal"));
    const bool canPass = rubric_.passMark || std::any_of(rubric_.rules.begin(), rubric_.rules.end(),
                                                         [](const Rule& r) { return r.required; });
    if (!canPass) tell(Severity::remark, 0, {}, say("lint.teacher-decides"));
}

void Linter::value(const Criterion& c, const MeasureKind* kind, double v, const char* what, int line) {
    if (kind && (v < kind->least || v > kind->most))
        tell(Severity::error, c, say(what, v, kind->unit, kind->least, kind->most), say("lint.mind-unit"), line);
}

void Linter::selection(const Criterion& c, const MeasureKind& kind) {
    const auto takes = [&](Selector selector, bool isGiven, const char* key) {
        if (!isGiven) return false;
        const bool isTaken = (kind.takes & static_cast<unsigned>(selector)) != 0;
        if (!isTaken) tell(Severity::error, c, say("lint.takes-none", kind.id, key), say("lint.leave-out", key));
        return isTaken;
    };
    const auto unknown = [&](const char* key, const std::string& given, const auto& known) {
        tell(Severity::error, c, say("lint.unknown-of", key, given.substr(0, 64)),
             say("lint.one-of", fmt::join(known, ", ")));
    };
    const measures::Selection& of = c.of;
    if (takes(Selector::zone, !of.zone.empty(), "zone") && !has(measures::kZones, of.zone))
        unknown("zone", of.zone, measures::kZones);
    if (takes(Selector::tissue, !of.tissue.empty(), "tissue") && !has(tissues(), of.tissue))
        unknown("tissue", of.tissue, tissues());
    if (takes(Selector::side, !of.side.empty(), "side") && !has(measures::kSides, of.side)) {
        if (kind.id != "reduction")
            unknown("side", of.side, measures::kSides);
        else if (!has(measures::kCusps, of.side))
            unknown("side", of.side, sidesAndCusps());
    }
    if (takes(Selector::statistic, !of.statistic.empty(), "statistic") && !has(measures::kStatistics, of.statistic))
        unknown("statistic", of.statistic, measures::kStatistics);
    takes(Selector::limit, of.limit.has_value(), "limit");
    if ((kind.takes & static_cast<unsigned>(Selector::limit)) != 0 && !of.limit)
        tell(Severity::error, c, say("lint.needs-limit", kind.id), say("lint.give-limit"));
}

const MeasureKind* Linter::kindOf(const Criterion& c) {
    const MeasureKind* kind = measures::findMeasureKind(c.measure);
    if (!kind) {
        tell(Severity::error, c, say("lint.unknown-measure", c.measure),
             say("lint.did-you-mean", nearest(c.measure, measures::measureKinds())));
        return nullptr;
    }
    if (c.unit != kind->unit)
        tell(Severity::error, c, c.unit.empty() ? say("lint.no-unit") : say("lint.unit", c.unit.substr(0, 64)),
             kind->unit.empty() ? say("lint.unit-none", kind->id) : say("lint.unit-is", kind->id, kind->unit));
    selection(c, *kind);
    return kind;
}

void Linter::completeness() {
    const Completeness& asked = *rubric_.completeness;
    Criterion& c = completeness_;
    c.measure = asked.measure, c.unit = asked.unit, c.of = asked.of, c.line = asked.line;
    const MeasureKind* kind = kindOf(c);
    // Of an attempt alone, and of a scan, nothing is known of the hand: its points would hang on how it was handed in.
    if (kind && kind->subject == measures::Subject::hand)
        tell(Severity::error, c, say("lint.completeness-hand", kind->id), say("lint.completeness-of-tooth"));
    if (asked.knots.size() < 2) tell(Severity::error, c, say("lint.one-knot"), say("lint.two-factors"));
    for (std::size_t i = 0; i < asked.knots.size(); ++i) {
        const Knot& knot = asked.knots[i];
        value(c, kind, knot.value, "lint.a-knot");
        if (!(knot.points >= 0.0 && knot.points <= 1.0))
            tell(Severity::error, c, say("lint.factor", knot.points), say("lint.factor-range"));
        if (i == 0) continue;
        if (!(knot.value > asked.knots[i - 1].value))
            tell(Severity::error, c, say("lint.knots-order", knot.value), say("lint.sort-knots"));
        if (knot.points < asked.knots[i - 1].points)
            tell(Severity::error, c, say("lint.factor-falls", knot.value), say("lint.factor-rises"));
    }
    if (asked.knots.size() < 2) return;
    if (asked.knots.back().points != 1.0)
        tell(Severity::error, c, say("lint.factor-end", asked.knots.back().points), say("lint.factor-to-1"));
    if (asked.knots.front().points > 0.0)
        tell(Severity::warning, c, say("lint.factor-begin", asked.knots.front().points), say("lint.factor-from-0"));
}

void Linter::criterion(const Criterion& c) {
    const MeasureKind* kind = kindOf(c);
    if (kind && c.isGraded() && kind->subject == measures::Subject::hand && c.devices.empty())
        tell(Severity::warning, c, say("lint.any-device"), say("lint.name-devices"));
    if (c.isGraded() && c.knots.empty() && c.bands.empty())
        tell(Severity::error, c, say("lint.no-points"), say("lint.say-points"));
    if (!c.isGraded() && !c.knots.empty())
        tell(Severity::error, c, say("lint.knots-no-weight"), say("lint.weight-or-knots"));
    knots(c, kind);
    bands(c, kind);
    critical(c, kind);
    const Status status = c.status.value_or(rubric_.status);
    if (status < rubric_.status && c.source.empty())
        tell(Severity::error, c, say("lint.no-source", nameOf(status)), say("lint.give-source"));
    if (status > rubric_.status)
        tell(Severity::error, c, say("lint.status-weaker", nameOf(status), nameOf(rubric_.status)),
             say("lint.status-weakest", nameOf(status)));
    if (c.title.empty()) tell(Severity::warning, c, say("lint.no-title"), say("lint.give-title"));
}

/// Where points rise again after they fell.
bool hasTwoPeaks(const std::vector<double>& points) {
    bool fell = false;
    for (std::size_t i = 1; i < points.size(); ++i) {
        if (points[i] < points[i - 1]) fell = true;
        if (points[i] > points[i - 1] && fell) return true;
    }
    return false;
}

void Linter::knots(const Criterion& c, const MeasureKind* kind) {
    if (c.knots.empty()) return;
    if (c.knots.size() == 1) tell(Severity::error, c, say("lint.one-knot"), say("lint.two-knots"));
    std::vector<double> points;
    for (std::size_t i = 0; i < c.knots.size(); ++i) {
        const Knot& knot = c.knots[i];
        if (i > 0 && !(knot.value > c.knots[i - 1].value))
            tell(Severity::error, c, say("lint.knots-order", knot.value), say("lint.sort-knots"));
        value(c, kind, knot.value, "lint.a-knot");
        if (!(knot.points >= 0.0 && knot.points <= 100.0))
            tell(Severity::error, c, say("lint.knot-points", knot.points), say("lint.points-range"));
        points.push_back(knot.points);
    }
    if (hasTwoPeaks(points)) tell(Severity::error, c, say("lint.two-peaks"), say("lint.only-fall"));
    if (*std::max_element(points.begin(), points.end()) < 100.0)
        tell(Severity::warning, c, say("lint.no-full"), say("lint.ideal-100"));
    if (std::all_of(points.begin(), points.end(), [&](double p) { return p == points.front(); }))
        tell(Severity::warning, c, say("lint.flat"), say("lint.differ"));
}

void Linter::bands(const Criterion& c, const MeasureKind* kind) {
    if (c.bands.empty()) return;
    std::vector<const Band*> sorted;
    bool wrong = false;
    for (const Band& band : c.bands) {
        const auto is = [&](const BandName& name) { return name.id == band.id; };
        if (std::none_of(rubric_.bands.begin(), rubric_.bands.end(), is))
            tell(Severity::error, c, say("lint.unknown-band", band.id), say("lint.list-band"), band.line);
        if (band.from && band.to && *band.from > *band.to) {
            tell(Severity::error, c, say("lint.band-order", band.id, *band.from, *band.to), say("lint.from-lesser"),
                 band.line);
            wrong = true;
        }
        if (band.from) value(c, kind, *band.from, "lint.band-begins", band.line);
        if (band.to) value(c, kind, *band.to, "lint.band-ends", band.line);
        if (band.points && !(*band.points >= 0.0 && *band.points <= 100.0))
            tell(Severity::error, c, say("lint.band-points", band.id, *band.points), say("lint.points-range"),
                 band.line);
        if (band.points && !c.knots.empty())
            tell(Severity::error, c, say("lint.band-and-knots", band.id), say("lint.bands-labels"), band.line);
        if (band.points && !c.isGraded())
            tell(Severity::error, c, say("lint.band-no-weight", band.id), say("lint.give-weight"), band.line);
        if (!band.points && c.isGraded() && c.knots.empty())
            tell(Severity::error, c, say("lint.band-none", band.id), say("lint.give-points"), band.line);
        sorted.push_back(&band);
    }
    if (wrong) return;
    static constexpr double kFar = 1e300;
    const auto from = [](const Band* b) { return b->from.value_or(-kFar); };
    const auto to = [](const Band* b) { return b->to.value_or(kFar); };
    std::stable_sort(sorted.begin(), sorted.end(), [&](const Band* a, const Band* b) {
        return from(a) != from(b) ? from(a) < from(b) : to(a) < to(b);
    });
    const auto told = [](double v) {
        return v <= -kFar ? std::string("below") : v >= kFar ? std::string("above") : fmt::format("{}", v);
    };
    const auto gap = [&](double low, double high) {
        tell(Severity::error, c, say("lint.gap", told(low), told(high)), say("lint.close-gap"));
    };
    if (from(sorted.front()) > (kind ? kind->least : from(sorted.front()))) gap(kind->least, from(sorted.front()));
    double end = to(sorted.front());
    for (std::size_t i = 1; i < sorted.size(); ++i) {
        if (from(sorted[i]) > end) gap(end, from(sorted[i]));
        if (from(sorted[i]) < end)
            tell(Severity::error, c,
                 say("lint.overlap", sorted[i]->id, told(from(sorted[i])), told(std::min(end, to(sorted[i])))),
                 say("lint.touch"), sorted[i]->line);
        end = std::max(end, to(sorted[i]));
    }
    if (kind && end < kind->most) gap(end, kind->most);
    if (!c.isGraded() || !c.knots.empty()) return;
    std::vector<double> points;
    for (const Band* band : sorted)
        points.push_back(band->points.value_or(0.0));
    if (hasTwoPeaks(points)) tell(Severity::error, c, say("lint.bands-two-peaks"), say("lint.only-fall"));
    if (*std::max_element(points.begin(), points.end()) < 100.0)
        tell(Severity::warning, c, say("lint.no-full"), say("lint.ideal-100"));
    for (const Band& better : c.bands)
        for (const Band& worse : c.bands) {
            const auto rank = [&](const Band& b) {
                return std::find_if(rubric_.bands.begin(), rubric_.bands.end(),
                                    [&](const BandName& n) { return n.id == b.id; }) -
                       rubric_.bands.begin();
            };
            if (rank(better) < rank(worse) && better.points.value_or(0) < worse.points.value_or(0)) {
                tell(Severity::warning, c, say("lint.worse-more", worse.id, better.id), say("lint.best-first"),
                     worse.line);
                return;
            }
        }
}

void Linter::critical(const Criterion& c, const MeasureKind* kind) {
    if (!c.critical) return;
    const auto& [below, above, title, line] = *c.critical;
    if (!below && !above) tell(Severity::error, c, say("lint.critical-none"), say("lint.give-critical"), line);
    if (below) value(c, kind, *below, "lint.critical-below", line);
    if (above) value(c, kind, *above, "lint.critical-above", line);
    if (below && above && *below > *above)
        tell(Severity::error, c, say("lint.all-critical", *below, *above), say("lint.below-lesser"), line);
    if (kind && ((below && !above && *below == kind->least) || (above && !below && *above == kind->most)))
        tell(Severity::error, c, say("lint.never-critical"), say("lint.move-limit"), line);
}

void Linter::rule(const Rule& r) {
    const auto wrong = [&](Phrase problem, Phrase remedy) {
        tell(Severity::error, r.line, say("lint.of-rule", r.id), std::move(problem), std::move(remedy));
    };
    std::size_t banded = 0;
    for (const Criterion& c : rubric_.criteria)
        banded += c.bands.empty() ? 0 : 1;
    for (const Condition& need : r.needs) {
        for (const std::string& band : need.bands)
            if (std::none_of(rubric_.bands.begin(), rubric_.bands.end(),
                             [&](const BandName& n) { return n.id == band; }))
                wrong(say("lint.unknown-band", band), say("lint.list-it"));
        for (const std::string& name : need.of) {
            const Criterion* c = rubric_.criterion(name);
            if (!c)
                wrong(say("lint.unknown-criterion", name), say("lint.name-one"));
            else if (c->bands.empty())
                wrong(say("lint.no-bands", name), say("lint.bands-or-out"));
        }
        if (need.least && need.most && *need.least > *need.most)
            wrong(say("lint.never", *need.least, *need.most), say("lint.least-lesser"));
        const std::size_t counted = need.of.empty() ? banded : need.of.size();
        if (need.least && static_cast<std::size_t>(*need.least) > counted)
            wrong(say("lint.too-many", *need.least, counted), say("lint.fewer"));
        if (!need.rule.empty() && std::none_of(rubric_.rules.begin(), rubric_.rules.end(),
                                               [&](const Rule& other) { return other.id == need.rule; }))
            wrong(say("lint.unknown-rule", need.rule), say("lint.name-one"));
    }
    if (r.elseAtMost && !(*r.elseAtMost >= 0.0 && *r.elseAtMost < 100.0))
        wrong(say("lint.else-range", *r.elseAtMost), say("lint.under-100"));
    const bool isUsed = std::any_of(rubric_.rules.begin(), rubric_.rules.end(), [&](const Rule& other) {
        return std::any_of(other.needs.begin(), other.needs.end(), [&](const Condition& n) { return n.rule == r.id; });
    });
    if (!r.required && !r.elseAtMost && !isUsed)
        tell(Severity::warning, r.line, say("lint.of-rule", r.id), say("lint.no-effect"), say("lint.give-effect"));
}

void Linter::references() {
    std::map<std::string, std::string> stepOf;
    for (const Step& step : rubric_.steps)
        for (const std::string& name : step.criteria) {
            if (!rubric_.criterion(name))
                tell(Severity::error, step.line, say("lint.of-step", step.id), say("lint.unknown-criterion", name),
                     say("lint.name-one"));
            else if (const auto [at, isNew] = stepOf.emplace(name, step.id); !isNew)
                tell(Severity::error, step.line, say("lint.of-step", step.id), say("lint.step-twice", name, at->second),
                     say("lint.once"));
        }
    std::map<std::string, std::vector<std::string>> voids, needs;
    for (const Criterion& c : rubric_.criteria) {
        if (!rubric_.steps.empty() && !stepOf.contains(c.id))
            tell(Severity::warning, c, say("lint.in-no-step"), say("lint.name-in-step"));
        for (const std::string& name : c.excludes)
            if (!rubric_.criterion(name))
                tell(Severity::error, c, say("lint.excludes-unknown", name), say("lint.name-one"));
        if (!c.excludes.empty() && !c.isGraded() && !c.critical)
            tell(Severity::warning, c, say("lint.excludes-nothing"), say("lint.give-one"));
        voids[c.id] = c.excludes;
    }
    for (const Rule& r : rubric_.rules) {
        rule(r);
        for (const Condition& need : r.needs)
            if (!need.rule.empty()) needs[r.id].push_back(need.rule);
    }
    if (const std::vector<std::string> circle = circleIn(voids); !circle.empty())
        tell(Severity::error, 0, {}, say("lint.circle", fmt::join(circle, " -> ")), say("lint.break-it"));
    if (const std::vector<std::string> circle = circleIn(needs); !circle.empty())
        tell(Severity::error, 0, {}, say("lint.rule-circle", fmt::join(circle, " -> ")), say("lint.break-it"));
}

void Linter::languages() {
    std::vector<std::pair<std::string, const Texts*>> all = {{"the title", &rubric_.title},
                                                             {"the words", &rubric_.words}};
    if (rubric_.completeness) {
        all.emplace_back("completeness", &rubric_.completeness->title);
        all.emplace_back("completeness' words", &rubric_.completeness->words);
    }
    for (const BandName& band : rubric_.bands)
        all.emplace_back("band " + band.id, &band.title);
    for (const Step& step : rubric_.steps)
        all.emplace_back("step " + step.id, &step.title);
    for (const Criterion& c : rubric_.criteria) {
        all.emplace_back("criterion " + c.id, &c.title);
        all.emplace_back(c.id + "'s words", &c.words);
        all.emplace_back("what " + c.id + " leaves out", &c.leavesOut);
        if (c.critical) all.emplace_back(c.id + "'s critical error", &c.critical->title);
    }
    for (const Rule& r : rubric_.rules)
        all.emplace_back("rule " + r.id, &r.title);
    std::set<std::string> languages;
    for (const auto& [what, texts] : all)
        for (const auto& [language, text] : *texts)
            languages.insert(language);
    for (const std::string& language : languages) {
        std::vector<std::string> missing;
        for (const auto& [what, texts] : all)
            if (!texts->empty() && !texts->contains(language)) missing.push_back(what);
        if (!missing.empty()) {
            tell(Severity::remark, 0, {}, say("lint.not-in", language, missing.size()));
            findings_.back().finding.problem = fmt::format("not in \"{}\": {}", language, fmt::join(missing, ", "));
        }
    }
}

}  // namespace

std::vector<SaidFinding> lint(const Rubric& rubric) {
    return Linter(rubric).findings();
}

std::vector<Finding> check(const Rubric& rubric) {
    std::vector<Finding> found;
    for (SaidFinding& one : lint(rubric))
        found.push_back(std::move(one.finding));
    return found;
}

void requireSound(const Rubric& rubric) {
    for (const Finding& f : check(rubric))
        if (f.severity == Severity::error) throw core::Error(f.problem, f.where, f.remedy).as("bad-text", {f.problem});
}

}  // namespace handpiece::rubric
