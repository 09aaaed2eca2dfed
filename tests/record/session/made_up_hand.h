// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Samples of a hand that cuts: strokes of four seconds in six, three joints with encoders of 55 um, gimbals of 1.5
/// mrad that jitter by half a step, noise on force, speed and what is removed. The same for the same seed.

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "handpiece/base/messages/haptic_sample.h"

namespace handpiece::test {

class MadeUpHand {
  public:
    explicit MadeUpHand(std::uint64_t seed = 1, double rateHz = 1000) : generator_(seed), rateHz_(rateHz) {}

    messages::HapticSample next() {
        messages::HapticSample s;
        const double t = static_cast<double>(tick_) / rateHz_;
        s.tick = tick_++;
        s.timeS = t;
        const bool down = std::fmod(t, 6.0) < 4.0;
        pose(t, down, s);
        const double load = down ? 1 + 0.3 * wave(2, t) + 0.05 * noise() : 0.0;
        const double k = 1000 / rateHz_;
        if (down) {
            removed_ += k * 0.0005 * (1 + 0.2 * noise());
            rpm_ += 0.05 * k * (280000 - rpm_ + 3000 * noise());
            s.pedal = std::round((0.9 + 0.02 * std::sin(t)) * 1023) / 1023;
            s.tissue = 1;
            s.flags = messages::kCutting;
            s.loadTorqueNmm = 0.2 * load;
            s.feedMmS = static_cast<float>(0.5 * load * (1 + 0.05 * noise()));
            s.forceN = {0.1 * load + 0.02 * noise(), 0.05 * load + 0.02 * noise(), load};
        } else {
            rpm_ *= 0.999;
        }
        s.pedal = std::nearbyint(s.pedal * 0x1p16) * 0x1p-16;
        s.depthMm = down ? 0.05 * load + 0.001 * noise() : s.positionMm[2];
        s.speedRpm = rpm_;
        s.removedMm3[1] = removed_;
        if (t > 30) s.removedMm3[2] = 0.3 * removed_;
        return s;
    }

  private:
    double noise() { return normal_(generator_); }
    static double wave(double hz, double t) { return std::sin(2 * std::numbers::pi * hz * t); }
    void pose(double t, bool down, messages::HapticSample& s) {
        constexpr double kArmMm = 133, kStep = 0.055 / kArmMm, kGimbalStep = 0.0015;
        double joint[3] = {1.5 * wave(0.5, t) + 0.05 * wave(9, t), 1.5 * wave(0.37, t + 0.7) + 0.05 * wave(8.7, t),
                           (down ? -1 : 2) + 0.3 * wave(0.8, t)};
        for (double& j : joint)
            j = std::round(j / kArmMm / kStep) * kStep;
        const double reach = kArmMm * (std::cos(joint[1]) + std::sin(joint[2]));
        const double p[3] = {reach * std::sin(joint[0]), kArmMm * (std::sin(joint[1]) - std::cos(joint[2]) + 1),
                             reach * std::cos(joint[0]) - kArmMm};
        for (int i = 0; i < 3; ++i) {
            s.positionMm[i] = std::nearbyint(p[i] * 0x1p20) * 0x1p-20;
            velocity_[i] += 0.05 * ((s.positionMm[i] - last_[i]) * rateHz_ - velocity_[i]);
            last_[i] = s.positionMm[i];
            s.velocityMmS[i] = velocity_[i];
        }
        double angle[3] = {0.2 * wave(0.3, t), 0.3 * wave(0.41, t), 0.1 * wave(0.2, t)}, c[3], n[3];
        for (int i = 0; i < 3; ++i) {
            angle[i] = std::round((angle[i] + 0.0008 * noise()) / kGimbalStep) * kGimbalStep;
            c[i] = std::cos(angle[i] / 2), n[i] = std::sin(angle[i] / 2);
        }
        const double q[4] = {c[0] * c[1] * c[2] - n[0] * n[1] * n[2], n[0] * c[1] * c[2] + c[0] * n[1] * n[2],
                             c[0] * n[1] * c[2] - n[0] * c[1] * n[2], c[0] * c[1] * n[2] + n[0] * n[1] * c[2]};
        for (int i = 0; i < 4; ++i)
            s.orientation[i] = std::nearbyint(q[i] * 0x1p30) * 0x1p-30;
    }

    std::mt19937_64 generator_;
    std::normal_distribution<double> normal_;
    double rateHz_;
    std::uint64_t tick_ = 0;
    double removed_ = 0, rpm_ = 0;
    double velocity_[3] = {}, last_[3] = {};
};

}  // namespace handpiece::test
