// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The colours of an intraoral scan on the tooth's own outer surface, wherever that is still there.

#include <memory>

#include "handpiece/model/tooth/tooth_model.h"
#include "handpiece/senses/surface/brick_mesh.h"
#include "handpiece/senses/surface/brick_update.h"

namespace handpiece::surface {

/// How far from the scan's surface one of this level of detail may lie and still be it: what is extracted from the
/// field rounds edges off, the more so with larger cells.
[[nodiscard]] double nearScanMm(const tooth::ToothModel& model, int level);

/// Of each vertex of `mesh` (in the tooth's own frame); null where the scan had no colours or there is no mesh. Cut
/// surfaces have none, nor has what was put into or onto the tooth after the scan: caries, fillings, calculus.
[[nodiscard]] std::shared_ptr<const std::vector<ScanColour>> scanColours(const tooth::ToothModel& model,
                                                                         const BrickMesh* mesh);

}  // namespace handpiece::surface
