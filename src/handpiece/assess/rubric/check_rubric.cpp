// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/case/tissue.h"

namespace handpiece::rubric {
namespace {

using measures::MeasureKind;
using measures::Selector;

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

    std::vector<Finding> findings() {
        whole();
        for (const Criterion& c : rubric_.criteria)
            criterion(c);
        references();
        languages();
        return std::move(findings_);
    }

  private:
    void tell(Severity severity, int line, const std::string& of, std::string problem, std::string remedy = {},
              std::string criterion = {}) {
        std::string where = line > 0 ? fmt::format("{}:{}", rubric_.where, line) : rubric_.where;
        if (!of.empty()) where += ": " + of;
        findings_.push_back({severity, std::move(where), std::move(problem), std::move(remedy), std::move(criterion)});
    }
    void tell(Severity severity, const Criterion& c, std::string problem, std::string remedy = {}, int line = 0) {
        tell(severity, line > 0 ? line : c.line, "criterion " + c.id, std::move(problem), std::move(remedy), c.id);
    }

    void whole();
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
    std::vector<Finding> findings_;
};

template <class List>
void Linter::once(const List& list, const char* what) {
    std::set<std::string> seen;
    for (const auto& entry : list)
        if (!seen.insert(entry.id).second)
            tell(Severity::error, 0, {}, fmt::format("there are two {} \"{}\"", what, entry.id),
                 "give one another name");
}

void Linter::whole() {
    if (rubric_.criteria.empty())
        tell(Severity::error, 0, {}, "there is no criterion", "give at least one [[criterion]]");
    if (rubric_.title.empty()) tell(Severity::warning, 0, {}, "it has no title", "give title = { en = \"...\" }");
    once(rubric_.criteria, "criteria");
    once(rubric_.bands, "bands");
    once(rubric_.steps, "steps");
    once(rubric_.rules, "rules");
    double sum = 0.0;
    for (const Criterion& c : rubric_.criteria)
        sum += c.weight;
    if (rubric_.totalWeight && std::abs(sum - *rubric_.totalWeight) > 1e-9 * std::max(1.0, sum))
        tell(Severity::error, 0, {},
             fmt::format("the weights sum to {}, not to the {} that total_weight states", sum, *rubric_.totalWeight),
             "mend a weight or total_weight");
    if (rubric_.passMark && !(*rubric_.passMark > 0.0 && *rubric_.passMark <= 100.0))
        tell(Severity::error, 0, {}, fmt::format("pass_mark is {}", *rubric_.passMark),
             "it is in % of the greatest score, above 0");
    if (rubric_.passMark && sum == 0.0)
        tell(Severity::error, 0, {}, "there is a pass_mark and no criterion has a weight", "give weights");
    if (rubric_.status != Status::proposal && rubric_.source.empty())
        tell(Severity::error, 0, {}, fmt::format("it is {}, and there is no source", nameOf(rubric_.status)),
             "give source = \"...\", or status = \"proposal\"");
    const bool canPass = rubric_.passMark || std::any_of(rubric_.rules.begin(), rubric_.rules.end(),
                                                         [](const Rule& r) { return r.required; });
    if (!canPass)
        tell(Severity::remark, 0, {},
             "it has neither a pass_mark nor a required rule: who passes, the teacher decides");
}

void Linter::value(const Criterion& c, const MeasureKind* kind, double v, const char* what, int line) {
    if (kind && (v < kind->least || v > kind->most))
        tell(Severity::error, c,
             fmt::format("{} at {} {}, which no measure can have: {} to {}", what, v, kind->unit, kind->least,
                         kind->most),
             "mind the unit", line);
}

void Linter::selection(const Criterion& c, const MeasureKind& kind) {
    const auto takes = [&](Selector selector, bool isGiven, const char* key) {
        if (!isGiven) return false;
        const bool isTaken = (kind.takes & static_cast<unsigned>(selector)) != 0;
        if (!isTaken)
            tell(Severity::error, c, fmt::format("{} has no {}", kind.id, key), fmt::format("leave {} out", key));
        return isTaken;
    };
    const auto unknown = [&](const char* key, const std::string& given, const auto& known) {
        tell(Severity::error, c, fmt::format("there is no {} \"{}\"", key, given.substr(0, 64)),
             fmt::format("one of {}", fmt::join(known, ", ")));
    };
    const measures::Selection& of = c.of;
    if (takes(Selector::zone, !of.zone.empty(), "zone") && !has(measures::kZones, of.zone))
        unknown("zone", of.zone, measures::kZones);
    if (takes(Selector::tissue, !of.tissue.empty(), "tissue") && !has(tissues(), of.tissue))
        unknown("tissue", of.tissue, tissues());
    if (takes(Selector::side, !of.side.empty(), "side") && !has(measures::kSides, of.side))
        unknown("side", of.side, measures::kSides);
    if (takes(Selector::statistic, !of.statistic.empty(), "statistic") && !has(measures::kStatistics, of.statistic))
        unknown("statistic", of.statistic, measures::kStatistics);
    takes(Selector::limit, of.limit.has_value(), "limit");
    if ((kind.takes & static_cast<unsigned>(Selector::limit)) != 0 && !of.limit)
        tell(Severity::error, c, fmt::format("{} needs a limit", kind.id), "give limit = ...");
}

void Linter::criterion(const Criterion& c) {
    const MeasureKind* kind = measures::findMeasureKind(c.measure);
    if (!kind) {
        tell(Severity::error, c, fmt::format("there is no measure \"{}\"", c.measure),
             fmt::format("did you mean \"{}\"? docs/formats/rubric.md lists them",
                         nearest(c.measure, measures::measureKinds())));
    } else {
        if (c.unit != kind->unit)
            tell(Severity::error, c,
                 c.unit.empty() ? fmt::format("the unit is missing")
                                : fmt::format("the unit is \"{}\"", c.unit.substr(0, 64)),
                 kind->unit.empty()
                     ? fmt::format("{} has none: leave it out", kind->id)
                     : fmt::format("{} is in {}: write unit = \"{}\"", kind->id, kind->unit, kind->unit));
        selection(c, *kind);
        if (c.isGraded() && kind->subject == measures::Subject::hand && c.devices.empty())
            tell(Severity::warning, c, "it grades the hand on any device",
                 "name the devices: scores of different ones are never pooled");
    }
    if (c.isGraded() && c.knots.empty() && c.bands.empty())
        tell(Severity::error, c, "it has a weight and neither knots nor bands", "say what gives how many points");
    if (!c.isGraded() && !c.knots.empty())
        tell(Severity::error, c, "it has knots and no weight", "give weight = ..., or leave the knots out");
    knots(c, kind);
    bands(c, kind);
    critical(c, kind);
    const Status status = c.status.value_or(rubric_.status);
    if (status < rubric_.status && c.source.empty())
        tell(Severity::error, c, fmt::format("it is {}, and there is no source", nameOf(status)),
             "give source = \"...\"");
    if (status > rubric_.status)
        tell(Severity::error, c,
             fmt::format("it is {} in a rubric that says {}", nameOf(status), nameOf(rubric_.status)),
             fmt::format("a rubric is no more than its weakest criterion: status = \"{}\"", nameOf(status)));
    if (c.title.empty()) tell(Severity::warning, c, "it has no title", "give title = { en = \"...\" }");
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
    if (c.knots.size() == 1) tell(Severity::error, c, "one knot is no curve", "give two at least");
    std::vector<double> points;
    for (std::size_t i = 0; i < c.knots.size(); ++i) {
        const Knot& knot = c.knots[i];
        if (i > 0 && !(knot.value > c.knots[i - 1].value))
            tell(Severity::error, c, fmt::format("the knots do not ascend at {}", knot.value),
                 "sort them, each value once");
        value(c, kind, knot.value, "a knot lies");
        if (!(knot.points >= 0.0 && knot.points <= 100.0))
            tell(Severity::error, c, fmt::format("a knot gives {} points", knot.points), "0 to 100");
        points.push_back(knot.points);
    }
    if (hasTwoPeaks(points))
        tell(Severity::error, c, "the points rise again after they fell",
             "away from the ideal they may only fall, to either side");
    if (*std::max_element(points.begin(), points.end()) < 100.0)
        tell(Severity::warning, c, "nobody can have full points", "let the ideal give 100");
    if (std::all_of(points.begin(), points.end(), [&](double p) { return p == points.front(); }))
        tell(Severity::warning, c, "all values give the same points",
             "let the points differ, or show the criterion only");
}

void Linter::bands(const Criterion& c, const MeasureKind* kind) {
    if (c.bands.empty()) return;
    std::vector<const Band*> sorted;
    bool wrong = false;
    for (const Band& band : c.bands) {
        const auto is = [&](const BandName& name) { return name.id == band.id; };
        if (std::none_of(rubric_.bands.begin(), rubric_.bands.end(), is))
            tell(Severity::error, c, fmt::format("there is no band \"{}\"", band.id),
                 "list it: [[band]], from best to worst", band.line);
        if (band.from && band.to && *band.from > *band.to) {
            tell(Severity::error, c, fmt::format("band \"{}\" goes from {} to {}", band.id, *band.from, *band.to),
                 "from is the lesser", band.line);
            wrong = true;
        }
        if (band.from) value(c, kind, *band.from, "a band begins", band.line);
        if (band.to) value(c, kind, *band.to, "a band ends", band.line);
        if (band.points && !(*band.points >= 0.0 && *band.points <= 100.0))
            tell(Severity::error, c, fmt::format("band \"{}\" gives {} points", band.id, *band.points), "0 to 100",
                 band.line);
        if (band.points && !c.knots.empty())
            tell(Severity::error, c, fmt::format("band \"{}\" gives points, and the knots do too", band.id),
                 "leave one of them out: with knots, bands are labels", band.line);
        if (band.points && !c.isGraded())
            tell(Severity::error, c, fmt::format("band \"{}\" gives points, and there is no weight", band.id),
                 "give weight = ...", band.line);
        if (!band.points && c.isGraded() && c.knots.empty())
            tell(Severity::error, c, fmt::format("band \"{}\" gives no points", band.id), "give points = ..., or knots",
                 band.line);
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
        tell(Severity::error, c, fmt::format("no band has the values from {} to {}", told(low), told(high)),
             "close the gap");
    };
    if (from(sorted.front()) > (kind ? kind->least : from(sorted.front()))) gap(kind->least, from(sorted.front()));
    double end = to(sorted.front());
    for (std::size_t i = 1; i < sorted.size(); ++i) {
        if (from(sorted[i]) > end) gap(end, from(sorted[i]));
        if (from(sorted[i]) < end)
            tell(Severity::error, c,
                 fmt::format("\"{}\" and another band both have the values from {} to {}", sorted[i]->id,
                             told(from(sorted[i])), told(std::min(end, to(sorted[i])))),
                 "let bands touch, not overlap", sorted[i]->line);
        end = std::max(end, to(sorted[i]));
    }
    if (kind && end < kind->most) gap(end, kind->most);
    if (!c.isGraded() || !c.knots.empty()) return;
    std::vector<double> points;
    for (const Band* band : sorted)
        points.push_back(band->points.value_or(0.0));
    if (hasTwoPeaks(points))
        tell(Severity::error, c, "the points of the bands rise again after they fell",
             "away from the ideal they may only fall, to either side");
    if (*std::max_element(points.begin(), points.end()) < 100.0)
        tell(Severity::warning, c, "nobody can have full points", "let the ideal give 100");
    for (const Band& better : c.bands)
        for (const Band& worse : c.bands) {
            const auto rank = [&](const Band& b) {
                return std::find_if(rubric_.bands.begin(), rubric_.bands.end(),
                                    [&](const BandName& n) { return n.id == b.id; }) -
                       rubric_.bands.begin();
            };
            if (rank(better) < rank(worse) && better.points.value_or(0) < worse.points.value_or(0)) {
                tell(Severity::warning, c, fmt::format("\"{}\" gives more points than \"{}\"", worse.id, better.id),
                     "[[band]] lists them from best to worst", worse.line);
                return;
            }
        }
}

void Linter::critical(const Criterion& c, const MeasureKind* kind) {
    if (!c.critical) return;
    const auto& [below, above, title, line] = *c.critical;
    if (!below && !above)
        tell(Severity::error, c, "the critical error has no condition", "give below = ... or above = ...", line);
    if (below) value(c, kind, *below, "critical below", line);
    if (above) value(c, kind, *above, "critical above", line);
    if (below && above && *below > *above)
        tell(Severity::error, c, fmt::format("every value is critical: below {} or above {}", *below, *above),
             "below is the lesser", line);
    if (kind && ((below && !above && *below == kind->least) || (above && !below && *above == kind->most)))
        tell(Severity::error, c, "no value can be critical", "move the limit into what the measure can have", line);
}

void Linter::rule(const Rule& r) {
    const auto wrong = [&](std::string problem, std::string remedy) {
        tell(Severity::error, r.line, "rule " + r.id, std::move(problem), std::move(remedy));
    };
    std::size_t banded = 0;
    for (const Criterion& c : rubric_.criteria)
        banded += c.bands.empty() ? 0 : 1;
    for (const Condition& need : r.needs) {
        for (const std::string& band : need.bands)
            if (std::none_of(rubric_.bands.begin(), rubric_.bands.end(),
                             [&](const BandName& n) { return n.id == band; }))
                wrong(fmt::format("there is no band \"{}\"", band), "list it: [[band]]");
        for (const std::string& name : need.of) {
            const Criterion* c = rubric_.criterion(name);
            if (!c)
                wrong(fmt::format("there is no criterion \"{}\"", name), "name one of the rubric's");
            else if (c->bands.empty())
                wrong(fmt::format("criterion \"{}\" has no bands", name), "give it bands, or leave it out");
        }
        if (need.least && need.most && *need.least > *need.most)
            wrong(fmt::format("at least {} and at most {} is never so", *need.least, *need.most),
                  "least is the lesser");
        const std::size_t counted = need.of.empty() ? banded : need.of.size();
        if (need.least && static_cast<std::size_t>(*need.least) > counted)
            wrong(fmt::format("at least {} of {} is never so", *need.least, counted), "ask for fewer");
        if (!need.rule.empty() && std::none_of(rubric_.rules.begin(), rubric_.rules.end(),
                                               [&](const Rule& other) { return other.id == need.rule; }))
            wrong(fmt::format("there is no rule \"{}\"", need.rule), "name one of the rubric's");
    }
    if (r.elseAtMost && !(*r.elseAtMost >= 0.0 && *r.elseAtMost < 100.0))
        wrong(fmt::format("else_at_most is {}", *r.elseAtMost), "it is in % of the greatest score, under 100");
    const bool isUsed = std::any_of(rubric_.rules.begin(), rubric_.rules.end(), [&](const Rule& other) {
        return std::any_of(other.needs.begin(), other.needs.end(), [&](const Condition& n) { return n.rule == r.id; });
    });
    if (!r.required && !r.elseAtMost && !isUsed)
        tell(Severity::warning, r.line, "rule " + r.id, "it has no effect",
             "give required = true or else_at_most = ...");
}

void Linter::references() {
    std::map<std::string, std::string> stepOf;
    for (const Step& step : rubric_.steps)
        for (const std::string& name : step.criteria) {
            if (!rubric_.criterion(name))
                tell(Severity::error, step.line, "step " + step.id, fmt::format("there is no criterion \"{}\"", name),
                     "name one of the rubric's");
            else if (const auto [at, isNew] = stepOf.emplace(name, step.id); !isNew)
                tell(Severity::error, step.line, "step " + step.id,
                     fmt::format("criterion \"{}\" is in step \"{}\" already", name, at->second), "once is enough");
        }
    std::map<std::string, std::vector<std::string>> voids, needs;
    for (const Criterion& c : rubric_.criteria) {
        if (!rubric_.steps.empty() && !stepOf.contains(c.id))
            tell(Severity::warning, c, "it is in no step", "name it in a [[step]]");
        for (const std::string& name : c.excludes)
            if (!rubric_.criterion(name))
                tell(Severity::error, c, fmt::format("it excludes \"{}\", which is no criterion", name),
                     "name one of the rubric's");
        if (!c.excludes.empty() && !c.isGraded() && !c.critical)
            tell(Severity::warning, c, "it can exclude nothing: it has neither points nor a critical error",
                 "give one of them");
        voids[c.id] = c.excludes;
    }
    for (const Rule& r : rubric_.rules) {
        rule(r);
        for (const Condition& need : r.needs)
            if (!need.rule.empty()) needs[r.id].push_back(need.rule);
    }
    if (const std::vector<std::string> circle = circleIn(voids); !circle.empty())
        tell(Severity::error, 0, {},
             fmt::format("criteria exclude each other in a circle: {}", fmt::join(circle, " -> ")), "break it");
    if (const std::vector<std::string> circle = circleIn(needs); !circle.empty())
        tell(Severity::error, 0, {}, fmt::format("rules need each other in a circle: {}", fmt::join(circle, " -> ")),
             "break it");
}

void Linter::languages() {
    std::vector<std::pair<std::string, const Texts*>> all = {{"the title", &rubric_.title},
                                                             {"the words", &rubric_.words}};
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
        if (!missing.empty())
            tell(Severity::remark, 0, {}, fmt::format("not in \"{}\": {}", language, fmt::join(missing, ", ")));
    }
}

}  // namespace

std::vector<Finding> check(const Rubric& rubric) {
    return Linter(rubric).findings();
}

void requireSound(const Rubric& rubric) {
    for (const Finding& f : check(rubric))
        if (f.severity == Severity::error) throw core::Error(f.problem, f.where, f.remedy).as("bad-text", {f.problem});
}

}  // namespace handpiece::rubric
