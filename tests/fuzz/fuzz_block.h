// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A block with a fissure, contacts, a horn, orifices, a junction and a cusp, for what is laid on a tooth.

#include "fuzz_model.h"
#include "handpiece/model/case/case.h"

namespace handpiece::fuzz {

/// 10 x 9 x 14 mm, of enamel.
inline cases::Case block() {
    cases::Case made;
    made.name = made.kind = "block";
    made.buccalSign = -1;
    geometry::TriangleMesh& mesh = made.outer;
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back({i & 1 ? 5.0 : -5.0, i & 2 ? 4.5 : -4.5, i & 4 ? 7.0 : -7.0});
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    made.parts.push_back({"enamel", cases::Tissue::enamel, 10, mesh});
    using Kind = cases::LandmarkKind;
    made.landmarks = {{Kind::fissure, "central", {{-2.5, 0, 7}, {0, 0.3, 7}, {2.5, 0, 7}}},
                      {Kind::cuspTip, "mesiobuccal", {{2.5, -3, 7}}},
                      {Kind::cuspTip, "distolingual", {{-2.5, 3, 7}}},
                      {Kind::contact, "mesial", {{5, 0, 4}}},
                      {Kind::contact, "distal", {{-5, 0, 4}}},
                      {Kind::pulpHorn, "mesiobuccal", {{1.5, -1.5, 3}}},
                      {Kind::orifice, "mesial", {{1.5, 0, -2}}},
                      {Kind::orifice, "distal", {{-1.5, 0, -2}}},
                      {Kind::cementoEnamelJunction, "", {{5, 4.5, 0}, {-5, 4.5, 0}, {-5, -4.5, 0}, {5, -4.5, 0}}}};
    return made;
}

}  // namespace handpiece::fuzz
