// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "handpiece/devices/fidelity/recording.h"
#include "support/random.h"

namespace handpiece::fidelity::judge_test {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// A made-up device: frames every `periodNs`, as asked.
Recording recordingOf(std::int64_t periodNs, int count) {
    Recording r;
    r.info.driver = "made-up";
    r.info.model = "Made Up";
    r.settings.durationS = 1e-9 * static_cast<double>(periodNs) * count;
    r.settings.push = false;
    r.plan.restS = r.settings.durationS;
    r.maxSlopeNPerS = 5000.0;
    for (int i = 0; i < count; ++i) {
        FrameRecord f;
        f.readNs = f.atNs = 1'000 * kMs + i * periodNs;
        r.frames.push_back(f);
        r.ticks.push_back({f.atNs + kMs / 10, 0, kMs / 10, 1});
    }
    r.startNs = r.frames.front().atNs;
    return r;
}

const Finding& of(const Report& report, const std::string& id) {
    return *std::find_if(report.findings.begin(), report.findings.end(), [&](const Finding& f) { return f.id == id; });
}
Verdict verdict(const Recording& r, const std::string& id) {
    return of(judge(r), id).verdict;
}

TEST(FidelityJudge, aServoUnderFiveHundredHertzIsNotGood) {
    EXPECT_EQ(verdict(recordingOf(kMs, 2000), "servo-period"), Verdict::pass);
    EXPECT_EQ(verdict(recordingOf(3 * kMs / 2, 2000), "servo-period"), Verdict::warn);
    EXPECT_EQ(verdict(recordingOf(5 * kMs / 2, 2000), "servo-period"), Verdict::fail);
    // What cannot push may be as slow as it says.
    Recording r = recordingOf(10 * kMs, 300);
    r.info.pushes = false;
    r.info.servoHz = 100.0;
    EXPECT_EQ(verdict(r, "servo-period"), Verdict::pass);
}

TEST(FidelityJudge, jitterAndPausesAreSeen) {
    Recording r = recordingOf(kMs, 4000);
    EXPECT_EQ(verdict(r, "servo-jitter"), Verdict::pass);
    EXPECT_EQ(verdict(r, "servo-gaps"), Verdict::pass);
    for (std::size_t i = 0; i < r.frames.size(); i += 50)
        r.frames[i].atNs += 4 * kMs / 5;
    EXPECT_EQ(verdict(r, "servo-jitter"), Verdict::warn);
    r = recordingOf(kMs, 4000);
    for (std::size_t i = 2000; i < r.frames.size(); ++i)
        r.frames[i].atNs += 6 * kMs;
    EXPECT_EQ(verdict(r, "servo-gaps"), Verdict::warn);
    for (std::size_t k = 1; k < 5; ++k)
        for (std::size_t i = 500 * k; i < r.frames.size(); ++i)
            r.frames[i].atNs += 6 * kMs;
    EXPECT_EQ(verdict(r, "servo-gaps"), Verdict::fail);
}

TEST(FidelityJudge, lateTicksAreCountedWithThoseLeftOut) {
    Recording r = recordingOf(kMs, 4000);
    EXPECT_EQ(verdict(r, "tick-lateness"), Verdict::pass);
    for (std::size_t i = 0; i < 20; ++i)  // 0.5 %
        r.ticks[i * 100].lateNs = 2 * kMs;
    EXPECT_EQ(verdict(r, "tick-lateness"), Verdict::warn);
    r.ticks[5].periods = 100;
    EXPECT_EQ(verdict(r, "tick-lateness"), Verdict::fail);
}

TEST(FidelityJudge, oldPosesAreSeen) {
    Recording r = recordingOf(kMs, 2000);
    EXPECT_EQ(verdict(r, "reading-age"), Verdict::pass);
    for (TickRecord& t : r.ticks)
        t.ageNs = 3 * kMs;
    EXPECT_EQ(verdict(r, "reading-age"), Verdict::warn);
    for (TickRecord& t : r.ticks)
        t.ageNs = 8 * kMs;
    EXPECT_EQ(verdict(r, "reading-age"), Verdict::fail);
}

TEST(FidelityJudge, noiseAndStepsAreThoseThatAreThere) {
    std::mt19937_64 random(test::seed());
    Recording r = recordingOf(kMs, 3000);
    std::normal_distribution<double> noise(0.0, 0.03);
    for (FrameRecord& f : r.frames)
        f.positionMm = {0.01 * std::round(noise(random) / 0.01), 1e3, 0.0};
    const Rest rest = restOf(r);
    EXPECT_NEAR(rest.noiseMm, 0.03, 0.003);
    EXPECT_NEAR(rest.stepMm, 0.01, 1e-9);
    EXPECT_FALSE(rest.moved);
    r.info.capability.maxStiffnessNPerMm = 0.5;
    EXPECT_EQ(verdict(r, "rest-noise"), Verdict::pass);
    r.info.capability.maxStiffnessNPerMm = 3.0;
    EXPECT_EQ(verdict(r, "rest-noise"), Verdict::warn);
    r.info.capability.encoderStepMm = 0.001;
    EXPECT_EQ(verdict(r, "encoder-step"), Verdict::warn);
}

TEST(FidelityJudge, stillEncodersSayNothingOfTheirStep) {
    EXPECT_EQ(verdict(recordingOf(kMs, 2000), "encoder-step"), Verdict::notMeasured);
}

TEST(FidelityJudge, heatCalibrationAndGrantsAreJudged) {
    Recording r = recordingOf(kMs, 2000);
    EXPECT_EQ(verdict(r, "temperature"), Verdict::notMeasured);
    r.frames[7].motorTemperature = 0.5f;
    EXPECT_EQ(verdict(r, "temperature"), Verdict::pass);
    r.frames[7].motorTemperature = 0.9f;
    EXPECT_EQ(verdict(r, "temperature"), Verdict::warn);
    r.frames[7].motorTemperature = 0.99f;
    EXPECT_EQ(verdict(r, "temperature"), Verdict::fail);
    EXPECT_EQ(verdict(r, "calibration"), Verdict::pass);
    r.calibration = link::CalibrationState::wantedByHand;
    r.calibrationStep = "Put the stylus into the inkwell.";
    EXPECT_EQ(verdict(r, "calibration"), Verdict::fail);
    EXPECT_EQ(config::words()(of(judge(r), "calibration").remedy), r.calibrationStep);
    EXPECT_EQ(verdict(r, "scheduling"), Verdict::warn);
    r.grant.scheduling = rt::Scheduling::fifo;
    r.grant.memoryLocked = true;
    EXPECT_EQ(verdict(r, "scheduling"), Verdict::pass);
    EXPECT_EQ(verdict(r, "memory-locked"), Verdict::pass);
}

// The arm answers a step of 0.5 N after `delayS` with a steady acceleration, less what damping takes.
TEST(FidelityJudge, theRoundTripIsFoundWhateverTheStepOfTheEncoders) {
    for (const double stepMm : {0.001, 0.01, 0.055})
        for (const double delayS : {0.0, 0.0013, 0.004, 0.012}) {
            Recording r = recordingOf(kMs, 4000);
            r.info.capability.encoderStepMm = stepMm;
            constexpr double kTauS = 0.05, kMmS2 = 8000.0;
            for (int k = 0; k < 12; ++k) {
                const std::int64_t atNs = r.startNs + (1000 + 200 * k) * kMs;
                const double restMm = 0.31 * stepMm * k;  // the hand comes back to another place each time
                r.pulses.push_back({atNs - kMs / 3, 0.0, 0.5});
                for (FrameRecord& f : r.frames) {
                    const double since = 1e-9 * static_cast<double>(f.atNs - atNs), t = since - delayS;
                    if (since < -0.05 || since > 0.14) continue;
                    f.sentN[1] = since >= 0.0 && since < 0.06 ? 0.5 : 0.0;
                    const double way = t > 0.0 ? kMmS2 * kTauS * (t - kTauS * (1.0 - std::exp(-t / kTauS))) : 0.0;
                    f.positionMm[1] = stepMm * std::round((restMm + way) / stepMm);
                }
            }
            const Delay d = roundTripOf(r);
            ASSERT_TRUE(d.measured) << config::words()(d.why);
            EXPECT_NEAR(d.seconds, delayS, std::max(0.0005, d.uncertaintyS)) << "step " << stepMm;
            EXPECT_LT(d.uncertaintyS, 0.002);
        }
}

TEST(FidelityJudge, aFirmHandHidesTheRoundTrip) {
    Recording r = recordingOf(kMs, 4000);
    for (int k = 0; k < 12; ++k) {
        const std::int64_t atNs = r.startNs + (1000 + 200 * k) * kMs;
        r.pulses.push_back({atNs, 0.0, 0.5});
        for (FrameRecord& f : r.frames)
            if (f.atNs >= atNs && f.atNs < atNs + 60 * kMs) f.sentN[1] = 0.5;
    }
    const Delay d = roundTripOf(r);
    EXPECT_FALSE(d.measured);
    EXPECT_EQ(d.why.id, "fidelity.unmeasured-path");
    // But the slope was there to be seen.
    r.settings.push = true;
    EXPECT_EQ(verdict(r, "force-slope"), Verdict::pass);
}

TEST(FidelityReport, jsonSaysWhatWasFound) {
    Recording r = recordingOf(kMs, 1500);
    r.info.model = "A \"<b>&\\\n";
    const std::string json = asJson(judge(r));
    EXPECT_NE(json.find("\"model\": \"A \\\"<b>&\\\\\\u000a\""), std::string::npos) << json;
    EXPECT_NE(json.find("\"id\": \"servo-period\", \"name\": \"Servo period\""), std::string::npos) << json;
    EXPECT_NE(json.find("[1000, 1499]"), std::string::npos);
}

TEST(FidelityReport, EveryFindingHasItsWordsInEveryLanguage) {
    for (const std::string& language : config::Words::languages())
        for (const Finding& f : judge(recordingOf(kMs, 1500)).findings) {
            const config::Words& words = config::Words::in(language);
            EXPECT_FALSE(nameOf(f, words).empty() || words(f.against).empty()) << f.id;
            EXPECT_TRUE(f.value.id.empty() || !words(f.value).empty()) << f.id;
        }
}

}  // namespace
}  // namespace handpiece::fidelity::judge_test
