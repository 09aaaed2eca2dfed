// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/sound/voices.h"

#include <algorithm>
#include <cmath>

namespace handpiece::sound {
namespace {

double volume(double value) noexcept {
    return std::isfinite(value) ? std::clamp(value, 0.0, 1.0) : 0.0;
}

}  // namespace

Gains gainsOf(const Mix& mix) noexcept {
    if (mix.muted) return {0.0, 0.0};
    const double balance = volume(mix.balance);
    return {volume(mix.motor) * std::min(1.0, 2.0 * (1.0 - balance)),
            volume(mix.cutting) * std::min(1.0, 2.0 * balance)};
}

template <class Synthesis>
void Voice<Synthesis>::use(std::shared_ptr<const Loop> loop) noexcept {
    next_ = std::move(loop);
    change_ = true;
}

template <class Synthesis>
void Voice<Synthesis>::render(const DrillState& drill, double level, double gain, std::span<float> out) noexcept {
    std::fill(out.begin(), out.end(), 0.0f);
    // Down to nothing, over, and up again.
    if (change_ && fade_.value() < 1e-6) {
        change_ = false;
        loop_.reset();
        if (next_) loop_.emplace(std::move(next_));
        next_.reset();
    }
    fade_.setTarget(change_ ? 0.0 : 1.0);
    if (!begun_) gain_.jump(gain);  // out of silence: muted is muted from the beginning
    begun_ = true;
    gain_.setTarget(gain);
    if (loop_)
        loop_->render(drill.speedRpm, level, out);
    else
        synthesis_.render(drill, out);
    for (float& sample : out)
        sample *= static_cast<float>(gain_.next() * fade_.next());
}

void Voices::useLoops(std::shared_ptr<const Loop> motor, std::shared_ptr<const Loop> cutting) noexcept {
    motor_.use(std::move(motor));
    cutting_.use(std::move(cutting));
}

void Voices::render(const DrillState& drill, const Mix& mix, std::span<float> motor,
                    std::span<float> cutting) noexcept {
    const Gains gains = gainsOf(mix);
    const double free = std::isfinite(drill.freeSpeedRpm) ? std::max(1000.0, drill.freeSpeedRpm) : 400000.0;
    const double share = std::isfinite(drill.speedRpm) ? std::clamp(drill.speedRpm / free, 0.0, 1.25) : 0.0;
    // A recording has motor, air and spray in one: it goes by the speed alone.
    const double motorLevel = fromDecibel(driveLevelDb(free)) * share * std::sqrt(share);
    const double cuttingSound = cuttingLevel(drill) * fromDecibel(tissueVoice(drill.tissue).levelDb);
    motor_.render(drill, motorLevel, gains.motor, motor);
    cutting_.render(drill, cuttingSound, gains.cutting, cutting);
}

template class Voice<MotorVoice>;
template class Voice<CuttingVoice>;

}  // namespace handpiece::sound
