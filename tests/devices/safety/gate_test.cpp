// SPDX-License-Identifier: Apache-2.0
// The gate alone, on a clock of the test's: whatever comes in, what goes out is within the limits, and doubt is zero.
#include "handpiece/devices/safety/gate.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "handpiece/base/core/error.h"
#include "support/random.h"
#include "support/realtime_trap.h"

namespace handpiece::safety::gate_test {
namespace {

using link::DeviceFault;
using link::DriverCommand;
using link::DriverReading;

constexpr std::int64_t kMs = 1'000'000;

double length(const std::array<double, 3>& v) {
    return std::hypot(v[0], v[1], v[2]);
}

/// A well device, a well tick and a gate between, frame by frame.
struct Bench {
    explicit Bench(const GateSettings& settings = {}, double servoHz = 1000.0)
        : gate(settings), periodNs(static_cast<std::int64_t>(1e9 / servoHz)) {
        reading.motorTemperature = 0.3f;
    }
    /// One frame later; the tick has given its last command just before.
    DriverCommand next() {
        nowNs += periodNs;
        if (deviceRuns) {
            reading.timeNs = nowNs;
            ++reading.frame;
        }
        if (tickRuns) {
            command.timeNs = nowNs;
            ++command.number;
        }
        return gate.pass(reading, command, nowNs);
    }
    DriverCommand run(double seconds) {
        DriverCommand out;
        const std::int64_t until = nowNs + static_cast<std::int64_t>(seconds * 1e9);
        while (nowNs < until)
            out = next();
        return out;
    }
    /// Pushing with all there is.
    void warmUp(double forceN = 3.0) {
        command.forceN = {0, forceN, 0};
        run(1.0);
    }

    Gate gate;
    std::int64_t periodNs, nowNs = 5'000'000'000;
    DriverReading reading;
    DriverCommand command;
    bool deviceRuns = true, tickRuns = true;
};

TEST(Gate, letsAGoodForceThrough) {
    Bench bench;
    bench.warmUp(2.0);
    EXPECT_EQ(bench.gate.status().trouble, DeviceFault::none);
    EXPECT_EQ(bench.gate.status().gain, 1.0);
    const DriverCommand out = bench.next();
    EXPECT_NEAR(out.forceN[1], 2.0, 1e-12);
    EXPECT_FALSE(bench.gate.status().clamped);
    EXPECT_EQ(bench.gate.status().troubles, 0u);
}

TEST(Gate, clampsForceAndTorqueToTheRecord) {
    GateSettings settings;
    settings.maxTorqueNmm = 100.0;
    Bench bench(settings);
    bench.command.forceN = {30, 40, 0};
    bench.command.torqueNmm = {0, 0, -500};
    bench.run(1.0);
    const DriverCommand out = bench.next();
    EXPECT_NEAR(length(out.forceN), 3.3, 1e-12);
    EXPECT_NEAR(out.forceN[0] / out.forceN[1], 0.75, 1e-12);
    EXPECT_NEAR(out.torqueNmm[2], -100.0, 1e-9);
    EXPECT_TRUE(bench.gate.status().clamped);

    bench.command.torqueNmm = {};
    bench.next();
    EXPECT_TRUE(bench.gate.status().clamped);

    Bench without;  // no torque axes
    without.command.torqueNmm = {1, 2, 3};
    without.run(1.0);
    EXPECT_EQ(length(without.next().torqueNmm), 0.0);
}

TEST(Gate, limitsTheSlopeByTheTimeThatHasPassed) {
    GateSettings settings;
    settings.maxSlopeNPerS = 200.0;
    Bench bench(settings);
    bench.warmUp(1.0);
    bench.command.forceN = {0, -1.0, 0};
    const double before = bench.next().forceN[1];
    EXPECT_NEAR(before, 1.0 - 0.2, 1e-9);
    EXPECT_TRUE(bench.gate.status().slopeLimited);
    bench.periodNs = 3 * kMs;
    EXPECT_NEAR(bench.next().forceN[1], before - 0.6, 1e-9);
    bench.periodNs = kMs / 4;
    EXPECT_NEAR(bench.next().forceN[1], 0.2 - 0.05, 1e-9);
}

TEST(Gate, limitsTheSlopeOfTorqueAsThatOfForce) {
    device::Capability capability;
    capability.maxForceN = 4.0;
    capability.maxForceSlopeNPerS = 2000.0;
    capability.maxTorqueNmm = 100.0;
    const GateSettings settings = gateSettingsFor(capability);
    EXPECT_NEAR(settings.maxTorqueSlopeNmmPerS, 50'000.0, 1e-9);  // both from none to the largest in 2 ms
    Bench bench(settings);
    bench.command.torqueNmm = {0, 100, 0};
    bench.run(1.0);
    EXPECT_NEAR(bench.next().torqueNmm[1], 100.0, 1e-9);
    EXPECT_FALSE(bench.gate.status().slopeLimited);
    bench.command.torqueNmm = {0, -100, 0};
    EXPECT_NEAR(bench.next().torqueNmm[1], 50.0, 1e-9);
    EXPECT_TRUE(bench.gate.status().slopeLimited);
    bench.periodNs = kMs / 2;
    EXPECT_NEAR(bench.next().torqueNmm[1], 25.0, 1e-9);
    EXPECT_EQ(length(bench.next().forceN), 0.0);
}

TEST(Gate, fadesInFromZeroAtTheFirstForce) {
    Bench bench;
    bench.run(2.0);  // well for long, but nothing was felt yet
    EXPECT_EQ(bench.gate.status().trouble, DeviceFault::none);
    bench.command.forceN = {3, 0, 0};
    double last = 0.0;
    EXPECT_EQ(length(bench.next().forceN), 0.0);
    for (int ms = 1; ms <= 310; ++ms) {
        const double now = length(bench.next().forceN);
        EXPECT_NEAR(now, 3.0 * std::min(1.0, ms / 300.0), 1e-9);
        EXPECT_GE(now, last);
        last = now;
    }
}

struct Case {
    const char* name;
    DeviceFault told;
    void (*spoil)(Bench&);
};
const Case kCases[] = {
    {"unplugged", DeviceFault::unplugged, [](Bench& b) { b.reading.trouble = DeviceFault::unplugged; }},
    {"vendor error", DeviceFault::vendorError, [](Bench& b) { b.reading.trouble = DeviceFault::vendorError; }},
    {"no trouble there is", DeviceFault::badData, [](Bench& b) { b.reading.trouble = static_cast<DeviceFault>(99); }},
    {"input lost", DeviceFault::inputLost, [](Bench& b) { b.reading.trouble = DeviceFault::inputLost; }},
    {"position not finite", DeviceFault::notFinite, [](Bench& b) { b.reading.positionMm[1] = std::nan(""); }},
    {"orientation not finite", DeviceFault::notFinite,
     [](Bench& b) { b.reading.orientation[3] = std::numeric_limits<double>::infinity(); }},
    {"no rotation", DeviceFault::badData,
     [](Bench& b) {
         b.reading.orientation = {0.5, 0, 0, 0};
     }},
    {"out of the world", DeviceFault::badData, [](Bench& b) { b.reading.positionMm[0] = -1e30; }},
    {"jump", DeviceFault::jumped, [](Bench& b) { b.reading.positionMm[2] += 100.0; }},
    {"turned at once", DeviceFault::jumped,
     [](Bench& b) {
         b.reading.orientation = {0, 1, 0, 0};
     }},
    {"hot", DeviceFault::hot, [](Bench& b) { b.reading.motorTemperature = 1.0f; }},
    {"temperature not finite", DeviceFault::notFinite, [](Bench& b) { b.reading.motorTemperature = std::nanf(""); }},
    {"force not finite", DeviceFault::notFinite, [](Bench& b) { b.command.forceN[0] = std::nan(""); }},
    {"torque not finite", DeviceFault::notFinite, [](Bench& b) { b.command.torqueNmm[0] = -std::nan(""); }},
    {"force out of the world", DeviceFault::notFinite, [](Bench& b) { b.command.forceN[2] = 1e300; }},
    {"the tick stands", DeviceFault::tickStalled, [](Bench& b) { b.tickRuns = false; }},
    {"the device repeats itself", DeviceFault::stalled, [](Bench& b) { b.deviceRuns = false; }},
};

TEST(Gate, everyDoubtEndsInZeroWithinTenMilliseconds) {
    for (const Case& c : kCases) {
        for (const double servoHz : {8000.0, 4000.0, 1000.0, 625.0, 500.0, 400.0, 333.0, 300.0, 260.0, 250.0, 200.0}) {
            SCOPED_TRACE(std::string(c.name) + " at " + std::to_string(servoHz));
            device::Capability capability;
            capability.rateHz = servoHz;
            Bench bench(gateSettingsFor(capability), servoHz);
            bench.warmUp();
            ASSERT_NEAR(length(bench.next().forceN), 3.0, 1e-9);
            // It begins right after this exchange.
            const std::int64_t began = bench.nowNs;
            const std::uint64_t before = bench.gate.status().troubles;
            c.spoil(bench);
            double last = 3.0;
            while (last > 0.0 && bench.nowNs < began + 100 * kMs) {
                const double now = length(bench.next().forceN);
                EXPECT_LE(now, last);
                last = now;
            }
            const double tookMs = static_cast<double>(bench.nowNs - began) / kMs;
            // A slow device is only known to repeat itself after 2.5 of its periods.
            const bool late = c.told == DeviceFault::stalled && servoHz < 625.0;
            EXPECT_LE(tookMs, late ? 3.0 * 1e3 / servoHz + 4.0 + 1e-6 : 10.0);
            EXPECT_EQ(bench.gate.status().last, c.told);
            EXPECT_EQ(bench.gate.status().troubles, before + 1);
            EXPECT_EQ(bench.gate.status().gain, 0.0);
        }
    }
}

TEST(Gate, afterDoubtItStaysAtZeroAndThenFadesIn) {
    Bench bench;
    bench.warmUp();
    bench.reading.trouble = DeviceFault::unplugged;
    bench.run(0.2);
    bench.reading.trouble = DeviceFault::none;
    for (int ms = 0; ms < 49; ++ms) {
        EXPECT_EQ(length(bench.next().forceN), 0.0);
        EXPECT_EQ(bench.gate.status().trouble, DeviceFault::unplugged);
    }
    bench.run(0.003);
    EXPECT_EQ(bench.gate.status().trouble, DeviceFault::none);
    EXPECT_EQ(bench.gate.status().last, DeviceFault::unplugged);
    const double early = length(bench.next().forceN);
    EXPECT_LT(early, 0.05);
    EXPECT_NEAR(length(bench.run(0.150).forceN), 1.5, 0.1);
    EXPECT_NEAR(length(bench.run(0.200).forceN), 3.0, 1e-9);
    // A doubt during the wait begins it anew.
    bench.reading.trouble = DeviceFault::unplugged;
    bench.run(0.02);
    bench.reading.trouble = DeviceFault::none;
    bench.run(0.04);
    bench.reading.positionMm[0] = std::nan("");
    bench.next();
    bench.reading.positionMm[0] = 0.0;
    EXPECT_EQ(length(bench.run(0.045).forceN), 0.0);
    EXPECT_EQ(bench.gate.status().trouble, DeviceFault::notFinite);
}

TEST(Gate, aDeviceThatStoodIsAnsweredWithZero) {
    for (const std::int64_t gapMs : {5, 7, 20, 500}) {
        Bench bench;
        bench.warmUp();
        bench.nowNs += (gapMs - 1) * kMs;
        EXPECT_EQ(length(bench.next().forceN), 0.0) << gapMs;
        EXPECT_EQ(bench.gate.status().trouble, DeviceFault::stalled);
    }
    Bench bench;
    bench.warmUp();
    bench.nowNs += 3 * kMs;  // late, not standing
    EXPECT_NEAR(length(bench.next().forceN), 3.0, 1e-9);
}

TEST(Gate, aPauseOfTheTickFadesInAgain) {
    Bench bench;
    bench.warmUp();
    bench.tickRuns = false;
    bench.run(3.0);
    EXPECT_EQ(bench.gate.status().trouble, DeviceFault::tickStalled);
    bench.tickRuns = true;
    EXPECT_EQ(length(bench.run(0.05).forceN), 0.0);
    EXPECT_LT(length(bench.run(0.01).forceN), 0.2);
    EXPECT_NEAR(length(bench.run(0.4).forceN), 3.0, 1e-9);
}

TEST(Gate, aStampOfTheFutureKeepsNoCommandYoung) {
    for (const std::int64_t aheadMs : {3, 30, 3'000'000}) {
        Bench bench;
        bench.warmUp();
        bench.tickRuns = false;
        bench.command.timeNs = bench.nowNs + aheadMs * kMs;
        bench.command.number++;
        EXPECT_EQ(length(bench.run(0.012).forceN), 0.0) << aheadMs;
        EXPECT_EQ(bench.gate.status().trouble, DeviceFault::tickStalled);
    }
}

TEST(Gate, aTickWhoseClockStandsIsNotBelieved) {
    Bench bench;
    bench.warmUp();
    bench.tickRuns = false;
    for (int ms = 0; ms < 12; ++ms) {  // commands go on, with the time of the first
        ++bench.command.number;
        bench.next();
    }
    EXPECT_EQ(bench.gate.status().gain, 0.0);
    EXPECT_EQ(bench.gate.status().trouble, DeviceFault::tickStalled);
}

TEST(Gate, oneCommandStampedAnewIsStillOne) {
    Bench bench;
    bench.warmUp();
    bench.tickRuns = false;
    for (int ms = 0; ms < 12; ++ms) {
        bench.command.timeNs = bench.nowNs;
        bench.next();
    }
    EXPECT_EQ(bench.gate.status().gain, 0.0);
    EXPECT_EQ(bench.gate.status().trouble, DeviceFault::tickStalled);
}

TEST(Gate, oneFrameStampedAnewIsStillOne) {
    Bench bench;
    bench.warmUp();
    bench.deviceRuns = false;
    for (int ms = 0; ms < 12; ++ms) {
        bench.reading.timeNs = bench.nowNs + bench.periodNs;
        bench.next();
    }
    EXPECT_EQ(bench.gate.status().gain, 0.0);
    EXPECT_EQ(bench.gate.status().trouble, DeviceFault::stalled);
}

TEST(Gate, aQuickHandIsNoJump) {
    Bench bench;
    bench.warmUp(1.0);
    for (int ms = 0; ms < 300; ++ms) {  // 2 m/s, turning with 30 rad/s
        bench.reading.positionMm[0] += 2.0;
        const double angle = 0.03 * ms;
        bench.reading.orientation = {std::cos(angle / 2), 0, std::sin(angle / 2), 0};
        bench.next();
        ASSERT_EQ(bench.gate.status().trouble, DeviceFault::none) << ms;
    }
    // The same turn told by the other quaternion.
    for (double& c : bench.reading.orientation)
        c = -c;
    bench.next();
    EXPECT_EQ(bench.gate.status().trouble, DeviceFault::none);
}

TEST(Gate, warmMotorsGetLessAndHotOnesNothing) {
    Bench bench;
    bench.warmUp();
    for (const auto& [temperature, share] : std::map<float, double>{{0.8f, 1.0}, {0.89f, 0.5}, {0.97f, 0.0556}}) {
        bench.reading.motorTemperature = temperature;
        EXPECT_NEAR(length(bench.run(0.1).forceN), 3.0 * share, 0.01) << temperature;
        EXPECT_EQ(bench.gate.status().trouble, DeviceFault::none);
    }
    bench.reading.motorTemperature = 0.985f;
    EXPECT_EQ(length(bench.run(0.01).forceN), 0.0);
    EXPECT_EQ(bench.gate.status().trouble, DeviceFault::hot);
    bench.reading.motorTemperature = -1.0f;  // not told
    EXPECT_NEAR(length(bench.run(1.0).forceN), 3.0, 1e-9);
}

TEST(Gate, tellsTheVendorsCode) {
    Bench bench;
    bench.warmUp();
    bench.reading.vendorCode = 0x0200;  // a warning
    bench.next();
    EXPECT_EQ(bench.gate.status().trouble, DeviceFault::none);
    EXPECT_EQ(bench.gate.status().vendorCode, 0x0200);
    bench.reading.trouble = DeviceFault::vendorError;
    bench.reading.vendorCode = 0x0301;
    bench.next();
    EXPECT_EQ(bench.gate.status().vendorCode, 0x0301);
}

TEST(Gate, whateverComesInTheAnswerIsWithinTheLimits) {
    std::mt19937_64 random(test::seed());
    const auto anything = [&]() -> double {
        switch (random() % 6) {
            case 0:
                return std::bit_cast<double>(static_cast<std::uint64_t>(random()));
            case 1:
                return std::numeric_limits<double>::quiet_NaN();
            case 2:
                return std::numeric_limits<double>::infinity() * (random() % 2 ? 1.0 : -1.0);
            case 3:
                return test::uniform(random, -1e308, 1e308);
            default:
                return test::uniform(random, -10.0, 10.0);
        }
    };
    std::uint64_t pushed = 0, doubted = 0;
    for (int round = 0; round < 60; ++round) {
        GateSettings settings;
        settings.maxForceN = test::uniform(random, 0.5, 20.0);
        settings.maxTorqueNmm = round % 2 ? test::uniform(random, 0.0, 300.0) : 0.0;
        settings.maxSlopeNPerS = test::uniform(random, 100.0, 5000.0);
        settings.maxTorqueSlopeNmmPerS = 20.0 * settings.maxSlopeNPerS;
        settings.fadeInS = test::uniform(random, 0.0, 0.05);
        settings.clearAfterS = test::uniform(random, 0.0, 0.02);
        Bench bench(settings, test::uniform(random, 300.0, 8000.0));
        // From rounds that are mostly well to rounds that are mostly garbage.
        const double share = std::pow(10.0, -0.06 * round);
        DriverCommand before;
        std::int64_t beforeNs = bench.nowNs;
        for (int i = 0; i < 4000; ++i) {
            const auto bad = [&] { return test::uniform(random, 0.0, 1.0) < 0.2 * share; };
            bench.command.forceN = {test::uniform(random, -30, 30), test::uniform(random, -30, 30), 5.0};
            bench.command.torqueNmm = {test::uniform(random, -300, 300), 10.0, 0.0};
            bench.command.vibration = static_cast<float>(anything());
            std::int64_t now = bench.nowNs + bench.periodNs;
            if (bad()) now = bench.nowNs - static_cast<std::int64_t>(random() % 10'000'000'000);
            if (bad()) now = bench.nowNs + static_cast<std::int64_t>(random() % 10'000'000'000);
            if (bad()) now = bench.nowNs;
            if (bad()) now = static_cast<std::int64_t>(random());
            DriverReading r = bench.reading;
            DriverCommand c = bench.command;
            r.timeNs = c.timeNs = now;
            ++r.frame;
            ++c.number;
            bench.reading = r;
            bench.command = c;
            if (bad()) r.positionMm[random() % 3] = anything();
            if (bad()) r.orientation[random() % 4] = anything();
            if (bad()) r.motorTemperature = static_cast<float>(anything());
            if (bad()) r.pedal = static_cast<float>(anything());
            if (bad()) r.trouble = static_cast<DeviceFault>(random() & 0xff);
            if (bad()) r.timeNs = static_cast<std::int64_t>(random());
            if (bad()) r.frame = random();
            if (bad()) c.forceN[random() % 3] = anything();
            if (bad()) c.torqueNmm[random() % 3] = anything();
            if (bad()) c.timeNs = static_cast<std::int64_t>(random());
            if (bad()) c.number = random() % 2 ? 0 : random();
            const DriverCommand out = bench.gate.pass(r, c, now);
            const double force = length(out.forceN);
            // Comparisons that NaN fails.
            ASSERT_TRUE(force <= settings.maxForceN * (1.0 + 1e-12)) << force;
            ASSERT_TRUE(length(out.torqueNmm) <= settings.maxTorqueNmm * (1.0 + 1e-12));
            ASSERT_TRUE(out.vibration >= 0.0f && out.vibration <= 1.0f) << out.vibration;
            const double elapsedS = (static_cast<double>(now) - static_cast<double>(beforeNs)) * 1e-9;
            const double change = std::hypot(out.forceN[0] - before.forceN[0], out.forceN[1] - before.forceN[1],
                                             out.forceN[2] - before.forceN[2]);
            if (bench.gate.status().trouble == DeviceFault::none) {
                ASSERT_LE(change, settings.maxSlopeNPerS * std::max(0.0, elapsedS) + 1e-9);
                const double turn =
                    std::hypot(out.torqueNmm[0] - before.torqueNmm[0], out.torqueNmm[1] - before.torqueNmm[1],
                               out.torqueNmm[2] - before.torqueNmm[2]);
                ASSERT_LE(turn, settings.maxTorqueSlopeNmmPerS * std::max(0.0, elapsedS) + 1e-7);
                pushed += force > 0.0;
            } else {
                ASSERT_LE(force, length(before.forceN) + 1e-12);  // falls, and in its own direction
                ASSERT_NEAR(change + force, length(before.forceN), 1e-9);
                ++doubted;
            }
            before = out;
            beforeNs = bench.nowNs = now;
            // Times stay where a sum of them does not overflow.
            if (std::abs(now) > std::int64_t{1} << 61) bench.nowNs = beforeNs = 7'000'000'000;
        }
    }
    // The test means something: both happened, often.
    EXPECT_GT(pushed, 20000u);
    EXPECT_GT(doubted, 20000u);
}

TEST(Gate, neitherAllocatesNorWaits) {
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc: the trap is off";
    Bench bench;
    const test::RealtimeTrap trap;
    bench.warmUp();
    bench.reading.positionMm[0] = std::nan("");
    bench.run(0.1);
    bench.reading.positionMm[0] = 0.0;
    bench.run(0.1);
    EXPECT_EQ(trap.total(), 0u);
}

TEST(Gate, refusesSettingsThatGuardNothing) {
    const auto refuses = [](auto change) {
        GateSettings settings;
        change(settings);
        EXPECT_THROW(validate(settings), core::Error);
    };
    EXPECT_NO_THROW(validate(GateSettings{}));
    refuses([](GateSettings& s) { s.maxForceN = 0.0; });
    refuses([](GateSettings& s) { s.maxForceN = std::nan(""); });
    refuses([](GateSettings& s) { s.maxSlopeNPerS = std::numeric_limits<double>::infinity(); });
    refuses([](GateSettings& s) { s.maxTorqueNmm = -1.0; });
    refuses([](GateSettings& s) { s.maxTorqueSlopeNmmPerS = std::nan(""); });
    refuses([](GateSettings& s) { s.releaseS = 1.0; });
    refuses([](GateSettings& s) { s.commandTimeoutS = 0.0; });
    refuses([](GateSettings& s) { s.readingTimeoutS = 2.0; });
    refuses([](GateSettings& s) { s.warmFrom = 0.99; });
    device::Capability capability;
    capability.rateHz = 200.0;
    EXPECT_NEAR(gateSettingsFor(capability).readingTimeoutS, 0.0125, 1e-12);
    capability.maxForceN = -1.0;
    EXPECT_THROW((void)gateSettingsFor(capability), core::Error);
}

}  // namespace
}  // namespace handpiece::safety::gate_test
