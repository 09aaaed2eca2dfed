// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the teeth have in common, as rules that fill in a specification. Private to this room.

#include "handpiece/model/dentition/anatomy.h"

namespace handpiece::dentition {

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

/// Cusp ridges, triangular ridges, marginal ridges and supplemental grooves.
void occlusalSurface(Spec& spec, const OcclusalPlan& plan);
/// The pulp, narrower with age. With several roots a chamber in the shape of the cervix with a horn under each cusp and
/// canals down the middle of the roots; with one root one cavity, flat as the root is.
void addPulp(Spec& spec, double ageYears);
/// Cusp tips wear flat.
void wear(Spec& spec, double byMm);
/// The specification in another size: shares of width, depth, crown and root.
void scale(Spec& spec, double x, double y, double crown, double root);

void lowerMolar(Spec& spec, int place);
void upperMolar(Spec& spec, int place, const Patient& patient);
void upperPremolar(Spec& spec, int place);
void lowerPremolar(Spec& spec, int place);
void anterior(Spec& spec, bool upper, int place);

}  // namespace handpiece::dentition
