// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The tooth's own frame, found on its surfaces; and another surface of the same tooth registered onto it.

#include <optional>
#include <string>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/scan/surfacing/surfaces.h"

namespace handpiece::registration {

struct Hints {
    std::optional<core::Vec3> occlusal;  ///< direction in the scanner's frame
    std::optional<core::Vec3> mesial;
    int fdiNumber = 0;  ///< 0 unknown
};
struct Placed {
    core::Pose scanInTooth;  ///< maps the scanner's frame to the tooth's: +z occlusal, +x mesial, z = 0 at the neck
    double confidence = 0;   ///< 0..1 of +z; mesial is a guess unless it was hinted
    bool isMesialGuessed = true;
    std::vector<std::string> notes;
};
/// Occlusal: where the enamel lies; the long axis by the roots; mesial by the crown's longer side.
[[nodiscard]] Placed place(const surfacing::Surfaces& surfaces, const Hints& hints = {});

struct RegisterSettings {
    std::optional<core::Pose> roughly;  ///< movingInFixed by hand; none: by features
    double overlap = 0.5;               ///< share of `moving` that has a counterpart, at least
};
struct Registered {
    core::Pose movingInFixed;
    double rmsMm = 0;    ///< of the points used
    double worstMm = 0;  ///< 95th percentile of them
    double overlap = 0;
};
/// Puts an intraoral scan onto a surface from a CT: features, then trimmed point-to-plane ICP. Deterministic.
/// Throws core::Error when nothing convincing is found (rms above 0.3 mm or overlap below what was asked).
[[nodiscard]] Registered registerOnto(const geometry::TriangleMesh& moving, const geometry::TriangleMesh& fixed,
                                      const RegisterSettings& settings = {}, const core::Progress& progress = {});
/// The tooth with `crown` (registered, open or closed; the scanner's frame) as its outer surface where the two agree
/// within `reachMm`; closed, and still around its tissues.
[[nodiscard]] surfacing::Surfaces withOuterSurface(const surfacing::Surfaces& surfaces,
                                                   const geometry::TriangleMesh& crown, double reachMm = 0.5,
                                                   const core::Progress& progress = {});

}  // namespace handpiece::registration
