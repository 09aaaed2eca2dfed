// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Facets: where teeth that bite on each other have ground each other flat. docs/anatomy.md#the-arches has the figures.

#include <span>

#include "handpiece/model/case/case.h"
#include "handpiece/model/dentition/arch.h"

namespace handpiece::dentition {

/// Between antagonists in intercuspation, once their facets are ground.
inline constexpr double kOcclusalGapMm = 0.008;
/// What arrange() lets antagonists overlap at most, as springs would: facets take it from both, about half from either.
inline constexpr double kDeepestOverlapMm = 0.15;

/// Grinds 32 teeth as they bite in `arrangement` (order of fdiOf): where antagonists overlap, outer surface and enamel
/// of either go back to half a gap from the middle of the overlap, and landmarks with them. Returns how deep the
/// deepest facet is [mm]. In parallel; the same bits at any thread count.
double grindFacets(std::span<cases::Tooth> teeth, const Arrangement& arrangement);

/// Grinds the tooth that is worked on alone, back to a gap from the antagonists of its mouth, jaws closed: where a
/// finer tooth has taken the place of one that was ground. Returns how deep the deepest facet is [mm].
double grindOntoAntagonists(cases::Case& mouth);

}  // namespace handpiece::dentition
