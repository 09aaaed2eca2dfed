// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a run sounds like, as a WAV file.

#include <filesystem>
#include <vector>

#include "handpiece/base/messages/haptic_sample.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/instrument/cutting_parameters.h"
#include "handpiece/model/instrument/rotor.h"
#include "handpiece/senses/sound/player.h"

namespace handpiece::cli {

/// Listens to a loop as the eye over the tooth would, with headphones; one thread.
class SoundTrack {
  public:
    /// Throws core::Error: a folder that cannot be written, a run of more than an hour.
    SoundTrack(std::filesystem::path file, const instrument::Bur& bur,
               const instrument::CuttingParameters& cuttingParameters, const instrument::Drive& drive, double rateHz,
               double durationS);
    void take(const messages::HapticSample& sample);
    /// Lets the last sound die away and writes the file. Throws core::Error.
    void finish();

  private:
    std::filesystem::path file_;
    double burRadiusMm_, freeSpeedRpm_, periodS_;
    int edges_;
    sound::OfflinePlayer player_;
    sound::DrillState drill_;
    messages::HapticSample before_;
    bool begun_ = false;
    std::vector<float> heard_;
};

}  // namespace handpiece::cli
