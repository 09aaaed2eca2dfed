// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The voices of the drill, made sample by sample from its state: motor and cutting. Mono, 48 kHz, -1..1.
///
/// Portable arithmetic, no sound library: the same states give the same samples. docs/sound.md says what each part
/// stands for and where its figures come from. One thread; never allocates. A block may have any length; what it ends
/// at depends only on the states and how many samples each held.

#include <array>
#include <span>

#include "handpiece/senses/sound/signal.h"
#include "handpiece/senses/sound/state.h"

namespace handpiece::sound {

/// Root mean square of the motor of a free-running turbine without air and spray, and of a bur of 0.5 mm radius in
/// enamel at 1 N and 400,000 rpm: the level that recordings are brought to.
inline constexpr double kNominalRms = 0.11;

/// Decibels of a drive's motor over the turbine's: 0 for 400,000 rpm free speed, -22 for 40,000.
[[nodiscard]] double driveLevelDb(double freeSpeedRpm) noexcept;
/// What a tissue's cutting sounds like. docs/sound.md#tissues.
struct TissueVoice {
    double levelDb;        ///< over enamel at the same load
    double lowHz, lowQ;    ///< of the main band
    double highHz, highQ;  ///< of the bright band over it
    double brightness;     ///< amplitude of the bright band over the main one's
};
[[nodiscard]] const TissueVoice& tissueVoice(cases::Tissue tissue) noexcept;
/// 0 without load or turning; 1 for the cut that kNominalRms names, whatever the tissue.
[[nodiscard]] double cuttingLevel(const DrillState& drill) noexcept;

/// Rotor, bearings or gears, air and spray.
class MotorVoice {
  public:
    explicit MotorVoice(std::uint32_t seed = 1) noexcept;
    /// Passes to `drill` and adds what is heard on the way to `out`.
    void render(const DrillState& drill, std::span<float> out) noexcept;

  private:
    static constexpr int kHarmonics = 8;
    void control() noexcept;

    Glide speedHz_, share_, pedal_, spray_, geared_, driveLevel_;
    double turn_ = 0.0, cage_ = 0.0;  // phases, in turns
    std::array<Ramp, kHarmonics> harmonics_;
    Ramp ball_, mesh_, air_, mist_;
    Filter airBand_, mistHigh_;
    Noise airNoise_, mistNoise_;
    Wander rattle_, flutter_;
    int untilControl_ = 0;
};

/// Chips: noise of the tissue's colour that swells with turn and tooth, and the grunt of a bur that sticks.
class CuttingVoice {
  public:
    explicit CuttingVoice(std::uint32_t seed = 2) noexcept;
    /// Passes to `drill` and adds what is heard on the way to `out`.
    void render(const DrillState& drill, std::span<float> out) noexcept;

  private:
    void control() noexcept;

    Glide level_, chatter_, speedHz_, edges_, lowHz_, lowQ_, highHz_, highQ_, tissueDb_, brightness_;

    cases::Tissue tissue_ = cases::Tissue::enamel;
    double turn_ = 0.0, toothTurn_ = 0.0, grunt_ = 0.0;
    Ramp low_, high_, turnTone_, toothTone_, toothSwell_, stick_;
    Filter lowBand_, highBand_, gruntBand_;
    Noise lowNoise_, highNoise_, gruntNoise_;
    Wander crumble_, stagger_;
    int untilControl_ = 0;
};

}  // namespace handpiece::sound
