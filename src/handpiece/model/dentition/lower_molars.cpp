// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/rules.h"

namespace handpiece::dentition {
using core::Vec2;
using core::Vec3;

void lowerMolar(Spec& s, int place, const Patient& patient) {
    // Outlines: contact in the occlusal third; buccal contour in the cervical third, lingual in the middle third; the
    // crown leans lingually.
    s.mesial = {4.6, 6.0, 4.75, 7.6, 3.7, 0.05};
    s.distal = {4.3, 5.8, 4.65, 7.4, 3.4};
    s.buccal = {2.2, 6.2, 3.95, 7.6, 2.7, 0.05};
    s.lingual = {3.6, 6.7, 4.05, 7.8, 3.0};
    s.lean = -0.05, s.wedge = 0.04;
    s.cervixSquare = 0.5, s.contourSquare = 0.7, s.rimSquare = 0.65;
    s.rimRound = 1.1;
    s.groundZ = 4.55;
    OcclusalPlan plan;
    plan.buccal = {{"mesiobuccal", Vec3(2.65, -2.75, 6.75), Vec3(1.75, -0.35, 5.05), 0.9, 1.0},
                   {"distobuccal", Vec3(-0.85, -2.95, 6.55), Vec3(-0.45, -0.25, 5.0), 0.85, 1.0},
                   {"distal", Vec3(-3.55, -1.65, 6.0), Vec3(-2.45, 0.0, 5.0), 0.7, 1.0}};
    plan.lingual = {{"mesiolingual", Vec3(2.45, 2.85, 7.25), Vec3(1.35, 0.35, 5.1), 0.95, 1.05},
                    {"distolingual", Vec3(-1.95, 2.85, 7.05), Vec3(-1.15, 0.45, 5.05), 0.95, 1.05}};
    plan.buccalNotch = {Vec3(0.9, -3.0, 5.75), Vec3(-2.45, -2.45, 5.55)};
    plan.lingualNotch = {Vec3(0.25, 2.95, 6.0)};
    plan.mesial = {Vec3(4.05, -2.0, 6.0), Vec3(4.4, 0.1, 5.75), Vec3(3.95, 2.1, 6.15)};
    plan.distal = {Vec3(-4.35, -0.6, 5.65), Vec3(-4.4, 0.75, 5.5), Vec3(-3.7, 2.0, 5.95)};
    occlusalSurface(s, plan);
    s.grooves.push_back({"central",
                         {Vec3(3.3, 0.1, 0.45), Vec3(2.2, 0.0, 0.4), Vec3(0.9, -0.12, 0.45), Vec3(0.1, 0.1, 0.5),
                          Vec3(-0.8, 0.15, 0.4), Vec3(-1.75, 0.15, 0.45), Vec3(-3.3, 0.3, 0.45)},
                         0.4,
                         3.0,
                         4.0});
    s.grooves.push_back({"mesiobuccal",
                         {Vec3(0.9, -0.12, 0.45), Vec3(0.98, -1.5, 0.35), Vec3(0.9, -2.9, 0.35), Vec3(0.85, -5.4, 0.3)},
                         0.5,
                         2.8,
                         4.2});
    s.grooves.push_back(
        {"distobuccal",
         {Vec3(-1.75, 0.15, 0.45), Vec3(-2.1, -1.2, 0.35), Vec3(-2.45, -2.4, 0.32), Vec3(-3.4, -4.9, 0.2)},
         0.5,
         3.6,
         5.0});
    s.grooves.push_back({"lingual",
                         {Vec3(0.1, 0.1, 0.5), Vec3(0.3, 1.5, 0.35), Vec3(0.25, 2.9, 0.3), Vec3(0.2, 5.4, 0.2)},
                         0.5,
                         3.6,
                         5.4});
    s.hollows.push_back({Vec3(0.87, -5.1, 3.3), Vec3(0.4, 0.6, 0.45), 0.3});
    s.trunk = 3.2;
    s.roots = {{"mesial", Vec2(2.1, 0.0), Vec3(3.1, 0.0, -7.0), Vec3(1.5, 0.1, -14.2), Vec2(2.0, 4.15), 0.4, 0.2,
                Vec2(0.78, 0.5)},
               {"distal", Vec2(-2.1, 0.0), Vec3(-3.0, 0.0, -6.6), Vec3(-3.5, 0.1, -13.2), Vec2(1.95, 3.85), 0.3, 0.1,
                Vec2(0.76, 0.45)}};
    s.roofZ = 0.6, s.floorZ = -1.0;
    if (place == 7) scale(s, 10.5 / 11.0, 10.0 / 10.5, 7.0 / 7.5, 13.0 / 14.0);
    if (place == 8) scale(s, 10.0 / 11.0, 9.5 / 10.5, 7.0 / 7.5, 11.0 / 14.0);
    pulpOf(s, patient.ageYears, {"mesial"});
}

}  // namespace handpiece::dentition
