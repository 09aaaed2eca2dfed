// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A task's zones as surfaces, to be looked at. Scores never rest on them.

#include <array>
#include <cstdint>

#include "handpiece/assess/preparation/preparation.h"
#include "handpiece/base/core/progress.h"
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

/// Closed, within the tooth, to about a tenth of a millimetre; edges are bevelled by that. Empty where there is no such
/// zone. `laid`: of this recipe on this tooth. In parallel, the same bytes at any thread count.
[[nodiscard]] geometry::TriangleMesh zoneSurface(SeenZone zone, const cases::Tooth& tooth, const Recipe& recipe,
                                                 const Laid& laid, const core::Progress& progress = {});

}  // namespace handpiece::preparation
