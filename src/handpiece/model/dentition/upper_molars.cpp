// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "handpiece/model/dentition/rules.h"

namespace handpiece::dentition {
using core::Vec2;
using core::Vec3;

namespace {
/// 0 in about a third of all seeds, up to 1.
double traitOf(const Patient& patient) {
    const std::uint64_t mixed = (patient.seed + 0x5DEECE66Dull) * 0x9E3779B97F4A7C15ull;
    return std::max(static_cast<double>(mixed >> 11) * 0x1p-53 * 1.5 - 0.5, 0.0);
}
/// Carabelli's trait on the wall of the mesiopalatal cusp: a furrow in some, a ridge beside it in more, a cusplet with
/// its own tip in few.
void carabelli(Spec& s, double trait, Draws& draws) {
    const Vec3 at = Vec3(1.8, 5.3, 3.5) + draws.shift(0.3, 0.0, 0.25);
    const auto swell = [&](const Vec3& off, const Vec3& radii, double by) {
        s.hollows.push_back({at + off, radii, -by});
    };
    // The furrow comes down from mesial and runs out towards distal.
    for (const auto& [off, deep] : {std::pair{Vec3(1.0, -0.55, 0.5), 0.10},
                                    {Vec3(0.35, -0.35, 0.95), 0.16},
                                    {Vec3(-0.45, -0.3, 0.95), 0.16},
                                    {Vec3(-1.1, -0.3, 0.35), 0.12},
                                    {Vec3(-1.5, -0.3, -0.4), 0.07}})
        s.hollows.push_back({at + off, Vec3(0.65, 1.0, 0.5), deep * std::min(1.0, 0.5 + trait)});
    swell(Vec3(0.1, 0.0, -0.9), Vec3(1.5, 1.2, 2.0), 0.18 * trait);
    swell(Vec3(-0.25 + 0.2 * draws.normal(), 0.0, 0.1), Vec3(0.95, 1.0, 0.85), 0.22 * trait);
    if (trait > 0.6) swell(Vec3(0.5, 0.0, -0.25), Vec3(0.8, 0.9, 0.8), 0.12 * trait);
}
}  // namespace

void upperMolar(Spec& s, int place, const Patient& patient, Draws& draws) {
    const Sizes sizes = s.sizes;
    s.mesial = {4.7, 6.1, 4.45, 7.6, 3.6, 0.05};
    s.distal = {4.2, 5.7, 4.3, 7.4, 3.2};
    s.buccal = {2.0, 6.4, 4.6, 7.8, 3.6, 0.0};
    s.lingual = {3.6, 6.5, 4.4, 7.8, 3.4};
    s.lean = 0.02, s.wedge = 0.04, s.skew = -0.13;
    s.cervixSquare = 0.45, s.contourSquare = 0.48, s.rimSquare = 0.48;
    s.mesial.belly = s.distal.belly = 0.7, s.buccal.belly = 0.73, s.lingual.belly = 0.74;
    s.enamelFossa = 0.4, s.enamelCusp = 2.12;
    s.rimRound = 1.2;
    s.groundZ = 4.4;
    OcclusalPlan plan;
    plan.buccal = {{"mesiobuccal", Vec3(2.75, -3.35, 6.85), Vec3(1.1, -0.75, 4.9), 0.62, 1.1, 0.15},
                   {"distobuccal", Vec3(-1.55, -3.15, 6.5), Vec3(-0.75, -1.0, 5.45), 0.6, 1.05}};
    plan.lingual = {{"mesiopalatal", Vec3(1.35, 2.75, 7.25), Vec3(1.3, -0.35, 5.0), 0.75, 1.05, 0.2},
                    {"distopalatal", Vec3(-2.8, 2.95, 6.0), Vec3(-2.6, 0.75, 4.8), 0.65, 1.05}};
    plan.buccalNotch = {Vec3(0.55, -3.5, 5.6)};
    plan.lingualNotch = {Vec3(-1.35, 3.3, 5.3)};
    plan.mesial = {Vec3(4.15, -2.2, 5.7), Vec3(4.15, 0.0, 5.25), Vec3(3.3, 2.3, 5.75)};
    plan.distal = {Vec3(-3.3, -2.2, 5.5), Vec3(-3.85, 0.1, 5.05), Vec3(-4.0, 1.8, 5.1)};
    if (place >= 7) {
        // The distopalatal cusp grows less from the first to the third.
        const double less = place == 7 ? draws.between(0.2, 0.5) : 1.1;
        plan.lingual[1].tip.z() -= less, plan.lingual[1].tip.x() += 0.15, plan.distal.lingual.z() -= 0.6 * less;
        plan.lingualNotch[0].z() -= 0.6 * less, plan.lingual[1].slope += 0.15;
        plan.buccal[1].tip.z() -= 0.15 * (place - 6), plan.distal.middle.z() -= 0.2 * less;
        s.skew = place == 7 ? -0.18 : -0.1;
    }
    vary(plan, draws);
    occlusalSurface(s, plan);
    // The oblique ridge: from the mesiopalatal to the distobuccal cusp, lowest in the middle.
    const Vec3 palatal = plan.lingual[0].tip, buccal = plan.buccal[1].tip,
               low = Vec3(-0.45, -0.35, 5.45) + draws.shift(0.2, 0.2, 0.08);
    const Vec3 bow = draws.shift(0.2, 0.1, 0.0);
    s.crests.push_back({palatal, Vec3(0.2, 1.4, 5.6) + bow, low, 0.65, 1.05, false, "oblique mesial"});
    s.crests.push_back({low, Vec3(-0.8, -1.3, 5.35) - bow, buccal, 0.65, 1.05, false, "oblique distal"});
    // Where the grooves meet: their depths, for the x and y of a pit.
    const auto at = [&](double x, double y, double depth) -> Vec3 {
        return Vec3(x, y, depth) + draws.shift(0.2, 0.2, 0.0);
    };
    const Vec3 central = at(0.5, -0.9, 0.4), mesial = at(3.2, -0.15, 0.3), distal = at(-3.1, -0.35, 0.3);
    const Vec3 buccalNotch(plan.buccalNotch[0].x(), plan.buccalNotch[0].y(), 0.25),
        palatalNotch(plan.lingualNotch[0].x(), plan.lingualNotch[0].y(), 0.28);
    s.grooves.push_back({"central", bent(mesial, central, draws), 0.26, 3.0, 4.0});
    // The buccal groove leaves the central one at the pit or a little mesial of it.
    Vec3 fork = central + std::max(draws.normal(), 0.0) * 0.2 * (mesial - central);
    fork.z() = 0.36;
    // Over the rim and down the side.
    const auto down = [&](std::vector<Vec3> points, const Vec3& end) {
        points.push_back(end + draws.shift(0.3, 0.0, 0.0));
        return points;
    };
    s.grooves.push_back({"buccal", down(bent(fork, buccalNotch, draws), Vec3(0.35, -5.9, 0.12)), 0.28, 3.4, 5.2});
    s.grooves.push_back(
        {"distopalatal", down(bent(distal, palatalNotch, draws), Vec3(-0.7, 5.9, 0.14)), 0.3, 2.9, 4.8});
    // Across the oblique ridge: deep in some, hardly there in most.
    const double across = draws.between(0.04, 0.2);
    s.grooves.push_back(
        {"transverse",
         {Vec3(central.x(), central.y(), 0.2), Vec3(low.x(), low.y() - 0.2, across),
          Vec3(0.5 * (low.x() + distal.x()), distal.y(), 1.2 * across), Vec3(distal.x(), distal.y(), 0.25)},
         0.25,
         3.0,
         4.0});
    // Lobes: the developmental grooves lie in broad furrows of the sides.
    s.hollows.push_back(
        {Vec3(0.5, -5.8, 5.6) + draws.shift(0.25, 0.0, 0.3), Vec3(1.6, 2.7, 2.9), draws.between(0.2, 0.5)});
    s.hollows.push_back(
        {Vec3(-0.9, 5.8, 5.2) + draws.shift(0.25, 0.0, 0.3), Vec3(1.7, 2.8, 3.3), draws.between(0.25, 0.6)});
    // Pits are where grooves meet.
    s.hollows.push_back({Vec3(central.x(), central.y(), 4.75), Vec3(0.8, 0.6, 0.9), 0.08, "central"});
    s.hollows.push_back({Vec3(mesial.x(), mesial.y(), 4.8), Vec3(0.7, 0.8, 0.9), 0.06, "mesial"});
    s.hollows.push_back({Vec3(distal.x(), distal.y(), 4.7), Vec3(0.7, 0.8, 0.9), 0.06, "distal"});
    supplementalGrooves(s, plan, draws);
    // The trunk is fluted towards the furcations.
    s.hollows.push_back({Vec3(0.3, -5.3, -0.8), Vec3(1.7, 1.9, 2.6), 0.35});
    s.hollows.push_back({Vec3(4.3, 0.4, -0.8), Vec3(1.6, 1.9, 2.6), 0.25});
    s.hollows.push_back({Vec3(-4.2, -0.2, -0.8), Vec3(1.6, 1.9, 2.6), 0.25});
    s.trunk = 6.4;
    s.roots = {{"mesiobuccal", Vec2(2.15, -2.2), Vec3(2.9, -3.1, -6.5), Vec3(1.9, -3.3, -12.3), Vec2(1.65, 2.2), 0.4,
                0.12, Vec2(0.84, 0.5)},
               {"distobuccal", Vec2(-1.65, -2.4), Vec3(-2.6, -3.1, -6.2), Vec3(-3.2, -3.0, -11.8), Vec2(1.6, 1.95), 0.3,
                0.0, Vec2(0.8, 0.48)},
               {"palatal", Vec2(-0.2, 2.3), Vec3(-0.3, 4.3, -6.5), Vec3(-0.4, 4.9, -13.3), Vec2(2.7, 2.2), 0.2, 0.0,
                Vec2(0.76, 0.48)}};
    s.roofZ = 0.6, s.floorZ = -1.25;
    if (const double trait = traitOf(patient); place == 6 && trait > 0.0) carabelli(s, trait, draws);
    if (place == 7) {
        s.roots[0].middle.x() = 2.4, s.roots[0].apex.x() = 1.2, s.roots[1].middle.x() = -2.2,
        s.roots[1].apex.x() = -2.6;
        s.roots[2].middle.y() = 3.7, s.roots[2].apex.y() = 4.0;
        scale(s, 9.0 / 10.0, 1.0, 7.0 / 7.5, 12.0 / 13.0);
    }
    if (place == 8) {
        s.trunk = 6.0;
        s.roots[0].middle.x() = 1.9, s.roots[0].apex.x() = 0.3, s.roots[1].middle.x() = -1.9,
        s.roots[1].apex.x() = -2.4;
        s.roots[2].middle.y() = 3.0, s.roots[2].apex.y() = 2.9, s.roots[0].middle.y() = s.roots[1].middle.y() = -2.4;
        s.roots[0].apex.y() = s.roots[1].apex.y() = -2.3;
        s.rimSquare = 0.5, s.contourSquare = 0.55, s.lean = -0.06;
        scale(s, 8.5 / 10.0, 10.0 / 11.0, 6.5 / 7.5, 11.0 / 13.0);
    }
    s.sizes = sizes;
    s.twoCanals = {"mesiobuccal"};
}

}  // namespace handpiece::dentition
