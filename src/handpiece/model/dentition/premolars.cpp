// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/rules.h"

namespace handpiece::dentition {
using core::Vec2;
using core::Vec3;

void upperPremolar(Spec& s, int place) {
    const bool first = place == 4;
    s.mesial = {4.9, 6.6, 2.9, 8.4, 2.1};
    s.distal = {4.6, 6.4, 2.8, 8.2, 2.0};
    s.buccal = {2.8, 7.2, 3.6, 9.0, 2.6};
    s.lingual = {4.2, 6.8, 3.4, 8.6, 2.4};
    s.lean = -0.08;
    s.cervixSquare = 0.4, s.contourSquare = 0.45, s.rimSquare = 0.4;
    s.rimRound = 1.0;
    s.groundZ = 5.1;
    const double palatal = first ? 7.25 : 8.1, buccal = first ? 8.25 : 8.2;
    OcclusalPlan plan;
    plan.buccal = {{"buccal", Vec3(first ? -0.15 : 0.1, -2.75, buccal), Vec3(0.0, 0.1, 5.7), 0.85, 1.1}};
    plan.lingual = {{"palatal", Vec3(0.35, 2.65, palatal), Vec3(0.1, 0.55, 5.7), 0.9, 1.0}};
    plan.mesial = {Vec3(2.55, -1.7, 6.7), Vec3(2.65, 0.3, 6.35), Vec3(2.1, 2.0, 6.6)};
    plan.distal = {Vec3(-2.5, -1.7, 6.6), Vec3(-2.6, 0.3, 6.3), Vec3(-1.9, 2.0, 6.5)};
    occlusalSurface(s, plan);
    const double reach = first ? 1.8 : 1.3;
    s.grooves.push_back(
        {"central", {Vec3(reach, 0.35, 0.45), Vec3(0.0, 0.35, 0.45), Vec3(-reach, 0.35, 0.45)}, 0.4, 3.5, 4.5});
    if (first)
        s.grooves.push_back(
            {"mesial marginal", {Vec3(1.8, 0.35, 0.45), Vec3(2.65, 0.5, 0.3), Vec3(3.6, 0.6, 0.2)}, 0.35, 4.2, 5.4});
    s.roots = {
        {"root", Vec2(0, 0), Vec3(0.0, 0.0, -7.0), Vec3(-0.5, 0.1, -14.2), Vec2(2.5, 4.0), 0.3, 0.15, Vec2(0.8, 0.45)}};
    if (first) {
        s.trunk = 7.0;
        s.roots = {{"buccal", Vec2(0, -1.8), Vec3(0.1, -2.1, -7.0), Vec3(-0.5, -2.4, -14.2), Vec2(2.45, 2.3), 0.3, 0.0,
                    Vec2(0.74, 0.4)},
                   {"palatal", Vec2(0, 1.8), Vec3(0.1, 2.1, -7.0), Vec3(-0.4, 2.5, -13.6), Vec2(2.4, 2.3), 0.3, 0.0,
                    Vec2(0.74, 0.4)}};
        s.hollows.push_back({Vec3(2.7, 0.3, 0.0), Vec3(1.3, 1.8, 3.0), 0.35});
    }
    singleRootPulp(s, 25.0, 3.0, 0.3);
}

void lowerPremolar(Spec& s, int place, const Patient&) {
    const bool first = place == 4;
    s.mesial = {4.6, 6.0, 3.0, 8.2, 2.0};
    s.distal = {4.4, 5.8, 3.0, 8.0, 2.0};
    s.buccal = {2.8, 6.8, 2.3, 8.8, 1.2};
    s.lingual = {4.6, 6.2, 3.1, 8.2, 2.4, 0.0};
    s.lean = -0.05;
    s.cervixSquare = 0.35, s.contourSquare = 0.45, s.rimSquare = 0.4;
    s.rimRound = 1.0;
    s.groundZ = 4.6;
    OcclusalPlan plan;
    plan.buccal = {{"buccal", Vec3(0.1, -1.1, first ? 8.25 : 7.7), Vec3(0.1, 1.0, 5.4), 0.9, 1.1}};
    if (first)
        plan.lingual = {{"lingual", Vec3(0.2, 2.45, 5.9), Vec3(0.1, 0.9, 5.1), 0.7, 1.0}};
    else {
        plan.lingual = {{"mesiolingual", Vec3(1.2, 2.6, 6.8), Vec3(0.7, 0.9, 5.0), 0.8, 1.0},
                        {"distolingual", Vec3(-1.4, 2.4, 6.4), Vec3(-0.8, 0.9, 5.0), 0.7, 1.0}};
        plan.lingualNotch = {Vec3(-0.2, 2.8, 5.9)};
    }
    plan.mesial = {Vec3(2.6, -0.6, 6.2), Vec3(2.75, 0.9, 5.6), Vec3(1.8, 2.2, 5.5)};
    plan.distal = {Vec3(-2.6, -0.6, 6.2), Vec3(-2.7, 0.9, 5.7), Vec3(-1.8, 2.2, 5.6)};
    occlusalSurface(s, plan);
    s.grooves.push_back(
        {"central", {Vec3(1.8, 0.7, 0.4), Vec3(0.1, 1.0, first ? 0.1 : 0.4), Vec3(-1.8, 0.7, 0.4)}, 0.4, 3.2, 4.2});
    s.roots = {{"root", Vec2(0, 0), Vec3(0.0, 0.0, -7.0), Vec3(-0.6, 0.1, -s.sizes.root - 0.25), Vec2(2.5, 3.3), 0.2,
                0.1, Vec2(0.8, 0.42)}};
    singleRootPulp(s, 25.0, 3.0, 0.2);
}

}  // namespace handpiece::dentition
