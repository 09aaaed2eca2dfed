// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "handpiece/model/dentition/rules.h"

namespace handpiece::dentition {
using core::Vec2;
using core::Vec3;

void anterior(Spec& s, bool upper, int place) {
    const Sizes& z = s.sizes;
    const double buccalZ = -0.25 * (z.curveMesial + z.curveDistal), top = z.crown + buccalZ;
    const double half = 0.5 * z.mesiodistal, depth = 0.5 * z.buccolingual;
    const bool canine = place == 3, lateral = place == 2;
    // Upper incisal edges stand over the root's axis or labial of it, lower ones lingual of it.
    const double edge = upper ? -0.25 : 0.3, thick = canine ? 0.45 : upper ? 0.55 : 0.45;
    const auto at = [&](double share) { return buccalZ + share * z.crown; };
    // Contacts: incisal third, distal ones lower; the rounder the angle, the lower.
    const double mesial = canine    ? 0.70
                          : !upper  ? 0.87
                          : lateral ? 0.80
                                    : 0.84,
                 distal = canine    ? 0.56
                          : !upper  ? 0.84
                          : lateral ? 0.66
                                    : 0.72;
    s.mesial = {at(mesial), at(0.95), (canine ? 0.84 : 0.90) * half, at(1.05), 0.72 * half};
    s.distal = {at(distal), at(0.93), (canine ? 0.76 : 0.87) * half, at(1.05), 0.64 * half};
    s.mesial.belly = s.distal.belly = upper ? 0.68 : 0.56;
    s.buccal = {at(0.2), at(0.55), 0.88 * depth - 0.55 * edge, at(1.02), thick - edge, 0.05};
    s.lingual = {at(upper ? 0.2 : 0.15), at(0.62), 0.42 * depth + 0.9 * edge, at(1.02), thick + edge};
    s.lean = upper ? -0.26 : -0.18;
    s.cervixSquare = 0.15, s.contourSquare = canine ? 0.4 : 0.75, s.rimSquare = canine ? 0.5 : 0.85;
    s.rimRound = 0.4, s.isEdge = true;
    if (canine) {
        const double tip = 0.12 * half;
        s.cusps = {{"cusp", Vec3(tip, edge, top)}};
        // The mesial slope is the shorter.
        s.crests = {{Vec3(tip, edge, top), Vec3(0.5 * half, edge, top - 0.6), Vec3(0.95 * half, edge, top - 1.8), 0.7,
                     1.0, true, "cusp ridge"},
                    {Vec3(tip, edge, top), Vec3(-0.4 * half, edge, top - 0.85), Vec3(-0.98 * half, edge, top - 2.7),
                     0.7, 1.0, true, "cusp ridge"}};
        s.hollows = {{Vec3(0.2, -1.05 * depth, at(0.6)), Vec3(1.6, 2.0, 0.6 * z.crown), -0.25},
                     {Vec3(0.42 * half, 0.35 * depth + edge, at(0.6)), Vec3(0.46 * half, 1.6, 0.33 * z.crown),
                      upper ? 0.32 : 0.18},
                     {Vec3(-0.42 * half, 0.35 * depth + edge, at(0.57)), Vec3(0.46 * half, 1.6, 0.33 * z.crown),
                      upper ? 0.32 : 0.18},
                     {Vec3(0.0, 0.95 * depth, at(0.2)), Vec3(2.0, 1.8, 0.3 * z.crown), upper ? -0.2 : -0.08}};
    } else {
        // A sharp mesial and a rounded distal incisal angle; what is left of three mamelons.
        const double round = upper ? lateral ? 1.5 : 1.0 : lateral ? 0.5 : 0.25, lobe = upper ? 0.1 : 0.05;
        s.cusps = {{"incisal edge", Vec3(0.2 * half, edge, top)}};
        const Vec3 corner(0.9 * half, edge, top - 0.14 * round), one(0.3 * half, edge, top - 0.4 * lobe),
            two(-0.27 * half, edge, top - 0.08 * round - 0.4 * lobe), end(-0.95 * half, edge, top - 1.05 * round);
        for (const auto& [from, by, to] : {std::array{corner, Vec3(0.6 * half, edge, top + lobe), one},
                                           {one, Vec3(0.02 * half, edge, top + lobe), two},
                                           {two, Vec3(-0.7 * half, edge, top - 0.14 * round + lobe), end}})
            s.crests.push_back({from, by, to, 0.7, 1.0, true, "incisal edge"});
        // The fossa between the marginal ridges, over the cingulum.
        const double deep = upper ? lateral ? 0.8 : 0.7 : 0.2, ridge = upper ? lateral ? -0.45 : -0.38 : -0.07;
        s.hollows = {
            {Vec3(0.03 * half, 0.42 * depth + edge, at(0.6)), Vec3(0.62 * half, 1.6, 0.34 * z.crown), deep},
            {Vec3(-0.08 * half, 0.85 * depth, at(0.23)), Vec3(0.7 * half, 2.0, 0.27 * z.crown), upper ? -0.16 : -0.05},
            {Vec3(0.7 * half, 0.35 * depth + edge, at(0.6)), Vec3(0.3 * half, 1.5, 0.42 * z.crown), ridge},
            {Vec3(-0.7 * half, 0.35 * depth + edge, at(0.55)), Vec3(0.3 * half, 1.5, 0.4 * z.crown), ridge}};
        // Between the three lobes of the labial side.
        for (const double x : {0.3, -0.3})
            s.hollows.push_back(
                {Vec3(x * half, -0.6 * depth, at(0.88)), Vec3(0.26 * half, 1.8, 0.45 * z.crown), upper ? 0.15 : 0.05});
        // The lingual pit of the lateral incisor, where the fossa meets the cingulum.
        if (upper && lateral)
            s.hollows.push_back({Vec3(0.0, 0.72 * depth, at(0.36)), Vec3(0.55, 1.2, 0.75), 0.25, "lingual"});
    }
    s.roots = {{"root", Vec2(0, 0), Vec3(0.05, 0.0, -0.5 * z.root),
                Vec3(lateral || canine ? -0.9 : -0.3, 0.1, buccalZ - z.root),
                Vec2(0.49 * z.mesiodistalCervix, 0.49 * z.buccolingualCervix), 0.1, upper ? 0.0 : 0.14,
                Vec2(0.82, 0.44)}};
    s.enamelCusp = canine ? 1.8 : 2.1, s.enamelSide = canine ? 0.85 : 0.75;
    s.roofZ = (canine ? 0.42 : 0.34) * top, s.edgeHorns = !canine;
}

}  // namespace handpiece::dentition
