// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Motor and cutting as two blocks of samples, mixed as asked: what the player puts into space.

#include <memory>
#include <optional>
#include <span>

#include "handpiece/senses/sound/recording.h"
#include "handpiece/senses/sound/state.h"
#include "handpiece/senses/sound/synthesis.h"

namespace handpiece::sound {

/// Gain of each voice. 0 and 1 of the balance leave one voice alone; the middle leaves both as they are.
struct Gains {
    double motor = 1.0, cutting = 1.0;
};
/// What is not a number counts as 0; all is held in 0..1.
[[nodiscard]] Gains gainsOf(const Mix& mix) noexcept;

/// One source of sound: the synthesis, or a loop instead. One thread.
template <class Synthesis>
class Voice {
  public:
    /// Passes over to a loop, or with null to the synthesis: down, over and up again in about 0.1 s.
    void use(std::shared_ptr<const Loop> loop) noexcept;
    /// Writes `out`. `level`: of a loop, as loud as the synthesis would be.
    void render(const DrillState& drill, double level, double gain, std::span<float> out) noexcept;

  private:
    Synthesis synthesis_;
    std::optional<LoopVoice> loop_;
    std::shared_ptr<const Loop> next_;
    bool change_ = false, begun_ = false;
    Glide gain_{5.0, 1.0}, fade_{3.0, 1.0};
};

/// Both.
class Voices {
  public:
    void useLoops(std::shared_ptr<const Loop> motor, std::shared_ptr<const Loop> cutting) noexcept;
    /// The next samples of both; the blocks are of one length.
    void render(const DrillState& drill, const Mix& mix, std::span<float> motor, std::span<float> cutting) noexcept;

  private:
    Voice<MotorVoice> motor_;
    Voice<CuttingVoice> cutting_;
};

}  // namespace handpiece::sound
