// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/sound/recording.h"

#include <fmt/format.h>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/senses/sound/synthesis.h"

namespace handpiece::sound {
namespace {

constexpr double kLoopRateHz = 96000.0;
// What each octave keeps: the ear's range; half and a quarter of it, for playing twice and four times as fast.
constexpr std::array<double, Loop::kOctaves> kKeptHz{20000.0, 10500.0, 5250.0};

std::vector<double> oneChannel(const Wav& wav) {
    const auto channels = static_cast<std::size_t>(wav.channels);
    std::vector<double> mono(wav.samples.size() / channels);
    for (std::size_t i = 0; i < mono.size(); ++i) {
        double sum = 0.0;
        for (std::size_t c = 0; c < channels; ++c)
            sum += wav.samples[i * channels + c];
        mono[i] = sum / static_cast<double>(channels);
    }
    return mono;
}

/// How alike two stretches are: 1 the same, 0 unlike.
double likeness(const double* a, const double* b, std::size_t n) {
    double ab = 0.0, aa = 0.0, bb = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        ab += a[i] * b[i];
        aa += a[i] * a[i];
        bb += b[i] * b[i];
    }
    return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

/// The end fades into the beginning. Where they are alike the sum of the two is evened out for it, so that neither a
/// tone nor a noise swells or sinks there.
std::vector<double> closed(const std::vector<double>& x, double rateHz) {
    const std::size_t fade = std::min(x.size() / 4, static_cast<std::size_t>(0.25 * rateHz));
    const std::size_t longest = x.size() - fade, compare = std::min<std::size_t>(fade, 2048);
    const std::size_t search = std::min(x.size() / 8, static_cast<std::size_t>(0.05 * rateHz));
    std::size_t length = longest;
    double best = -2.0;
    for (std::size_t back = 0; back <= search; ++back) {
        const double alike = likeness(x.data(), x.data() + longest - back, compare);
        if (alike > best + 1e-9) {
            best = alike;
            length = longest - back;
        }
    }
    const double r = std::clamp(likeness(x.data(), x.data() + length, fade), 0.0, 1.0);
    std::vector<double> loop(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(length));
    for (std::size_t i = 0; i < fade; ++i) {
        const double in =
            0.5 - 0.5 * std::cos(std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(fade));
        const double out = 1.0 - in, even = 1.0 / std::sqrt(in * in + out * out + 2.0 * in * out * r);
        loop[i] = even * (in * x[i] + out * x[length + i]);
    }
    return loop;
}

/// The endless loop at another rate, without what lies above `keptHz`: a windowed sinc that wraps around, from a table
/// of places between two samples.
std::vector<float> resampled(const std::vector<double>& loop, double rateHz, double keptHz) {
    const auto size = static_cast<std::size_t>(std::llround(static_cast<double>(loop.size()) * kLoopRateHz / rateHz));
    const double stretch = static_cast<double>(loop.size()) / static_cast<double>(size);
    const double cut = std::min(keptHz, 0.46 * rateHz) / rateHz;  // in turns a sample of the loop
    constexpr double kZeros = 16.0;
    constexpr std::size_t kPlaces = 512;
    const auto reach = static_cast<std::size_t>(std::ceil(kZeros * 0.5 / cut)), taps = 2 * reach;
    std::vector<float> table((kPlaces + 1) * taps);
    for (std::size_t place = 0; place <= kPlaces; ++place) {
        double weight = 0.0;
        std::vector<double> row(taps);
        for (std::size_t k = 0; k < taps; ++k) {
            const double d = static_cast<double>(k) + 1.0 - static_cast<double>(reach) -
                             static_cast<double>(place) / static_cast<double>(kPlaces);
            const double x = 2.0 * std::numbers::pi * cut * d;
            const double window = 0.5 + 0.5 * std::cos(std::numbers::pi * d / static_cast<double>(reach));
            row[k] = window * (std::abs(x) < 1e-9 ? 1.0 : std::sin(x) / x);
            weight += row[k];
        }
        for (std::size_t k = 0; k < taps; ++k)
            table[place * taps + k] = static_cast<float>(row[k] / weight);
    }
    std::vector<float> wrapped(loop.size() + taps + 1);
    for (std::size_t i = 0; i < wrapped.size(); ++i)
        wrapped[i] = static_cast<float>(loop[(i + loop.size() * taps - reach + 1) % loop.size()]);
    std::vector<float> out(size);
    core::parallelFor(size, 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const double at = static_cast<double>(i) * stretch;
            const auto whole = static_cast<std::size_t>(at);
            const double between = (at - static_cast<double>(whole)) * kPlaces;
            const auto place = std::min(static_cast<std::size_t>(between), kPlaces - 1);
            const float t = static_cast<float>(between - static_cast<double>(place));
            const float *x = &wrapped[whole], *a = &table[place * taps], *b = a + taps;
            float evens = 0.0f, odds = 0.0f;
            for (std::size_t k = 0; k < taps; k += 2) {
                evens += x[k] * (a[k] + t * (b[k] - a[k]));
                odds += x[k + 1] * (a[k + 1] + t * (b[k + 1] - a[k + 1]));
            }
            out[i] = evens + odds;
        }
    });
    return out;
}

double at(const std::vector<float>& x, double place) noexcept {
    const auto n = x.size();
    const auto i = static_cast<std::size_t>(place);
    const double t = place - static_cast<double>(i);
    const double a = x[(i + n - 1) % n], b = x[i % n], c = x[(i + 1) % n], d = x[(i + 2) % n];
    // Cubic through value and slope of both neighbours.
    return b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)));
}

}  // namespace

std::shared_ptr<const Loop> makeLoop(const Wav& wav, double recordedAtRpm, const std::string& where) {
    if (wav.rateHz < 8000 || wav.rateHz > 192000)
        throw core::Error(fmt::format("the recording has {} samples a second", wav.rateHz), where,
                          "record with 8,000 to 192,000; 48,000 is what the program itself uses")
            .as("sound-unfit");
    if (!(recordedAtRpm == 0.0 || (recordedAtRpm >= 1000.0 && recordedAtRpm <= 1e6)))
        throw core::Error(fmt::format("a recording taken at {:.6g} rpm", recordedAtRpm), where,
                          "give 1,000 to 1,000,000, or 0 for a pitch that stays");
    const std::vector<double> mono = wav.channels > 0 ? oneChannel(wav) : std::vector<double>{};
    const double lastsS = static_cast<double>(mono.size()) / wav.rateHz;
    if (lastsS > kLongestRecordingS)
        throw core::Error(fmt::format("the recording lasts {:.0f} s", lastsS), where,
                          "cut out up to a minute in which the handpiece runs evenly")
            .as("sound-too-long");
    if (lastsS < kShortestRecordingS)
        throw core::Error(fmt::format("the recording lasts {:.3f} s", lastsS), where,
                          "a tenth of a second is the least")
            .as("sound-too-short");
    double power = 0.0;
    for (const double v : mono)
        power += v * v;
    const double rms = std::sqrt(power / static_cast<double>(mono.size()));
    if (!(rms > 1e-4))
        throw core::Error("the recording is silent", where, "check the microphone and its level").as("sound-silent");
    std::vector<double> loop = closed(mono, wav.rateHz);
    for (double& v : loop)
        v *= kNominalRms / rms;
    auto made = std::make_shared<Loop>();
    made->recordedAtRpm = recordedAtRpm;
    for (std::size_t octave = 0; octave < Loop::kOctaves; ++octave)
        made->samples[octave] = resampled(loop, wav.rateHz, kKeptHz[octave]);
    return made;
}

std::shared_ptr<const Loop> loadLoop(const Recording& recording) {
    if (recording.file.empty()) return nullptr;
    return makeLoop(readWav(recording.file), recording.recordedAtRpm, recording.file.string());
}

LoopVoice::LoopVoice(std::shared_ptr<const Loop> loop) noexcept
    : loop_(std::move(loop)), rate_(3.0, 1.0), level_(2.0) {}

void LoopVoice::render(double speedRpm, double level, std::span<float> out) noexcept {
    double rate = 1.0;
    if (loop_->recordedAtRpm > 0.0)
        rate = std::isfinite(speedRpm) ? std::clamp(speedRpm / loop_->recordedAtRpm, 0.0, 4.0) : 0.0;
    if (level_.value() == 0.0)
        rate_.jump(rate);
    else
        rate_.setTarget(rate);
    level_.setTarget(level);
    const double size = static_cast<double>(loop_->samples[0].size());
    for (float& sample : out) {
        const double r = rate_.next(), gain = level_.next();
        place_ += r * kLoopRateHz / kSampleRateHz;
        if (place_ >= size) place_ -= size;
        if (gain == 0.0) continue;
        // Between octaves, so that nothing folds back into what is heard.
        const double octave = std::clamp(r > 1.0 ? std::log2(r) : 0.0, 0.0, Loop::kOctaves - 1.0);
        const auto lower = std::min(static_cast<std::size_t>(octave), static_cast<std::size_t>(Loop::kOctaves - 2));
        const double t = std::min(1.0, 3.0 * (octave - static_cast<double>(lower)));
        const double value =
            (1.0 - t) * at(loop_->samples[lower], place_) + (t > 0.0 ? t * at(loop_->samples[lower + 1], place_) : 0.0);
        sample += static_cast<float>(gain * value);
    }
}

}  // namespace handpiece::sound
