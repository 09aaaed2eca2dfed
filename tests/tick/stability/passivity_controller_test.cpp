// SPDX-License-Identifier: Apache-2.0
// The controller in the closed loop of hand, simulated arm and wall. What is judged is the arm's own exact work and its
// force's total variation: at every tick sum F dx <= step/2 TV(F), the bound without any allowance for motion.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "handpiece/base/core/hash.h"
#include "handpiece/tick/device/passing_device.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/loop/loop_run.h"
#include "studies/plane_method.h"
#include "studies/shaped_device.h"
#include "support/random.h"

namespace handpiece::stability::passivity_controller_test {
namespace {

using core::Vec3;

/// Loses the pose now and then, as a real arm's driver does.
class Losing final : public device::PassingDevice {
  public:
    Losing(std::unique_ptr<device::Device> inner, int every, int ticks)
        : PassingDevice(std::move(inner)), every_(every), ticks_(ticks) {}
    device::Reading read(double periodS) noexcept override {
        device::Reading reading = PassingDevice::read(periodS);
        if (++count_ % every_ < ticks_) reading.status = device::ReadStatus::lost;
        return reading;
    }

  private:
    int every_, ticks_, count_ = 0;
};

struct Case {
    double stiffness = 0.5, friction = 0.05, delay = 0.003, rate = 1000.0, assumedDelay = 0.003;
    device::Hand hand = device::handByName("loose");
    int loseEvery = 0, loseTicks = 0;
    bool controlled = true;
    std::vector<device::TimedPose> poses;
};
struct Result {
    double margin = 1e9, peak = 0.0, rest = 0.0, ripple = 0.0;
    std::uint64_t engaged = 0, bits = 0;
};

std::vector<device::TimedPose> tap(const Case& c) {
    const double depth = 1.0 / c.hand.stiffnessNPerMm + 1.0 / c.stiffness, down = (0.5 + depth) / 60.0;
    const auto pose = [](double t, double z) {
        return device::TimedPose{t, {Vec3(0, 0, z), core::Quat::Identity()}, 0.0};
    };
    return {pose(0, 0.5), pose(down, -depth), pose(down + 1.0, -depth)};
}

Result run(const Case& c) {
    device::SimulatedDeviceSettings settings;
    settings.capability.maxStiffnessNPerMm = c.stiffness;
    settings.frictionN = c.friction;
    settings.delayS = c.delay;
    settings.hand = c.hand;
    device::Motion motion(c.poses.empty() ? tap(c) : c.poses);
    const double duration = motion.durationS();
    auto owned = std::make_unique<device::SimulatedDevice>(settings, std::move(motion));
    const device::SimulatedDevice& arm = *owned;
    std::unique_ptr<device::Device> inner = std::move(owned);
    if (c.loseEvery > 0) inner = std::make_unique<Losing>(std::move(inner), c.loseEvery, c.loseTicks);
    ShaperSettings shaping = studies::shaperSettingsFor(settings.capability);
    shaping.passivityController = c.controlled;
    shaping.thermalBudget = false;
    shaping.delayS = c.assumedDelay;
    auto shaped = std::make_unique<studies::ShapedDevice>(std::move(inner), shaping);
    const studies::ShapedDevice& sent = *shaped;
    loop::LoopSettings loopSettings;
    loopSettings.rateHz = c.rate;
    loopSettings.queueCapacity = 16;
    loop::HapticLoop loop(loopSettings, std::move(shaped),
                          std::make_unique<studies::PlaneMethod>(cases::Tissue::enamel), force::defaultParameters());
    Result r;
    double low = 1e9, high = -1e9;
    core::Hasher hash;
    (void)runSimulated(loop, duration, [&](const messages::HapticSample& s) {
        r.margin =
            std::min(r.margin, 0.5 * settings.capability.encoderStepMm * arm.forceVariationN() - arm.appliedWorkNmm());
        const double size = sent.sentN().norm();
        r.peak = std::max(r.peak, size);
        hash.add(size);
        if (s.timeS > duration - 0.3) {
            low = std::min(low, size);
            high = std::max(high, size);
            r.rest = size;
        }
    });
    r.ripple = high - low;
    r.engaged = sent.status().engaged;
    r.bits = hash.value();
    return r;
}

TEST(PassivityController, holdsWhereTheBareLoopDoesNot) {
    Case c;
    c.stiffness = 5.0;
    c.controlled = false;
    const Result bare = run(c);
    EXPECT_LT(bare.margin, -10.0);
    EXPECT_GT(bare.ripple, 1.0);
    c.controlled = true;
    const Result held = run(c);
    std::printf("  5 N/mm, 3 ms, loose: margin %.3f N mm without, %.4f with; ripple %.2f and %.2f N\n", bare.margin,
                held.margin, bare.ripple, held.ripple);
    EXPECT_GE(held.margin, -1e-9);
    EXPECT_GT(held.peak, 0.3) << "it holds by controlling, not by giving up";
}

TEST(PassivityController, leavesAPassiveContactAlone) {
    // At the arm's own limit and the delay of a good station: not a bit of the force is changed.
    for (const char* hand : {"loose", "normal", "stiff"})
        for (const double rate : {1000.0, 4000.0}) {
            Case c;
            c.hand = device::handByName(hand);
            c.delay = c.assumedDelay = 0.001;
            c.rate = rate;
            c.controlled = false;
            const Result bare = run(c);
            c.controlled = true;
            const Result held = run(c);
            EXPECT_GE(bare.margin, -1e-9);
            EXPECT_EQ(held.engaged, 0u) << hand << ", " << rate << " Hz";
            EXPECT_EQ(held.bits, bare.bits) << hand << ", " << rate << " Hz";
        }
}

TEST(PassivityController, holdsInRandomHandsAndMotions) {
    std::mt19937_64 random(test::seed());
#ifdef HANDPIECE_SANITIZED
    constexpr int kCases = 15;
#else
    constexpr int kCases = 60;
#endif
    int bareHeld = 0, held = 0;
    for (int i = 0; i < kCases; ++i) {
        Case c;
        const auto log = [&](double from, double to) {
            return from * std::pow(to / from, test::uniform(random, 0.0, 1.0));
        };
        c.stiffness = log(0.1, 5.0);
        c.friction = log(0.05, 0.3);
        c.rate = log(500.0, 8000.0);
        c.delay = test::uniform(random, 0.0, 0.003);
        c.assumedDelay = test::uniform(random, 0.0, 1.0) < 0.5 ? 0.003 : c.delay;
        const double firm = test::uniform(random, 0.0, 1.0);  // from the loose to the stiff hand
        c.hand = {"random", 0.01 * std::pow(10.0, firm), 0.0005 * std::pow(20.0, firm), 0.05 * std::pow(20.0, firm)};
        double t = 0.0;
        Vec3 at(0.0, 0.0, 0.5);
        c.poses.push_back({t, {at, core::Quat::Identity()}, 0.0});
        for (int leg = 0; leg < 8; ++leg) {
            const double deepest = -(test::uniform(random, 0.1, 2.0) / c.hand.stiffnessNPerMm + 1.0 / c.stiffness);
            const Vec3 to(test::uniform(random, -3.0, 3.0), test::uniform(random, -3.0, 3.0),
                          leg % 3 == 2 ? 0.5 : deepest);
            t += (to - at).norm() / log(5.0, 80.0);
            at = to;
            c.poses.push_back({t, {at, core::Quat::Identity()}, 0.0});
            t += test::uniform(random, 0.01, 0.2);
            c.poses.push_back({t, {at, core::Quat::Identity()}, 0.0});
        }
        const Result with = run(c);
        c.controlled = false;
        bareHeld += run(c).margin >= -1e-9;
        held += with.margin >= -1e-9;
        EXPECT_GE(with.margin, -1e-9) << "case " << i << ": " << c.stiffness << " N/mm, " << c.friction << " N, "
                                      << c.delay << " s (told " << c.assumedDelay << "), " << c.rate << " Hz, hand "
                                      << c.hand.stiffnessNPerMm << " N/mm";
    }
    std::printf("  %d random loops: %d hold without the controller, %d with\n", kCases, bareHeld, held);
    EXPECT_LT(bareHeld, kCases);
}

/// A bur caught in its own cavity: it is pulled back to the middle from all sides. A late pull feeds a whirl around it.
double whirlMargin(double rateHz, bool controlled) {
    constexpr double kDelayS = 0.003, kStiffness = 1.0, kMaxN = 3.3;
    device::SimulatedDeviceSettings settings;
    settings.frictionN = 0.05;
    settings.delayS = kDelayS;
    settings.hand = device::handByName("loose");
    const auto pose = [](double t, double x, double y) {
        return device::TimedPose{t, {Vec3(x, y, 0), core::Quat::Identity()}, 0.0};
    };
    // Once around sets it off; then the hand holds still.
    device::SimulatedDevice arm(settings,
                                device::Motion({pose(0, 0, 0), pose(0.02, 4, 0), pose(0.04, 0, 4), pose(0.06, -4, 0),
                                                pose(0.08, 0, -4), pose(0.1, 0, 0), pose(1.5, 0, 0)}));
    PassivityController controller;
    controller.set({settings.capability.encoderStepMm, kDelayS, settings.massKg, 0.5});
    double margin = 1e9;
    for (int i = 0; i < static_cast<int>(1.5 * rateHz); ++i) {
        const Vec3 read = arm.read(1.0 / rateHz).burInTooth.positionMm;
        margin =
            std::min(margin, 0.5 * settings.capability.encoderStepMm * arm.forceVariationN() - arm.appliedWorkNmm());
        Vec3 wanted = -kStiffness * read;
        if (wanted.norm() > kMaxN) wanted *= kMaxN / wanted.norm();
        arm.command(controller.pass(read, wanted, 1.0 / rateHz, i == 0, controlled).forceN, Vec3::Zero());
    }
    return margin;
}

TEST(PassivityController, doesNotFeedAWhirl) {
    for (const double rate : {500.0, 1000.0, 4000.0, 8000.0}) {
        const double bare = whirlMargin(rate, false), held = whirlMargin(rate, true);
        std::printf("  %.0f Hz: margin %.3f N mm without, %.4f with\n", rate, bare, held);
        EXPECT_LT(bare, -1.0);
        EXPECT_GE(held, -1e-9);
    }
}

TEST(PassivityController, survivesLostPoses) {
    for (const double stiffness : {0.5, 5.0}) {
        Case c;
        c.stiffness = stiffness;
        c.loseEvery = 97;
        c.loseTicks = 3;
        const Result r = run(c);
        EXPECT_GE(r.margin, -1e-9) << stiffness;
        EXPECT_TRUE(std::isfinite(r.peak));
    }
}

TEST(PassivityController, freshInContactTheForceComesBackAsTheHandPresses) {
    // A clutch let go while pressed 2 mm into a wall of 2 N/mm: no energy is known but what a step of the
    // encoder explains, so half the force at most.
    Shaper shaper{ShaperSettings{}};
    Vec3 sent = shaper.shape(Vec3(0, 0, -2.0), Vec3(0, 0, 3.3), 1e-3, true);
    EXPECT_LT(sent.z(), 1.7);
    double z = -2.0;
    for (int i = 0; i < 100; ++i) {
        z -= 0.01;
        sent = shaper.shape(Vec3(0, 0, z), Vec3(0, 0, 3.3), 1e-3, false);
    }
    EXPECT_NEAR(sent.z(), 3.3, 1e-9);
}

TEST(PassivityController, aLateTickCountsTheForceThatWentOnActing) {
    PassivityController a, b;
    const PassivityController::Device device{0.055, 0.002, 0.045, 0.5};
    a.set(device);
    b.set(device);
    const Vec3 force(0, 0, 0.4);
    for (int i = 0; i < 50; ++i) {
        const Vec3 x(0, 0, -0.055 * i);
        (void)a.pass(x, force, 1e-3, i == 0, false);
        (void)b.pass(x, force, 1e-3, i == 0, false);
    }
    // Three periods at rest, or one that is three long.
    const Vec3 x(0, 0, -0.055 * 49);
    for (int i = 0; i < 3; ++i)
        (void)a.pass(x, force, 1e-3, false, false);
    (void)b.pass(x, force, 3e-3, false, false);
    EXPECT_NEAR(a.storedNmm(), b.storedNmm(), 1e-12);
    EXPECT_GT(a.storedNmm(), 0.4 * 0.055 * 40);
}

TEST(PassivityController, sameInputsSameBits) {
    Case c;
    c.stiffness = 3.0;
    EXPECT_EQ(run(c).bits, run(c).bits);
}

}  // namespace
}  // namespace handpiece::stability::passivity_controller_test
