// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/rules.h"

namespace handpiece::dentition {
using core::Vec2;
using core::Vec3;

namespace {
/// Premolars are drawn 7 mm wide. In a narrower one all of it is narrower: between necks as wide as ever no bone would
/// find room.
void narrow(Spec& s) {
    const Sizes sizes = s.sizes;
    scale(s, sizes.mesiodistal / 7.0, 1.0, 1.0, 1.0);
    s.sizes = sizes;
}
}  // namespace

void upperPremolar(Spec& s, int place, Draws& draws) {
    const bool first = place == 4;
    s.mesial = {4.9, 6.6, 2.85, 8.4, 2.2};
    s.distal = {4.6, 6.4, 2.75, 8.2, 2.1};
    s.buccal = {2.4, 7.0, 3.6, 9.0, 2.5};
    s.lingual = {4.2, 6.8, 3.45, 8.6, 2.5};
    s.lean = -0.08;
    s.cervixSquare = 0.45, s.contourSquare = 0.55, s.rimSquare = 0.5;
    s.rimRound = 0.8;
    s.groundZ = 5.15;
    const double buccal = first ? 8.25 : 8.25, palatal = first ? 7.2 : 8.05;
    OcclusalPlan plan;
    // The first one's buccal cusp stands distal of the middle: its mesial slope is the longer.
    plan.buccal = {
        {"buccal", Vec3(first ? -0.25 : 0.1, -2.85, buccal), Vec3(first ? -0.05 : 0.05, 0.2, 5.75), 0.55, 1.25}};
    plan.lingual = {{"palatal", Vec3(0.4, 2.75, palatal), Vec3(0.15, 0.55, 5.75), 0.6, 1.2}};
    plan.mesial = {Vec3(2.6, -1.7, 6.65), Vec3(2.65, 0.4, 6.35), Vec3(2.0, 1.95, 6.6)};
    plan.distal = {Vec3(-2.5, -1.7, 6.6), Vec3(-2.6, 0.3, 6.3), Vec3(-1.75, 2.0, 6.5)};
    occlusalSurface(s, plan);
    const double m = first ? 1.75 : 1.25, d = first ? 1.65 : 1.15;
    s.grooves.push_back(
        {"central",
         {Vec3(m, 0.4, 0.38), Vec3(0.6, 0.32, 0.32), Vec3(0.1, 0.42, 0.3), Vec3(-0.6, 0.34, 0.32), Vec3(-d, 0.4, 0.38)},
         0.27,
         3.5,
         4.5});
    if (first) {
        s.grooves.push_back({"mesial marginal",
                             {Vec3(m, 0.4, 0.38), Vec3(2.3, 0.5, 0.28), Vec3(2.75, 0.6, 0.25), Vec3(3.6, 0.7, 0.16)},
                             0.27,
                             4.2,
                             5.4});
        // The concavity of the mesial side, across the cervix.
        s.hollows.push_back({Vec3(3.0, 0.2, -0.5), Vec3(1.7, 2.2, 4.2), 0.4});
    }
    for (const double side : {1.0, -1.0}) {
        const double x = side > 0.0 ? m : -d;
        s.hollows.push_back({Vec3(x, 0.4, 5.5), Vec3(0.35, 0.35, 0.8), 0.18, side > 0.0 ? "mesial" : "distal"});
        if (!first) {  // wrinkled, as second premolars are
            s.grooves.push_back(
                {"",
                 {Vec3(0.35 * side, 0.35, 0.2), Vec3(0.75 * side, -0.5, 0.14), Vec3(0.85 * side, -1.3, 0.0)},
                 0.22,
                 3.5,
                 4.5});
            s.grooves.push_back({"",
                                 {Vec3(0.3 * side, 0.4, 0.2), Vec3(0.75 * side, 1.1, 0.1), Vec3(0.8 * side, 1.7, 0.0)},
                                 0.2,
                                 3.5,
                                 4.5});
        }
        // Buccal furrows beside the buccal ridge.
        s.hollows.push_back({Vec3(1.75 * side, -4.3, 6.0), Vec3(1.1, 1.9, 2.6), 0.22});
    }
    supplementalGrooves(s, plan, draws);
    s.enamelCusp = 1.7, s.enamelSide = 0.95, s.enamelFossa = 0.65;
    if (first) {
        s.trunk = 7.0;
        s.roots = {{"buccal", Vec2(0, -1.75), Vec3(0.1, -2.1, -7.0), Vec3(-0.6, -2.4, -14.2), Vec2(2.1, 2.0), 0.2, 0.0,
                    Vec2(0.8, 0.46)},
                   {"palatal", Vec2(0, 1.75), Vec3(0.1, 2.1, -7.0), Vec3(-0.5, 2.5, -13.6), Vec2(2.05, 2.0), 0.2, 0.0,
                    Vec2(0.8, 0.46)}};
        s.roofZ = 1.4, s.floorZ = -2.5;
    } else {
        s.roots = {{"root", Vec2(0, 0), Vec3(0.1, 0.0, -7.0), Vec3(-0.6, 0.1, -14.2), Vec2(2.5, 4.0), 0.3, 0.16,
                    Vec2(0.82, 0.48)}};
        s.roofZ = 2.6;
    }
    narrow(s);
}

void lowerPremolar(Spec& s, int place, Draws& draws) {
    const bool first = place == 4;
    s.mesial = {4.6, 6.0, 3.0, 8.2, 2.1};
    s.distal = {4.4, 5.8, 3.05, 8.0, 2.1};
    s.buccal = {2.4, 6.4, 2.55, 8.8, 1.2};
    s.lingual = {4.4, 5.9, 3.35, 8.2, 2.6};
    s.lean = first ? -0.1 : 0.0;
    s.cervixSquare = 0.35, s.contourSquare = 0.5, s.rimSquare = 0.5;
    s.rimRound = 0.8;
    s.enamelCusp = 1.8, s.enamelSide = 1.05, s.enamelFossa = 0.55;
    OcclusalPlan plan;
    if (first) {
        s.groundZ = 4.4;
        // The buccal cusp stands over the root's axis; the transverse ridge crosses the crown to the small lingual one.
        plan.buccal = {{"buccal", Vec3(0.15, -1.0, 8.25), Vec3(0.15, 0.9, 5.0), 0.62, 1.6}};
        plan.lingual = {{"lingual", Vec3(0.05, 2.45, 5.95), Vec3(0.1, 1.5, 4.85), 0.4, 1.3}};
        plan.mesial = {Vec3(2.65, -0.55, 5.9), Vec3(2.7, 0.9, 5.2), Vec3(1.6, 2.2, 4.9)};
        plan.distal = {Vec3(-2.65, -0.55, 6.0), Vec3(-2.75, 0.9, 5.4), Vec3(-1.7, 2.3, 5.1)};
        occlusalSurface(s, plan);
        s.grooves.push_back({"mesial",
                             {Vec3(1.7, 1.0, 0.3), Vec3(1.5, 0.6, 0.2), Vec3(1.55, 0.1, 0.1), Vec3(1.7, -0.3, 0.0)},
                             0.27,
                             3.2,
                             4.2});
        s.grooves.push_back({"distal",
                             {Vec3(-1.1, 1.7, 0.0), Vec3(-1.6, 1.4, 0.2), Vec3(-1.75, 0.95, 0.3), Vec3(-1.65, 0.4, 0.2),
                              Vec3(-1.8, -0.3, 0.0)},
                             0.27,
                             3.2,
                             4.2});
        s.grooves.push_back({"mesiolingual",
                             {Vec3(1.7, 1.0, 0.32), Vec3(1.72, 1.7, 0.22), Vec3(1.9, 2.4, 0.2), Vec3(2.4, 3.7, 0.12)},
                             0.28,
                             3.4,
                             4.8});
        s.hollows.push_back({Vec3(2.1, 3.2, 5.2), Vec3(1.0, 1.4, 2.2), 0.25});
        for (const double x : {1.7, -1.75})
            s.hollows.push_back({Vec3(x, 0.97, 5.0), Vec3(0.5, 0.5, 0.9), 0.2, x > 0.0 ? "mesial" : "distal"});
    } else {
        s.groundZ = 4.7;
        // Three cusps: the grooves make a Y. Fewer people have two.
        plan.buccal = {{"buccal", Vec3(0.15, -1.35, 7.75), Vec3(0.1, 0.35, 5.2), 0.65, 1.15}};
        plan.lingual = {{"mesiolingual", Vec3(1.15, 2.75, 6.9), Vec3(0.75, 0.85, 5.15), 0.6, 1.15},
                        {"distolingual", Vec3(-1.55, 2.5, 6.4), Vec3(-0.95, 0.75, 5.1), 0.55, 1.1}};
        plan.lingualNotch = {Vec3(-0.4, 2.95, 5.75)};
        plan.mesial = {Vec3(2.7, -0.75, 6.25), Vec3(2.75, 0.9, 5.85), Vec3(2.2, 2.1, 6.05)};
        plan.distal = {Vec3(-2.7, -0.75, 6.15), Vec3(-2.8, 0.7, 5.7), Vec3(-2.4, 1.8, 5.75)};
        occlusalSurface(s, plan);
        s.grooves.push_back(
            {"mesial", {Vec3(1.85, 0.7, 0.35), Vec3(1.0, 0.55, 0.3), Vec3(-0.1, 0.75, 0.4)}, 0.27, 3.2, 4.2});
        s.grooves.push_back(
            {"distal", {Vec3(-0.1, 0.75, 0.4), Vec3(-0.9, 0.4, 0.25), Vec3(-1.9, 0.5, 0.25)}, 0.27, 3.2, 4.2});
        s.grooves.push_back(
            {"lingual",
             {Vec3(-0.1, 0.75, 0.4), Vec3(-0.25, 1.7, 0.3), Vec3(-0.4, 2.9, 0.22), Vec3(-0.45, 4.2, 0.1)},
             0.28,
             3.8,
             5.2});
        s.hollows.push_back({Vec3(-0.42, 4.0, 5.6), Vec3(1.1, 1.8, 2.0), 0.28});
        for (const double x : {1.85, -1.9}) {
            s.hollows.push_back({Vec3(x, 0.6, 4.9), Vec3(0.35, 0.35, 0.8), 0.18, x > 0.0 ? "mesial" : "distal"});
        }
    }
    supplementalGrooves(s, plan, draws);
    for (const double side : {1.0, -1.0})
        s.hollows.push_back({Vec3(1.8 * side, -3.6, 6.0), Vec3(1.1, 1.9, 2.6), 0.22});
    s.roots = {{"root", Vec2(0, 0), Vec3(0.1, 0.0, -7.0), Vec3(-0.7, 0.1, -s.sizes.root - 0.25), Vec2(2.5, 3.25), 0.2,
                0.1, Vec2(0.82, 0.46)}};
    s.roofZ = 2.6;
    narrow(s);
}

}  // namespace handpiece::dentition
