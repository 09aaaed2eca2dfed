// SPDX-License-Identifier: Apache-2.0
#include "cli/sound_track.h"

#include <fmt/format.h>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::cli {

SoundTrack::SoundTrack(std::filesystem::path file, const instrument::Bur& bur,
                       const instrument::CuttingParameters& cuttingParameters, const instrument::Drive& drive,
                       double rateHz, double durationS)
    : file_(std::move(file)),
      burRadiusMm_(bur.maxRadiusMm()),
      freeSpeedRpm_(drive.freeSpeedRpm),
      periodS_(1.0 / rateHz),
      edges_(cuttingParameters.edges) {
    if (durationS > 3600.0)
        throw core::Error(fmt::format("the sound of {:.0f} s", durationS), "--sound", "give at most an hour");
    if (core::isFolder(file_)) throw core::Error("this is a folder", file_.string(), "name the WAV file in it");
    core::prepareOutputFolder(core::wholePath(file_).parent_path());
}

void SoundTrack::take(const messages::HapticSample& sample) {
    drill_ = sound::drillStateOf(begun_ ? before_ : sample, sample, periodS_, burRadiusMm_, edges_, freeSpeedRpm_);
    before_ = sample;
    begun_ = true;
    player_.advance(sample.timeS + periodS_, drill_, heard_);
}

void SoundTrack::finish() {
    if (begun_) {
        drill_.speedRpm = drill_.loadTorqueNmm = drill_.removalMm3S = drill_.pedal = 0.0;
        drill_.cutting = drill_.stalled = drill_.water = false;
        player_.advance(before_.timeS + periodS_ + 0.1, drill_, heard_);
    }
    sound::writeWav({sound::OfflinePlayer::kRateHz, 2, heard_}, file_);
}

}  // namespace handpiece::cli
