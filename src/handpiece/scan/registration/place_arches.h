// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The frames of teeth that stand together: which way is up and which mesial, by their numbers and their places.

#include <span>
#include <vector>

#include "handpiece/scan/registration/registration.h"

namespace handpiece::registration {

struct ToothOfArch {
    int fdi = 0;
    const geometry::TriangleMesh* outer = nullptr;  ///< closed; scanner's frame
};
struct PlacedArches {
    std::vector<Placed> teeth;  ///< in the order given; mesial is a guess for a tooth that stands alone in its jaw
    /// The numbers' right is the places' left: the scan is a mirror image, or its numbers are.
    bool isMirrored = false;
    core::Vec3 upInScan = core::Vec3::UnitZ();    ///< from the lower teeth to the upper ones
    core::Vec3 frontInScan = core::Vec3::Zero();  ///< of the patient; zero where too few teeth tell
};
/// Occlusal by the long axes and, with both jaws, by where the other one is; mesial along the arch, towards the
/// midline; the cervix at two fifths of the length. Permanent and deciduous teeth. Deterministic.
[[nodiscard]] PlacedArches placeArches(std::span<const ToothOfArch> teeth);

}  // namespace handpiece::registration
