// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/contact_transient.h"

#include <algorithm>
#include <cstddef>

#include "handpiece/tick/force/wave.h"

namespace handpiece::force {
namespace {

constexpr double kApartS = 0.02;    // a bur that chatters on the surface does not strike it anew each time
constexpr double kMinMmS = 3.0;     // slower than this it is laid down, not struck
constexpr double kNothingN = 1e-3;  // below it the sinusoid has ended
// In the order of cases::Tissue.
constexpr std::array<Knock, cases::kTissueCount> kKnocks{{
    {0.0, 0.0, 0.0},         // none
    {0.010, 300.0, 90.0},    // enamel
    {0.006, 180.0, 120.0},   // dentine
    {0.0, 0.0, 0.0},         // pulp
    {0.0, 0.0, 0.0},         // caries
    {0.0045, 150.0, 130.0},  // cementum
    {0.0, 0.0, 0.0},         // gum
    {0.004, 130.0, 140.0},   // bone
    {0.010, 300.0, 90.0},    // neighbour
    {0.009, 280.0, 100.0},   // restoration
    {0.006, 200.0, 110.0},   // demineralised enamel
    {0.0, 0.0, 0.0},         // carious dentine: soft
    {0.0, 0.0, 0.0},         // soft to leathery
    {0.0, 0.0, 0.0},         // leathery
    {0.001, 120.0, 160.0},   // leathery to firm
    {0.0025, 135.0, 145.0},  // firm
    {0.004, 155.0, 130.0},   // firm to hard
    {0.010, 300.0, 90.0},    // stained enamel
    {0.005, 160.0, 130.0},   // calculus
}};

}  // namespace

const Knock& knockOf(cases::Tissue tissue) noexcept {
    const auto index = static_cast<std::size_t>(tissue);
    return kKnocks[index < kKnocks.size() ? index : 0];
}

core::Vec3 ContactTransient::step(const Strike& strike, const ContactTransients& settings, double periodS) noexcept {
    if (!strike.touching) {
        apartS_ = std::min(apartS_ + periodS, 1.0);
        stop();
        return core::Vec3::Zero();
    }
    const bool struck = apartS_ >= kApartS;
    apartS_ = 0.0;
    const double approachMmS = -strike.velocityMmS.dot(strike.normal);
    if (struck && settings.on && approachMmS > kMinMmS) {
        Knock mean;
        double total = 0.0;
        for (std::size_t i = 0; i < kKnocks.size(); ++i) {
            total += strike.shares[i];
            const double n = strike.shares[i] * kKnocks[i].nPerMmS;
            mean.nPerMmS += n;
            mean.hz += n * kKnocks[i].hz;
            mean.decayPerS += n * kKnocks[i].decayPerS;
        }
        if (mean.nPerMmS > 0.0) {
            mean = {mean.nPerMmS / total, mean.hz / mean.nPerMmS, mean.decayPerS / mean.nPerMmS};
        } else if (!(total > 0.0)) {
            mean = knockOf(strike.tissue);
        }
        amplitudeN_ = std::min(settings.gain * mean.nPerMmS * approachMmS, mostN_);
        hz_ = std::min(mean.hz, mostHz_);
        decayPerS_ = mean.decayPerS;
        normal_ = strike.normal;
        turns_ = 0.0;
    }
    if (!(amplitudeN_ > kNothingN)) {
        stop();
        return core::Vec3::Zero();
    }
    // The strike's own tick is half a step into the wave: the force answers at once, and no tick falls on its zeros.
    const double here = turns_ > 0.0 ? 1.0 : 0.5;
    turns_ += here * hz_ * periodS;
    amplitudeN_ *= decayOver(here * decayPerS_ * periodS);
    return amplitudeN_ * sineOfTurns(turns_) * normal_;
}

}  // namespace handpiece::force
