// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Lips and cheeks as what leaves the handpiece its room: plain closed solids about the opened mouth.
/// docs/working-positions.md#the-mouths-opening.

#include <span>

#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/model/dentition/arch.h"

namespace handpiece::dentition {

/// Width of the upper canines, from side to side, over that of the mouth (Stephan and Henneberg 2003, from an
/// abstract).
inline constexpr double kCaninesOverMouth = 0.758;
// [R] or judgements: so far a retractor or mirror holds the cheek off the teeth; so far the lips reach over the incisal
// edges into the opening; so thick is what gives way.
inline constexpr double kCheekOffTeethMm = 6.0, kLipOverEdgeMm = 2.0, kLipOffTeethMm = 3.0, kCheekThicknessMm = 25.0;

struct Cheeks {
    geometry::TriangleMesh left, right, upperLip, lowerLip;  ///< mouth frame, closed
};
/// About these teeth (outer surfaces as they stand in the mouth, order of fdiOf, the mandible opened).
[[nodiscard]] Cheeks makeCheeks(std::span<const geometry::TriangleMesh> teethInMouth);

}  // namespace handpiece::dentition
