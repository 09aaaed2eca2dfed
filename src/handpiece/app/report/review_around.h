// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What stands around the tooth of a review, near it and coarser: adjacent teeth and gingiva, to look at. Private to
/// this room.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "handpiece/model/case/case.h"

namespace handpiece::report {

/// A surface of whole steps from `lowMm`.
struct AroundPart {
    std::string name;
    cases::Tissue tissue = cases::Tissue::neighbour;
    std::vector<std::array<std::uint16_t, 3>> vertices;
    std::vector<std::array<std::uint16_t, 3>> triangles;
};
struct Around {
    static constexpr double kStepMm = 0.001;
    core::Vec3 lowMm = core::Vec3::Zero();
    std::vector<AroundPart> parts;
};

/// Those surfaces of cases::surroundings() that come within 6 mm of a box [mm], cut off there, with the vertices of
/// each cell of 0.3 mm made one (after Rossignac and Borrel 1993). Parts of which nothing is left are not there.
[[nodiscard]] Around aroundOf(const cases::Case& toothCase, const core::Vec3& lowMm, const core::Vec3& highMm);

}  // namespace handpiece::report
