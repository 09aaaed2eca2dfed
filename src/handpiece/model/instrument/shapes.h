// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Outlines of the ISO 6360 shapes at any size, and meshes turned from outlines.

#include <string>
#include <string_view>
#include <vector>

#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/instrument/profile.h"

namespace handpiece::instrument {

enum class Shape {
    round,
    invertedCone,
    cylinderFlat,
    cylinderRound,
    taperFlat,
    taperRound,
    pear,
    flame,
    torpedo,
    wheel
};

struct ShapeInfo {
    Shape shape;
    std::string_view name;      ///< as typed on the command line: "round", "inverted-cone", "cylinder-flat", ...
    std::string_view isoShape;  ///< three digits of ISO 6360-2, "001"; see docs/burs.md for which are unchecked
    std::string_view description;
};
[[nodiscard]] const std::vector<ShapeInfo>& shapes();
/// Throws core::Error naming the shapes there are.
[[nodiscard]] Shape shapeByName(std::string_view name);

/// Outline of the working head, diameter and length in mm. Throws core::Error when the two cannot make that shape.
[[nodiscard]] Profile makeProfile(Shape shape, double diameterMm, double lengthMm);

/// A closed mesh of the outline turned about z: `around` points a ring, rings no farther than `spacingMm` apart on
/// arcs.
[[nodiscard]] geometry::TriangleMesh turnedMesh(const Profile& profile, int around, double spacingMm);

/// A named bur of the product: "paper" (Table I: 170 vertices), one of the catalogue by name ("330", "round-4"), US
/// name or ISO number, or "SHAPE:DIAMETERxLENGTH" ("cylinder-round:1.0x4.0"). Throws core::Error listing what there is.
[[nodiscard]] Bur makeBur(std::string_view name);
/// Names makeBur knows, for help and completion.
[[nodiscard]] std::vector<std::string> burNames();

}  // namespace handpiece::instrument
