// SPDX-License-Identifier: Apache-2.0
#include <AL/al.h>
#include <AL/alc.h>
#include <AL/alext.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/senses/sound/player.h"

namespace handpiece::sound {
namespace {

constexpr int kRateHz = 48000;
constexpr std::size_t kMaxSamples = 60 * kRateHz;  // as long as a recording may be

}  // namespace

struct Microphone::State {
    ALCdevice* device = nullptr;
    Wav wav;
    ~State() {
        if (!device) return;
        alcCaptureStop(device);
        alcCaptureCloseDevice(device);
    }
};

Microphone::Microphone() : state_(std::make_unique<State>()) {
    state_->wav.rateHz = kRateHz;
    state_->wav.channels = 1;
    // 16 bits: every microphone has them. Half a second of room for a poll that comes late.
    if (alcIsExtensionPresent(nullptr, "ALC_EXT_CAPTURE"))
        state_->device = alcCaptureOpenDevice(nullptr, kRateHz, AL_FORMAT_MONO16, kRateHz / 2);
    if (!state_->device)
        throw core::Error("there is no microphone", "OpenAL", "connect one and allow the program to use it")
            .as("no-microphone");
    alcCaptureStart(state_->device);
}

Microphone::~Microphone() = default;

double Microphone::poll() {
    std::array<std::int16_t, 1024> piece;
    int peak = 0;
    if (!state_->device) return 0.0;
    for (;;) {
        ALCint waiting = 0;
        alcGetIntegerv(state_->device, ALC_CAPTURE_SAMPLES, 1, &waiting);
        const auto n = std::min<std::size_t>(piece.size(), static_cast<std::size_t>(std::max(0, waiting)));
        if (n == 0) break;
        alcCaptureSamples(state_->device, piece.data(), static_cast<ALCsizei>(n));
        for (std::size_t i = 0; i < n; ++i) {
            peak = std::max(peak, std::abs(static_cast<int>(piece[i])));
            if (state_->wav.samples.size() < kMaxSamples)
                state_->wav.samples.push_back(static_cast<float>(piece[i]) / 32768.0f);
        }
    }
    return peak / 32768.0;
}

Wav Microphone::finish() {
    poll();
    if (state_->device) {
        alcCaptureStop(state_->device);
        alcCaptureCloseDevice(state_->device);
        state_->device = nullptr;
    }
    return std::move(state_->wav);
}

}  // namespace handpiece::sound
