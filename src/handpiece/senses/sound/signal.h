// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The small parts that voices are made of: gliding values, noise, a filter that may be turned while it runs. 48 kHz.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace handpiece::sound {

inline constexpr double kSampleRateHz = 48000.0;
/// Parameters are worked out anew every so many samples and pass to their new values in between.
inline constexpr int kControlSamples = 16;

/// A value that passes to its target through two equal low passes: neither it nor its slope ever jumps.
class Glide {
  public:
    explicit Glide(double timeMs, double value = 0.0) noexcept
        : step_(1.0 - std::exp(-1000.0 / (timeMs * kSampleRateHz))), first_(value), value_(value), target_(value) {}
    void setTarget(double target) noexcept { target_ = target; }
    void jump(double value) noexcept { first_ = value_ = target_ = value; }
    double next() noexcept {
        first_ += step_ * (target_ - first_);
        value_ += step_ * (first_ - value_);
        if (std::abs(target_ - first_) < kEnd && std::abs(target_ - value_) < kEnd) first_ = value_ = target_;
        return value_;
    }
    [[nodiscard]] double value() const noexcept { return value_; }
    [[nodiscard]] bool arrived() const noexcept { return value_ == target_ && first_ == target_; }

  private:
    static constexpr double kEnd = 1e-9;  // far below what is heard, far above denormal numbers
    double step_, first_, value_, target_;
};

/// A straight line to the next value over kControlSamples.
class Ramp {
  public:
    void aim(double target) noexcept { slope_ = (target - value_) / kControlSamples; }
    double next() noexcept { return value_ += slope_; }
    [[nodiscard]] double value() const noexcept { return value_; }

  private:
    double value_ = 0.0, slope_ = 0.0;
};

/// White noise of root mean square 1 (uniform), the same from the same seed.
class Noise {
  public:
    explicit Noise(std::uint32_t seed) noexcept : state_(seed * 2654435769u + 1u) {
        if (state_ == 0) state_ = 1;
    }
    double next() noexcept {
        state_ ^= state_ << 13;
        state_ ^= state_ >> 17;
        state_ ^= state_ << 5;
        return static_cast<double>(static_cast<std::int32_t>(state_)) * (0x1p-31 * std::numbers::sqrt3);
    }

  private:
    std::uint32_t state_;
};

/// A slow random swing of root mean square about 1: noise through two low passes.
class Wander {
  public:
    Wander(std::uint32_t seed, double cornerHz) noexcept
        : noise_(seed),
          step_(1.0 - std::exp(-2.0 * std::numbers::pi * cornerHz / kSampleRateHz)),
          scale_(std::sqrt((2.0 - step_) * (2.0 - step_) * (2.0 - step_) /
                           (step_ * (1.0 + (1.0 - step_) * (1.0 - step_))))) {}
    double next() noexcept {
        first_ += step_ * (noise_.next() - first_);
        value_ += step_ * (first_ - value_);
        return scale_ * value_;
    }

  private:
    Noise noise_;
    double step_, scale_, first_ = 0.0, value_ = 0.0;
};

/// A two-pole filter (trapezoidal state variable). Turned over kControlSamples, it stays stable and smooth.
class Filter {
  public:
    /// At once.
    void tune(double centreHz, double q) noexcept {
        aim(centreHz, q);
        while (turning_ > 0)
            turn();
    }
    void aim(double centreHz, double q) noexcept {
        const double hz = std::clamp(centreHz, 20.0, 0.45 * kSampleRateHz);
        if (hz == hz_ && q == q_) return;
        hz_ = hz;
        q_ = q;
        gSlope_ = (std::tan(std::numbers::pi * hz / kSampleRateHz) - g_) / kControlSamples;
        kSlope_ = (1.0 / q - k_) / kControlSamples;
        turning_ = kControlSamples;
    }
    /// Band pass; white noise of root mean square 1 comes out with root mean square 1, whatever centre and width.
    double band(double in) noexcept {
        pass(in);
        return k_ * even_ * band_;
    }
    double high(double in) noexcept {
        pass(in);
        return in - k_ * band_ - low_;
    }

  private:
    void turn() noexcept {
        g_ += gSlope_;
        k_ += kSlope_;
        a1_ = 1.0 / (1.0 + g_ * (g_ + k_));
        even_ = 1.0 / std::sqrt(g_ * k_ * a1_);  // the share of white noise that the band lets through
        --turning_;
    }
    void pass(double in) noexcept {
        if (turning_ > 0) turn();
        const double v3 = in - low2_;
        band_ = a1_ * (band2_ + g_ * v3);
        low_ = low2_ + g_ * band_;
        band2_ = 2.0 * band_ - band2_;
        low2_ = 2.0 * low_ - low2_;
    }
    double hz_ = 0.0, q_ = 0.0, g_ = 0.1, k_ = 1.0, gSlope_ = 0.0, kSlope_ = 0.0, a1_ = 0.9, even_ = 1.0;
    double band_ = 0.0, low_ = 0.0, band2_ = 0.0, low2_ = 0.0;
    int turning_ = 0;
};

/// 1 in what is heard, 0 from 21 kHz on: tones leave smoothly before they would fold back.
[[nodiscard]] inline double audible(double hz) noexcept {
    const double t = std::clamp((21000.0 - hz) / 4000.0, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

[[nodiscard]] inline double fromDecibel(double db) noexcept {
    return std::pow(10.0, db / 20.0);
}

}  // namespace handpiece::sound
