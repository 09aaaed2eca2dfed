// SPDX-License-Identifier: Apache-2.0
// The voices and what OpenAL makes of them, through the loopback device.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "handpiece/base/core/error.h"
#include "handpiece/senses/sound/player.h"
#include "handpiece/senses/sound/stage.h"
#include "handpiece/senses/sound/voices.h"
#include "senses/sound/listen.h"
#include "support/error_of.h"

namespace handpiece::sound::sound_test {
namespace {

using test::click;
using test::db;
using test::rms;
namespace fs = std::filesystem;

DrillState turning(double rpm, double pedal = 1.0) {
    DrillState drill;
    drill.speedRpm = rpm;
    drill.pedal = pedal;
    return drill;
}

/// At 1 N of the reference friction.
DrillState cuttingState(cases::Tissue tissue, double rpm = 380000.0) {
    DrillState drill = turning(rpm);
    drill.tissue = tissue;
    drill.loadTorqueNmm = 0.15;
    drill.removalMm3S = 1.0;
    drill.cutting = true;
    return drill;
}

template <class Voice>
void hear(Voice& voice, const DrillState& drill, double seconds, std::vector<double>& out, std::size_t block = 48) {
    std::vector<float> piece(block);
    for (auto left = static_cast<std::size_t>(seconds * 48000.0); left > 0;) {
        const std::size_t n = std::min(block, left);
        std::fill(piece.begin(), piece.end(), 0.0f);
        voice.render(drill, std::span(piece).first(n));
        out.insert(out.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(n));
        left -= n;
    }
}

template <class Voice>
std::vector<double> settled(const DrillState& drill, double seconds) {
    Voice voice;
    std::vector<double> out;
    hear(voice, drill, 0.3, out);
    out.clear();
    hear(voice, drill, seconds, out);
    return out;
}

std::vector<double> channel(const std::vector<float>& stereo, std::size_t c) {
    std::vector<double> out;
    for (std::size_t i = c; i < stereo.size(); i += 2)
        out.push_back(stereo[i]);
    return out;
}

class Files : public testing::Test {
  protected:
    void SetUp() override { fs::create_directories(folder); }
    void TearDown() override { fs::remove_all(folder); }
    fs::path sine(double hz, double seconds, double rate = 48000.0) const {
        Wav wav;
        wav.rateHz = static_cast<int>(rate);
        for (int i = 0; i < static_cast<int>(seconds * rate); ++i)
            wav.samples.push_back(0.5f * static_cast<float>(std::sin(2.0 * std::numbers::pi * hz * i / rate)));
        writeWav(wav, folder / "sine.wav");
        return folder / "sine.wav";
    }
    fs::path folder = fs::temp_directory_path() /
                      ("handpiece-sound-" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
                       testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST(Motor, FundamentalIsTheSpeed) {
    for (const double rpm : {20000.0, 50000.0, 100000.0, 200000.0, 300000.0, 400000.0}) {
        const auto x = settled<MotorVoice>(turning(rpm), 0.5);
        EXPECT_NEAR(test::peakNear(x, rpm / 60.0, 0.03) / (rpm / 60.0), 1.0, 0.005) << rpm;
    }
    DrillState slow = turning(20000.0);
    slow.freeSpeedRpm = 40000.0;
    EXPECT_NEAR(test::peakNear(settled<MotorVoice>(slow, 0.5), 20000.0 / 60.0, 0.03) * 60.0 / 20000.0, 1.0, 0.005);
}

TEST(Motor, StandingIsSilentOrBareNoise) {
    EXPECT_EQ(rms(settled<MotorVoice>(turning(0.0, 0.0), 0.2)), 0.0);
    const auto air = settled<MotorVoice>(turning(0.0, 1.0), 0.5);
    EXPECT_GT(rms(air), 0.005);
    // Noise: no frequency stands out of it.
    double strongest = 0.0;
    for (double hz = 100.0; hz < 12000.0; hz += 37.0)
        strongest = std::max(strongest, test::tone(air, hz));
    EXPECT_LT(strongest, 0.1 * rms(air));
}

TEST(Motor, NothingFoldsBack) {
    // 400,000 rpm: overtones from the fourth on lie over 24 kHz; folded they would stand at 48 kHz - n x 6,667 Hz.
    const double f = 400000.0 / 60.0;
    const auto x = settled<MotorVoice>(turning(400000.0, 0.0), 0.5);
    for (const double hz : {48000.0 - 4 * f, 48000.0 - 5 * f, 48000.0 - 6 * f})
        EXPECT_LT(db(test::tone(x, hz) / test::tone(x, f)), -60.0) << hz;
}

TEST(Motor, LevelsOfDrivesAsStated) {
    EXPECT_NEAR(driveLevelDb(400000.0), 0.0, 1e-9);
    EXPECT_NEAR(driveLevelDb(40000.0), -22.0, 1e-9);
    DrillState slow = turning(40000.0, 0.0);
    slow.freeSpeedRpm = 40000.0;
    const double fast = test::tone(settled<MotorVoice>(turning(400000.0, 0.0), 0.5), 400000.0 / 60.0);
    EXPECT_NEAR(db(test::tone(settled<MotorVoice>(slow, 0.5), 40000.0 / 60.0) / fast), -22.0, 0.5);
    EXPECT_NEAR(rms(settled<MotorVoice>(turning(400000.0, 0.0), 0.5)), kNominalRms, 0.15 * kNominalRms);
}

TEST(Motor, NoClickAtStartStopAndChange) {
    // Without air the motor is tones alone: a jump has nowhere to hide.
    MotorVoice voice;
    std::vector<double> x;
    const auto with = [](double rpm) {
        DrillState d = turning(rpm, 0.0);
        d.freeSpeedRpm = 40000.0;
        return d;
    };
    for (const double rpm : {0.0, 3000.0, 0.0, 3000.0, 1500.0, 3000.0})
        hear(voice, with(rpm), 0.1, x);
    const double full = rms(settled<MotorVoice>(with(3000.0), 0.3)) * std::numbers::sqrt2;
    EXPECT_LT(db(click(x) / full), -60.0);
    std::printf("motor: %.1f dB\n", db(click(x) / full));
    // The measure hears what it should: the same sound switched off and on at once.
    std::vector<double> cut = settled<MotorVoice>(with(3000.0), 0.3);
    for (std::size_t i = 5003; i < cut.size(); ++i)
        cut[i] = 0.0;
    EXPECT_GT(db(click(cut) / full), -60.0);
}

TEST(Cutting, TissuesDifferAsStated) {
    const double enamel = rms(settled<CuttingVoice>(cuttingState(cases::Tissue::enamel), 2.0));
    for (const auto tissue :
         {cases::Tissue::dentine, cases::Tissue::caries, cases::Tissue::pulp, cases::Tissue::restoration})
        EXPECT_NEAR(db(rms(settled<CuttingVoice>(cuttingState(tissue), 2.0)) / enamel), tissueVoice(tissue).levelDb,
                    1.0);
    EXPECT_NEAR(rms(settled<CuttingVoice>(cuttingState(cases::Tissue::enamel, 400000.0), 2.0)) / kNominalRms, 1.0,
                0.12);
}

TEST(Cutting, BrighterInHarderTissue) {
    const auto centre = [](cases::Tissue tissue) {
        const auto x = settled<CuttingVoice>(cuttingState(tissue), 0.25);
        double weighed = 0.0, all = 0.0;
        for (double hz = 100.0; hz < 20000.0; hz += 100.0) {
            const double t = test::tone(x, hz);
            weighed += hz * t * t;
            all += t * t;
        }
        return weighed / all;
    };
    const double enamel = centre(cases::Tissue::enamel), dentine = centre(cases::Tissue::dentine),
                 caries = centre(cases::Tissue::caries);
    EXPECT_GT(enamel, 1.3 * dentine);
    EXPECT_GT(dentine, 1.3 * caries);
}

TEST(Cutting, FollowsLoadAndNeedsIt) {
    DrillState drill = cuttingState(cases::Tissue::enamel);
    const double one = rms(settled<CuttingVoice>(drill, 1.0));
    drill.loadTorqueNmm *= 0.25;
    EXPECT_NEAR(db(rms(settled<CuttingVoice>(drill, 1.0)) / one), db(std::pow(0.25, 0.6)), 1.0);
    drill.loadTorqueNmm = 0.0;
    EXPECT_EQ(rms(settled<CuttingVoice>(drill, 0.2)), 0.0);
    drill.speedRpm = 0.0;
    drill.stalled = true;
    EXPECT_GT(rms(settled<CuttingVoice>(drill, 1.0)), 0.005);  // the grunt of a bur that sticks
}

TEST(Cutting, NoClickAtContactAndLifting) {
    // Caries is low: its spectrum leaves room over it for a click to show. Against the same without any change.
    DrillState in = cuttingState(cases::Tissue::caries), out = turning(380000.0);
    in.speedRpm = out.speedRpm = 20000.0;
    const auto steady = settled<CuttingVoice>(in, 1.0);
    CuttingVoice voice;
    std::vector<double> x;
    for (int i = 0; i < 10; ++i) {
        hear(voice, in, 0.05, x);
        hear(voice, out, 0.05, x);
    }
    EXPECT_LT(click(x), 1.3 * click(steady) + 1e-3 * rms(steady));
}

TEST(Voices, BlocksOfAnyLengthGiveTheSame) {
    std::vector<double> a, b;
    MotorVoice first, second;
    hear(first, turning(300000.0), 0.1, a, 480);
    hear(second, turning(300000.0), 0.1, b, 7);
    EXPECT_EQ(a, b);
}

TEST(Voices, MixAndMute) {
    EXPECT_EQ(gainsOf({1.0, 1.0, 0.0, false}).cutting, 0.0);
    EXPECT_EQ(gainsOf({1.0, 1.0, 0.0, false}).motor, 1.0);
    EXPECT_EQ(gainsOf({1.0, 1.0, 1.0, false}).motor, 0.0);
    EXPECT_EQ(gainsOf({0.8, 0.6, 0.5, false}).motor, 0.8);
    EXPECT_EQ(gainsOf({0.8, 0.6, 0.5, false}).cutting, 0.6);
    EXPECT_EQ(gainsOf({1.0, 1.0, 0.5, true}).motor, 0.0);
    EXPECT_EQ(gainsOf({std::nan(""), 7.0, 0.5, false}).motor, 0.0);
    OfflinePlayer player;
    player.setMix({1.0, 1.0, 0.5, true});
    std::vector<float> heard;
    player.advance(0.1, turning(400000.0), heard);
    heard.clear();
    player.advance(0.2, turning(400000.0), heard);
    EXPECT_LT(db(rms(channel(heard, 0))), -100.0);
}

TEST(Space, LeftAndRightNearAndFar) {
    for (const bool headphones : {true, false}) {
        const auto heardAt = [&](const core::Vec3& place, std::size_t ear) {
            OfflinePlayer player(headphones);
            Ear listener;  // looks along +y
            listener.eyeMm = {0, -72, 0};
            listener.forward = {0, 1, 0};
            listener.up = {0, 0, 1};
            player.setEar(listener);
            DrillState drill = turning(400000.0);
            drill.positionMm = place;
            drill.axis = {0, 1e-6, 0};  // the motor at the same place
            std::vector<float> heard;
            player.advance(0.2, drill, heard);
            heard.clear();
            player.advance(0.5, drill, heard);
            return rms(channel(heard, ear));
        };
        EXPECT_GT(db(heardAt({40, 0, 0}, 1) / heardAt({40, 0, 0}, 0)), 3.0) << headphones;
        EXPECT_GT(db(heardAt({-40, 0, 0}, 0) / heardAt({-40, 0, 0}, 1)), 3.0) << headphones;
        EXPECT_NEAR(db(heardAt({0, 0, 0}, 0) / heardAt({0, 0, 0}, 1)), 0.0, 0.5) << headphones;
        EXPECT_NEAR(db(heardAt({0, 72, 0}, 0) / heardAt({0, 0, 0}, 0)), -6.02, 0.2) << headphones;
        // No louder than three times however near.
        EXPECT_NEAR(db(heardAt({0, -71, 0}, 0) / heardAt({0, 0, 0}, 0)), db(3.0), 0.3) << headphones;
    }
}

TEST(Space, MotorIsAboveTheBur) {
    DrillState drill;
    drill.positionMm = {1, 2, 3};
    EXPECT_NEAR((motorPositionMm(drill) - core::Vec3(1, 2, 18)).norm(), 0.0, 1e-12);
}

TEST(Offline, SameInputsSameSound) {
    std::vector<float> a, b;
    for (auto* out : {&a, &b}) {
        OfflinePlayer player;
        for (int i = 1; i <= 200; ++i)
            player.advance(i * 1e-3, i < 100 ? turning(300000.0) : cuttingState(cases::Tissue::enamel), *out);
    }
    EXPECT_EQ(a, b);
    EXPECT_EQ(a.size(), 2u * 9600u);
}

TEST(Offline, ContactIsHeardWithinItsDelay) {
    OfflinePlayer player(false);
    player.setMix({0.0, 1.0, 0.5, false});
    std::vector<float> heard;
    player.advance(0.1, turning(380000.0), heard);
    const std::size_t contact = heard.size() / 2;
    player.advance(0.3, cuttingState(cases::Tissue::enamel), heard);
    const auto x = channel(heard, 0);
    const double full = rms(x, contact + 4800, x.size());
    std::size_t first = contact;
    while (first < x.size() && std::abs(x[first]) < 0.1 * full)
        ++first;
    const double ms = static_cast<double>(first - contact) / 48.0;
    std::printf("contact to sound, without a card: %.2f ms\n", ms);
    EXPECT_GE(first - contact, static_cast<std::size_t>(OfflinePlayer::kDelayFrames));
    EXPECT_LT(ms, 8.0);
    for (std::size_t i = 0; i < contact; ++i)
        ASSERT_LT(std::abs(x[i]), 1e-6);
}

TEST_F(Files, RecordingLoopsAndChangesWithoutAClick) {
    // A length that is no whole number of periods: the seam has to be made.
    const fs::path file = sine(200.0, 0.3137);
    OfflinePlayer player(false);
    Ear ear;
    player.setEar(ear);
    player.setRecordings({file, 0.0}, {});
    std::vector<float> heard;
    const auto run = [&](double until, const DrillState& drill) {
        for (double t = static_cast<double>(heard.size()) / 96000.0 + 1e-3; t < until + 5e-4; t += 1e-3)
            player.advance(t, drill, heard);
    };
    DrillState on = turning(400000.0), off = turning(0.0, 0.0);
    run(0.2, off);  // start
    run(1.5, on);   // several loop points
    const std::size_t steady = heard.size() / 2;
    player.setMix({0.3, 1.0, 0.5, false});
    run(1.7, on);
    player.setMix({1.0, 1.0, 0.5, true});
    run(1.9, on);
    player.setMix({});
    run(2.1, on);
    on.positionMm = {20, 0, 0};  // another place
    run(2.3, on);
    ear.eyeMm = {0, -30, 20};
    player.setEar(ear);
    run(2.5, on);
    run(2.8, off);  // stop
    for (std::size_t c = 0; c < 2; ++c) {
        const auto x = channel(heard, c);
        const double full = std::numbers::sqrt2 * rms(x, steady - 9600, steady);
        EXPECT_GT(full, 0.02);
        EXPECT_LT(db(click(x, 19200, steady) / full), -60.0) << "loop";
        EXPECT_LT(db(click(x) / full), -60.0) << "changes";
        std::printf("channel %d: loop %.1f dB, changes %.1f dB\n", static_cast<int>(c),
                    db(click(x, 19200, steady) / full), db(click(x) / full));
        // The loop neither swells nor sinks at its seam.
        for (std::size_t i = 24000; i + 480 < steady; i += 240)
            ASSERT_NEAR(db(std::numbers::sqrt2 * rms(x, i, i + 480) / full), 0.0, 1.0);
        // The same with the recording's own ends put together: the measure hears the seam.
        std::vector<double> hard;
        for (int i = 0; i < 20000; ++i)
            hard.push_back(full * std::sin(2.0 * std::numbers::pi * 200.0 * (i % 15057) / 48000.0));
        EXPECT_GT(db(click(hard) / full), -60.0);
    }
}

TEST_F(Files, RecordingFollowsTheSpeed) {
    const auto loop = loadLoop({sine(1000.0, 1.0, 44100.0), 200000.0});
    for (const double rpm : {100000.0, 200000.0, 400000.0}) {
        LoopVoice voice(loop);
        std::vector<float> x(24000, 0.0f);
        voice.render(rpm, 1.0, x);
        const std::vector<double> y(x.begin() + 4800, x.end());
        EXPECT_NEAR(test::peakNear(y, 1000.0 * rpm / 200000.0, 0.02) / (1000.0 * rpm / 200000.0), 1.0, 0.003);
        EXPECT_NEAR(rms(y) / kNominalRms, 1.0, 0.05);
    }
}

TEST_F(Files, WavComesBack) {
    Wav wav{44100, 2, {0.0f, 0.5f, -0.5f, 2.0f, -2.0f, 0.25f}};
    writeWav(wav, folder / "a.wav");
    const Wav back = readWav(folder / "a.wav");
    EXPECT_EQ(back.rateHz, 44100);
    EXPECT_EQ(back.channels, 2);
    ASSERT_EQ(back.samples.size(), 6u);
    EXPECT_NEAR(back.samples[1], 0.5, 1e-4);
    EXPECT_NEAR(back.samples[3], 1.0, 1e-4);  // held, not wrapped
    EXPECT_NEAR(back.samples[4], -1.0, 1e-4);
}

TEST_F(Files, BadWavIsToldClearly) {
    EXPECT_FALSE(test::errorOf([&] { (void)readWav(folder / "none.wav"); }).empty());
    std::ofstream(folder / "empty.wav");
    EXPECT_NE(test::errorOf([&] { (void)readWav(folder / "empty.wav"); }).find("empty"), std::string::npos);
    std::ofstream(folder / "text.wav") << "this is no sound at all, only a few words";
    EXPECT_NE(test::errorOf([&] { (void)readWav(folder / "text.wav"); }).find("no WAV"), std::string::npos);
    const fs::path good = sine(200.0, 0.5);
    std::ifstream in(good, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), {});
    for (const std::size_t n : {std::size_t{10}, std::size_t{30}, std::size_t{44}, bytes.size() / 2}) {
        std::ofstream(folder / "part.wav", std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(n));
        OfflinePlayer player;
        const std::string problem = test::errorOf([&] { player.setRecordings({folder / "part.wav", 0.0}, {}); });
        EXPECT_NE(problem.find("part.wav"), std::string::npos) << n;
    }
    OfflinePlayer player;
    EXPECT_NE(test::errorOf([&] {
                  player.setRecordings({sine(200.0, 61.0), 0.0}, {});
              }).find("61 s"),
              std::string::npos);
    EXPECT_FALSE(test::errorOf([&] { player.setRecordings({sine(200.0, 0.05), 0.0}, {}); }).empty());
    EXPECT_FALSE(test::errorOf([&] { player.setRecordings({sine(200.0, 0.5), -5.0}, {}); }).empty());
    EXPECT_NE(test::errorOf([&] {
                  (void)makeLoop({48000, 1, std::vector<float>(9600)}, 0.0, "x");
              }).find("silent"),
              std::string::npos);
    EXPECT_FALSE(test::errorOf([&] { writeWav({48000, 1, {0.0f}}, folder / "no" / "such" / "a.wav"); }).empty());
}

TEST(State, OfTwoSamples) {
    messages::HapticSample before, now;
    before.tick = 10;
    before.timeS = 0.010;
    now.tick = 12;
    now.timeS = 0.012;
    now.removedMm3[1] = 0.004;
    now.pedal = 1.0;
    now.flags = messages::kCutting;
    now.tissue = 1;
    const DrillState drill = drillStateOf(before, now, 1e-3, 0.4, 6, 400000.0);
    EXPECT_NEAR(drill.removalMm3S, 2.0, 1e-9);
    EXPECT_TRUE(drill.cutting && drill.water && !drill.stalled);
    EXPECT_EQ(drill.tissue, cases::Tissue::enamel);
    EXPECT_EQ(drillStateOf(now, before, 1e-3, 0.4, 6, 400000.0).removalMm3S, 0.0);
}

}  // namespace
}  // namespace handpiece::sound::sound_test
