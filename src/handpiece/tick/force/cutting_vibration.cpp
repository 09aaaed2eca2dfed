// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/cutting_vibration.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "handpiece/tick/force/wave.h"

namespace handpiece::force {
namespace {

constexpr double kLowestHz = 120.0, kSpanHz = 100.0, kUpperTone = 1.6;  // 120..220 and 192..352 Hz
constexpr double kFullRpm = 400000.0;                                   // at which the pitch is highest
constexpr double kSlowRpm = 20000.0;                                    // below it the hum fades with the speed
constexpr double kCapN = 1.5;                                           // more load does not shake more
constexpr double kRubbing = 0.4, kHalfFeedMmS = 0.5;                    // share of a bur that turns without cutting
constexpr double kTauS = 0.01;                                          // of each of the three low passes
constexpr double kMaxOfRate = 0.45;
constexpr double kNothingN = 1e-6;
// In the order of cases::Tissue.
constexpr std::array<Hum, cases::kTissueCount> kHums{{
    {0.0, 0.0},   // none
    {0.20, 0.5},  // enamel
    {0.12, 0.3},  // dentine
    {0.02, 0.0},  // pulp
    {0.05, 0.1},  // caries
    {0.10, 0.3},  // cementum
    {0.03, 0.0},  // gum
    {0.10, 0.3},  // bone
    {0.20, 0.5},  // neighbour
    {0.18, 0.6},  // restoration
    {0.15, 0.4},  // demineralised enamel
    {0.04, 0.1},  // carious dentine: soft
    {0.05, 0.1},  // soft to leathery
    {0.06, 0.1},  // leathery
    {0.07, 0.2},  // leathery to firm
    {0.09, 0.2},  // firm
    {0.1, 0.3},   // firm to hard
    {0.20, 0.5},  // stained enamel
    {0.10, 0.4},  // calculus
}};

}  // namespace

const Hum& humOf(cases::Tissue tissue) noexcept {
    const auto index = static_cast<std::size_t>(tissue);
    return kHums[index < kHums.size() ? index : 0];
}

void BurHum::follow(Smooth& smooth, double target, double periodS) noexcept {
    const double news = periodS / (kTauS + periodS);
    for (double& value : smooth) {
        value += news * (target - value);
        target = value;
    }
}

void BurHum::stop() noexcept {
    low_.fill(0.0);
    high_.fill(0.0);
}

double BurHum::lowerHz() const noexcept {
    return kLowestHz + kSpanHz * pitch_.back();
}

double BurHum::step(const Work& work, const CuttingVibration& settings, double periodS) noexcept {
    double low = 0.0, high = 0.0;
    if (settings.on && work.loadN > 0.0 && work.speedRpm > 0.0) {
        double total = 0.0, strength = 0.0, upper = 0.0;
        for (std::size_t i = 0; i < kHums.size(); ++i) {
            total += work.shares[i];
            strength += work.shares[i] * kHums[i].nPerN;
            upper += work.shares[i] * kHums[i].nPerN * kHums[i].grain;
        }
        if (total > 0.0) {
            strength /= total;
            upper /= total;
        } else {
            strength = humOf(work.tissue).nPerN;
            upper = strength * humOf(work.tissue).grain;
        }
        const double feed = std::max(0.0, work.feedMmS);
        const double biting = kRubbing + (1.0 - kRubbing) * feed / (feed + kHalfFeedMmS);
        const double wanted =
            settings.gain * strength * std::min(work.loadN, kCapN) * biting * std::min(1.0, work.speedRpm / kSlowRpm);
        const double amplitude = std::min({wanted, mostN_, std::max(0.0, work.headroomN)});
        const double grain = strength > 0.0 ? upper / strength : 0.0;
        low = amplitude * (1.0 - grain);
        high = amplitude * grain;
    }
    follow(pitch_, std::min(1.0, work.speedRpm / kFullRpm), periodS);
    const double lowHz = lowerHz(), highHz = kUpperTone * lowHz;
    follow(low_, lowHz < kMaxOfRate * rateHz_ ? low : 0.0, periodS);
    follow(high_, highHz < kMaxOfRate * rateHz_ ? high : 0.0, periodS);
    if (!(amplitudeN() > kNothingN) && low + high <= 0.0) {
        stop();
        lowTurns_ = highTurns_ = 0.0;
        return 0.0;
    }
    lowTurns_ += lowHz * periodS;
    highTurns_ += highHz * periodS;
    lowTurns_ -= std::floor(lowTurns_);
    highTurns_ -= std::floor(highTurns_);
    return low_.back() * sineOfTurns(lowTurns_) + high_.back() * sineOfTurns(highTurns_);
}

}  // namespace handpiece::force
