// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What flies about while a tooth is cut: chips of it, and the cooling water. Arithmetic only; effects_particles.cpp
/// draws it.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/senses/view/look.h"

namespace handpiece::view {

struct Moment;

/// One soft sprite, tooth frame. A long one (`streakMm` not zero) reaches from the place back along the way it came.
struct Speck {
    std::array<float, 3> positionMm{};
    float radiusMm = 0.05f;
    std::array<float, 3> streakMm{};     ///< from the place to the tail
    float hardness = 0.0f;               ///< 0 a puff of mist, 1 a chip with an edge
    std::array<std::uint8_t, 4> rgba{};  ///< sRGB, not premultiplied
};

/// Of puffs and jets: what has no hardness.
inline constexpr std::array<std::uint8_t, 3> kMistColour{226, 236, 244};

inline constexpr std::size_t kMaxChips = 220, kMaxDroplets = 90, kMaxPuffs = 60, kJets = 3;
inline constexpr std::size_t kMaxSpecks = kMaxChips + kMaxDroplets + kMaxPuffs + kJets;

/// Moves in steps of kParticleStepS of the simulation's time, so that what is seen does not depend on how often it is
/// looked at; the same moments give the same specks. Time that stands still changes nothing; when it goes back, or on
/// by more than kParticleJumpS, everything begins anew as if the moment had lasted for a while: one picture alone shows
/// its spray. One thread.
class Particles {
  public:
    static constexpr double kParticleStepS = 1.0 / 500.0, kParticleJumpS = 0.5, kRunUpS = 0.3;

    explicit Particles(std::uint64_t seed = 1) : seed_(seed) {}

    /// On to the moment. `headRadiusMm` of the bur. Chips and water that the look does not want end at once.
    void advance(const Moment& moment, const Look& look, double headRadiusMm);
    /// Those in the air now, farthest last step first; at most kMaxSpecks. Valid until the next call.
    [[nodiscard]] std::span<const Speck> specks() const noexcept { return specks_; }
    void clear();

  private:
    enum class Kind : std::uint8_t { chip, droplet, puff };
    struct Particle {
        core::Vec3 positionMm, velocityMmS;
        double bornS = 0.0, lifeS = 0.0, radiusMm = 0.0, relaxationS = 0.01;
        Kind kind = Kind::chip;
        cases::Tissue tissue = cases::Tissue::none;
        std::uint8_t shade = 0;
    };
    void step(std::int64_t index, const Moment& moment, double headRadiusMm);
    void emit(std::int64_t index, const Moment& moment, double headRadiusMm);
    void show(const Moment& moment, const Look& look, double headRadiusMm);
    [[nodiscard]] bool room(Kind kind) const noexcept;

    std::uint64_t seed_;
    bool started_ = false, chips_ = true, water_ = true;
    std::int64_t stepIndex_ = 0;
    double chipDebt_ = 0.0, dropletDebt_ = 0.0, puffDebt_ = 0.0;
    std::array<std::size_t, 3> counts_{};
    std::vector<Particle> particles_;
    std::vector<Speck> specks_;
};

}  // namespace handpiece::view
