// SPDX-License-Identifier: Apache-2.0
// The player's own thread. Run twice: without any sound card, and with OpenAL's writer of files as the card, which
// takes its time as a card does. HANDPIECE_TEST_CARD says which.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "handpiece/base/core/error.h"
#include "handpiece/senses/sound/player.h"
#include "support/random.h"

namespace handpiece::sound::device_test {
namespace {

using namespace std::chrono_literals;

constexpr std::uintmax_t kSecondBytes = 48000 * 2 * 4;  // in stereo, of 32 bits at the most

bool withCard() {
    const char* card = std::getenv("HANDPIECE_TEST_CARD");
    return card && std::string(card) == "wave";
}

/// What the card plays.
std::filesystem::path played() {
    static const test::TemporaryFolder folder;
    return folder.path() / "played.wav";
}

/// OpenAL reads its settings once, at the first call: they are there before any test.
const bool kPrepared = [] {
    if (withCard()) {
        const auto settings = played().parent_path() / "card.conf";
        std::ofstream(settings) << "[general]\ndrivers = wave\nperiod_size = 128\nperiods = 3\n[wave]\nfile = "
                                << played().string() << "\n";
        setenv("ALSOFT_CONF", settings.c_str(), 1);
    } else {
        setenv("ALSOFT_DRIVERS", "null", 1);
    }
    return true;
}();

/// Waits for what must come about, a minute at most.
PlayerStatus wait(const Player& player, const std::function<bool(const PlayerStatus&)>& until) {
    for (int i = 0; i < 6000 && !until(player.status()); ++i)
        std::this_thread::sleep_for(10ms);
    return player.status();
}

TEST(Device, WithoutACardItIsSilentAndGoesOn) {
    if (withCard()) GTEST_SKIP() << "the other run";
    ASSERT_TRUE(kPrepared);
    Player player;
    player.setDrill({});
    player.setEar({});
    player.setMix({});
    const auto status = wait(player, [](const PlayerStatus& s) { return s.device != "looking for a sound card"; });
    EXPECT_TRUE(status.silent);
    EXPECT_NE(status.device.find("no sound card"), std::string::npos) << status.device;
    EXPECT_EQ(status.latencyMs, 0.0);
}

TEST(Device, NoMicrophoneIsToldClearly) {
    if (withCard()) GTEST_SKIP() << "the other run";
    try {
        const Microphone microphone;
        FAIL() << "there is one";
    } catch (const core::Error& error) {
        EXPECT_NE(std::string(error.what()).find("no microphone"), std::string::npos);
    }
}

TEST(Device, PlaysAndKeepsTheBooks) {
    if (!withCard()) GTEST_SKIP() << "the other run";
    {
        Player player;
        DrillState drill;
        drill.speedRpm = 300000.0;
        drill.pedal = 1.0;
        player.setDrill(drill);
        const auto status = wait(player, [](const PlayerStatus& s) {
            std::error_code none;
            const auto bytes = std::filesystem::file_size(played(), none);
            return !s.silent && s.latencyMs > 0.0 && !none && bytes > kSecondBytes;
        });
        EXPECT_FALSE(status.silent) << status.device;
        // Queue (period and spare), a block, and at least one period of the device; more after each time it ran dry.
        EXPECT_GT(status.latencyMs, (128 + 192) / 48.0);
        EXPECT_LT(status.latencyMs, status.underruns == 0 ? 30.0 : 300.0);
        std::printf("latency %.2f ms, underruns %d\n", status.latencyMs, static_cast<int>(status.underruns));
    }
    const Wav wav = readWav(played());
    EXPECT_GT(wav.samples.size(), kSecondBytes / 5);  // but for its head
    double peak = 0.0;
    for (const float v : wav.samples)
        peak = std::max(peak, static_cast<double>(std::abs(v)));
    EXPECT_GT(peak, 0.05);
}

}  // namespace
}  // namespace handpiece::sound::device_test
