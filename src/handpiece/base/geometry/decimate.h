// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Fewer triangles, the same shape.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::geometry {

struct Decimated {
    TriangleMesh mesh;
    /// No vertex of the given mesh lies farther from the new surface [mm]. Measured (an upper bound, one-sided).
    double errorBoundMm = 0.0;
};

/// The mesh with `targetFaces` faces, or as near as the surface lets it: still closed, two-manifold and of the same
/// genus.
///
/// Quadric edge collapse (Garland & Heckbert 1997) with the link condition; no triangle turns over or becomes a sliver.
/// An odd target is rounded up, a target above the count gives the mesh back as it is. Deterministic: ties go by index.
/// Throws core::Error when the mesh is not closed and consistently oriented, or the target is below 4.
[[nodiscard]] Decimated decimate(const TriangleMesh& mesh, std::size_t targetFaces,
                                 const core::Progress& progress = {});

/// The same at each of several targets, bit for bit, in one run down to the least. In the order of `targets`.
[[nodiscard]] std::vector<Decimated> decimateSteps(const TriangleMesh& mesh, std::span<const std::size_t> targets,
                                                   const core::Progress& progress = {});

/// The same of a mesh whose faces do not cross, so that they do not cross afterwards either. Where those of a thin part
/// came to, the given surface stays as it is for `holdMm` about, and all begins anew; none when a few times do not
/// help.
[[nodiscard]] std::optional<TriangleMesh> decimateUncrossed(const TriangleMesh& mesh, std::size_t targetFaces,
                                                            double holdMm, const core::Progress& progress = {});

}  // namespace handpiece::geometry
