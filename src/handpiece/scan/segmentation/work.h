// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The block around one tooth while it is taken apart, and the stages that do it. Private to this room.

#include <string>
#include <vector>

#include "handpiece/scan/segmentation/segment.h"
#include "handpiece/scan/segmentation/teeth.h"
#include "handpiece/scan/segmentation/voxels.h"

namespace handpiece::segmentation {

inline constexpr std::uint8_t kHeldCavity = 1, kHeldCut = 2;
inline constexpr float kBand = 3;  ///< voxels: beyond it distances are clamped

/// Of the tooth and its tissues: depths in voxels, how far inside. A Region has the signed distances. What is empty is
/// not there.
struct Work {
    volume::Grid grid;  ///< isotropic
    Shape shape;
    Thresholds levels;
    Field raw;     ///< grey values as scanned
    Field damped;  ///< noise taken out, edges kept
    Field around;  ///< grey values outside the tooth where they differ (bone, gum, neighbours); empty: levels.outside
    Field outer, dentine, pulp, caries, restoration;
    Mask held;  ///< cavities that were closed and what was cut off: grey values have no say there
    float cariesLevel = 0, restorationLevel = 0;
    bool areLevelsOpen = true;  ///< grey levels are fitted: nobody gave them
    float groundLevel = 0;      ///< the brightest thing around the tooth: bone, else as outside
    double sigma = 0.85;        ///< blur [voxels]
    float noise = 0;            ///< grey values
    std::vector<std::string> notes;
    Field scratch, scratch2;

    [[nodiscard]] double spacingMm() const { return grid.spacingMm.x(); }
};

/// Cuts a block with a margin out of a scan, at equal spacings; what lies outside the scan is `outside`.
void cutOut(Work& work, const volume::Volume& volume, const core::Vec3& lowVoxel, const core::Vec3& highVoxel,
            double spacingMm, const core::Progress& progress);
/// Noise, rings and streaks.
void damp(Work& work, const core::Progress& progress);

/// Of a block of zeros and ones [0, 1]: what `filled` closed off from the outside through narrow mouths.
/// Wide-mouthed grooves (fissures, the furcation) stay open.
[[nodiscard]] Mask closedCavities(const Shape& shape, const Mask& solid, double spacingMm);

/// The tooth's outline: which voxels, cavities filled, neighbours cut off.
void findOuter(Work& work, const CoarseTeeth& teeth, std::size_t chosen, const volume::Grid& scan,
               const Settings& settings, const core::Progress& progress);
/// First guesses of pulp, caries, enamel against dentine, restoration.
void findTissues(Work& work, const Settings& settings, const core::Progress& progress);
/// Moves all surfaces until the tissues, blurred as the scanner blurs, look like the scan.
void refine(Work& work, const core::Progress& progress);
/// Marks, cut planes and authored lesions; nesting; units.
[[nodiscard]] Region toRegion(Work&& work, const Settings& settings, const core::Progress& progress);

/// A distance to the smoothed boundary of what is set (1, else 0), nowhere further than half a voxel from the boundary
/// between the voxels: a voxel's centre never changes sides.
[[nodiscard]] Field smoothed(const Shape& shape, Field&& share);

/// Gives `values` of unknown voxels (1) what the nearest known ones (0) have; others (2) stay out of it.
void spreadInto(const Shape& shape, Field& values, const Mask& unknown);

}  // namespace handpiece::segmentation
