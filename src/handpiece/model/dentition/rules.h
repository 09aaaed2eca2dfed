// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the teeth have in common, as rules that fill in a specification. Private to this room.

#include <algorithm>

#include "handpiece/base/core/split_mix.h"
#include "handpiece/model/dentition/anatomy.h"

namespace handpiece::dentition {

/// Numbers of a seed, the same everywhere.
class Draws {
  public:
    Draws(std::uint64_t seed, bool isAverage) : state_(seed), isAverage_(isAverage) {}
    double uniform() { return core::unitOf(core::nextSplitMix(state_)); }
    /// About normal, of unit spread, never beyond 2; nothing for seed 0, the average patient.
    double normal() {
        if (isAverage_) return 0.0;
        double sum = -6.0;
        for (int i = 0; i < 12; ++i)
            sum += uniform();
        return std::clamp(sum, -2.0, 2.0);
    }
    /// Of the average patient the middle.
    double between(double low, double high) { return low + (high - low) * (isAverage_ ? 0.5 : uniform()); }
    core::Vec3 shift(double x, double y, double z) {
        const double dx = x * normal(), dy = y * normal();
        return {dx, dy, z * normal()};
    }

  private:
    std::uint64_t state_;
    bool isAverage_;
};

/// One cusp of a posterior tooth with its triangular ridge.
struct CuspPlan {
    const char* name;
    core::Vec3 tip, inner;  ///< where the triangular ridge ends at a developmental groove
    double round = 0.85, slope = 1.0;
    double bow = 0.0;  ///< the triangular ridge bends by this towards mesial [mm]
};
/// Where the occlusal surface ends towards mesial or distal.
struct MarginalPlan {
    core::Vec3 buccal, middle, lingual;
    double round = 0.55;
};
struct OcclusalPlan {
    std::vector<CuspPlan> buccal, lingual;              ///< from mesial to distal
    std::vector<core::Vec3> buccalNotch, lingualNotch;  ///< between them
    MarginalPlan mesial, distal;
};

/// No two teeth have their cusps, notches and marginal ridges at the same places.
void vary(OcclusalPlan& plan, Draws& draws);
/// Cusp ridges, triangular ridges and marginal ridges.
void occlusalSurface(Spec& spec, const OcclusalPlan& plan);
/// A groove's control points: from one to the other, bent to a side or to both.
[[nodiscard]] std::vector<core::Vec3> bent(const core::Vec3& from, const core::Vec3& to, Draws& draws);
/// Supplemental grooves: the developmental ones fork at the mesial and distal ends, and twigs leave them on their way;
/// each fades out, some fork again.
void supplementalGrooves(Spec& spec, const OcclusalPlan& plan, Draws& draws);
/// The pulp, narrower with age. With several roots a chamber in the shape of the cervix, its roof drawn out into a horn
/// under each cusp, and canals that open from it like funnels and run down the middle of the roots; with one root one
/// cavity, flat as the root is.
void addPulp(Spec& spec, double ageYears);
/// Cusp tips wear flat.
void wear(Spec& spec, double byMm);
/// The specification in another size: shares of width, depth, crown and root.
void scale(Spec& spec, double x, double y, double crown, double root);

void lowerMolar(Spec& spec, int place, Draws& draws);
void upperMolar(Spec& spec, int place, const Patient& patient, Draws& draws);
void upperPremolar(Spec& spec, int place, Draws& draws);
void lowerPremolar(Spec& spec, int place, Draws& draws);
void anterior(Spec& spec, bool upper, int place);

}  // namespace handpiece::dentition
