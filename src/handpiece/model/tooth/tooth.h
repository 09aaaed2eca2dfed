// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A tooth ready to be felt: exact triangles of its outer surface, its distance field, its tissues.

#include <filesystem>
#include <memory>
#include <string>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/field/distance_field.h"

namespace handpiece::tooth {

/// Everything the tick reads of a tooth. Immutable; shared by pointer.
struct Tooth {
    std::string name;
    geometry::TriangleMesh outer;  ///< as felt
    geometry::TriangleTree tree;   ///< exact distances to `outer`
    field::DistanceField field;
    bool fromCache = false;
    double buildSeconds = 0.0;  ///< that prepareTooth took, built or reopened
};

struct PrepareSettings {
    field::FieldSettings field;
    bool useCache = true;
    std::filesystem::path cacheFolder;  ///< empty: beside the case, or the user's cache folder where that is read-only
};

/// Builds (in parallel) or reopens the field of a case. Throws core::Error for surfaces that cannot be felt.
[[nodiscard]] std::shared_ptr<const Tooth> prepareTooth(const cases::Case& toothCase,
                                                        const PrepareSettings& settings = {},
                                                        const core::Progress& progress = {});

}  // namespace handpiece::tooth
