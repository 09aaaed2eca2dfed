// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The parts that a tooth is described by, in the words of dental anatomy, and the tooth made of them. Private to this
/// room. Frame of these: +x mesial, +y lingual, +z occlusal [mm], so that left and right share one description.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/model/dentition/tooth_form.h"

namespace handpiece::dentition {

/// Mean sizes of a kind of tooth [mm]; docs/anatomy.md says from where.
struct Sizes {
    double crown, root, mesiodistal, mesiodistalCervix, buccolingual, buccolingualCervix, curveMesial, curveDistal;
};

/// How far people differ in the crown's widths: standard deviations, shares of the mean.
struct Spreads {
    double mesiodistal, buccolingual;
};

/// An outline of the crown seen from a side: how far it stands out at the cervix, at the height of contour, at the rim
/// of the occlusal surface and above.
struct Outline {
    double contourZ;      ///< height of contour
    double rimZ, rim;     ///< at the rim
    double topZ, top;     ///< at the height of the highest cusp, beyond the surface
    double shift = 0.0;   ///< moves the contour outwards [mm], its opposite side follows
    double belly = 0.64;  ///< share of the way out that is gone half-way up from the cervix to the contour
};

/// A crest of the crown: cusp, triangular, oblique or marginal ridge, incisal edge. Convex across; where the flanks of
/// two meet there is a groove, as in nature where two lobes have grown together.
struct Crest {
    core::Vec3 from, by, to;  ///< a quadratic Bezier curve's points
    double round = 0.8;       ///< the larger, the broader its back [mm]
    double slope = 0.95;      ///< of its flanks
    bool isRim = false;       ///< one of the ring of cusp and marginal ridges, which pass into each other
    std::string name{};       ///< those with a name become landmarks
    bool isMarginal = false;
};

/// A groove cut into the finished surface along a line seen from above: points are x, y and depth. V-shaped with
/// rounded shoulders; it widens and narrows on its way.
struct Groove {
    std::string name;  ///< developmental grooves have one and become landmarks
    std::vector<core::Vec3> points;
    double halfWidth = 0.4;
    double fromZ = 2.5, toZ = 4.0;  ///< it fades in over this height, where it runs down a side
    std::vector<double> widths{};   ///< shares of halfWidth, one a point; none: the same all along
};

/// A round hollow, or with a negative depth a swelling: pit, fossa, concavity, cingulum, lobe, Carabelli's cusp.
struct Hollow {
    core::Vec3 centre, radii;
    double depth;
    std::string pit{};  ///< its name when it is a pit: those become landmarks
};

struct Cusp {
    std::string name;
    core::Vec3 tip;
};

/// Where antagonists have ground a cusp flat: along the surface as it was at this place, so deep.
struct Facet {
    core::Vec2 place;
    double depth;
};

struct Root {
    std::string name;
    core::Vec2 cervix;        ///< centre at z = 0
    core::Vec3 middle, apex;  ///< centre half-way down, and the tip
    core::Vec2 half;          ///< half widths at z = 0
    double square = 0.3;
    double waist = 0.0;              ///< concavity of the mesial and distal sides, share of the half width
    core::Vec2 taper = {0.8, 0.45};  ///< widths half-way and nine tenths down, shares of those at z = 0
};

/// Where a root's middle runs, at this share of the way from the cervix to the apex.
[[nodiscard]] core::Vec2 rootCentre(const Root& root, double share);

struct Canal {
    std::string name;
    std::vector<core::Vec3> points;  ///< from the orifice to the apical foramen
    double orificeRadius, apexRadius;
    double funnel;  ///< how much wider it opens into the chamber
};
struct Horn {
    std::string name;
    core::Vec3 base, tip;
    double baseRadius, tipRadius;  ///< it narrows the faster, the broader it is
};

/// A cross-section of a column at one height.
struct Section {
    double z, cx, cy, halfX, halfY;
    double square;       ///< 0 an ellipse, 1 nearly a rectangle
    double waist = 0.0;  ///< concavity of the sides towards +x and -x
};

struct Spec {
    Sizes sizes{};
    Spreads spreads{};
    Outline mesial{}, distal{}, buccal{}, lingual{};
    double centreX = 0.0;  ///< of the cervix
    double cervixSquare = 0.5, contourSquare = 0.7, rimSquare = 0.7;
    double lean = 0.0;   ///< relative growth of the mesiodistal width towards lingual
    double wedge = 0.0;  ///< relative growth of the buccolingual width towards mesial
    double skew = 0.0;   ///< shift towards mesial for each mm lingual
    double rimRound = 1.2;
    bool isEdge = false;   ///< the crests are an incisal edge: they say how high it is, the outlines how thick
    double groundZ = 0.0;  ///< no crest reaches below this inside the rim: floor of the fossae
    std::vector<Cusp> cusps;
    std::vector<Crest> crests;
    std::vector<Groove> grooves;
    std::vector<Hollow> hollows;
    std::vector<Facet> facets;
    std::uint64_t unevenSeed = 0;
    double uneven = 0.0;  ///< no wall of a tooth is as smooth as its outlines: spread of this [mm]
    std::vector<Root> roots;
    double trunk = 0.0;  ///< from the cervix to the furcation; 0 with one root
    double rootBlend = 1.4;
    double enamelCusp = 2.0, enamelFossa = 0.75, enamelSide = 1.05;  ///< thicknesses
    std::vector<Section> chamber;
    double roofZ = 0.8, floorZ = -1.0;  ///< of the chamber's middle; with one root the roof alone
    /// How much higher the roof is at the walls of x and of y than in its middle, and how much lower the floor.
    core::Vec2 roofRise = core::Vec2::Zero(), floorFall = core::Vec2::Zero();
    bool edgeHorns = false;                ///< horns stand behind the lobes of an incisal edge
    std::vector<std::string> twoCanals{};  ///< roots with two
    std::vector<Horn> horns;
    std::vector<Canal> canals;
};

/// Of the right side's tooth with this place in its quadrant (1 central incisor .. 8 third molar), before sizes are
/// scaled to a patient.
[[nodiscard]] Spec specOf(bool upper, int place, const Patient& patient);

}  // namespace handpiece::dentition
