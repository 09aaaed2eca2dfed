// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/fidelity/fidelity.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "handpiece/devices/drivers/simulated_driver.h"
#include "handpiece/devices/safety/injector.h"
#include "support/error_of.h"

namespace handpiece::fidelity::fidelity_test {
namespace {

/// An arm held still, in virtual time.
drivers::SimulatedSettings still() {
    drivers::SimulatedSettings s;
    const core::Pose held{{0.0, 0.0, 30.0}, core::Quat::Identity()};
    s.motion = device::Motion({{0.0, held, 0.0}, {1.0, held, 0.0}});
    s.stepped = true;
    return s;
}

Report checked(const drivers::SimulatedSettings& arm, CheckSettings settings, const std::string& faults = {},
               std::shared_ptr<safety::FaultLog> log = nullptr) {
    auto driver = std::make_unique<drivers::SimulatedDriver>(arm);
    drivers::SimulatedDriver* servo = driver.get();
    settings.nowNs = [servo] { return servo->nowNs(); };
    settings.advance = [servo](double periodS) { servo->step(periodS); };
    if (faults.empty() && !log) return check(std::move(driver), settings);
    return check(safety::withFaults(std::move(driver),
                                    faults.empty() ? std::vector<safety::Fault>{} : safety::parseFaults(faults), log),
                 settings);
}

const Finding& of(const Report& report, const std::string& id) {
    const auto f = std::find_if(report.findings.begin(), report.findings.end(),
                                [&](const Finding& finding) { return finding.id == id; });
    if (f == report.findings.end()) throw core::Error("no finding " + id);
    return *f;
}

double figure(const Report& report, const std::string& id, const std::string& name) {
    for (const auto& [key, value] : of(report, id).figures)
        if (key == name) return value;
    throw core::Error("no figure " + name + " in " + id);
}

CheckSettings lasting(double seconds) {
    CheckSettings s;
    s.durationS = seconds;
    return s;
}

TEST(Fidelity, findsTheDelayThatTheArmHas) {
    for (const double delayMs : {0.0, 2.0, 5.0}) {
        drivers::SimulatedSettings arm = still();
        arm.arm.delayS = 1e-3 * delayMs;
        arm.arm.capability.encoderStepMm = 0.002;
        const Report report = checked(arm, lasting(5.0));
        EXPECT_NEAR(figure(report, "round-trip-delay", "delay_ms"), delayMs,
                    std::max(0.7, figure(report, "round-trip-delay", "uncertainty_ms")))
            << config::words()(of(report, "round-trip-delay").value);
        EXPECT_LT(figure(report, "round-trip-delay", "uncertainty_ms"), 1.5);
        EXPECT_EQ(of(report, "round-trip-delay").verdict, delayMs > 3.0 ? Verdict::warn : Verdict::pass);
    }
}

TEST(Fidelity, findsItWithTheEncoderOfADesktopArmToo) {
    drivers::SimulatedSettings arm = still();
    arm.arm.delayS = 0.004;
    const Report report = checked(arm, lasting(6.0));
    EXPECT_NEAR(figure(report, "round-trip-delay", "delay_ms"), 4.0, 2.0)
        << config::words()(of(report, "round-trip-delay").value);
}

TEST(Fidelity, aWellArmPasses) {
    const Report report = checked(still(), lasting(4.0));
    EXPECT_TRUE(report.passed);
    EXPECT_EQ(report.device.driver, "simulated");
    EXPECT_NEAR(report.durationS, 4.0, 0.1);
    EXPECT_NEAR(figure(report, "servo-period", "rate_hz"), 1000.0, 1.0);
    EXPECT_EQ(of(report, "servo-period").verdict, Verdict::pass);
    EXPECT_EQ(of(report, "servo-gaps").verdict, Verdict::pass);
    EXPECT_NEAR(figure(report, "encoder-step", "step_um"), 55.0, 0.1);
    EXPECT_EQ(of(report, "encoder-step").verdict, Verdict::pass);
    EXPECT_EQ(of(report, "rest-noise").verdict, Verdict::pass);
    EXPECT_EQ(of(report, "force-slope").verdict, Verdict::pass);
    EXPECT_GT(figure(report, "force-slope", "steepest_n_per_s"), 300.0);
    EXPECT_LE(figure(report, "force-slope", "steepest_n_per_s"), 1.001 * device::Capability{}.maxForceSlopeNPerS);
    EXPECT_EQ(of(report, "troubles").verdict, Verdict::pass);
    // A wall of 0.5 N/mm is softer than what is taken for hard.
    EXPECT_EQ(of(report, "limits").verdict, Verdict::warn);
    // On virtual time nothing is late, and nothing is claimed of it.
    EXPECT_EQ(of(report, "tick-lateness").verdict, Verdict::notMeasured);
    for (const Finding& f : report.findings) {
        EXPECT_FALSE(f.value.empty()) << f.id;
        EXPECT_FALSE(f.against.empty()) << f.id;
        if (f.verdict == Verdict::warn || f.verdict == Verdict::fail) {
            EXPECT_FALSE(f.remedy.empty()) << f.id;
        }
    }
}

TEST(Fidelity, pushesOnlyWhenItMayAndNoHarderThanItSays) {
    const auto output = [](bool push) {
        const auto log = std::make_shared<safety::FaultLog>();
        CheckSettings settings = lasting(3.0);
        settings.push = push;
        std::vector<std::string> said;
        settings.announce = [&](const std::string& sentence) { said.push_back(sentence); };
        const Report report = checked(still(), settings, {}, log);
        EXPECT_EQ(of(report, "force-slope").verdict != Verdict::notMeasured, push);
        EXPECT_EQ(said.size(), push ? 2u : 1u);
        EXPECT_EQ(said.back().find("0.8 N") != std::string::npos, push) << said.back();
        EXPECT_GT(log->output().samples, 2000u);
        return log->output().largestN;
    };
    EXPECT_EQ(output(false), 0.0);
    EXPECT_NEAR(output(true), 0.8, 1e-6);
}

TEST(Fidelity, aTroubleIsToldInWordsAndFails) {
    const Report report = checked(still(), lasting(3.0), "error@1.2:0.1=0x0301");
    const Finding& troubles = of(report, "troubles");
    EXPECT_EQ(troubles.verdict, Verdict::fail);
    const std::string said = config::words()(troubles.value);
    EXPECT_NE(said.find("own software reports"), std::string::npos) << said;
    EXPECT_FALSE(troubles.remedy.empty());
    EXPECT_FALSE(report.passed);
}

TEST(Fidelity, aDeviceThatWasMovedHasNoNoise) {
    drivers::SimulatedSettings arm = still();
    arm.motion.reset();  // its own: circles
    CheckSettings settings = lasting(2.0);
    settings.push = false;
    EXPECT_EQ(of(checked(arm, settings), "rest-noise").verdict, Verdict::notMeasured);
}

TEST(Fidelity, runsOnTheWallClockToo) {
    drivers::SimulatedSettings arm = still();
    arm.stepped = false;
    CheckSettings settings = lasting(1.0);
    settings.push = false;
    int reports = 0;
    const Report report = check(std::make_unique<drivers::SimulatedDriver>(arm), settings, [&](double share) {
        EXPECT_GE(share, 0.0);
        EXPECT_LE(share, 1.0);
        ++reports;
        return true;
    });
    EXPECT_GT(reports, 3);
    EXPECT_NE(of(report, "tick-lateness").verdict, Verdict::notMeasured);
    EXPECT_FALSE(report.periodHistogramUs.empty());
    EXPECT_FALSE(report.latenessHistogramUs.empty());
    EXPECT_NE(report.machine.find("cores"), std::string::npos);
}

TEST(Fidelity, canBeStopped) {
    drivers::SimulatedSettings arm = still();
    arm.stepped = false;
    EXPECT_NE(test::errorOf([&] {
                  (void)check(std::make_unique<drivers::SimulatedDriver>(arm), lasting(300.0),
                              [](double) { return false; });
              }).find("cancelled"),
              std::string::npos);
}

/// A device that never tells anything.
class Silent final : public link::Driver {
  public:
    [[nodiscard]] const link::DriverInfo& info() const noexcept override { return info_; }
    void start(link::Servo&) override {}
    void stop() noexcept override {}

  private:
    link::DriverInfo info_{"silent", "Silent", "", "", {}, true, true, 1000.0, 0.0, 0.0, ""};
};

TEST(Fidelity, aSilentDeviceIsToldAsOne) {
    CheckSettings settings = lasting(2.0);
    std::int64_t now = 1;
    settings.nowNs = [&] { return now; };
    settings.advance = [&](double periodS) { now += static_cast<std::int64_t>(1e9 * periodS); };
    try {
        (void)check(std::make_unique<Silent>(), settings);
        FAIL();
    } catch (const core::Error& e) {
        EXPECT_EQ(e.id(), "no-reading");
        EXPECT_FALSE(e.remedy().empty());
    }
}

TEST(Fidelity, settingsOutOfRangeAreRefused) {
    CheckSettings s = lasting(1.5);
    EXPECT_NE(test::errorOf([&] { (void)checked(still(), s); }).find("duration"), std::string::npos);
    s = lasting(1e9);
    EXPECT_NE(test::errorOf([&] { (void)checked(still(), s); }).find("duration"), std::string::npos);
    s = lasting(3.0);
    s.rateHz = 50.0;
    EXPECT_NE(test::errorOf([&] { (void)checked(still(), s); }).find("rate"), std::string::npos);
}

}  // namespace
}  // namespace handpiece::fidelity::fidelity_test
