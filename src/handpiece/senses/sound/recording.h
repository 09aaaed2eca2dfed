// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A recording as a voice: an endless loop without a seam, played as fast as the bur turns.

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "handpiece/senses/sound/player.h"
#include "handpiece/senses/sound/signal.h"
#include "handpiece/senses/sound/state.h"

namespace handpiece::sound {

inline constexpr double kLongestRecordingS = 60.0, kShortestRecordingS = 0.1;

/// A loop in memory, at 96 kHz so that it can be read in between: as it is, and without its upper octaves for playing
/// it up to 2 and 4 times as fast. Immutable.
struct Loop {
    static constexpr int kOctaves = 3;
    std::array<std::vector<float>, kOctaves> samples;
    double recordedAtRpm = 0.0;
};
/// One channel of `wav`, brought to kNominalRms; its end passes into its beginning over up to a quarter of it, at the
/// place where the two are most alike. Throws core::Error naming `where`: too short, too long, silent, a rate that is
/// no sound's.
[[nodiscard]] std::shared_ptr<const Loop> makeLoop(const Wav& wav, double recordedAtRpm, const std::string& where);
/// The loop of a recording's file; null for the synthesis. Throws core::Error.
[[nodiscard]] std::shared_ptr<const Loop> loadLoop(const Recording& recording);

/// Plays a loop. Beyond 4 times the speed it was taken at it goes no higher.
class LoopVoice {
  public:
    explicit LoopVoice(std::shared_ptr<const Loop> loop) noexcept;
    /// Adds the loop, with `level` 1 as loud as kNominalRms, to `out`.
    void render(double speedRpm, double level, std::span<float> out) noexcept;

  private:
    std::shared_ptr<const Loop> loop_;
    Glide rate_, level_;
    double place_ = 0.0;  // in samples of the loop
};

}  // namespace handpiece::sound
