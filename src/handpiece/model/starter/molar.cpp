// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/starter/anatomy.h"

namespace handpiece::starter {

// A lower right first molar, FDI 46: +x mesial, +y lingual. Sizes after Wheeler's Dental Anatomy [R, unchecked]: crown
// 11.0 x 10.5 x 7.5 mm, neck 9.2 x 9.0 mm, root 14 mm, curvature of the cervical line 1 mm mesial, less distal.
Anatomy lowerFirstMolarAnatomy() {
    using V = core::Vec3;
    Anatomy a{};
    a.crown.sections = {{-3.0, -0.10, 0.00, 4.05, 3.70, 0.45}, {0.0, -0.05, 0.00, 4.50, 4.35, 0.50},
                        {1.2, 0.00, -0.08, 4.90, 4.85, 0.60},  {2.4, 0.00, -0.10, 5.25, 5.10, 0.68},
                        {4.2, 0.02, 0.08, 5.52, 4.92, 0.72},   {5.6, 0.02, 0.22, 5.36, 4.40, 0.72},
                        {6.8, 0.00, 0.32, 4.95, 3.70, 0.70},   {8.2, 0.00, 0.35, 4.30, 2.90, 0.70}};
    a.crown.bottomZ = -1.6;
    a.crown.bottomLength = 2.1;
    a.crown.topZ = 8.2;
    a.crown.topLength = 0.0;
    a.crown.wedge = 0.07;
    a.crown.lean = -0.06;

    const V mb(2.75, -2.65, 6.75), db(-0.85, -2.85, 6.60), d(-3.65, -1.55, 6.05), ml(2.55, 2.75, 7.25),
        dl(-2.05, 2.70, 7.05);
    a.ridges = {
        // Triangular ridges, from the cusps down to the central groove.
        {mb, V(1.55, -0.55, 5.15), 1.0},
        {db, V(-0.45, -0.60, 5.10), 1.0},
        {d, V(-2.55, -0.25, 5.05), 1.0},
        {ml, V(1.35, 0.60, 5.20), 1.0},
        {dl, V(-1.20, 0.60, 5.15), 1.0},
        // Cusp ridges along the rim.
        {mb, V(4.10, -1.80, 5.95), 0.95},
        {mb, V(1.15, -2.85, 5.75), 0.95},
        {db, V(0.60, -2.95, 5.80), 0.95},
        {db, V(-2.00, -2.60, 5.75), 0.95},
        {d, V(-2.75, -2.25, 5.60), 0.95},
        {d, V(-4.45, -0.50, 5.55), 0.95},
        {ml, V(4.00, 1.95, 6.15), 0.95},
        {ml, V(0.60, 2.90, 6.10), 0.95},
        {dl, V(-0.10, 2.90, 6.10), 0.95},
        {dl, V(-3.75, 1.90, 5.90), 0.95},
        // Marginal ridges.
        {V(4.10, -1.80, 5.95), V(4.40, 0.10, 5.70), 1.1},
        {V(4.40, 0.10, 5.70), V(4.00, 1.95, 6.15), 1.1},
        {V(-4.45, -0.50, 5.55), V(-4.45, 0.70, 5.45), 1.1},
        {V(-4.45, 0.70, 5.45), V(-3.75, 1.90, 5.90), 1.1},
    };
    a.edgeRadius = 1.5;

    using P = core::Vec2;
    a.fissures = {
        // Central groove, from the mesial to the distal pit.
        {P(3.20, 0.10), P(2.20, 0.02), 0.50, 0.60},
        {P(2.20, 0.02), P(0.90, -0.12), 0.60, 0.65},
        {P(0.90, -0.12), P(0.10, 0.05), 0.65, 0.70},
        {P(0.10, 0.05), P(-0.80, 0.12), 0.70, 0.65},
        {P(-0.80, 0.12), P(-1.70, 0.05), 0.65, 0.62},
        {P(-1.70, 0.05), P(-3.25, 0.20), 0.62, 0.50},
        // Mesiobuccal groove, over the rim to the buccal pit.
        {P(0.90, -0.12), P(0.95, -1.40), 0.65, 0.55},
        {P(0.95, -1.40), P(0.88, -2.80), 0.55, 0.50},
        {P(0.88, -2.80), P(0.85, -5.40), 0.50, 0.35},
        // Distobuccal groove.
        {P(-1.70, 0.05), P(-2.00, -1.20), 0.62, 0.55},
        {P(-2.00, -1.20), P(-2.40, -2.40), 0.55, 0.45},
        {P(-2.40, -2.40), P(-3.30, -4.80), 0.45, 0.20},
        // Lingual groove: with the two buccal ones the Y of the Y5 pattern.
        {P(0.10, 0.05), P(0.28, 1.40), 0.70, 0.55},
        {P(0.28, 1.40), P(0.27, 2.80), 0.55, 0.45},
        {P(0.27, 2.80), P(0.25, 5.20), 0.45, 0.15},
        // Short grooves into the fossae's corners.
        {P(3.20, 0.10), P(3.75, -0.95), 0.50, 0.10},
        {P(3.20, 0.10), P(3.75, 1.05), 0.50, 0.10},
        {P(-3.25, 0.20), P(-3.75, -0.45), 0.50, 0.10},
        {P(-3.25, 0.20), P(-3.65, 1.00), 0.50, 0.10},
    };
    a.flutes = {
        {0.85, -1.0, 0.42, 0.60, 2.0, 5.2}, {-2.75, -1.0, 0.36, 0.55, 2.6, 5.2}, {0.26, 1.0, 0.38, 0.60, 3.0, 5.8}};

    Column mesial, distal;
    mesial.sections = {{-13.6, 1.35, 0.25, 0.85, 1.55, 0.3}, {-11.0, 2.25, 0.15, 1.20, 2.45, 0.4},
                       {-8.0, 2.85, 0.05, 1.50, 3.20, 0.5},  {-5.0, 2.90, 0.00, 1.72, 3.75, 0.5},
                       {-2.0, 2.45, 0.00, 1.95, 4.10, 0.5},  {0.5, 2.20, 0.00, 2.00, 4.20, 0.5}};
    mesial.bottomZ = -12.4;
    mesial.bottomLength = 1.5;
    mesial.topZ = 0.0;
    mesial.topLength = 1.5;
    distal.sections = {{-12.8, -3.35, 0.10, 0.85, 1.25, 0.1}, {-10.0, -3.25, 0.05, 1.25, 2.00, 0.2},
                       {-7.0, -3.00, 0.00, 1.55, 2.75, 0.3},  {-4.5, -2.75, 0.00, 1.70, 3.25, 0.4},
                       {-2.0, -2.40, 0.00, 1.90, 3.65, 0.5},  {0.5, -2.20, 0.00, 2.00, 3.85, 0.5}};
    distal.bottomZ = -11.6;
    distal.bottomLength = 1.5;
    distal.topZ = 0.0;
    distal.topLength = 1.5;
    a.roots = {mesial, distal};
    a.rootBlend = 1.1;

    a.neckMesial = 0.75, a.neckDistal = 0.45, a.neckPlusY = -0.25, a.neckMinusY = -0.40;
    a.neckHalfX = 4.5, a.neckHalfY = 4.35;
    a.enamelSide = 1.45, a.enamelTop = 2.1, a.enamelTopFromZ = 3.8, a.enamelTopToZ = 6.8;

    a.pulpChamber.sections = {
        {-1.5, 0.0, 0.0, 1.75, 1.25, 0.6}, {0.0, 0.0, 0.0, 2.0, 1.5, 0.6}, {2.0, 0.0, 0.05, 1.95, 1.45, 0.6}};
    a.pulpChamber.bottomZ = -0.8;
    a.pulpChamber.bottomLength = 0.9;
    a.pulpChamber.topZ = 1.0;
    a.pulpChamber.topLength = 0.9;
    a.canals = {
        // Horns under the cusps.
        {{V(1.3, -0.9, 1.0), V(2.0, -1.7, 3.1)}, {0.42, 0.18}},
        {{V(-0.4, -0.9, 1.0), V(-0.7, -1.7, 2.8)}, {0.42, 0.18}},
        {{V(-1.4, -0.6, 1.0), V(-2.1, -1.0, 2.3)}, {0.40, 0.16}},
        {{V(1.2, 0.9, 1.0), V(1.8, 1.6, 3.3)}, {0.42, 0.18}},
        {{V(-1.0, 0.9, 1.0), V(-1.5, 1.6, 3.1)}, {0.42, 0.18}},
        // Two canals in the mesial root, one wide one in the distal.
        {{V(1.6, -0.9, -0.8), V(2.6, -1.5, -5.0), V(2.5, -1.2, -9.0), V(1.8, -0.3, -11.6)}, {0.42, 0.34, 0.26, 0.16}},
        {{V(1.6, 0.9, -0.8), V(2.6, 1.5, -5.0), V(2.5, 1.4, -9.0), V(2.0, 0.8, -11.3)}, {0.42, 0.34, 0.26, 0.16}},
        {{V(-1.6, 0.0, -0.8), V(-2.7, 0.0, -5.0), V(-3.1, 0.05, -9.0), V(-3.3, 0.1, -11.2)}, {0.55, 0.45, 0.34, 0.20}},
    };
    a.caries = {V(-0.30, 0.08, 4.7), 0.32, V(-0.35, 0.05, 2.75), V(1.45, 1.15, 0.6)};
    a.crownTopZ = 8.2, a.apexZ = -14.6, a.reach = 6.4;
    return a;
}

}  // namespace handpiece::starter
