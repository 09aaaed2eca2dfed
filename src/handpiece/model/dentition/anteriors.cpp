// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/rules.h"

namespace handpiece::dentition {
using core::Vec2;
using core::Vec3;

void anterior(Spec& s, bool upper, int place) {
    const Sizes& z = s.sizes;
    const double buccalZ = -0.25 * (z.curveMesial + z.curveDistal), top = z.crown + buccalZ, half = 0.5 * z.mesiodistal,
                 depth = 0.5 * z.buccolingual;
    const bool canine = place == 3;
    const double edgeY = upper ? -0.3 : 0.2;
    s.mesial = {0.8 * top, 0.93 * top, 0.95 * half, 1.1 * top, 0.85 * half};
    s.distal = {0.68 * top, 0.88 * top, 0.93 * half, 1.1 * top, 0.75 * half};
    if (canine)
        s.mesial = {0.68 * top, 0.85 * top, 0.75 * half, 1.1 * top, 0.3 * half},
        s.distal = {0.55 * top, 0.8 * top, 0.75 * half, 1.1 * top, 0.3 * half};
    s.buccal = {0.2 * top, 0.9 * top, 0.75 - edgeY, 1.1 * top, 0.35 - edgeY, 0.05};
    s.lingual = {0.12 * top, 0.9 * top, 0.75 + edgeY, 1.1 * top, 0.35 + edgeY};
    (void)depth;
    s.lean = -0.2;
    s.cervixSquare = 0.15, s.contourSquare = 0.35, s.rimSquare = 0.6;
    s.rimRound = 0.5;
    s.groundZ = 0.0;
    if (canine) {
        s.cusps = {{"cusp", Vec3(0.15, edgeY, top)}};
        s.crests = {{Vec3(0.15, edgeY, top), Vec3(1.2, edgeY, top - 0.6), Vec3(half, edgeY, top - 1.9), 0.5, 1.2},
                    {Vec3(0.15, edgeY, top), Vec3(-1.2, edgeY, top - 0.8), Vec3(-half, edgeY, top - 2.6), 0.5, 1.2}};
    } else {
        s.cusps = {{"incisal edge", Vec3(0.2 * half, edgeY, top)}};
        s.crests = {{Vec3(0.9 * half, edgeY, top - 0.08), Vec3(0.2 * half, edgeY, top + 0.05),
                     Vec3(-0.45 * half, edgeY, top - 0.1), 1.0, 0.8},
                    {Vec3(-0.45 * half, edgeY, top - 0.1), Vec3(-0.8 * half, edgeY, top - 0.25),
                     Vec3(-0.95 * half, edgeY, top - 0.9), 1.0, 0.8}};
    }
    // Lingual fossa between the cingulum and the incisal edge.
    s.hollows.push_back(
        {Vec3(0.0, 0.45 * depth + edgeY, 0.62 * top), Vec3(0.75 * half, 1.8, 0.33 * top), upper ? 0.5 : 0.25});
    s.roots = {{"root", Vec2(0, 0), Vec3(0.0, 0.0, -0.5 * z.root), Vec3(-0.6, 0.1, buccalZ - z.root),
                Vec2(0.5 * z.mesiodistalCervix, 0.5 * z.buccolingualCervix), 0.1, upper ? 0.0 : 0.12, Vec2(0.8, 0.42)}};
    s.enamelCusp = 2.0, s.enamelSide = 0.9, s.enamelFossa = 0.9;
    singleRootPulp(s, 25.0, 0.5 * top, canine ? 0.0 : 0.5);
}

}  // namespace handpiece::dentition
