// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a phantom's truth says about a tooth found in its scan: surfaces, overlap, volumes.

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/field/part_tissues.h"
#include "handpiece/scan/phantom/phantom.h"
#include "handpiece/scan/segmentation/segment.h"
#include "handpiece/scan/surfacing/surfaces.h"

namespace handpiece::bench {

/// Solids as segment.h has them: the whole tooth; enamel alone; dentine with all that is in it; pulp; caries.
enum class SolidKind { outer, enamel, dentine, pulp, caries };
inline constexpr std::array<SolidKind, 5> kSolidKinds = {SolidKind::outer, SolidKind::enamel, SolidKind::dentine,
                                                         SolidKind::pulp, SolidKind::caries};
[[nodiscard]] const char* nameOf(SolidKind kind);

struct SurfacePoint {
    core::Vec3 atMm, normal;
};
/// Evenly over the area; the same points for the same mesh.
[[nodiscard]] std::vector<SurfacePoint> sampled(const geometry::TriangleMesh& mesh, std::size_t points);

/// A solid to compare: what lies in all of some closed surfaces (or out of those that are hollowed out), and the points
/// on its surface that count.
struct ComparedSurface {
    struct Bound {
        std::shared_ptr<const geometry::TriangleTree> tree;
        bool isHollow = false;  ///< the solid lies outside it
    };
    std::vector<Bound> bounds;  ///< none: there is no such solid
    std::vector<SurfacePoint> points;
    /// Negative inside; exact where the nearest place of a bound is the solid's own surface.
    [[nodiscard]] double signedDistance(const core::Vec3& p) const;
};
using ComparedSurfaces = std::array<ComparedSurface, kSolidKinds.size()>;

struct SurfaceError {
    std::size_t points = 0;
    double medianMm = 0, p95Mm = 0, worstMm = 0;
    double biasMm = 0;  ///< mean signed distance: positive where the found solid is too large
};
struct SolidErrors {
    SurfaceError ofTruth;  ///< from the true surface to the found one
    SurfaceError ofFound;  ///< and back
};

/// The case as it stood in the scanner.
class ToothTruth {
  public:
    /// Both must outlive this.
    ToothTruth(const cases::Case& toothCase, const phantom::Image& image);

    [[nodiscard]] const ComparedSurfaces& surfaces() const { return surfaces_; }
    /// Where another tissue hides what is asked for: in a lesion or a filling, or within two voxels of one.
    [[nodiscard]] bool isHidden(SolidKind kind, const core::Vec3& p) const;
    /// Errors of found surfaces (points that are hidden count for nothing), by SolidKind; nothing where either is none.
    [[nodiscard]] std::array<std::optional<SolidErrors>, kSolidKinds.size()> errors(
        const ComparedSurfaces& found) const;
    /// Of the voxels of the truth, tissue by tissue: twice what both have over what either has.
    [[nodiscard]] std::array<double, cases::kTissueCount> dice(const segmentation::Region& region) const;

  private:
    [[nodiscard]] cases::Tissue tissueAt(const core::Vec3& p) const;
    const phantom::Image& image_;
    std::vector<std::unique_ptr<geometry::TriangleTree>> trees_;
    std::vector<field::PartSurface> parts_;
    std::unique_ptr<field::PartTissues> tissues_;
    std::unique_ptr<geometry::TriangleTree> outer_;
    double voxelMm_;
    ComparedSurfaces surfaces_;
};

/// The zero surfaces of a region's solids, trilinear between its voxels.
[[nodiscard]] ComparedSurfaces surfacesOf(const segmentation::Region& region);
/// Surfaces as made for a case; enamel is bounded by what the outer surface and the dentine's bound it by.
[[nodiscard]] ComparedSurfaces surfacesOf(const surfacing::Surfaces& surfaces);
/// Exclusive volumes of closed nested surfaces.
[[nodiscard]] std::array<double, cases::kTissueCount> volumesOf(const surfacing::Surfaces& surfaces);

}  // namespace handpiece::bench
