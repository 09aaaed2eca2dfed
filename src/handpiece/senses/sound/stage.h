// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The room's only hand on OpenAL: a device with two streaming sources in space and a listener. One thread; calls of
/// OpenAL in other threads go on undisturbed, whatever device they are about.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "handpiece/senses/sound/state.h"

namespace handpiece::sound {

enum class StageKind { device, loopback };

class Stage {
  public:
    /// Throws core::Error: no device, one without output, no loopback.
    Stage(StageKind kind, bool headphones);
    ~Stage();
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;

    [[nodiscard]] const std::string& name() const noexcept;
    /// Frames that the device asks for at a time, and their rate.
    [[nodiscard]] int periodFrames() const noexcept;
    [[nodiscard]] bool connected() const noexcept;

    /// Puts listener and sources; they pass there within the next blocks.
    void place(const Ear& ear, const core::Vec3& motorMm, const core::Vec3& cuttingMm, double passedS);
    /// Queues a block of both sources, 48 kHz.
    void queue(std::span<const float> motor, std::span<const float> cutting);
    /// Begins to play what is queued.
    void start();
    /// Frames queued and not yet taken by the device; 0 when it ran dry.
    [[nodiscard]] int queuedFrames();
    /// Whether the sources have stopped for want of blocks since start().
    [[nodiscard]] bool ranDry() const;
    /// From a sample that leaves the queue to the ear, as far as the device tells [s].
    [[nodiscard]] double deviceLatencyS() const;
    /// Loopback only: `frames` of left and right, appended.
    void render(int frames, std::vector<float>& out);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Where the motor is heard: in the handpiece's head, above the bur's tip.
[[nodiscard]] core::Vec3 motorPositionMm(const DrillState& drill);

}  // namespace handpiece::sound
