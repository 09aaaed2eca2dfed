// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The two dental arches: where each tooth stands, and how the mandible opens. docs/anatomy.md#the-arches has the
/// figures.
///
/// Mouth frame [mm]: +x to the patient's left, +y backwards, +z up; the origin lies in the midline between the incisal
/// edges of the lower central incisors, the plane z = 0 goes through them and the lower second molars. The maxilla
/// rests in it.

#include <array>
#include <cstddef>
#include <span>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/model/case/case.h"

namespace handpiece::dentition {

/// Arrays of teeth run 11 to 18, 21 to 28, 31 to 38, 41 to 48.
inline constexpr std::size_t kToothCount = 32;
[[nodiscard]] constexpr int fdiOf(std::size_t index) {
    return 10 * (1 + static_cast<int>(index / 8)) + 1 + static_cast<int>(index % 8);
}
/// Throws core::Error for what is no permanent tooth.
[[nodiscard]] std::size_t indexOf(int fdi);
[[nodiscard]] constexpr bool isUpper(std::size_t index) {
    return index < 16;
}

// What is asked of the arches: [R] recalled from textbooks, unchecked.
inline constexpr double kSpeeRadiusMm = 90.0;     ///< of the line through the lower buccal cusps, seen from the side
inline constexpr double kWilsonRadiusMm = 101.6;  ///< of the line through buccal and lingual cusps, seen from the front
inline constexpr double kOverbiteMm = 2.5;
/// Adjacent crowns: a foil of floss's thickness does not pass.
inline constexpr double kContactGapMm = 0.015;
inline constexpr double kOpeningMm = 40.0, kWidestOpeningMm = 60.0;  ///< between the incisal edges: for work, at most

struct Arrangement {
    std::array<core::Pose, kToothCount> toothInMouth;  ///< jaws closed, maximal intercuspation
    core::Vec3 upperIncisalMm, lowerIncisalMm;         ///< mesial incisal edges in the midline, jaws closed
    core::Vec3 hingeMm;                                ///< between the condyles; they turn about x
};

/// Sets 32 teeth (order of fdiOf) into arches: adjacent ones in contact, none in another, upper ones settled on the
/// lower ones. Rests on their outer surfaces, cusp tips and cervices alone. The same bits at any thread count.
[[nodiscard]] Arrangement arrange(std::span<const cases::Tooth> teeth, const core::Progress& progress = {});

/// Where the mandible has gone, in the mouth frame, when the incisal edges stand `openingMm` apart; 0 leaves the jaws
/// closed. It turns about the hinge alone: at this opening real condyles have begun to glide forwards.
[[nodiscard]] core::Pose opened(const Arrangement& arrangement, double openingMm);

}  // namespace handpiece::dentition
