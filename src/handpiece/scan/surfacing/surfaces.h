// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From a region's solids to closed surfaces that do not cross, at chosen numbers of faces.

#include <array>
#include <span>
#include <string>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/scan/segmentation/segment.h"

namespace handpiece::surfacing {

struct Surface {
    cases::Tissue tissue = cases::Tissue::none;  ///< none: the whole tooth
    geometry::TriangleMesh mesh;                 ///< scanner's frame [mm]; closed, manifold, outward
    double errorBoundMm = 0;                     ///< of the decimation
    bool isAuthored = false;
};
/// The whole tooth first, then its tissues in the region's order.
///
/// As parts of a cases::Case they overlap, and the higher priority wins: the enamel's part is the whole tooth itself
/// (the lowest priority of all), dentine lies in it, pulp in the dentine, caries and restorations where they are.
/// Where dentine (at the root), caries or a restoration reach the tooth's outside, their surface does not run along the
/// outer one, which would leave flakes of enamel between the two, but a little outside it: `standOutMm`, below
/// cases::kCaseToleranceMm, which no vertex of a tissue passes. Nothing outside the outer surface is felt or counted,
/// so no volume changes by that.
struct Surfaces {
    Surface outer;
    std::vector<Surface> tissues;
    double leastGapMm = 0;  ///< the pulp keeps this distance at least from the dentine's and the tooth's surface
    double standOutMm = 0;  ///< where a tissue reaches the outside it stands out of the tooth by about this much
    std::vector<std::string> notes;  ///< what a person should know: parts left out, targets that could not be kept
};

struct Settings {
    bool smooth = true;  ///< without shrinking: the volume is kept to 0.1 %
};
/// Isosurfaces of the region's solids, smoothed by Taubin's low-pass within a fraction of a voxel of them, each shell
/// then set to the volume that its solid has below the voxel. Of the tooth and its dentine the largest shell is kept,
/// of the other tissues those (and the hollows) of 20 voxels and more. A solid with more than a few tunnels is noise:
/// it is evened out over a voxel, its volume kept, and the notes tell. The same bytes at any thread count. Throws
/// core::Error for a region without a tooth, values that do not fill its grid, a grid that is not isotropic.
[[nodiscard]] Surfaces makeSurfaces(const segmentation::Region& region, const Settings& settings = {},
                                    const core::Progress& progress = {});

struct Parted {
    std::size_t teeth = 0;  ///< that were moved
    double movedMm = 0;     ///< farthest of any vertex
};
/// Teeth made of labels that touch may reach into one another by a part of a voxel where they were smoothed: they are
/// drawn apart by 0.01 mm, a voxel and a half at most.
[[nodiscard]] Parted partTeeth(std::span<Surfaces* const> teeth, double voxelMm, const core::Progress& progress = {});

/// The paper's Table II.
inline constexpr std::array<double, 5> kTableTwoPercents{6, 12, 25, 50, 100};
/// The whole percentage of the faces that a distance field of this voxel can use: as many as equilateral triangles with
/// edges of two voxels v would be. Between its nodes the field is straight, as a face is; such faces stay within about
/// v * v / r of a surface of radius r (0.0025 mm for voxels of 0.05 mm and a radius of 1 mm), the field itself within a
/// quarter of that, and decimated() leaves more of them where the surface bends more.
[[nodiscard]] double usefulPercent(const Surfaces& full, double voxelMm);
/// All surfaces at a percentage (0..100] of their faces, to the even number nearest; 100 gives them back. What was
/// nested stays so: where fewer faces let a tissue come out, its vertices are pushed back.
[[nodiscard]] Surfaces decimated(const Surfaces& full, double percent, const core::Progress& progress = {});
/// The same as decimated() at each percentage, in one go.
[[nodiscard]] std::vector<Surfaces> decimatedSteps(const Surfaces& full, std::span<const double> percents,
                                                   const core::Progress& progress = {});
/// All surfaces together at about `faces` faces, the outer one's share by its area.
[[nodiscard]] Surfaces decimatedTo(const Surfaces& full, std::size_t faces, const core::Progress& progress = {});

}  // namespace handpiece::surfacing
