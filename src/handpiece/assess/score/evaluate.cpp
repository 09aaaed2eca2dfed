// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "handpiece/assess/score/score.h"
#include "handpiece/base/core/error.h"

namespace handpiece::score {
namespace {

using measures::Measured;
using measures::MeasureKind;
using rubric::Band;
using rubric::Criterion;
using rubric::Knot;
using rubric::Rubric;

/// The values that a measure may truly have had.
struct Interval {
    double low, high;
};

std::optional<std::string> unusable(const Measured& m, const MeasureKind& kind) {
    if (!m.value) return m.reason.empty() ? std::string("it was not measured") : m.reason;
    if (!std::isfinite(*m.value)) return std::string("what was measured is no number");
    if (*m.value < kind.least || *m.value > kind.most)
        return fmt::format("{} {} cannot be: {} to {}", *m.value, kind.unit, kind.least, kind.most);
    if (!(m.uncertainty >= 0.0) || !std::isfinite(m.uncertainty)) return std::string("how sure it is, is not known");
    return {};
}

/// Bands that the interval reaches, in the rubric's order, each once.
std::vector<std::string> bandsIn(const Rubric& rubric, const Criterion& c, const Interval& in) {
    std::set<std::string> found;
    for (const double end : {in.low, in.high})
        if (const Band* band = bandOf(c, end)) found.insert(band->id);
    for (const Band& band : c.bands)
        if ((!band.from || *band.from < in.high) && (!band.to || *band.to > in.low)) found.insert(band.id);
    std::vector<std::string> sorted;
    for (const rubric::BandName& name : rubric.bands)
        if (found.contains(name.id)) sorted.push_back(name.id);
    return sorted;
}

/// Least and most of a curve in an interval: at its ends, or at what lies between.
std::pair<double, double> pointsIn(const Criterion& c, const Interval& in) {
    double least = 100.0, most = 0.0;
    const auto take = [&](const std::optional<double>& points) {
        if (!points) return;
        least = std::min(least, *points);
        most = std::max(most, *points);
    };
    take(pointsOf(c, in.low));
    take(pointsOf(c, in.high));
    for (const Knot& knot : c.knots)
        if (knot.value > in.low && knot.value < in.high) take(knot.points);
    if (c.knots.empty())
        for (const Band& band : c.bands)
            if ((!band.from || *band.from < in.high) && (!band.to || *band.to > in.low)) take(band.points);
    return {least, most};
}

/// Full points are the weight to the bit.
double weighted(const Criterion& c, double points) {
    return points == 100.0 ? c.weight : std::min(c.weight, c.weight * points / 100.0);
}

Verdict criticalIn(const Criterion& c, double value, const Interval& in) {
    if (!c.critical) return Verdict::no;
    const auto is = [&](double v) {
        return (c.critical->below && v < *c.critical->below) || (c.critical->above && v > *c.critical->above);
    };
    if (!is(value)) return is(in.low) || is(in.high) ? Verdict::borderline : Verdict::no;
    // Critical from one side only where the whole interval lies beyond that limit.
    const bool surely =
        (c.critical->below && in.high < *c.critical->below) || (c.critical->above && in.low > *c.critical->above);
    return surely ? Verdict::yes : Verdict::borderline;
}

/// What was measured of what is asked; null: nothing. `why`: it cannot be used.
template <class Asks>
const Measured* find(const Asks& asks, std::span<const Measured> measured, std::optional<std::string>& why) {
    const auto at = std::find_if(measured.begin(), measured.end(),
                                 [&](const Measured& m) { return m.kind == asks.measure && m.of == asks.of; });
    if (at == measured.end()) {
        why = "it was not measured";
        return nullptr;
    }
    why = unusable(*at, *measures::findMeasureKind(asks.measure));
    return &*at;
}

Completeness completenessOf(const rubric::Completeness& asks, std::span<const Measured> measured) {
    Completeness c{asks.measure, asks.unit, asks.of, {}, {}, 0.0, 1.0, 1.0, 1.0, {}};
    std::optional<std::string> why;
    const Measured* m = find(asks, measured, why);
    if (m != nullptr) c.evidence = m->evidence;
    if (why) {
        c.reason = *why;
        return c;
    }
    c.value = *m->value;
    c.uncertainty = m->uncertainty;
    // Factors never fall, so what it is at the ends is what it is at most.
    c.factor = factorOf(asks, *c.value);
    c.leastFactor = std::min(c.factor, factorOf(asks, *c.value - c.uncertainty));
    c.mostFactor = std::max(c.factor, factorOf(asks, *c.value + c.uncertainty));
    return c;
}

CriterionScore judge(const Rubric& rubric, const Criterion& c, std::span<const Measured> measured,
                     const Context& context) {
    CriterionScore s;
    s.id = c.id;
    s.measure = c.measure;
    s.unit = c.unit;
    s.of = c.of;
    s.maxPoints = c.weight;
    std::optional<std::string> why;
    const Measured* at = find(c, measured, why);
    if (at != nullptr) s.evidence = at->evidence;
    const MeasureKind& kind = *measures::findMeasureKind(c.measure);
    if (!why) {
        s.value = *at->value;
        s.uncertainty = at->uncertainty;
    }
    if (!c.devices.empty() && std::find(c.devices.begin(), c.devices.end(), context.device) == c.devices.end()) {
        s.standing = Standing::leftOut;
        s.reason = fmt::format("not valid for the device \"{}\"", context.device);
        return s;
    }
    if (why) {
        s.standing = Standing::notMeasured;
        s.reason = *why;
        for (const Band& band : c.bands)
            if (std::find(s.possibleBands.begin(), s.possibleBands.end(), band.id) == s.possibleBands.end())
                s.possibleBands.push_back(band.id);
        return s;
    }
    const double value = *s.value;
    const Interval in = {std::max(kind.least, value - s.uncertainty), std::min(kind.most, value + s.uncertainty)};
    if (const Band* band = bandOf(c, value)) s.band = band->id;
    s.possibleBands = bandsIn(rubric, c, in);
    s.critical = criticalIn(c, value, in);
    s.borderline = s.possibleBands.size() > 1 || s.critical == Verdict::borderline;
    if (c.isGraded()) {
        const auto [least, most] = pointsIn(c, in);
        s.points = weighted(c, *pointsOf(c, value));
        s.ownPoints = *s.points;
        s.leastPoints = std::min(*s.points, weighted(c, least));
        s.mostPoints = std::max(*s.points, weighted(c, most));
    }
    return s;
}

/// Voids what failed criteria exclude; one that is void itself excludes nothing. There is no circle: the rubric is
/// sound. Returns the first criterion of which it is not sure whether it voids another; null when there is none.
const CriterionScore* voidExcluded(const Rubric& rubric, std::vector<CriterionScore>& scores) {
    std::map<std::string, std::vector<std::size_t>> excludedBy;
    for (std::size_t i = 0; i < rubric.criteria.size(); ++i)
        for (const std::string& name : rubric.criteria[i].excludes)
            excludedBy[name].push_back(i);
    const CriterionScore* unsure = nullptr;
    std::vector<char> isSettled(scores.size(), 0);
    const std::function<void(std::size_t)> settle = [&](std::size_t i) {
        if (isSettled[i]) return;
        isSettled[i] = 1;
        CriterionScore& s = scores[i];
        const CriterionScore* perhaps = nullptr;
        for (const std::size_t by : excludedBy[s.id]) {
            settle(by);
            const CriterionScore& other = scores[by];
            if (other.standing != Standing::judged || s.standing == Standing::leftOut) continue;
            const bool fails = other.critical == Verdict::yes || (other.points && other.mostPoints == 0.0);
            const bool mayFail = other.critical != Verdict::no || (other.points && other.leastPoints == 0.0);
            if (!fails && mayFail) perhaps = &other;
            if (!fails) continue;
            s.standing = Standing::voided;
            s.reason = fmt::format("void: \"{}\" failed", other.id);
            s.points.reset();
            s.ownPoints = 0.0;
            s.band.clear();
            s.possibleBands.clear();
            s.leastPoints = s.mostPoints = 0.0;
            s.borderline = s.critical == Verdict::borderline;
            return;
        }
        if (perhaps && !unsure) unsure = perhaps;
    };
    for (std::size_t i = 0; i < scores.size(); ++i)
        settle(i);
    return unsure;
}

/// Whether rules hold: surely, or by the values as they were measured.
class Rules {
  public:
    Rules(const Rubric& rubric, const std::vector<CriterionScore>& scores, bool surely)
        : rubric_(rubric), scores_(scores), surely_(surely) {}

    std::optional<bool> holds(const rubric::Rule& rule) {
        if (const auto at = known_.find(rule.id); at != known_.end()) return at->second;
        std::optional<bool> all = true;
        for (const rubric::Condition& need : rule.needs) {
            const std::optional<bool> one = isMet(need);
            if (one == std::optional<bool>(false)) {
                all = false;
                break;
            }
            if (!one) all.reset();
        }
        return known_[rule.id] = all;
    }

  private:
    std::optional<bool> isMet(const rubric::Condition& need) {
        if (!need.rule.empty()) {
            const auto at = std::find_if(rubric_.rules.begin(), rubric_.rules.end(),
                                         [&](const rubric::Rule& r) { return r.id == need.rule; });
            return holds(*at);
        }
        std::int64_t surely = 0, perhaps = 0;
        for (const CriterionScore& s : scores_) {
            if (s.standing == Standing::leftOut || s.standing == Standing::voided) continue;
            if (!need.of.empty() && std::find(need.of.begin(), need.of.end(), s.id) == need.of.end()) continue;
            const auto in = [&](const std::string& band) {
                return std::find(need.bands.begin(), need.bands.end(), band) != need.bands.end();
            };
            const bool asMeasured = !surely_ && s.standing == Standing::judged && !s.band.empty();
            const std::vector<std::string> bands = asMeasured ? std::vector{s.band} : s.possibleBands;
            if (!bands.empty() && std::all_of(bands.begin(), bands.end(), in)) ++surely;
            if (std::any_of(bands.begin(), bands.end(), in)) ++perhaps;
        }
        const std::int64_t least = need.least.value_or(0), most = need.most.value_or(perhaps);
        if (surely >= least && perhaps <= most) return true;
        if (perhaps < least || surely > most) return false;
        return {};
    }

    const Rubric& rubric_;
    const std::vector<CriterionScore>& scores_;
    bool surely_;
    std::map<std::string, std::optional<bool>> known_;
};

}  // namespace

std::string_view nameOf(Standing standing) {
    switch (standing) {
        case Standing::judged:
            return "judged";
        case Standing::notMeasured:
            return "not-measured";
        case Standing::leftOut:
            return "left-out";
        case Standing::voided:
            return "void";
    }
    return "";
}

std::string_view nameOf(Passed passed) {
    return passed == Passed::yes ? "yes" : passed == Passed::no ? "no" : "teacher";
}

std::string_view nameOf(RegisteredOn on) {
    return on == RegisteredOn::adjacentTeeth ? "adjacent-teeth"
           : on == RegisteredOn::earlierScan ? "earlier-scan"
                                             : "uncut-surface";
}

std::optional<RegisteredOn> registeredOnByName(std::string_view name) {
    for (const RegisteredOn on : {RegisteredOn::uncutSurface, RegisteredOn::adjacentTeeth, RegisteredOn::earlierScan})
        if (nameOf(on) == name) return on;
    return std::nullopt;
}

double Assessment::lostUndone() const {
    double sum = 0.0;
    for (const CriterionScore& c : criteria)
        if (c.points) sum += c.ownPoints - *c.points;
    return sum;
}

Assessment evaluate(const Rubric& rubric, std::span<const Measured> measured, const Context& context,
                    std::span<const std::string> given) {
    requireSound(rubric);
    Assessment a;
    a.rubric = rubric.id;
    a.rubricVersion = rubric.version;
    a.rubricHash = hashOf(rubric);
    a.context = context;
    for (const Criterion& c : rubric.criteria)
        a.criteria.push_back(judge(rubric, c, measured, context));
    // By what they are worth themselves: who has hardly begun has failed no criterion by that.
    const CriterionScore* unsure = voidExcluded(rubric, a.criteria);

    // Squares of what each measure's error does to the sum; what the error of completeness does to all of it.
    double sum = 0.0, below = 0.0, above = 0.0, undoneBelow = 0.0, undoneAbove = 0.0;
    std::vector<std::string> missing;
    if (rubric.completeness) {
        a.completeness = completenessOf(*rubric.completeness, measured);
        if (!a.completeness->value) missing.emplace_back("completeness");
    }
    const auto scale = [&](CriterionScore& s) {
        const double least = s.leastPoints, most = s.mostPoints;
        const bool isGiven = std::find(given.begin(), given.end(), s.id) != given.end();
        double ownBelow = s.ownPoints - least, ownAbove = most - s.ownPoints;
        if (a.completeness && !isGiven) {
            const Completeness& c = *a.completeness;
            s.points = c.factor * s.ownPoints;
            s.leastPoints = std::min(*s.points, c.leastFactor * least);
            s.mostPoints = std::max(*s.points, c.mostFactor * most);
            // A criterion of the same measure errs with it.
            const bool isSame = s.measure == c.measure && s.of == c.of;
            undoneBelow += *s.points - c.leastFactor * (isSame ? least : s.ownPoints);
            undoneAbove += c.mostFactor * (isSame ? most : s.ownPoints) - *s.points;
            ownBelow *= isSame ? 0.0 : c.factor;
            ownAbove *= isSame ? 0.0 : c.factor;
        }
        below += ownBelow * ownBelow;
        above += ownAbove * ownAbove;
    };
    for (std::size_t i = 0; i < a.criteria.size(); ++i) {
        CriterionScore& s = a.criteria[i];
        const Criterion& c = rubric.criteria[i];
        if (s.standing == Standing::leftOut) continue;
        // What is void may still be a critical error.
        if (s.critical != Verdict::no) a.critical.push_back({s.id, s.critical == Verdict::borderline});
        if (s.standing == Standing::voided) continue;
        a.wholeScore += s.maxPoints;
        if (s.standing == Standing::notMeasured &&
            (c.isGraded() || c.critical || (!c.bands.empty() && !rubric.rules.empty())))
            missing.push_back(s.id);
        if (!s.points) continue;
        scale(s);
        sum += *s.points;
        a.maxScore += s.maxPoints;
    }
    below += undoneBelow * undoneBelow;
    above += undoneAbove * undoneAbove;
    for (const rubric::Step& step : rubric.steps) {
        StepScore total{step.id};
        for (const CriterionScore& s : a.criteria)
            if (std::find(step.criteria.begin(), step.criteria.end(), s.id) != step.criteria.end() &&
                s.maxPoints > 0.0) {
                if (s.standing == Standing::notMeasured) total.isWhole = false;
                if (!s.points) continue;
                total.points += *s.points;
                total.maxPoints += s.maxPoints;
            }
        a.steps.push_back(std::move(total));
    }

    a.score = sum;
    a.leastScore = std::max(0.0, sum - std::sqrt(below));
    a.mostScore = std::min(a.maxScore, sum + std::sqrt(above));
    Rules rules(rubric, a.criteria, true), asMeasured(rubric, a.criteria, false);
    // Where nothing of what passes is asked for, nobody can pass or fail by it.
    bool asksForAnything = rubric.passMark && a.maxScore > 0.0;
    std::string failed, open;
    for (const rubric::Rule& rule : rubric.rules) {
        const std::optional<bool> holds = rules.holds(rule);
        a.rules.push_back({rule.id, holds});
        if (rule.elseAtMost) {
            const double cap = a.maxScore * *rule.elseAtMost / 100.0;
            if (asMeasured.holds(rule) == std::optional<bool>(false)) a.score = std::min(a.score, cap);
            if (holds == std::optional<bool>(false)) a.mostScore = std::min(a.mostScore, cap);
            if (holds != std::optional<bool>(true)) a.leastScore = std::min(a.leastScore, cap);
        }
        if (!rule.required) continue;
        asksForAnything = true;
        if (holds == std::optional<bool>(false))
            failed = fmt::format("rule \"{}\" does not hold", rule.id);
        else if (!holds)
            open = fmt::format("rule \"{}\" hangs on what is uncertain", rule.id);
    }
    if (rubric.passMark && a.maxScore > 0.0) {
        const double mark = std::min(a.maxScore, a.maxScore * *rubric.passMark / 100.0);
        const bool isAbove = a.score >= mark;
        if (isAbove ? a.leastScore < mark : a.mostScore >= mark)
            open = fmt::format("the pass mark lies within the uncertainty of the score, {:.1f} to {:.1f}", a.leastScore,
                               a.mostScore);
        else if (!isAbove)
            failed = "the score is under the pass mark";
    }
    const auto surely =
        std::find_if(a.critical.begin(), a.critical.end(), [](const CriticalError& e) { return !e.borderline; });
    if (surely != a.critical.end()) {
        a.passed = Passed::no;
        a.why = fmt::format("critical error: {}", surely->criterion);
    } else if (!missing.empty()) {
        a.passed = Passed::teacher;
        a.why = fmt::format("not measured: {}", fmt::join(missing, ", "));
    } else if (unsure) {
        a.passed = Passed::teacher;
        a.borderline = true;
        a.why = fmt::format("borderline: whether \"{}\" voids others lies within the uncertainty", unsure->id);
    } else if (!failed.empty()) {
        // What is certain stands, whatever else is not.
        a.passed = Passed::no;
        a.why = failed;
    } else if (!a.critical.empty()) {
        a.passed = Passed::teacher;
        a.borderline = true;
        a.why =
            fmt::format("borderline: a critical error, {}, lies within the uncertainty", a.critical.front().criterion);
    } else if (!open.empty()) {
        a.passed = Passed::teacher;
        a.borderline = true;
        a.why = "borderline: " + open;
    } else if (!asksForAnything) {
        a.passed = Passed::teacher;
        a.why = "the rubric does not say who passes";
    } else {
        a.passed = Passed::yes;
        a.why = "all that it asks for is met";
    }
    return a;
}

}  // namespace handpiece::score
