// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What holds the teeth of an arch: gingiva with its scalloped margin and papillae, bone with its crest and sockets,
/// the periodontal ligament's space between bone and root. docs/anatomy.md#gingiva-ligament-and-bone.

#include <cstddef>
#include <span>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/model/case/case.h"

namespace handpiece::dentition {

// [R] recalled from textbooks, unchecked.
inline constexpr double kMarginOverCervixMm = 0.6;     ///< gingival margin, young and healthy: 0.5 to 1
inline constexpr double kPapillaBelowContactMm = 0.9;  ///< its tip under the contact
inline constexpr double kCrestUnderCervixMm = 1.5;     ///< bone's crest: 1 to 2
inline constexpr double kLigamentMm = 0.20;            ///< half-way down the root; 0.15 to 0.38
inline constexpr double kLigamentAtEndsMm = 0.30;      ///< at crest and apex
inline constexpr double kGingivaThicknessMm = 1.2;

struct ArchTooth {
    const cases::Tooth* tooth;  ///< outer surface and its cemento-enamel junction
    core::Pose inArch;
};

struct Periodontium {
    geometry::TriangleMesh gingiva, bone;  ///< closed solids
};

struct PeriodontiumOptions {
    double spacingMm = 0.2;
    std::size_t gingivaFaces = 150000, boneFaces = 60000;  ///< at most
};

/// Of the teeth of one arch, in their order along it from one end to the other. The same bytes at any thread count.
/// Throws core::Error for fewer than two teeth, or a tooth without cemento-enamel junction.
[[nodiscard]] Periodontium makePeriodontium(std::span<const ArchTooth> teeth, const PeriodontiumOptions& options = {},
                                            const core::Progress& progress = {});

}  // namespace handpiece::dentition
