// SPDX-License-Identifier: Apache-2.0
// A pointer's hand: alone against springs in closed form, and in the whole tick against a block of tooth.
#include "handpiece/tick/device/pointer_device.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/tooth/tooth_state.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/device/replay_device.h"
#include "handpiece/tick/loop/loop_run.h"
#include "support/closed_meshes.h"
#include "support/realtime_trap.h"

namespace handpiece::device::pointer_device_test {
namespace {

using cases::Tissue;
using core::Pose;
using core::Quat;
using core::Vec3;
using messages::HapticSample;

constexpr double kPeriodS = 1e-3;

PointerTarget targetAt(const Vec3& p, double loadN = 0.0, double pedal = 0.0, const Quat& q = Quat::Identity()) {
    PointerTarget t;
    for (int k = 0; k < 3; ++k)
        t.positionMm[k] = p[k];
    t.orientation[0] = q.w();
    for (int k = 0; k < 3; ++k)
        t.orientation[k + 1] = q.vec()[k];
    t.loadN = loadN;
    t.pedal = pedal;
    if (loadN > 0.0) {  // down, as far as it goes
        t.way[2] = -1.0;
        t.farMm = 10.0;
    }
    return t;
}

struct Alone {
    explicit Alone(const Vec3& start = Vec3::Zero(), const PointerHandSettings& settings = {})
        : mailbox(std::make_shared<PointerMailbox>()), hand(settings, mailbox, {start, Quat::Identity()}) {}
    Vec3 read(double periodS = kPeriodS) { return hand.read(periodS).burInTooth.positionMm; }
    /// What a spring does to it that holds the bur's tip on a plane: its force.
    double meet(const Vec3& handMm, const Vec3& pointMm, const Vec3& normal, double stiffness) {
        const double in = std::max(0.0, (pointMm - handMm).dot(normal));
        const Vec3 forceN = stiffness * in * normal;
        hand.watch(handMm + in * normal, -forceN);
        hand.command(forceN, Vec3::Zero());
        return forceN.norm();
    }
    std::shared_ptr<PointerMailbox> mailbox;
    PointerDevice hand;
};

TEST(PointerDevice, holdsStillUntilThePointerSpeaks) {
    Alone alone(Vec3(1, 2, 3));
    for (int i = 0; i < 50; ++i)
        EXPECT_EQ(alone.read(), Vec3(1, 2, 3));
    EXPECT_EQ(alone.hand.capability().maxForceN, 3.3);
}

TEST(PointerDevice, aTargetThatMakesNoSenseCountsAsNone) {
    Alone alone;
    alone.mailbox->write(targetAt(Vec3(1, 0, 0)));
    for (int i = 0; i < 300; ++i)
        (void)alone.read();
    const double nan = std::nan("");
    for (const Vec3& p : {Vec3(nan, 0, 0), Vec3(0, 1e300, 0), Vec3(0, 0, -INFINITY)}) {
        alone.mailbox->write(targetAt(p));
        EXPECT_NEAR((alone.read() - Vec3(1, 0, 0)).norm(), 0.0, 1e-6);
    }
    PointerTarget bad = targetAt(Vec3(2, 0, 0));
    bad.orientation[0] = 0.0;
    alone.mailbox->write(bad);
    EXPECT_NEAR((alone.read() - Vec3(1, 0, 0)).norm(), 0.0, 1e-6);
    bad = targetAt(Vec3(2, 0, 0));
    bad.loadN = nan;
    alone.mailbox->write(bad);
    EXPECT_NEAR((alone.read() - Vec3(1, 0, 0)).norm(), 0.0, 1e-6);
    bad = targetAt(Vec3(2, 0, 0));
    bad.way[0] = 0.5;
    alone.mailbox->write(bad);
    EXPECT_NEAR((alone.read() - Vec3(1, 0, 0)).norm(), 0.0, 1e-6);
    bad.way[0] = 1.0;
    bad.farMm = nan;
    alone.mailbox->write(bad);
    alone.hand.watch(Vec3(0, nan, 0), Vec3::Zero());
    const Reading r = alone.hand.read(kPeriodS);
    EXPECT_NEAR((r.burInTooth.positionMm - Vec3(1, 0, 0)).norm(), 0.0, 1e-6);
    EXPECT_TRUE(r.burInTooth.isValid());
    alone.hand.command(Vec3(nan, 0, 0), Vec3::Zero());
    EXPECT_TRUE(alone.read().allFinite());
}

TEST(PointerDevice, followsAnEvenPointerByItsDelayWithoutOvershoot) {
    const PointerHandSettings settings;
    Alone alone;
    double x = 0.0, worst = 0.0;
    for (int i = 0; i < 500; ++i) {
        const double t = i * kPeriodS, at = 50.0 * t;  // 50 mm/s
        alone.mailbox->write(targetAt(Vec3(at, 0, 0)));
        x = alone.read().x();
        if (t > 0.2) worst = std::max(worst, std::abs((at - x) / 50.0 - settings.followS));
    }
    EXPECT_LT(worst, 1e-3);
    // The pointer stops: the hand comes to rest there.
    const double end = 50.0 * 0.499;
    double most = 0.0;
    for (int i = 0; i < 300; ++i)
        most = std::max(most, alone.read().x());
    EXPECT_NEAR(alone.read().x(), end, 1e-6);
    EXPECT_LT(most, end + 0.005);
}

TEST(PointerDevice, aJumpOfThePointerIsATravelOfTheHand) {
    for (const double period : {1e-3, 1.25e-4}) {
        const PointerHandSettings settings;
        Alone alone;
        alone.mailbox->write(targetAt(Vec3(80, 0, 0)));
        Vec3 last = Vec3::Zero();
        double fastest = 0.0, furthest = 0.0, seconds = 0.0;
        for (double t = 0; t < 1.0; t += period) {
            const Vec3 p = alone.read(period);
            fastest = std::max(fastest, (p - last).norm() / period);
            furthest = std::max(furthest, p.x());
            if (std::abs(p.x() - 80) > 0.1) seconds = t;
            last = p;
        }
        EXPECT_LE(fastest, settings.travelMmS * 1.02);
        EXPECT_GT(fastest, settings.travelMmS * 0.9);
        EXPECT_LT(furthest, 80.05);
        EXPECT_LT(seconds, 80 / settings.travelMmS + 0.08);
    }
}

TEST(PointerDevice, turnsNoFasterThanAHand) {
    const PointerHandSettings settings;
    Alone alone;
    const Quat wanted(Eigen::AngleAxisd(2.0, Vec3::UnitY()));
    alone.mailbox->write(targetAt(Vec3::Zero(), 0, 0, wanted));
    Quat last = Quat::Identity();
    (void)alone.read();
    double seconds = 0.0;
    for (int i = 1; i < 600; ++i) {
        const Reading r = alone.hand.read(kPeriodS);
        EXPECT_TRUE(r.burInTooth.isValid());
        EXPECT_LE(r.burInTooth.orientation.angularDistance(last), settings.turnRadS * kPeriodS * 1.001);
        last = r.burInTooth.orientation;
        if (last.angularDistance(wanted) > 0.01) seconds = i * kPeriodS;
        EXPECT_LT(r.burInTooth.positionMm.norm(), 1e-12);
    }
    EXPECT_GT(seconds, 2.0 / settings.turnRadS - 0.01);
    EXPECT_LT(seconds, 2.0 / settings.turnRadS + 0.08);
}

TEST(PointerDevice, pressingBalancesAtItsLoadAgainstASpring) {
    for (const double load : {0.1, 1.0, 3.0}) {
        for (const double stiffness : {0.06, 0.3, 0.5, 2.0}) {
            Alone alone(Vec3(0, 0, 0.5));
            alone.mailbox->write(targetAt(Vec3(0, 0, 0.5), load));
            double touched = -1.0, fastest = 0.0, lastZ = 0.5, most = 0.0, force = 0.0;
            for (int i = 0; i < 6000; ++i) {
                const Vec3 at = alone.read();
                if (at.z() < 0 && touched < 0) touched = i * kPeriodS;
                fastest = std::max(fastest, (lastZ - at.z()) / kPeriodS);
                lastZ = at.z();
                most = std::max(most, force = alone.meet(at, Vec3::Zero(), Vec3::UnitZ(), stiffness));
            }
            // On what is so soft that the load would take it farther than a hand goes: as far as it goes.
            const double held = std::min(load, stiffness * PointerHandSettings{}.farthestMm);
            EXPECT_NEAR(force, held, 0.001 * held) << load << " N, " << stiffness << " N/mm";
            EXPECT_LT(most, 1.1 * load);
            EXPECT_LE(fastest, PointerHandSettings{}.approachMmS * 1.001);
            // A light hand comes down slowly, or it would knock with more than its load.
            const PointerHandSettings hand;
            const double speed = std::min({hand.approachMmS, load / hand.dampingNSPerMm, 20.0 * load});
            EXPECT_NEAR(touched, 0.5 / speed, 0.03);
        }
    }
}

TEST(PointerDevice, onASlopeTheTipStaysOnTheWayAndTheLoadIsTheForce) {
    for (const double load : {0.3, 1.0, 3.0}) {
        for (const double degrees : {20.0, 45.0, 70.0}) {
            const double angle = degrees * 3.14159265358979 / 180.0;
            const Vec3 normal(std::sin(angle), 0, std::cos(angle));
            for (const double period : {1e-3, 1.25e-4, 0.02}) {
                Alone alone(Vec3(0, 0, 0.3));
                alone.mailbox->write(targetAt(Vec3(0, 0, 0), load));
                double off = 0.0, force = 0.0;
                for (double t = 0.0; t < 3.0; t += period) {
                    const Vec3 at = alone.read(period);
                    force = alone.meet(at, Vec3::Zero(), normal, 2.0);
                    off = (at + force / 2.0 * normal).x();
                    ASSERT_TRUE(at.allFinite());
                }
                EXPECT_NEAR(off, 0.0, 0.003) << load << " N, " << degrees << " degrees, " << period << " s";
                EXPECT_NEAR(force, load, 0.02 * load) << degrees << " degrees, " << period << " s";
            }
        }
    }
}

TEST(PointerDevice, heldBackBesideThePointerItPullsThereWithTheLoad) {
    // A floor at z = 0 and a wall at x = 0, the pointer beyond it.
    for (const double beyond : {0.1, 0.3, 3.0}) {
        Alone alone(Vec3(-1, 0, 0.1));
        alone.mailbox->write(targetAt(Vec3(beyond, 0, 0), 0.5));
        Vec3 force = Vec3::Zero();
        for (int i = 0; i < 3000; ++i) {
            const Vec3 at = alone.read(), tip(std::min(at.x(), 0.0), at.y(), std::max(at.z(), 0.0));
            force = 2.0 * (tip - at);
            alone.hand.watch(tip, -force);
            alone.hand.command(force, Vec3::Zero());
        }
        EXPECT_NEAR(force.norm(), 0.5, 0.01) << beyond;
        EXPECT_GT(-force.x(), 0.45) << beyond;
        EXPECT_GE(force.z(), 0.0);
    }
}

// A head that rests on a tooth beside the bur holds it off: the tip stays a millimetre over the place, bears nothing,
// and the hand is told of what bears on the head.
TEST(PointerDevice, heldOffByTheHandpieceItStaysNear) {
    for (const double load : {0.1, 1.0, 3.0}) {
        Alone alone(Vec3(0, 0, 1));
        alone.mailbox->write(targetAt(Vec3(0, 0, 1), load));
        double most = 0.0, farthest = 0.0;
        for (int i = 0; i < 7000; ++i) {
            const Vec3 at = alone.read(), tip(at.x(), at.y(), std::max(at.z(), 1.0));
            const Vec3 force = 2.0 * (tip - at);
            alone.hand.watch(tip, -force);
            alone.hand.command(force, Vec3::Zero());
            most = std::max(most, force.norm());
            farthest = std::max(farthest, (tip - at).norm());
        }
        EXPECT_LT(most, 1.1 * load);
        EXPECT_LT(farthest, 1.1 * load / 2.0);
    }
    // Not even one that is told of nothing goes away.
    Alone deaf(Vec3(0, 0, 1));
    deaf.mailbox->write(targetAt(Vec3(0, 0, 1), 1.0));
    Vec3 at;
    for (int i = 0; i < 7000; ++i) {
        at = deaf.read();
        deaf.hand.watch(Vec3(0, 0, 1), Vec3::Zero());
    }
    EXPECT_LE((at - Vec3(0, 0, 1)).norm(), PointerHandSettings{}.farthestMm + 1e-9);
}

TEST(PointerDevice, leftBehindItComesUpToWhereTheStrokeBegan) {
    // A slot half a millimetre deep, its wall at x = 0; the pointer goes on beyond it.
    Alone alone(Vec3(-1, 0, 0.1));
    PointerTarget t = targetAt(Vec3(-1, 0, 0), 1.0);
    t.farMm = 0.5;
    t.passMm = 0.0;
    const auto tick = [&](double x) {
        t.positionMm[0] = x;
        alone.mailbox->write(t);
        const Vec3 at = alone.read();
        const bool isUp = at.z() >= 0.0;
        const Vec3 tip(isUp ? at.x() : std::min(at.x(), 0.0), at.y(), std::max(at.z(), -0.5));
        alone.hand.watch(tip, 2.0 * (at - tip));
        return tip;
    };
    Vec3 tip;
    for (int i = 0; i < 500; ++i)
        tip = tick(-1.0);
    EXPECT_NEAR(tip.z(), -0.5, 0.01);
    for (int i = 0; i < 1000; ++i)
        tip = tick(std::min(1.0, -1.0 + 0.004 * i));
    EXPECT_NEAR(tip.x(), 1.0, 0.05) << "it comes along";
}

// On its way out the head stands aslant in a tooth, with more than the load: the hand gives way beside it.
TEST(PointerDevice, comingOutItDoesNotPressTheHeadIntoATooth) {
    Alone alone(Vec3(0, 0, -0.9));
    PointerTarget target = targetAt(Vec3::Zero(), 1.0, 1.0);
    target.farMm = target.passMm = 0.0;
    alone.mailbox->write(target);
    const Vec3 normal = Vec3(0.6, 0.0, -0.8);
    double firstN = 0.0, mostN = 0.0, nowN = 0.0;
    for (int i = 0; i < 1000; ++i) {
        nowN = alone.meet(alone.read(), Vec3(0, 0, -1.8), normal, alone.hand.capability().maxStiffnessNPerMm);
        if (i == 0) firstN = nowN;
        mostN = std::max(mostN, nowN);
    }
    EXPECT_GT(firstN, 1.3);
    EXPECT_LE(mostN, firstN);
    EXPECT_LT(nowN, 1.1);
    EXPECT_GT(nowN, 0.5) << "it presses on, as far as the load goes";
}

TEST(PointerDevice, ledItGivesWayAcross) {
    // Out of a cavity whose wall leans: no force across stays.
    Alone alone;
    PointerTarget t = targetAt(Vec3(0, 0, 2), 1.0);
    t.way[2] = 1.0;
    t.farMm = 0.0;
    t.isLed = true;
    alone.mailbox->write(t);
    double sideways = 0.0;
    Vec3 at;
    for (int i = 0; i < 1000; ++i) {
        at = alone.read();
        const Vec3 tip(std::min(at.x(), -0.2 * at.z()), at.y(), at.z());
        alone.hand.watch(tip, 2.0 * (at - tip));
        sideways = std::max(sideways, 2.0 * (at - tip).norm());
    }
    EXPECT_NEAR(at.z(), 2.0, 0.02);
    EXPECT_NEAR(at.x(), -0.4, 0.02);
    EXPECT_LT(sideways, 0.15);
}

TEST(PointerDevice, itComesOutBeforeItGoesAcross) {
    Alone alone;
    (void)alone.read();
    PointerTarget t = targetAt(Vec3(4, 0, 3));
    t.way[2] = -1.0;
    alone.mailbox->write(t);
    Vec3 at;
    for (int i = 0; i < 400; ++i) {
        at = alone.read();
        if (at.z() < 2.0) {
            EXPECT_LT(at.x(), 0.3);
        }
    }
    EXPECT_LT((at - Vec3(4, 0, 3)).norm(), 0.01);
}

TEST(PointerDevice, theLoadNeverExceedsWhatTheDeviceCanHold) {
    Alone alone;
    alone.mailbox->write(targetAt(Vec3::Zero(), 50.0));
    double force = 0.0;
    for (int i = 0; i < 4000; ++i)
        force = alone.meet(alone.read(), Vec3::Zero(), Vec3::UnitZ(), 2.0);
    EXPECT_LT(force, 3.3);
    EXPECT_GT(force, 3.0);
}

TEST(PointerDevice, pullsNoHarderThanAHandWhenTheToothIsInItsWay) {
    // A wall at x = 1, the pointer 20 mm beyond it.
    const PointerHandSettings settings;
    Alone alone;
    alone.mailbox->write(targetAt(Vec3(21, 0, 0)));
    double force = 0.0;
    for (int i = 0; i < 1000; ++i) {
        force = std::max(0.0, 0.5 * (alone.read().x() - 1.0));
        alone.hand.command(Vec3(-std::min(force, 3.3), 0, 0), Vec3::Zero());
    }
    EXPECT_NEAR(force, settings.mostPullN, 0.02);
    // Back to where it is free: it lets go at once, with no memory of how far the pointer was.
    alone.mailbox->write(targetAt(Vec3(0.5, 0, 0)));
    alone.hand.command(Vec3::Zero(), Vec3::Zero());
    for (int i = 0; i < 100; ++i)
        (void)alone.read();
    EXPECT_NEAR(alone.read().x(), 0.5, 0.01);
}

TEST(PointerDevice, theEndOfTheWayEndsTheLoad) {
    for (const double load : {0.3, 1.0, 3.0}) {
        for (const double period : {1e-3, 1.25e-4, 0.05}) {
            Alone alone(Vec3(0, 0, 0.5));
            PointerTarget t = targetAt(Vec3(0, 0, 0.5), load);
            t.farMm = 1.5;
            alone.mailbox->write(t);
            double lowest = 0.0, z = 0.0;
            for (double passed = 0.0; passed < 2.0; passed += period) {
                const Vec3 at = alone.read(period);
                alone.hand.watch(at, Vec3::Zero());
                lowest = std::min(lowest, z = at.z());
            }
            EXPECT_NEAR(z, -1.0, 1e-3);
            EXPECT_GT(lowest, -1.01) << period;
        }
    }
}

TEST(PointerDevice, frozenStandsAndAwayLifts) {
    Alone alone(Vec3(0, 0, 5));
    PointerTarget t = targetAt(Vec3(3, 0, 5), 0.0, 1.0);
    t.frozen = true;
    alone.mailbox->write(t);
    for (int i = 0; i < 200; ++i)
        (void)alone.read();
    EXPECT_LT((alone.read() - Vec3(0, 0, 5)).norm(), 1e-9);
    t.frozen = false;
    t.away = true;
    t.loadN = 1.0;
    alone.mailbox->write(t);
    Reading r;
    for (int i = 0; i < 400; ++i)
        r = alone.hand.read(kPeriodS);
    EXPECT_EQ(r.pedal, 0.0);
    EXPECT_NEAR((r.burInTooth.positionMm - Vec3(0, 0, 10)).norm(), 0.0, 1e-3);
    t.away = false;
    t.loadN = 0.0;
    alone.mailbox->write(t);
    for (int i = 0; i < 400; ++i)
        r = alone.hand.read(kPeriodS);
    EXPECT_EQ(r.pedal, 1.0);
    EXPECT_NEAR((r.burInTooth.positionMm - Vec3(3, 0, 5)).norm(), 0.0, 1e-3);
}

TEST(PointerDevice, refusesWhatCannotBeSimulated) {
    const auto mailbox = std::make_shared<PointerMailbox>();
    const auto with = [&](auto change) {
        PointerHandSettings s;
        change(s);
        PointerDevice hand(s, mailbox, {});
    };
    EXPECT_NO_THROW(with([](auto&) {}));
    EXPECT_THROW(with([](auto& s) { s.massKg = 0; }), core::Error);
    EXPECT_THROW(with([](auto& s) { s.stiffnessNPerMm = std::nan(""); }), core::Error);
    EXPECT_THROW(with([](auto& s) { s.dampingNSPerMm = -1; }), core::Error);
    EXPECT_THROW(with([](auto& s) { s.travelMmS = 1e6; }), core::Error);
    EXPECT_THROW(with([](auto& s) { s.subStepS = 0; }), core::Error);
    EXPECT_THROW(PointerDevice({}, nullptr, {}), core::Error);
    EXPECT_THROW(PointerDevice({}, mailbox, {Vec3::Zero(), Quat(0, 0, 0, 0)}), core::Error);
}

// In the whole tick: a block whose top is z = 0, enamel to -1.2 mm, dentine below.
class PointerAtATooth : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        cases::Case made;
        made.name = "block";
        made.outer = test::boxMesh(Vec3(-3, -3, -3), Vec3(3, 3, 0));
        tooth::LoadSettings settings;
        settings.useCache = false;
        auto uncut = tooth::loadModel(made, settings);
        const field::TissueMap::PartFunction dentine{[](const Vec3& p) { return p.z() + 1.2; }, Tissue::dentine, 20};
        field::TissueMap tissues =
            field::TissueMap::fromFunctions(uncut->field, std::span(&dentine, 1), Tissue::enamel);
        base_ = tooth::withTissues(*uncut, std::move(tissues));
    }
    static void TearDownTestSuite() { base_.reset(); }

    struct Scene {
        std::shared_ptr<tooth::ToothState> field;
        std::shared_ptr<PointerMailbox> mailbox;
        std::unique_ptr<loop::HapticLoop> loop;
    };
    static loop::Work work(const std::shared_ptr<tooth::ToothState>& field) {
        const auto bur = std::make_shared<const instrument::Bur>(instrument::makeBur("cylinder-round:1.0x4.0"));
        return {contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(field), bur),
                std::make_unique<cutting::Cutter>(field, bur, instrument::CuttingParameters{}, cases::builtInTissues(),
                                                  cutting::Cutter::Settings{})};
    }
    static Scene scene(double rateHz, const Vec3& start = Vec3(0, 0, 0.5)) {
        Scene s;
        s.field = std::make_shared<tooth::ToothState>(base_);
        s.mailbox = std::make_shared<PointerMailbox>();
        loop::LoopSettings settings;
        settings.rateHz = rateHz;
        s.loop = std::make_unique<loop::HapticLoop>(
            settings, std::make_unique<PointerDevice>(PointerHandSettings{}, s.mailbox, Pose{start, Quat::Identity()}),
            work(s.field), force::defaultParameters());
        return s;
    }
    template <class Each>
    static void run(Scene& s, double seconds, Each&& each) {
        const auto ticks = static_cast<int>(std::lround(seconds / s.loop->periodS()));
        for (int i = 0; i < ticks; ++i) {
            s.loop->tick({});
            HapticSample sample;
            while (s.loop->samples().tryPop(sample))
                each(sample);
            tooth::BrickSnapshot brick;
            while (s.loop->bricks().tryPop(brick)) {
            }
        }
    }

    static inline std::shared_ptr<const tooth::ToothModel> base_;
};

TEST_F(PointerAtATooth, aLoadOnEnamelIsFeltAsThatLoadAtEveryRate) {
    for (const double rate : {1000.0, 2000.0, 4000.0, 8000.0}) {
        for (const double load : {0.1, 1.0, 3.0}) {
            Scene s = scene(rate);
            s.mailbox->write(targetAt(Vec3(0, 0, 0.5), load));
            double low = 1e9, high = 0.0, peak = 0.0, proxyZ = 0.0;
            run(s, 1.5, [&](const HapticSample& h) {
                const double f = Vec3(h.forceN.data()).norm();
                peak = std::max(peak, f);
                if (h.timeS < 1.0) return;
                low = std::min(low, f);
                high = std::max(high, f);
                proxyZ = h.proxyPositionMm[2];
                EXPECT_EQ(h.flags & (messages::kFault | messages::kInvalidPose), 0u);
            });
            EXPECT_NEAR(low, load, 0.02 * load) << rate << " Hz";
            EXPECT_NEAR(high, load, 0.02 * load) << rate << " Hz";
            EXPECT_LT(high - low, 0.002 * load) << rate << " Hz";
            EXPECT_LT(peak, 1.3 * load + 0.1) << rate << " Hz";
            EXPECT_NEAR(proxyZ, 0.0, 0.005);
        }
    }
}

TEST_F(PointerAtATooth, theProxySlidesWithThePointerWhilePressed) {
    for (const double rate : {1000.0, 4000.0}) {
        Scene s = scene(rate, Vec3(-2, 0, 0.5));
        PointerTarget t = targetAt(Vec3(-2, 0, 0.5), 1.0);
        s.mailbox->write(t);
        run(s, 0.6, [](const HapticSample&) {});
        double worst = 0.0;
        for (int i = 0; i < 200; ++i) {  // 10 mm/s for 0.2 s
            t.positionMm[0] = -2.0 + 0.01 * i;
            s.mailbox->write(t);
            run(s, 1e-3, [&](const HapticSample& h) {
                if (i > 60) worst = std::max(worst, t.positionMm[0] - h.proxyPositionMm[0]);
                EXPECT_NEAR(h.proxyPositionMm[2], 0.0, 0.005);
            });
        }
        // 12 ms at 10 mm/s, and what 0.12 N of friction holds back.
        EXPECT_LT(worst, 0.12 + 0.15);
    }
}

TEST_F(PointerAtATooth, aHeldButtonCutsAndADragCutsAGroove) {
    Scene s = scene(1000, Vec3(-1.5, 0, 0.5));
    PointerTarget t = targetAt(Vec3(-1.5, 0, 0.5), 1.0, 1.0);
    s.mailbox->write(t);
    HapticSample last;
    double peak = 0.0;
    const auto look = [&](const HapticSample& h) {
        peak = std::max(peak, Vec3(h.forceN.data()).norm());
        last = h;
    };
    run(s, 0.6, look);
    const double plunged = -last.proxyPositionMm[2];
    const double before = last.removedMm3[static_cast<std::size_t>(Tissue::enamel)];
    EXPECT_GT(plunged, 0.05);
    EXPECT_GT(before, 0.01);
    t.loadN = 0.3;                    // lightly sideways
    for (int i = 0; i < 4000; ++i) {  // 0.5 mm/s
        t.positionMm[0] = -1.5 + 0.0005 * i;
        s.mailbox->write(t);
        run(s, 1e-3, look);
    }
    std::printf("  sank %.3f mm in 0.6 s, dragged to %.3f of %.3f mm, peak %.2f N\n", plunged, last.proxyPositionMm[0],
                t.positionMm[0], peak);
    EXPECT_GT(last.removedMm3[static_cast<std::size_t>(Tissue::enamel)], 1.5 * before);
    EXPECT_GT(last.proxyPositionMm[0], -1.0);  // enamel gives way no faster
    EXPECT_LT(peak, 3.3);
}

TEST_F(PointerAtATooth, theStopHoldsTheFloor) {
    Scene s = scene(1000);
    PointerTarget t = targetAt(Vec3(0, 0, 0.5), 2.0, 1.0);
    t.farMm = 1.0;  // from 0.5 mm over the surface
    s.mailbox->write(t);
    HapticSample last;
    double deepest = 0.0;
    run(s, 6.0, [&](const HapticSample& h) {
        deepest = std::min(deepest, h.proxyPositionMm[2]);
        last = h;
    });
    std::printf("  floor at %.4f mm, deepest %.4f mm\n", -last.proxyPositionMm[2], -deepest);
    EXPECT_NEAR(deepest, -0.5, 0.02);
}

TEST_F(PointerAtATooth, aReplayOfItsReadingsGivesTheSameTicks) {
    Scene s = scene(1000, Vec3(-1, 0, 0.5));
    std::vector<HapticSample> live;
    const auto keep = [&](const HapticSample& h) { live.push_back(h); };
    PointerTarget t = targetAt(Vec3(-1, 0, 0.5), 1.0, 1.0);
    for (int i = 0; i < 1500; ++i) {
        t.positionMm[0] = -1.0 + 0.001 * i;
        t.positionMm[1] = 0.3 * std::sin(0.01 * i);
        t.loadN = i < 1200 ? 1.0 : 0.0;
        t.farMm = i < 1200 ? 10.0 : 0.0;
        if (i % 7 == 0) s.mailbox->write(t);
        run(s, 1e-3, keep);
    }
    std::vector<Reading> readings;
    for (const HapticSample& h : live) {
        Reading r;
        r.burInTooth.positionMm = Vec3(h.positionMm.data());
        r.burInTooth.orientation = Quat(h.orientation[0], h.orientation[1], h.orientation[2], h.orientation[3]);
        r.pedal = h.pedal;
        readings.push_back(r);
    }
    const auto field = std::make_shared<tooth::ToothState>(base_);
    loop::HapticLoop again({}, std::make_unique<ReplayDevice>(s.loop->device().capability(), readings), work(field),
                           force::defaultParameters());
    std::size_t i = 0, differing = 0;
    (void)runSimulated(again, 1.499, [&](const HapticSample& h) {
        ASSERT_LT(i, live.size());
        differing += h.forceN != live[i].forceN || h.proxyPositionMm != live[i].proxyPositionMm ||
                     h.removedMm3 != live[i].removedMm3 || h.speedRpm != live[i].speedRpm;
        ++i;
    });
    EXPECT_EQ(i, live.size());
    EXPECT_EQ(differing, 0u);
    EXPECT_GT(live.back().removedMm3[static_cast<std::size_t>(Tissue::enamel)], 0.01);
    EXPECT_EQ(field->stateHash(), s.field->stateHash());
}

TEST_F(PointerAtATooth, repeatsItselfBitForBit) {
    const auto end = [] {
        Scene s = scene(2000);
        s.mailbox->write(targetAt(Vec3(0.3, 0.2, 0.5), 1.0, 1.0));
        HapticSample last;
        run(s, 0.4, [&](const HapticSample& h) { last = h; });
        return std::make_pair(last.positionMm, s.field->stateHash());
    };
    EXPECT_EQ(end(), end());
}

TEST_F(PointerAtATooth, theTickNeitherAllocatesNorLocksNorWaits) {
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc: the trap is off";
    Scene s = scene(1000);
    PointerTarget t = targetAt(Vec3(0.5, 0, 0.5), 1.0, 1.0);
    const test::RealtimeTrap trap;
    for (int i = 0; i < 600; ++i) {
        t.frozen = i > 300 && i < 350;
        t.away = i > 500;
        t.farMm = i > 200 ? 0.7 : 10.0;
        t.isLed = i > 400 && i < 450;
        s.mailbox->write(t);
        s.loop->tick({});
    }
    EXPECT_EQ(trap.total(), 0u);
}

}  // namespace
}  // namespace handpiece::device::pointer_device_test
