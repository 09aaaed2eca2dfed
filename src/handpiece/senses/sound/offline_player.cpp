// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/senses/sound/player.h"
#include "handpiece/senses/sound/stage.h"
#include "handpiece/senses/sound/voices.h"

namespace handpiece::sound {

// OpenAL passes to new gains and places over one whole update: short ones keep up with the drill.
constexpr int kLongestBlock = 64;

struct OfflinePlayer::State {
    explicit State(bool headphones) : stage(StageKind::loopback, headphones) {}

    Stage stage;
    Voices voices;
    Ear ear;
    Mix mix;
    std::int64_t frames = 0;
    bool started = false;

    void begin() {
        const std::array<float, kLongestBlock> silence{};
        // A source needs what comes next while it plays, or it stops.
        for (int ahead = 0; ahead < kDelayFrames; ahead += kLongestBlock)
            stage.queue(silence, silence);
        stage.start();
        started = true;
    }
};

OfflinePlayer::OfflinePlayer(bool headphones) : state_(std::make_unique<State>(headphones)) {}
OfflinePlayer::~OfflinePlayer() = default;

void OfflinePlayer::setEar(const Ear& ear) {
    state_->ear = ear;
}
void OfflinePlayer::setMix(const Mix& mix) {
    state_->mix = mix;
}
void OfflinePlayer::setRecordings(const Recording& motor, const Recording& cutting) {
    auto motorLoop = loadLoop(motor), cuttingLoop = loadLoop(cutting);
    state_->voices.useLoops(std::move(motorLoop), std::move(cuttingLoop));
}

void OfflinePlayer::advance(double timeS, const DrillState& drill, std::vector<float>& out) {
    State& s = *state_;
    const double ahead = timeS - static_cast<double>(s.frames) / kRateHz;
    if (!(ahead <= 3600.0))
        throw core::Error(fmt::format("sound for {} s at once", ahead), {}, "advance in smaller steps");
    const auto until = static_cast<std::int64_t>(std::floor(timeS * kRateHz + 1e-6));
    std::array<float, kLongestBlock> motor, cutting;
    while (s.frames < until) {
        const auto n = static_cast<std::size_t>(std::min<std::int64_t>(kLongestBlock, until - s.frames));
        s.stage.place(s.ear, motorPositionMm(drill), drill.positionMm, static_cast<double>(n) / kRateHz);
        if (!s.started) s.begin();
        s.voices.render(drill, s.mix, std::span(motor).first(n), std::span(cutting).first(n));
        s.stage.queue(std::span(motor).first(n), std::span(cutting).first(n));
        s.stage.render(static_cast<int>(n), out);
        s.frames += static_cast<std::int64_t>(n);
    }
}

}  // namespace handpiece::sound
