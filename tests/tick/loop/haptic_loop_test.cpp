// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/loop/loop_run.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <limits>
#include <thread>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/tick/device/simulated_device.h"
#include "support/realtime_trap.h"
#include "tick/force/analytic_methods.h"

namespace handpiece::loop::haptic_loop_test {
namespace {

using core::Pose;
using core::Quat;
using core::Vec3;
using messages::HapticSample;

constexpr double kRadius = 0.5, kLength = 4.0;

std::unique_ptr<contact::Method> planeMethod(cases::Tissue tissue = cases::Tissue::enamel) {
    return std::make_unique<test::AnalyticMethod>(test::plane(), kRadius, kLength, tissue);
}
std::unique_ptr<device::Device> handThatPresses(double depthMm = 4.0,
                                                const device::SimulatedDeviceSettings& settings = {}) {
    return std::make_unique<device::SimulatedDevice>(
        settings, device::press({Vec3(0, 0, 2), Quat::Identity()}, {0, 0, -1}, 2.0 + depthMm, 30.0, 0.3));
}
HapticLoop makeLoop(double rateHz = 1000) {
    LoopSettings settings;
    settings.rateHz = rateHz;
    return {settings, handThatPresses(), planeMethod(), force::defaultParameters()};
}

/// Everything of a sample but the times it took.
std::uint64_t stateHash(HapticSample sample) {
    sample.workUs = sample.lateUs = 0;
    core::Hasher h;
    for (const auto* a : {&sample.positionMm, &sample.velocityMmS, &sample.forceN, &sample.torqueNmm,
                          &sample.truePositionMm, &sample.proxyPositionMm, &sample.appliedForceN}) {
        for (const double v : *a)
            h.add(v);
    }
    h.add(sample.tick);
    h.add(sample.depthMm);
    h.add(sample.contactAreaMm2);
    h.add(sample.flags);
    return h.value();
}

TEST(HapticLoop, aHandPressesOnAPlaneAndFeelsIt) {
    HapticLoop loop = makeLoop();
    std::vector<HapticSample> samples;
    const RunReport report = runSimulated(loop, 0.6, [&](const HapticSample& s) { samples.push_back(s); });
    ASSERT_EQ(samples.size(), 601u);
    EXPECT_EQ(report.ticks, 601u);
    EXPECT_EQ(report.queueOverflow, 0u);
    double peak = 0.0, deepestProxy = 10.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        EXPECT_EQ(samples[i].tick, i);
        EXPECT_DOUBLE_EQ(samples[i].timeS, 1e-3 * static_cast<double>(i));
        EXPECT_EQ(samples[i].appliedForceN, samples[i].forceN);  // no delay
        peak = std::max(peak, samples[i].forceN[2]);
        deepestProxy = std::min(deepestProxy, samples[i].proxyPositionMm[2]);
    }
    EXPECT_EQ(samples.front().forceN[2], 0.0);
    EXPECT_LT(samples.front().depthMm, -1.9);
    // The hand wants 4 mm deeper: its 0.3 N/mm against our 0.5 settle near 0.3 x 0.5 / 0.8 x 4 = 0.75 N, friction
    // aside.
    EXPECT_NEAR(samples[500].forceN[2], 0.75, 0.3);
    EXPECT_GT(peak, 0.5);
    EXPECT_GT(deepestProxy, -0.002);
    EXPECT_EQ(samples[500].tissue, static_cast<std::uint8_t>(cases::Tissue::enamel));
    EXPECT_GT(samples[500].contactAreaMm2, 0.0);
    EXPECT_EQ(samples[500].patchCount, 1);
    EXPECT_GT(report.workUs.p50, 0.0);
}

TEST(HapticLoop, repeatsItselfBitForBitAtEveryRate) {
    for (const double rate : {1000.0, 2000.0, 4000.0, 8000.0}) {
        const auto run = [&] {
            HapticLoop loop = makeLoop(rate);
            core::Hasher all;
            std::uint64_t count = 0;
            (void)runSimulated(loop, 0.3, [&](const HapticSample& s) {
                all.add(stateHash(s));
                ++count;
            });
            EXPECT_EQ(count, static_cast<std::uint64_t>(std::lround(0.3 * rate)) + 1);
            return all.value();
        };
        EXPECT_EQ(run(), run()) << rate;
    }
}

TEST(HapticLoop, theTickNeitherAllocatesNorLocksNorWaits) {
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc: the trap is off";
    for (const force::LawId mode : {force::LawId::proxy, force::LawId::penalty}) {
        force::Parameters parameters = force::defaultParameters();
        parameters.law = mode;
        HapticLoop loop(LoopSettings{}, handThatPresses(), planeMethod(), parameters);
        loop.tick({});
        loop.setParameters(parameters);
        loop.setMethod(planeMethod());
        const test::RealtimeTrap trap;
        for (int i = 0; i < 600; ++i)
            loop.tick({});
        EXPECT_EQ(trap.total(), 0u);
    }
}

TEST(HapticLoop, takesAnotherToothAndOtherParametersBetweenTwoTicks) {
    device::SimulatedDeviceSettings rigid;
    rigid.rigidHand = true;
    const auto height = [](double z) { return core::Pose{Vec3(0, 0, z), Quat::Identity()}; };
    device::Motion motion(
        {{0.0, height(1.0)}, {0.2, height(-0.8)}, {1.0, height(-0.8)}, {1.1, height(0.1)}, {1.2, height(-0.8)}});
    HapticLoop loop(LoopSettings{}, std::make_unique<device::SimulatedDevice>(rigid, std::move(motion)), planeMethod(),
                    force::defaultParameters());
    HapticSample last;
    const auto keep = [&](const HapticSample& s) { last = s; };
    (void)runSimulated(loop, 0.5, keep);
    EXPECT_NEAR(last.forceN[2], 0.5 * 0.8, 1e-3);
    force::Parameters softer = force::defaultParameters();
    softer.stiffnessMultiplier = 0.5;
    loop.setParameters(softer);
    (void)runSimulated(loop, 0.1, keep);
    EXPECT_NEAR(last.forceN[2], 0.25 * 0.8, 1e-3);
    loop.setMethod(planeMethod(cases::Tissue::dentine));
    double before = last.forceN[2], worstRise = 0.0, whileWaiting = 0.0;
    int waited = 0, clear = 0;
    (void)runSimulated(loop, 1.0, [&](const HapticSample& s) {
        const bool waits = (s.flags & messages::kWaiting) != 0;
        waited += waits;
        clear += s.depthMm <= 0.0;
        if (waited > 5 && waits) whileWaiting = std::max(whileWaiting, std::abs(s.forceN[2]));
        worstRise = std::max(worstRise, s.forceN[2] - before);
        before = s.forceN[2];
        last = s;
    });
    EXPECT_GT(waited, 300);  // the bur was in the new tooth
    EXPECT_GT(clear, 0);
    EXPECT_EQ(whileWaiting, 0.0);
    EXPECT_LE(worstRise, 0.005);  // and is faded in
    EXPECT_EQ(last.tissue, static_cast<std::uint8_t>(cases::Tissue::dentine));
    EXPECT_NEAR(last.forceN[2], 0.25 * cases::properties(cases::Tissue::dentine).stiffnessFraction * 0.8, 1e-3);
}

/// A device that reports a jump and then is lost.
class BadDevice final : public device::Device {
  public:
    const device::Capability& capability() const noexcept override { return capability_; }
    device::Reading read(double) noexcept override {
        device::Reading r;
        r.burInTooth.positionMm = Vec3(0, 0, -1);
        if (tick_ == 400) r.burInTooth.positionMm.x() = 10'000;  // 10 m
        if (tick_ >= 800 && tick_ < 900) r.status = device::ReadStatus::lost;
        if (tick_ == 1300) r.burInTooth.positionMm.z() = std::numeric_limits<double>::quiet_NaN();
        ++tick_;
        return r;
    }
    void command(const Vec3& f, const Vec3&) noexcept override { force_ = f; }
    Vec3 truePositionMm() const noexcept override { return Vec3::Zero(); }
    Vec3 appliedForceN() const noexcept override { return force_; }

  private:
    device::Capability capability_;
    int tick_ = 0;
    Vec3 force_ = Vec3::Zero();
};

TEST(HapticLoop, anyDoubtEndsInZeroForceAndAFlag) {
    HapticLoop loop(LoopSettings{}, std::make_unique<BadDevice>(), planeMethod(), force::defaultParameters());
    std::vector<HapticSample> s;
    (void)runSimulated(loop, 1.8, [&](const HapticSample& sample) { s.push_back(sample); });
    for (const std::size_t fault : {400u, 800u, 1300u}) {
        EXPECT_GT(s[fault - 1].forceN[2], 0.4);
        EXPECT_EQ(s[fault - 1].flags & (messages::kInvalidPose | messages::kFault), 0u);
        EXPECT_NE(s[fault].flags & messages::kInvalidPose, 0u);
        EXPECT_NE(s[fault].flags & messages::kFault, 0u);
        EXPECT_EQ(s[fault + 15].forceN[2], 0.0);
        EXPECT_NE(s[fault + 15].flags & messages::kFault, 0u);
        for (std::size_t i = fault; i < fault + 300; ++i) {
            EXPECT_TRUE(std::isfinite(s[i].forceN[2]));
            EXPECT_LE(std::abs(s[i].forceN[2] - s[i - 1].forceN[2]), 0.06);
        }
    }
    EXPECT_EQ(s.back().flags, 0u);
}

TEST(HapticLoop, countsSamplesNobodyFetches) {
    LoopSettings settings;
    settings.queueCapacity = 16;
    HapticLoop loop(settings, handThatPresses(), planeMethod(), force::defaultParameters());
    for (int i = 0; i < 100; ++i)
        loop.tick({});
    EXPECT_EQ(loop.samples().overflowCount(), 84u);
}

TEST(HapticLoop, runsOnTheWallClockAndSaysUnderWhichScheduler) {
    HapticLoop loop = makeLoop(1000);
    std::uint64_t last = 0, count = 0;
    bool ordered = true;
    const RunReport report = runRealTime(loop, 0.25, [&](const HapticSample& s) {
        ordered = ordered && (count == 0 || s.tick > last);
        last = s.tick;
        ++count;
    });
    EXPECT_TRUE(ordered);
    EXPECT_EQ(report.ticks, count);
    EXPECT_EQ(report.queueOverflow, 0u);
    EXPECT_GE(report.ticks + report.missedPeriods, 251u);
    EXPECT_NE(report.scheduling.scheduling, rt::Scheduling::notAsked);
    EXPECT_NE(report.scheduling.line().find("real-time scheduling"), std::string::npos);
    EXPECT_LE(report.lateTicks, report.ticks);
    EXPECT_GE(report.latenessUs.max, report.latenessUs.p50);
}

TEST(HapticLoop, parametersChangeWhileItRunsOnTheWallClock) {
    HapticLoop loop = makeLoop(2000);
    std::atomic<bool> begun{false};
    std::atomic<std::uint64_t> taken{0};
    std::thread person([&] {
        const auto pause = [] { std::this_thread::sleep_for(std::chrono::milliseconds(2)); };
        while (!begun)
            pause();
        force::Parameters p = force::defaultParameters();
        std::uint64_t given = 0;
        for (int i = 0; i < 100; ++i) {
            p.stiffnessMultiplier = 0.5 + 0.005 * i;
            given = loop.setParameters(p);
            if (i % 10 == 0) given = loop.setMethod(planeMethod());
            pause();
        }
        while (taken < given)
            pause();
        loop.requestStop();
    });
    const RunReport report = runRealTime(loop, 600.0, [&](const HapticSample& s) {
        begun = true;
        taken = s.lastCommand;
    });
    person.join();
    EXPECT_GT(report.ticks, 0u);
    EXPECT_LT(report.ticks, 600u * 2000u);
    EXPECT_EQ(taken, 110u);
}

TEST(HapticLoop, aFailingListenerEndsTheRun) {
    HapticLoop loop = makeLoop();
    EXPECT_THROW((void)runRealTime(loop, 30.0, [](const HapticSample&) { throw core::Error("the disk is full"); }),
                 core::Error);
}

TEST(HapticLoop, refusesRatesThatCannotBeRun) {
    for (const double rate :
         {0.0, -1000.0, 1e9, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        EXPECT_THROW((void)makeLoop(rate), core::Error) << rate;
    }
    EXPECT_THROW(HapticLoop(LoopSettings{}, nullptr, planeMethod(), force::defaultParameters()), core::Error);
    EXPECT_THROW(HapticLoop(LoopSettings{}, handThatPresses(), nullptr, force::defaultParameters()), core::Error);
    HapticLoop loop = makeLoop();
    EXPECT_THROW((void)runSimulated(loop, 0.0), core::Error);
    EXPECT_THROW((void)runSimulated(loop, -1.0), core::Error);
    EXPECT_THROW((void)runSimulated(loop, std::numeric_limits<double>::quiet_NaN()), core::Error);
    force::Parameters bad = force::defaultParameters();
    bad.dampingMultiplier = -1;
    EXPECT_THROW(loop.setParameters(bad), core::Error);
}

}  // namespace
}  // namespace handpiece::loop::haptic_loop_test
