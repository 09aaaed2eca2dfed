// SPDX-License-Identifier: Apache-2.0
// Hands whose measures are known: circles, reaches as smooth as can be, loads in steps.
#include "handpiece/assess/hand/hand.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "handpiece/assess/hand/smoothness.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/instrument/shapes.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::hand::hand_test {
namespace {

using core::Vec3;
using measures::Measured;
using measures::Request;
using testing::HasSubstr;

/// Uneven, and the same in the script that gave the numbers below.
std::vector<double> profile(int n, int half) {
    std::vector<double> v;
    for (int i = 0; i < n; ++i) {
        const double s = static_cast<double>(i) / n;
        v.push_back(s * s * (1 - s) * (1 - s) * (1 + 0.5 * ((i * 7919) % 101) / 101.0) +
                    ((i / half) % 2 != 0 ? 0.03 : 0));
    }
    return v;
}

// From the definition in twenty lines of Python: a plain discrete Fourier transform by cmath, nothing of this program.
TEST(SpectralArcLength, IsThatOfTheDefinition) {
    EXPECT_NEAR(*spectralArcLength(profile(150, 20), 100.0), -2.097249134550361, 1e-12);
    EXPECT_NEAR(*spectralArcLength(profile(128, 20), 100.0), -2.076812867129792, 1e-12);
    EXPECT_NEAR(*spectralArcLength(profile(317, 20), 60.0), -2.3941556398028663, 1e-12);
    EXPECT_NEAR(*spectralArcLength(profile(1000, 20), 100.0), -2.931112823363103, 1e-12);
    // What is faster than the cut-off counts where that lies higher.
    EXPECT_NEAR(*spectralArcLength(profile(150, 4), 100.0), -1.3994335523979822, 1e-12);
    EXPECT_NEAR(*spectralArcLength(profile(150, 4), 100.0, {20.0}), -2.245779163340128, 1e-12);
}

/// Of the speed 30 s^2 (1 - s)^2, by the integral: 15 ((3 - x^2) sin x - 3 x cos x) / x^5 with x = pi f T. The length
/// up to where it last has `threshold`.
double minimumJerkArc(double threshold = 0.05) {
    const auto at = [](double x) {
        return x < 0.05 ? 1.0 - x * x / 14.0
                        : std::abs(15.0 * ((3.0 - x * x) * std::sin(x) - 3.0 * x * std::cos(x)) / std::pow(x, 5));
    };
    const double step = 1e-4;
    double end = 0.0;
    for (double x = 0.0; x < 40.0; x += step)
        if (at(x) >= threshold) end = x;
    double length = 0.0;
    for (double x = 0.0; x < end; x += step)
        length += std::hypot(step / end, at(x + step) - at(x));
    return -length;
}

double minimumJerk(double s) {
    s = std::clamp(s, 0.0, 1.0);
    return s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
}

TEST(SpectralArcLength, OfTheSmoothestReachIsItsClosedForm) {
    EXPECT_NEAR(minimumJerkArc(), -1.41, 0.005);  // as published
    for (const double lasts : {0.8, 1.5, 4.0, 9.0}) {
        std::vector<double> speed;
        for (double t = 0.0; t <= lasts; t += 0.01) {
            const double s = t / lasts;
            speed.push_back(30.0 * s * s * (1 - s) * (1 - s));
        }
        // Where the spectrum falls below the threshold is known to within one of its steps.
        EXPECT_NEAR(*spectralArcLength(speed, 100.0), minimumJerkArc(), 0.015) << lasts;
        EXPECT_NEAR(*spectralArcLength(speed, 100.0, {10.0, 0.05, 8}), minimumJerkArc(), 0.001) << lasts;
        const double before = *spectralArcLength(speed, 100.0);
        for (double& v : speed)
            v *= 1024;
        EXPECT_DOUBLE_EQ(*spectralArcLength(speed, 100.0), before) << "free of its unit";
    }
}

TEST(SpectralArcLength, IsNoneWhereThereIsNoMovement) {
    EXPECT_FALSE(spectralArcLength({}, 100.0));
    EXPECT_FALSE(spectralArcLength(std::vector<double>(100, 0.0), 100.0));
    EXPECT_FALSE(spectralArcLength(std::vector<double>{1, 2, std::nan(""), 1, 1}, 100.0));
    EXPECT_FALSE(spectralArcLength(std::vector<double>(100, 1.0), 0.0));
}

/// Measures of a hand that does `at` at each tick.
std::vector<Measured> taken(const std::vector<Request>& requests, double lastsS,
                            const std::function<Sample(double)>& at, double rateHz = 1000.0,
                            const Against& against = {}) {
    HandMeasures hand(requests, against);
    const auto ticks = static_cast<int>(std::lround(lastsS * rateHz));
    for (int i = 0; i < ticks; ++i) {
        Sample s = at(i / rateHz);
        s.timeS = i / rateHz;
        s.lastsS = 1.0 / rateHz;
        hand.take(s);
    }
    return hand.measured();
}
Measured one(const std::string& kind, double lastsS, const std::function<Sample(double)>& at,
             const measures::Selection& of = {}, double rateHz = 1000.0, const Against& against = {}) {
    return taken({{kind, of}}, lastsS, at, rateHz, against).front();
}
measures::Selection statistic(const char* name) {
    measures::Selection of;
    of.statistic = name;
    return of;
}
measures::Selection limit(double value) {
    measures::Selection of;
    of.limit = value;
    return of;
}
Sample cutting(double forceN = 1.0) {
    Sample s;
    s.isPedalDown = s.isCutting = true;
    s.depthMm = 0.1;
    s.forceN = forceN;
    s.speedRpm = 200000;
    s.tissue = cases::Tissue::enamel;
    return s;
}
double stepped(double value, double step) {
    return step > 0.0 ? std::round(value / step) * step : value;
}

TEST(Hand, GoesRoundACircleOfAKnownLength) {
    for (const double radius : {0.5, 2.0, 10.0})
        for (const double turnsPerS : {0.2, 0.5, 1.0})
            for (const double encoder : {0.0, 0.01, 0.055}) {
                const auto round = [&](double t) {
                    Sample s = cutting();
                    const double a = 2 * std::numbers::pi * turnsPerS * t;
                    s.burInTooth.positionMm = {stepped(radius * std::cos(a), encoder),
                                               stepped(radius * std::sin(a), encoder), 3};
                    return s;
                };
                const Measured path = one("path-length", 10.0, round);
                const double truth = 2 * std::numbers::pi * radius * turnsPerS * 10.0;
                EXPECT_NEAR(*path.value, truth, path.uncertainty)
                    << radius << " mm, " << turnsPerS << "/s, " << encoder;
                EXPECT_LT(path.uncertainty, 0.04 * truth + 0.5);
            }
}

TEST(Hand, StandsStillOnAnEncodersSteps) {
    // Noise of a step to or fro at each tick: 27 mm a second, if one added them up.
    std::mt19937_64 generator(test::seed());
    const Measured path = one("path-length", 10.0, [&](double) {
        Sample s = cutting();
        s.burInTooth.positionMm = {test::uniform(generator, 0, 1) < 0.5 ? 0.0 : 0.055, 0, 0};
        return s;
    });
    EXPECT_NEAR(*path.value, 0.0, path.uncertainty);
    EXPECT_LT(path.uncertainty, 0.5);
}

TEST(Hand, ReachesAsSmoothAsCanBe) {
    std::mt19937_64 generator(test::seed());
    for (const double lasts : {1.2, 2.0, 6.0})
        for (const double noise : {0.0, 0.02}) {
            const auto reach = [&](double t) {
                Sample s = cutting();
                s.burInTooth.positionMm = {6.0 * minimumJerk(t / lasts) + test::uniform(generator, -noise, noise), 0,
                                           0};
                return s;
            };
            const Measured smooth = one("smoothness", lasts, reach);
            EXPECT_NEAR(*smooth.value, minimumJerkArc(), smooth.uncertainty) << lasts << " s, noise " << noise;
            ASSERT_EQ(smooth.evidence.size(), 1u);
            EXPECT_NEAR(*smooth.evidence[0].timeS, 0.0, 0.03);
        }
    // Two strokes, the second with a tremor of 6 Hz.
    const auto two = [](double t) {
        Sample s = cutting();
        s.isPedalDown = t < 2.0 || t >= 2.5;
        const double along = t < 2.25 ? minimumJerk(t / 2.0) : 1 - minimumJerk((t - 2.5) / 2.0);
        const double tremor = t > 2.5 ? 0.1 * std::sin(2 * std::numbers::pi * 6 * t) : 0.0;
        s.burInTooth.positionMm = {6.0 * along, tremor, 0};
        return s;
    };
    const Measured smooth = one("smoothness", 4.5, two);
    EXPECT_LT(*smooth.value, minimumJerkArc() - 0.1);
    EXPECT_NEAR(*smooth.evidence[0].timeS, 2.5, 0.03);
    EXPECT_EQ(*one("strokes", 4.5, two).value, 2.0);
    EXPECT_THAT(one("smoothness", 0.5, two).reason, HasSubstr("no stroke"));
    EXPECT_THAT(one("smoothness", 5.0, [](double) { return cutting(); }).reason, HasSubstr("no stroke"));
}

TEST(Hand, LoadsInASquareWave) {
    // 0.5 N and 2 N, each for a quarter and three quarters of a second.
    const auto wave = [](double t) { return cutting(t - std::floor(t) < 0.25 - 1e-9 ? 0.5 : 2.0); };
    const auto is = [&](const char* kind, const measures::Selection& of, double truth) {
        const Measured m = one(kind, 8.0, wave, of);
        ASSERT_TRUE(m.value) << kind << ": " << m.reason;
        EXPECT_NEAR(*m.value, truth, m.uncertainty) << kind << " " << of.statistic;
    };
    is("force", statistic("mean"), 1.625);
    is("force", {}, 2.0);
    is("force", statistic("p5"), 0.5);
    is("force", statistic("p95"), 2.0);
    is("force", statistic("least"), 0.5);
    is("force", statistic("greatest"), 2.0);
    is("load-over-limit", limit(1.0), 6.0);
    is("load-over-limit", limit(0.25), 8.0);
    is("load-over-limit", limit(2.5), 0.0);
    is("load-over-limit-share", limit(1.0), 75.0);
    const Measured over = one("load-over-limit", 8.0, wave, limit(1.0));
    EXPECT_NEAR(*over.evidence.at(0).timeS, 0.25, 0.0015);
    EXPECT_DOUBLE_EQ(*over.evidence.at(1).forceN, 2.0);
    // A limit that the load has: it is not sure of it.
    EXPECT_GT(one("load-over-limit", 8.0, wave, limit(2.0)).uncertainty, 5.0);
    EXPECT_THAT(one("load-over-limit", 8.0, wave).reason, HasSubstr("limit"));
}

TEST(Hand, TellsWhatItDidWhen) {
    // A second each: waits; cuts enamel; pedal down in the air; presses on the pulp; on the tooth beside; on gingiva.
    const auto day = [](double t) {
        Sample s;
        if (t >= 1) s = cutting();
        if (t >= 2) s.isCutting = false, s.depthMm = -1, s.forceN = 0;
        if (t >= 3) s = cutting(0.5), s.isCutting = false, s.tissue = cases::Tissue::pulp;
        if (t >= 4) s.tissue = cases::Tissue::enamel, s.tooth = 2, s.forceN = 0.25;
        if (t >= 5)
            s.tooth = 0, s.tissue = cases::Tissue::none, s.depthMm = -1, s.pressesGingiva = true, s.forceN = 0.125;
        return s;
    };
    const auto is = [&](const char* kind, double truth, const char* tissue = "") {
        measures::Selection of;
        of.tissue = tissue;
        const Measured m = one(kind, 6.0, day, of);
        ASSERT_TRUE(m.value) << kind << ": " << m.reason;
        EXPECT_NEAR(*m.value, truth, m.uncertainty + 1e-9) << kind << " " << tissue;
        EXPECT_LT(m.uncertainty, 0.02 * std::max(truth, 0.1)) << kind;
    };
    is("time", 6.0);
    is("drill-time", 1.0);
    is("idle-time", 1.0);
    is("strokes", 1.0);
    is("impulse-on-protected", 0.75);
    is("impulse-on-protected", 0.5, "pulp");
    is("impulse-on-protected", 0.25, "neighbour");
    is("impulse-on-protected", 0.125, "gum");
    is("impulse-on-protected", 0.0, "dentine");
    const Measured on = one("impulse-on-protected", 6.0, day);
    EXPECT_NEAR(*on.evidence.at(0).timeS, 3.0, 0.0015);
    EXPECT_DOUBLE_EQ(*on.evidence.at(1).forceN, 0.5);
}

TEST(Hand, AStrokeThatIsTakenBackTakesItsHarmWithIt) {
    using Step = HandMeasures::Step;
    measures::Selection gum;
    gum.tissue = "gum";
    HandMeasures hand(std::vector<Request>{{"impulse-not-undone", gum}, {"impulse-on-protected", gum}, {"undos"}}, {});
    double nowS = 0.0;
    // A second with so much on the gingiva; `removes`: it also cuts tooth, which makes it a step of the history.
    const auto stroke = [&](double gumN, bool removes) {
        for (int i = 0; i < 1000; ++i) {
            Sample s = cutting(gumN);
            s.timeS = nowS += 1e-3;
            s.lastsS = 1e-3;
            s.depthMm = -1.0;
            s.pressesGingiva = gumN > 0.0;
            s.isCutting = s.hasRemoved = removes;
            hand.take(s);
        }
        hand.endStroke();
    };
    const auto stands = [&](double truth, const char* when) {
        const std::vector<Measured> all = hand.measured();
        EXPECT_NEAR(*all[0].value, truth, 1e-6) << when;
        if (truth > 0.0) {
            EXPECT_FALSE(all[0].evidence.empty()) << when;
        } else {
            EXPECT_TRUE(all[0].evidence.empty()) << when;
        }
    };
    stroke(0.125, true);
    stroke(0.5, true);
    stands(0.625, "nothing was undone");
    hand.takeStep(nowS, Step::undo);
    stands(0.125, "the second goes whole");
    hand.takeStep(nowS, Step::redo);
    stands(0.625, "and comes back");
    hand.takeStep(nowS, Step::undo);
    stroke(0.25, false);
    stands(0.375, "a stroke that cut no tooth");
    hand.takeStep(nowS, Step::undo);
    stands(0.0, "goes back with the step before it");
    stroke(1.0, true);
    hand.takeStep(nowS, Step::redo);
    stands(1.0, "what was undone before a new stroke cannot come back");
    hand.takeStep(nowS, Step::reset);
    stands(0.0, "a whole tooth in whole gingiva");
    hand.takeStep(nowS, Step::undo);
    stands(1.0, "a reset is a step too");
    const std::vector<Measured> all = hand.measured();
    EXPECT_NEAR(*all[1].value, 0.125 + 0.5 + 0.25 + 1.0, 1e-6) << "the measure of before counts all, as it did";
    EXPECT_EQ(*all[2].value, 7.0) << "and how often is told";
}

TEST(Hand, OfALoopThatCutsEveryOtherTickDrillsAllTheTime) {
    const auto at = [](double t) {
        Sample s = cutting();
        s.isCutting = static_cast<int>(std::lround(t * 4000)) % 2 == 0;
        return s;
    };
    const Measured drill = one("drill-time", 3.0, at, {}, 4000.0);
    EXPECT_NEAR(*drill.value, 3.0, drill.uncertainty);
    EXPECT_LE(drill.uncertainty, 0.005);
}

TEST(Hand, StallsTiltsAndSlowsDown) {
    const auto at = [](double t) {
        Sample s = cutting();
        const double degrees = 10.0 + 20.0 * t;  // to 50
        s.burInTooth.orientation = core::Quat(Eigen::AngleAxisd(degrees / 57.29577951308232, Vec3(1, 0, 0)));
        s.speedRpm = 100000 + 50000 * t;
        s.isStalled = (t > 0.5 && t < 0.6) || (t > 0.62 && t < 0.7) || t > 1.5;
        return s;
    };
    const auto is = [&](const char* kind, const char* which, double truth, double within) {
        const Measured m = one(kind, 2.0, at, statistic(which));
        EXPECT_NEAR(*m.value, truth, within) << kind << " " << which;
    };
    is("tilt", "least", 10.0, 0.01);
    is("tilt", "greatest", 50.0, 0.03);
    is("tilt", "median", 30.0, 0.03);
    is("tilt", "mean", 30.0, 0.03);
    is("speed-under-load", "least", 100000, 4);
    is("speed-under-load", "p95", 195000, 60);
    EXPECT_NEAR(*one("tilt", 2.0, at).evidence.at(0).timeS, 2.0, 0.002);
    const Measured stalls = one("stalls", 2.0, at);
    EXPECT_EQ(*stalls.value, 2.0);
    EXPECT_NEAR(*stalls.evidence.at(1).timeS, 1.5, 0.002);
}

TEST(Hand, ReachesIntoWhatIsProtected) {
    // All below z = 0 must stay; a flat-ended bur of 1 mm goes down to and past it.
    const zones::Zones zones(
        [](const Vec3& p) {
            return zones::PastTarget{p.head<2>().norm() - 2.0, -p.z()};
        },
        {Vec3(-2, -2, 0), Vec3(2, 2, 2)}, {}, [](const Vec3& p) { return p.z(); });
    const instrument::Bur bur = instrument::makeBur("cylinder-flat:1.0x4");
    for (const double tiltDeg : {0.0, 30.0}) {
        HandMeasures hand(std::vector<Request>{{"impulse-on-protected"}}, {Vec3::UnitZ(), &zones});
        hand.takeBur(0.0, "cylinder", &bur);
        const core::Quat turn(Eigen::AngleAxisd(tiltDeg / 57.29577951308232, Vec3(1, 0, 0)));
        // Of a flat end the lowest point lies its radius times the sine below the tip.
        const double lowest = 0.5 * std::sin(tiltDeg / 57.29577951308232);
        for (int i = 0; i < 4000; ++i) {
            Sample s = cutting();
            s.timeS = i * 1e-3;
            s.lastsS = 1e-3;
            s.burInTooth = {Vec3(0, 0, lowest + 1.0 - i * 5e-4), turn};  // there after 2 s
            hand.take(s);
        }
        const Measured on = hand.measured().front();
        EXPECT_NEAR(*on.value, 2.0, 0.04) << tiltDeg;
        EXPECT_NEAR(*on.evidence.at(0).timeS, 2.0, 0.04) << tiltDeg;
    }
}

TEST(Hand, TellsHowOneWorkedOnlyWhereItIsTold) {
    const std::vector<Request> all{{"mirror-share"},     {"finger-rest-share"}, {"views"},
                                   {"depth-stop-share"}, {"bur-changes"},       {"undos"}};
    const auto work = [&](bool tells) {
        HandMeasures hand(all, {});
        hand.takeBur(0, "330", nullptr);
        for (int i = 0; i < 10000; ++i) {
            if (tells && i == 0) hand.takeWay({9, false, true, false});
            if (tells && i == 2500) hand.takeWay({11, true, true, true});
            if (tells && i == 9500) hand.takeWay({12, true, false, true});
            if (i == 5000) hand.goOn(1), hand.takeBur(0, "330", nullptr), hand.takeStep(0, HandMeasures::Step::undo);
            if (i == 6000) hand.takeBur(1.0, "245", nullptr);
            Sample s = cutting();
            s.timeS = (i % 5000) * 1e-3;
            s.lastsS = 1e-3;
            hand.take(s);
        }
        return hand.measured();
    };
    const std::vector<Measured> told = work(true), untold = work(false);
    EXPECT_NEAR(*told[0].value, 75.0, told[0].uncertainty);
    EXPECT_NEAR(*told[1].value, 95.0, told[1].uncertainty);
    EXPECT_EQ(*told[2].value, 2.0) << "half a second is none";
    EXPECT_NEAR(*told[3].value, 75.0, told[3].uncertainty);
    EXPECT_EQ(*told[4].value, 1.0);
    EXPECT_EQ(told[4].evidence.at(0).session, 1u);
    EXPECT_EQ(*told[5].value, 1.0);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_FALSE(untold[i].value) << all[i].kind;
        EXPECT_FALSE(untold[i].reason.empty());
    }
}

TEST(Hand, OfNoSamplesSaysSoAndTwiceIsTheSame) {
    std::vector<Request> all;
    for (const measures::MeasureKind& kind : measures::measureKinds())
        if (kind.subject == measures::Subject::hand)
            all.push_back({std::string(kind.id), kind.takes == 16 ? limit(1) : measures::Selection{}});
    HandMeasures nothing(all, {});
    for (const Measured& m : nothing.measured()) {
        EXPECT_FALSE(m.value) << m.kind;
        EXPECT_THAT(m.reason, HasSubstr("no samples")) << m.kind;
    }
    const auto seed = test::seed();
    const auto work = [&] {
        std::mt19937_64 generator(seed);
        return taken(all, 12.0, [&](double t) {
            Sample s = cutting(test::uniform(generator, 0, 3));
            s.isPedalDown = std::fmod(t, 4.0) < 3.0;
            s.burInTooth.positionMm = {std::sin(t), std::cos(2.2 * t), test::uniform(generator, 0, 0.1)};
            return s;
        });
    };
    const std::vector<Measured> once = work(), again = work();
    for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_EQ(once[i].value, again[i].value) << all[i].kind;
        EXPECT_EQ(once[i].uncertainty, again[i].uncertainty) << all[i].kind;
        EXPECT_NE(once[i].reason, "not taken by this version") << all[i].kind;
        if (once[i].value) {
            const measures::MeasureKind& kind = *measures::findMeasureKind(all[i].kind);
            EXPECT_TRUE(*once[i].value >= kind.least && *once[i].value <= kind.most) << all[i].kind;
        }
    }
    EXPECT_THAT(test::errorOf([] { HandMeasures(std::vector<Request>{{"floor-depth"}}, {}); }),
                HasSubstr("of the tooth"));
    EXPECT_THAT(test::errorOf([] { HandMeasures(std::vector<Request>{{"force", limit(1)}}, {}); }), HasSubstr("limit"));
    EXPECT_THAT(test::errorOf([] { HandMeasures(std::vector<Request>{{"grace"}}, {}); }), HasSubstr("no measure"));
}

TEST(Hand, WithNumbersThatAreNoneIsStillMeasured) {
    const auto at = [](double t) {
        Sample s = cutting();
        if (std::fmod(t, 0.1) < 0.05) {
            s.forceN = s.speedRpm = std::nan("");
            s.depthMm = std::nan("");
            s.burInTooth.positionMm = Vec3::Constant(std::nan(""));
        }
        return s;
    };
    for (const char* kind :
         {"force", "path-length", "tilt", "speed-under-load", "drill-time", "impulse-on-protected"}) {
        const Measured m = one(kind, 3.0, at);
        ASSERT_TRUE(m.value) << kind;
        EXPECT_TRUE(std::isfinite(*m.value) && std::isfinite(m.uncertainty)) << kind;
    }
}

}  // namespace
}  // namespace handpiece::hand::hand_test
