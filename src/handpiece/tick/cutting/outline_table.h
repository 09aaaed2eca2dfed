// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A bur's outline as the sweep kernel wants it: its pieces, and which of them can be nearest where.

#include <cstdint>
#include <vector>

#include "handpiece/model/instrument/profile.h"
#include "handpiece/tick/cutting/sweep_kernel.h"

namespace handpiece::cutting {

/// Off the tick to make, immutable, any thread.
class OutlineTable {
  public:
    /// The distances matter from bandOutMm inside the bur to bandMm outside. Lookups reach `marginMm` farther out. One
    /// kernel unit is `unitMm`; cells are `cellMm` wide.
    OutlineTable(const instrument::Profile& profile, double unitMm, double bandMm, double bandOutMm, double marginMm,
                 double cellMm);

    /// Those of the outline, then capsules: a round tip and the cylinder that it ends, as one.
    [[nodiscard]] const std::vector<SweepPiece>& pieces() const noexcept { return pieces_; }
    [[nodiscard]] std::size_t realPieces() const noexcept { return realPieces_; }
    /// A rectangle of the half-plane [mm].
    struct Rectangle {
        float rhoLow, rhoHigh, zLow, zHigh;
    };
    /// What holds all over a rectangle.
    struct Region {
        float lowMm, highMm;   ///< bounds of the signed distance
        std::uint64_t groups;  ///< of pieces that can be nearest
        std::uint64_t alone;   ///< pieces that do alone, taken for whole lines and circles
    };
    [[nodiscard]] Region region(const Rectangle& rectangle) const noexcept;
    /// Writes the pieces of some groups, rising; returns how many.
    std::int32_t list(std::uint64_t groups, std::uint16_t* out) const noexcept;
    [[nodiscard]] SweepForm formOf(std::uint16_t piece) const noexcept {
        const SweepPiece& p = pieces_[piece];
        if (p.radius == 0.0f) return p.ur == 0.0f && p.uz == 1.0f ? SweepForm::wall : SweepForm::line;
        return piece < realPieces_ ? SweepForm::ball : SweepForm::capsule;
    }

  private:
    std::vector<SweepPiece> pieces_;
    std::size_t realPieces_ = 0;
    std::vector<Region> cells_;
    std::uint32_t groupSize_ = 1;
    std::int32_t columns_ = 0, rows_ = 0;  ///< along rho and z
    float perCell_ = 0.0f, zLow_ = 0.0f;
};

/// An outline round the profile (nowhere inside it) of few pieces; the profile itself when it has few.
[[nodiscard]] instrument::Profile simpleOutline(const instrument::Profile& profile);

}  // namespace handpiece::cutting
