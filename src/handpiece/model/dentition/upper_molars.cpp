// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/rules.h"

namespace handpiece::dentition {
using core::Vec2;
using core::Vec3;

void upperMolar(Spec& s, int place, const Patient& patient) {
    s.mesial = {4.7, 6.0, 4.35, 7.6, 3.5, 0.05};
    s.distal = {4.2, 5.6, 4.2, 7.4, 3.0};
    s.buccal = {2.0, 6.4, 4.55, 7.8, 3.5, 0.0};
    s.lingual = {3.4, 6.4, 4.3, 7.8, 3.3};
    s.lean = 0.03, s.wedge = 0.03, s.skew = -0.1;
    s.cervixSquare = 0.5, s.contourSquare = 0.68, s.rimSquare = 0.6;
    s.rimRound = 1.1;
    s.groundZ = 4.4;
    OcclusalPlan plan;
    plan.buccal = {{"mesiobuccal", Vec3(2.6, -3.35, 6.85), Vec3(1.2, -0.9, 4.95), 0.9, 1.0, 0.1},
                   {"distobuccal", Vec3(-1.7, -3.15, 6.5), Vec3(-0.75, -1.0, 5.35), 0.85, 1.0}};
    plan.lingual = {{"mesiopalatal", Vec3(1.55, 2.6, 7.25), Vec3(1.15, -0.2, 5.05), 1.05, 1.0},
                    {"distopalatal", Vec3(-2.7, 2.9, 5.85), Vec3(-2.55, 0.6, 4.85), 0.8, 1.0}};
    plan.buccalNotch = {Vec3(0.4, -3.5, 5.6)};
    plan.lingualNotch = {Vec3(-1.35, 3.25, 5.3)};
    plan.mesial = {Vec3(3.95, -2.4, 5.9), Vec3(4.05, 0.0, 5.6), Vec3(3.3, 2.3, 5.95)};
    plan.distal = {Vec3(-3.35, -2.2, 5.6), Vec3(-3.8, 0.2, 5.3), Vec3(-3.9, 1.9, 5.3)};
    occlusalSurface(s, plan);
    // The oblique ridge: from the mesiopalatal to the distobuccal cusp.
    s.crests.push_back({Vec3(1.55, 2.6, 7.25), Vec3(-0.2, 0.4, 4.9), Vec3(-1.7, -3.15, 6.5), 0.8, 0.95});
    s.grooves.push_back(
        {"central", {Vec3(3.0, -0.25, 0.4), Vec3(1.9, -0.45, 0.4), Vec3(0.5, -0.85, 0.55)}, 0.4, 3.0, 4.0});
    s.grooves.push_back({"buccal",
                         {Vec3(0.5, -0.85, 0.5), Vec3(0.3, -2.2, 0.4), Vec3(0.4, -3.6, 0.35), Vec3(0.35, -5.9, 0.25)},
                         0.5,
                         3.0,
                         4.5});
    s.grooves.push_back({"distopalatal",
                         {Vec3(-3.0, -0.3, 0.4), Vec3(-2.3, 0.8, 0.45), Vec3(-1.5, 2.2, 0.4), Vec3(-1.25, 3.4, 0.35),
                          Vec3(-0.6, 5.9, 0.25)},
                         0.5,
                         2.8,
                         4.4});
    s.trunk = 4.0;
    s.roots = {{"mesiobuccal", Vec2(2.0, -2.3), Vec3(2.9, -3.2, -6.5), Vec3(1.9, -3.3, -12.3), Vec2(1.9, 2.6), 0.4,
                0.12, Vec2(0.75, 0.42)},
               {"distobuccal", Vec2(-2.0, -2.3), Vec3(-2.9, -3.1, -6.2), Vec3(-3.4, -3.0, -11.8), Vec2(1.8, 2.3), 0.3,
                0.0, Vec2(0.72, 0.42)},
               {"palatal", Vec2(-0.1, 2.2), Vec3(-0.2, 4.4, -6.5), Vec3(-0.3, 5.0, -13.3), Vec2(3.0, 2.5), 0.3, 0.0,
                Vec2(0.72, 0.42)}};
    s.roofZ = 0.8, s.floorZ = -1.0;
    if (place == 7) scale(s, 9.0 / 10.0, 1.0, 7.0 / 7.5, 12.0 / 13.0);
    if (place == 8) scale(s, 8.5 / 10.0, 10.0 / 11.0, 6.5 / 7.5, 11.0 / 13.0);
    pulpOf(s, patient.ageYears, {"mesiobuccal"});
}

}  // namespace handpiece::dentition
