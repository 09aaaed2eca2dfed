// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// An X-ray beam and what each tissue takes out of it. Sources of every figure: docs/radiographs.md.

#include <array>
#include <span>
#include <string_view>

#include "handpiece/model/case/tissue.h"

namespace handpiece::radiograph {

/// Bands of photon energy, kBandKev wide, the first from kFirstKev.
inline constexpr std::size_t kBands = 22;
inline constexpr double kFirstKev = 15.0, kBandKev = 2.5;
using Spectrum = std::array<double, kBands>;

/// What a filling is made of; the tissue of a case does not tell.
enum class Filling { amalgam, composite };
/// "amalgam", "composite"; throws core::Error naming them.
[[nodiscard]] Filling fillingByName(std::string_view name);

/// Linear attenuation [1/mm] in each band; Tissue::none is air and takes nothing.
[[nodiscard]] const Spectrum& attenuationPerMm(cases::Tissue tissue, Filling filling = Filling::amalgam);
/// Of aluminium, by which beams are measured.
[[nodiscard]] const Spectrum& aluminiumPerMm();

/// Path lengths [mm] by Tissue.
using Paths = std::array<double, cases::kTissueCount>;

/// A tungsten tube's beam as a scintillator sees it.
class Beam {
  public:
    /// `softTissueMm`: cheek before the teeth. Throws core::Error for a voltage outside 50..70 kV.
    Beam(double kv, double aluminiumMm, double softTissueMm, Filling filling);

    /// Share of what the detector sees of each band without teeth; sums to 1.
    [[nodiscard]] const Spectrum& weights() const noexcept { return weights_; }
    /// Share of the signal that is left: sum of weight x exp(-sum of attenuation x path).
    [[nodiscard]] double transmission(const Paths& pathsMm) const noexcept;
    /// Aluminium that halves the air kerma of the bare beam [mm]: what a tube's data sheet tells.
    [[nodiscard]] double halfValueLayerMm() const;

  private:
    Spectrum weights_{}, bare_{};
    std::array<const Spectrum*, cases::kTissueCount> attenuation_{};
    std::size_t first_ = 0, last_ = 0;  ///< bands that hold anything
};

}  // namespace handpiece::radiograph
