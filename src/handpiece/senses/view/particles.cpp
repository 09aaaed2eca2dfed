// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/particles.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "handpiece/base/core/split_mix.h"
#include "handpiece/model/instrument/turbine.h"
#include "handpiece/senses/view/renderer.h"

namespace handpiece::view {

using core::Vec3;

namespace {

// Chips and drops in air: Stokes drag, d^2 rho / 18 eta, holds a sphere of 20 to 30 um and dentine's density to its own
// way for 2.5 to 6 ms, so that a chip flies some millimetres and then drifts down. Sizes of chips and drops, and the
// speeds, are chosen for the eye; chips are drawn larger than they are.
constexpr double kGravityMmS2 = 9810.0;
constexpr double kChipSpeedMmS = 1000.0, kDropletSpeedMmS = 700.0;
constexpr double kChipsPerMm3 = 1200.0;   // drawn; a cubic millimetre is thousands, so each stands for many
constexpr double kMaxChipsPerS = 1500.0;  // what fits in the air at once anyway
constexpr double kDropletsPerS = 1100.0, kPuffsPerS = 240.0;
constexpr double kPortRadiusMm = 2.3;  // as instrument::turbineMesh() has them
constexpr double kStillRpm = 500.0;
constexpr double kMaxStreak = 2.5;  // radii of a drop
constexpr double kJetShare = 0.6;   // of the way to the tip

/// Random numbers of one step: the same for the same seed and step, however time was cut into pictures.
class Dice {
  public:
    Dice(std::uint64_t seed, std::int64_t step)
        : state_(seed * core::kSplitMixStep + static_cast<std::uint64_t>(step)) {}
    /// 0..1
    double unit() { return core::unitOf(core::nextSplitMix(state_)); }
    double between(double a, double b) { return a + (b - a) * unit(); }
    /// A direction of the upper half about an axis, towards it.
    Vec3 around(const Vec3& axis) {
        const double z = 2.0 * unit() - 1.0, angle = 2.0 * std::numbers::pi * unit(), r = std::sqrt(1.0 - z * z);
        const Vec3 v(r * std::cos(angle), r * std::sin(angle), z);
        return v.dot(axis) < 0.0 ? Vec3(-v) : v;
    }

  private:
    std::uint64_t state_;
};

std::array<float, 3> floats(const Vec3& v) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

std::uint8_t byte(double v) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0, 255.0)));
}

/// A port of the spray, in the bur frame: three about the bur in the head's lower face, none towards the handle.
Vec3 portAt(std::size_t i) {
    const double angle = 0.5 * std::numbers::pi * static_cast<double>(i + 1);
    return {kPortRadiusMm * std::cos(angle), kPortRadiusMm * std::sin(angle), instrument::kBurReachMm - 0.1};
}

}  // namespace

void Particles::clear() {
    started_ = false;
    chipDebt_ = dropletDebt_ = puffDebt_ = 0.0;
    counts_ = {};
    particles_.clear();
    specks_.clear();
}

bool Particles::room(Kind kind) const noexcept {
    static constexpr std::array<std::size_t, 3> kMost{kMaxChips, kMaxDroplets, kMaxPuffs};
    const auto k = static_cast<std::size_t>(kind);
    return counts_[k] < kMost[k];
}

void Particles::advance(const Moment& moment, const Look& look, double headRadiusMm) {
    if (chips_ != look.debris || water_ != look.spray) clear();
    chips_ = look.debris;
    water_ = look.spray;
    if ((!chips_ && !water_) || !std::isfinite(moment.timeS)) {
        clear();
        return;
    }
    const auto target = static_cast<std::int64_t>(std::floor(moment.timeS / kParticleStepS + 1e-6));
    constexpr auto kJump = static_cast<std::int64_t>(kParticleJumpS / kParticleStepS);
    constexpr auto kRunUp = static_cast<std::int64_t>(kRunUpS / kParticleStepS);
    if (!started_ || target < stepIndex_ || target > stepIndex_ + kJump) {
        clear();
        started_ = true;
        stepIndex_ = target - kRunUp;
    }
    for (; stepIndex_ < target; ++stepIndex_)
        step(stepIndex_, moment, headRadiusMm);
    show(moment, look, headRadiusMm);
}

void Particles::step(std::int64_t index, const Moment& moment, double headRadiusMm) {
    const double nowS = static_cast<double>(index + 1) * kParticleStepS;
    for (Particle& p : particles_) {
        // Drag towards still air and weight, solved exactly for one step; mist is carried and does not fall.
        const double keep = std::exp(-kParticleStepS / p.relaxationS);
        const Vec3 fall = p.kind == Kind::puff ? Vec3(Vec3::Zero()) : Vec3(0.0, 0.0, -kGravityMmS2 * p.relaxationS);
        const Vec3 slip = p.velocityMmS - fall;
        p.positionMm += fall * kParticleStepS + slip * (p.relaxationS * (1.0 - keep));
        p.velocityMmS = fall + slip * keep;
    }
    std::erase_if(particles_, [&](const Particle& p) {
        const bool over = nowS - p.bornS >= p.lifeS;
        if (over) --counts_[static_cast<std::size_t>(p.kind)];
        return over;
    });
    emit(index, moment, headRadiusMm);
}

void Particles::emit(std::int64_t index, const Moment& moment, double headRadiusMm) {
    if (!moment.burShown || !moment.burInTooth.isValid() || !moment.contactPointMm.allFinite() ||
        !moment.contactNormal.allFinite())
        return;
    Dice dice(seed_, index);
    const double bornS = static_cast<double>(index + 1) * kParticleStepS;
    const Vec3 tip = moment.burInTooth.positionMm, axis = moment.burInTooth.orientation * Vec3::UnitZ();
    const bool turning = moment.speedRpm > kStillRpm;
    const bool wet = water_ && moment.water && turning;

    if (chips_ && turning && moment.removalMm3S > 0.0 && moment.tissue != cases::Tissue::none)
        chipDebt_ += std::min(moment.removalMm3S * kChipsPerMm3, kMaxChipsPerS) * kParticleStepS;
    for (; chipDebt_ >= 1.0; chipDebt_ -= 1.0) {
        if (!room(Kind::chip)) continue;
        const Vec3 place = moment.contact ? moment.contactPointMm : tip;
        const Vec3 out = moment.contact ? moment.contactNormal : axis;
        // The edge goes by clockwise as seen from the shank: what it breaks off flies along, and off the surface.
        Vec3 along = -axis.cross(place - tip);
        along = along.norm() > 1e-3 ? Vec3(along.normalized()) : Vec3(axis.unitOrthogonal());
        // Wet chips are caught by the water and do not get as far.
        const double speed = kChipSpeedMmS * dice.between(0.25, 1.2) * (wet ? 0.65 : 1.0);
        Particle p;
        p.kind = Kind::chip;
        const Vec3 jitter = dice.around(out);
        p.velocityMmS = speed * (0.75 * along + 0.55 * out + 0.7 * jitter).normalized();
        p.positionMm = place + 0.3 * headRadiusMm * jitter;
        p.bornS = bornS;
        p.lifeS = dice.between(0.05, 0.16);
        p.radiusMm = dice.between(0.022, 0.06);
        p.relaxationS = dice.between(0.0025, 0.006);
        p.tissue = moment.tissue;
        p.shade = byte(dice.between(0.0, 255.0));
        particles_.push_back(p);
        ++counts_[static_cast<std::size_t>(Kind::chip)];
    }

    if (!wet) return;
    dropletDebt_ += kDropletsPerS * kParticleStepS;
    puffDebt_ += kPuffsPerS * kParticleStepS;
    for (; dropletDebt_ >= 1.0; dropletDebt_ -= 1.0) {
        const Vec3 away = dice.around(axis);
        Particle p;
        p.kind = Kind::droplet;
        const Vec3 across = (away - axis * away.dot(axis) * 0.55).normalized();
        p.velocityMmS = kDropletSpeedMmS * dice.between(0.3, 1.5) * across;
        p.positionMm = tip + (0.6 + headRadiusMm) * dice.unit() * across + 0.3 * axis;
        p.bornS = bornS;
        p.lifeS = dice.between(0.02, 0.08);
        p.radiusMm = dice.between(0.02, 0.055);
        p.relaxationS = dice.between(0.004, 0.01);
        if (room(Kind::droplet)) {
            particles_.push_back(p);
            ++counts_[static_cast<std::size_t>(Kind::droplet)];
        }
    }
    for (; puffDebt_ >= 1.0; puffDebt_ -= 1.0) {
        const Vec3 away = dice.around(axis);
        Particle p;
        p.kind = Kind::puff;
        p.velocityMmS = dice.between(15.0, 70.0) * away;
        p.positionMm = tip + axis * dice.between(0.2, 2.0) + headRadiusMm * away;
        p.bornS = bornS;
        p.lifeS = dice.between(0.12, 0.34);
        p.radiusMm = dice.between(0.6, 1.1);
        p.relaxationS = 0.04;
        if (room(Kind::puff)) {
            particles_.push_back(p);
            ++counts_[static_cast<std::size_t>(Kind::puff)];
        }
    }
}

void Particles::show(const Moment& moment, const Look& look, double headRadiusMm) {
    specks_.clear();
    const double nowS = static_cast<double>(stepIndex_) * kParticleStepS;
    for (const Particle& p : particles_) {
        const double age = std::clamp((nowS - p.bornS) / p.lifeS, 0.0, 1.0);
        Speck s;
        s.positionMm = floats(p.positionMm);
        if (p.kind == Kind::puff) {
            // Mist spreads and thins.
            s.radiusMm = static_cast<float>(p.radiusMm * (1.0 + 1.9 * age));
            s.rgba = {kMistColour[0], kMistColour[1], kMistColour[2],
                      byte(40.0 * (1.0 - age) * std::min(1.0, 6.0 * age))};
        } else {
            // What the eye smears of a fast speck, held short: chips would look like needles, drops like sticks.
            Vec3 streak = -0.004 * p.velocityMmS;
            const double longest = p.kind == Kind::chip ? 0.22 : kMaxStreak * p.radiusMm;
            if (streak.norm() > longest) streak *= longest / streak.norm();
            s.streakMm = floats(streak);
            s.radiusMm = static_cast<float>(p.radiusMm);
            s.hardness = p.kind == Kind::chip ? 0.85f : 0.5f;
            const double fade = std::min(1.0, 3.0 * (1.0 - age));
            if (p.kind == Kind::droplet) s.hardness = 0.25f;
            if (p.kind == Kind::chip) {
                const auto colour = colourOf(p.tissue, look.palette);
                const double shade = 0.78 + 0.3 * p.shade / 255.0;
                s.rgba = {byte(shade * colour[0]), byte(shade * colour[1]), byte(shade * colour[2]),
                          byte(255.0 * fade)};
            } else {
                s.rgba = {232, 242, 250, byte(150.0 * fade)};
            }
        }
        specks_.push_back(s);
    }
    const bool jets =
        water_ && moment.water && moment.burShown && moment.speedRpm > kStillRpm && moment.burInTooth.isValid();
    for (std::size_t i = 0; jets && i < kJets; ++i) {
        // A jet leaves its port as a thread and is mist before it is at the tip.
        const Vec3 port = portAt(i), aim(0.12 * port.x(), 0.12 * port.y(), 0.6 * headRadiusMm);
        Speck s;
        s.positionMm = floats(moment.burInTooth.apply(port));
        s.streakMm = floats(moment.burInTooth.orientation * (kJetShare * (aim - port)));
        s.radiusMm = 0.11f;
        s.hardness = 0.0f;
        s.rgba = {kMistColour[0], kMistColour[1], kMistColour[2], 64};
        specks_.push_back(s);
    }
}

}  // namespace handpiece::view
