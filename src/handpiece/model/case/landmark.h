// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Places, lines and axes of a tooth that dentists name: what measures and preparations rest on.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/base/core/vec.h"

namespace handpiece::cases {

enum class LandmarkKind : std::uint8_t {
    cuspTip,                ///< a point
    pit,                    ///< a point
    contact,                ///< a point, where the adjacent tooth touches
    pulpHorn,               ///< a point, the tip
    orifice,                ///< a point, where a canal begins
    furcation,              ///< a point
    apex,                   ///< a point
    fissure,                ///< a line, along the floor of a developmental groove
    marginalRidge,          ///< a line, along the crest
    ridge,                  ///< a line: triangular, oblique, transverse, cusp or labial ridge, incisal edge
    heightOfContour,        ///< a ring
    cementoEnamelJunction,  ///< a ring
    longAxis,               ///< two points, from the apex towards the crown
    pathOfInsertion,        ///< two points, from the tooth outwards
};
inline constexpr std::size_t kLandmarkKindCount = 14;
/// As files name them: "cusp-tip", in the order of LandmarkKind.
inline constexpr std::array<std::string_view, kLandmarkKindCount> kLandmarkKinds = {"cusp-tip",
                                                                                    "pit",
                                                                                    "contact",
                                                                                    "pulp-horn",
                                                                                    "orifice",
                                                                                    "furcation",
                                                                                    "apex",
                                                                                    "fissure",
                                                                                    "marginal-ridge",
                                                                                    "ridge",
                                                                                    "height-of-contour",
                                                                                    "cemento-enamel-junction",
                                                                                    "long-axis",
                                                                                    "path-of-insertion"};
/// How many points a kind has: {least, most}; a ring is closed from its last point to its first.
struct LandmarkShape {
    std::size_t least, most;
    bool isRing;
};
[[nodiscard]] LandmarkShape shapeOf(LandmarkKind kind) noexcept;

/// Who says where it is: a generator that put it there, a search on a surface, or a person.
enum class LandmarkSource : std::uint8_t { generated, found, set };
inline constexpr std::array<std::string_view, 3> kLandmarkSources = {"generated", "found", "set"};

struct Landmark {
    LandmarkKind kind = LandmarkKind::cuspTip;
    std::string name;                  ///< in the field's words: "mesiobuccal", "central", "mesial"; may be empty
    std::vector<core::Vec3> pointsMm;  ///< tooth frame
    LandmarkSource source = LandmarkSource::set;
};

}  // namespace handpiece::cases
