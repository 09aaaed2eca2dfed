// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "handpiece/model/dentition/rules.h"

namespace handpiece::dentition {
namespace {

/// Mean sizes [mm] as Wheeler's Dental Anatomy has them [R, recalled, unchecked]: crown, root, mesiodistal crown and
/// cervix, buccolingual crown and cervix, curve of the cemento-enamel junction mesial and distal. Narrower than his,
/// since what people's teeth were measured to have is about a standard deviation less (docs/anatomy.md, Held against
/// people): 14, 15, 43 and 44 mesiodistally, the premolars' necks with their crowns, 42 buccolingually.
constexpr Sizes kUpper[8] = {{10.5, 13.0, 8.5, 7.0, 7.0, 6.0, 3.5, 2.5},  {9.0, 13.0, 6.5, 5.0, 6.0, 5.0, 3.0, 2.0},
                             {10.0, 17.0, 7.5, 5.5, 8.0, 7.0, 2.5, 1.5},  {8.5, 14.0, 6.7, 4.8, 9.0, 8.0, 1.0, 0.0},
                             {8.5, 14.0, 6.5, 4.65, 9.0, 8.0, 1.0, 0.0},  {7.5, 13.0, 10.0, 8.0, 11.0, 10.0, 1.0, 0.0},
                             {7.0, 12.0, 9.0, 7.0, 11.0, 10.0, 1.0, 0.0}, {6.5, 11.0, 8.5, 6.5, 10.0, 9.5, 1.0, 0.0}};
constexpr Sizes kLower[8] = {{9.0, 12.5, 5.0, 3.5, 6.0, 5.3, 3.0, 2.0},   {9.5, 14.0, 5.5, 4.0, 6.2, 5.8, 3.0, 2.0},
                             {11.0, 16.0, 6.7, 5.5, 7.5, 7.0, 2.5, 1.0},  {8.5, 14.0, 6.7, 4.8, 7.5, 6.5, 1.0, 0.0},
                             {8.0, 14.5, 7.0, 5.0, 8.0, 7.0, 1.0, 0.0},   {7.5, 14.0, 11.0, 9.0, 10.5, 9.0, 1.0, 0.0},
                             {7.0, 13.0, 10.5, 8.0, 10.0, 9.0, 1.0, 0.0}, {7.0, 11.0, 10.0, 7.5, 9.5, 9.0, 1.0, 0.0}};

/// Standard deviations of crown widths over people, shares of the mean: docs/anatomy.md [Z]; of third molars none was
/// found, they have those of the second ones.
constexpr Spreads kUpperSpreads[8] = {{0.053, 0.060}, {0.086, 0.068}, {0.052, 0.071}, {0.060, 0.070},
                                      {0.064, 0.066}, {0.059, 0.052}, {0.062, 0.059}, {0.062, 0.059}};
constexpr Spreads kLowerSpreads[8] = {{0.054, 0.066}, {0.065, 0.061}, {0.062, 0.074}, {0.065, 0.064},
                                      {0.067, 0.064}, {0.050, 0.048}, {0.060, 0.058}, {0.060, 0.058}};

}  // namespace

Spec specOf(bool upper, int place, const Patient& patient) {
    Spec spec;
    // Plans of a seed, far from the numbers that tooth_form.cpp draws.
    Draws draws(patient.seed * 9176263 + static_cast<std::uint64_t>(1000 + place + (upper ? 0 : 8)), patient.seed == 0);
    spec.sizes = (upper ? kUpper : kLower)[place - 1];
    spec.spreads = (upper ? kUpperSpreads : kLowerSpreads)[place - 1];
    if (place <= 3)
        anterior(spec, upper, place);
    else if (place <= 5)
        upper ? upperPremolar(spec, place, draws) : lowerPremolar(spec, place, draws);
    else
        upper ? upperMolar(spec, place, patient, draws) : lowerMolar(spec, place, draws);
    return spec;
}

}  // namespace handpiece::dentition
