// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/rules.h"

namespace handpiece::dentition {
using core::Vec2;
using core::Vec3;

namespace {

/// Five cusps; the grooves make a Y.
void fiveCusps(Spec& s, Draws& draws) {
    OcclusalPlan plan;
    plan.buccal = {{"mesiobuccal", Vec3(2.6, -2.9, 6.75), Vec3(1.7, -0.35, 5.0), 0.62, 1.1, 0.15},
                   {"distobuccal", Vec3(-0.85, -3.05, 6.55), Vec3(-0.4, -0.2, 4.95), 0.6, 1.1},
                   {"distal", Vec3(-3.5, -1.75, 6.0), Vec3(-2.4, 0.0, 4.95), 0.5, 1.1}};
    plan.lingual = {{"mesiolingual", Vec3(2.4, 3.05, 7.25), Vec3(1.3, 0.35, 5.05), 0.65, 1.15, 0.1},
                    {"distolingual", Vec3(-1.95, 3.05, 7.05), Vec3(-1.15, 0.5, 5.0), 0.65, 1.15, -0.1}};
    plan.buccalNotch = {Vec3(0.9, -3.15, 5.75), Vec3(-2.5, -2.55, 5.55)};
    plan.lingualNotch = {Vec3(0.25, 3.15, 6.05)};
    plan.mesial = {Vec3(4.1, -2.0, 5.85), Vec3(4.4, 0.1, 5.5), Vec3(3.95, 2.1, 5.95)};
    plan.distal = {Vec3(-4.3, -0.6, 5.5), Vec3(-4.35, 0.75, 5.3), Vec3(-3.7, 2.0, 5.75)};
    vary(plan, draws);
    occlusalSurface(s, plan);
    const auto at = [&](double x, double y, double depth) -> Vec3 {
        return Vec3(x, y, depth) + draws.shift(0.18, 0.16, 0.0);
    };
    const auto outwards = [](std::vector<Vec3> points, const Vec3& end) {
        points.push_back(end);
        return points;
    };
    const auto notch = [](const Vec3& p, double depth) { return Vec3(p.x(), p.y(), depth); };
    const Vec3 mesial = at(3.35, 0.15, 0.3), mesiobuccal = at(0.9, -0.2, 0.36), lingual = at(0.15, 0.15, 0.42),
               distobuccal = at(-1.75, 0.15, 0.33), distal = at(-3.3, 0.35, 0.3);
    // Zigzag from pit to pit past the places where the others leave it.
    std::vector<Vec3> line = bent(mesial, mesiobuccal, draws);
    line.push_back(lingual);
    for (const auto& [from, to] : {std::pair{lingual, distobuccal}, {distobuccal, distal}}) {
        const std::vector<Vec3> part = bent(from, to, draws);
        line.push_back(0.5 * (part[1] + part[2])), line.push_back(to);
    }
    s.grooves.push_back({"central", line, 0.26, 3.0, 4.0});
    s.grooves.push_back({"mesiobuccal",
                         outwards(bent(mesiobuccal, notch(plan.buccalNotch[0], 0.24), draws), Vec3(0.85, -5.5, 0.16)),
                         0.28, 2.8, 4.2});
    s.grooves.push_back({"distobuccal",
                         outwards(bent(distobuccal, notch(plan.buccalNotch[1], 0.22), draws), Vec3(-3.4, -4.9, 0.1)),
                         0.28, 3.6, 5.0});
    s.grooves.push_back({"lingual",
                         outwards(bent(lingual, notch(plan.lingualNotch[0], 0.22), draws), Vec3(0.2, 5.4, 0.1)), 0.28,
                         3.6, 5.4});
    // Lobes: the developmental grooves lie in broad furrows of the sides.
    s.hollows.push_back(
        {Vec3(0.9, -5.6, 5.4) + draws.shift(0.2, 0.0, 0.3), Vec3(1.6, 2.8, 3.0), draws.between(0.25, 0.55)});
    s.hollows.push_back(
        {Vec3(-3.0, -5.0, 5.6) + draws.shift(0.2, 0.0, 0.3), Vec3(1.5, 2.5, 2.8), draws.between(0.2, 0.5)});
    s.hollows.push_back(
        {Vec3(0.25, 5.6, 5.8) + draws.shift(0.2, 0.0, 0.3), Vec3(1.7, 2.8, 3.0), draws.between(0.25, 0.55)});
    // The mesiobuccal groove ends in a pit in the middle third.
    s.hollows.push_back({Vec3(0.86, -5.15, 3.35), Vec3(0.65, 0.8, 0.8), 0.16, "buccal"});
    // Pits are where grooves meet.
    s.hollows.push_back({Vec3(lingual.x(), lingual.y(), 4.75), Vec3(0.8, 0.6, 0.9), 0.08, "central"});
    s.hollows.push_back({Vec3(mesial.x(), mesial.y(), 4.8), Vec3(0.7, 0.8, 0.9), 0.06, "mesial"});
    s.hollows.push_back({Vec3(distal.x(), distal.y(), 4.8), Vec3(0.7, 0.8, 0.9), 0.06, "distal"});
    supplementalGrooves(s, plan, draws);
}

/// Four cusps; the grooves make a +. Wrinkled: more supplemental grooves, as third molars have.
void fourCusps(Spec& s, bool isWrinkled, Draws& draws) {
    OcclusalPlan plan;
    plan.buccal = {{"mesiobuccal", Vec3(2.5, -2.95, 6.75), Vec3(1.35, -0.35, 5.0), 0.62, 1.1, 0.15},
                   {"distobuccal", Vec3(-2.05, -2.85, 6.55), Vec3(-1.2, -0.35, 4.95), 0.62, 1.1, -0.1}};
    plan.lingual = {{"mesiolingual", Vec3(2.35, 3.0, 7.25), Vec3(1.3, 0.45, 5.05), 0.65, 1.15, 0.1},
                    {"distolingual", Vec3(-2.05, 2.9, 7.0), Vec3(-1.2, 0.5, 5.0), 0.65, 1.15, -0.1}};
    plan.buccalNotch = {Vec3(0.3, -3.2, 5.75)};
    plan.lingualNotch = {Vec3(0.25, 3.15, 6.0)};
    plan.mesial = {Vec3(4.05, -2.0, 5.85), Vec3(4.35, 0.1, 5.5), Vec3(3.9, 2.1, 5.95)};
    plan.distal = {Vec3(-3.95, -1.75, 5.65), Vec3(-4.35, 0.1, 5.35), Vec3(-3.75, 1.9, 5.75)};
    vary(plan, draws);
    occlusalSurface(s, plan);
    const auto at = [&](double x, double y, double depth) -> Vec3 {
        return Vec3(x, y, depth) + draws.shift(0.18, 0.16, 0.0);
    };
    const auto outwards = [](std::vector<Vec3> points, const Vec3& end) {
        points.push_back(end);
        return points;
    };
    const auto notch = [](const Vec3& p, double depth) { return Vec3(p.x(), p.y(), depth); };
    const Vec3 mesial = at(3.3, 0.1, 0.3), central = at(0.25, 0.08, 0.42), distal = at(-3.25, 0.1, 0.3);
    std::vector<Vec3> line = bent(mesial, central, draws);
    const std::vector<Vec3> second = bent(central, distal, draws);
    line.insert(line.end(), second.begin() + 1, second.end());
    s.grooves.push_back({"central", line, 0.27, 3.0, 4.0});
    // A +, whose arms seldom meet in one point.
    Vec3 lingual = central + draws.shift(0.25, 0.0, 0.0), buccal = central;
    lingual.z() = buccal.z() = 0.36;
    s.grooves.push_back({"buccal",
                         outwards(bent(buccal, notch(plan.buccalNotch[0], 0.24), draws), Vec3(0.3, -5.5, 0.12)), 0.28,
                         3.0, 4.4});
    s.grooves.push_back({"lingual",
                         outwards(bent(lingual, notch(plan.lingualNotch[0], 0.22), draws), Vec3(0.25, 5.4, 0.1)), 0.28,
                         3.6, 5.4});
    s.hollows.push_back(
        {Vec3(0.3, -5.6, 5.4) + draws.shift(0.2, 0.0, 0.3), Vec3(1.7, 2.8, 3.0), draws.between(0.25, 0.55)});
    s.hollows.push_back(
        {Vec3(0.25, 5.6, 5.8) + draws.shift(0.2, 0.0, 0.3), Vec3(1.7, 2.8, 3.0), draws.between(0.25, 0.55)});
    s.hollows.push_back({Vec3(central.x(), central.y(), 4.75), Vec3(0.8, 0.6, 0.9), 0.08, "central"});
    s.hollows.push_back({Vec3(mesial.x(), mesial.y(), 4.8), Vec3(0.7, 0.8, 0.9), 0.06, "mesial"});
    s.hollows.push_back({Vec3(distal.x(), distal.y(), 4.8), Vec3(0.7, 0.8, 0.9), 0.06, "distal"});
    for (int i = 0; i < (isWrinkled ? 2 : 1); ++i)
        supplementalGrooves(s, plan, draws);
}

}  // namespace

void lowerMolar(Spec& s, int place, Draws& draws) {
    const Sizes sizes = s.sizes;
    // Outlines: contact in the occlusal third; buccal contour in the cervical third, lingual in the middle third; the
    // crown leans lingually.
    s.mesial = {4.6, 6.0, 4.75, 7.6, 3.7, 0.05};
    s.distal = {4.3, 5.8, 4.65, 7.4, 3.4};
    s.buccal = {2.2, 6.2, 3.95, 7.6, 2.7, 0.05};
    s.lingual = {3.6, 6.7, 4.05, 7.8, 3.0};
    s.lean = -0.06, s.wedge = 0.05;
    s.cervixSquare = 0.5, s.contourSquare = 0.5, s.rimSquare = 0.5;
    s.mesial.belly = s.distal.belly = 0.7, s.buccal.belly = 0.73, s.lingual.belly = 0.72;
    s.enamelFossa = 0.55;
    s.rimRound = 1.2;
    s.groundZ = 4.55;
    if (place == 6)
        fiveCusps(s, draws);
    else
        fourCusps(s, place == 8, draws);
    s.trunk = 3.6;
    s.roots = {{"mesial", Vec2(2.05, 0.0), Vec3(3.0, 0.0, -7.0), Vec3(1.6, 0.1, -14.2), Vec2(2.0, 3.85), 0.4, 0.22,
                Vec2(0.78, 0.5)},
               {"distal", Vec2(-2.05, 0.0), Vec3(-2.9, 0.0, -6.6), Vec3(-3.5, 0.1, -13.2), Vec2(1.95, 3.65), 0.35, 0.1,
                Vec2(0.75, 0.46)}};
    // The trunk is fluted towards the furcation, buccally more than lingually: there the trunk is the longer.
    s.hollows.push_back({Vec3(0.1, -5.0, -1.6), Vec3(1.9, 2.0, 3.4), 0.4});
    s.hollows.push_back({Vec3(0.0, 5.0, -1.4), Vec3(1.9, 2.0, 3.2), 0.32});
    s.hollows.push_back({Vec3(0.0, 2.9, -3.6), Vec3(1.6, 2.2, 1.4), -0.6});
    s.roofZ = 0.4, s.floorZ = -1.15;
    if (place == 7) {
        // Straighter roots, closer together.
        s.roots[0].middle.x() = 2.7, s.roots[0].apex.x() = 1.2;
        s.roots[1].middle.x() = -2.6, s.roots[1].apex.x() = -3.2;
        s.distal.rim = 3.5, s.wedge = 0.05;
        scale(s, 10.5 / 11.0, 10.0 / 10.5, 7.0 / 7.5, 13.0 / 14.0);
    }
    if (place == 8) {
        // Short roots, often grown together for most of their length and bent to distal.
        s.trunk = 6.0;
        s.roots[0].middle.x() = 1.7, s.roots[0].apex.x() = -0.9;
        s.roots[1].middle.x() = -2.5, s.roots[1].apex.x() = -4.0;
        s.contourSquare = 0.5, s.rimSquare = 0.45, s.wedge = 0.07;
        scale(s, 10.0 / 11.0, 9.5 / 10.5, 7.0 / 7.5, 11.0 / 14.0);
    }
    s.sizes = sizes;
    s.twoCanals = {"mesial"};
}

}  // namespace handpiece::dentition
