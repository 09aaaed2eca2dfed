// SPDX-License-Identifier: Apache-2.0
// Scores by hand, and what must hold of all: never no number, monotone, sums right, the same at any number of threads,
// and a verdict that is not borderline stands wherever the values lie within their uncertainty.
#include "handpiece/assess/score/score.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::score::score_test {
namespace {

using measures::Measured;
using rubric::Rubric;
using test::errorOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const char* kText = R"(
format = 1
id = "r"
version = "1"
status = "proposal"
pass_mark = 60
[[band]]
id = "good"
[[band]]
id = "fair"
[[band]]
id = "bad"
[[step]]
id = "first"
criteria = ["depth"]
[[step]]
id = "second"
criteria = ["width", "ridge", "time"]
[[criterion]]
id = "depth"
measure = "floor-depth"
unit = "mm"
weight = 60
knots = [[1, 0], [1.5, 100], [2, 100], [2.5, 0]]
bands = [{ id = "good", from = 1.5, to = 2 }, { id = "bad", to = 1.5 }, { id = "bad", from = 2 }]
critical = { above = 2.5 }
[[criterion]]
id = "width"
measure = "isthmus"
unit = "mm"
weight = 40
bands = [{ id = "good", from = 1, to = 1.5, points = 100 }, { id = "fair", from = 0.5, to = 1, points = 50 },
    { id = "bad", to = 0.5, points = 0 }, { id = "bad", from = 1.5, points = 0 }]
[[criterion]]
id = "ridge"
measure = "marginal-ridge-left"
side = "mesial"
unit = "mm"
critical = { below = 1 }
[[criterion]]
id = "time"
measure = "time"
unit = "s"
)";

Rubric rubricOf(const std::string& more = {}) {
    return rubric::parseRubric(kText + more, "r.toml");
}
Measured of(const char* kind, double value, double uncertainty = 0.0, const char* side = "") {
    Measured m;
    m.kind = kind;
    m.of.side = side;
    m.value = value;
    m.uncertainty = uncertainty;
    return m;
}
std::vector<Measured> all(double depth, double width, double ridge, double uncertainty = 0.0) {
    return {of("floor-depth", depth, uncertainty), of("isthmus", width, uncertainty),
            of("marginal-ridge-left", ridge, uncertainty, "mesial"), of("time", 100)};
}
const CriterionScore& at(const Assessment& a, const std::string& id) {
    return *std::find_if(a.criteria.begin(), a.criteria.end(), [&](const CriterionScore& c) { return c.id == id; });
}

TEST(Score, ByHand) {
    const Assessment a = evaluate(rubricOf(), all(1.25, 0.7, 2), {"pointer", 1});
    EXPECT_DOUBLE_EQ(*at(a, "depth").points, 30);
    EXPECT_EQ(at(a, "depth").band, "bad");
    EXPECT_DOUBLE_EQ(*at(a, "width").points, 20);
    EXPECT_EQ(at(a, "width").band, "fair");
    EXPECT_FALSE(at(a, "ridge").points);
    EXPECT_FALSE(at(a, "time").points);
    EXPECT_EQ(*at(a, "time").value, 100);
    EXPECT_DOUBLE_EQ(a.score, 50);
    EXPECT_DOUBLE_EQ(a.maxScore, 100);
    EXPECT_EQ(a.passed, Passed::no);
    EXPECT_FALSE(a.borderline);
    ASSERT_EQ(a.steps.size(), 2u);
    EXPECT_DOUBLE_EQ(a.steps[0].points, 30);
    EXPECT_DOUBLE_EQ(a.steps[1].maxPoints, 40);
    EXPECT_EQ(evaluate(rubricOf(), all(1.75, 1.2, 2), {}).passed, Passed::yes);
    EXPECT_EQ(evaluate(rubricOf(), all(1.75, 1.2, 2), {}).score, 100);
}

TEST(Score, CriticalErrorsAreNotAveragedAway) {
    Assessment a = evaluate(rubricOf(), all(1.75, 1.2, 0.8), {});
    EXPECT_EQ(a.score, 100);
    EXPECT_EQ(a.passed, Passed::no);
    ASSERT_EQ(a.critical.size(), 1u);
    EXPECT_EQ(a.critical[0].criterion, "ridge");
    EXPECT_FALSE(a.critical[0].borderline);
    // Within the uncertainty on either side of the limit: the teacher.
    for (const double ridge : {0.95, 1.05}) {
        a = evaluate(rubricOf(), all(1.75, 1.2, ridge, 0.1), {});
        EXPECT_EQ(a.passed, Passed::teacher);
        EXPECT_TRUE(a.borderline);
        ASSERT_EQ(a.critical.size(), 1u);
        EXPECT_TRUE(a.critical[0].borderline);
    }
    EXPECT_EQ(evaluate(rubricOf(), all(1.75, 1.2, 0.85, 0.1), {}).passed, Passed::no);
    EXPECT_EQ(evaluate(rubricOf(), all(1.75, 1.2, 1.15, 0.1), {}).passed, Passed::yes);
}

TEST(Score, WhatWasNotMeasuredIsNoZero) {
    std::vector<Measured> measured = all(1.75, 1.2, 2);
    measured[1].value.reset();
    measured[1].reason = "the cavity has no walls";
    Assessment a = evaluate(rubricOf(), measured, {});
    EXPECT_FALSE(at(a, "width").points);
    EXPECT_EQ(at(a, "width").standing, Standing::notMeasured);
    EXPECT_EQ(at(a, "width").reason, "the cavity has no walls");
    EXPECT_EQ(a.score, 60);
    EXPECT_EQ(a.maxScore, 60);
    EXPECT_EQ(a.wholeScore, 100);
    EXPECT_EQ(a.passed, Passed::teacher);
    EXPECT_THAT(a.why, HasSubstr("not measured: width"));
    EXPECT_FALSE(a.borderline);
    EXPECT_FALSE(a.steps[1].isWhole);
    // A critical error decides all the same.
    measured[2].value = 0.5;
    EXPECT_EQ(evaluate(rubricOf(), measured, {}).passed, Passed::no);
    // One that is only shown may be missing.
    measured = all(1.75, 1.2, 2);
    measured.pop_back();
    EXPECT_EQ(evaluate(rubricOf(), measured, {}).passed, Passed::yes);
    // What cannot be is not measured either.
    for (const double wrong : {std::nan(""), HUGE_VAL, -3.0, 1000.0}) {
        measured = all(1.75, wrong, 2);
        EXPECT_EQ(evaluate(rubricOf(), measured, {}).passed, Passed::teacher) << wrong;
        EXPECT_FALSE(evaluate(rubricOf(), measured, {}).criteria[1].value);
    }
    for (const double wrong : {std::nan(""), HUGE_VAL, -1.0}) {
        measured = all(1.75, 1.2, 2);
        measured[1].uncertainty = wrong;
        EXPECT_EQ(evaluate(rubricOf(), measured, {}).passed, Passed::teacher) << wrong;
    }
    EXPECT_EQ(evaluate(rubricOf(), {}, {}).passed, Passed::teacher);
    // Of another side it is another measure.
    measured = all(1.75, 1.2, 2);
    measured[2].of.side = "distal";
    EXPECT_EQ(at(evaluate(rubricOf(), measured, {}), "ridge").standing, Standing::notMeasured);
}

TEST(Score, ThePassMarkWithinTheUncertaintyIsTheTeachers) {
    // depth 1.25 +- 0.05 is 24 to 36 points; with width's 40 the mark of 60 lies below.
    EXPECT_EQ(evaluate(rubricOf(), all(1.25, 1.2, 2, 0.05), {}).passed, Passed::yes);
    const Assessment a = evaluate(rubricOf(), all(1.2, 1.2, 2, 0.05), {});
    EXPECT_DOUBLE_EQ(a.score, 64);
    EXPECT_DOUBLE_EQ(a.leastScore, 58);
    EXPECT_DOUBLE_EQ(a.mostScore, 70);
    EXPECT_EQ(a.passed, Passed::teacher);
    EXPECT_TRUE(a.borderline);
    // Errors of two measures are taken as independent: width within its cliff, depth on its slope.
    const Assessment both = evaluate(rubricOf(), all(1.25, 1.02, 2, 0.05), {});
    EXPECT_NEAR(both.leastScore, 70 - std::sqrt(6 * 6 + 20 * 20), 1e-9);
    EXPECT_THAT(at(both, "width").possibleBands, ElementsAre("good", "fair"));
    EXPECT_TRUE(at(both, "width").borderline);
    EXPECT_FALSE(at(evaluate(rubricOf(), all(1.25, 1.2, 2, 0.05), {}), "width").borderline);
}

TEST(Score, DevicesThatACriterionIsNotForLeaveItOut) {
    const std::string only =
        "[[criterion]]\nid = \"strokes\"\nmeasure = \"strokes\"\nweight = 100\nknots = [[10, 100], [50, 0]]\ndevices = "
        "[\"openhaptics\"]\n";
    std::vector<Measured> measured = all(1.75, 1.2, 2);
    measured.push_back(of("strokes", 50));
    const Assessment mouse = evaluate(rubricOf(only), measured, {"pointer", 1}),
                     arm = evaluate(rubricOf(only), measured, {"openhaptics", 1});
    EXPECT_EQ(mouse.maxScore, 100);
    EXPECT_EQ(mouse.wholeScore, 100);
    EXPECT_EQ(at(mouse, "strokes").standing, Standing::leftOut);
    EXPECT_THAT(at(mouse, "strokes").reason, HasSubstr("pointer"));
    EXPECT_EQ(mouse.passed, Passed::yes);
    EXPECT_EQ(arm.maxScore, 200);
    EXPECT_EQ(arm.passed, Passed::no);
}

TEST(Score, AFailedCriterionVoidsWhatItExcludes) {
    const std::string more =
        "[[criterion]]\nid = \"undercut\"\nmeasure = \"undercut-depth\"\nunit = \"mm\"\ncritical = { above = 0.1 "
        "}\nexcludes = [\"width\"]\n";
    std::vector<Measured> measured = all(1.75, 1.2, 2);
    measured.push_back(of("undercut-depth", 0.3));
    Assessment a = evaluate(rubricOf(more), measured, {});
    EXPECT_EQ(at(a, "width").standing, Standing::voided);
    EXPECT_THAT(at(a, "width").reason, HasSubstr("undercut"));
    EXPECT_EQ(a.maxScore, 60);
    EXPECT_EQ(a.passed, Passed::no);
    measured.back() = of("undercut-depth", 0.05);
    a = evaluate(rubricOf(more), measured, {});
    EXPECT_EQ(a.maxScore, 100);
    EXPECT_EQ(a.passed, Passed::yes);
    measured.back() = of("undercut-depth", 0.08, 0.05);
    EXPECT_EQ(evaluate(rubricOf(more), measured, {}).passed, Passed::teacher);
    // A critical error of what is void stands.
    const std::string ridge =
        "[[criterion]]\nid = \"u\"\nmeasure = \"undercut-depth\"\nunit = \"mm\"\ncritical = { above = 0.1 }\nexcludes "
        "= [\"ridge\"]\n";
    measured = all(1.75, 1.2, 0.5);
    measured.push_back(of("undercut-depth", 0.3));
    EXPECT_EQ(evaluate(rubricOf(ridge), measured, {}).critical.size(), 2u);
}

TEST(Score, RulesOverBands) {
    const std::string required =
        "[[rule]]\nid = \"x\"\nneeds = [{ bands = [\"bad\"], most = 0 }, { bands = [\"fair\"], most = 0 }]\nrequired = "
        "true\n";
    EXPECT_EQ(evaluate(rubricOf(required), all(1.75, 1.2, 2), {}).passed, Passed::yes);
    EXPECT_EQ(evaluate(rubricOf(required), all(1.75, 0.7, 2), {}).passed, Passed::no) << "80 points, and one is fair";
    EXPECT_EQ(evaluate(rubricOf(required), all(1.75, 0.99, 2, 0.05), {}).passed, Passed::teacher);
    EXPECT_TRUE(evaluate(rubricOf(required), all(1.75, 0.99, 2, 0.05), {}).borderline);
    const std::string cap =
        "[[rule]]\nid = \"base\"\nneeds = [{ bands = [\"fair\", \"bad\"], of = [\"width\"], most = 0 }]\n"
        "[[rule]]\nid = \"x\"\nneeds = [{ rule = \"base\" }]\nelse_at_most = 62\n";
    Assessment a = evaluate(rubricOf(cap), all(1.75, 0.7, 2), {});
    EXPECT_DOUBLE_EQ(a.score, 62);
    EXPECT_EQ(a.rules[0].holds, false);
    EXPECT_EQ(a.rules[1].holds, false);
    EXPECT_DOUBLE_EQ(evaluate(rubricOf(cap), all(1.75, 1.2, 2), {}).score, 100);
    a = evaluate(rubricOf(cap), all(1.75, 1.02, 2, 0.05), {});
    EXPECT_DOUBLE_EQ(a.score, 100) << "as measured";
    EXPECT_DOUBLE_EQ(a.leastScore, 62);
    EXPECT_FALSE(a.rules[1].holds);
    // An unmeasured criterion leaves a rule open, but only where it could matter.
    std::vector<Measured> measured = all(1.75, 1.2, 2);
    measured[1].value.reset();
    EXPECT_FALSE(evaluate(rubricOf(required), measured, {}).rules[0].holds);
    measured[0].value = 1.2;
    EXPECT_EQ(evaluate(rubricOf(required), measured, {}).rules[0].holds, false);
}

TEST(Score, ARubricThatSaysNothingOfPassingLeavesItToTheTeacher) {
    std::string text = kText;
    text.erase(text.find("pass_mark"), 14);
    const Assessment a = evaluate(rubric::parseRubric(text, "r.toml"), all(1.75, 1.2, 2), {});
    EXPECT_EQ(a.passed, Passed::teacher);
    EXPECT_FALSE(a.borderline);
    EXPECT_THAT(errorOf([&] { (void)evaluate(rubricOf("[[criterion]]\nid = \"x\"\nmeasure = \"nix\"\n"), {}, {}); }),
                HasSubstr("no measure \"nix\""));
}

const char* kUndone = R"([completeness]
measure = "removed-share"
zone = "target"
unit = "%"
knots = [[0, 0], [50, 0.5], [70, 1]]
)";
Measured done(double share, double uncertainty = 0.0) {
    Measured m = of("removed-share", share, uncertainty);
    m.of.zone = "target";
    return m;
}
std::vector<Measured> with(std::vector<Measured> measured, Measured one) {
    measured.push_back(std::move(one));
    return measured;
}

TEST(Completeness, MultipliesAllPointsWithoutACliff) {
    const Rubric rubric = rubricOf(kUndone);
    const std::vector<Measured> good = all(1.75, 1.2, 2), half = all(1.25, 1.2, 2);
    for (const auto& [share, factor] :
         {std::pair{0.0, 0.0}, {10.0, 0.1}, {50.0, 0.5}, {60.0, 0.75}, {70.0, 1.0}, {98.4, 1.0}}) {
        const Assessment a = evaluate(rubric, with(good, done(share)), {});
        EXPECT_NEAR(a.score, 100 * factor, 1e-9) << share;
        EXPECT_EQ(a.maxScore, 100);
        EXPECT_NEAR(a.lostUndone(), 100 - 100 * factor, 1e-9);
        EXPECT_NEAR(a.completeness->factor, factor, 1e-12);
        EXPECT_EQ(a.passed, 100 * factor < 60 ? Passed::no : Passed::yes) << share;
        // What each criterion lost of its own is told apart.
        EXPECT_NEAR(*at(a, "depth").points, 60 * factor, 1e-9);
        EXPECT_EQ(at(a, "depth").ownPoints, 60);
        EXPECT_EQ(at(a, "depth").band, "good");
        const Assessment b = evaluate(rubric, with(half, done(share)), {});
        EXPECT_NEAR(b.score, 70 * factor, 1e-9);
        EXPECT_NEAR(b.steps[0].points, 30 * factor, 1e-9);
    }
    EXPECT_EQ(evaluate(rubric, with(good, done(70)), {}).score, 100) << "full points to the bit";
    const Assessment begun = evaluate(rubric, with(all(2.6, 1.2, 2), done(5)), {});
    EXPECT_EQ(begun.critical.size(), 1u) << "a critical error stands, however little is done";
}

TEST(Completeness, ItsErrorMovesAllPointsTogether) {
    const Rubric rubric = rubricOf(kUndone);
    // 10 +- 2 %: the factor is 0.1 +- 0.02, of 100 points.
    Assessment a = evaluate(rubric, with(all(1.75, 1.2, 2), done(10, 2)), {});
    EXPECT_NEAR(a.leastScore, 8, 1e-9);
    EXPECT_NEAR(a.mostScore, 12, 1e-9);
    EXPECT_NEAR(at(a, "depth").leastPoints, 0.08 * 60, 1e-9);
    // Depth alone errs by 12 of its 60 points, which count a half; independent of how much is done.
    a = evaluate(rubric, with(all(1.25, 1.2, 2, 0.1), done(50, 4)), {});
    EXPECT_NEAR(a.score, 35, 1e-9);
    EXPECT_NEAR(a.leastScore, 35 - std::hypot(0.5 * 12, 0.04 * 70), 1e-9);
    EXPECT_NEAR(a.mostScore, 35 + std::hypot(0.5 * 12, 0.1 * 70), 1e-9);
    // The mark of 60 lies within that of the completeness.
    a = evaluate(rubric, with(all(1.75, 1.2, 2), done(54, 2)), {});
    EXPECT_EQ(a.passed, Passed::teacher);
    EXPECT_TRUE(a.borderline);
    // A criterion of the same measure errs with it, not beside it: 1 % of share is 1 % of its points and of the factor.
    const Rubric same = rubricOf(std::string(kUndone) + R"([[criterion]]
id = "target"
measure = "removed-share"
zone = "target"
unit = "%"
weight = 100
knots = [[0, 0], [100, 100]]
)");
    a = evaluate(same, with(all(1.75, 1.2, 2), done(40, 1)), {});
    EXPECT_NEAR(a.score, 0.4 * 140, 1e-9);
    EXPECT_NEAR(a.leastScore, 0.39 * 139, 1e-9);
    EXPECT_NEAR(a.mostScore, 0.41 * 141, 1e-9);
}

TEST(Completeness, NotMeasuredTakesNothingOffAndLetsNobodyPass) {
    const Rubric rubric = rubricOf(kUndone);
    for (const bool isTold : {false, true}) {
        Measured none = done(0);
        none.value.reset();
        none.reason = "the task has no zone \"target\"";
        const std::vector<Measured> good = all(1.75, 1.2, 2);
        const Assessment a = evaluate(rubric, isTold ? with(good, none) : good, {});
        EXPECT_EQ(a.score, 100);
        EXPECT_EQ(a.passed, Passed::teacher);
        EXPECT_FALSE(a.borderline);
        EXPECT_THAT(a.why, HasSubstr("completeness"));
        EXPECT_THAT(a.completeness->reason, HasSubstr(isTold ? "no zone" : "not measured"));
    }
    EXPECT_FALSE(evaluate(rubricOf(), all(1.75, 1.2, 2), {}).completeness);
}

TEST(Completeness, VoidsNothingAndLeavesPointsThatWereGiven) {
    std::string text = std::string(kText) + kUndone;
    text.replace(text.find("weight = 60"), 11, "weight = 60\nexcludes = [\"width\"]");
    const Rubric rubric = rubric::parseRubric(text, "r.toml");
    const Assessment nothing = evaluate(rubric, with(all(1.75, 1.2, 2), done(0)), {});
    EXPECT_EQ(at(nothing, "width").standing, Standing::judged) << "depth itself did not fail";
    EXPECT_EQ(nothing.score, 0);
    const std::string given[] = {"width"};
    const Assessment a = evaluate(rubric, with(all(1.75, 1.2, 2), done(10)), {}, given);
    EXPECT_EQ(*at(a, "width").points, 40);
    EXPECT_NEAR(a.score, 46, 1e-9);
    EXPECT_NEAR(a.lostUndone(), 54, 1e-9);
}

// ---- 10,000 random rubrics and works

struct Random {
    explicit Random(std::uint64_t seed) : generator(seed) {}
    std::mt19937_64 generator;
    double in(double low, double high) { return test::uniform(generator, low, high); }
    std::size_t upTo(std::size_t n) { return generator() % (n + 1); }
    bool chance(double p) { return in(0, 1) < p; }
};

/// Rises to 100 and falls, at n values; where a peak is.
std::vector<double> peaked(Random& random, std::size_t n) {
    std::vector<double> points(n);
    const std::size_t peak = random.upTo(n - 1);
    for (std::size_t i = 0; i < n; ++i)
        points[i] = std::floor(random.in(0, 100));
    std::sort(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(peak));
    std::sort(points.begin() + static_cast<std::ptrdiff_t>(peak), points.end(), std::greater<>());
    points[peak] = 100;
    return points;
}

const char* const kKinds[] = {"floor-depth",       "isthmus",     "wall-height",    "reduction",
                              "remaining-dentine", "axial-depth", "adjacent-depth", "gouge-depth"};

Rubric randomRubric(Random& random) {
    Rubric r;
    r.id = r.version = "x";
    r.where = "random";
    for (const char* id : {"a", "b", "c", "d"})
        r.bands.push_back({id, {}});
    if (random.chance(0.8)) r.passMark = std::floor(random.in(1, 100));
    const std::size_t count = 1 + random.upTo(7);
    for (std::size_t i = 0; i < count; ++i) {
        rubric::Criterion c;
        c.id = fmt::format("c{}", i);
        c.measure = kKinds[i];
        c.unit = "mm";
        const bool isGraded = random.chance(0.85);
        if (isGraded) c.weight = random.chance(0.5) ? std::floor(random.in(1, 30)) : random.in(0.01, 30);
        std::vector<double> cuts;
        for (std::size_t n = 1 + random.upTo(5); n > 0; --n)
            cuts.push_back(random.in(0.1, 19.9));
        std::sort(cuts.begin(), cuts.end());
        const bool hasKnots = isGraded && random.chance(0.5);
        if (hasKnots) {
            cuts.insert(cuts.begin(), random.in(0, 0.1));
            const std::vector<double> points = peaked(random, cuts.size());
            for (std::size_t k = 0; k < cuts.size(); ++k)
                c.knots.push_back({cuts[k], points[k]});
        }
        if (!hasKnots || random.chance(0.7)) {
            const std::vector<double> points = peaked(random, cuts.size() + 1);
            for (std::size_t k = 0; k <= cuts.size(); ++k) {
                rubric::Band band;
                band.id = r.bands[random.upTo(3)].id;
                if (k > 0) band.from = cuts[k - 1];
                if (k < cuts.size()) band.to = cuts[k];
                if (isGraded && !hasKnots) band.points = points[k];
                c.bands.push_back(band);
            }
            std::shuffle(c.bands.begin(), c.bands.end(), random.generator);
        }
        if (random.chance(0.3)) {
            c.critical.emplace();
            if (random.chance(0.6)) c.critical->above = random.in(10, 19.9);
            if (!c.critical->above || random.chance(0.3)) c.critical->below = random.in(0.1, 8);
        }
        if (random.chance(0.1)) c.devices = {"arm"};
        if (i > 0 && random.chance(0.1) && (isGraded || c.critical))
            c.excludes = {fmt::format("c{}", random.upTo(i - 1))};
        r.criteria.push_back(std::move(c));
    }
    for (std::size_t i = 0; i < random.upTo(2); ++i) {
        rubric::Rule rule;
        rule.id = fmt::format("r{}", i);
        rubric::Condition need;
        need.bands = {r.bands[random.upTo(3)].id};
        need.most = static_cast<std::int64_t>(random.upTo(3));
        rule.needs.push_back(need);
        if (i > 0 && random.chance(0.5)) {
            rubric::Condition other;
            other.rule = "r0";
            rule.needs.push_back(other);
        }
        rule.required = random.chance(0.5);
        if (!rule.required || random.chance(0.3)) rule.elseAtMost = std::floor(random.in(0, 99));
        r.rules.push_back(std::move(rule));
    }
    if (random.chance(0.5)) {
        rubric::Completeness& c = r.completeness.emplace();
        c.measure = kKinds[random.upTo(std::size(kKinds) - 1)];
        c.unit = "mm";
        std::vector<double> values, factors;
        for (std::size_t n = 2 + random.upTo(3); n > 0; --n) {
            values.push_back(random.in(0, 20));
            factors.push_back(random.in(0, 1));
        }
        std::sort(values.begin(), values.end());
        std::sort(factors.begin(), factors.end());
        if (random.chance(0.7)) factors.front() = 0;
        factors.back() = 1;
        for (std::size_t i = 0; i < values.size(); ++i)
            c.knots.push_back({values[i], factors[i]});
    }
    return r;
}

std::vector<Measured> randomWork(Random& random, const Rubric& rubric) {
    std::vector<Measured> measured;
    for (const rubric::Criterion& c : rubric.criteria) {
        Measured m = of(c.measure.c_str(), random.in(0, 20), random.chance(0.3) ? 0.0 : random.in(0, 0.5));
        if (random.chance(0.3) && !c.bands.empty()) m.value = c.bands.front().from.value_or(20.0);
        if (random.chance(0.3) && !c.knots.empty()) m.value = c.knots[random.upTo(c.knots.size() - 1)].value;
        if (random.chance(0.03)) m.value.reset();
        if (random.chance(0.01)) m.value = std::nan("");
        if (random.chance(0.02)) continue;
        measured.push_back(std::move(m));
    }
    if (rubric.completeness && random.chance(0.97) &&
        std::none_of(rubric.criteria.begin(), rubric.criteria.end(),
                     [&](const rubric::Criterion& c) { return c.measure == rubric.completeness->measure; }))
        measured.push_back(of(rubric.completeness->measure.c_str(), random.in(0, 20), random.in(0, 0.5)));
    return measured;
}

std::uint64_t bitsOf(const Assessment& a) {
    core::Hasher hasher;
    for (const double v : {a.score, a.maxScore, a.wholeScore, a.leastScore, a.mostScore})
        hasher.add(v);
    hasher.add(a.passed);
    hasher.add(a.borderline);
    hasher.add(a.why);
    for (const CriterionScore& c : a.criteria) {
        hasher.add(c.points.value_or(-1));
        hasher.add(c.leastPoints);
        hasher.add(c.mostPoints);
        hasher.add(c.band);
        hasher.add(c.critical);
        hasher.add(c.standing);
    }
    return hasher.value();
}

/// What must hold of any; the first that does not, or nothing.
std::string wrongWith(const Rubric& rubric, const std::vector<Measured>& measured, const Assessment& a,
                      Random& random) {
    double sum = 0, most = 0;
    for (const CriterionScore& c : a.criteria) {
        for (const double v :
             {c.points.value_or(0), c.leastPoints, c.mostPoints, c.maxPoints, c.value.value_or(0), c.uncertainty})
            if (!std::isfinite(v)) return c.id + " is no number";
        if (!c.points) continue;
        if (*c.points < 0 || *c.points > c.maxPoints || c.leastPoints > *c.points || c.mostPoints < *c.points)
            return c.id + " has points out of range";
        if (*c.points != (a.completeness ? a.completeness->factor : 1.0) * c.ownPoints)
            return c.id + " is not its own points times the factor";
        sum += *c.points;
        most += c.maxPoints;
    }
    if (a.completeness) {
        const Completeness& c = *a.completeness;
        if (!(c.leastFactor >= 0 && c.leastFactor <= c.factor && c.factor <= c.mostFactor && c.mostFactor <= 1))
            return "the factor lies outside of its range";
        if (!c.value && (c.factor != 1 || a.passed == Passed::yes)) return "what is not known counts as done";
    }
    for (const double v : {a.score, a.maxScore, a.wholeScore, a.leastScore, a.mostScore, a.percent()})
        if (!std::isfinite(v)) return "the score is no number";
    double expected = sum;
    for (std::size_t i = 0; i < rubric.rules.size(); ++i)
        if (rubric.rules[i].elseAtMost && a.rules[i].holds == std::optional<bool>(false))
            expected = std::min(expected, most * *rubric.rules[i].elseAtMost / 100);
    if (a.maxScore != most) return "the greatest score is no sum";
    if (a.score > sum || (a.score != expected &&
                          std::none_of(a.rules.begin(), a.rules.end(), [](const RuleResult& r) { return !r.holds; })))
        return "the score is no sum";
    if (a.leastScore > a.score || a.mostScore < a.score) return "the score lies outside of its range";
    // Monotone: from any value to one nearer to the ideal, no fewer points.
    for (const rubric::Criterion& c : rubric.criteria) {
        if (!c.isGraded()) continue;
        const double x = random.in(0, 20), y = random.in(0, 20), z = random.in(0, 20);
        double v[] = {x, y, z};
        std::sort(v, v + 3);
        if (*pointsOf(c, v[1]) < std::min(*pointsOf(c, v[0]), *pointsOf(c, v[2]))) return c.id + " is not monotone";
    }
    // Who has done more has no less, where no criterion is of the same measure.
    if (a.completeness && a.completeness->value &&
        std::none_of(a.criteria.begin(), a.criteria.end(),
                     [&](const CriterionScore& c) { return c.measure == a.completeness->measure; })) {
        std::vector<Measured> moved = measured;
        moved.back().value = random.in(*moved.back().value, 20);
        if (evaluate(rubric, moved, a.context).score < a.score) return "more done has less";
    }
    // Wherever one value lies within its uncertainty, a verdict that is not the teacher's stands.
    if (a.passed != Passed::teacher)
        for (int trial = 0; trial < 4 && !measured.empty(); ++trial) {
            std::vector<Measured> moved = measured;
            for (Measured& m : moved)
                m.uncertainty = 0;
            const std::size_t which = random.upTo(measured.size() - 1);
            if (!measured[which].value) continue;
            const double side = trial == 0 ? -1.0 : trial == 1 ? 1.0 : random.in(-1, 1);
            moved[which].value = std::clamp(*measured[which].value + side * measured[which].uncertainty, 0.0, 20.0);
            const Assessment other = evaluate(rubric, moved, a.context);
            if (other.passed != a.passed)
                return fmt::format("{} turned {} by {} at {} +- {}: {} / {}", nameOf(a.passed), nameOf(other.passed),
                                   measured[which].kind, *measured[which].value, measured[which].uncertainty, a.why,
                                   other.why);
        }
    return {};
}

TEST(Score, TenThousandRandomRubricsAndWorks) {
    constexpr std::size_t kCount = 10000;
    const std::uint64_t seed = test::seed();
    std::vector<Rubric> rubrics;
    std::vector<std::vector<Measured>> works;
    std::size_t discarded = 0;
    for (std::uint64_t i = 0; rubrics.size() < kCount; ++i) {
        Random random(seed + i);
        Rubric r = randomRubric(random);
        const auto findings = check(r);
        if (std::any_of(findings.begin(), findings.end(),
                        [](const rubric::Finding& f) { return f.severity == rubric::Severity::error; })) {
            ++discarded;
            continue;
        }
        works.push_back(randomWork(random, r));
        rubrics.push_back(std::move(r));
    }
    EXPECT_LT(discarded, kCount) << "most of them make sense";
    std::vector<Assessment> results[2] = {std::vector<Assessment>(kCount), std::vector<Assessment>(kCount)};
    for (const std::size_t threads : {1u, 2u}) {
        core::setThreadCount(threads);
        core::parallelFor(kCount, 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                results[threads - 1][i] = evaluate(rubrics[i], works[i], {"pointer", 1});
        });
    }
    core::setThreadCount(0);
    std::size_t counts[3] = {}, borderline = 0;
    for (std::size_t i = 0; i < kCount; ++i) {
        ASSERT_EQ(bitsOf(results[0][i]), bitsOf(results[1][i]));
        Random random(seed ^ i);
        ASSERT_EQ(wrongWith(rubrics[i], works[i], results[0][i], random), "") << i << "\n" << canonicalText(rubrics[i]);
        ++counts[static_cast<int>(results[0][i].passed)];
        borderline += results[0][i].borderline ? 1 : 0;
    }
    // All verdicts come about, or the above says little.
    for (const std::size_t count : counts)
        EXPECT_GT(count, kCount / 50);
    EXPECT_GT(borderline, kCount / 50);
}

TEST(Attempts, MeanSpreadAndCurve) {
    std::vector<Assessment> made;
    for (const double depth : {1.1, 1.2, 1.3, 1.4, 1.5})
        made.push_back(evaluate(rubricOf(), all(depth, 1.2, 2), {"pointer", 1}));
    // 52, 64, 76, 88, 100 %.
    const Attempts a = attempts(made);
    EXPECT_EQ(a.count, 5u);
    EXPECT_NEAR(a.mean, 76, 1e-9);
    EXPECT_NEAR(*a.spread, std::sqrt(360.0), 1e-9);
    EXPECT_NEAR(a.least, 52, 1e-9);
    EXPECT_NEAR(a.greatest, 100, 1e-9);
    EXPECT_NEAR(*a.change, 94 - 58, 1e-9);
    EXPECT_NEAR(a.curve[1].mean, 58, 1e-9);
    const Attempts one = attempts(std::span(made).first(1));
    EXPECT_FALSE(one.spread);
    EXPECT_FALSE(one.change);
    made[2].context.motionScale = 2;
    EXPECT_THAT(errorOf([&] { (void)attempts(made); }), testing::AllOf(HasSubstr("attempt 3"), HasSubstr("scale 2")));
    made[2] = evaluate(rubricOf("[[criterion]]\nid = \"x\"\nmeasure = \"views\"\n"), all(1.3, 1.2, 2), {"pointer", 1});
    EXPECT_THAT(errorOf([&] { (void)attempts(made); }), HasSubstr("another rubric"));
    made[2] = evaluate(rubricOf(), std::vector<Measured>{of("floor-depth", 1.3)}, {"pointer", 1});
    EXPECT_THAT(errorOf([&] { (void)attempts(made); }), HasSubstr("not all"));
    EXPECT_NE(errorOf([] { (void)attempts({}); }), "");
}

}  // namespace
}  // namespace handpiece::score::score_test
