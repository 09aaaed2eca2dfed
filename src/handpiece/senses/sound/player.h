// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Plays the drill: two sources in space, motor and cutting, heard from the eye (the paper's Figure 6).

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "handpiece/senses/sound/state.h"

namespace handpiece::sound {

struct PlayerStatus {
    bool silent = false;     ///< there is no sound card: nothing is played, all else goes on
    std::string device;      ///< its name, or why there is none
    double latencyMs = 0.0;  ///< from a state given to the ear, as far as the device tells
    std::uint64_t underruns = 0;
};

struct PlayerSettings {
    bool headphones = true;  ///< HRTF, where the device is stereo and has the data; else plain panning
};

/// Asks OpenAL for short periods (3 of 128 samples): with its own 3 of 1024 contact and sound are 70 ms apart. In main,
/// before any thread and any other call of this header: it sets an environment variable for a moment. Leaves a machine
/// alone whose user has set ALSOFT_CONF. Returns whether it asked.
bool preferLowLatency();

/// Plays through the default output, on a thread of its own. Without a sound card it says so and does nothing; it looks
/// for one again after 10 s, then ever more rarely. A card that is lost counts as none.
class Player {
  public:
    explicit Player(const PlayerSettings& settings = {});
    ~Player();
    Player(const Player&) = delete;
    Player& operator=(const Player&) = delete;

    // From one thread each; none ever waits.
    void setDrill(const DrillState& drill) noexcept;
    void setEar(const Ear& ear) noexcept;
    void setMix(const Mix& mix) noexcept;
    /// Reads the file here and now. Throws core::Error: not a WAV, empty, longer than a minute.
    void setRecordings(const Recording& motor, const Recording& cutting);
    [[nodiscard]] PlayerStatus status() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The same sound through OpenAL's loopback device, as fast as it computes: for files and tests.
class OfflinePlayer {
  public:
    /// 48 kHz stereo, with HRTF (headphones) or plain. Throws core::Error when OpenAL has no loopback.
    explicit OfflinePlayer(bool headphones = true);
    ~OfflinePlayer();
    OfflinePlayer(const OfflinePlayer&) = delete;
    OfflinePlayer& operator=(const OfflinePlayer&) = delete;

    void setEar(const Ear& ear);
    void setMix(const Mix& mix);
    void setRecordings(const Recording& motor, const Recording& cutting);
    /// What is heard from the last call up to `timeS` while the drill passes to this state. Interleaved left, right;
    /// appended to `out`. Sound comes kDelayFrames after its cause. Throws core::Error for a time that is not finite or
    /// more than an hour on; one in the past adds nothing.
    void advance(double timeS, const DrillState& drill, std::vector<float>& out);
    static constexpr int kRateHz = 48000;
    static constexpr int kDelayFrames = 128;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// 16-bit stereo or mono WAV at kRateHz. writeWav: beside its place and renamed. Throw core::Error.
struct Wav {
    int rateHz = 48000, channels = 1;
    std::vector<float> samples;  ///< interleaved, -1..1
};
void writeWav(const Wav& wav, const std::filesystem::path& path);
[[nodiscard]] Wav readWav(const std::filesystem::path& path);

/// Records from the default microphone through OpenAL capture. Mono, 48 kHz.
class Microphone {
  public:
    /// Throws core::Error when there is none.
    Microphone();
    ~Microphone();
    Microphone(const Microphone&) = delete;
    Microphone& operator=(const Microphone&) = delete;
    /// Takes what has come in since the last call; returns its peak 0..1 for a level meter.
    double poll();
    /// Ends; what was recorded.
    [[nodiscard]] Wav finish();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::sound
