// SPDX-License-Identifier: Apache-2.0
// Presses and drags about whole mouths. HANDPIECE_POINTER_SWEEP=N: so many at random of each of three.
// HANDPIECE_KEPT_CASES=FOLDER keeps the mouths, which take a minute to make.
#include "app/input/mouth_course.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <map>

#include "handpiece/assess/hand/hand.h"
#include "support/random.h"

namespace handpiece::input::mouth_course_test {
namespace {

using core::Vec2;
using core::Vec3;
using Idle = PointerController::Idle;

Mouth& mouthAt(int fdi) {
    static std::map<int, std::unique_ptr<Mouth>> made;
    std::unique_ptr<Mouth>& mouth = made[fdi];
    static const test::TemporaryFolder own;
    const char* kept = std::getenv("HANDPIECE_KEPT_CASES");
    if (!mouth) mouth = std::make_unique<Mouth>(fdi, kept ? kept : own.path());
    return *mouth;
}

const char* nameOf(Idle idle) {
    constexpr const char* kNames[] = {"cuts",    "off tooth", "at stop", "pass done", "off stroke", "no reach",
                                      "through", "on way",    "stalled", "hurries",   "held"};
    static_assert(std::size(kNames) == static_cast<std::size_t>(Idle::held) + 1);
    return kNames[static_cast<int>(idle)];
}

void print(const MouthWay& way, const MouthFigures& f) {
    std::printf("  | %s | %s | %d | %.1f | %.3f | %.3f | %s | %d | %.2f | %.2f | %.3f | %.4f | %.3f |\n",
                way.name.c_str(), way.bur.c_str(), static_cast<int>(way.eye), way.loadN, f.offMm, f.notNearestMm,
                nameOf(f.said), f.tooHard, f.mostN, f.mostAwayMm, f.removedMm3, f.outsideMm3, f.othersMm3);
    std::fflush(stdout);
}

// A groove on the buccal side, then a press at the neck, by the gingiva.
TEST(MouthCourse, fromAGrooveToTheNeck) {
    MouthWay way;
    way.name = "46/neck";
    way.eye = view::StandardView::buccal;
    way.at = [](double t) {
        const double s = std::clamp((t - 0.6) / 1.0, 0.0, 1.0);
        return t < 2.2 ? Vec2(420 + 60 * s, 330) : Vec2(470, 560);
    };
    way.releaseS = 2.0;
    way.againS = 2.7;
    way.endS = 5.0;
    MouthCourse course(mouthAt(46), way);
    const MouthFigures f = course.play();
    print(way, f);
    EXPECT_LT(f.notNearestMm, 0.15);
    EXPECT_EQ(f.tooHard, 0);
}

// Along the central fissure, as the mouse's hand begins: one groove of one depth, whatever the speed.
TEST(MouthCourse, alongAFissureTheDepthIsEven) {
    for (const double pxPerS : {15.0, 40.0, 150.0}) {
        MouthWay way;
        way.name = "46/fissure " + std::to_string(static_cast<int>(pxPerS)) + " px/s";
        const Vec2 from(390, 350), to(500, 350);
        const double lastsS = (to - from).norm() / pxPerS;
        way.at = [=](double t) { return Vec2(from + std::clamp((t - 0.45) / lastsS, 0.0, 1.0) * (to - from)); };
        way.releaseS = 0.45 + lastsS + 0.05;
        way.endS = way.releaseS + 0.4;
        MouthCourse course(mouthAt(46), way);
        const MouthFigures f = course.play();
        // The deepest at each tenth of a millimetre along the fissure, along the bur, below the uncut tooth.
        std::map<int, double> deepest;
        for (const core::Pose& at : f.floor) {
            double& deep = deepest[static_cast<int>(std::lround(10.0 * at.positionMm.x()))];
            const Leading leading(*course.feel, at.orientation);
            deep = std::max(deep, leading.wayOutMm(at.positionMm, leading.axis(), 0.0));
        }
        ASSERT_GT(deepest.size(), 10u);
        std::vector<double> depths;
        for (const auto& [place, deep] : deepest)
            if (place > deepest.begin()->first + 1 && place < deepest.rbegin()->first - 1) depths.push_back(deep);
        const auto [least, most] = std::minmax_element(depths.begin(), depths.end());
        std::printf("  %s: %.3f to %.3f mm deep, %.3f mm3, bore %.2f N\n", way.name.c_str(), *least, *most,
                    f.removedMm3, f.mostN);
        EXPECT_LT(*most - *least, 0.15) << pxPerS;
        EXPECT_LT(*most, kFirstPerPassMm + 0.05);
        EXPECT_LT(f.outsideMm3, 0.001);
    }
}

// Four times there and back: what a recording says of the hand is what the script did, as the report measures it.
TEST(MouthCourse, aRecordingHasThePathAndTheTimeOfTheScript) {
    for (const bool isFissure : {true, false}) {
        MouthWay way;
        way.name = isFissure ? "46/fissure" : "46/buccal";
        if (!isFissure) way.eye = view::StandardView::buccal;
        const double high = isFissure ? 350 : 330;
        const Vec2 from(isFissure ? 390 : 370, high), to(isFissure ? 500 : 530, high);
        const double beginsS = 1.0, onceS = (to - from).norm() / 40.0, lastsS = 4.0 * onceS;
        way.at = [=](double t) {
            const double s = std::clamp((t - beginsS) / onceS, 0.0, 4.0), r = std::fmod(s, 2.0);
            return Vec2(from + (r <= 1.0 ? r : 2.0 - r) * (to - from));
        };
        way.releaseS = beginsS + lastsS + 0.1;
        way.endS = way.releaseS + 0.4;
        MouthCourse course(mouthAt(46), way);
        measures::Selection mean;
        mean.statistic = "mean";
        const std::vector<measures::Request> asked{{"path-length"}, {"force", mean}, {"time"}};
        hand::HandMeasures measures(asked, {});
        double downS = 0.0;
        course.look = [&](double t, const messages::HapticSample& sample) {
            downS += sample.pedal > 0.5 ? course.loop->periodS() : 0.0;
            if (t < beginsS || t > beginsS + lastsS) return;
            hand::Sample s;
            s.timeS = t;
            s.lastsS = course.loop->periodS();
            s.burInTooth.positionMm = Vec3(sample.positionMm.data());
            s.burInTooth.orientation = course.tilt();
            s.forceN = Vec3(sample.forceN.data()).norm();
            s.depthMm = sample.depthMm;
            s.speedRpm = sample.speedRpm;
            s.tissue = static_cast<cases::Tissue>(sample.tissue);
            s.isPedalDown = sample.pedal > 0.5;
            s.isCutting = (sample.flags & messages::kCutting) != 0;
            measures.take(s);
        };
        const MouthFigures f = course.play();
        const std::vector<measures::Measured> told = measures.measured();
        ASSERT_TRUE(told[0].value && told[2].value) << told[0].reason;
        std::printf("  %s: drawn %.2f mm, recorded %.2f; %.3f N; %.2f of %.2f s, pedal %.2f\n", way.name.c_str(),
                    f.drawnMm, *told[0].value, told[1].value.value_or(-1.0), *told[2].value, lastsS, downS);
        // Of each turn a ruler of 0.2 mm may lose half of itself.
        EXPECT_NEAR(*told[0].value, f.drawnMm, (isFissure ? 0.03 : 0.05) * f.drawnMm);
        EXPECT_NEAR(*told[2].value, lastsS, 0.03 * lastsS);
        EXPECT_NEAR(downS, way.releaseS - way.pressS, 0.03 * (way.releaseS - way.pressS));
    }
}

// The bur stands: between the walls of a fissure and over its ridges the tip goes several times as far as the hand.
TEST(MouthCourse, touchedAlongAFissureItDoesNotChatter) {
    MouthWay way;
    way.turns = false;
    way.at = [](double t) { return Vec2(390 + 110 * std::clamp((t - 1.0) / 2.75, 0.0, 1.0), 350); };
    way.releaseS = 3.8;
    way.endS = 4.0;
    MouthCourse course(mouthAt(46), way);
    double tipMm = 0.0;
    std::optional<Vec3> before;
    course.look = [&](double t, const messages::HapticSample& sample) {
        if (t < 1.0 || t > 3.75) return;
        const Vec3 tip(sample.proxyPositionMm.data());
        tipMm += before ? (tip - *before).norm() : 0.0;
        before = tip;
    };
    const MouthFigures f = course.play();
    std::printf("  drawn %.2f mm, tip %.2f\n", f.drawnMm, tipMm);
    EXPECT_LT(tipMm, 5.0 * f.drawnMm);  // 25 times without that, at 1 kHz
}

// A deep hole, as who turns the depth of a pass up makes it: the bur comes out, and cuts elsewhere.
TEST(MouthCourse, outOfADeepHoleAndOn) {
    for (const char* bur : {"245", "round-4"}) {
        MouthWay way;
        way.name = "46/deep";
        way.bur = bur;
        way.loadN = 3.0;
        way.limits = {4.0, 3.0};
        const Vec2 from(440, 350), along(15, 12);
        way.at = [=](double t) {
            return t < 4.2 ? Vec2(from + std::clamp((t - 2.0) / 1.0, 0.0, 1.0) * along) : Vec2(360, 300);
        };
        way.releaseS = 3.5;
        way.againS = 4.7;
        way.endS = 6.0;
        MouthCourse course(mouthAt(46), way);
        double freeS = -1.0;
        course.look = [&](double t, const messages::HapticSample& sample) {
            if (t > way.releaseS && freeS < 0.0 && sample.depthMm <= 0.0) freeS = t - way.releaseS;
        };
        const MouthFigures f = course.play();
        print(way, f);
        EXPECT_GT(f.removedMm3, 1.0);
        EXPECT_LT(f.notNearestMm, 0.15) << bur;
        EXPECT_TRUE(freeS >= 0.0 && freeS < 1.0) << bur << ' ' << freeS;
    }
}

TEST(MouthCourse, pressesAndDragsAtRandom) {
    const char* asked = std::getenv("HANDPIECE_POINTER_SWEEP");
    const int many = asked ? std::max(1, std::atoi(asked)) : 3;
    std::mt19937_64 random(test::seed());
    int tooHard = 0, outside = 0, near = 0, told = 0, all = 0;
    const std::vector<int> mouths = asked ? std::vector<int>{46, 33, 16} : std::vector<int>{46};
    for (const int fdi : mouths) {
        Mouth& mouth = mouthAt(fdi);
        for (int i = 0; i < many; ++i) {
            static const char* const kBurs[] = {"330", "round-4", "556", "round-1/4", "245"};
            MouthWay way;
            way.name = std::to_string(fdi) + "/" + std::to_string(i);
            way.bur = kBurs[random() % 5];
            way.eye = view::standardViews()[random() % 6].first;
            way.isLeftHanded = random() % 2 == 0;
            way.loadN = std::array{0.3, 1.0, 3.0}[random() % 3];
            const double u = test::uniform(random, 0.3, 0.7), v = test::uniform(random, 0.3, 0.7);
            const Vec2 from(900.0 * u, 700.0 * v);
            const double angle = test::uniform(random, 0.0, 6.283), length = test::uniform(random, 0.0, 120.0);
            const double speed = std::exp(test::uniform(random, std::log(15.0), std::log(400.0)));
            const Vec2 to = from + length * Vec2(std::cos(angle), std::sin(angle));
            const double dwellS = 0.25, lastsS = length / speed;
            // It waits for a handpiece that has to be taken another way.
            way.releaseS = way.pressS + dwellS + lastsS + 1.5;
            way.endS = way.releaseS + 0.3;
            way.at = [=](double t) {
                return Vec2(from + std::clamp((t - 0.65) / std::max(lastsS, 1e-6), 0.0, 1.0) * (to - from));
            };
            MouthCourse course(mouth, way);
            const MouthFigures f = course.play();
            const bool isNear = f.notNearestMm < 0.15, isTold = !isNear && f.said != Idle::no;
            ++all;
            near += isNear;
            told += isTold;
            tooHard += f.tooHard > 0;
            outside += f.outsideMm3 > 0.001;
            if (many <= 10 || !isNear || f.tooHard > 0 || f.outsideMm3 > 0.001) print(way, f);
        }
    }
    std::printf("  %d ways: %d near, %d told why not; %d bore too hard, %d cut outside\n", all, near, told, tooHard,
                outside);
    EXPECT_EQ(near + told, all);
    EXPECT_LE(tooHard, all / 30);  // a light hand that meets gingiva on its way: docs/pointer.md
    EXPECT_EQ(outside, 0);
}

}  // namespace
}  // namespace handpiece::input::mouth_course_test
