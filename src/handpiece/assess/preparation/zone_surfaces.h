// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A task's zones as surfaces, to be looked at. Scores never rest on them.

#include <array>
#include <cstdint>

#include "handpiece/assess/preparation/preparation.h"
#include "handpiece/base/core/progress.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::preparation {

enum class SeenZone : std::uint8_t {
    target,         ///< what of the tooth is to go
    leeway,         ///< what of it may go: the target and what lies beside and under it
    protectedZone,  ///< must stay: the pulp, and what the recipe keeps about it
    container       ///< what of it is none of these
};
inline constexpr std::array kSeenZones{SeenZone::target, SeenZone::leeway, SeenZone::protectedZone,
                                       SeenZone::container};

/// layOn() with the tooth's surface as somebody has it already: dear to make.
[[nodiscard]] Laid layOn(const cases::Tooth& tooth, const Recipe& recipe,
                         std::shared_ptr<const geometry::TriangleTree> whole);

/// Closed, within the tooth, to about `finestMm`; edges are bevelled by that. Empty where there is no such zone.
/// `laid`: of this recipe on this tooth. In parallel, the same bytes at any thread count.
[[nodiscard]] geometry::TriangleMesh zoneSurface(SeenZone zone, const cases::Tooth& tooth, const Recipe& recipe,
                                                 const Laid& laid, const core::Progress& progress = {},
                                                 double finestMm = 0.1);

/// The same of any region within any tooth, both as signed distances: where both are negative. `tooth` is dear to ask,
/// and is asked near the region only.
[[nodiscard]] geometry::TriangleMesh regionSurface(const geometry::ScalarFunction& region,
                                                   const geometry::ScalarFunction& tooth, const core::Box& box,
                                                   double finestMm = 0.1, const core::Progress& progress = {});

}  // namespace handpiece::preparation
