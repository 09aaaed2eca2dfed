// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The parts that a starter tooth is described by, in the words of dental anatomy. Private to this room.

#include <vector>

#include "handpiece/base/core/vec.h"

namespace handpiece::starter {

/// A cross-section of a column at one height: a rounded rectangle about (cx, cy) [mm].
struct Section {
    double z, cx, cy, halfX, halfY;
    double square;  ///< 0 an ellipse, 1 nearly a rectangle
};
/// A body lofted through sections (smooth between them), rounded off at both ends: the crown's sides, a root, a pulp
/// chamber.
struct Column {
    std::vector<Section> sections;  ///< z rising
    double bottomZ, bottomLength;   ///< below bottomZ it closes like an ellipsoid of this half-length
    double topZ, topLength;         ///< likewise above topZ; topLength 0: open (the occlusal surface closes it)
    double wedge = 0.0;             ///< relative growth of halfY towards +x
    double lean = 0.0;              ///< relative growth of halfX towards +y
};
/// A ridge of the occlusal surface: a roof along a straight line, falling to both sides.
struct Ridge {
    core::Vec3 from, to;
    double slope = 0.9;
};
/// A stretch of a fissure: a narrow groove cut into the finished surface, seen from above [mm].
struct FissureStretch {
    core::Vec2 from, to;
    double fromDepth, toDepth;
};
/// A shallow upright furrow of a side, or with a negative depth a swelling.
struct Flute {
    double x, side, depth, sigma;
    double fromZ, toZ;  ///< fades in over this height
};
/// A chain of balls: a root canal, a pulp horn.
struct Canal {
    std::vector<core::Vec3> points;
    std::vector<double> radii;
};
struct CariesLesion {
    core::Vec3 pit;  ///< on the occlusal surface, where it went in
    double neckRadius;
    core::Vec3 spread;      ///< centre of the part along the dentine
    core::Vec3 spreadHalf;  ///< its half axes
};

/// Everything that makes one tooth. Tooth frame [mm]: +z out of the crown, +x mesial, z = 0 at the neck.
struct Anatomy {
    Column crown;
    std::vector<Column> roots;
    std::vector<Ridge> ridges;   ///< empty: the crown column's own top closes it
    double ridgeSoftness = 4.0;  ///< 1/mm; larger is crisper
    double edgeRadius = 1.3;     ///< of the turn from the sides to the occlusal surface
    double rootBlend = 1.0;
    std::vector<FissureStretch> fissures;
    double fissureSigma = 0.15;
    double fissureFromZ = 2.8, fissureToZ = 4.6;
    std::vector<Flute> flutes;
    // Cervical line: height at the mesial, distal, buccal and lingual middle.
    double neckMesial, neckDistal, neckPlusY, neckMinusY;
    double neckHalfX, neckHalfY;
    double enamelSide, enamelTop, enamelTopFromZ, enamelTopToZ;  ///< thickness of the sides and of the cusps
    Column pulpChamber;
    std::vector<Canal> canals;
    CariesLesion caries;
    double crownTopZ, apexZ, reach;  ///< extent; reach: largest |x|, |y|
};

[[nodiscard]] Anatomy lowerFirstMolarAnatomy();
[[nodiscard]] Anatomy upperIncisorAnatomy();
[[nodiscard]] Anatomy upperPremolarAnatomy();

}  // namespace handpiece::starter
