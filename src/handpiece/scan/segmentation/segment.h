// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From grey values to the tissues of one tooth, with surfaces between the voxels.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/model/case/tissue.h"
#include "handpiece/scan/volume/volume.h"

namespace handpiece::segmentation {

/// Grey values between tissues; the mean of two neighbours' peaks is where the surface lies after blur.
struct Thresholds {
    float outside = 0;          ///< peak of what surrounds the tooth (air, water, embedding)
    float pulp = 0;             ///< peak of the pulp: may be darker than the outside
    float dentine = 0;          ///< peak
    float enamel = 0;           ///< peak
    float toothFrom = 0;        ///< outside | dentine
    float enamelFrom = 0;       ///< dentine | enamel
    float restorationFrom = 0;  ///< above it: metal or filling; infinite when there is none
};

/// A plane that cuts the tooth from what it touches [mm, scanner's frame]: what lies on the normal's side is left out.
struct CutPlane {
    core::Vec3 pointMm, normal;
};
/// A person's mark [mm, scanner's frame]: here is this tissue (Tissue::none: nothing) within radiusMm.
struct Mark {
    core::Vec3 centreMm;
    double radiusMm = 0;
    cases::Tissue tissue = cases::Tissue::none;
};
/// A lesion that a teacher placed: an ellipsoid about a centre, only where tooth is. Marked as authored.
struct AuthoredLesion {
    core::Vec3 centreMm;
    core::Vec3 halfAxesMm;
};

/// All that a person decided; the same settings give the same tooth, so a wizard and a script share them.
struct Settings {
    std::optional<Thresholds> thresholds;  ///< none: found
    std::optional<core::Vec3> toothAtMm;   ///< in the crown or a root of the tooth wanted; none: the largest
    std::vector<CutPlane> cutPlanes;
    std::vector<Mark> marks;  ///< later ones win
    std::vector<AuthoredLesion> lesions;
    bool damp = true;  ///< noise (edges kept), streaks and rings
    bool findCaries = true;
    double spacingMm = 0;  ///< of the result; 0: the scan's, at least 0.03 mm
};

/// One tissue's solid as signed distances: negative inside, zero on its surface.
struct Solid {
    cases::Tissue tissue = cases::Tissue::none;
    std::vector<float> distanceMm;  ///< on Region::grid, i fastest; held to +-3 voxels
    bool isAuthored = false;
};

/// The tissues of one tooth on a grid around it (the rest of the scan is left out: a face identifies).
struct Region {
    volume::Grid grid;  ///< isotropic; axes as the scan's
    Solid outer;        ///< the whole tooth, its pulp filled and its apices closed
    /// In this order, only what is there: dentine (with everything below the enamel: pulp, caries in it; none where
    /// labels tell no dentine from the enamel), pulp, caries, restoration. What `outer` holds beyond them is enamel.
    /// Later ones win where they overlap.
    std::vector<Solid> solids;
    Thresholds thresholds;           ///< that were used
    double blurMm = 0;               ///< of the scan, as found: standard deviation
    double noise = 0;                ///< standard deviation in dentine, grey values
    std::vector<std::string> notes;  ///< what a person should know: cut off by the border, touching neighbour, ...
};

/// Peaks and thresholds from the histogram. Throws core::Error when there is no tooth in it ("empty segmentation").
[[nodiscard]] Thresholds findThresholds(const volume::Volume& volume, const core::Progress& progress = {});

/// A thing that could be a tooth.
struct Candidate {
    core::Vec3 atMm;     ///< a point inside it: Settings::toothAtMm
    core::Box boundsMm;  ///< along the grid's own axes about its origin
    double volumeMm3 = 0;
    bool touchesBorder = false;
};
/// Whether something of this size and shape can be a tooth, or what a scan's border left of one: neither a speck, nor a
/// plate of bone, nor a skull. From a milk incisor (100 mm3, 14 mm long) to a molar (1,300 mm3) with room to spare.
[[nodiscard]] bool isToothLike(const Candidate& candidate);
/// Separate hard things, the largest first.
[[nodiscard]] std::vector<Candidate> findTeeth(const volume::Volume& volume, const Thresholds& thresholds,
                                               const core::Progress& progress = {});

/// Throws core::Error: nothing found, the tooth is cut off by the scan's border (crown or more than the tips), marks
/// outside the scan.
[[nodiscard]] Region segment(const volume::Volume& volume, const Settings& settings = {},
                             const core::Progress& progress = {});
/// Labels (volume::Labels' numbers) taken as they are, smoothed to surfaces that lie within half a voxel of them; a
/// pulp that is open to the outside is closed at the apices and filled.
[[nodiscard]] Region segmentLabels(const volume::Labels& labels, const Settings& settings = {},
                                   const core::Progress& progress = {});

/// What a region says a voxel is, as volume::Labels' numbers on the region's grid.
[[nodiscard]] volume::Labels labelsOf(const Region& region);
/// Volume of each tissue [mm3], sub-voxel; by cases::Tissue.
[[nodiscard]] std::array<double, cases::kTissueCount> volumesMm3(const Region& region);

}  // namespace handpiece::segmentation
