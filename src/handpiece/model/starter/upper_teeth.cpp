// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/starter/anatomy.h"

namespace handpiece::starter {

// An upper right central incisor, FDI 11: +x mesial, +y labial. Sizes after Wheeler's Dental Anatomy [R, unchecked]:
// crown 8.5 x 7.0 x 10.5 mm, neck 7.0 x 6.0 mm, root 13 mm, curvature of the cervical line 3.5 mm mesial, 2.5 distal.
Anatomy upperIncisorAnatomy() {
    using V = core::Vec3;
    Anatomy a{};
    a.crown.sections = {{-3.0, 0.00, 0.05, 2.72, 2.72, 0.15}, {0.0, 0.00, 0.05, 3.30, 3.20, 0.20},
                        {1.6, 0.00, 0.05, 3.55, 3.40, 0.25},  {3.2, 0.02, 0.28, 3.80, 3.00, 0.35},
                        {5.5, 0.05, 0.72, 4.05, 2.15, 0.50},  {7.6, 0.05, 1.02, 4.22, 1.35, 0.60},
                        {9.6, 0.08, 1.12, 4.24, 0.78, 0.65},  {10.4, 0.10, 1.12, 4.20, 0.62, 0.65}};
    a.crown.bottomZ = -1.6;
    a.crown.bottomLength = 2.1;
    a.crown.topZ = 9.7;
    a.crown.topLength = 0.85;
    // The palatal fossa between two marginal ridges, and two faint developmental furrows on the labial face.
    a.flutes = {
        {0.05, -1.0, 0.55, 1.50, 2.8, 6.0}, {-1.25, 1.0, 0.10, 0.55, 5.0, 8.5}, {1.25, 1.0, 0.10, 0.55, 5.0, 8.5}};

    Column root;
    root.sections = {{-13.2, -0.35, -0.05, 0.80, 0.85, 0.1},
                     {-10.5, -0.25, -0.05, 1.45, 1.55, 0.1},
                     {-7.0, -0.10, 0.00, 2.15, 2.30, 0.1},
                     {-3.5, 0.00, 0.00, 2.75, 2.85, 0.1},
                     {0.5, 0.00, 0.05, 3.15, 3.10, 0.15}};
    root.bottomZ = -11.6;
    root.bottomLength = 1.6;
    root.topZ = 0.0;
    root.topLength = 1.5;
    a.roots = {root};
    a.rootBlend = 1.0;

    a.neckMesial = 2.6, a.neckDistal = 1.9, a.neckPlusY = -0.9, a.neckMinusY = -0.9;
    a.neckHalfX = 3.3, a.neckHalfY = 3.2;
    a.enamelSide = 0.95, a.enamelTop = 1.6, a.enamelTopFromZ = 7.5, a.enamelTopToZ = 10.0;

    a.pulpChamber.sections = {
        {-2.0, 0.0, 0.05, 0.95, 0.90, 0.1}, {1.0, 0.0, 0.10, 1.25, 1.00, 0.2}, {4.0, 0.0, 0.35, 1.35, 0.65, 0.3}};
    a.pulpChamber.bottomZ = -1.0;
    a.pulpChamber.bottomLength = 1.0;
    a.pulpChamber.topZ = 3.4;
    a.pulpChamber.topLength = 1.2;
    a.canals = {{{V(0.0, 0.05, -0.5), V(-0.1, 0.0, -5.0), V(-0.25, -0.05, -9.0), V(-0.35, -0.05, -12.2)},
                 {0.85, 0.62, 0.42, 0.22}},
                {{V(0.6, 0.2, 2.5), V(1.1, 0.5, 5.4)}, {0.45, 0.20}},
                {{V(-0.6, 0.2, 2.5), V(-1.1, 0.5, 5.4)}, {0.45, 0.20}}};
    // At the contact with the neighbour, on the mesial side.
    a.caries = {V(4.15, 0.55, 5.4), 0.45, V(3.05, 0.60, 5.2), V(0.55, 0.70, 0.95)};
    a.crownTopZ = 11.4, a.apexZ = -14.0, a.reach = 5.2;
    return a;
}

// An upper right first premolar, FDI 14: +x mesial, +y buccal. Sizes after Wheeler's Dental Anatomy [R, unchecked]:
// crown 7.0 x 9.0 x 8.5 mm, neck 5.0 x 8.0 mm, roots 14 mm, curvature of the cervical line 1 mm mesial, less distal.
Anatomy upperPremolarAnatomy() {
    using V = core::Vec3;
    Anatomy a{};
    a.crown.sections = {{-3.0, 0.00, 0.00, 2.15, 3.35, 0.20}, {0.0, 0.00, 0.00, 2.55, 3.90, 0.25},
                        {1.4, 0.00, 0.00, 2.80, 4.25, 0.35},  {2.8, 0.00, 0.02, 3.15, 4.45, 0.45},
                        {4.6, 0.02, -0.02, 3.48, 4.35, 0.55}, {6.0, 0.02, -0.05, 3.45, 3.95, 0.55},
                        {7.4, 0.00, 0.05, 3.15, 3.45, 0.50},  {9.4, 0.00, 0.10, 2.70, 2.90, 0.50}};
    a.crown.bottomZ = -1.6;
    a.crown.bottomLength = 2.0;
    a.crown.topZ = 9.4;
    a.crown.topLength = 0.0;
    a.crown.wedge = 0.0;
    a.crown.lean = 0.10;

    const V buccal(-0.10, 2.55, 8.25), palatal(0.35, -2.35, 7.30);
    a.ridges = {{buccal, V(-0.05, 0.55, 5.75), 1.0},
                {palatal, V(0.15, -0.45, 5.70), 1.0},
                {buccal, V(2.75, 1.85, 6.70), 0.95},
                {buccal, V(-2.85, 1.80, 6.65), 0.95},
                {palatal, V(2.60, -1.65, 6.25), 0.95},
                {palatal, V(-2.45, -1.65, 6.20), 0.95},
                {V(2.75, 1.85, 6.70), V(2.85, 0.05, 6.15), 1.1},
                {V(2.85, 0.05, 6.15), V(2.60, -1.65, 6.25), 1.1},
                {V(-2.85, 1.80, 6.65), V(-2.85, 0.05, 6.10), 1.1},
                {V(-2.85, 0.05, 6.10), V(-2.45, -1.65, 6.20), 1.1}};
    a.edgeRadius = 1.4;

    using P = core::Vec2;
    a.fissures = {{P(1.90, 0.02), P(0.70, 0.10), 0.50, 0.60},
                  {P(0.70, 0.10), P(-0.70, 0.02), 0.60, 0.60},
                  {P(-0.70, 0.02), P(-1.95, 0.05), 0.60, 0.50},
                  // Over the mesial marginal ridge: the mark of this tooth.
                  {P(1.90, 0.02), P(3.50, -0.10), 0.50, 0.15},
                  {P(1.90, 0.02), P(2.25, 1.10), 0.50, 0.10},
                  {P(1.90, 0.02), P(2.15, -0.95), 0.50, 0.10},
                  {P(-1.95, 0.05), P(-2.30, 1.05), 0.50, 0.10},
                  {P(-1.95, 0.05), P(-2.15, -0.90), 0.50, 0.10}};
    a.fissureFromZ = 3.6, a.fissureToZ = 5.2;
    a.flutes = {{-1.45, 1.0, 0.12, 0.60, 4.5, 7.0}, {1.40, 1.0, 0.12, 0.60, 4.5, 7.0}};

    Column buccalRoot, palatalRoot;
    buccalRoot.sections = {{-13.4, -0.35, 2.15, 0.70, 0.75, 0.1},
                           {-10.5, -0.25, 2.30, 1.15, 1.15, 0.1},
                           {-7.0, -0.10, 2.05, 1.65, 1.55, 0.2},
                           {-3.5, 0.00, 1.75, 2.05, 1.95, 0.2},
                           {0.5, 0.00, 1.60, 2.35, 2.25, 0.2}};
    buccalRoot.bottomZ = -12.0;
    buccalRoot.bottomLength = 1.4;
    buccalRoot.topZ = 0.0;
    buccalRoot.topLength = 1.5;
    palatalRoot.sections = {{-12.8, -0.25, -2.20, 0.70, 0.75, 0.1},
                            {-10.0, -0.15, -2.30, 1.10, 1.10, 0.1},
                            {-6.5, -0.05, -2.05, 1.55, 1.50, 0.2},
                            {-3.2, 0.00, -1.75, 1.95, 1.90, 0.2},
                            {0.5, 0.00, -1.60, 2.25, 2.20, 0.2}};
    palatalRoot.bottomZ = -11.4;
    palatalRoot.bottomLength = 1.4;
    palatalRoot.topZ = 0.0;
    palatalRoot.topLength = 1.5;
    a.roots = {buccalRoot, palatalRoot};
    a.rootBlend = 0.9;

    a.neckMesial = 0.75, a.neckDistal = 0.45, a.neckPlusY = -0.40, a.neckMinusY = -0.30;
    a.neckHalfX = 2.55, a.neckHalfY = 3.9;
    a.enamelSide = 1.15, a.enamelTop = 1.9, a.enamelTopFromZ = 5.0, a.enamelTopToZ = 7.6;

    a.pulpChamber.sections = {
        {-1.5, 0.0, 0.0, 0.75, 1.90, 0.2}, {0.5, 0.0, 0.0, 0.95, 2.10, 0.2}, {2.2, 0.0, 0.0, 0.95, 1.90, 0.2}};
    a.pulpChamber.bottomZ = -0.8;
    a.pulpChamber.bottomLength = 0.8;
    a.pulpChamber.topZ = 1.6;
    a.pulpChamber.topLength = 0.8;
    a.canals = {{{V(0.0, 1.3, 1.4), V(-0.05, 1.8, 4.0)}, {0.45, 0.20}},
                {{V(0.1, -1.3, 1.4), V(0.2, -1.7, 3.6)}, {0.45, 0.20}},
                {{V(0.0, 1.2, -0.6), V(-0.1, 1.9, -6.0), V(-0.35, 2.15, -12.4)}, {0.50, 0.36, 0.20}},
                {{V(0.0, -1.2, -0.6), V(-0.05, -1.9, -6.0), V(-0.25, -2.2, -11.8)}, {0.50, 0.36, 0.20}}};
    a.caries = {V(-0.20, 0.05, 6.4), 0.30, V(-0.20, 0.05, 3.75), V(0.85, 1.00, 0.5)};
    a.crownTopZ = 9.2, a.apexZ = -14.2, a.reach = 5.4;
    return a;
}

}  // namespace handpiece::starter
