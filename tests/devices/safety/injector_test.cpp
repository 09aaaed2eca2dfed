// SPDX-License-Identifier: Apache-2.0
// Faults on purpose: what is typed, and that each of them truly reaches the gate.
#include "handpiece/devices/safety/injector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>

#include "handpiece/base/core/error.h"

namespace handpiece::safety::injector_test {
namespace {

using link::DeviceFault;
using link::DriverCommand;
using link::DriverReading;

TEST(Faults, areReadAsTyped) {
    const auto faults = parseFaults("unplug@2.5, stall@3:0.2, jump@4=-0.5,error@5:0.1=0x0301 ,tick@1:0.02");
    ASSERT_EQ(faults.size(), 5u);
    EXPECT_EQ(faults[0].kind, FaultKind::tickStall);  // in the order of their times
    EXPECT_EQ(faults[0].lastsS, 0.02);
    EXPECT_EQ(faults[1].kind, FaultKind::unplug);
    EXPECT_EQ(faults[1].atS, 2.5);
    EXPECT_EQ(faults[1].lastsS, 0.1);
    EXPECT_EQ(faults[2].kind, FaultKind::stall);
    EXPECT_EQ(faults[2].lastsS, 0.2);
    EXPECT_EQ(faults[3].size, -0.5);
    EXPECT_EQ(faults[4].kind, FaultKind::error);
    EXPECT_EQ(faults[4].size, 0x0301);
    for (std::size_t k = 0; k < kFaultKinds; ++k) {
        const auto kind = static_cast<FaultKind>(k);
        EXPECT_EQ(parseFaults(std::string(nameOf(kind)) + "@1").front().kind, kind);
    }
}

TEST(Faults, atRandomAreTheSameForTheSameSeed) {
    const auto faults = parseFaults("random:300:seed=7:every=0.15:from=2");
    ASSERT_EQ(faults.size(), 300u);
    EXPECT_EQ(faults.front().atS, 2.0);
    std::array<int, kFaultKinds> counts{};
    for (std::size_t i = 0; i < faults.size(); ++i) {
        ++counts[static_cast<std::size_t>(faults[i].kind)];
        if (i > 0) {
            EXPECT_GT(faults[i].atS, faults[i - 1].atS + faults[i - 1].lastsS);
        }
        if (faults[i].kind == FaultKind::stall) {
            EXPECT_GE(faults[i].lastsS, 0.005);
            EXPECT_LE(faults[i].lastsS, 0.5);
        }
    }
    for (const int count : counts)
        EXPECT_GT(count, 15);
    const auto again = parseFaults("random:300:seed=7:every=0.15:from=2");
    const auto others = parseFaults("random:300:seed=8:every=0.15:from=2");
    EXPECT_TRUE(std::equal(faults.begin(), faults.end(), again.begin(), [](const Fault& a, const Fault& b) {
        return a.kind == b.kind && a.atS == b.atS && a.lastsS == b.lastsS && a.size == b.size;
    }));
    EXPECT_NE(others.back().atS, faults.back().atS);
    for (const Fault& fault : parseFaults("random:50:kinds=nan+stall"))
        EXPECT_TRUE(fault.kind == FaultKind::notANumber || fault.kind == FaultKind::stall);
}

TEST(Faults, aMistakeIsShownWhereItIs) {
    const auto where = [](const char* specification) {
        try {
            (void)parseFaults(specification);
        } catch (const core::Error& error) {
            EXPECT_EQ(error.id(), "bad-faults") << specification;
            EXPECT_FALSE(error.remedy().empty());
            return error.arguments().at(1);
        }
        return std::string("taken");
    };
    EXPECT_EQ(where(""), "1");
    EXPECT_EQ(where("unplg@2"), "1");
    EXPECT_EQ(where("unplug"), "7");
    EXPECT_EQ(where("unplug@"), "8");
    EXPECT_EQ(where("unplug@x"), "8");
    EXPECT_EQ(where("unplug@-1"), "8");
    EXPECT_EQ(where("unplug@nan"), "8");
    EXPECT_EQ(where("unplug@1:0"), "10");
    EXPECT_EQ(where("unplug@1, "), "11");
    EXPECT_EQ(where("unplug@1 jump@2"), "10");
    EXPECT_EQ(where("error@1=0xzz"), "9");
    EXPECT_EQ(where("random"), "7");
    EXPECT_EQ(where("random:0"), "8");
    EXPECT_EQ(where("random:10:sed=1"), "11");
    EXPECT_EQ(where("random:10:kinds=nan+stal"), "21");
    EXPECT_EQ(where("random:10:every=0"), "17");
}

/// A driver that is stepped by hand.
class Puppet final : public link::Driver {
  public:
    explicit Puppet(Puppet** self) { *self = this; }
    [[nodiscard]] const link::DriverInfo& info() const noexcept override { return info_; }
    void start(link::Servo& servo) override { servo_ = &servo; }
    void stop() noexcept override { servo_ = nullptr; }
    void relax() noexcept override { relaxed = true; }
    DriverCommand step() {
        reading.timeNs += 1'000'000;
        ++reading.frame;
        return servo_->exchange(reading);
    }
    DriverReading reading;
    bool relaxed = false;

  private:
    link::DriverInfo info_;
    link::Servo* servo_ = nullptr;
};

/// What the gate would see.
class Ear final : public link::Servo {
  public:
    [[nodiscard]] DriverCommand exchange(const DriverReading& reading) noexcept override {
        heard = reading;
        ++calls;
        DriverCommand command;
        command.timeNs = reading.timeNs;
        command.forceN = {1, 0, 0};
        return command;
    }
    DriverReading heard;
    int calls = 0;
};

TEST(Faults, reachTheGateAndEnd) {
    const auto with = [](const char* faults, const std::function<void(Puppet&, Ear&, link::Driver&)>& look) {
        Puppet* puppet = nullptr;
        auto driver = std::make_unique<Puppet>(&puppet);
        puppet->reading.timeNs = 77'000'000'000;
        puppet->reading.positionMm = {1, 2, 3};
        puppet->reading.motorTemperature = 0.2f;
        Ear ear;
        const auto faulty = withFaults(std::move(driver), parseFaults(faults));
        faulty->start(ear);
        for (int ms = 0; ms < 10; ++ms)
            (void)puppet->step();
        EXPECT_EQ(ear.heard.trouble, DeviceFault::none);
        EXPECT_EQ(ear.heard.positionMm[0], 1.0);
        (void)puppet->step();  // the first one at 10 ms
        look(*puppet, ear, *faulty);
        for (int ms = 0; ms < 20; ++ms)
            (void)puppet->step();
        EXPECT_EQ(ear.heard.trouble, DeviceFault::none);
        EXPECT_EQ(ear.heard.positionMm, (std::array<double, 3>{1, 2, 3}));
        EXPECT_EQ(ear.heard.motorTemperature, 0.2f);
        EXPECT_EQ(ear.heard.timeNs, puppet->reading.timeNs);
        faulty->stop();
    };
    with("unplug@0.01:0.02", [](Puppet&, Ear& e, auto&) { EXPECT_EQ(e.heard.trouble, DeviceFault::unplugged); });
    with("drop@0.01:0.02", [](Puppet&, Ear& e, auto&) { EXPECT_EQ(e.heard.trouble, DeviceFault::inputLost); });
    with("nan@0.01:0.02", [](Puppet&, Ear& e, auto&) { EXPECT_TRUE(std::isnan(e.heard.positionMm[0])); });
    with("jump@0.01:0.02=2", [](Puppet&, Ear& e, auto&) { EXPECT_EQ(e.heard.positionMm[0], 201.0); });
    with("hot@0.01:0.02=1.2", [](Puppet&, Ear& e, auto&) { EXPECT_EQ(e.heard.motorTemperature, 1.2f); });
    with("error@0.01:0.02=0x0303", [](Puppet&, Ear& e, auto&) {
        EXPECT_EQ(e.heard.trouble, DeviceFault::vendorError);
        EXPECT_EQ(e.heard.vendorCode, 0x0303);
    });
    with("garbage@0.01:0.02", [](Puppet& p, Ear& e, auto&) { EXPECT_NE(e.heard.positionMm, p.reading.positionMm); });
    with("stall@0.01:0.02", [](Puppet& p, Ear& e, link::Driver& faulty) {
        const int calls = e.calls;
        EXPECT_EQ(calls, 10);
        EXPECT_EQ(p.step().forceN[0], 1.0);  // it goes on with what it had
        faulty.relax();                      // the watchdog
        EXPECT_TRUE(p.relaxed);
        EXPECT_EQ(p.step().forceN[0], 0.0);
        EXPECT_EQ(e.calls, calls);
    });
}

TEST(Faults, theLogTellsWhatTheyCameTo) {
    Puppet* puppet = nullptr;
    auto driver = std::make_unique<Puppet>(&puppet);
    puppet->reading.timeNs = 5'000'000'000;
    Ear ear;
    const auto log = std::make_shared<FaultLog>();
    const auto faulty = withFaults(std::move(driver), parseFaults("stall@0.0105:0.02,unplug@9"), log);
    faulty->start(ear);
    for (int ms = 0; ms < 20; ++ms)
        (void)puppet->step();
    EXPECT_EQ(log->count(), 1u);
    faulty->relax();
    (void)puppet->step();
    faulty->stop();
    const auto outcomes = log->outcomes();
    ASSERT_EQ(outcomes.size(), 1u);  // the other has not begun
    EXPECT_EQ(outcomes[0].fault.kind, FaultKind::stall);
    EXPECT_EQ(outcomes[0].forceBeforeN, 1.0);
    EXPECT_EQ(outcomes[0].largestN, 1.0);
    EXPECT_NEAR(outcomes[0].toZeroS, 0.0095, 1e-9);
    EXPECT_EQ(log->output().samples, 11u);
    EXPECT_EQ(log->output().largestN, 1.0);
}

}  // namespace
}  // namespace handpiece::safety::injector_test
