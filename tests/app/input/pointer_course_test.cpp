// SPDX-License-Identifier: Apache-2.0
// Pointer paths over the starter teeth, played through hand, tick and cutting: where the bur went, in numbers. With
// HANDPIECE_POINTER_SWEEP=N in the environment also N paths at random, and the table is worth more.
#include "app/input/pointer_course.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <random>

#include "handpiece/model/instrument/catalogue.h"
#include "support/random.h"

namespace handpiece::input::pointer_course_test {
namespace {

using core::Vec2;
using core::Vec3;
using starter::ToothKind;
using view::StandardView;

// What docs/pointer.md promises.
constexpr double kMaxTargetPx = 3.0, kMaxNotNearestMm = 0.05, kMaxOutside = 0.03;
constexpr double kMaxSilentS = 0.1;  // three pictures
constexpr double kMaxOffPx = 3.0;    // of the tip, under a pointer that stands still

struct Case {
    const char* name;
    ToothKind tooth = ToothKind::lowerFirstMolar;
    const char* bur = "330";
    StandardView eye = StandardView::occlusal;
    double loadN = 1.0, stopMm = 0.0;
    const char* path = "drag";
    double speedPx = 20.0, lengthPx = 50.0;
    Vec2 fromPx{-25, 10};  // from the middle of the crown
};

/// Prepared once: an uncut tooth and the tissues in it.
simulation::SimulationSetup stationOf(ToothKind kind, const std::string& bur) {
    static std::map<ToothKind, simulation::SimulationSetup> made;
    simulation::SimulationSettings settings;
    settings.field.voxelMm = 0.1;
    const instrument::Instrument instrument = instrument::makeInstrument(bur);
    settings.bur = instrument.bur;
    settings.cuttingParameters = instrument.cuttingParameters;
    auto found = made.find(kind);
    if (found == made.end()) {
        cases::Case toothCase;
        if (kind == ToothKind::lowerFirstMolar) {
            toothCase = starter::makeTooth(kind, {8000, 4000, false});
        } else {  // of enamel: parts as coarse as this cross themselves
            toothCase.name = starter::infoOf(kind).name;
            toothCase.outer = starter::makeOuter(kind, 8000);
            toothCase.parts.push_back({"enamel", cases::Tissue::enamel, 0, toothCase.outer});
        }
        found = made.emplace(kind, simulation::makeSimulation(toothCase, settings, false)).first;
    }
    simulation::SimulationSetup station = found->second;
    station.field = std::make_shared<tooth::ToothState>(station.tooth);
    station.settings.bur = settings.bur;
    station.settings.cuttingParameters = settings.cuttingParameters;
    return station;
}

/// The middle of the crown as one sees it.
Vec2 middleOf(const PointerCourse& course) {
    const core::Box box = course.station.tooth->outer.bounds();
    return course.pixel({box.centre().x(), box.centre().y(), box.max.z() - 0.15 * box.size().z()});
}

PointerPath pathOf(const Case& c, const PointerCourse& course) {
    PointerPath path;
    path.name = c.path;
    const std::string kind = c.path;
    const Vec2 from = middleOf(course) + c.fromPx;
    const double way = c.lengthPx, speed = c.speedPx, lasts = way / speed, dwell = 0.4;
    path.pressS = 0.3;
    path.releaseS = path.pressS + 2 * dwell + lasts;
    path.endS = path.releaseS + 0.4;
    const double begins = path.pressS + dwell;
    const auto share = [=](double t) { return std::clamp((t - begins) / lasts, 0.0, 1.0); };
    if (kind == "across") {
        path.at = [=](double t) { return Vec2(from + Vec2(0.3, -0.95) * way * share(t)); };
    } else if (kind == "circle") {
        path.at = [=](double t) {
            const double angle = 2.0 * std::numbers::pi * share(t), r = way / (2.0 * std::numbers::pi);
            return Vec2(from + r * Vec2(1.0 - std::cos(angle), std::sin(angle)));
        };
    } else if (kind == "zigzag") {
        path.at = [=](double t) {
            const double s = share(t), leg = 8.0 * s - std::floor(8.0 * s);
            const double side = static_cast<int>(std::floor(8.0 * s)) % 2 == 0 ? leg : 1.0 - leg;
            return Vec2(from + Vec2(0.5 * way * s, 12.0 * side));
        };
    } else if (kind == "jitter") {
        path.at = [=](double t) {
            const double n = std::floor(t / kEventS);
            return Vec2(from + Vec2(way * share(t), 0) + 1.5 * Vec2(std::sin(37.0 * n), std::sin(61.0 * n)));
        };
    } else if (kind == "hold") {
        path.at = [=](double) { return from; };
    } else if (kind == "there and back") {
        path.at = [=](double t) { return Vec2(from + Vec2(way * (1.0 - std::abs(2.0 * share(t) - 1.0)), 0)); };
    } else if (kind == "on") {  // begins beside the tooth
        path.at = [=](double t) { return Vec2(from + Vec2(-way * (1.0 - share(t)), 0)); };
    } else {
        path.at = [=](double t) { return Vec2(from + Vec2(way * share(t), 0)); };
    }
    return path;
}

void header() {
    std::printf(
        "  | path | tooth | bur | view | load, stop | target px | strain mm | not nearest mm | idle s | "
        "most N | mm3 |\n  |---|---|---|---|---|---|---|---|---|---|---|\n");
}

const char* nameOf(StandardView eye) {
    for (const auto& [view, name] : view::standardViews())
        if (view == eye) return name.data();
    return "";
}

CourseFigures run(const Case& c, const PointerPath& path, PointerCourse& course) {
    course.hand->setLoad(c.loadN);
    if (c.stopMm > 0.0) course.hand->setStop(c.stopMm);
    const CourseFigures f = course.play(path);
    const std::string stop = c.stopMm > 0.0 ? std::to_string(c.stopMm).substr(0, 3) : "-";
    std::printf("  | %s, %s | %s | %s | %s | %.1f, %s | %.2f | %.2f | %.3f | %.2f | %.2f | %.3f |\n", c.name,
                path.name.c_str(), std::string(starter::infoOf(c.tooth).name).c_str(), c.bur, nameOf(c.eye), c.loadN,
                stop.c_str(), f.targetOffPx, f.tipOffMm, f.notNearestMm, f.idleS, f.mostLoadN, f.removedMm3);
    EXPECT_LT(f.targetOffPx, kMaxTargetPx) << c.name;
    EXPECT_LT(f.notNearestMm, kMaxNotNearestMm) << c.name;
    if (path.name == "hold") {
        EXPECT_LT(f.tipOffPx, kMaxOffPx) << c.name;
    }
    EXPECT_LT(f.idleS, kMaxSilentS) << c.name;
    EXPECT_LT(f.mostLoadN, 3.3001) << c.name;
    return f;
}

CourseFigures run(const Case& c) {
    PointerCourse course(stationOf(c.tooth, c.bur), c.eye, starter::infoOf(c.tooth).buccalSign, 0.42);
    return run(c, pathOf(c, course), course);
}

constexpr ToothKind kMolar = ToothKind::lowerFirstMolar, kIncisor = ToothKind::upperIncisor,
                    kPremolar = ToothKind::upperPremolar;

TEST(PointerCourse, theBurStaysUnderThePointer) {
    header();
    const std::vector<Case> cases{
        {"beside the fissure", kMolar, "330", StandardView::occlusal, 1.0, 1.5},
        {"across the fissure", kMolar, "330", StandardView::occlusal, 1.0, 0.5, "across"},
        {"3 N on a slope", kMolar, "round-4", StandardView::occlusal, 3.0, 0.0, "hold", 40, 40, {-45, 60}},
        {"3 N on a slope", kMolar, "330", StandardView::occlusal, 3.0, 0.0, "hold", 40, 40, {50, -70}},
        {"gently", kMolar, "round-4", StandardView::occlusal, 0.3, 0.0, "circle", 30, 60},
        {"oblique", kMolar, "330", StandardView::oblique, 1.0, 0.5, "drag"},
        {"oblique", kMolar, "330", StandardView::oblique, 3.0, 0.0, "hold", 40, 40, {60, -40}},
        {"over the cusps", kMolar, "round-4", StandardView::oblique, 1.0, 0.0, "across", 150, 160, {0, 60}},
        {"at the side", kMolar, "556", StandardView::buccal, 1.0, 0.5, "drag", 30, 60, {-30, 40}},
        {"fast", kMolar, "round-4", StandardView::occlusal, 0.3, 0.0, "there and back", 2000, 200, {-100, 30}},
        {"creeping", kMolar, "round-4", StandardView::occlusal, 1.0, 0.5, "drag", 5, 8},
        {"shaking", kPremolar, "330", StandardView::occlusal, 1.0, 0.5, "jitter", 20, 30, {-10, 20}},
        {"zigzag", kPremolar, "round-4", StandardView::mesial, 1.0, 0.5, "zigzag", 20, 40, {-20, 20}},
        {"at the back", kIncisor, "round-4", StandardView::lingual, 1.0, 0.5, "drag", 20, 40, {-20, 60}},
        {"at the edge", kIncisor, "556", StandardView::distal, 1.0, 0.0, "drag", 20, 30, {-10, 30}},
    };
    for (const Case& c : cases)
        EXPECT_GT(run(c).removedMm3, 0.0) << c.name;
}

TEST(PointerCourse, offTheToothItSaysSoAndCutsOnWhenItIsBack) {
    header();
    const CourseFigures on =
        run({"dragged on", kMolar, "330", StandardView::occlusal, 1.0, 0.5, "on", 120, 300, {-60, 0}});
    const CourseFigures off =
        run({"dragged off", kMolar, "330", StandardView::occlusal, 1.0, 0.5, "off", 120, 300, {60, 0}});
    EXPECT_GT(on.removedMm3, 0.0);
    EXPECT_GT(off.removedMm3, 0.0);
}

TEST(PointerCourse, theSamePathTwiceCutsTheSameGroove) {
    std::printf("  | second pass | view | removed mm3 | outside mm3 | share |\n  |---|---|---|---|---|\n");
    for (const Case& c : {Case{"a groove", kMolar, "330", StandardView::occlusal, 2.0, 0.5, "drag", 8, 30},
                          Case{"a groove", kMolar, "round-4", StandardView::occlusal, 2.0, 0.5, "circle", 8, 40},
                          Case{"a groove", kMolar, "330", StandardView::oblique, 2.0, 0.5, "drag", 8, 30}}) {
        PointerCourse course(stationOf(c.tooth, c.bur), c.eye, 1, 0.42);
        course.hand->setLoad(c.loadN);
        course.hand->setStop(c.stopMm);
        PointerPath path = pathOf(c, course);
        const CourseFigures first = course.play(path);
        course.firstPass = false;
        (void)course.play(path);
        const PointerCourse::Outside o = course.outside();
        std::printf("  | %s, %s, %s, %.1f mm3 first | %s | %.4f | %.5f | %.1f %% |\n", c.name, c.path, c.bur,
                    first.removedMm3, nameOf(c.eye), o.secondMm3, o.outsideMm3,
                    100.0 * o.outsideMm3 / std::max(1e-9, o.secondMm3));
        EXPECT_GT(first.removedMm3, 0.15);
        EXPECT_LE(o.outsideMm3, kMaxOutside * o.secondMm3) << c.path;
    }
}

// The stroke of which it was told that the bur stood a millimetre beside it: 5 mm in 9 s, faster than 1 N cuts to the
// stop, twice.
TEST(PointerCourse, aLongStrokeBesideTheFissure) {
    if (std::getenv("HANDPIECE_POINTER_SWEEP") == nullptr) GTEST_SKIP() << "takes six seconds";
    PointerCourse course(stationOf(kMolar, "330"), StandardView::occlusal, 1, 0.42);
    course.hand->setStop(1.5);
    const core::Box box = course.station.tooth->outer.bounds();
    const Vec3 middle(box.centre().x(), box.centre().y() + 0.6, box.max.z() - 1.0);
    const Vec2 pixel = course.pixel(middle);
    const double px = 1.0 / view::mmPerPixel(course.camera, course.viewport, middle);
    PointerPath path;
    path.releaseS = 9.3;
    path.endS = 10.0;
    path.at = [=](double t) { return Vec2(pixel + Vec2((std::clamp((t - 0.3) / 9.0, 0.0, 1.0) - 0.5) * 5.0 * px, 0)); };
    for (const bool again : {false, true}) {
        double next = 0.5;
        const CourseFigures f = course.play(path, [&](double t, const messages::HapticSample& h) {
            if (t < next) return;
            next += 1.0;
            const Vec3 off = course.tipOff(path.at(t - 0.012));
            std::printf("  %.1f s: tip %.3f %.3f %.3f, beside the stroke %.3f mm, behind %.3f mm, %.2f N, %.3f mm3\n",
                        t, h.proxyPositionMm[0], h.proxyPositionMm[1], h.proxyPositionMm[2], off.y(), off.x(),
                        Vec3(h.forceN.data()).norm(), course.removedMm3());
            if (t > 0.6 && t < path.releaseS) {
                EXPECT_LT(std::abs(off.y()), 0.05) << t;
            }
        });
        std::printf("  %s: %.3f mm3, off at most %.3f mm, not nearest %.3f mm\n", again ? "again" : "once",
                    f.removedMm3, f.tipOffMm, f.notNearestMm);
        EXPECT_LT(f.notNearestMm, kMaxNotNearestMm);
        course.firstPass = false;
    }
    const PointerCourse::Outside o = course.outside();
    std::printf("  second %.3f mm3, outside %.3f, of it not below the first groove %.3f\n", o.secondMm3, o.outsideMm3,
                o.acrossMm3);
}

TEST(PointerCourse, theStopHoldsAndTheLoadIsTheForce) {
    for (const double loadN : {0.1, 1.0, 3.0}) {
        // A still bur, on a flat and on a slope: what it feels is the load.
        for (const Vec2& at : {Vec2(-25, 10), Vec2(-45, 60), Vec2(50, -70)}) {
            PointerCourse course(stationOf(kMolar, "round-4"), StandardView::occlusal, 1, 0.42);
            course.hand->setLoad(loadN);
            const Vec2 pixel = middleOf(course) + at;
            course.hand->move(pixel);
            for (int i = 0; i < 200; ++i)
                course.tick();
            course.hand->follow(course.last);
            course.hand->press(pixel, false);
            for (int i = 0; i < 1000; ++i) {
                if (i % 33 == 0) course.hand->follow(course.last);
                course.tick();
            }
            const double feltN = Vec3(course.last.forceN.data()).norm();
            std::printf("  %.1f N: %.3f N felt, %.1f px off\n", loadN, feltN,
                        course.tipOff(pixel).norm() / view::mmPerPixel(course.camera, course.viewport, course.tip()));
            EXPECT_NEAR(feltN, loadN, 0.03 * loadN);
        }
    }
    // Down to the stop, however hard.
    for (const StandardView eye : {StandardView::occlusal, StandardView::oblique}) {
        PointerCourse course(stationOf(kMolar, "330"), eye, 1, 0.42);
        course.hand->setLoad(3.0);
        course.hand->setStop(1.0);
        PointerPath path;
        const Vec2 pixel = middleOf(course) + Vec2(-25, 10);
        path.at = [=](double) { return pixel; };
        path.releaseS = 3.3;
        path.endS = 3.4;
        Vec3 deepest = Vec3::Zero();
        (void)course.play(path, [&](double t, const messages::HapticSample&) {
            if (t < 3.29) deepest = course.tip();
        });
        const Vec3 axis = Vec3::UnitZ();
        double out = 0.0;
        core::Pose pose;
        while (out < 5.0) {
            pose.positionMm = deepest + out * axis;
            const double depth = course.uncut->depth(pose).depthMm;
            if (depth < 1e-3) break;
            out += std::max(depth, 1e-3);
        }
        std::printf("  stop at 1.0 mm, %s: %.3f mm\n", nameOf(eye), out);
        // Seen aslant over a slope three times the stop along the line of sight may be less than the stop along the
        // bur.
        EXPECT_LT(out, 1.03) << nameOf(eye);
        EXPECT_GT(out, eye == StandardView::occlusal ? 0.97 : 0.7) << nameOf(eye);
    }
}

TEST(PointerCourse, afterAResetAStrokeCuts) {
    PointerCourse course(stationOf(kMolar, "330"), StandardView::occlusal, 1, 0.42);
    course.hand->setStop(0.5);
    const Case c{"", kMolar, "330", StandardView::occlusal, 1.0, 0.5, "drag", 20, 30, {-15, 0}};
    PointerPath path = pathOf(c, course);
    EXPECT_GT(course.play(path).removedMm3, 0.02);
    // Every brick back, with the bur over the groove, and three strokes.
    const tooth::StateDelta back = tooth::changeBetween(course.mirror.state({}), {});
    (void)course.loop->restore(back);
    for (int i = 0; i < 50; ++i)
        course.tick();
    for (int stroke = 0; stroke < 3; ++stroke) {
        const CourseFigures f = course.play(path);
        EXPECT_LT(f.idleS, kMaxSilentS) << "it cuts, or says why not";
        if (stroke == 0) {
            EXPECT_GT(f.removedMm3, 0.02);
        }
    }
}

TEST(PointerCourse, liftingOutDoesNotCutSideways) {
    for (const StandardView eye : {StandardView::occlusal, StandardView::oblique}) {
        PointerCourse course(stationOf(kMolar, "330"), eye, 1, 0.42);
        const Case c{"", kMolar, "330", eye, 2.0, 1.0, "drag", 10, 10, {-15, 0}};
        course.hand->setLoad(2.0);
        course.hand->setStop(1.0);
        const PointerPath path = pathOf(c, course);
        double beforeLift = 0.0;
        const CourseFigures f = course.play(path, [&](double t, const messages::HapticSample&) {
            if (t < path.releaseS) beforeLift = course.removedMm3();
        });
        std::printf("  %s: %.3f mm3, of it %.4f when lifted\n", nameOf(eye), f.removedMm3, f.removedMm3 - beforeLift);
        EXPECT_LT(f.removedMm3 - beforeLift, 0.1 * f.removedMm3);
        EXPECT_EQ(course.hand->target().pedal, 0.0) << "and it has come out";
    }
}

TEST(PointerCourse, atRandom) {
    const char* asked = std::getenv("HANDPIECE_POINTER_SWEEP");
    const int many = asked ? std::atoi(asked) : 0;
    if (many <= 0) GTEST_SKIP() << "HANDPIECE_POINTER_SWEEP says how many";
    const std::uint64_t seed = test::seed();
    std::printf("  seed %llu\n", static_cast<unsigned long long>(seed));
    std::mt19937_64 random(seed);
    const auto between = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
    };
    header();
    for (int i = 0; i < many; ++i) {
        static const char* const kBurs[] = {"330", "round-4", "556", "556", "round-1/4"};
        static const char* const kPaths[] = {"drag", "across",         "circle", "zigzag", "jitter",
                                             "hold", "there and back", "on",     "off"};
        static constexpr ToothKind kTeeth[] = {kMolar, kIncisor, kPremolar};
        static constexpr double kLoads[] = {0.3, 1.0, 3.0}, kStops[] = {0.0, 0.5, 1.5};
        Case c{"random"};
        c.tooth = kTeeth[random() % 3];
        c.bur = kBurs[random() % 5];
        c.eye = view::standardViews()[random() % 6].first;
        c.loadN = kLoads[random() % 3];
        c.stopMm = kStops[random() % 3];
        c.path = kPaths[random() % 9];
        c.lengthPx = between(20, 150);
        c.speedPx = std::max(c.lengthPx / 4.0, std::exp(between(std::log(5.0), std::log(2000.0))));
        c.fromPx = {between(-100, 100), between(-80, 80)};
        (void)run(c);
    }
}

}  // namespace
}  // namespace handpiece::input::pointer_course_test
